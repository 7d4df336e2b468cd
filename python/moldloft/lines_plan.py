"""The lines plan on one sheet: profile, half-breadth plan and body plan to one scale.

Sections are solved on the surfaces, and drawn as cubic curves through their points and tangents.
The sheet is a list of curves and texts in millimetres of paper; SVG, PDF and DXF are written
from it.
"""

from __future__ import annotations

import math
import os
import warnings
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error, ModelError

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = ["Plan", "draw", "dxf", "lines_plan", "pdf", "svg"]

SHEETS = {"A4": (297, 210), "A3": (420, 297), "A2": (594, 420), "A1": (841, 594), "A0": (1189, 841)}
"""Sheets of ISO 5457, landscape, in mm."""

SCALES = [1, 2, 2.5, 5, 10, 20, 25, 50, 100, 200, 250, 500, 1000, 2000, 2500, 5000, 10000]
"""Denominators of scales (ISO 5455, and 1:25 as in yards)."""

# Layer: line width in mm, dashes in mm (ISO 128).
_LAYERS: dict[str, tuple[float, tuple[float, ...]]] = {
    "grid": (0.13, ()),
    "sections": (0.25, ()),
    "outline": (0.5, ()),
    "dwl": (0.5, ()),
    "diagonals": (0.18, (6, 1.5, 0.5, 1.5)),
    "frame": (0.7, ()),
    "text": (0.25, ()),
}

# Widths of Helvetica in thousandths of its size, for measuring text (Adobe font metrics).
_WIDTHS = dict.fromkeys("0123456789abdeghnopqu_+$", 556) | dict.fromkeys(" .,:;/fIt!\\", 278)
_WIDTHS |= dict.fromkeys("ijl", 222) | dict.fromkeys("ckszvxyJ", 500) | dict.fromkeys("-r()", 333)
_WIDTHS |= {"m": 833, "w": 722, "W": 944, "M": 833, "%": 889, "=": 584, "³": 333, "²": 333}
_WIDTHS |= (
    dict.fromkeys("ABEKPSVXY", 667) | dict.fromkeys("CDHNRU", 722) | dict.fromkeys("FTZ", 611)
)
_WIDTHS |= {"L": 556, "G": 778, "O": 778, "Q": 778, "°": 400, "±": 584, "·": 278, "½": 834}


@dataclass(frozen=True)
class Path2:
    """A curve of cubic pieces: the first point, then three control points each; in mm, y up."""

    layer: str
    points: np.ndarray[Any, np.dtype[np.float64]]
    straight: bool = False
    """True if every piece is a straight line."""


@dataclass(frozen=True)
class Text:
    """A text; ``x`` and ``y`` are its lower left corner."""

    x: float
    y: float
    size: float
    text: str


@dataclass
class Plan:
    """A sheet."""

    width: float
    """Width of the sheet, in mm."""
    height: float
    """Height of the sheet, in mm."""
    scale: float
    """Its denominator."""
    unit: str
    """The model's unit of length."""
    metres: float
    """The model's unit of length, in metres."""
    paths: list[Path2] = field(default_factory=list)
    """The curves."""
    texts: list[Text] = field(default_factory=list)
    """The texts."""
    left_out: list[str] = field(default_factory=list)
    """Labels without a free position."""

    def line(self, layer: str, *points: tuple[float, float]) -> None:
        """A polyline.

        Parameters
        ----------
        layer
            The layer of the drawing.
        *points
            Points on the sheet, millimetres.
        """
        pieces = [np.array(points[0], dtype=float)]
        for a, b in pairwise(points):
            p, q = np.array(a, dtype=float), np.array(b, dtype=float)
            pieces += [p + (q - p) / 3, p + (q - p) * 2 / 3, q]
        self.paths.append(Path2(layer, np.array(pieces), straight=True))

    def label(
        self,
        x: float,
        y: float,
        text: str,
        size: float = 2.5,
        *,
        anchor: str = "middle",
        needed: bool = True,
    ) -> bool:
        """A text at (x, y); one that would overlap another is omitted and listed.

        Parameters
        ----------
        x
            Position on the sheet, in mm.
        y
            Position on the sheet, in mm.
        text
            The text.
        size
            Height of the letters, millimetres.
        anchor
            Part of the text at the position: ``"start"``, ``"middle"`` or ``"end"``.
        needed
            True to list it if it is left out.
        """
        wide = text_width(text, size)
        shift = {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor]
        place = Text(x - shift * wide, y - 0.36 * size, size, text)
        if any(_overlap(place, other) for other in self.texts):
            if needed:
                self.left_out.append(text)
            return False
        self.texts.append(place)
        return True


