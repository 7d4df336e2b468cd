"""Fairing of surfaces, with their normals, curvatures and reflections."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction, points_of, radii, too_large, vector_of
from moldloft.fairing.asked import EXACT, only_data, stays_near
from moldloft.fairing.findings import along_lines, grid_lines, lines_exact
from moldloft.fairing.look import Look
from moldloft.fairing.report import Finding, certificate_of, claims_optimum, lines_of

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["SplineSurface", "SurfaceFairing", "fair_surface"]


class SplineSurface:
    """A tensor-product spline surface.

    Parameters
    ----------
    control_points
        ``(m, n, 3)``, at least degree + 2 in each direction.
    degree
        The polynomial degree, or two of them.
    knots
        Two knot vectors; without them they are uniform.
    weights
        Positive weights ``(m, n)`` of a rational surface.
    closed
        True if it is closed along u and v.
    clamped
        True if uniform knots are clamped.
    periods
        Of closed directions with knots: how far the first knot is from itself, once round.
    """

    def __init__(
        self,
        control_points: ArrayLike,
        *,
        degree: int | tuple[int, int] = 3,
        knots: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
        weights: ArrayLike | None = None,
        closed: tuple[bool, bool] = (False, False),
        clamped: bool = True,
        periods: tuple[float | None, float | None] = (None, None),
    ) -> None:
        points, _ = points_of(control_points, 3)
        degrees = (degree, degree) if isinstance(degree, int) else degree
        forms = tuple("closed" if c else ("clamped" if clamped else "floating") for c in closed)
        ku, kv = (None if k is None else np.asarray(k, np.float64) for k in knots)
        w = None if weights is None else _weights(weights, points.shape[:2])
        self._core = _core.Net(
            points.reshape(-1, 3), degrees, points.shape[:2], forms, (ku, kv), periods, w
        )

    @classmethod
    def _of(cls, core: _core.Net) -> SplineSurface:
        surface = cls.__new__(cls)
        surface._core = core
        return surface

    @classmethod
    def interpolate(
        cls,
        points: ArrayLike,
        *,
        degree: int | tuple[int, int] = 3,
        closed: tuple[bool, bool] = (False, False),
        knots: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
        weights: ArrayLike | None = None,
        breaks: tuple[Sequence[int], Sequence[int]] = ((), ()),
    ) -> SplineSurface:
        """The surface through a grid of points ``(m, n, 3)`` at uniform parameters.

        Parameters
        ----------
        points
            The grid; a closed direction does not repeat its first row.
        degree, closed
            As for :class:`SplineSurface`.
        knots
            Knots of your own, of open directions. Fewer of them than interpolation needs give the
            nearest surface in the sum of squares instead.
        weights
            Positive weights of the control points, constant: a rational surface.
        breaks
            Rows of points along u and along v, from 0, at which it may have edges, in open
            directions without knots of their own.

        Returns
        -------
        SplineSurface
            A new surface.

        Examples
        --------
        >>> import numpy as np
        >>> angle = np.arange(16) * 2 * np.pi / 16
        >>> x, y = np.cos(angle), np.sin(angle)
        >>> rings = [np.stack([x, y, np.full(16, z)], axis=-1) for z in np.linspace(0, 2, 6)]
        >>> tube = SplineSurface.interpolate(np.stack(rings, axis=1), closed=(True, False))
        >>> bool(abs(np.linalg.norm(tube.grid(40, 9)[..., :2], axis=-1) - 1).max() < 1e-3)
        True
        """
        return cls._interpolated(points, degree, breaks, closed, knots, weights)[0]

    @classmethod
    def _interpolated(
        cls,
        points: ArrayLike,
        degree: int | tuple[int, int],
        breaks: tuple[Sequence[int], Sequence[int]],
        closed: tuple[bool, bool] = (False, False),
        knots: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
        weights: ArrayLike | None = None,
    ) -> tuple[SplineSurface, tuple[Floats, Floats], tuple[list[int], list[int]]]:
        net, _ = points_of(points, 3)
        degrees = (degree, degree) if isinstance(degree, int) else degree
        axes = [_Axis.of(*a) for a in zip(net.shape, degrees, closed, knots, breaks, strict=False)]
        forms: dict[str, Any] = {
            "degree": degrees,
            "closed": closed,
            "knots": (axes[0].knots, axes[1].knots),
            "periods": (axes[0].period, axes[1].period),
        }
        at = (axes[0].at, axes[1].at)
        if weights is None:
            for k, axis in enumerate(axes):
                net = axis.fitted(net, k)
            return cls(net, **forms), at, (axes[0].marks, axes[1].marks)
        # The homogeneous surface passes through the points times their denominator.
        shape = (axes[0].count, axes[1].count)
        each = _weights(weights, shape).reshape(shape)
        under = cls(np.stack([each, 0 * each, 0 * each], axis=-1), **forms)
        net = net * under.grid(*at)[..., :1]
        for k, axis in enumerate(axes):
            net = axis.fitted(net, k)
        surface = cls(net / each[..., None], weights=each, **forms)
        return surface, at, (axes[0].marks, axes[1].marks)

    @property
    def control_points(self) -> Floats:
        """The net, ``(m, n, 3)``."""
        return self._core.control_points.reshape(*self._core.shape, 3)

    @property
    def degrees(self) -> tuple[int, int]:
        """The degrees along u and v."""
        return self._core.degrees

    @property
    def closed(self) -> tuple[bool, bool]:
        """True if it is closed along u and v."""
        return self._core.closed

    @property
    def knots(self) -> tuple[Floats, Floats]:
        """The knots along u and v."""
        return self._core.knots()

    def look(self, u: ArrayLike = 41, v: ArrayLike = 41) -> Look:
        """Points of the surface at a grid of parameters, or at numbers of equally spaced ones.

        Parameters
        ----------
        u
            Parameters along u in [0, 1], or how many even ones.
        v
            Parameters along v in [0, 1], or how many even ones.

        Returns
        -------
        Look
            Normals, curvatures and reflections there.
        """
        return Look(self._core.look(_parameters(u), _parameters(v)))

    def grid(self, u: ArrayLike = 41, v: ArrayLike = 41) -> Floats:
        """Positions on a grid of parameters, ``(m, n, 3)``.

        Parameters
        ----------
        u
            Parameters along u in [0, 1], or how many even ones.
        v
            Parameters along v in [0, 1], or how many even ones.

        Returns
        -------
        numpy.ndarray
            In the order of the parameters.
        """
        return self.look(u, v).points

    def measure(self, name: str) -> tuple[float, float]:
        """A measure over the curves of the net along u, and over those along v.

        Parameters
        ----------
        name
            The name of a measure, as for :func:`~moldloft.fairing.fair`.

        Returns
        -------
        tuple of float
            The sums over the curves of each direction.
        """
        return self._core.measure(name)

    def __repr__(self) -> str:
        m, n = self._core.shape
        return f"<spline surface, net {m} x {n}>"


def _weights(given: ArrayLike, shape: tuple[int, ...]) -> Floats:
    weights = np.asarray(given, np.float64)
    if weights.shape != tuple(shape):
        raise FairingError(f"expected weights {tuple(shape)}, found {weights.shape}")
    bad = np.argwhere(~(np.isfinite(weights) & (weights > 0)))
    if len(bad):
        i, j = (int(k) for k in bad[0])
        raise FairingError(
            f"weight ({i + 1}, {j + 1}) is {weights[i, j]:g}, expected a positive number"
        )
    return np.ascontiguousarray(weights.ravel())


@dataclass
class _Axis:
    """Fit of the lines of a grid along one direction, common to all."""

    degree: int
    closed: bool
    knots: Floats
    period: float | None
    at: Floats
    """The parameters of the points, in [0, 1]."""
    marks: list[int]
    """The control points that are breaks."""
    breaks: list[int]
    own: bool
    """True if the knots are the user's."""

    @classmethod
    def of(
        cls, count: int, degree: int, closed: bool, knots: ArrayLike | None, breaks: Sequence[int]
    ) -> _Axis:
        rows = [int(b) for b in breaks]
        if rows and (closed or knots is not None):
            what = "a closed direction" if closed else "a direction with knots of its own"
            raise FairingError(f"{what} has no breaks of its points")
        line = np.column_stack([np.arange(count, dtype=np.float64), np.zeros((count, 2))])
        if knots is None:
            core, at, marks = _core.Spline.interpolate(
                line, degree, "index", closed, rows, (1.0, 0.0, 0.0)
            )
            low, high = core.domain
            period = high - low if closed else None
            return cls(degree, closed, core.knots, period, at, marks, rows, False)
        own = np.ascontiguousarray(np.asarray(knots, np.float64).ravel())
        if closed:
            raise FairingError("knots of your own are for open directions of a fit")
        at = np.arange(count) / (count - 1)
        axis = cls(degree, closed, own, None, at, [], rows, True)
        if not degree + 2 <= axis.count <= count:
            raise FairingError(
                f"expected {2 * degree + 3} to {count + degree + 1} knots for {count} "
                f"points, found {len(own)}"
            )
        return axis

    @property
    def count(self) -> int:
        """The number of control points."""
        return len(self.knots) if self.closed else len(self.knots) - self.degree - 1

    def fitted(self, net: Floats, axis: int) -> Floats:
        """The lines along an axis as control points."""
        lines = np.moveaxis(net, axis, 0)

        def one(line: Floats) -> Floats:
            if self.own:
                return _core.Spline.fit(
                    line,
                    self.degree,
                    self.count,
                    "clamped",
                    self.knots,
                    None,
                    None,
                    "index",
                    self.at,
                )[0].control_points
            made = _core.Spline.interpolate(
                line, self.degree, "index", self.closed, self.breaks, (1.0, 0.0, 0.0)
            )
            return made[0].control_points

        columns = [one(np.ascontiguousarray(lines[:, k])) for k in range(lines.shape[1])]
        return np.moveaxis(np.stack(columns, axis=1), 0, axis)


