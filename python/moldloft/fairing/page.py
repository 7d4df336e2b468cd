"""A fairing as one HTML page: pictures to scale, and every point in a table."""

from __future__ import annotations

from collections.abc import Sequence
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
    MOVE,
    QUIET,
    WRONG,
    by_length,
    even_turns,
    exaggeration,
    round_below,
    teeth,
)

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from moldloft.fairing.faired import Fairing
    from moldloft.fairing.network import NetworkFairing
    from moldloft.fairing.patches import PatchesFairing
    from moldloft.fairing.spline import Spline
    from moldloft.fairing.surface import SplineSurface, SurfaceFairing

    Floats = NDArray[np.float64]

__all__ = ["page", "write_page"]

_INK, _MUTED, _LINE = COLOURS["ink"], COLOURS["muted"], COLOURS["line"]

_STYLE = (
    f"body{{font:14px/1.45 sans-serif;max-width:64em;margin:2em auto;padding:0 1em;color:{_INK}}}"
    f"h1{{font-size:1.4em}}h2{{font-size:1.1em;margin:1.8em 0 .4em}}"
    f"p.about{{color:{_MUTED};margin:.2em 0}}"
    "table{border-collapse:collapse;margin:.6em 0;font-variant-numeric:tabular-nums}"
    f"td,th{{border-bottom:1px solid {_LINE};padding:2px 10px;text-align:right}}"
    "td:first-child,th:first-child{text-align:left}"
    f"tr.limit td{{background:{COLOURS['row-limit']}}}"
    f"tr.wrong td{{background:{COLOURS['row-wrong']}}}"
    f"svg{{width:100%;height:auto;background:{COLOURS['paper']}}}"
    f"pre{{background:{COLOURS['ground']};padding:.8em;white-space:pre-wrap}}"
    f"figure{{margin:0}}figcaption{{color:{_MUTED};font-size:.92em}}"
    "@media print{body{margin:0;max-width:none}h2{break-after:avoid}figure{break-inside:avoid}}"
)

WIDE = 960.0


class _Picture:
    """Plane lines as SVG, by default with equal scales along both axes."""

    def __init__(self, corners: Floats, height: float | None = None) -> None:
        low, high = corners.min(axis=0), corners.max(axis=0)
        size = high - low
        largest = float(size.max()) or 1.0
        pad = 0.04 * largest
        self.margin = 28.0
        inner = WIDE - 2 * self.margin
        if height is None:
            self.scale = np.full(2, inner / max(float(size[0]) + 2 * pad, 0.6 * largest))
            tall = float(size[1] + 2 * pad) * self.scale[1]
            self.height = tall + 2 * self.margin
            self.origin = np.array([low[0] - pad, low[1] - pad])
            spare = inner - (size[0] + 2 * pad) * self.scale[0]
            self.origin[0] -= 0.5 * spare / self.scale[0]
        else:
            safe = np.where(size > 0, size, 1.0)
            self.height = height
            self.scale = np.array([inner / safe[0], (height - 2 * self.margin) / (1.08 * safe[1])])
            self.origin = low - np.array([0.0, 0.04 * safe[1]])
        self.parts: list[str] = []

    def place(self, points: Floats) -> Floats:
        """Points in the picture."""
        out = (np.asarray(points) - self.origin) * self.scale
        return np.column_stack([self.margin + out[:, 0], self.height - self.margin - out[:, 1]])

    def line(self, points: Floats, colour: str, width: float = 1.2, dash: str = "") -> None:
        at = self.place(points)
        d = "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in at)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<path d="{d}" fill="none" stroke="{colour}" stroke-width="{width}"{dashed}/>'
        )

    def segments(self, a: Floats, b: Floats, colour: str, width: float = 0.6) -> None:
        pairs = zip(self.place(a), self.place(b), strict=True)
        d = "".join(f"M{p[0]:.2f} {p[1]:.2f}L{q[0]:.2f} {q[1]:.2f}" for p, q in pairs)
        self.parts.append(f'<path d="{d}" stroke="{colour}" stroke-width="{width}" fill="none"/>')

    def dots(self, points: Floats, colour: str, titles: Sequence[str], radius: float = 2.2) -> None:
        for (x, y), title in zip(self.place(points), titles, strict=True):
            self.parts.append(
                f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius}" fill="{colour}">'
                f"<title>{escape(title)}</title></circle>"
            )

    def text(self, x: float, y: float, text: str, colour: str = _INK, end: bool = False) -> None:
        anchor = ' text-anchor="end"' if end else ""
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="12" font-family="sans-serif" '
            f'fill="{colour}"{anchor}>{escape(text)}</text>'
        )

    def bar(self) -> None:
        """A length that fits the picture, with its number."""
        length = round_below(0.18 * WIDE / float(self.scale[0]))
        x, y = self.margin, self.height - 8
        self.parts.append(
            f'<path d="M{x} {y}h{length * self.scale[0]:.2f}" stroke="{_INK}" stroke-width="1.5"/>'
        )
        self.text(x + float(length * self.scale[0]) + 6, y + 4, f"{length:g}")

    def svg(self, label: str) -> str:
        return (
            f'<svg viewBox="0 0 {WIDE:g} {self.height:.1f}" role="img" '
            f'aria-label="{escape(label)}">' + "".join(self.parts) + "</svg>"
        )