#: Lines at least so far apart can all be labelled, in mm.
_LABEL_STEP = 3.2


def text_width(text: str, size: float) -> float:
    """The width of a text in Helvetica.

    >>> round(text_width("10", 2.5), 3)
    2.78
    """
    return sum(_WIDTHS.get(c, 600) for c in text) * size / 1000


def _overlap(a: Text, b: Text) -> bool:
    gap = 0.3
    return (
        a.x < b.x + text_width(b.text, b.size) + gap
        and b.x < a.x + text_width(a.text, a.size) + gap
        and a.y < b.y + b.size + gap
        and b.y < a.y + a.size + gap
    )


def _nice(step: float) -> float:
    power = 10 ** math.floor(math.log10(step))
    factors = (1.0, 2.0, 2.5, 5.0, 10.0)
    return float(next(f * power for f in factors if f * power >= step * (1 - 1e-9)))


@dataclass
class _Curve:
    """A curve in space: points with tangents; the parameter of each piece is its chord length."""

    points: np.ndarray[Any, np.dtype[np.float64]]
    tangents: np.ndarray[Any, np.dtype[np.float64]]


class _Lines:
    """The curves of a model: sections by planes, and the edges of its surfaces."""

    def __init__(self, model: Model) -> None:
        names = [
            name
            for name in model.objects
            if (fact := model.facts(name))["class"] == "surface" and fact["shown"] and fact["ok"]
        ]
        if not names:
            raise Error("a lines plan needs surfaces, and the model shows no surface")
        self.surfaces = [model[name] for name in names]
        grids = [s.grid(9, 9) for s in self.surfaces]
        points = np.concatenate([g.reshape(-1, 3) for g in grids])
        self.low, self.high = points.min(axis=0), points.max(axis=0)
        # Of a model that shows one end, the sheet shows both.
        self.mirrored = "x" in model.symmetry
        if self.mirrored:
            self.high[0] = max(abs(self.low[0]), abs(self.high[0]))
            self.low[0] = -self.high[0]
        self.size = float(np.linalg.norm(self.high - self.low))

    def _whole(self, curves: list[_Curve]) -> list[_Curve]:
        """The curves, completed by their mirror images."""
        if not self.mirrored:
            return curves
        flip = np.array([-1.0, 1.0, 1.0])
        return curves + [_Curve(c.points * flip, c.tangents * flip) for c in curves]

    def section(self, axis: int, value: float) -> list[_Curve]:
        """The curves in the plane x, y or z = value."""
        if axis == 0 and self.mirrored:
            own, other = self._cut(0, value), self._cut(0, -value) if value else []
            return own + self._whole(other)[len(other) :]
        return self._whole(self._cut(axis, value))

    def _cut(self, axis: int, value: float) -> list[_Curve]:
        found = []
        for surface in self.surfaces:
            cut = surface.intersect(f"{'xyz'[axis]}={value!r}")
            for branch in cut.branches:
                if len(branch.points) >= 2:
                    found.append(_Curve(np.array(branch.points), np.array(branch.tangents)))
        return found

    def diagonal(self, height: float, angle: float) -> list[_Curve]:
        """The curves in a plane through (y, z) = (0, height) that falls outward at an angle."""
        normal = (0.0, math.sin(angle), math.cos(angle))
        found = []
        for surface in self.surfaces:
            for branch in surface.intersect(((0.0, 0.0, height), normal)).branches:
                if len(branch.points) >= 2:
                    found.append(_Curve(np.array(branch.points), np.array(branch.tangents)))
        return self._whole(found)

    def edges(self) -> list[_Curve]:
        """The non-degenerate edges of all surfaces."""
        found = []
        t = np.linspace(0, 1, 41)
        for surface in self.surfaces:
            for u, v in ((t, 0 * t), (1 + 0 * t, t), (t, 1 + 0 * t), (0 * t, t)):
                points = np.array([surface(a, b) for a, b in zip(u, v, strict=True)])
                # An edge in the plane of symmetry is not an edge of the whole.
                seam = self.mirrored and abs(points[:, 0]).max() <= 1e-9 * self.size
                if not seam and np.ptp(points, axis=0).max() > 1e-9 * self.size:
                    found.append(_Curve(points, _slopes(points)))
        return self._whole(found)


