"""``moldloft fair MODEL:OBJECT``: an object of a model as the source of a fairing."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft.cli.fair import Source, commit_file, curve_options, fair_grid, known_ending
from moldloft.errors import Error

if TYPE_CHECKING:
    from moldloft.fairing import Fairing, SurfaceFairing

__all__ = ["ObjectSource"]


class ObjectSource(Source):
    """An object of a model: a curve, a surface, or rows of points."""

    def __init__(self, model: str, name: str, options: argparse.Namespace) -> None:
        from moldloft.fairing.objects import sampled
        from moldloft.loading import load

        if isinstance(options.tol, list):
            raise Error("--tol FILE is for points: those of an object are sampled")
        if options.units:
            raise Error("--units is for files of points: a model states its own")
        loaded = load(model, library=options.library)
        if options.set:
            loaded.set(dict(options.set))
        self.title = f"{model}:{name}"
        self.unit = loaded.length_unit[0]
        self.made = sampled(loaded, name, options.tol)
        self.error = self.made.error

    def fair(self, options: argparse.Namespace) -> Fairing | SurfaceFairing:
        """The result by these options."""
        from moldloft.fairing import fair

        made = self.made
        if made.points.ndim == 3:
            return fair_grid(made.points, options.role or made.role, options)
        if made.closed:
            options.closed = True
        chosen = curve_options(options, len(made.points), options.role or made.role)
        if not options.breaks and made.breaks:
            chosen["breaks"] = made.breaks
        if made.role == "fit" and not made.breaks:
            chosen["spacing"] = "index"
        if (options.role or made.role) == "fit" and options.mode == "optimum":
            # The object itself is what the tolerance is about, between its points too.
            chosen["bound"] = options.bound or "curve"
        return fair(made.points, options.tol, as_=options.role or made.role, **chosen)

    def facts(self) -> dict[str, Any]:
        """The source, and the distance of the points from the object."""
        return {"source": self.title, "fit_error": self.error}

    def notes(self) -> list[str]:
        """Distance of the object from the curve through its points."""
        if self.error is None:
            return []
        count = " x ".join(str(n) for n in self.made.points.shape[:-1])
        return [
            f"{count} points of the object were fitted; the error between them is {self.error:.2e}"
        ]

    def write(self, result: Any, path: Path) -> Path:
        """Writes the result and returns its path."""
        if self.made.points.ndim == 3:
            if path.suffix.lower() == ".vts":
                result.write_vtk(path)
                return path
            from moldloft.grids import write_plot3d

            return write_plot3d(path, [result.points])
        from moldloft.fairing.files import points_text
        from moldloft.fairing.spline_files import SPLINES, encoded

        known_ending(path, None)
        if path.suffix.lower() in SPLINES:
            return commit_file(path, encoded([result.spline], path, self.unit))
        delimiter = {".csv": ",", ".tsv": "\t"}.get(path.suffix.lower(), " ")
        return commit_file(path, points_text(result.points, None, delimiter).encode())