def _plane(points: Floats) -> tuple[int, int]:
    spread = np.ptp(points, axis=0)
    least = 2 if spread[2] <= 1e-12 * spread.max() else int(np.argmin(spread))
    i, j = (c for c in range(3) if c != least)
    return i, j


def _figure(picture: _Picture, caption: str) -> str:
    return f"<figure>{picture.svg(caption)}<figcaption>{escape(caption)}</figcaption></figure>"


def _number(x: float, least: float = 0.0) -> str:
    """A number to six digits; zero below `least`."""
    return f"{x:.6g}" if abs(x) > least else "0"


def _table(head: Sequence[str], rows: Sequence[tuple[str, Sequence[str]]]) -> str:
    top = "".join(f"<th>{escape(h)}</th>" for h in head)
    body = "".join(
        (f'<tr class="{kind}">' if kind else "<tr>")
        + "".join(f"<td>{escape(c)}</td>" for c in cells)
        + "</tr>"
        for kind, cells in rows
    )
    return f"<table><tr>{top}</tr>{body}</table>"


def _moved(
    data: Floats,
    moved: Floats,
    tol: float | None,
    curves: Sequence[tuple[Spline, Spline]],
    axes: tuple[int, int],
    wrong: set[int],
) -> str:
    """The shape to scale, with exaggerated displacements of points."""
    ij = list(axes)
    away = moved - data
    lengths = np.linalg.norm(away, axis=1)
    extent = float(np.ptp(data, axis=0).max())
    factor = exaggeration(lengths, extent)
    lines = [(a.samples(12).points, b.samples(12).points) for a, b in curves]
    corners = np.vstack([data[:, ij], (data + factor * away)[:, ij], *(b[:, ij] for _, b in lines)])
    picture = _Picture(corners)
    for before, after in lines:
        picture.line(before[:, ij], BEFORE, 0.8)
        picture.line(after[:, ij], AFTER, 1.3)
    full = tol is not None and tol > 0
    at_limit = lengths >= (1 - 1e-4) * tol if full and tol is not None else lengths < 0
    picture.segments(data[:, ij], (data + factor * away)[:, ij], MOVE, 1.1)
    for mask, colour in ((~at_limit, QUIET), (at_limit, BEFORE)):
        picked = np.flatnonzero(mask & ~np.isin(np.arange(len(data)), list(wrong)))
        titles = [f"point {k + 1}: moved {lengths[k]:.3g}" for k in picked]
        picture.dots(data[picked][:, ij], colour, titles)
    for k in wrong:
        picture.dots(data[[k]][:, ij], WRONG, [f"point {k + 1}: probably wrong"], 3.5)
    picture.bar()
    named = "".join("xyz"[c] for c in axes)
    picture.text(WIDE - 8, 16, f"{named[0]} to the right, {named[1]} up", QUIET, end=True)
    reached = int(at_limit.sum())
    said = f"; {reached} points (orange) are at their tolerance" if reached else ""
    largest = float(lengths.max(initial=0.0))
    moves = (
        f"Moves of the points (purple) are drawn {factor:g} times as long; the largest is "
        f"{largest:.3g}{said}."
        if largest > 0
        else "No point moved."
    )
    return _figure(picture, f"To scale: before orange, after blue. {moves}")


