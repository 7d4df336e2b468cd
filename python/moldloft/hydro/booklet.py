"""A stability booklet, as one HTML page or as PDF: weights, hydrostatics, curves, criteria.

:func:`_parts` defines the content; both formats are drawn from the same parts.
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft.arguments import explain
from moldloft.errors import Error
from moldloft.units import header

if TYPE_CHECKING:
    from moldloft.hydro.stability import Stability, Wind
    from moldloft.models import Model

__all__ = ["booklet", "write_booklet"]

_STYLE = (
    "body{font:14px sans-serif;max-width:60em;margin:2em auto;color:#111}"
    "table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #999;padding:2px 8px;"
    "text-align:right}td:first-child,th:first-child{text-align:left}.fail{background:#fbb}"
    ".missing{background:#ffd}svg{max-width:100%}"
)
#: Of curves in one plot; dark enough on white for names in the same colour.
_SHADES = ("#003399", "#c04000", "#007a5a", "#8a2be2", "#5a5a5a")
_COLUMNS = ["draft", "volume", "displacement", "lcb", "kb", "lcf", "waterplane_area", "kmt", "kml"]
_COLUMNS += ["tpc", "mtc", "wetted_area"]


@dataclass
class _Heading:
    text: str


@dataclass
class _Text:
    text: str
    #: In columns that are set by blanks.
    columns: bool = False


@dataclass
class _Table:
    head: list[str]
    rows: list[list[str]]
    #: A word for each row: ``"fail"``, ``"missing"`` or nothing.
    kinds: list[str] = field(default_factory=list)


@dataclass
class _Plot:
    """Curves over the same abscissae."""

    x: list[float]
    curves: dict[str, list[float]]
    along: str
    up: str


_Part = _Heading | _Text | _Table | _Plot


def booklet(
    model: Model,
    stability: Stability,
    *,
    title: str = "",
    rule: str = "is-code-2008",
    wind: Wind | None = None,
    drafts: Sequence[float] = (),
    heels: Sequence[float] = (),
) -> str:
    """The booklet of a loading as an HTML page.

    Parameters
    ----------
    stability
        The loading, of :meth:`moldloft.Model.stability`.
    rule, wind
        The criteria, as for :meth:`moldloft.hydro.stability.Stability.assess`.
    drafts
        Drafts of the hydrostatic table; default: eight about the draft of the loading.
    heels
        Heels of the righting arms, in radians; default: 0 to 90 degrees in steps of 5.

    Returns
    -------
    str
        HTML that needs no other file.
    """
    parts = _parts(model, stability, rule, wind, drafts, heels)
    return _html(title or "loading", parts)


def _parts(
    model: Model,
    stability: Stability,
    rule: str,
    wind: Wind | None,
    drafts: Sequence[float],
    heels: Sequence[float],
) -> list[_Part]:
    """Contents of the booklet of a loading."""
    from moldloft.hydro.stability import cross_curves

    row = stability.upright
    units = model.units.complete() if model.units.length else model.units
    drafts = list(drafts) or [row.draft * (0.6 + 0.1 * k) for k in range(8)]
    heels = list(heels) or [math.radians(5 * k) for k in range(19)]
    bound = row.bounds.get("volume", 0) / row.volume
    parts: list[_Part] = [
        _Text(stability.summary(), columns=True),
        _Text(
            "All figures are integrals over the surfaces; the bound of the volume, relative, is "
            f"{bound:.1g}."
        ),
    ]
    weights = model.weights()
    if weights.rows:
        head = ["weight", "group"] + [header(n, units) for n in ("mass", "x", "y", "z")]
        body = [[w.name, w.group, *map(_short, (w.mass, *w.centre))] for w in weights.rows]
        body.append(["all", "", *map(_short, (weights.mass, *weights.centre))])
        parts += [_Heading("Weights"), _Table(head, body)]
    table = model.hydrostatic_table(drafts, density=stability.density)
    names = [n for n in _COLUMNS if any(getattr(r, n) is not None for r in table)]
    rows = [[_short(getattr(r, n)) for n in names] for r in table]
    parts += [_Heading("Hydrostatics, upright"), _Table([header(n, units) for n in names], rows)]
    volumes = [row.volume * s for s in (0.7, 0.85, 1.0, 1.15)]
    curves = cross_curves(model, volumes, [math.radians(a) for a in (10, 20, 30, 40, 60)])
    head, values = curves._table()
    parts += [
        _Heading("Cross curves, trim free"),
        _Plot(
            [float(v[0]) for v in values],
            {h: [float(v[k + 1]) for v in values] for k, h in enumerate(head[1:])},
            head[0],
            "KN",
        ),
        _Table(head, [[*map(_short, v)] for v in values]),
    ]
    arms = [stability.gz(h) for h in stability.grid(heels[0], heels[-1], heels[1] - heels[0])]
    degrees = [math.degrees(h) for h in heels]
    head = ["heel [deg]", header("gz", units), "area from 0 [" + (units.length or "-") + "·rad]"]
    rows = [
        [f"{a:.4g}", _short(g), _short(stability.area(0, h))]
        for a, g, h in zip(degrees, arms, heels, strict=True)
    ]
    parts += [
        _Heading("Righting arms"),
        _Plot(degrees, {header("gz", units): arms}, "heel [deg]", "GZ"),
        _Table(head, rows),
    ]
    found = stability.assess(rule, wind=wind)
    head = ["clause", "what", "required", "attained", "margin", "unit", "result", "note"]
    lines, kinds = [], []
    for c in found.checks:
        numbers = [_short(c.required), _short(c.attained), _short(c.margin)]
        kinds.append({"fail": "fail", "data missing": "missing"}.get(c.result, ""))
        lines.append([c.clause, c.what, *numbers, c.unit, c.result, c.note])
    parts += [_Heading(found.rule), _Text(found.source), _Table(head, lines, kinds)]
    return parts


def write_booklet(
    path: str | os.PathLike[str], model: Model, stability: Stability, **options: Any
) -> Path:
    """Write a booklet atomically, in the format of the extension: ``.html`` or ``.pdf``.

    Parameters
    ----------
    path
        The file. PDF needs reportlab (``pip install 'moldloft[plot]'``).
    options
        See :func:`booklet`.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    Error
        If the ending is another one, or reportlab is not installed.
    """
    from moldloft.exchange.files import Output, commit

    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".html", ".htm", ".pdf"):
        raise Error(f"a booklet is an .html or .pdf file, not `{path.suffix}`")
    title = options.pop("title", "") or path.stem
    if ending == ".pdf":
        asked = {"rule": "is-code-2008", "wind": None, "drafts": (), "heels": ()} | options
        if unknown := set(asked) - {"rule", "wind", "drafts", "heels"}:
            raise Error(f"a booklet has no option `{min(unknown)}`")
        data = _pdf(title, _parts(model, stability, **asked))
    else:
        data = booklet(model, stability, title=title, **options).encode()
    return commit(path.parent, [Output(path.name, data)], make=False)[0]


def _short(value: float | None) -> str:
    """Six digits; the rounding error of a zero is printed as zero."""
    if value is None:
        return "-"
    return "0" if abs(value) < 1e-11 else f"{value:.6g}"


def _html(title: str, parts: Sequence[_Part]) -> str:
    page = [f"<h1>Stability: {escape(title)}</h1>"]
    for part in parts:
        match part:
            case _Heading(text):
                page.append(f"<h2>{escape(text)}</h2>")
            case _Text(text, columns):
                page.append(f"<pre>{escape(text)}</pre>" if columns else f"<p>{escape(text)}</p>")
            case _Table(head, rows, kinds):
                page.append(_table(head, rows, kinds))
            case _Plot():
                page.append(_plot(part))
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style><body>{chr(10).join(page)}</body></html>\n"
    )


def _pdf(title: str, parts: Sequence[_Part]) -> bytes:
    """The parts on A4 pages, the same bytes each time."""
    try:
        from reportlab.lib import colors
        from reportlab.lib.pagesizes import A4
        from reportlab.lib.styles import getSampleStyleSheet
        from reportlab.platypus import (
            Paragraph,
            Preformatted,
            SimpleDocTemplate,
            Spacer,
            Table,
            TableStyle,
        )
    except ImportError as error:
        raise Error(
            "a booklet as PDF needs reportlab\nhelp: pip install 'moldloft[plot]'"
        ) from error
    styles = getSampleStyleSheet()
    small = styles["BodyText"].clone("cell", fontSize=6.5, leading=8, spaceBefore=0)
    story: list[Any] = [Paragraph(escape(f"Stability: {title}"), styles["Title"])]
    for part in parts:
        match part:
            case _Heading(text):
                story.append(Paragraph(escape(text), styles["Heading2"]))
            case _Text(text, columns):
                shown = (text, styles["Code"]) if columns else (escape(text), styles["BodyText"])
                story.append((Preformatted if columns else Paragraph)(*shown))
            case _Table(head, rows, kinds):
                cells = [[Paragraph(escape(c), small) for c in line] for line in [head, *rows]]
                look: list[Any] = [
                    ("GRID", (0, 0), (-1, -1), 0.4, colors.grey),
                    ("BACKGROUND", (0, 0), (-1, 0), colors.whitesmoke),
                    ("VALIGN", (0, 0), (-1, -1), "TOP"),
                ]
                for k, kind in enumerate(kinds, 1):
                    if kind:
                        colour = colors.pink if kind == "fail" else colors.lightyellow
                        look.append(("BACKGROUND", (0, k), (-1, k), colour))
                story += [Table(cells, repeatRows=1, style=TableStyle(look)), Spacer(1, 8)]
            case _Plot():
                story += [_pdf_plot(part), Spacer(1, 8)]
    page = io.BytesIO()
    document = SimpleDocTemplate(page, pagesize=A4, title=title, author="", invariant=1)
    document.build(story)
    return page.getvalue()


def _pdf_plot(plot: _Plot) -> Any:
    from reportlab.graphics.charts.lineplots import LinePlot
    from reportlab.graphics.shapes import Drawing, String
    from reportlab.lib import colors

    drawing = Drawing(450, 210)
    lines = LinePlot()
    lines.x, lines.y, lines.width, lines.height = 40, 30, 300, 160
    lines.data = [list(zip(plot.x, y, strict=True)) for y in plot.curves.values()]
    lines.joinedLines = 1
    shades = [colors.HexColor(c) for c in _SHADES]
    drawing.add(lines)
    for k, name in enumerate(plot.curves):
        shade = shades[k % len(shades)]
        lines.lines[k].strokeColor = shade
        drawing.add(String(350, 180 - 12 * k, name, fontSize=8, fillColor=shade))
    drawing.add(String(190, 6, plot.along, fontSize=8, textAnchor="middle"))
    drawing.add(String(8, 198, plot.up, fontSize=8))
    return drawing


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], kinds: Sequence[str] = ()) -> str:
    lines = ["<table><tr>" + "".join(f"<th>{escape(h)}</th>" for h in head) + "</tr>"]
    for k, row in enumerate(rows):
        kind = f' class="{kinds[k]}"' if kinds and kinds[k] else ""
        lines.append(f"<tr{kind}>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>")
    return "\n".join([*lines, "</table>"])


def _plot(plot: _Plot) -> str:
    """Curves as SVG."""
    wide, tall, left, right, low = 720.0, 300.0, 60.0, 130.0, 40.0
    x = plot.x
    values = [v for y in plot.curves.values() for v in y]
    top, bottom = max(*values, 0.0), min(*values, 0.0)
    reach = (top - bottom) or 1.0

    def place(a: float, b: float) -> tuple[str, str]:
        px = left + (wide - left - right) * (a - x[0]) / ((x[-1] - x[0]) or 1.0)
        return f"{px:.1f}", f"{tall - low - (tall - low - 20) * (b - bottom) / reach:.1f}"

    def line(points: Sequence[tuple[float, float]], colour: str, width: int) -> str:
        along = " ".join(",".join(place(a, b)) for a, b in points)
        return f'<polyline points="{along}" fill="none" stroke="{colour}" stroke-width="{width}"/>'

    drawn = [line([(x[0], 0), (x[-1], 0)], "#999", 1)]
    drawn += [
        f'<text x="{place(a, bottom)[0]}" y="{tall - 24}" text-anchor="middle">{a:.4g}</text>'
        for a in (x if len(x) < 8 else x[::2])
    ]
    drawn += [
        f'<text x="{left - 6}" y="{place(x[0], v)[1]}" text-anchor="end">{v:.3g}</text>'
        for v in (bottom, 0.5 * (top + bottom), top)
    ]
    drawn.append(
        f'<text x="{(left + wide - right) / 2}" y="{tall - 6}" text-anchor="middle">'
        f"{escape(plot.along)}</text>"
    )
    for k, (name, y) in enumerate(plot.curves.items()):
        shade = _SHADES[k % len(_SHADES)]
        drawn.append(line(list(zip(x, y, strict=True)), shade, 2))
        drawn.append(
            f'<text x="{wide - right + 20}" y="{24 + 15 * k}" fill="{shade}">{escape(name)}</text>'
        )
    return (
        f'<svg viewBox="0 0 {wide:g} {tall:g}" font-size="11" font-family="sans-serif">'
        f"{''.join(drawn)}</svg>"
    )


explain(globals())