def _slopes(points: np.ndarray[Any, np.dtype[np.float64]]) -> Any:
    """Unit tangents at points of even parameters, by differences of fourth order within corners."""
    step = np.gradient(points, axis=0, edge_order=2)
    inner = (8 * (points[3:-1] - points[1:-3]) - (points[4:] - points[:-4])) / 12
    step[2:-2] = inner
    norm = np.linalg.norm(step, axis=1, keepdims=True)
    return step / np.where(norm > 0, norm, 1)


def _flat(curve: _Curve, across: int, up: int, mirror: float = 1.0) -> Any:
    """The control points of a curve in a view; collinear for a view along it."""
    p = curve.points[:, [across, up]] * [mirror, 1.0]
    t = curve.tangents[:, [across, up]] * [mirror, 1.0]
    chords = np.linalg.norm(np.diff(curve.points, axis=0), axis=1)
    # Tangents point along the points.
    along = np.einsum("ij,ij->i", np.diff(curve.points, axis=0), curve.tangents[:-1])
    if along.sum() < 0:
        t = -t
    pieces = [p[:1]]
    for k, chord in enumerate(chords):
        a, b = p[k] + t[k] * chord / 3, p[k + 1] - t[k + 1] * chord / 3
        pieces.append(np.array([a, b, p[k + 1]]))
    return np.concatenate(pieces)