def _comb(fairing: Fairing, axes: tuple[int, int]) -> str:
    ij = list(axes)
    after = even_turns(fairing.spline)
    extent = float(np.ptp(after.points, axis=0).max())
    largest = float(np.abs(after.curvature).max())
    if largest * extent <= 1e-9:
        return "<p>The curve is straight: it has no comb.</p>"
    # A nose would leave the rest without teeth: these are cut where they are.
    usual = float(np.percentile(by_length(after), 80))
    cut = largest if largest <= 8 * usual else max(3 * usual, 1e-3 * largest)
    scale = 0.22 * extent / cut
    feet, tips = teeth(after, ij, cut, scale)
    _, rough = teeth(fairing.original.samples(12), ij, cut, scale)
    picture = _Picture(np.vstack([feet, tips, rough]))
    picture.line(rough, BEFORE, 0.5)
    picture.segments(feet, tips, AFTER, 0.5)
    picture.line(tips, AFTER, 1.1)
    picture.line(feet, _INK, 1.4)
    picture.bar()
    said = f"; teeth beyond {cut:.3g} are cut (largest {largest:.4g})" if cut < largest else ""
    return _figure(
        picture,
        f"Curvature comb of the faired curve, to scale, and its line before (orange){said}.",
    )


def _combs(pairs: Sequence[tuple[Spline, Spline]], axes: tuple[int, int]) -> str:
    """Combs of the curves in planes parallel to a view, before and after, with the same scale.

    Stations in the body plan, waterlines in the plan, buttocks in the profile.
    """
    ij, across = list(axes), 3 - sum(axes)
    shown = []
    for before, after in pairs:
        points = after.control_points
        if np.ptp(points[:, across]) <= 1e-9 * np.ptp(points, axis=0).max():
            shown.append((even_turns(before, 0.05, 160), even_turns(after, 0.05, 160)))
    bends = [by_length(after) for _, after in shown]
    extent = max((float(np.ptp(a.points[:, ij], axis=0).max()) for _, a in shown), default=0.0)
    if not shown or float(np.max(bends)) * extent <= 1e-9:
        return ""
    cut = 3 * float(np.percentile(np.concatenate(bends), 80))
    cut = min(cut, float(np.max(bends))) or float(np.max(bends))
    scale = 0.1 * extent / cut
    both = [[teeth(s[k], ij, cut, scale) for s in shown] for k in (0, 1)]
    corners = np.vstack([p for combs in both for feet_tips in combs for p in feet_tips])
    parts = []
    for combs, colour, word in zip(both, (BEFORE, AFTER), ("before", "after"), strict=True):
        picture = _Picture(corners)
        for feet, tips in combs:
            picture.segments(feet, tips, colour, 0.4)
            picture.line(tips, colour, 0.9)
            picture.line(feet, _INK, 1.0)
        picture.bar()
        caption = f"Curvature combs {word}, to scale; teeth beyond {cut:.3g} are cut."
        parts.append(_figure(picture, caption))
    return "".join(parts)


