"""A stability booklet on one HTML page: weights, hydrostatics, curves, criteria."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft.errors import Error
from moldloft.units import header

if TYPE_CHECKING:
    from moldloft.models import Model
    from moldloft.stability import Stability, Wind

__all__ = ["booklet", "write_booklet"]

_STYLE = (
    "body{font:14px sans-serif;max-width:60em;margin:2em auto;color:#111}"
    "table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #999;padding:2px 8px;"
    "text-align:right}td:first-child,th:first-child{text-align:left}.fail{background:#fbb}"
    ".missing{background:#ffd}svg{max-width:100%}"
)
_COLUMNS = ["draft", "volume", "displacement", "lcb", "kb", "lcf", "waterplane_area", "kmt", "kml"]
_COLUMNS += ["tpc", "mtc", "wetted_area"]


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
    """The page of a loading.

    Parameters
    ----------
    stability
        The loading, of :meth:`moldloft.Model.stability`.
    rule, wind
        The criteria, as for :meth:`moldloft.stability.Stability.assess`.
    drafts
        Of the hydrostatic table; by default ten about the draught of the loading.
    heels
        Of the righting arms, in radians; by default 0 to 90 degrees by 5.
    """
    from moldloft.stability import cross_curves

    row = stability.upright
    units = model.units.complete() if model.units.length else model.units
    drafts = list(drafts) or [row.draft * (0.6 + 0.1 * k) for k in range(8)]
    heels = list(heels) or [math.radians(5 * k) for k in range(19)]
    table = model.hydrostatic_table(drafts, density=stability.density)
    names = [n for n in _COLUMNS if any(getattr(r, n) is not None for r in table)]
    parts = [f"<h1>Stability: {escape(title or 'loading')}</h1>"]
    parts.append(f"<pre>{escape(stability.summary())}</pre>")
    parts.append(
        "<p>All figures are integrals over the surfaces; the bound of the volume, relative, is "
        f"{row.bounds.get('volume', 0) / row.volume:.1g}.</p>"
    )
    weights = model.weights()
    if weights.rows:
        head = ["weight", "group"] + [header(n, units) for n in ("mass", "x", "y", "z")]
        body = [[w.name, w.group, *map(_short, (w.mass, *w.centre))] for w in weights.rows]
        body.append(["all", "", *map(_short, (weights.mass, *weights.centre))])
        parts += ["<h2>Weights</h2>", _table(head, body)]
    head = [header(n, units) for n in names]
    rows = [[_short(getattr(r, n)) for n in names] for r in table]
    parts += ["<h2>Hydrostatics, upright</h2>", _table(head, rows)]
    volumes = [row.volume * s for s in (0.7, 0.85, 1.0, 1.15)]
    curves = cross_curves(model, volumes, [math.radians(a) for a in (10, 20, 30, 40, 60)])
    head, values = curves._table()
    parts += ["<h2>Cross curves, trim free</h2>", _table(head, [[*map(_short, v)] for v in values])]
    arms = [stability.gz(h) for h in stability.grid(heels[0], heels[-1], heels[1] - heels[0])]
    degrees = [math.degrees(h) for h in heels]
    head = ["heel [deg]", header("gz", units), "area from 0 [" + (units.length or "-") + "·rad]"]
    rows = [
        [f"{a:.4g}", _short(g), _short(stability.area(0, h))]
        for a, g, h in zip(degrees, arms, heels, strict=True)
    ]
    parts += [
        "<h2>Righting arms</h2>",
        _plot(degrees, arms, header("GZ", units)),
        _table(head, rows),
    ]
    found = stability.assess(rule, wind=wind)
    parts += [f"<h2>{escape(found.rule)}</h2>", f"<p>{escape(found.source)}</p>"]
    head = ["clause", "what", "required", "attained", "margin", "unit", "result", "note"]
    lines = []
    for c in found.checks:
        numbers = [_short(c.required), _short(c.attained), _short(c.margin)]
        kind = {"fail": "fail", "data missing": "missing"}.get(c.result, "")
        cells = [c.clause, c.what, *numbers, c.unit, c.result, c.note]
        lines.append((kind, cells))
    parts.append(_table(head, [cells for _, cells in lines], [kind for kind, _ in lines]))
    page = "\n".join(parts)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style><body>{page}</body></html>\n"
    )


def write_booklet(
    path: str | os.PathLike[str], model: Model, stability: Stability, **options: Any
) -> Path:
    """Write :func:`booklet` to an ``.html`` file, whole or not at all."""
    from moldloft.files import Output, commit

    path = Path(path)
    if path.suffix.lower() not in (".html", ".htm"):
        raise Error(f"a booklet is an .html file, not `{path.suffix}`")
    options.setdefault("title", path.stem)
    return commit(path.parent, [Output(path.name, booklet(model, stability, **options).encode())])[
        0
    ]


def _short(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], kinds: Sequence[str] = ()) -> str:
    lines = ["<table><tr>" + "".join(f"<th>{escape(h)}</th>" for h in head) + "</tr>"]
    for k, row in enumerate(rows):
        kind = f' class="{kinds[k]}"' if kinds and kinds[k] else ""
        lines.append(f"<tr{kind}>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>")
    return "\n".join([*lines, "</table>"])


def _plot(x: Sequence[float], y: Sequence[float], label: str) -> str:
    """A curve over heel as SVG."""
    wide, tall, left, low = 640.0, 300.0, 60.0, 30.0
    top, bottom = max(*y, 0.0), min(*y, 0.0)
    reach = (top - bottom) or 1.0

    def place(a: float, b: float) -> str:
        px = left + (wide - left - 10) * (a - x[0]) / ((x[-1] - x[0]) or 1.0)
        return f"{px:.1f},{tall - low - (tall - low - 10) * (b - bottom) / reach:.1f}"

    curve = " ".join(place(a, b) for a, b in zip(x, y, strict=True))
    ticks = "".join(
        f'<text x="{place(a, bottom).split(",")[0]}" y="{tall - 8}" text-anchor="middle">'
        f"{a:g}</text>"
        for a in x[::2]
    )
    marks = "".join(
        f'<text x="{left - 6}" y="{place(x[0], v).split(",")[1]}" text-anchor="end">{v:.3g}</text>'
        for v in (bottom, 0.5 * (top + bottom), top)
    )
    zero = f'<polyline points="{place(x[0], 0)} {place(x[-1], 0)}" fill="none" stroke="#999"/>'
    return (
        f'<svg viewBox="0 0 {wide:g} {tall:g}" font-size="11" font-family="sans-serif">'
        f"{zero}{ticks}{marks}"
        f'<polyline points="{curve}" fill="none" stroke="#039" stroke-width="2"/>'
        f'<text x="{left + 6}" y="14">{escape(label)} over heel [deg]</text></svg>'
    )
