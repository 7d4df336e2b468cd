"""Networks of the command ``fair``: the curves of a file and their options."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.cli import fair_words as words
from moldloft.errors import Error, FairingError

if TYPE_CHECKING:
    import argparse

    from numpy.typing import NDArray

    from moldloft.fairing import NetworkFairing
    from moldloft.fairing.files import PointFile

__all__ = ["FileLines"]


@dataclass
class FileLines:
    """The curves of a file as a network."""

    file: PointFile
    rows: list[int] = field(default_factory=list)
    """Of each different point its first row."""
    of_row: list[int] = field(default_factory=list)
    """Of each row its point."""
    motion: Any = "ball"
    """The motion of all points, or the axes of each."""
    tolerances: Any = None
    """One tolerance, or that of each different point."""

    @classmethod
    def of(cls, file: PointFile, options: argparse.Namespace, said: list[str]) -> FileLines:
        """The network of a file; notes are added to ``said``."""
        for name, given in (
            ("--as", options.role not in (None, "points")),
            ("--closed", options.closed or options.closed_v),
            ("--through", options.through),
            ("--tangent", options.tangent),
            ("--normal", options.normal),
            ("--join", options.join),
            ("--rims", options.rims != "corners"),
            ("--count", options.count),
            ("--knots", options.knots or options.knots_v),
            ("--weights", options.weights),
            ("--seams", options.seams),
            ("--log", options.log),
            ("--degree with two numbers", not isinstance(options.degree, int)),
        ):
            if given:
                raise Error(f"{name}: not for networks; {file.path} has {len(file.blocks)} curves")
        lines = cls(file)
        keys: dict[Any, int] = {}
        for k, point in enumerate(file.points):
            key = file.places[k] if file.offsets else (point + 0.0).tobytes()
            if key not in keys:
                keys[key] = len(lines.rows)
                lines.rows.append(k)
            lines.of_row.append(keys[key])
        lines.tolerances = lines.tolerances_of(options)
        lines.motion = lines.axes_of(options, said)
        return lines

    @property
    def limits(self) -> NDArray[np.float64]:
        """The tolerance of each distinct point; infinite without a tolerance."""
        tolerances = np.inf if self.tolerances is None else self.tolerances
        return np.broadcast_to(np.asarray(tolerances, np.float64), len(self.rows))

    def fair(self, options: argparse.Namespace) -> NetworkFairing:
        """The faired network; errors state the row of the point."""
        from moldloft.fairing import network

        file, rows = self.file, self.rows
        names = list(file.names) if file.offsets else []
        marks: list[int | str] | str = (
            "auto" if options.breaks == "auto" else self._breaks(options.breaks, names)
        )
        released: list[int] | str = (
            "auto" if options.release == "auto" else self._points(options.release, "--release")
        )
        fixed: Any = options.ends or "corners"
        if options.fixed:
            fixed = self._points(options.fixed, "--fixed")
        try:
            result = network(
                file.points[rows],
                [[self.of_row[i] for i in block] for block in file.blocks],
                self.tolerances,
                names=names,
                degree=options.degree,
                measure=options.measure or "third",
                mode=options.mode,
                spacing="chord" if options.spacing == "auto" else options.spacing,
                goal=options.goal,
                shape=options.shape,
                breaks=marks,
                release=released,
                fixed=fixed,
                motion=self.motion,
                keep=options.keep,
                bound="curve" if options.bound == "curve" else "points",
                passes=options.passes or 1,
                steps=options.steps,
            )
        except FairingError as error:
            if error.index is not None and error.index < len(rows):
                raise FairingError(str(error), index=rows[error.index]) from error
            raise
        if not file.offsets:
            return result
        called = tuple(file.point_names[file.places[k]] for k in rows)
        return replace(result, point_names=called)

    def _points(self, text: str, what: str) -> list[int]:
        """Points by the numbers of their rows, from 1."""
        return [self.of_row[i] for i in words.places(text, len(self.file.points), what)]

    def _breaks(self, text: str, names: list[str]) -> list[int | str]:
        """Points by the numbers of their rows, and names of curves along which others break."""
        out: list[int | str] = []
        for word in filter(None, (w.strip() for w in text.split(","))):
            if word in names:
                out.append(word)
            else:
                out += self._points(word, "--breaks")
        return out

    def axes_of(self, options: argparse.Namespace, said: list[str]) -> Any:
        """The motion of the network, or the axes of each point if a table has several."""
        file, motion = self.file, words.motion(options)
        if motion != "ball" or not file.offsets:
            return motion
        if file.motions is None:
            said.append(
                "heights move; stations and buttocks stay"
                if file.moves == 2
                else "half-breadths move; stations and heights stay"
            )
            return (0.0, 0.0, 1.0) if file.moves == 2 else (0.0, 1.0, 0.0)
        said.append(
            "half-breadths of waterlines and heights of buttocks move, both of a sheer; stations "
            "and ends on stem and post stay"
        )
        return [file.motions[file.places[k]] for k in self.rows]

    def tolerances_of(self, options: argparse.Namespace) -> Any:
        """One tolerance, or the tolerance of each distinct point."""
        if not isinstance(options.tol, list):
            return options.tol
        found, rows, count = len(options.tol), self.rows, len(self.file.points)
        if found == len(rows):
            return options.tol
        if found != count:
            raise Error(
                f"--tol: expected {len(rows)} tolerances, one for each different point, or "
                f"{count}, one for each row of the curves, found {found}"
            )
        return [options.tol[k] for k in rows]