def _ticks(low: float, high: float, floor: float) -> list[float]:
    """Round numbers along an axis, which is logarithmic from `floor` on if that is not 0."""
    if floor <= 0:
        step = round_below(0.5 * (high - low))
        first, last = int(np.ceil(low / step)), int(np.floor(high / step))
        return [k * step for k in range(first, last + 1)]
    out = [0.0]
    for sign, most in ((1.0, high), (-1.0, -low)):
        value = 10.0 ** np.ceil(np.log10(2 * floor))
        while np.log1p(value / floor) < most:
            out.append(sign * float(value))
            value *= 10.0
    return out


def _bends(fairing: Fairing) -> str:
    """Curvature along the length, before and after; logarithmic where it spans decades."""
    before, after = fairing.original.samples(12), fairing.spline.samples(12)
    bend = np.abs(after.curvature)
    largest, usual = float(bend.max()), float(np.median(by_length(after)))
    swamped = usual > 0 and largest > 30 * usual

    def shown(values: Floats) -> Floats:
        if not swamped:
            return values
        floor = 0.3 * usual
        return np.asarray(np.sign(values) * np.log1p(np.abs(values) / floor))

    a, b = shown(before.curvature), shown(after.curvature)
    low, high = float(b.min()), float(b.max())
    room = 0.5 * (high - low) or max(abs(high), 1e-300)
    low, high = max(low - room, float(a.min())), min(high + room, float(a.max()))
    low, high = min(low, float(b.min())), max(high, float(b.max()))
    picture = _Picture(np.array([[0.0, low], [1.0, high]]), 260.0)
    picture.line(np.column_stack([before.arc, np.clip(a, low, high)]), BEFORE, 0.8)
    picture.line(np.column_stack([after.arc, b]), AFTER, 1.4)
    floor = 0.3 * usual
    for value in _ticks(low, high, floor if swamped else 0.0):
        y = float(shown(np.array([value]))[0])
        picture.line(np.array([[0.0, y], [1.0, y]]), _LINE if value else QUIET, 0.6)
        height = float(picture.place(np.array([[0.0, y]]))[0, 1])
        picture.text(WIDE - 2, height - 3, f"{value:g}", QUIET, end=True)
    picture.text(WIDE - 60, 12, f"largest {largest:.4g}, median {usual:.4g}", QUIET, end=True)
    picture.text(8, picture.height - 8, "fraction of the length", QUIET)
    how = "on a logarithmic scale" if swamped else "cut where it was rougher before"
    return _figure(picture, f"Curvature along the curve, {how}: before orange, after blue.")


def _points(
    data: Floats,
    after: Floats,
    off: Floats,
    tol: float | None,
    wrong: set[int],
    called: list[str] | None = None,
) -> str:
    """Every point: as given, as faired, and the distance, also in percent of the tolerance."""
    width = 2 if np.ptp(data[:, 2]) == 0 and not data[:, 2].any() else 3
    names = "xyz"[:width]
    head = ["point", *names, *(f"{c} faired" for c in names), "distance"]
    if tol:
        head.append("of the tolerance")
    rows = []
    rounding = 1e-14 * float(np.abs(data).max(initial=0.0))
    for k, (p, q, d) in enumerate(zip(data, after, off, strict=True)):
        name = str(k + 1) if called is None else called[k]
        cells = [name, *(_number(float(x), rounding) for x in (*p[:width], *q[:width]))]
        cells.append(f"{d:.3g}" if d > rounding else "0")
        if tol:
            cells.append(f"{100 * d / tol:.0f} %")
        limit = bool(tol) and d >= (1 - 1e-4) * (tol or 0.0)
        rows.append(("wrong" if k in wrong else "limit" if limit else "", cells))
    return _table(head, rows)


def _three(points: Floats) -> Floats:
    out = np.zeros((len(points), 3))
    out[:, : points.shape[1]] = points
    return out