def lines_plan(
    model: Model,
    *,
    title: str = "",
    sheet: str = "",
    scale: float | None = None,
    stations: str = "bow",
    waterline_spacing: float | None = None,
    buttock_spacing: float | None = None,
    diagonals: Sequence[tuple[float, float]] = (),
    density: float | str | None = None,
) -> Plan:
    """The lines plan of a model.

    Parameters
    ----------
    model
        The model, z up, x along the ship.
    title
        For the title block.
    sheet
        ``A0`` to ``A4``; by default A3, or a larger one where the plan needs it.
    scale
        The denominator; by default the largest scale that fits.
    stations
        End of the waterline with station 0: ``bow`` or ``stern``.
    waterline_spacing, buttock_spacing
        In the model's unit; by default round numbers.
    diagonals
        Planes through (0, height) that fall outward at an angle in radians: (height, angle) each.
    density
        Water for the displacement in the title block.
    """
    if stations not in ("bow", "stern"):
        raise Error(f"stations are counted from the `bow` or the `stern`, not `{stations}`")
    if sheet and sheet not in SHEETS:
        raise Error(f"unknown sheet `{sheet}`; expected one of: {', '.join(SHEETS)}")
    if scale is not None and not scale > 0:
        raise Error(f"a scale has a positive denominator, not {scale}")
    lines = _Lines(model)
    mirrored = "y" in model.symmetry
    flotation = None
    if lines.low[2] < 0 <= lines.high[2]:
        try:
            flotation = model.hydrostatics(density=density)
        except ModelError as error:
            warnings.warn(f"the sheet has no hydrostatics: {error}", stacklevel=2)
    if flotation is not None and flotation.waterline_low_x is not None:
        ends = (flotation.waterline_low_x, flotation.waterline_high_x or lines.high[0])
    else:
        flotation, ends = None, (float(lines.low[0]), float(lines.high[0]))
    unit, metres = model.length_unit
    mm = metres * 1000
    length, height = float(lines.high[0] - lines.low[0]), float(lines.high[2] - lines.low[2])
    breadth = float(max(abs(lines.low[1]), abs(lines.high[1])))
    if not length > 0:
        raise Error("a lines plan is of a body with length along x")
    # All three views and the gaps between them, in mm of paper at a scale.
    gap, border = 18.0, 10.0
    block = (178.0, 52.0)

    def needs(denominator: float) -> tuple[float, float]:
        f = mm / denominator
        wide = f * (length + 2 * breadth) + 3 * gap + 2 * border
        high = f * (height + breadth) + 3 * gap + 2 * border + block[1]
        return wide, high

    names = [sheet] if sheet else list(SHEETS)
    choice: tuple[str, float] | None = None
    for name in names:
        width, tall = SHEETS[name]
        fitting = [s for s in SCALES if needs(s)[0] <= width - 10 and needs(s)[1] <= tall]
        wanted = scale if scale is not None else (fitting[0] if fitting else None)
        if wanted is not None and needs(wanted)[0] <= width - 10 and needs(wanted)[1] <= tall:
            choice = (name, float(wanted))
            # On a sheet of less than A2 the curves are small; A3 suits most plans.
            if sheet or scale is not None or name == "A3":
                break
    if choice is None:
        raise Error(f"the plan does not fit on {sheet or 'A0'} at this scale")
    name, denominator = choice
    width, tall = SHEETS[name]
    plan = Plan(float(width), float(tall), denominator, unit, metres)
    f = mm / denominator
    left, bottom = 20.0 + gap, border + block[1] + gap
    # Places of the origins of the views on the paper.
    x0 = left - f * float(lines.low[0])
    half_y = bottom
    profile_y = bottom + f * breadth + gap - f * float(lines.low[2])
    body_x = left + f * length + gap + f * breadth
    body_y = profile_y

    def put(
        layer: str, curves: Iterable[_Curve], across: int, up: int, origin: Any, m: float = 1
    ) -> None:
        for curve in curves:
            plan.paths.append(Path2(layer, _flat(curve, across, up, m) * f + np.array(origin)))

    low_z, high_z = float(lines.low[2]), float(lines.high[2])
    # Of lines closer than their labels are high, not all could be labelled.
    rise = waterline_spacing or _nice(max(height / 7, _LABEL_STEP / f))
    aside = buttock_spacing or _nice(max(breadth / 4.5, _LABEL_STEP / f))
    first = math.ceil((low_z + 0.02 * height) / rise)
    levels = [k * rise for k in range(first, math.floor((high_z - 0.02 * height) / rise) + 1)]
    offs = [k * aside for k in range(1, math.floor(breadth * 0.97 / aside) + 1)]
    side = 1.0 if lines.high[1] >= -lines.low[1] else -1.0
    xs = [ends[0] + (ends[1] - ends[0]) * k / 10 for k in range(11)]
    numbers = [str(k if stations == "bow" else 10 - k) for k in range(11)]

    # Grids first, then curves.
    for x, number in zip(xs, numbers, strict=True):
        px = x0 + f * x
        plan.line("grid", (px, half_y - 4), (px, half_y + f * breadth + 3))
        plan.line("grid", (px, profile_y + f * low_z - 3), (px, profile_y + f * high_z + 3))
        plan.label(px, half_y - 6.5, number)
        plan.label(px, profile_y + f * high_z + 5.5, number)
    # The design waterline is labelled first, then the others from the lowest up.
    for z in sorted(levels, key=lambda z: (abs(z) >= 1e-9 * height, z)):
        layer = "dwl" if abs(z) < 1e-9 * height else "grid"
        y = profile_y + f * z
        plan.line(layer, (x0 + f * lines.low[0] - 6, y), (x0 + f * lines.high[0] + 6, y))
        plan.line(layer, (body_x - f * breadth - 4, y), (body_x + f * breadth + 4, y))
        text = "DWL" if layer == "dwl" else f"WL {z:g}"
        plan.label(x0 + f * lines.low[0] - 7, y, text, anchor="end")
        plan.label(body_x + f * breadth + 5, y, text, anchor="start")
    plan.label(body_x, body_y + f * low_z - 5.5, "CL")
    plan.label(x0 + f * lines.low[0] - 7, half_y, "CL", anchor="end")
    for y in offs:
        py = half_y + f * y
        plan.line("grid", (x0 + f * lines.low[0] - 6, py), (x0 + f * lines.high[0] + 6, py))
        known = plan.label(x0 + f * lines.low[0] - 7, py, f"B {y:g}", anchor="end")
        for sign in (-1, 1):
            px = body_x + sign * f * y
            plan.line("grid", (px, body_y + f * low_z - 3), (px, body_y + f * high_z + 3))
            # In a narrow body plan the half-breadth plan says which they are.
            plan.label(px, body_y + f * low_z - 5.5, f"B {y:g}", needed=not known)
    plan.line("grid", (x0 + f * lines.low[0] - 6, half_y), (x0 + f * lines.high[0] + 6, half_y))
    plan.line("grid", (body_x, body_y + f * low_z - 3), (body_x, body_y + f * high_z + 3))
    base = profile_y + f * low_z
    plan.line("grid", (x0 + f * lines.low[0] - 6, base), (x0 + f * lines.high[0] + 6, base))
    plan.label(x0 + f * lines.high[0] + 7, base, "BL", anchor="start")

    profile, half, body = (x0, profile_y), (x0, half_y), (body_x, body_y)
    for z in levels:
        curves = [c for c in lines.section(2, z) if side * c.points[:, 1].mean() > -1e-9]
        put("dwl" if abs(z) < 1e-9 * height else "sections", curves, 0, 1, half, 1)
        if side < 0:
            for path in plan.paths[-len(curves) :] if curves else []:
                path.points[:, 1] = 2 * half_y - path.points[:, 1]
    for y in offs:
        put("sections", lines.section(1, side * y), 0, 2, profile)
    middle = 0.5 * (ends[0] + ends[1])
    for x in xs:
        inside = min(max(x, lines.low[0] + 1e-7 * length), lines.high[0] - 1e-7 * length)
        curves = lines.section(0, float(inside))
        # Fore sections right, after ones left of the centre line, the middle on both.
        signs = [1] if x < middle - 1e-9 else [-1] if x > middle + 1e-9 else [1, -1]
        for sign in signs:
            shown = [c for c in curves if side * c.points[:, 1].mean() > -1e-9]
            put("sections", shown, 1, 2, body, sign * side)
    edges = lines.edges()
    put("outline", edges, 0, 2, profile)
    put("outline", [c for c in edges if side * c.points[:, 1].mean() > -1e-9], 0, 1, half, 1)
    for edge in edges:
        if side * edge.points[:, 1].mean() <= -1e-9:
            continue
        along = edge.points[:, 0]
        if np.ptp(along) <= 1e-6 * length:
            put("outline", [edge], 1, 2, body, side * (1 if along.mean() < middle else -1))
        else:
            for sign, keep in ((1, along <= middle), (-1, along >= middle)):
                if np.count_nonzero(keep) >= 2:
                    part = _Curve(edge.points[keep], edge.tangents[keep])
                    put("outline", [part], 1, 2, body, side * sign)
    for k, (at, angle) in enumerate(diagonals):
        letter = "ABCDEFGHJK"[k % 10]
        reach = min(breadth / max(math.cos(angle), 1e-6), (at - low_z) / max(math.sin(angle), 1e-6))
        for sign in (-1, 1):
            across, down = reach * math.cos(angle), reach * math.sin(angle)
            end = (body_x + sign * f * across, body_y + f * (at - down))
            plan.line("diagonals", (body_x, body_y + f * at), end)
            plan.label(end[0] + sign * 2.5, end[1], letter)
        for curve in lines.diagonal(at, angle):
            if side * curve.points[:, 1].mean() < 0:
                continue
            # Unfolded: true length in its plane, drawn below the centre line.
            flat = curve.points.copy()
            flat[:, 1] = -np.hypot(curve.points[:, 1], curve.points[:, 2] - at)
            slopes = curve.tangents.copy()
            slopes[:, 1] = -(
                curve.tangents[:, 1] * math.cos(angle) - curve.tangents[:, 2] * math.sin(angle)
            ) * np.sign(curve.points[:, 1] + 1e-300)
            put("diagonals", [_Curve(flat, slopes)], 0, 1, half)
    _title_block(plan, block, title, name, unit, metres, flotation, lines, ends, mirrored)
    if plan.left_out:
        names = list(dict.fromkeys(plan.left_out))
        more = f" and {len(names) - 8} more" if len(names) > 8 else ""
        plan.label(30, 30, f"without labels: {', '.join(names[:8])}{more}", 2.5, anchor="start")
    return plan


