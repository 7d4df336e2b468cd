"""STEP and IGES files as programs: faces become surfaces to build upon."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from moldloft.arguments import explain
from moldloft.cad.aligning import align
from moldloft.cad.apart import read
from moldloft.cad.joining import joins
from moldloft.cad.occt import Imported, ImportedFace
from moldloft.errors import Error
from moldloft.nurbs import Nurbs, _braced, _plain, _wrapped

if TYPE_CHECKING:
    import os

    from moldloft.models import Model

__all__ = ["UNITS", "load_cad", "program"]

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
"""Units of length in metres."""

ENDINGS = (".step", ".stp", ".iges", ".igs")
"""The endings of the files that are read."""


def program(path: str | os.PathLike[str], *, units: str = "m") -> tuple[str, list[str]]:
    """A CAD file as a program, and what is doubtful or left out.

    A face that is all of its surface becomes a ``NURBSurf``; others a hidden ``NURBSurf``, snakes
    along their loops and a ``TrimSurf``. An edge that faces share in the file is a ``Join``. Curves
    that bound no face become ``NURBCurve``.

    Parameters
    ----------
    path
        A STEP or IGES file.
    units
        The unit of length of the model: m, cm, mm, ft or in. Lengths are converted into it.

    Raises
    ------
    FormatError
        When the file cannot be read.
    """
    if units not in UNITS:
        raise Error(f"unknown unit `{units}`; expected one of: {', '.join(UNITS)}")
    path = Path(path)
    if path.suffix.lower() not in ENDINGS:
        raise Error(f"`{path}` is no CAD file by its ending; expected one of: {', '.join(ENDINGS)}")
    found = read(path, UNITS[units])
    align(found.faces)
    # Joins may add remarks.
    text = _text(found, path.name, units)
    return text, found.remarks


def load_cad(path: str | os.PathLike[str], *, units: str = "m") -> Model:
    """A model of a CAD file; see :func:`program`. Remarks are warnings of Python."""
    import warnings

    from moldloft.loading import loads

    text, remarks = program(path, units=units)
    for remark in remarks:
        warnings.warn(f"{path}: {remark}", stacklevel=2)
    return loads(text, name=f"{Path(path).stem}.sdl")


def _text(found: Imported, name: str, units: str) -> str:
    lines = [f"# {name}", f'Model info(units = "{units}");']
    trimmed = sum(not face.natural for face in found.faces)
    most = min(_FINEST, int(np.sqrt(_CELLS / max(trimmed, 1))))
    goal = _NEAR * _size(found) if found.faces else 1.0
    taken = {face.name for face in found.faces} | set(found.curves)
    for face in found.faces:
        if face.natural:
            lines += _whole(face, taken)
        else:
            lines += _trimmed(face, taken, _finer(face, goal, most))
    lines += joins(found, taken)
    lines += [curve.to_sdl(label) for label, curve in found.curves.items()]
    return "\n".join(lines) + "\n"


def _size(found: Imported) -> float:
    points = np.concatenate([face.surface.points.reshape(-1, 3) for face in found.faces])
    return float(np.linalg.norm(np.ptp(points, axis=0)))


_POLE = 1e-9
"""Control points of an edge within this share of the size are one point."""


def _whole(face: ImportedFace, taken: set[str]) -> list[str]:
    """A surface; an edge that is one point has one point object, by which panels know the pole."""
    points = face.surface.points
    near = _POLE * float(np.ptp(points.reshape(-1, 3), axis=0).max())
    numbers = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    lines: list[str] = []
    named: dict[int, str] = {}
    for edge in (numbers[:, 0], numbers[-1], numbers[:, -1], numbers[0]):
        places = points.reshape(-1, 3)[edge]
        if np.ptp(places, axis=0).max() > near:
            continue
        pole = f"{face.name}_pole{len(lines) + 1}"
        while pole in taken:
            pole += "_"
        taken.add(pole)
        at = ", ".join(map(_plain, places.mean(axis=0)))
        lines.append(f"AbsPoint {pole}({at}, visible = 0);")
        named |= dict.fromkeys(edge.tolist(), pole)
    text = face.surface._statement(face.name, named)
    return [*lines, text.removesuffix(");") + ", orientation = 1);" if face.reversed else text]


_USUAL, _FINEST = 12, 40
"""Divisions of a trimmed surface: where none are stated, and at most."""

_CELLS = 50_000
"""Divisions of all trimmed surfaces, about at most."""

_NEAR = 2e-5
"""Triangles are to be within this share of the body's size from their surface."""