def _of_curve(fairing: Fairing) -> list[str]:
    data = fairing.data
    after = _three(fairing.points)
    axes = _plane(fairing.original.samples(4).points)
    wrong = {f.index for f in (*fairing.findings, *fairing.corrected) if f.kind == "outlier"}
    off = fairing.residuals
    if off is None:
        off = np.linalg.norm(after - data, axis=1)
    parts = ["<h2>Shape</h2>"]
    parts.append(
        _moved(data, after, fairing.tol, [(fairing.original, fairing.spline)], axes, wrong)
    )
    parts += ["<h2>Curvature</h2>", _bends(fairing), _comb(fairing, axes)]
    parts += ["<h2>Points</h2>", _points(data, after, np.asarray(off), fairing.tol, wrong)]
    spline = fairing.spline
    rows = [
        ("", [str(k + 1), *(repr(float(x)) for x in p)])
        for k, p in enumerate(spline.control_points)
    ]
    knots = ", ".join(f"{float(k):.9g}" for k in spline.knots)
    parts += [
        f"<h2>Spline of degree {spline.degree}</h2>",
        f"<p>Knots: {knots}</p>",
        _table(["control point", "x", "y", "z"], rows),
    ]
    return parts


def _curves(fairing: NetworkFairing, pairs: list[tuple[Spline, Spline]], off: Floats) -> str:
    """Every curve: inflections, monotone pieces, and position of the largest displacement."""
    head = ["curve", "inflections", "faired", "monotone pieces", "faired", "largest move", "at"]
    if fairing.tol:
        head.append("of the tolerance")
    rows = []
    for k, (before, after) in enumerate(pairs):
        own = list(fairing.lists[k])
        most = own[int(np.argmax(off[own]))]
        counts = [before.inflections(), after.inflections()]
        counts += [before.monotone_pieces(), after.monotone_pieces()]
        cells = [fairing.name(k), *map(str, counts), f"{off[most]:.3g}"]
        cells.append(fairing.point_name(most) if off[most] > 0 else "")
        if fairing.tol:
            cells.append(f"{100 * off[most] / fairing.tol:.0f} %")
        rows.append(("", cells))
    return _table(head, rows)


def _of_network(fairing: NetworkFairing) -> list[str]:
    data, after = fairing.data, _three(fairing.points)
    if fairing.points.shape[1] == 2:
        views = [("Plan", (0, 1))]
    else:
        views = [("Plan", (0, 1)), ("Profile", (0, 2)), ("Body plan", (1, 2))]
    wrong = {f.index for _, f in fairing.findings if f.kind == "outlier"}
    pairs = list(zip(fairing.originals, fairing.curves, strict=True))
    parts = ["<h2>Curves</h2>", _curves(fairing, pairs, np.linalg.norm(after - data, axis=1))]
    for name, axes in views:
        if min(float(np.ptp(data[:, c])) for c in axes) > 0:
            parts += [f"<h2>{name}</h2>", _moved(data, after, fairing.tol, pairs, axes, wrong)]
            parts.append(_combs(pairs, axes))
    off = np.linalg.norm(after - data, axis=1)
    names = [fairing.point_name(k) for k in range(len(data))] if fairing.point_names else None
    parts += ["<h2>Points</h2>", _points(data, after, off, fairing.tol, wrong, names)]
    if fairing.findings:
        said = "".join(
            f"<li>{escape(fairing.name(k))}: {escape(fairing.text(f))}</li>"
            for k, f in fairing.findings
        )
        parts += ["<h2>Findings</h2>", f"<ul>{said}</ul>"]
    return parts


def _of_surface(fairing: SurfaceFairing) -> list[str]:
    data = fairing.data.reshape(-1, 3)
    moved = _three(np.asarray(fairing.points).reshape(-1, fairing.points.shape[-1]))
    return _surface(fairing.original, fairing.surface, "", data, moved)


def _of_patches(fairing: PatchesFairing) -> list[str]:
    parts = []
    for k, (before, after) in enumerate(zip(fairing.originals, fairing.surfaces, strict=True)):
        parts += _surface(before, after, f" of surface {k + 1}")
    return parts