def _title_block(
    plan: Plan,
    block: tuple[float, float],
    title: str,
    sheet: str,
    unit: str,
    metres: float,
    flotation: Any,
    lines: _Lines,
    ends: tuple[float, float],
    mirrored: bool,
) -> None:
    """The frame, the block of principal dimensions, and the scale bar."""
    plan.line(
        "frame",
        (20, 10),
        (plan.width - 10, 10),
        (plan.width - 10, plan.height - 10),
        (20, plan.height - 10),
        (20, 10),
    )
    x, y = plan.width - 10 - block[0], 10.0
    plan.line("frame", (x, y), (x, y + block[1]), (x + block[0], y + block[1]))
    sizes = lines.high - lines.low
    beam = 2 * max(abs(lines.low[1]), abs(lines.high[1])) if mirrored else sizes[1]
    rows = [("L OA", sizes[0], "length"), ("B", beam, "length"), ("D", sizes[2], "length")]
    if flotation is not None:
        rows += [
            ("L WL", ends[1] - ends[0], "length"),
            ("B WL", flotation.waterline_beam, "length"),
            ("T", flotation.draft, "length"),
            ("volume", flotation.volume, "volume"),
            ("displacement", flotation.displacement, "displacement"),
            ("LCB", flotation.lcb, "length"),
            ("LCF", flotation.lcf, "length"),
            ("wetted area", flotation.wetted_area, "area"),
            ("CB", flotation.cb, ""),
            ("CP", flotation.cp, ""),
            ("CM", flotation.cm, ""),
            ("CWP", flotation.cwp, ""),
        ]
    powers = {"length": unit, "area": f"{unit}²", "volume": f"{unit}³", "": ""}
    if flotation is not None:
        powers["displacement"] = flotation.unit("displacement")
    plan.label(x + 4, y + block[1] - 6, title or "LINES PLAN", 5, anchor="start")
    text = f"scale 1:{plan.scale:g}   sheet {sheet}   lengths in {unit}"
    text += "   x from the origin, aft positive"
    plan.label(x + 4, y + block[1] - 13, text, 2.5, anchor="start")
    row = 0
    for what, value, kind in rows:
        if value is None:
            continue
        column, line = divmod(row, 5)
        text = f"{what}  {value:.5g} {powers[kind]}".rstrip()
        plan.label(x + 4 + 58 * column, y + block[1] - 20 - 6 * line, text, 2.5, anchor="start")
        row += 1
    # The bar keeps its length when the sheet is shrunk.
    f = metres * 1000 / plan.scale
    step = _nice(20 / f)
    left, base = 30.0, 18.0
    for k in range(4):
        plan.line("outline", (left + k * step * f, base), (left + (k + 1) * step * f, base))
        plan.line("outline", (left + k * step * f, base), (left + k * step * f, base + 2))
        plan.label(left + k * step * f, base + 5, f"{k * step:g}")
    plan.line("outline", (left + 4 * step * f, base), (left + 4 * step * f, base + 2))
    plan.label(left + 4 * step * f, base + 5, f"{4 * step:g}")
    plan.label(left + 4 * step * f + 8, base + 1, unit, anchor="start")