#: More along one direction are more points than a grid may have.
_MOST_PARAMETERS = 10_000_000


def _parameters(given: ArrayLike) -> Floats:
    if np.ndim(given) == 0:
        count = int(np.asarray(given))
        if count < 2:
            raise FairingError(f"expected 2 parameters or more, found {count}")
        if count > _MOST_PARAMETERS:
            raise FairingError(f"expected {_MOST_PARAMETERS} parameters or fewer, found {count}")
        return np.linspace(0, 1, count)
    return np.ascontiguousarray(given, np.float64)


@dataclass(frozen=True)
class SurfaceFairing:
    """A faired surface, with its report."""

    points: Floats
    """The faired grid, ``(m, n, 3)``: the net, or the surface at the parameters of the points."""
    surface: SplineSurface
    """The faired surface."""
    original: SplineSurface
    """The surface before."""
    data: Floats
    """The grid that was given."""
    tol: float | None
    """The largest tolerance; ``None`` for no limit."""
    as_: str
    """Meaning of the points: ``"control"`` or ``"fit"``."""
    mode: str
    """Fairing mode."""
    measure: str
    """The measure that was minimised."""
    measure_before: float
    """The measure over all curves of the net before."""
    measure_after: float
    """The measure of the result."""
    jumps_before: float
    """Sum of squared jumps over all curves of the net before."""
    jumps_after: float
    """Sum of squared jumps of the result."""
    jumps_along: tuple[tuple[float, float], tuple[float, float]]
    """The same over the curves along u and along v: before, after."""
    deviation_certified: float
    """No point of the surface is farther from its original than this."""
    deviation_sampled: float
    """The largest distance found by sampling."""
    extent: float
    """The diagonal of the box round the data."""
    value: float
    """The measure of the result, from the certificate."""
    gap: float
    """No surface within the tolerance has a measure below ``value - gap``."""
    passes: int | None
    """Passes of the faithful mode."""
    seconds: float
    """Time of the fairing."""
    goal: str = "fairest"
    """Goal: choice among the surfaces within the tolerances."""
    residuals: Floats | None = field(default=None, repr=False)
    """The distance of each point from the surface at its parameters, for fits."""
    used: float | None = None
    """The mean of the squared residuals over tolerances; 1 is noise that fills these evenly."""
    stayed: bool = False
    """True if exact points stayed in a mode that moves others."""

    @property
    def deviation_data(self) -> float:
        """Bound of the distance of the given points from the surface."""
        if self.residuals is not None:
            return float(self.residuals.max())
        return float(np.linalg.norm(self.points - self.data, axis=2).max())

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Wrong digits and knuckles found along the lines of a grid of data.

        Their index is that of the point, row by row, from 0; they do not affect the result.
        """
        if self.as_ != "fit":
            return ()
        m, n = self.data.shape[:2]
        found = along_lines(self.data.reshape(-1, 3), grid_lines((m, n), self.surface.closed))
        out = []
        for _, f in found:
            i, j = divmod(f.index, n)
            text = f.text.replace(f"point {f.index + 1}", f"point ({i + 1}, {j + 1})", 1)
            out.append(replace(f, text=text))
        return tuple(out)

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """Warnings and notes for the user."""
        stays = (EXACT,) if self.stayed else ()
        return (*too_large(self.tol, self.data), *stays)

    @property
    def gap_relative(self) -> float:
        """The gap relative to the measure (of at least a trillionth of the original one)."""
        size = max(self.value, 1e-12 * self.measure_before)
        return self.gap / size if size > 0 else 0.0

    @property
    def deviation_percent(self) -> float:
        """The certified deviation in percent of the extent."""
        return 100.0 * self.deviation_certified / self.extent if self.extent > 0 else 0.0

    def as_dict(self) -> dict[str, Any]:
        """The report as plain data, as printed by ``moldloft fair --json``."""
        (bu, au), (bv, av) = self.jumps_along
        return {
            "points": list(self.data.shape[:2]),
            "degree": list(self.surface.degrees),
            "closed": list(self.surface.closed),
            "as": self.as_,
            "mode": self.mode,
            "measure": self.measure,
            "tolerance": self.tol,
            "passes": self.passes,
            "goal": self.goal,
            "budget_used": self.used,
            "deviation_data": self.deviation_data,
            "deviation_certified": self.deviation_certified,
            "deviation_sampled": self.deviation_sampled,
            "deviation_percent": self.deviation_percent,
            "extent": self.extent,
            "measure_before": self.measure_before,
            "measure_after": self.measure_after,
            "jumps_before": self.jumps_before,
            "jumps_after": self.jumps_after,
            "jumps_u_before": bu,
            "jumps_u_after": au,
            "jumps_v_before": bv,
            "jumps_v_after": av,
            "value": self.value,
            "gap": self.gap,
            "gap_relative": self.gap_relative,
            "optimum_claimed": claims_optimum(self.gap, self.gap_relative),
            "findings": [
                {"kind": f.kind, "point": f.index + 1, "text": f.text} for f in self.findings
            ],
            "notes": list(self.notes),
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        (bu, au), (bv, av) = self.jumps_along
        rows = [
            (self.measure, f"{self.measure_before:.6e}", f"{self.measure_after:.6e}"),
            ("squared jumps", f"{self.jumps_before:.6e}", f"{self.jumps_after:.6e}"),
            ("  along u", f"{bu:.6e}", f"{au:.6e}"),
            ("  along v", f"{bv:.6e}", f"{av:.6e}"),
        ]
        moved = self.deviation_certified > 0
        proved = certificate_of(self.value, self.gap, self.gap_relative, moved=moved)
        tail = [
            (
                "deviation",
                f"at the points {self.deviation_data:.6e}; surface to surface certified "
                f"{self.deviation_certified:.6e}, sampled {self.deviation_sampled:.6e}, "
                f"{self.deviation_percent:.4g} % of the extent",
            ),
            ("certificate", proved),
            ("time", f"{1e3 * self.seconds:.3g} ms"),
        ]
        if self.passes is not None:
            tail.insert(2, ("passes", str(self.passes)))
        said = [f"note: {f.text}" for f in self.findings] + [f"note: {n}" for n in self.notes]
        return "\n".join([lines_of(rows, tail), *said])

    def plot(self, path: str | PathLike[str]) -> None:
        """Draw the surface, its curvature, zebra, jumps and displacement into a file.

        PNG or SVG by the name's end. Needs Matplotlib: ``pip install 'moldloft[plot]'``.

        Parameters
        ----------
        path
            The file.
        """
        from moldloft.fairing.plot import plot_surface

        plot_surface(self, path)

    def write_vtk(self, path: str | PathLike[str], u: ArrayLike = 81, v: ArrayLike = 41) -> None:
        """Write the faired surface for viewers as a structured grid (``.vts``).

        Its arrays are the curvatures, zebra stripes and normals, those of the original with
        ``_before`` at their names, and ``displacement``.

        Parameters
        ----------
        path
            The file.
        u
            Parameters along u in [0, 1], or how many even ones.
        v
            Parameters along v in [0, 1], or how many even ones.
        """
        from moldloft.fairing.files import write_vts

        before, after = self.original.look(u, v), self.surface.look(u, v)
        fields = after.fields()
        fields.update({f"{name}_before": value for name, value in before.fields().items()})
        fields["displacement"] = after.points - before.points
        write_vts(path, after.points, fields)


_RIMS = ("u0", "u1", "v0", "v1")


def _rims(rims: str | Mapping[str, str]) -> list[str]:
    """Rim conditions: at u = 0 and 1, at v = 0 and 1."""
    known = ("corners", "position", "tangent", "curvature")
    by_name = dict.fromkeys(_RIMS, rims) if isinstance(rims, str) else dict(rims)
    for name, word in by_name.items():
        if name not in _RIMS:
            raise FairingError(f"rims are {', '.join(_RIMS)}, not `{name}`")
        if word not in known:
            raise FairingError(f"rims: expected {', '.join(known)}, found `{word}`")
    return [by_name.get(name, "corners") for name in _RIMS]


_Condition = tuple[str, tuple[float, float], tuple[float, float, float]]


def _conditions(
    through: Iterable[tuple[Sequence[float], ArrayLike]],
    normals: Iterable[tuple[Sequence[float], ArrayLike]],
    keep: Sequence[str],
) -> tuple[list[_Condition], list[str]]:
    """The conditions, with their names for error messages."""
    out: list[_Condition] = []
    labels = []
    for word, rows in (("through", through), ("normal", normals)):
        for place, vector in rows:
            uv = [float(t) for t in place]
            if len(uv) != 2 or not all(0 <= t <= 1 for t in uv):
                raise FairingError(f"expected u and v from 0 to 1, found {place}")
            x, y, z = vector_of(vector)
            if not np.isfinite([x, y, z]).all() or (word == "normal" and not any((x, y, z))):
                raise FairingError(f"{word} at {uv[0]:g}, {uv[1]:g}: no such direction")
            out.append((word, (uv[0], uv[1]), (x, y, z)))
            labels.append(f"{word} at {uv[0]:g}, {uv[1]:g}")
    for word in keep:
        if word not in ("area", "volume"):
            raise FairingError(f"`{word}` of a surface cannot be kept; what can: area, volume")
        out.append((word, (0.0, 0.0), (0.0, 0.0, 0.0)))
        labels.append(f"keep {word}")
    return out, labels


def _fair_data(
    points: ArrayLike,
    tol: ArrayLike | None,
    options: dict[str, Any],
    conditions: tuple[list[_Condition], list[str]],
) -> SurfaceFairing:
    """A grid of data under tolerances."""
    from moldloft.fairing.asked import goal_of, spacing_of

    started = time.perf_counter()
    data, _ = points_of(points, 3)
    m, n = data.shape[:2]
    degree, closed = options["degree"], options["closed"]
    for axis, name in ((0, "u"), (1, "v")):
        few = (2 * degree[axis] if closed[axis] else degree[axis]) + 2
        if data.shape[axis] < few:
            raise FairingError(
                f"expected at least {few} points along {name}, found {data.shape[axis]}"
            )
    if tol is not None and np.ndim(tol) == 2 and np.shape(tol) != (m, n):
        raise FairingError(f"expected tolerances {(m, n)}, found {np.shape(tol)}")
    if tol is None and any(closed):
        raise FairingError("a closed surface without a tolerance shrinks")
    if any(c and len(rows) for c, rows in zip(closed, options["breaks"], strict=True)):
        raise FairingError("a closed direction has no breaks of its points")
    limits = radii(tol, m * n)
    for i, j in options["fixed"]:
        limits[int(i) * n + int(j)] = 0.0
    word, way = direction(options["motion"])
    spaced, spaced_way = spacing_of(options["spacing"])
    wanted = goal_of(options["goal"])
    measure = options["measure"] or ("variation" if min(degree) >= 3 else "bending")
    core, before, at, reported = _core.Net.fair_data(
        data.reshape(-1, 3),
        (m, n),
        {
            "tolerance": limits,
            "motion": word,
            "direction": way,
            "degree": degree,
            "closed": closed,
            "spacing": spaced,
            "spacing_direction": spaced_way,
            "marks": (list(options["breaks"][0]), list(options["breaks"][1])),
            "rims": _rims(options["rims"]),
            "measure": measure,
            "goal": wanted,
            "conditions": conditions[0],
            "labels": conditions[1],
        },
    )
    faired, original = SplineSurface._of(core), SplineSurface._of(before)
    moved = faired.grid(np.asarray(at[0]), np.asarray(at[1]))
    residuals = reported["residuals"].reshape(m, n)
    # Points on the surface to rounding are unchanged to the bit.
    still = residuals <= 64 * np.finfo(float).eps * np.abs(data).max()
    moved[still] = data[still]
    jumps_before, jumps_after = original.measure("jumps"), faired.measure("jumps")
    return SurfaceFairing(
        points=moved,
        surface=faired,
        original=original,
        data=data,
        tol=None if tol is None else float(np.max(np.asarray(tol, np.float64))),
        as_="fit",
        mode="optimum",
        measure=measure,
        measure_before=reported["measure_before"],
        measure_after=reported["measure_after"],
        jumps_before=reported["jumps_before"],
        jumps_after=reported["jumps_after"],
        jumps_along=((jumps_before[0], jumps_after[0]), (jumps_before[1], jumps_after[1])),
        deviation_certified=reported["certified"],
        deviation_sampled=reported["sampled"],
        extent=float(np.linalg.norm(np.ptp(data.reshape(-1, 3), axis=0))),
        value=reported["certificate"]["value"],
        gap=reported["certificate"]["gap"],
        passes=None,
        seconds=time.perf_counter() - started,
        goal=wanted[0],
        residuals=residuals,
        used=reported["used"],
    )


def fair_surface(
    points: ArrayLike | SplineSurface | SurfaceFairing,
    tol: ArrayLike | None,
    *,
    as_: str = "control",
    degree: int | tuple[int, int] = 3,
    closed: tuple[bool, bool] = (False, False),
    knots: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
    weights: ArrayLike | None = None,
    measure: str | None = None,
    mode: str = "optimum",
    bound: str | None = None,
    spacing: Any = "chord",
    goal: Any = "near",
    breaks: tuple[Sequence[int], Sequence[int]] = ((), ()),
    fixed: Sequence[tuple[int, int]] = (),
    ends: Any = 2,
    rims: str | Mapping[str, str] = "corners",
    motion: Any = "ball",
    through: Iterable[tuple[Sequence[float], ArrayLike]] = (),
    normals: Iterable[tuple[Sequence[float], ArrayLike]] = (),
    keep: Sequence[str] = (),
    passes: int = 1,
    steps: int | None = None,
    order: str = "vu",
    original: ArrayLike | None = None,
) -> SurfaceFairing:
    """Fair a surface within a tolerance.

    Parameters
    ----------
    points
        A grid ``(m, n, 3)`` or a :class:`SplineSurface`; or the :class:`SurfaceFairing` of a grid,
        which is then faired again from the points as they were read.
    tol
        Maximum distance that each point of the net may move; ``None`` for no limit.
    as_
        ``"control"``: the grid is the control net of a uniform surface; ``"fit"``: data on the
        surface, which stays within the tolerance of each. Surfaces with knots or weights of their
        own pass through data at even parameters before they are faired.
    degree, closed, knots, weights
        Of the surface of a grid; see :class:`SplineSurface` and :meth:`SplineSurface.interpolate`.
    measure
        As for curves: the sum over all curves of the net in both directions, of data over those
        through the data. By default ``"variation"`` for data, ``"second"`` otherwise.
    mode
        ``"optimum"``: all curves at once, with a certificate. ``"faithful"``: curve after curve by
        local steps, those of constant v first, then those of constant u, ``passes`` times.
        ``"sweeps"``: all points in order, for nets too large for the optimum.
    bound
        ``"data"``: the tolerance bounds the distance of each point from the surface; ``"points"``:
        the move of each control point; ``"curve"``: that of the surface from the one through the
        points, which leaves the control points more room. By default the data for fits.
    spacing
        Parameters of data in each direction, the mean over its lines; see curves.
    goal
        Choice among the surfaces within the tolerances of data; see curves. Other modes have
        ``"near"``, which leaves grids of exact lines as they are, and ``"fairest"``.
    breaks
        Rows of points along u and along v, from 0, that are knuckle lines: their points do not move
        by a bit and nothing is smoothed across them.
    fixed
        Points (i, j) of the net that do not move.
    ends
        Fixed quantities of curves at open ends in the faithful mode; see curves. The optimum keeps
        the four corners, two by two points.
    rims
        Exactly fixed quantities of the rims, so that neighbours still fit: ``"corners"`` (only
        these),
        ``"position"``, ``"tangent"`` or ``"curvature"``, of all rims or by name, as in
        ``{"u0": "curvature", "v1": "position"}``.
    motion
        As for curves.
    through, normals
        Conditions of an optimum: pairs of parameters (u, v) in [0, 1] and the point that the
        surface passes through there, or the direction of its normal.
    keep
        ``"volume"``: the volume between the surfaces is zero to first order, so that a hull keeps
        its displacement; ``"area"``: so is the change of the area.
    passes
        Passes of the faithful mode; the tolerance is from the original across all of them.
    steps
        Local steps per point of each curve (3), or sweeps (50).
    order
        Order of curves in a pass: ``"vu"``, those of constant v first, or ``"uv"``.
    original
        The grid as it was read, when ``points`` were faired already: tolerances are counted from
        it, so that fairing a result again is fairing the original.

    Raises
    ------
    FairingError
        If there is too little to fair or something is wrong.
    """
    if isinstance(points, SurfaceFairing):
        as_, points = points.as_, points.data
    if original is not None:
        if isinstance(points, SplineSurface) or np.shape(original) != np.shape(points):
            raise FairingError("the original is a grid of as many points")
        points = original
    if as_ not in ("control", "fit"):
        raise FairingError(f"points of a surface are `control` or `fit`, not `{as_}`")
    if mode not in ("optimum", "faithful", "sweeps"):
        raise FairingError(
            f"unknown mode `{mode}` of surfaces; expected one of: optimum, faithful, sweeps"
        )
    by_data = as_ == "fit" and mode == "optimum" and bound in (None, "data")
    plain = weights is None and all(k is None for k in knots)
    if bound == "data" and not (by_data and plain):
        raise FairingError("bound `data` is for optima of grids of data without own knots")
    if by_data and plain and not isinstance(points, SplineSurface):
        options = {
            "degree": (degree, degree) if isinstance(degree, int) else degree,
            "closed": closed,
            "measure": measure,
            "spacing": spacing,
            "goal": goal,
            "breaks": breaks,
            "fixed": fixed,
            "rims": rims,
            "motion": motion,
        }
        return _fair_data(points, tol, options, _conditions(through, normals, keep))
    only_data(goal)
    measure = measure or "second"
    bound = bound or "points"
    conditions, labels = _conditions(through, normals, keep)
    if conditions and mode != "optimum":
        raise FairingError("only the optimum keeps conditions; take mode `optimum`")
    started = time.perf_counter()
    marks = (list(breaks[0]), list(breaks[1]))
    at: tuple[Floats, Floats] | None = None
    if isinstance(points, SplineSurface):
        surface, data = points, points.control_points
    else:
        data, _ = points_of(points, 3)
        for axis, name in ((0, "u"), (1, "v")):
            least = degree[axis] if isinstance(degree, tuple) else degree
            few = (2 * least if closed[axis] else least) + 2
            if data.shape[axis] < few:
                raise FairingError(
                    f"expected at least {few} points along {name}, found {data.shape[axis]}"
                )
        if as_ == "fit":
            surface, at, marks = SplineSurface._interpolated(
                data, degree, marks, closed, knots, weights
            )
        else:
            surface = SplineSurface(
                data, degree=degree, knots=knots, weights=weights, closed=closed, clamped=False
            )
    m, n = surface._core.shape
    if tol is not None and np.ndim(tol) == 2 and np.shape(tol) != (m, n):
        raise FairingError(f"expected tolerances {(m, n)}, found {np.shape(tol)}")
    word, way = direction(motion)
    pair = ends if isinstance(ends, (tuple, list)) else (ends, ends)
    chosen = {
        "tolerance": radii(tol, m * n),
        "motion": word,
        "direction": way,
        "ends": tuple(map(str, pair)),
        "marks": marks,
        "fixed": [int(i) * n + int(j) for i, j in fixed],
        "measure": measure,
        "mode": mode,
        "bound": bound,
        "goal": None,
        "passes": passes,
        "steps": {"faithful": 3, "sweeps": 50}.get(mode, 0) if steps is None else steps,
        "order": order,
        "rims": _rims(rims),
        "conditions": conditions,
        "labels": labels,
    }
    free = not (surface._core.rational or conditions)
    around = surface.closed
    stay = tol is not None and stays_near(goal, free) and lines_exact(data, around, breaks)
    if stay:
        chosen["tolerance"] = [0.0] * (m * n)
    core, reported = surface._core.fair(chosen)
    if stay:
        # The fairest surface was not computed.
        reported["certificate"]["gap"] = reported["certificate"]["value"]
    faired = SplineSurface._of(core)
    seconds = time.perf_counter() - started
    jumps_before, jumps_after = surface.measure("jumps"), faired.measure("jumps")
    return SurfaceFairing(
        points=faired.control_points if at is None else faired.grid(*at),
        surface=faired,
        original=surface,
        data=data,
        tol=None if tol is None else float(np.max(np.asarray(tol, np.float64))),
        as_=as_,
        mode=mode,
        measure=measure,
        measure_before=reported["measure_before"],
        measure_after=reported["measure_after"],
        jumps_before=reported["jumps_before"],
        jumps_after=reported["jumps_after"],
        jumps_along=((jumps_before[0], jumps_after[0]), (jumps_before[1], jumps_after[1])),
        deviation_certified=reported["certified"],
        deviation_sampled=reported["sampled"],
        extent=float(np.linalg.norm(np.ptp(data.reshape(-1, 3), axis=0))),
        value=reported["certificate"]["value"],
        gap=reported["certificate"]["gap"],
        passes=passes if mode == "faithful" else None,
        seconds=seconds,
        stayed=stay,
    )


explain(globals())
