"""Normals, curvatures and reflections of a surface on a grid of parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.fairing.arrays import vector_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Look"]


class Look:
    """A surface on a grid of parameters: normals, curvatures, reflections.

    Made by :meth:`SplineSurface.look` and by :meth:`moldloft.Object.look`. Arrays are ``(m, n)`` or
    ``(m, n, 3)``, NaN where the surface is singular.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... AbsPoint A(1, 0, 0); AbsPoint B(1, 0, 2); AbsPoint C(0, 0, 0); AbsPoint D(0, 0, 2);
    ... Line l(A, B); Line axis(C, D); RevSurf tube(l, axis, 0, 3);
    ... ''')
    >>> look = m["tube"].look(5, 5)
    >>> bool(abs(look.gaussian).max() < 1e-12), abs(look.mean).round(12).max().item()
    (True, 0.5)
    """

    def __init__(self, core: _core.Look) -> None:
        self._core = core

    @property
    def points(self) -> Floats:
        """Positions."""
        return self._core.points

    @property
    def normals(self) -> Floats:
        """Unit normals in the direction S_u x S_v."""
        return self._core.normals

    @property
    def gaussian(self) -> Floats:
        """Gaussian curvature, the product of the principal ones: 0 on cylinders and cones."""
        return self._core.gaussian

    @property
    def mean(self) -> Floats:
        """Mean curvature, positive where the surface bends towards its normal: 0 on soap films."""
        return self._core.mean

    @property
    def principal(self) -> tuple[Floats, Floats]:
        """The principal curvatures, the larger first."""
        return self._core.largest, self._core.smallest

    @property
    def absolute(self) -> Floats:
        """Sum of the principal curvatures' sizes: 0 on planes only."""
        return self._core.absolute

    def isophotes(self, light: ArrayLike = (0, 0, 1)) -> Floats:
        """The cosine between normal and light, whose level lines are the isophotes.

        Parameters
        ----------
        light
            Direction of the light, ``(3,)``.
        """
        return self._core.isophote(vector_of(light))

    def highlight(self, point: ArrayLike, along: ArrayLike) -> Floats:
        """Signed distance of the normal from a light line.

        It is 0 on the highlight line and small on the highlight band.

        Parameters
        ----------
        point
            A point of the line, ``(3,)``.
        along
            Direction of the line, ``(3,)``.
        """
        return self._core.highlight(vector_of(point), vector_of(along))

    def reflection(self, view: ArrayLike, point: ArrayLike, along: ArrayLike) -> Floats:
        """Zero where a distant observer in direction ``view`` sees the reflected line.

        Parameters
        ----------
        view
            Direction towards the eye, ``(3,)``.
        point
            A point of the line, ``(3,)``.
        along
            Direction of the line, ``(3,)``.
        """
        return self._core.reflection(vector_of(view), vector_of(point), vector_of(along))

    def zebra(
        self, view: ArrayLike = (0, 0, 1), axis: ArrayLike = (1, 0, 0), stripes: float = 8
    ) -> Floats:
        """Stripes, 1 and -1, by the angle of the mirrored view round an axis.

        Parameters
        ----------
        view
            Direction towards the eye, ``(3,)``.
        axis
            The axis of the stripes, ``(3,)``.
        stripes
            The number of stripes in a full turn.
        """
        return self._core.zebra(vector_of(view), vector_of(axis), stripes)

    def orthotomic(self, p: ArrayLike, k: float = 2.0) -> Floats:
        """The k-orthotomic surface of a point: singular where the Gaussian curvature is 0.

        Parameters
        ----------
        p
            The point, ``(3,)``.
        k
            The factor of the distance to the tangent.
        """
        return self._core.orthotomic(vector_of(p), k)

    def fields(self) -> dict[str, Floats]:
        """The curvatures by name, for files of viewers."""
        largest, smallest = self.principal
        return {
            "gaussian_curvature": self.gaussian,
            "mean_curvature": self.mean,
            "largest_curvature": largest,
            "smallest_curvature": smallest,
            "isophote": self.isophotes(),
            "zebra": self.zebra(),
            "normal": self.normals,
        }


explain(globals())