def _number(x: float) -> str:
    text = f"{x:.4f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def svg(plan: Plan) -> bytes:
    """The sheet as SVG, in millimetres.

    Parameters
    ----------
    plan
        The lines plan.
    """
    from xml.sax.saxutils import escape

    w, h = _number(plan.width), _number(plan.height)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}mm" height="{h}mm" '
        f'viewBox="0 0 {w} {h}">',
        f'<rect width="{w}" height="{h}" fill="white"/>',
    ]
    for layer, (width, dashes) in _LAYERS.items():
        paths = [p for p in plan.paths if p.layer == layer]
        if not paths:
            continue
        dash = f' stroke-dasharray="{" ".join(map(_number, dashes))}"' if dashes else ""
        out.append(
            f'<g id="{layer}" fill="none" stroke="black" stroke-width="{width}" '
            f'stroke-linecap="round" stroke-linejoin="round"{dash}>'
        )
        for path in paths:
            points = [f"{_number(x)} {_number(plan.height - y)}" for x, y in path.points]
            out.append(f'<path d="M{points[0]} C{" ".join(points[1:])}"/>')
        out.append("</g>")
    out.append('<g id="text" font-family="Helvetica, Arial, sans-serif" fill="black">')
    for text in plan.texts:
        at = f'x="{_number(text.x)}" y="{_number(plan.height - text.y)}"'
        out.append(f'<text {at} font-size="{_number(text.size)}">{escape(text.text)}</text>')
    out.append("</g></svg>\n")
    return "\n".join(out).encode()