def _surface(
    original: SplineSurface,
    surface: SplineSurface,
    of: str,
    data: Floats | None = None,
    moved: Floats | None = None,
) -> list[str]:
    """Three views of a surface, with displacements of its points if given."""
    before, after = (s.grid(61, 41) for s in (original, surface))
    both = np.vstack([before.reshape(-1, 3), after.reshape(-1, 3)])
    parts = []
    for name, axes in (("Plan", (0, 1)), ("Profile", (0, 2)), ("Body plan", (1, 2))):
        ij = list(axes)
        if min(float(np.ptp(both[:, c])) for c in axes) <= 0:
            continue
        caption = "To scale: before orange, after blue."
        tips = None
        if data is not None and moved is not None:
            away = np.linalg.norm(moved - data, axis=1)
            factor = exaggeration(away, float(np.ptp(data, axis=0).max()))
            tips = data + factor * (moved - data)
            caption += (
                f" Moves of the points (purple) are drawn {factor:g} times as long; the largest is "
                f"{away.max(initial=0.0):.3g}."
            )
        picture = _Picture((both if tips is None else np.vstack([both, tips]))[:, ij])
        for grid, colour, width in ((before, BEFORE, 0.5), (after, AFTER, 0.8)):
            for k in range(0, grid.shape[0], 4):
                picture.line(grid[k][:, ij], colour, width)
            for k in range(0, grid.shape[1], 4):
                picture.line(grid[:, k][:, ij], colour, width)
        if tips is not None and data is not None:
            picture.segments(data[:, ij], tips[:, ij], MOVE, 1.1)
        picture.bar()
        parts += [f"<h2>{name}{of}</h2>", _figure(picture, caption)]
    return parts


def page(
    fairing: Fairing | NetworkFairing | SurfaceFairing | PatchesFairing,
    title: str = "Fairing",
    facts: Sequence[tuple[str, str]] = (),
) -> str:
    """The HTML page of a fairing; it needs no other file and no network.

    Parameters
    ----------
    fairing
        What :func:`moldloft.fair`, :func:`moldloft.fairing.network` or
        :func:`moldloft.fairing.patches` returned.
    title
        Its heading.
    facts
        Entries below the heading in addition to the program version: names and values, such as
        the file, its unit and the command.

    Returns
    -------
    str
        HTML with its pictures inside.
    """
    from moldloft.fairing.faired import Fairing
    from moldloft.fairing.network import NetworkFairing
    from moldloft.fairing.surface import SurfaceFairing

    if isinstance(fairing, Fairing):
        parts = _of_curve(fairing)
    elif isinstance(fairing, NetworkFairing):
        parts = _of_network(fairing)
    elif isinstance(fairing, SurfaceFairing):
        parts = _of_surface(fairing)
    else:
        parts = _of_patches(fairing)
    report: Any = str(fairing)
    stated = [*facts, ("tolerance", _tolerance(fairing)), ("program", f"Moldloft {__version__}")]
    head = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in stated)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style>'
        f'<h1>{escape(title)}</h1><table class="facts">{head}</table>'
        f"<pre>{escape(report)}</pre>" + "".join(parts) + "</html>\n"
    )


def _tolerance(fairing: Any) -> str:
    tol = getattr(fairing, "tol", None)
    return "none" if tol is None else f"{tol:.6g}"


def write_page(
    fairing: Fairing | NetworkFairing | SurfaceFairing | PatchesFairing,
    path: str | PathLike[str],
    title: str = "Fairing",
    facts: Sequence[tuple[str, str]] = (),
) -> Path:
    """Writes :func:`page` to a file atomically.

    Parameters
    ----------
    fairing
        The faired result.
    path
        The file.
    title
        Its heading.
    facts
        See :func:`page`.

    Returns
    -------
    pathlib.Path
        The file.
    """
    from moldloft.exchange.files import Output, commit

    path = Path(path)
    if path.suffix.lower() not in (".html", ".htm"):
        raise Error(f"a page is .html, not `{path}`")
    return commit(
        path.parent, [Output(path.name, page(fairing, title, facts).encode())], make=False
    )[0]


explain(globals())
