"""A fairing as a sheet to sign: one content, as an HTML page or as PDF.

:func:`_parts` defines the content; both formats are drawn from the same parts. Drawings are in
millimetres of paper, so that a scale of 1 : n holds on both.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft._core import __version__
from moldloft.arguments import explain
from moldloft.colours import COLOURS
from moldloft.errors import Error
from moldloft.fairing.drawing import (
    AFTER,
    BEFORE,
    QUIET,
    by_length,
    even_turns,
    round_below,
    teeth,
)
from moldloft.lines_plan import SCALES

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from moldloft.fairing.faired import Fairing
    from moldloft.fairing.network import NetworkFairing
    from moldloft.fairing.spline import Spline
    from moldloft.fairing.suspects import Suspect

    Floats = NDArray[np.float64]

__all__ = ["SheetDetails", "SheetTable", "sheet", "write_sheet"]

#: The paper, A4 landscape, and its margins, in mm.
_PAPER, _MARGIN = (297.0, 210.0), 12.0
_WIDE, _TALL = _PAPER[0] - 2 * _MARGIN, _PAPER[1] - 2 * _MARGIN - 16.0

#: Stations side by side in one table, at most.
_COLUMNS = 19

#: A unit of length in mm.
_MM = {"m": 1000.0, "cm": 10.0, "mm": 1.0, "ft": 304.8, "in": 25.4}

_UNIT_NAMES = {
    "m": "metres",
    "cm": "centimetres",
    "mm": "millimetres",
    "ft": "feet",
    "in": "inches",
}

#: A point is at its limit from this share on.
_AT_LIMIT = 1 - 1e-4

_INK, _MOVED, _LIMIT = COLOURS["ink"], COLOURS["accent-soft"], COLOURS["row-limit"]

_STYLE = (
    "body{font:13px/1.4 Helvetica,Arial,sans-serif;max-width:285mm;margin:8mm auto;padding:0 4mm;"
    f"color:{_INK}}}h1{{font-size:1.5em;margin:.2em 0}}h2{{font-size:1.15em;margin:1.6em 0 .4em}}"
    "table{border-collapse:collapse;margin:.6em 0;font-variant-numeric:tabular-nums}"
    f"td,th{{border:1px solid {COLOURS['line']};padding:1px 6px;text-align:right;"
    f"vertical-align:top}}td:first-child,th:first-child,.facts td{{text-align:left}}"
    f"th{{background:{COLOURS['ground']}}}td.moved{{background:{_MOVED};font-weight:bold}}"
    f"td.moved small{{display:block;color:{BEFORE};font-weight:normal}}"
    f"td.limit{{background:{_LIMIT}}}p{{margin:.3em 0;max-width:60em}}"
    f"svg{{display:block;margin:.4em 0;background:{COLOURS['paper']};max-width:100%}}"
    ".sign td{height:12mm;min-width:55mm}"
    "@media print{@page{size:A4 landscape;margin:10mm}body{margin:0;max-width:none;"
    "padding:0}"
    "h2{break-after:avoid}svg,tr{break-inside:avoid}}"
)


@dataclass
class SheetTable:
    """A table of offsets before and after."""

    lines: list[str]
    """Names of its rows."""
    stations: list[str]
    """Names of its columns."""
    cells: dict[tuple[str, str], tuple[str, str | None]]
    """Offset of each row and column before and after; ``None`` if unchanged."""


@dataclass
class SheetDetails:
    """Data of a sheet in addition to the result."""

    facts: Sequence[tuple[str, str]] = ()
    """Names and values of the title block: source, date, the command that repeats it."""
    table: SheetTable | None = None
    """The table of offsets before and after; without it all points are listed."""
    suspects: Sequence[Suspect] = ()
    """See :func:`moldloft.fairing.suspects`."""
    unit: str | None = None
    """The unit of the points (m, cm, mm, ft, in), for the scale."""
    eighths: bool = False
    """True if the table is in feet, inches and eighths."""
    limits: Floats | None = None
    """The tolerance of each point, where these differ."""
    notes: Sequence[str] = ()
    """Sentences in addition to those of the result."""


@dataclass
class _Heading:
    text: str


@dataclass
class _Text:
    text: str


@dataclass
class _Table:
    """Rows of texts; a changed cell has the old text below the new one."""

    head: list[str]
    rows: list[list[str | tuple[str, str]]]
    #: Row and column of cells at a limit.
    limits: set[tuple[int, int]] = field(default_factory=set)
    #: ``"facts"``, ``"sign"`` or nothing.
    kind: str = ""


@dataclass
class _Drawing:
    """Lines and texts in mm of paper, y up."""

    width: float
    height: float
    lines: list[tuple[Floats, str, float]] = field(default_factory=list)
    segments: list[tuple[Floats, Floats, str, float]] = field(default_factory=list)
    texts: list[tuple[float, float, str, float, str, str]] = field(default_factory=list)

    def line(self, points: Floats, colour: str, width: float) -> None:
        self.lines.append((np.asarray(points, float), colour, width))

    def pairs(self, a: Floats, b: Floats, colour: str, width: float) -> None:
        self.segments.append((np.asarray(a, float), np.asarray(b, float), colour, width))

    def text(
        self, x: float, y: float, text: str, size: float = 2.4, anchor: str = "start",
        colour: str = _INK,
    ) -> None:  # fmt: skip
        self.texts.append((x, y, text, size, anchor, colour))


_Part = _Heading | _Text | _Table | _Drawing


@dataclass
class _Lines:
    """The curves of a result in common terms."""

    names: list[str]
    pairs: list[tuple[Spline, Spline]]
    lists: list[list[int]]
    data: Floats
    after: Floats
    off: Floats
    limits: Floats
    point_names: list[str]


def _three(points: Floats) -> Floats:
    out = np.zeros((len(points), 3))
    out[:, : points.shape[1]] = points
    return out


def _lines_of(result: Fairing | NetworkFairing, limits: Floats | None) -> _Lines:
    from moldloft.fairing.faired import Fairing

    data, after = result.data, _three(np.asarray(result.points))
    count = len(data)
    tol = np.inf if result.tol is None else result.tol
    each = np.full(count, tol) if limits is None else np.broadcast_to(limits, count)
    if isinstance(result, Fairing):
        off = result.residuals
        moved = np.linalg.norm(after - data, axis=1) if off is None else np.asarray(off)
        names = [f"point {k + 1}" for k in range(count)]
        each = each.copy()
        each[[f.index for f in result.corrected if f.kind == "outlier"]] = np.inf
        pair = (result.original, result.spline)
        return _Lines(["curve"], [pair], [list(range(count))], data, after, moved, each, names)
    moved = np.linalg.norm(after - data, axis=1)
    names = [result.point_name(k) for k in range(count)]
    curves = [result.name(k) for k in range(len(result.curves))]
    pairs = list(zip(result.originals, result.curves, strict=True))
    lists = [list(own) for own in result.lists]
    return _Lines(curves, pairs, lists, data, after, moved, each, names)


def _share(off: float, limit: float) -> str:
    if not np.isfinite(limit):
        return "released"
    return "fixed" if limit <= 0 else f"{100 * off / limit:.0f} %"


def _tolerance(lines: _Lines, unit: str | None) -> str:
    """The tolerances of the points that may move."""
    free = lines.limits[(lines.limits > 0) & np.isfinite(lines.limits)]
    if not len(free):
        return "none" if np.isinf(lines.limits).any() else "0: no point may move"
    low, high = float(free.min()), float(free.max())
    said = f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
    fixed = int((lines.limits == 0).sum())
    return f"{said} {unit or ''}".strip() + (f"; {fixed} points are fixed" if fixed else "")


def _facts(
    result: Fairing | NetworkFairing,
    lines: _Lines,
    details: SheetDetails,
) -> _Table:
    from moldloft.fairing.report import claims_optimum

    moved = int((lines.off > 1e-12 * max(float(np.abs(lines.data).max()), 1e-300)).sum())
    most = int(np.argmax(lines.off))
    moved_text = f"{moved} of {len(lines.data)} points"
    if moved:
        moved_text += f"; the largest move is {lines.off[most]:.4g} {details.unit or ''}".rstrip()
        moved_text += f" at {lines.point_names[most]}"
    before = sum(a.inflections() for a, _ in lines.pairs)
    after = sum(b.inflections() for _, b in lines.pairs)
    proved = "no optimum is claimed"
    if claims_optimum(result.gap, result.gap_relative):
        proved = (
            "no curves with these knots and parameters within the limits have a measure lower by "
            f"more than {result.gap_relative:.1e} of it"
        )
    far = (
        f"no point farther than {result.deviation_certified:.4g} from the one read"
        if hasattr(result, "lists")
        else f"curve to curve at most {result.deviation_certified:.4g}"
    )
    rows = [
        *details.facts,
        ("tolerance", _tolerance(lines, details.unit)),
        ("options", f"mode {result.mode}, goal {result.goal}, measure {result.measure}"),
        ("moved", moved_text),
        ("bends", f"{before} before, {after} after, over all curves"),
        ("certified", f"{far}; {proved}"),
        ("program", f"Moldloft {__version__}"),
    ]
    return _Table([], [[name, value] for name, value in rows], kind="facts")


def _apart(before: Spline, after: Spline) -> float:
    """The largest distance of two curves at equal parameters, sampled on the spans of both."""
    t = np.union1d(before.samples(12).t, after.samples(12).t)
    return float(np.linalg.norm(before(t) - after(t), axis=1).max())


def _curves(lines: _Lines) -> _Table:
    head = ["curve", "points", "bends before", "after", "pieces before", "after"]
    head += ["largest move", "at", "of its limit", "along the curve", "state"]
    rows: list[list[str | tuple[str, str]]] = []
    limits: set[tuple[int, int]] = set()
    for k, (before, after) in enumerate(lines.pairs):
        own = np.array(lines.lists[k])
        most = int(own[np.argmax(lines.off[own])])
        finite = lines.limits[own]
        reached = int(((lines.off[own] >= _AT_LIMIT * finite) & (finite > 0)).sum())
        along = _apart(before, after)
        moved = lines.off[most] > 0
        state = "unmoved" if not moved else "faired"
        if reached:
            state += f", {reached} at the limit"
            limits.add((k, len(head) - 1))
        rows.append(
            [
                lines.names[k],
                str(len(set(own.tolist()))),
                str(before.inflections()),
                str(after.inflections()),
                str(before.monotone_pieces()),
                str(after.monotone_pieces()),
                f"{lines.off[most]:.3g}" if moved else "0",
                lines.point_names[most] if moved else "",
                _share(float(lines.off[most]), float(lines.limits[most])) if moved else "",
                f"{along:.3g}",
                state,
            ]
        )
    return _Table(head, rows, limits)


def _offsets(table: SheetTable) -> list[_Part]:
    out: list[_Part] = []
    for first in range(0, len(table.stations), _COLUMNS):
        stations = table.stations[first : first + _COLUMNS]
        rows: list[list[str | tuple[str, str]]] = []
        for line in table.lines:
            row: list[str | tuple[str, str]] = [line]
            for station in stations:
                old, new = table.cells.get((line, station), ("", None))
                row.append(old if new is None else (new, old))
            if any(row[1:]):
                rows.append(row)
        out.append(_Table(["", *(s.removeprefix("station ") for s in stations)], rows))
    return out


def _points(lines: _Lines) -> _Table:
    width = 2 if not lines.data[:, 2].any() and not lines.after[:, 2].any() else 3
    head = ["point", *"xyz"[:width], *(f"{c} faired" for c in "xyz"[:width])]
    head += ["distance", "of its limit"]
    rows: list[list[str | tuple[str, str]]] = []
    limits = set()
    for k, (p, q) in enumerate(zip(lines.data, lines.after, strict=True)):
        numbers = [f"{float(x):.9g}" for x in (*p[:width], *q[:width])]
        share = _share(float(lines.off[k]), float(lines.limits[k]))
        rows.append([lines.point_names[k], *numbers, f"{lines.off[k]:.3g}", share])
        if lines.limits[k] > 0 and lines.off[k] >= _AT_LIMIT * lines.limits[k]:
            limits.add((k, len(head) - 1))
    return _Table(head, rows, limits)


def _suspects(found: Sequence[Suspect]) -> _Table:
    rows: list[list[str | tuple[str, str]]] = []
    for s in found:
        meant = f"{s.meant_reading} ({s.slip})" if s.slip else "no single slip explains it"
        gain = f"{100 * s.gain:.0f} %"
        rows.append([s.name, s.reading, meant, f"{s.score:.1f}", gain])
    return _Table(["offset", "as read", "probably meant", "errors off", "gain"], rows)


def _views(lines: _Lines) -> list[tuple[str, tuple[int, int]]]:
    both = np.vstack([lines.data, lines.after])
    if not both[:, 2].any():
        return [("To scale", (0, 1))]
    views = [("Profile", (0, 2)), ("Half-breadth plan", (0, 1)), ("Body plan", (1, 2))]
    return [v for v in views if min(float(np.ptp(both[:, c])) for c in v[1]) > 0]


def _scale(size: tuple[float, float], room: tuple[float, float], unit: str | None) -> float:
    """The largest scale at which a size fits, in mm of paper per unit of length."""
    most = min(r / s for r, s in zip(room, size, strict=True) if s > 0)
    if unit is None:
        return round_below(most)
    fits = [_MM[unit] / n for n in SCALES if _MM[unit] / n <= most]
    return fits[0] if fits else round_below(most)


def _stated(scale: float, unit: str | None) -> str:
    if unit is None:
        return f"1 unit of length is {scale:g} mm; the unit is not stated"
    ratio = _MM[unit] / scale
    return f"1 : {ratio:g}" if ratio >= 1 else f"{1 / ratio:g} : 1"


def _plan(lines: _Lines, unit: str | None) -> list[_Part]:
    """The lines at one scale, before and after, each view in a drawing with a bar."""
    views = _views(lines)
    both = np.vstack([lines.data, lines.after])
    sizes = [[float(np.ptp(both[:, c])) for c in axes] for _, axes in views]
    room = (_WIDE - 24.0, _TALL - 26.0)
    size = (max(s[0] for s in sizes), max(s[1] for s in sizes))
    scale = _scale(size, room, unit)
    parts: list[_Part] = [
        _Heading(f"Lines, {_stated(scale, unit)} on A4"),
        _Text("Faired curves are blue, curves through the offsets as read orange."),
    ]
    for name, (i, j) in views:
        low = both[:, [i, j]].min(axis=0)
        high = both[:, [i, j]].max(axis=0)
        tall = float(high[1] - low[1]) * scale + 22.0
        drawing = _Drawing(_WIDE, tall)

        def place(points: Floats, i: int = i, j: int = j, low: Floats = low) -> Floats:
            return np.asarray((points[:, [i, j]] - low) * scale + np.array([12.0, 13.0]))

        for before, after in lines.pairs:
            drawing.line(place(before.samples(12).points), BEFORE, 0.18)
            drawing.line(place(after.samples(12).points), AFTER, 0.3)
        drawing.text(12, tall - 4, name, 3.2)
        _bar(drawing, scale, unit)
        if i == 0:
            _stations(drawing, lines, place)
        parts.append(drawing)
    return parts


def _stations(drawing: _Drawing, lines: _Lines, place: Any) -> None:
    """Names of stations below a view along the ship."""
    last = -1e9
    for name, own in sorted(zip(lines.names, lines.lists, strict=True), key=lambda p: p[1][0]):
        points = lines.data[own]
        if not name.startswith("station ") or np.ptp(points[:, 0]) > 0:
            continue
        x = float(place(points)[0, 0])
        text = name.removeprefix("station ")
        if x - last > 1.6 * len(text) + 1.0:
            drawing.text(x, 8.6, text, 2.2, "middle", QUIET)
            last = x


def _bar(drawing: _Drawing, scale: float, unit: str | None) -> None:
    length = round_below(60.0 / scale)
    x, y = 12.0, 3.0
    drawing.line(np.array([[x, y], [x + length * scale, y]]), _INK, 0.5)
    for at in (x, x + length * scale):
        drawing.line(np.array([[at, y - 0.9], [at, y + 0.9]]), _INK, 0.35)
    drawing.text(x + length * scale + 2, y - 0.9, f"{length:g} {unit or ''}".strip())


def _combs(lines: _Lines, unit: str | None) -> list[_Part]:
    """Combs of the curves that are in planes of a view, before and after at one scale."""
    parts: list[_Part] = []
    for name, axes in _views(lines):
        ij, across = list(axes), 3 - sum(axes)
        shown = []
        for before, after in lines.pairs:
            points = after.control_points
            if np.ptp(points[:, across]) <= 1e-9 * np.ptp(points, axis=0).max():
                shown.append([even_turns(s, 0.05, 160) for s in (before, after)])
        extent = max((float(np.ptp(s[1].points[:, ij], axis=0).max()) for s in shown), default=0)
        bends = [by_length(s[1]) for s in shown]
        if not shown or float(np.max(bends)) * extent <= 1e-9:
            continue
        cut = min(3 * float(np.percentile(np.concatenate(bends), 80)), float(np.max(bends)))
        cut = cut or float(np.max(bends))
        tooth = 0.1 * extent / cut
        both = [[teeth(s[k], ij, cut, tooth) for s in shown] for k in (0, 1)]
        corners = np.vstack([p for combs in both for feet_tips in combs for p in feet_tips])
        low, size = corners.min(axis=0), np.ptp(corners, axis=0)
        scale = _scale((float(size[0]), float(size[1])), (_WIDE - 24, 0.44 * _TALL), unit)
        for combs, colour, word in zip(both, (BEFORE, AFTER), ("before", "after"), strict=True):
            tall = float(size[1]) * scale + 18.0
            drawing = _Drawing(_WIDE, tall)
            for feet, tips in combs:
                feet, tips = ((p - low) * scale + np.array([12.0, 8.0]) for p in (feet, tips))
                drawing.pairs(feet, tips, colour, 0.1)
                drawing.line(tips, colour, 0.22)
                drawing.line(feet, _INK, 0.25)
            drawing.text(12, tall - 4, f"{name}, combs {word}", 3.2)
            _bar(drawing, scale, unit)
            parts.append(drawing)
    if parts:
        parts[:0] = [
            _Heading("Curvature combs"),
            _Text(
                "A tooth is as long as the curve is bent there, on the outside of the bend. A fair "
                "curve has a smooth comb; where the comb changes sides the curve has an inflection."
            ),
        ]
    return parts


def _strips(lines: _Lines) -> list[_Part]:
    """Curvature over the length, and displacements of points with their limits, for each curve."""
    parts: list[_Part] = [
        _Heading("Curvature and deviation, curve by curve"),
        _Text(
            "Left: curvature along the curve, before orange, after blue. Right: the move of each "
            "point as a fraction of its limit; the upper line is the limit, dark bars are at it."
        ),
    ]
    wide, tall = _WIDE / 3 - 2, 34.0
    for first in range(0, len(lines.pairs), 3):
        drawing = _Drawing(_WIDE, tall + 3)
        for column, k in enumerate(range(first, min(first + 3, len(lines.pairs)))):
            _strip(drawing, lines, k, column * (_WIDE / 3), wide, tall)
        parts.append(drawing)
    return parts


def _strip(drawing: _Drawing, lines: _Lines, k: int, left: float, wide: float, tall: float) -> None:
    before, after = (s.samples(12) for s in lines.pairs[k])
    drawing.text(left, tall - 1, lines.names[k], 2.8)
    box = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], float)
    foot, height = 5.0, tall - 9.0
    half = 0.5 * wide - 3
    # Values dominated by steep ends are cut off: both ends of a waterline may be round.
    low, high = np.percentile(after.curvature, [1, 99])
    room = 0.35 * (high - low) or max(abs(high), 1e-300)
    low, high = min(low - room, 0.0), max(high + room, 0.0)
    for samples, colour, width in ((before, BEFORE, 0.18), (after, AFTER, 0.3)):
        y = (np.clip(samples.curvature, low, high) - low) / (high - low)
        at = np.column_stack([left + samples.arc * half, foot + y * height])
        drawing.line(at, colour, width)
    zero = foot + height * (0 - low) / (high - low)
    drawing.line(np.array([[left, zero], [left + half, zero]]), QUIET, 0.12)
    drawing.line(box * [half, height] + [left, foot], QUIET, 0.15)
    drawing.text(left, 1.4, f"curvature {low:.2g} to {high:.2g}", 2.0, "start", QUIET)
    own = lines.lists[k]
    right = left + half + 6
    drawing.line(box * [half - 2, height] + [right, foot], QUIET, 0.15)
    limit = lines.limits[own]
    used = np.where(
        (limit > 0) & np.isfinite(limit), lines.off[own] / np.where(limit > 0, limit, 1), 0
    )
    x = right + (np.arange(len(own)) + 0.5) * (half - 2) / len(own)
    tops = foot + height / 1.08 * np.minimum(used, 1.08)
    drawing.line(
        np.array([[right, foot + height / 1.08], [right + half - 2, foot + height / 1.08]]),
        BEFORE,
        0.15,
    )
    full = used >= _AT_LIMIT
    for mask, colour in ((~full, AFTER), (full, COLOURS["arrow"])):
        if mask.any():
            a = np.column_stack([x[mask], np.full(int(mask.sum()), foot)])
            b = np.column_stack([x[mask], tops[mask]])
            drawing.pairs(a, b, colour, 0.8)
    drawing.text(right, 1.4, "fraction of the limit at each point", 2.0, "start", QUIET)


def _findings(result: Fairing | NetworkFairing) -> list[str]:
    from moldloft.fairing.network import NetworkFairing

    if isinstance(result, NetworkFairing):
        return [f"{result.name(k)}: {result.text(f)}" for k, f in result.findings]
    kept = ", ".join(str(k + 1) for k in result.breaks)
    said = [f"corners are kept at points {kept}"] if kept else []
    return said + [f.text for f in result.findings]


def _parts(result: Fairing | NetworkFairing, details: SheetDetails) -> list[_Part]:
    if not hasattr(result, "data") or not (hasattr(result, "lists") or hasattr(result, "spline")):
        raise Error("a sheet is of curves and networks: surfaces have a report")
    lines = _lines_of(result, details.limits)
    parts: list[_Part] = [_facts(result, lines, details)]
    parts.append(
        _Table(["faired by", "checked by", "approved by", "date"], [["", "", "", ""]], kind="sign")
    )
    said_unit = (
        f"Lengths are in {_UNIT_NAMES[details.unit]}."
        if details.unit
        else "The unit of lengths is not stated."
    )
    if details.eighths:
        said_unit += (
            " Offsets are in feet, inches and eighths: 4-5-1+ is 4 feet, 5 inches, one eighth and "
            "a sixteenth."
        )
    parts += [_Heading("Curves"), _Text(said_unit), _curves(lines)]
    parts.append(
        _Text(
            "Bends are sign changes of the curvature, pieces its monotone pieces. "
            "The limit of a point is its tolerance. Along the curve is the largest distance from "
            "the curve before, sampled; between points it may exceed the tolerance."
        )
    )
    said = [*result.notes, *details.notes]
    said += _findings(result)
    if said:
        parts += [_Heading("Notes"), *(_Text(text) for text in said)]
    if details.suspects:
        parts += [_Heading("Suspects"), _suspects(details.suspects)]
        parts.append(
            _Text(
                "Offsets that contradict their neighbours, the clearest first, with the reading "
                "that a single slip of the pen explains. No offset was changed for it. The gain is "
                "the fraction of the local unfairness that the other reading removes."
            )
        )
    if details.table is not None:
        parts += [
            _Heading("Offsets"),
            _Text("Offsets that moved are marked: the faired one, and below it the one read."),
            *_offsets(details.table),
        ]
    else:
        parts += [_Heading("Points"), _points(lines)]
    parts += _plan(lines, details.unit)
    parts += _combs(lines, details.unit)
    return parts + _strips(lines)


def sheet(
    result: Fairing | NetworkFairing,
    title: str = "Fairing",
    details: SheetDetails | None = None,
) -> str:
    """The sheet of a faired curve or network as HTML that needs no other file.

    Parameters
    ----------
    result
        The result of :func:`moldloft.fair` for a curve, or of :func:`moldloft.fairing.network`.
    title
        Its heading, such as the name of the boat.
    details
        Source, table, unit and other data that are not in the result.

    Returns
    -------
    str
        HTML.
    """
    return _html(title, _parts(result, details or SheetDetails()))


def write_sheet(
    result: Fairing | NetworkFairing,
    path: str | PathLike[str],
    title: str = "Fairing",
    details: SheetDetails | None = None,
) -> Path:
    """Write a sheet atomically, in the format of the extension: ``.html`` or ``.pdf``.

    Parameters
    ----------
    result
        See :func:`sheet`.
    path
        The file. PDF needs reportlab (``pip install 'moldloft[plot]'``).
    title, details
        See :func:`sheet`.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    Error
        If the extension is another one, or reportlab is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> from moldloft import fair
    >>> x = np.linspace(0, 6, 13)
    >>> faired = fair(np.column_stack([x, np.round(np.sin(x / 3), 2)]), 0.005)
    >>> details = SheetDetails(facts=[("source", "sin.csv")], unit="m")
    >>> write_sheet(faired, getfixture("tmp_path") / "sheet.html", "A sine", details).name
    'sheet.html'
    """
    from moldloft.exchange.files import Output, commit

    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".html", ".htm", ".pdf"):
        raise Error(f"a sheet is an .html or .pdf file, not `{path.suffix}`")
    if ending == ".pdf":
        data = _pdf(title, _parts(result, details or SheetDetails()))
    else:
        data = sheet(result, title, details).encode()
    return commit(path.parent, [Output(path.name, data)])[0]


def _html(title: str, parts: Sequence[_Part]) -> str:
    page = [f"<h1>{escape(title)}</h1>"]
    for part in parts:
        match part:
            case _Heading(text):
                page.append(f"<h2>{escape(text)}</h2>")
            case _Text(text):
                page.append(f"<p>{escape(text)}</p>")
            case _Table():
                page.append(_html_table(part))
            case _Drawing():
                page.append(_svg(part))
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style><body>{chr(10).join(page)}</body></html>\n"
    )


def _html_table(table: _Table) -> str:
    kind = f' class="{table.kind}"' if table.kind else ""
    out = [f"<table{kind}>"]
    if table.head:
        out.append("<tr>" + "".join(f"<th>{escape(h)}</th>" for h in table.head) + "</tr>")
    for k, row in enumerate(table.rows):
        cells = []
        for j, cell in enumerate(row):
            if isinstance(cell, tuple):
                new, old = map(escape, cell)
                cells.append(f'<td class="moved">{new}<small>{old}</small></td>')
            else:
                marked = ' class="limit"' if (k, j) in table.limits else ""
                cells.append(f"<td{marked}>{escape(cell)}</td>")
        out.append("<tr>" + "".join(cells) + "</tr>")
    return "\n".join([*out, "</table>"])


def _svg(drawing: _Drawing) -> str:
    """A drawing in mm, so that a print keeps its scale."""
    tall = drawing.height
    out = []

    def d(points: Floats) -> str:
        return "M" + "L".join(f"{x:.2f} {tall - y:.2f}" for x, y in points)

    for points, colour, width in drawing.lines:
        out.append(f'<path d="{d(points)}" fill="none" stroke="{colour}" stroke-width="{width}"/>')
    for a, b, colour, width in drawing.segments:
        path = "".join(d(np.array([p, q])) for p, q in zip(a, b, strict=True))
        out.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="{width}"/>')
    for x, y, text, size, anchor, colour in drawing.texts:
        out.append(
            f'<text x="{x:.2f}" y="{tall - y:.2f}" font-size="{size}" font-family="Helvetica,Arial,'
            f'sans-serif" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>'
        )
    return (
        f'<svg width="{drawing.width:.1f}mm" height="{tall:.1f}mm" '
        f'viewBox="0 0 {drawing.width:.2f} {tall:.2f}">{"".join(out)}</svg>'
    )


def _plain(text: str) -> str:
    """Text limited to the characters of the standard PDF fonts."""
    return text.encode("cp1252", "replace").decode("cp1252")


def _pdf(title: str, parts: Sequence[_Part]) -> bytes:
    """The parts on A4 pages, the same bytes each time."""
    try:
        from reportlab.lib.pagesizes import A4, landscape
        from reportlab.lib.styles import getSampleStyleSheet
        from reportlab.lib.units import mm
        from reportlab.platypus import CondPageBreak, Paragraph, SimpleDocTemplate, Spacer
    except ImportError as error:
        raise Error("a sheet as PDF needs reportlab\nhelp: pip install 'moldloft[plot]'") from error
    styles = getSampleStyleSheet()
    body = styles["BodyText"].clone("body", fontSize=8, leading=10, spaceBefore=1)
    heading = styles["Heading2"].clone("head", fontSize=11, leading=13, spaceBefore=8)
    first = styles["Title"].clone("title", fontSize=15, leading=18, alignment=0, spaceAfter=4)
    story: list[Any] = [Paragraph(escape(_plain(title)), first)]
    for k, part in enumerate(parts):
        match part:
            case _Heading(text):
                behind = next((p for p in parts[k + 1 :] if not isinstance(p, _Text)), None)
                tall = behind.height if isinstance(behind, _Drawing) else 20.0
                story += [CondPageBreak((tall + 22) * mm), Paragraph(escape(_plain(text)), heading)]
            case _Text(text):
                story.append(Paragraph(escape(_plain(text)), body))
            case _Table():
                story += [_pdf_table(part, body), Spacer(1, 6)]
            case _Drawing():
                story += [_pdf_drawing(part), Spacer(1, 2)]
    page = io.BytesIO()

    def footer(canvas: Any, document: Any) -> None:
        canvas.saveState()
        canvas.setFont("Helvetica", 7)
        canvas.drawString(_MARGIN * mm, 7 * mm, _plain(title))
        right = (_PAPER[0] - _MARGIN) * mm
        canvas.drawRightString(right, 7 * mm, f"page {document.page}")
        canvas.restoreState()

    document = SimpleDocTemplate(
        page, pagesize=landscape(A4), title=title, author="", invariant=1,
        leftMargin=_MARGIN * mm - 6, rightMargin=_MARGIN * mm - 6,
        topMargin=_MARGIN * mm - 6, bottomMargin=_MARGIN * mm,
    )  # fmt: skip
    document.build(story, onFirstPage=footer, onLaterPages=footer)
    return page.getvalue()


def _pdf_table(table: _Table, body: Any) -> Any:
    from reportlab.lib import colors
    from reportlab.lib.units import mm
    from reportlab.platypus import Paragraph, Table, TableStyle

    small = body.clone("cell", fontSize=7, leading=8.4, spaceBefore=0)
    number = small.clone("number", alignment=2)

    def paragraph(cell: str | tuple[str, str], left: bool) -> Any:
        style = small if left else number
        if isinstance(cell, tuple):
            new, old = (escape(_plain(c)) for c in cell)
            return Paragraph(
                f'<b>{new}</b><br/><font size="6" color="{BEFORE}">{old}</font>', style
            )
        return Paragraph(escape(_plain(cell)), style)

    lead = [table.head] if table.head else []
    every: list[list[str | tuple[str, str]]] = [list(head) for head in lead]
    every += table.rows
    all_left = table.kind == "facts"
    cells = [[paragraph(c, all_left or j == 0) for j, c in enumerate(row)] for row in every]
    look: list[Any] = [
        ("GRID", (0, 0), (-1, -1), 0.3, colors.grey),
        ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("LEFTPADDING", (0, 0), (-1, -1), 3),
        ("RIGHTPADDING", (0, 0), (-1, -1), 3),
        ("TOPPADDING", (0, 0), (-1, -1), 1),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 1.5),
    ]
    if table.head:
        look.append(("BACKGROUND", (0, 0), (-1, 0), colors.whitesmoke))
    shift = len(lead)
    for k, row in enumerate(table.rows):
        for j, cell in enumerate(row):
            if isinstance(cell, tuple):
                look.append(("BACKGROUND", (j, k + shift), (j, k + shift), colors.HexColor(_MOVED)))
            elif (k, j) in table.limits:
                look.append(("BACKGROUND", (j, k + shift), (j, k + shift), colors.HexColor(_LIMIT)))
    columns = len(every[0]) if every else 1
    widths: list[float]
    if table.kind == "facts":
        widths = [24.0, _WIDE - 24.0]
    elif table.kind == "sign":
        widths = [_WIDE / columns] * columns
    else:
        widths = _widths(every)
    tall: list[float | None] = [None] * len(every)
    if table.kind == "sign":
        tall = [None, 11 * mm]
    return Table(
        cells, colWidths=[w * mm for w in widths], rowHeights=tall, repeatRows=shift, hAlign="LEFT",
        style=TableStyle(look),
    )  # fmt: skip


def _widths(rows: Sequence[Sequence[str | tuple[str, str]]]) -> list[float]:
    """Widths of columns in mm by their texts, made to fit the page."""
    columns = max(len(row) for row in rows)
    need = [4.0] * columns
    for row in rows:
        for j, cell in enumerate(row):
            texts = cell if isinstance(cell, tuple) else (cell,)
            need[j] = max(need[j], *(min(1.36 * len(t) + 2.6, 62.0) for t in texts))
    whole = sum(need)
    return [w * _WIDE / whole for w in need] if whole > _WIDE else need


def _pdf_drawing(drawing: _Drawing) -> Any:
    from reportlab.graphics.shapes import Drawing, PolyLine, String
    from reportlab.graphics.shapes import Path as Strokes
    from reportlab.lib import colors
    from reportlab.lib.units import mm

    out = Drawing(drawing.width * mm, drawing.height * mm)
    for points, colour, width in drawing.lines:
        out.add(
            PolyLine(
                [float(c) * mm for p in points for c in p],
                strokeColor=colors.HexColor(colour), strokeWidth=width * mm,
            )
        )  # fmt: skip
    for a, b, colour, width in drawing.segments:
        strokes = Strokes(
            strokeColor=colors.HexColor(colour), strokeWidth=width * mm, fillColor=None
        )
        for p, q in zip(a, b, strict=True):
            strokes.moveTo(float(p[0]) * mm, float(p[1]) * mm)
            strokes.lineTo(float(q[0]) * mm, float(q[1]) * mm)
        out.add(strokes)
    for x, y, text, size, anchor, colour in drawing.texts:
        out.add(
            String(
                x * mm, y * mm, _plain(text), fontName="Helvetica", fontSize=size * mm,
                textAnchor=anchor, fillColor=colors.HexColor(colour),
            )
        )  # fmt: skip
    return out


explain(globals())
