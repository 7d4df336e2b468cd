"""An overlay: content of a file of another program, in the model's unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model
    from moldloft.overlays.deviation import Deviation
    from moldloft.shapes.nurbs import Nurbs

    Floats = NDArray[np.float64]

__all__ = ["Overlay"]


def _no_points() -> Floats:
    return np.empty((0, 3))


def _no_faces() -> NDArray[np.uint32]:
    return np.empty((0, 4), dtype=np.uint32)


@dataclass(frozen=True, eq=False)
class Overlay:
    """Reference geometry: points, faces between them, and curves."""

    name: str
    """The name of the file."""
    points: Floats = field(default_factory=_no_points)
    """Vertices of faces, or points without faces: ``(n, 3)``."""
    faces: NDArray[np.uint32] = field(default_factory=_no_faces)
    """Four corners of each face, a triangle repeats its last: ``(m, 4)``."""
    groups: tuple[tuple[str, int, int], ...] = ()
    """Ranges of faces by name: first, and one past the last."""
    curves: Mapping[str, Nurbs] = field(default_factory=dict)
    """Curves by name, exact."""
    remarks: tuple[str, ...] = ()
    """Omitted or doubtful content of the file."""

    def scaled(self, factor: float) -> Overlay:
        """The overlay in another unit: every length times a factor.

        Parameters
        ----------
        factor
            A positive number.

        Returns
        -------
        Overlay
            A new one; this stays as it is.
        """
        if not (np.isfinite(factor) and factor > 0):
            raise Error(f"a scale is a positive number, not {factor}")
        curves = {
            name: replace(c, points=c.points * factor, error=c.error * factor)
            for name, c in self.curves.items()
        }
        return replace(self, points=self.points * factor, curves=curves)

    def samples(self, per_curve: int = 101) -> Floats:
        """The points, and points of the curves at equal steps of the parameter: ``(n, 3)``.

        Parameters
        ----------
        per_curve
            Points of each curve, at least 2.

        Returns
        -------
        numpy.ndarray
            In the overlay's unit.
        """
        if per_curve < 2:
            raise Error(f"per_curve: expected 2 points or more, found {per_curve}")
        t = np.linspace(0, 1, per_curve)
        return np.concatenate([self.points, *(c(t) for c in self.curves.values())])

    def deviation(self, model: Model, *, objects: Sequence[str] | str = ()) -> Deviation:
        """Distance of each sample from the surfaces of a model.

        See :func:`moldloft.overlays.deviation`.

        Parameters
        ----------
        model
            The model.
        objects
            Names of its surfaces; by default all that it shows.

        Returns
        -------
        Deviation
            For each sample its foot, its signed distance and the surface.
        """
        from moldloft.overlays.deviation import deviation

        return deviation(model, self.samples(), objects=objects)

    def to_sdl(self) -> str:
        """Statements that declare the curves, as ``NURBCurve``, to build upon.

        Returns
        -------
        str
            A line for each curve.
        """
        if not self.curves:
            raise Error(f"`{self.name}` contains no curve; points and faces can only be overlays")
        return "\n".join(c.to_sdl(name) for name, c in self.curves.items()) + "\n"

    def to_pyvista(self) -> Any:
        """The faces, or the points if there are no faces, as ``pyvista.PolyData``.

        Returns
        -------
        pyvista.PolyData
            In the overlay's unit.
        """
        from moldloft.adapters import polydata

        return polydata(self.points, self.faces)

    def __repr__(self) -> str:
        what = [(len(self.points), "point"), (len(self.faces), "face"), (len(self.curves), "curve")]
        said = [f"{n} {word}{'s' * (n != 1)}" for n, word in what if n]
        return f"<Overlay {self.name}: {', '.join(said)}>"


explain(globals())