def _finer(face: ImportedFace, goal: float, most: int) -> dict[str, int]:
    """The divisions that a trimmed face needs for triangles near its surface, beyond the usual."""
    t = np.linspace(0, 1, 2 * _USUAL + 1)
    sides = [np.clip(trace(t), 0, 1) for cycle in face.loops for _, _, trace in cycle]
    low, high = np.min(np.concatenate(sides), axis=0), np.max(np.concatenate(sides), axis=0)
    # The divisions are those of the whole surface.
    u, v = np.meshgrid(t, t, indexing="ij")
    net = face.surface(u.ravel(), v.ravel()).reshape(len(t), len(t), 3)
    counts = {}
    for name, chords, axis in (("nu", net, 1), ("nv", net.swapaxes(0, 1), 0)):
        kept = (t >= low[axis]) & (t <= high[axis])
        apart = chords[1::2] - (chords[:-1:2] + chords[2::2]) / 2
        off = float(np.linalg.norm(apart[:, kept], axis=-1).max(initial=0))
        counts[name] = min(int(np.ceil(_USUAL * np.sqrt(off / goal))), most)
    return {name: count for name, count in counts.items() if count > _USUAL}


def _trimmed(face: ImportedFace, taken: set[str], finer: dict[str, int]) -> list[str]:
    base = f"{face.name}_surface"
    while base in taken:
        base += "_"
    taken.add(base)
    lines = [face.surface.to_sdl(base).replace(");", ", visible = 0);")]
    names = []
    for c, cycle in enumerate(face.loops):
        ends = [f"{face.name}_p{c}_{k}" for k in range(len(cycle))]
        # The magnet at which a side begins is that at which the one before ends.
        for k, (_, backwards, trace) in enumerate(cycle):
            start = trace.points[-1 if backwards else 0]
            lines.append(
                f"AbsMagnet {ends[k]}({base}, {_plain(start[0])}, {_plain(start[1])}, visible = 0);"
            )
        for k, (_, backwards, trace) in enumerate(cycle):
            own = trace if not backwards else _turned(trace)
            label = f"{face.name}_s{c}_{k}"
            inner = []
            for i, p in enumerate(own.points[1:-1]):
                magnet = f"{label}_{i}"
                lines.append(
                    f"AbsMagnet {magnet}({base}, {_plain(p[0])}, {_plain(p[1])}, visible = 0);"
                )
                inner.append(magnet)
            control = [ends[k], *inner, ends[(k + 1) % len(cycle)]]
            text = f"NURBSnake {label}({_braced(control)}, {own.degrees[0]}, "
            text += _braced(map(_plain, own.knots[0]))
            if own.weights is not None:
                text += f", weights = {_braced(map(_plain, own.weights))}"
            lines.append(_wrapped(text + ", visible = 0);"))
            names.append(label)
    turned = "".join(f", {name} = {count}" for name, count in finer.items())
    turned += ", orientation = 1" if face.reversed else ""
    lines.append(_wrapped(f"TrimSurf {face.name}({base}, {_braced(names)}{turned});"))
    return lines


def _turned(trace: Nurbs) -> Nurbs:
    weights = None if trace.weights is None else trace.weights[::-1]
    return Nurbs(trace.degrees, (1 - trace.knots[0][::-1],), trace.points[::-1], weights)


explain(globals())
