"""Derivatives, normals and curvatures of curves and surfaces on arrays of parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import ModelError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft import _core

    Floats = NDArray[np.float64]

__all__ = ["CurveCalculus", "SurfaceCalculus", "parameter"]

_ROUNDING = 1e-9
"""Parameters this far outside [0, 1] are there by rounding."""


def parameter(name: str, values: ArrayLike, beyond: bool) -> Floats:
    """Parameters as an array of finite numbers, in [0, 1] unless values beyond are allowed.

    Parameters
    ----------
    name
        Name of the parameter in messages.
    values
        The parameters.
    beyond
        True to allow values outside [0, 1], where formulas are continued.
    """
    at = np.asarray(values, dtype=np.float64)
    if not np.isfinite(at).all():
        raise ModelError(f"{name} is not finite: found {at[~np.isfinite(at)].flat[0]}")
    outside = (at < -_ROUNDING) | (at > 1 + _ROUNDING)
    if not beyond and outside.any():
        raise ModelError(
            f"{name} = {at[outside].flat[0]:g} is outside [0, 1]\n"
            "help: beyond=True continues the shape's formula there"
        )
    return at


class CurveCalculus:
    """Derivatives and lengths of curves and snakes at parameters."""

    if TYPE_CHECKING:
        name: str

        @property
        def _document(self) -> _core.Document: ...

    def derivative(self, t: ArrayLike, order: int = 1, *, beyond: bool = False) -> Floats:
        """Derivatives of the position with respect to ``t``, ``(…, 3)``.

        Parameters
        ----------
        t
            Parameters in [0, 1], of shape ``(…)``.
        order
            1 or 2.
        beyond
            Take parameters outside [0, 1] too, where the formula is continued.

        Returns
        -------
        ndarray
            ``(…, 3)``, in the model's unit.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); Line edge(A, B);")
        >>> m["edge"].derivative([0.2, 0.7])
        array([[2., 0., 0.],
               [2., 0., 0.]])
        """
        if order not in (1, 2):
            raise ModelError(f"derivatives of a curve are of order 1 or 2, not {order}")
        at = parameter("t", t, beyond)
        found = self._document.curve_derivatives(self.name, np.ascontiguousarray(at.ravel()))
        return np.asarray(found[order - 1]).reshape(*at.shape, 3)

    def tangent(self, t: ArrayLike, *, beyond: bool = False) -> Floats:
        """Unit tangents, ``(…, 3)``; zero where the speed is zero.

        Parameters
        ----------
        t
            Parameters in [0, 1], of shape ``(…)``.
        beyond
            Take parameters outside [0, 1] too.

        Returns
        -------
        ndarray
            ``(…, 3)``, of length 1 or 0.
        """
        return _unit(self.derivative(t, beyond=beyond))

    def curvature(self, t: ArrayLike, *, beyond: bool = False) -> Floats:
        """Curvatures, ``(…)``, in 1 over the model's unit; ``nan`` where the speed is zero.

        Parameters
        ----------
        t
            Parameters in [0, 1], of shape ``(…)``.
        beyond
            Take parameters outside [0, 1] too.

        Returns
        -------
        ndarray
            ``(…)``, 0 or more.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(2, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 2, 0); Arc a(A, O, B, type = 2);
        ... ''')
        >>> m["a"].curvature([0.1, 0.9]).round(12).tolist()
        [0.5, 0.5]
        """
        first = self.derivative(t, beyond=beyond)
        second = self.derivative(t, 2, beyond=beyond)
        speed = np.linalg.norm(first, axis=-1)
        turned = np.linalg.norm(np.cross(first, second), axis=-1)
        still = speed == 0
        found: Floats = np.where(still, np.nan, turned / np.where(still, 1, speed) ** 3)
        return found


class SurfaceCalculus:
    """Derivatives, normals and curvatures of surfaces at parameters."""

    if TYPE_CHECKING:
        name: str

        @property
        def _document(self) -> _core.Document: ...

    def derivative(
        self, u: ArrayLike, v: ArrayLike, du: int = 0, dv: int = 0, *, beyond: bool = False
    ) -> Floats:
        """Derivatives of the position of order ``du`` in ``u`` and ``dv`` in ``v``: ``(…, 3)``.

        Parameters
        ----------
        u, v
            Parameters in [0, 1], which are broadcast, of shape ``(…)``.
        du, dv
            Orders, together at most 2.
        beyond
            Take parameters outside [0, 1] too, where the formula is continued.

        Returns
        -------
        ndarray
            ``(…, 3)``, in the model's unit.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... Line a({0, 0, 0}, {2, 0, 0}); Line b({0, 1, 0}, {2, 1, 4}); RuledSurf s(a, b);
        ... ''')
        >>> m["s"].derivative(0.5, [0, 1], 1, 0)
        array([[2., 0., 0.],
               [2., 0., 4.]])
        >>> m["s"].derivative(0.5, 0.5, 1, 1)
        array([0., 0., 4.])
        """
        orders = {(0, 0): 0, (1, 0): 1, (0, 1): 2, (2, 0): 3, (1, 1): 4, (0, 2): 5}
        if (du, dv) not in orders:
            raise ModelError(
                f"orders of derivatives of a surface are at least 0 and together at most 2, "
                f"not {du} and {dv}"
            )
        found, shape = self._jets(u, v, beyond)
        return found[orders[du, dv]].reshape(*shape, 3)

    def normal(self, u: ArrayLike, v: ArrayLike, *, beyond: bool = False) -> Floats:
        """Unit normals in the direction S_u x S_v, ``(…, 3)``; zero where the surface is singular.

        Parameters
        ----------
        u, v
            Parameters in [0, 1], which are broadcast, of shape ``(…)``.
        beyond
            Take parameters outside [0, 1] too.

        Returns
        -------
        ndarray
            ``(…, 3)``, of length 1 or 0.
        """
        found, shape = self._jets(u, v, beyond)
        return _unit(np.cross(found[1], found[2])).reshape(*shape, 3)

    def curvature(
        self, u: ArrayLike, v: ArrayLike, *, beyond: bool = False
    ) -> tuple[Floats, Floats]:
        """The principal curvatures, the greater one first, each ``(…)``.

        They are positive where the surface bends towards its normal S_u x S_v (do Carmo 1976,
        section 3-3), and ``nan`` where it is singular.

        Parameters
        ----------
        u, v
            Parameters in [0, 1], which are broadcast, of shape ``(…)``.
        beyond
            Take parameters outside [0, 1] too.

        Returns
        -------
        tuple of ndarray
            Two of shape ``(…)``, in 1 over the model's unit.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(2, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 2, 0); AbsPoint Z(0, 0, 1);
        ... Arc a(A, O, B, type = 2); Line up(O, Z); TranSurf tube(a, up);
        ... ''')
        >>> [round(float(k), 12) for k in m["tube"].curvature(0.3, 0.6)]
        [0.0, -0.5]
        """
        found, shape = self._jets(u, v, beyond)
        _, su, sv, suu, suv, svv = found
        normal = _unit(np.cross(su, sv))
        e, f, g = ((a * b).sum(axis=-1) for a, b in ((su, su), (su, sv), (sv, sv)))
        p, q, r = ((normal * x).sum(axis=-1) for x in (suu, suv, svv))
        area = e * g - f * f
        singular = ~normal.any(axis=-1) | (area <= 0)
        area = np.where(singular, 1, area)
        mean = np.where(singular, np.nan, (e * r - 2 * f * q + g * p) / (2 * area))
        gauss = (p * r - q * q) / area
        half = np.sqrt(np.maximum(mean * mean - gauss, 0))
        return (mean + half).reshape(shape), (mean - half).reshape(shape)

    def _jets(
        self, u: ArrayLike, v: ArrayLike, beyond: bool
    ) -> tuple[list[Floats], tuple[int, ...]]:
        us, vs = broadcast(parameter("u", u, beyond), parameter("v", v, beyond))
        flat = [np.ascontiguousarray(x.ravel()) for x in (us, vs)]
        return self._document.surface_derivatives(self.name, *flat), us.shape


def broadcast(u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Parameters u and v of a surface as arrays of the same shape."""
    try:
        us, vs = np.broadcast_arrays(u, v)
    except ValueError:
        raise ModelError(
            f"u of shape {u.shape} and v of shape {v.shape} do not broadcast to one shape"
        ) from None
    return us, vs


def _unit(vectors: Floats) -> Floats:
    size = np.linalg.norm(vectors, axis=-1, keepdims=True)
    found: Floats = vectors / np.where(size > 0, size, 1)
    return found


explain(globals())