def pdf(plan: Plan) -> bytes:
    """The sheet as PDF 1.7: exact millimetres, texts in Helvetica, the same bytes each time.

    Parameters
    ----------
    plan
        The lines plan.
    """
    point = 72 / 25.4
    out = [f"{point:.8f} 0 0 {point:.8f} 0 0 cm 1 J 1 j"]
    for layer, (width, dashes) in _LAYERS.items():
        paths = [p for p in plan.paths if p.layer == layer]
        if paths:
            out.append(f"{width} w [{' '.join(map(_number, dashes))}] 0 d")
        for path in paths:
            at = [f"{_number(x)} {_number(y)}" for x, y in path.points]
            pieces = [f"{at[k]} {at[k + 1]} {at[k + 2]} c" for k in range(1, len(at), 3)]
            out.append(" ".join([f"{at[0]} m", *pieces, "S"]))
    out.append("BT")
    for text in plan.texts:
        code = text.text.encode("cp1252", "replace")
        for special in (b"\\", b"(", b")"):
            code = code.replace(special, b"\\" + special)
        place = f"/F1 {_number(text.size)} Tf 1 0 0 1 {_number(text.x)} {_number(text.y)} Tm "
        out.append(place + "(" + code.decode("latin-1") + ") Tj")
    out.append("ET")
    stream = zlib.compress("\n".join(out).encode("latin-1"), 9)
    box = f"[0 0 {plan.width * point:.4f} {plan.height * point:.4f}]"
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox {box} /Contents 4 0 R "
        "/Resources << /Font << /F1 5 0 R >> >> >>".encode(),
        f"<< /Length {len(stream)} /Filter /FlateDecode >>\nstream\n".encode()
        + stream
        + b"\nendstream",
        b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
    ]
    data = b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n"
    starts = []
    for number, body in enumerate(objects, 1):
        starts.append(len(data))
        data += f"{number} 0 obj\n".encode() + body + b"\nendobj\n"
    table = len(data)
    data += f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n".encode()
    data += b"".join(f"{start:010d} 00000 n \n".encode() for start in starts)
    data += f"trailer\n<< /Size {len(objects) + 1} /Root 1 0 R >>\n".encode()
    data += f"startxref\n{table}\n%%EOF\n".encode()
    return data


