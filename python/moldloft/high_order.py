"""WAMIT's high-order geometry: B-spline patches (GDF with IGDEF = 1).

A file has a title; ``ULEN GRAV``; ``ISX ISY``; ``NPATCH 1``; for each patch ``NUG NVG`` (spans),
``KUG KVG`` (orders, degree + 1), the NUG + 2 KUG - 1 knots in u, those in v, on [-1, 1], and
(NUG + KUG - 1)(NVG + KVG - 1) control points, u running fastest (WAMIT User Manual 7.6; the layout
is the one that BEMRosetta reads and writes). S_u x S_v points out of the water, into the body.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]
    Evaluate = Callable[[Floats, Floats], Floats]

__all__ = ["SplinePatch", "patches", "write"]

_DEGREES = range(1, 6)
_MOST_SPANS = 24
"""The largest number of spans that is tried for an exact form, in each direction."""

_MOST_PIECES = 16
"""The largest number of even pieces that is tried where a surface has knuckles."""

_FIT_DEGREE = 3
_FIT_SPANS = (2, 4, 8, 16, 32)
_DEEPEST = 4
"""How often a patch is halved, in each direction, before its fit is given up."""

_EXACT = 4e-13
"""Deviation over the size of the model that counts as rounding."""


@dataclass(frozen=True)
class SplinePatch:
    """A B-spline patch with clamped uniform knots on [-1, 1]."""

    name: str
    """The surface that it is, or is a part of."""
    degree: tuple[int, int]
    """Degrees in u and v."""
    spans: tuple[int, int]
    """Spans in u and v."""
    points: Floats
    """Control points, ``(nu, nv, 3)``."""
    deviation: float
    """The largest distance found from the surface; rounding where the form is exact."""

    def knots(self, axis: int) -> Floats:
        """The knot vector of u (0) or v (1), end knots included."""
        return _knots(self.degree[axis], self.spans[axis])

    def __call__(self, u: Floats, v: Floats) -> Floats:
        """Positions on the grid of ``u`` and ``v`` in [-1, 1], ``(nu, nv, 3)``."""
        left = _basis(u, self.degree[0], self.spans[0])
        right = _basis(v, self.degree[1], self.spans[1])
        grid: Floats = np.einsum("ia,jb,abc->ijc", left, right, self.points)
        return grid


def _knots(degree: int, spans: int) -> Floats:
    inner = -1 + 2 * np.arange(1, spans) / spans
    return np.concatenate([np.full(degree + 1, -1.0), inner, np.full(degree + 1, 1.0)])


def _basis(t: Floats, degree: int, spans: int) -> Floats:
    """All basis functions at ``t``, by the recursion of Cox and de Boor; ``(len(t), n)``."""
    knots = _knots(degree, spans)
    t = np.asarray(t, dtype=np.float64)
    span = np.clip(np.floor((t + 1) / 2 * spans).astype(int), 0, spans - 1) + degree
    # The floor may be a knot off by rounding.
    span = np.where(t < knots[span], span - 1, span)
    span = np.clip(np.where(t >= knots[span + 1], span + 1, span), degree, degree + spans - 1)
    values = np.zeros((len(t), len(knots) - 1))
    values[np.arange(len(t)), span] = 1.0
    for p in range(1, degree + 1):
        count = len(knots) - 1 - p
        lengths = knots[p : p + count] - knots[:count]
        after = knots[p + 1 : p + 1 + count] - knots[1 : 1 + count]
        rise = np.where(lengths > 0, lengths, np.inf)
        fall = np.where(after > 0, after, np.inf)
        left = (t[:, None] - knots[:count]) / rise * values[:, :count]
        right = (knots[p + 1 : p + 1 + count] - t[:, None]) / fall * values[:, 1 : count + 1]
        values = left + right
    return values


def _greville(degree: int, spans: int) -> Floats:
    knots = _knots(degree, spans)
    n = degree + spans
    means: Floats = np.array([knots[i + 1 : i + 1 + degree].mean() for i in range(n)])
    return np.clip(means, -1, 1)


def _tests(spans: int) -> Floats:
    """Places between the knots at which a form is compared with the surface."""
    inner = np.array([0.11, 0.37, 0.52, 0.83])
    each = -1 + 2 * (np.arange(spans)[:, None] + inner) / spans
    return np.concatenate([[-1.0], each.ravel(), [1.0]])


def _exact(along: Callable[[Floats], Floats], size: float) -> tuple[int, int] | None:
    """The degree and spans, with fewest control points, that give curves exactly.

    ``along`` takes parameters and returns points of several curves, ``(n, curves, 3)``.
    """
    forms = [(p, n) for p in _DEGREES for n in range(1, _MOST_SPANS + 1)]
    for degree, spans in sorted(forms, key=lambda form: (sum(form), form)):
        at, test = _greville(degree, spans), _tests(spans)
        given, wanted = along(at), along(test)
        flat = given.reshape(len(at), -1)
        solved = np.linalg.solve(_basis(at, degree, spans), flat)
        error = _basis(test, degree, spans) @ solved - wanted.reshape(len(test), -1)
        if np.abs(error).max() <= _EXACT * size:
            return degree, spans
    return None


def _pieces(along: Callable[[Floats], Floats], size: float) -> int:
    """The fewest even pieces, two or more, each of which is a polynomial; 1 when there are none."""
    for count in range(2, _MOST_PIECES + 1):
        starts = -1 + 2 * np.arange(count) / count

        def piece(t: Floats, start: float, count: int = count) -> Floats:
            return along(start + (t + 1) / count)

        for degree in _DEGREES:
            at, test = _greville(degree, 1), _tests(1)
            left, right = _basis(at, degree, 1), _basis(test, degree, 1)
            for start in starts:
                given = piece(at, start).reshape(len(at), -1)
                wanted = piece(test, start).reshape(len(test), -1)
                if np.abs(right @ np.linalg.solve(left, given) - wanted).max() > _EXACT * size:
                    break
            else:
                return count
    return 1


def _fit(
    name: str, evaluate: Evaluate, forms: tuple[tuple[int, int], tuple[int, int]]
) -> SplinePatch:
    """The patch of given degrees and spans that interpolates a surface, and how far it is off."""
    (p, m), (q, n) = forms
    points: NDArray[np.floating[Any]] = evaluate(_greville(p, m), _greville(q, n))
    points = np.linalg.solve(_basis(_greville(p, m), p, m), points.reshape(len(points), -1))
    points = points.reshape(p + m, q + n, 3).transpose(1, 0, 2)
    points = np.linalg.solve(_basis(_greville(q, n), q, n), points.reshape(q + n, -1))
    points = points.reshape(q + n, p + m, 3).transpose(1, 0, 2)
    patch = SplinePatch(name, (p, q), (m, n), points.astype(np.float64), 0.0)
    u, v = _tests(m), _tests(n)
    off = np.linalg.norm(patch(u, v) - evaluate(u, v), axis=-1).max()
    return replace(patch, deviation=float(off))


def _part(evaluate: Evaluate, box: tuple[float, float, float, float]) -> Evaluate:
    """The part of a surface over a box of its parameters in [0, 1], on [-1, 1] twice."""
    u0, u1, v0, v1 = box

    def inside(u: Floats, v: Floats) -> Floats:
        return evaluate(u0 + (u1 - u0) * (u + 1) / 2, v0 + (v1 - v0) * (v + 1) / 2)

    return inside


def _forms_of(
    name: str,
    evaluate: Evaluate,
    box: tuple[float, float, float, float],
    size: float,
    tolerance: float,
    depth: int = 0,
) -> list[SplinePatch]:
    part = _part(evaluate, box)
    probes = np.array([-0.83, -0.31, 0.17, 0.56, 0.97])

    def along_u(t: Floats) -> Floats:
        return part(t, probes)

    def along_v(t: Floats) -> Floats:
        across: Floats = part(probes, t).transpose(1, 0, 2)
        return across

    in_u, in_v = _exact(along_u, size), _exact(along_v, size)
    if depth == 0:
        # Knuckles at even parameters, as in polylines: they become edges of exact patches.
        m = 1 if in_u else _pieces(along_u, size)
        n = 1 if in_v else _pieces(along_v, size)
        if m * n > 1:
            at_u, at_v = np.linspace(0, 1, m + 1), np.linspace(0, 1, n + 1)
            boxes = [(*u, *v) for u in pairwise(at_u) for v in pairwise(at_v)]
            return [
                patch
                for one in boxes
                for patch in _forms_of(name, evaluate, one, size, tolerance, 1)
            ]
    best: SplinePatch | None = None
    for spans in _FIT_SPANS:
        forms = (in_u or (_FIT_DEGREE, spans), in_v or (_FIT_DEGREE, spans))
        patch = _fit(name, part, forms)
        if best is None or patch.deviation < best.deviation:
            best = patch
        if patch.deviation <= tolerance:
            return [patch]
        if in_u and in_v:
            # Exact along the probes but not between them.
            in_u = in_v = None
    assert best is not None
    if depth == _DEEPEST:
        raise Error(
            f"no B-spline comes within {tolerance:.3g} of `{name}`: the best is off by "
            f"{best.deviation:.3g}\nhelp: ask for less with a larger tolerance"
        )
    # A knuckle that is no knot: halve the patch, so that the knuckle becomes an edge.
    u0, u1, v0, v1 = box
    us = [(u0, u1)] if in_u else [(u0, (u0 + u1) / 2), ((u0 + u1) / 2, u1)]
    vs = [(v0, v1)] if in_v else [(v0, (v0 + v1) / 2), ((v0 + v1) / 2, v1)]
    parts = [(*u, *v) for u in us for v in vs]
    return [
        patch
        for one in parts
        for patch in _forms_of(name, evaluate, one, size, tolerance, depth + 1)
    ]


def patches(
    model: Model, *, tolerance: float | None = None, lids: bool = False
) -> list[SplinePatch]:
    """The model's skin as B-spline patches, in the order of its patches.

    Surfaces that are B-splines of uniform knots and degrees up to 5 (lofts, rulings and
    translations of such curves) are exact. Others are fitted by cubics within ``tolerance``, and
    halved where that fails.

    Parameters
    ----------
    model
        The model.
    tolerance
        The largest distance from the surface, by default 1e-5 of the model's diagonal. It is
        checked at four places of each span in each direction.
    lids
        Whether lids are among the patches.
    """
    mesh = model.mesh()
    if not np.isfinite(mesh.vertices).all():
        raise Error("cannot write gdf-high: a position is not a finite number")
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    allowed = 1e-5 * size if tolerance is None else tolerance
    if not allowed > 0:
        raise Error(f"a tolerance is a positive number, not {allowed}")
    out: list[SplinePatch] = []
    turned = {name: reverse for _, name, _, reverse, _ in mesh._core.blocks()}
    for facts in mesh.patches:
        if facts.tag in ("waterline", "symmetry") or (facts.tag == "lid" and not lids):
            continue
        if facts.name not in turned or facts.name not in model:
            raise Error(f"cannot write gdf-high: `{facts.name}` is no surface of u and v")
        surface = model[facts.name]

        def evaluate(u: Floats, v: Floats, surface: object = surface) -> Floats:
            grid: Floats = surface(u[:, None], v[None, :])  # type: ignore[operator]
            return grid

        for patch in _forms_of(facts.name, evaluate, (0, 1, 0, 1), size, allowed):
            points = patch.points
            if not turned[facts.name]:
                # Panels face the water along S_u x S_v: u is turned round.
                points = points[::-1]
            for axis, letter in enumerate("xy"):
                if letter in model.symmetry:
                    near = np.abs(points[..., axis]) <= 1e-9 * size
                    points = points.copy()
                    points[..., axis][near] = 0.0
            one = SplinePatch(patch.name, patch.degree, patch.spans, points, patch.deviation)
            _check_side(one, model.symmetry, size)
            out.append(one)
    return out


def _check_side(patch: SplinePatch, symmetry: str, size: float) -> None:
    t = np.linspace(-1, 1, 17)
    grid = patch(t, t)
    for axis, letter in enumerate("xy"):
        side = grid[..., axis]
        if letter in symmetry and side.min() < -1e-9 * size and side.max() > 1e-9 * size:
            raise Error(
                f"cannot write gdf-high: a half mirrored in {letter} = 0 must stay on one "
                f"side, but patch `{patch.name}` crosses it"
            )


def write(model: Model, title: str, *, tolerance: float | None = None, lids: bool = False) -> bytes:
    """The file. Patches above the water are left to WAMIT, which trims them (ITRIMWL = 1)."""
    symmetry = model.symmetry
    forms = patches(model, tolerance=tolerance, lids=lids)
    # The low-order file knows the gravity in the model's unit of length.
    (_, low), *_ = model._document.write("gdf", "x", False, False, [])
    gravity = low.split(b"\n", 2)[1].split()[1].decode()
    line = "".join(c if c.isprintable() else " " for c in title)
    lines = [line, f"1 {gravity}", f"{int('x' in symmetry)} {int('y' in symmetry)}"]
    lines.append(f"{len(forms)} 1")
    for patch in forms:
        lines.append(f"{patch.spans[0]} {patch.spans[1]}")
        lines.append(f"{patch.degree[0] + 1} {patch.degree[1] + 1}")
        for axis in (0, 1):
            lines.append(" ".join(repr(float(k)) for k in patch.knots(axis)))
        # u fastest.
        for point in patch.points.transpose(1, 0, 2).reshape(-1, 3):
            lines.append(" ".join(repr(float(x) + 0.0) for x in point))
    return ("\n".join(lines) + "\n").encode()
