"""Spline curves and their interrogation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import points_of, refuse_repeats

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Samples", "Spline", "divided_differences", "grid_metric", "monotone_runs"]

PER_SPAN = 16
"""Samples on each span where curvatures are counted."""


@dataclass(frozen=True)
class Samples:
    """A curve at several parameters."""

    t: Floats
    """Parameters in [0, 1], ``(n,)``."""
    points: Floats
    """Positions, ``(n, 3)``."""
    first: Floats
    """First derivatives by t, ``(n, 3)``."""
    second: Floats
    """Second derivatives by t, ``(n, 3)``."""
    third: Floats
    """Third derivatives by t, ``(n, 3)``."""
    curvature: Floats
    """Curvature, ``(n,)``: of a plane curve positive where it turns left seen against +z (or
    against the plane's normal nearest to it), of others not signed. 0 where the tangent
    still."""
    torsion: Floats
    """Torsion, ``(n,)``; 0 at inflections."""
    curvature_slope: Floats
    """Derivative of the curvature of a plane curve by arc length, ``(n,)``; NaN for others."""
    plane: tuple[float, float, float] | None
    """Unit normal of a plane curve; ``None`` for others."""

    @property
    def arc(self) -> Floats:
        """Fraction of the length of the polyline up to each point, from 0 to 1."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        sums = np.concatenate([[0.0], np.cumsum(steps)])
        return sums / sums[-1] if sums[-1] > 0 else sums


class Spline:
    """A spline curve of any degree and knots, open or closed, with or without weights.

    Parameters
    ----------
    control_points
        ``(n, 2)`` or ``(n, 3)``, at least ``degree + 2`` of them (closed: ``2 degree + 2``).
    degree
        The polynomial degree.
    knots
        ``n + degree + 1`` non-decreasing knots, of a closed curve n increasing ones. Without them
        they are uniform: clamped, so that the curve begins and ends at control points, or not.
    weights
        Positive weights of a rational curve.
    closed
        True for a closed curve.
    clamped
        True if uniform knots of an open curve are clamped.
    period
        Of closed curves with knots: how far the first knot is from itself, once round.

    Examples
    --------
    >>> import numpy as np
    >>> c = Spline([(0, 0), (1, 2), (2, 2), (3, -2), (4, 0)])
    >>> c([0.0, 1.0])
    array([[0., 0., 0.],
           [4., 0., 0.]])
    >>> c.inflections()
    1
    >>> Spline.interpolate(c(np.linspace(0, 1, 9)))(0.5).round(3)
    array([2.061, 0.855, 0.   ])
    """

    def __init__(
        self,
        control_points: ArrayLike,
        *,
        degree: int = 3,
        knots: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        closed: bool = False,
        clamped: bool = True,
        period: float | None = None,
    ) -> None:
        points, _ = points_of(control_points)
        form = "closed" if closed else ("clamped" if clamped else "floating")
        floats = [None if a is None else np.asarray(a, np.float64) for a in (knots, weights)]
        self._core = _core.Spline(points, degree, form, floats[0], floats[1], period)

    @classmethod
    def _of(cls, core: _core.Spline) -> Spline:
        spline = cls.__new__(cls)
        spline._core = core
        return spline

    @classmethod
    def interpolate(
        cls,
        points: ArrayLike,
        *,
        degree: int = 3,
        spacing: str = "chord",
        closed: bool = False,
        breaks: Sequence[int] = (),
    ) -> Spline:
        """The spline through points.

        Parameters
        ----------
        points
            ``(n, 2)`` or ``(n, 3)``; a closed curve does not repeat the first.
        degree
            The polynomial degree.
        spacing
            Parametrisation of the points: ``"chord"``, ``"centripetal"`` or ``"index"``.
        closed
            True for a closed curve.
        breaks
            Points, from 0, at which the curve may have corners. A closed curve with breaks becomes
            an open one that begins and ends at the first of them.

        Returns
        -------
        Spline
            A new curve.
        """
        return cls._interpolated(points, degree, spacing, closed, breaks)[0]

    @classmethod
    def _interpolated(
        cls, points: ArrayLike, degree: int, spacing: str, closed: bool, breaks: Sequence[int]
    ) -> tuple[Spline, Floats, list[int]]:
        """The spline, its data's parameters and the control points that are breaks."""
        rows, _ = points_of(points)
        refuse_repeats(rows, closed)
        core, at, marks = _core.Spline.interpolate(
            rows, degree, spacing, closed, [int(b) for b in breaks], (0.0, 0.0, 0.0)
        )
        return cls._of(core), at, marks

    @classmethod
    def least_squares(
        cls,
        points: ArrayLike,
        count: int,
        *,
        degree: int = 3,
        spacing: str = "chord",
        closed: bool = False,
    ) -> Spline:
        """The spline with ``count`` control points nearest to points in the sum of squares.

        Parameters
        ----------
        points
            Points ``(n, 2)`` or ``(n, 3)`` in order.
        count
            The number of control points.
        degree
            Polynomial degree.
        spacing
            ``"chord"``, ``"centripetal"``, ``"index"``, or an axis, ``"x"`` to ``"z"``.
        closed
            True if the curve closes.

        Returns
        -------
        Spline
            A new curve.
        """
        rows, _ = points_of(points)
        refuse_repeats(rows, closed)
        return cls._of(_core.Spline.least_squares(rows, degree, count, spacing, closed)[0])

    @classmethod
    def fit(
        cls,
        points: ArrayLike,
        *,
        degree: int = 3,
        knots: ArrayLike | None = None,
        count: int | None = None,
        weights: ArrayLike | None = None,
        closed: bool = False,
        period: float | None = None,
        spacing: str = "chord",
        at: ArrayLike | None = None,
    ) -> Spline:
        """The spline with given knots and weights nearest to points.

        It passes through them when it has as many control points as there are points.

        Parameters
        ----------
        points
            ``(n, 2)`` or ``(n, 3)``.
        degree, knots, closed, period
            As for :class:`Spline`. Without knots those of an interpolation, or ``count`` uniform.
        count
            The number of control points, where there are no knots.
        weights
            Positive weights, one per control point, constant: a rational curve.
        spacing
            Parametrisation of the points.
        at
            The parameters themselves, rising, in [0, 1].

        Returns
        -------
        Spline
            A new curve.

        Examples
        --------
        >>> import numpy as np
        >>> angle = np.linspace(0, np.pi / 2, 30)
        >>> arc = Spline.fit(
        ...     np.column_stack([np.cos(angle), np.sin(angle)]),
        ...     degree=2, knots=[0, 0, 0, 0.5, 1, 1, 1], weights=[1, 0.9, 0.9, 1],
        ... )
        >>> arc.weights
        array([1. , 0.9, 0.9, 1. ])
        >>> bool(abs(np.linalg.norm(arc(np.linspace(0, 1, 9)), axis=1) - 1).max() < 3e-3)
        True
        """
        return cls._fit(points, degree, knots, count, weights, closed, period, spacing, at)[0]

    @classmethod
    def _fit(
        cls,
        points: ArrayLike,
        degree: int,
        knots: ArrayLike | None,
        count: int | None,
        weights: ArrayLike | None,
        closed: bool,
        period: float | None,
        spacing: str,
        at: ArrayLike | None,
    ) -> tuple[Spline, Floats]:
        """The spline and its data's parameters."""
        rows, _ = points_of(points)
        own, w, t = (
            None if a is None else np.ascontiguousarray(np.asarray(a, np.float64).ravel())
            for a in (knots, weights, at)
        )
        if t is None:
            refuse_repeats(rows, closed)
        elif len(t) != len(rows) or not (np.diff(t) > 0).all() or t[0] < 0 or t[-1] > 1:
            raise FairingError(f"expected {len(rows)} rising parameters in [0, 1]")
        if own is not None:
            count = len(own) if closed else len(own) - degree - 1
        elif count is None:
            through, t, _ = cls._interpolated(rows, degree, spacing, closed, ())
            own, count = through.knots, len(rows)
            low, high = through.domain
            period = high - low
        if closed and own is not None and period is None:
            raise FairingError("a closed curve with knots needs a period")
        if not degree + 1 <= count <= len(rows):
            raise FairingError(
                f"expected {degree + 2} to {len(rows)} control points, as many as there "
                f"are points at most; found {count}"
            )
        form = "closed" if closed else "clamped"
        core, parameters, _, _ = _core.Spline.fit(
            rows, degree, count, form, own, w, period, spacing, t
        )
        return cls._of(core), parameters

    @property
    def degree(self) -> int:
        """The polynomial degree."""
        return self._core.degree

    @property
    def knots(self) -> Floats:
        """The knots: all of an open curve, one period of a closed one."""
        return self._core.knots

    @property
    def control_points(self) -> Floats:
        """The control points, ``(n, 3)``."""
        return self._core.control_points

    @property
    def weights(self) -> Floats | None:
        """The weights of a rational curve."""
        return self._core.weights

    @property
    def closed(self) -> bool:
        """True if the curve is closed."""
        return self._core.closed

    @property
    def domain(self) -> tuple[float, float]:
        """The knot values at t = 0 and t = 1."""
        return self._core.domain

    def open_form(self) -> tuple[Floats, Floats, list[float] | None]:
        """Knots over [0, 1], control points and weights of the curve as an open spline.

        A closed curve is converted to this form for other programs.

        Returns
        -------
        tuple
            Knots ``(n + degree + 1,)``, control points ``(n, 3)``, weights or None.
        """
        return self._core.open_form()

    def at(self, t: ArrayLike) -> Samples:
        """Position, derivatives, curvature and torsion at parameters in [0, 1].

        Parameters
        ----------
        t
            Parameters in [0, 1], of any shape.

        Returns
        -------
        Samples
            Arrays ``(k,)`` and ``(k, 3)``, one row for each parameter.
        """
        flat = np.ascontiguousarray(np.asarray(t, np.float64).ravel())
        return Samples(**self._core.at(flat))

    def samples(self, per_span: int = PER_SPAN) -> Samples:
        """As :meth:`at`, ``per_span + 1`` times on each span, with both sides of each knot.

        Parameters
        ----------
        per_span
            Samples on each span of the curve.

        Returns
        -------
        Samples
            Arrays ``(k,)`` and ``(k, 3)``.
        """
        return Samples(**self._core.spans(per_span))

    def __call__(self, t: ArrayLike) -> Floats:
        """Positions at parameters in [0, 1], of their shape and three coordinates."""
        shape = np.shape(t)
        return self.at(t).points.reshape(*shape, 3)

    def curvature(self, t: ArrayLike) -> Floats:
        """Curvature at parameters in [0, 1]; see :attr:`Samples.curvature`.

        Parameters
        ----------
        t
            Parameters in [0, 1], of any shape.

        Returns
        -------
        numpy.ndarray
            Shape ``(k,)``, per unit of length; of plane curves with its sign.
        """
        return self.at(t).curvature.reshape(np.shape(t))

    def torsion(self, t: ArrayLike) -> Floats:
        """Torsion at parameters in [0, 1].

        Parameters
        ----------
        t
            Parameters in [0, 1], of any shape.

        Returns
        -------
        numpy.ndarray
            Shape ``(k,)``, per unit of length.
        """
        return self.at(t).torsion.reshape(np.shape(t))

    @property
    def length(self) -> float:
        """Its length."""
        return self._core.length()

    def comb(self, scale: float | None = None, per_span: int = 8) -> tuple[Floats, Floats]:
        """The curvature comb: feet on the curve and tips at distance ``scale`` times curvature.

        Parameters
        ----------
        scale
            Square of a length; by default such that the longest tooth is a tenth of the curve's
            extent.
        per_span
            Teeth on each span.

        Returns
        -------
        tuple of two arrays
            Feet and tips, ``(k, 3)`` each. The tips of a plane curve are on the outside of the
            bend.
        """
        if scale is None:
            samples = self.samples(per_span)
            extent = float(np.ptp(samples.points, axis=0).max())
            largest = float(np.abs(samples.curvature).max())
            scale = 0.1 * extent / largest if largest > 0 else 0.0
        return self._core.comb(scale, per_span)

    def jumps(self) -> tuple[Floats, Floats]:
        """Jumps of the highest derivative: parameters ``(k,)`` and jump vectors ``(k, 3)``.

        Independent of the parameter's unit: for uniform cubics, the fourth difference of the
        control points.

        Returns
        -------
        tuple of two numpy.ndarray
            Parameters and vectors, in rising order.
        """
        return self._core.jumps()

    def measure(self, name: str) -> float:
        """A measure of unfairness, as in :func:`~moldloft.fairing.fair`.

        Parameters
        ----------
        name
            The name of a measure, as for :func:`~moldloft.fairing.fair`.

        Returns
        -------
        float
            In the unit of its definition; 0 is ideal.
        """
        return self._core.measure(name)

    def monotone_pieces(self, share: float = 1e-3, per_span: int = PER_SPAN) -> int:
        """Number of monotone pieces of the curvature.

        Reversals below a fraction of its range are ignored.

        Parameters
        ----------
        share
            Fraction of the range of values below which a reversal is ignored.
        per_span
            Samples on each span of the curve.

        Returns
        -------
        int
            1 where the curvature only rises or only falls.
        """
        return self._core.monotone_pieces(share, per_span)

    def inflections(self, per_span: int = PER_SPAN) -> int:
        """Number of sign changes of the curvature.

        Parameters
        ----------
        per_span
            Samples on each span of the curve.

        Returns
        -------
        int
            Reversals below the fraction that reports ignore do not count.
        """
        return self._core.inflections(per_span)

    def logarithmic_curvature(self, per_span: int = PER_SPAN) -> Floats:
        """The logarithmic curvature graph of a plane curve, ``(k, 2)``.

        Rows of log of the radius of curvature and log of |radius ds / d radius|: a straight line of
        slope -1 for a clothoid, 1 for a logarithmic spiral, 2 for the involute of a circle.

        Parameters
        ----------
        per_span
            Samples on each span of the curve.

        Returns
        -------
        numpy.ndarray
            Columns log(radius) and log(d(length)/d(log radius)).
        """
        return self._core.logarithmic(per_span)

    def orthotomic(self, p: ArrayLike, k: float = 2.0, per_span: int = PER_SPAN) -> Floats:
        """The k-orthotomic for a point p, ``(m, 3)``.

        It has cusps exactly at inflections, unless p is on a tangent.

        Parameters
        ----------
        p
            The point, ``(3,)``.
        k
            The factor of the distance to the tangent.
        per_span
            Samples on each span of the curve.

        Returns
        -------
        numpy.ndarray
            Points, in the order of the parameters.
        """
        point, _ = points_of([np.asarray(p, np.float64).ravel()])
        return self._core.orthotomic([float(c) for c in point[0]], k, per_span)

    def findings(self) -> list[Any]:
        """Corners and single wrong control points, found by the jumps.

        Returns
        -------
        list
            Each with its position, its kind and its prominence.
        """
        from moldloft.fairing.report import Finding

        return [Finding.of(row) for row in self._core.findings()]

    def __repr__(self) -> str:
        kind = "closed " if self.closed else ""
        return f"<{kind}spline of degree {self.degree}, {len(self.control_points)} control points>"


def monotone_runs(values: ArrayLike, share: float = 1e-3) -> int:
    """Number of monotone pieces of a list, without reversals below a fraction of its range.

    Parameters
    ----------
    values
        The list, ``(n,)``.
    share
        Fraction of the range of values below which a reversal is ignored.

    Returns
    -------
    int
        1 for a list that only rises or only falls.

    Examples
    --------
    >>> monotone_runs([0, 1, 2, 1.9999, 3, 1])
    2
    """
    return _core.monotone_runs(np.ascontiguousarray(values, np.float64), share)


def divided_differences(points: ArrayLike, t: ArrayLike) -> Floats:
    """Second divided differences of points at rising parameters, ``(n - 2, 3)``.

    Parameters
    ----------
    points
        Points ``(n, 2)`` or ``(n, 3)``.
    t
        Their parameters, increasing, ``(n,)``.

    Returns
    -------
    numpy.ndarray
        Vectors, one for each point but the first and the last.

    Examples
    --------
    >>> divided_differences([(0, 0), (1, 1), (3, 9)], [0, 1, 3])
    array([[0., 1., 0.]])
    """
    rows, _ = points_of(points)
    return _core.divided_differences(rows, np.ascontiguousarray(t, np.float64))


def grid_metric(grid: ArrayLike) -> Floats:
    """The metric eta_y of a plane grid, ``(m, n)``: the density of its lines normal to the body.

    Parameters
    ----------
    grid
        ``(m, n, 2)`` or ``(m, n, 3)``, i along the body and j away from it; z is not looked at.

    Returns
    -------
    numpy.ndarray
        Of the shape of the grid.
    """
    points, _ = points_of(grid, 3)
    m, n = points.shape[:2]
    return _core.eta_y(points.reshape(-1, 3), m, n).reshape(m, n)


explain(globals())