def dxf(plan: Plan) -> bytes:
    """The sheet as DXF R2018 by ezdxf, at full size in the model's unit.

    Each curve is one spline of degree 3 with the control points of the plan, each straight line a
    line or polyline; layers have the widths and dashes of the drawing, dashes and texts are scaled
    to the size on paper at the plan's scale.

    Parameters
    ----------
    plan
        The lines plan.
    """
    from moldloft.cad import needed
    from moldloft.cad.dxf import UNITS, saved

    ezdxf: Any = needed("ezdxf", "ezdxf", "writing DXF")
    full = plan.scale / (1000 * plan.metres)
    document = ezdxf.new("R2018", setup=False)
    document.header["$INSUNITS"] = UNITS[plan.unit]
    document.header["$LWDISPLAY"] = 1
    document.styles.add("plan", font="arial.ttf")
    for name, (width, dashes) in _LAYERS.items():
        layer = document.layers.add(name, lineweight=round(100 * width))
        if dashes:
            pattern = [size if k % 2 == 0 else -size for k, size in enumerate(dashes)]
            pattern = [full * size for size in pattern]
            document.linetypes.add(name, [full * sum(dashes), *pattern])
            layer.dxf.linetype = name
    space = document.modelspace()
    for path in plan.paths:
        points = path.points * full
        attributes = {"layer": path.layer}
        if path.straight:
            ends = points[::3].tolist()
            if len(ends) == 2:
                space.add_line(*ends, dxfattribs=attributes)
            else:
                space.add_lwpolyline(ends, dxfattribs=attributes)
            continue
        pieces = (len(points) - 1) // 3
        spline = space.add_spline(dxfattribs=attributes)
        spline.dxf.degree = 3
        spline.control_points = [(x, y, 0.0) for x, y in points.tolist()]
        inner = np.repeat(np.arange(1, pieces), 3)
        spline.knots = [0.0] * 4 + inner.astype(float).tolist() + [float(pieces)] * 4
        spline.dxf.flags = 8
    for text in plan.texts:
        # The height of capitals is 0.72 of the size of Helvetica.
        place = {"layer": "text", "style": "plan", "height": 0.72 * text.size * full}
        space.add_text(text.text, dxfattribs=place).set_placement((text.x * full, text.y * full))
    return saved(document)


def encode_svg(model: Model, stem: str) -> bytes:
    """The row ``lines-svg`` of the table of formats."""
    return svg(lines_plan(model, title=stem.removesuffix(".lines")))


def encode_pdf(model: Model, stem: str) -> bytes:
    """The row ``lines-pdf`` of the table of formats."""
    return pdf(lines_plan(model, title=stem.removesuffix(".lines")))


def encode_dxf(model: Model, stem: str) -> bytes:
    """The row ``lines-dxf`` of the table of formats."""
    return dxf(lines_plan(model, title=stem.removesuffix(".lines")))


def draw(model: Model, path: str | os.PathLike[str], **options: Any) -> Path:
    """Write the lines plan of a model as ``.svg``, ``.pdf`` or ``.dxf``.

    Options are those of :func:`lines_plan`.

    Parameters
    ----------
    model
        The model.
    path
        The file; its ending is ``.svg``, ``.pdf`` or ``.dxf``.
    **options
        Options of :func:`lines_plan`.
    """
    from moldloft.exchange.files import Output, commit

    path = Path(path)
    writers = {".svg": svg, ".pdf": pdf, ".dxf": dxf}
    if path.suffix.lower() not in writers:
        raise Error(f"no lines plan ends in `{path.suffix}`; expected one of: {', '.join(writers)}")
    plan = lines_plan(model, **options)
    data = writers[path.suffix.lower()](plan)
    return commit(path.parent, [Output(path.name, data)], make=False)[0]


explain(globals())
