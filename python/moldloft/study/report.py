"""A study as one HTML page that opens offline: states, failures, plots, sensitivities."""

from __future__ import annotations

import itertools
import math
from base64 import b64encode
from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from moldloft.colours import COLOURS
from moldloft.study.robustness import sobol_indices, spreads, validity, worst_cases
from moldloft.study.store import Results

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["failures", "html", "sensitivities"]

#: Most cases that are drawn one by one. Plots of more show the number of cases by cells; parallel
#: coordinates show this number, evenly chosen, and the page states the number left out.
MAX_DRAWN = 2_000

#: Points of all lines of parallel coordinates: many inputs allow fewer cases.
MAX_LINE_POINTS = 40_000

#: Cells of a plot of more cases, and their shades, each for twice to eight times as many cases.
CELLS = (60, 40)
SHADES = (0.15, 0.3, 0.45, 0.6, 0.8, 1.0)

#: Plots of outputs by inputs.
MAX_SCATTERS = 60

#: Plans whose points fill the ranges, so that a regression means something.
SAMPLED = ("grid", "latin-hypercube", "sobol", "saltelli")

#: Rows listed of the table.
MAX_ROWS = 200

#: Correlations whose eigenvalue is below this fraction of the greatest are of dependent inputs.
RANK = 1e-10

WIDTH, HEIGHT, MARGIN = 300.0, 220.0, 58.0

_MUTED, _AXIS = COLOURS["muted"], COLOURS["line-grid"]
_POINT, _MARKED = COLOURS["accent"], COLOURS["mark"]

_STYLE = f"""
body{{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:76rem;padding:0 1rem;
color:{COLOURS["ink"]};background:{COLOURS["paper"]}}}
h1,h2{{font-weight:600}}table{{border-collapse:collapse;font-variant-numeric:tabular-nums}}
td,th{{padding:2px 12px 2px 0;text-align:right;border-bottom:1px solid {COLOURS["line"]}}}
th:first-child,td:first-child{{text-align:left}}.plots{{display:flex;flex-wrap:wrap;gap:1rem}}
figure{{margin:0}}figcaption{{font-size:13px;color:{_MUTED}}}
svg text{{font:11px system-ui;fill:{_MUTED}}}
.wide{{overflow-x:auto}}
@media (prefers-color-scheme:dark){{
body{{color:{COLOURS["ink-dark"]};background:{COLOURS["paper-dark"]}}}
td,th{{border-color:{COLOURS["line-dark"]}}}
figcaption{{color:{COLOURS["muted-dark"]}}}svg text{{fill:{COLOURS["muted-dark"]}}}}}
"""


def sensitivities(results: Results) -> dict[str, dict[str, float]]:
    """Standardised regression coefficients of each output by each input.

    Parameters
    ----------
    results
        The table.

    Returns
    -------
    dict
        Coefficients by output and input: the change of the output, in its standard deviations,
        by one standard deviation of the input. Empty where there are fewer cases than inputs.
    """
    done = results.done
    names = [n for n, c in results.inputs.items() if np.ptp(c[done]) > 0] if done.any() else []
    if done.sum() < len(names) + 2 or not names:
        return {}
    columns = np.stack([_standard(results.inputs[n][done]) for n in names])
    # The normal equations: correlations, which are well scaled, and small for a million cases.
    between = columns @ columns.T / done.sum()
    found = {}
    for output, values in results.outputs.items():
        if np.ptp(values[done]) > 0:
            with_output = columns @ _standard(values[done]) / done.sum()
            slopes, *_ = np.linalg.lstsq(between, with_output, rcond=RANK)
            found[output] = dict(zip(names, slopes.tolist(), strict=True))
    return found


def _standard(values: Floats) -> Floats:
    found: Floats = (values - values.mean()) / values.std()
    return found


def failures(results: Results) -> dict[str, int]:
    """The number of failures by id, the most frequent first."""
    failed = ~results.done & (results.state != "pending")
    found = Counter(results.id[failed].tolist())
    return dict(sorted(found.items(), key=lambda pair: (-pair[1], pair[0])))


def html(
    results: Results,
    title: str,
    facts: Mapping[str, str],
    saltelli: int = 0,
    tolerances: Mapping[str, float] | None = None,
    pictures: Sequence[tuple[str, bytes]] = (),
) -> bytes:
    """The page.

    Parameters
    ----------
    results
        The table.
    title
        The heading.
    facts
        Lines about the study, by name; sensitivities are given for a sampled `plan`.
    saltelli
        The `count` of a plan by Saltelli's scheme.
    tolerances
        Tolerances of manufacture by input: spreads of the outputs are stated.
    pictures
        Pictures of variants as PNG, with their captions.

    Returns
    -------
    bytes
        HTML without references to other files.
    """
    parts = [
        f"<h1>{escape(title)}</h1>",
        _rows(["", ""], [[k, v] for k, v in facts.items()]),
        "<h2>States</h2>",
        _rows(["state", "cases"], [[k, str(v)] for k, v in results.counts.items()]),
    ]
    if found := validity(results):
        parts.append(
            f"<p>Valid: {found.valid} of {found.cases} shapes, {100 * found.fraction:.1f} %; "
            f"of the space {100 * found.low:.1f} to {100 * found.high:.1f} % (95 %).</p>"
        )
    if failed := failures(results):
        parts += [
            "<h2>Failures</h2>",
            _rows(["reason", "cases"], [[k, str(v)] for k, v in failed.items()]),
            _plots(_failure_plots(results)),
        ]
    if results.done.any():
        parts += [
            "<h2>Numbers</h2>",
            _rows(["", "least", "mean", "greatest"], _statistics(results)),
        ]
        if rows := _tolerance_rows(results, tolerances or {}):
            header = ["", "RSS, mean", "RSS, greatest", "worst case, mean", "worst case, greatest"]
            parts += ["<h2>Tolerances of manufacture</h2>", _rows(header, rows)]
        if facts.get("plan") in SAMPLED:
            parts += _sensitivity_parts(results, saltelli)
        if results.objectives:
            parts += ["<h2>Objectives by evaluation</h2>", _plots(_histories(results))]
        parts += ["<h2>Outputs by inputs</h2>", _plots(_scatters(results))]
        if len(results.outputs) > 1:
            parts += ["<h2>Outputs by outputs</h2>", _plots(_output_plots(results))]
            if results.front is not None:
                parts.append(f"<p>Marked: the {results.front.sum()} points of the front.</p>")
        parts += ["<h2>Parallel coordinates</h2>", _parallel(results)]
        if pictures:
            parts += ["<h2>Variants</h2>", _plots([_picture(*each) for each in pictures])]
    parts += ["<h2>Cases</h2>", _listed(results)]
    body = "\n".join(parts)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>'
        '<meta name="viewport" content="width=device-width">'
        f"<style>{_STYLE}</style><body><main>{body}</main></body></html>\n"
    ).encode()


def _text(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"


def _rows(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(word)}</th>" for word in header)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(word)}</td>" for word in row) + "</tr>" for row in rows
    )
    top = f"<thead><tr>{head}</tr></thead>" if any(header) else ""
    return f'<div class="wide"><table>{top}<tbody>{body}</tbody></table></div>'


def _plots(figures: Sequence[str]) -> str:
    return f'<div class="plots">{"".join(figures)}</div>'


def _statistics(results: Results) -> list[list[str]]:
    done = results.done
    return [
        [name, *(_text(float(v)) for v in (c[done].min(), c[done].mean(), c[done].max()))]
        for name, c in {**results.inputs, **results.outputs}.items()
    ]


def _tolerance_rows(results: Results, tolerances: Mapping[str, float]) -> list[list[str]]:
    both = zip(
        spreads(results, tolerances).items(),
        worst_cases(results, tolerances).values(),
        strict=True,
    )
    return [
        [name, *(_text(float(v)) for c in (rss, worst) for v in (np.nanmean(c), np.nanmax(c)))]
        for (name, rss), worst in both
    ]


def _sensitivity_parts(results: Results, saltelli: int) -> list[str]:
    parts = []
    if indices := sobol_indices(results, saltelli) if saltelli else {}:
        names = list(results.inputs)
        rows = [
            [output, *(f"{own[n][0]:.3f} / {own[n][1]:.3f}" for n in names)]
            for output, own in indices.items()
        ]
        parts += ["<h2>Sobol indices (first order / total)</h2>", _rows(["", *names], rows)]
    if found := sensitivities(results):
        names = list(next(iter(found.values())))
        rows = [[output, *(f"{own[n]:+.3f}" for n in names)] for output, own in found.items()]
        parts += ["<h2>Standardised regression coefficients</h2>", _rows(["", *names], rows)]
    return parts


def _drawn(results: Results, chosen: NDArray[np.bool_], most: int) -> NDArray[np.int64]:
    """The rows drawn one by one, including those of a front."""
    rows = np.flatnonzero(chosen)
    if rows.size > most:
        few = rows[np.linspace(0, rows.size - 1, most).astype(int)]
        if results.front is not None:
            few = np.union1d(few, np.flatnonzero(results.front & chosen)[:most])
        rows = few
    return rows


def _histories(results: Results) -> list[str]:
    """Each objective by the number of the evaluation, points that better all before marked."""
    assert results.feasible is not None
    rows = np.flatnonzero(results.done)
    figures = []
    for name, sign in results.objectives.items():
        values = np.where(results.feasible, sign * results.outputs[name], np.inf)
        best = np.minimum.accumulate(values)
        better = np.concatenate([[True], best[1:] < best[:-1]]) & results.feasible
        marked = np.flatnonzero(better[rows])
        of = rows.astype(np.float64)
        figures.append(_scatter(of, results.outputs[name][rows], ("evaluation", name), marked))
    return figures


def _span(values: Floats) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def _dots(px: Floats, py: Floats, radius: int, colour: str) -> str:
    return "".join(
        f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{radius}" fill="{colour}" fill-opacity=".65"/>'
        for a, b in zip(px, py, strict=True)
    )


def _density(px: Floats, py: Floats) -> str:
    """Cells shaded by the logarithm of the number of cases in them."""
    across, down = CELLS
    wide, high = (WIDTH - MARGIN - 8) / across, (HEIGHT - MARGIN - 8) / down
    i = np.minimum(((px - MARGIN) / wide).astype(np.int64), across - 1)
    j = np.minimum(((py - 8) / high).astype(np.int64), down - 1)
    counts = np.bincount(i * down + j, minlength=across * down)
    filled = np.flatnonzero(counts)
    share = np.log1p(counts[filled]) / math.log1p(counts.max())
    shade = np.minimum((share * len(SHADES)).astype(int), len(SHADES) - 1)
    paths = []
    for k, opacity in enumerate(SHADES):
        cells = "".join(
            f"M{MARGIN + wide * (c // down):.1f} {8 + high * (c % down):.1f}h{wide:.1f}v{high:.1f}"
            f"h-{wide:.1f}z"
            for c in filled[shade == k].tolist()
        )
        if cells:
            paths.append(f'<path d="{cells}" fill="{_POINT}" fill-opacity="{opacity}"/>')
    return "".join(paths)


def _scatter(
    x: Floats, y: Floats, names: tuple[str, str], marked: NDArray[np.int64] | None = None
) -> str:
    (x0, x1), (y0, y1) = _span(x), _span(y)
    px = MARGIN + (x - x0) / (x1 - x0) * (WIDTH - MARGIN - 8)
    py = HEIGHT - MARGIN - (y - y0) / (y1 - y0) * (HEIGHT - MARGIN - 8)
    dots = _density(px, py) if len(x) > MAX_DRAWN else _dots(px, py, 2, _POINT)
    if marked is not None:
        few = marked[:MAX_DRAWN]
        dots += _dots(px[few], py[few], 3, _MARKED)
    right, low = WIDTH - 8, HEIGHT - MARGIN
    axes = (
        f'<path d="M{MARGIN} 8V{low}H{right}" fill="none" stroke="{_AXIS}"/>'
        f'<text x="{MARGIN}" y="{low + 14}">{_text(x0)}</text>'
        f'<text x="{right}" y="{low + 14}" text-anchor="end">{_text(x1)}</text>'
        f'<text x="{MARGIN - 4}" y="{low}" text-anchor="end">{_text(y0)[:8]}</text>'
        f'<text x="{MARGIN - 4}" y="16" text-anchor="end">{_text(y1)[:8]}</text>'
    )
    label = f"{names[1]} by {names[0]}"
    if len(x) > MAX_DRAWN:
        label += f", {len(x)} cases in {CELLS[0]} x {CELLS[1]} cells"
    return (
        f'<figure><svg role="img" aria-label="{escape(label)}" width="{WIDTH:.0f}" '
        f'height="{HEIGHT:.0f}">{axes}{dots}</svg><figcaption>{escape(label)}</figcaption></figure>'
    )


def _scatters(results: Results) -> list[str]:
    done = results.done
    pairs = itertools.product(results.outputs.items(), results.inputs.items())
    return [
        _scatter(x[done], y[done], (by, name))
        for (name, y), (by, x) in itertools.islice(pairs, MAX_SCATTERS)
    ]


def _output_plots(results: Results) -> list[str]:
    done = results.done
    columns = [(n, c[done]) for n, c in results.outputs.items()]
    marked = None if results.front is None else np.flatnonzero(results.front[done])
    return [
        _scatter(x, y, (a, b), marked)
        for k, (a, x) in enumerate(columns)
        for b, y in columns[k + 1 :]
    ][:30]


def _failure_plots(results: Results) -> list[str]:
    """The fraction of failures over tenths of each input's range."""
    failed = ~results.done & (results.state != "pending")
    figures = []
    for name, values in results.inputs.items():
        tried = np.isfinite(values)
        if not tried.any() or np.ptp(values[tried]) == 0:
            continue
        low, high = _span(values[tried])
        bins = np.clip(((values[tried] - low) / (high - low) * 10).astype(int), 0, 9)
        of = np.bincount(bins, minlength=10)
        wrong = np.bincount(bins, weights=failed[tried].astype(float), minlength=10)
        share = np.where(of > 0, wrong / np.maximum(of, 1), 0.0)
        width = (WIDTH - MARGIN) / 10
        bars = "".join(
            f'<rect x="{MARGIN + k * width:.1f}" y="{8 + 100 * (1 - s):.1f}" '
            f'width="{width - 2:.1f}" height="{100 * s:.1f}" fill="{_MARKED}"/>'
            for k, s in enumerate(share)
        )
        label = f"fraction of failures by {name}"
        figures.append(
            f'<figure><svg role="img" aria-label="{escape(label)}" width="{WIDTH:.0f}" '
            f'height="128">{bars}<path d="M{MARGIN} 8V108H{WIDTH}" fill="none" stroke="{_AXIS}"/>'
            f'<text x="{MARGIN - 4}" y="16" text-anchor="end">1</text>'
            f'<text x="{MARGIN}" y="122">{_text(low)}</text>'
            f'<text x="{WIDTH}" y="122" text-anchor="end">{_text(high)}</text></svg>'
            f"<figcaption>{escape(label)}</figcaption></figure>"
        )
    return figures


def _picture(caption: str, png: bytes) -> str:
    text, data = escape(caption), b64encode(png).decode()
    return (
        f'<figure style="width:{WIDTH:.0f}px"><img alt="{text}" width="{WIDTH:.0f}" '
        f'src="data:image/png;base64,{data}"><figcaption>{text}</figcaption></figure>'
    )


def _parallel(results: Results) -> str:
    columns = {**results.inputs, **results.outputs}
    rows = _drawn(results, results.done, min(MAX_DRAWN, MAX_LINE_POINTS // len(columns)))
    step = 110.0
    width, height = step * (len(columns) - 1) + 120, 260.0
    units = []
    for values in columns.values():
        low, high = _span(values[rows])
        units.append((values[rows] - low) / (high - low))
    last = units[-1]
    lines = []
    for k in range(rows.size):
        points = " ".join(
            f"{60 + step * i:.0f},{height - 40 - (height - 70) * float(u[k]):.1f}"
            for i, u in enumerate(units)
        )
        hue = 230 - 200 * float(last[k])
        lines.append(f'<polyline points="{points}" stroke="hsl({hue:.0f} 65% 45%)"/>')
    axes = "".join(
        f'<path d="M{60 + step * i:.0f} 30V{height - 40:.0f}" stroke="{_AXIS}"/>'
        f'<text x="{60 + step * i:.0f}" y="18" text-anchor="middle">{escape(n)}</text>'
        f'<text x="{60 + step * i:.0f}" y="{height - 24:.0f}" text-anchor="middle">'
        f"{_text(_span(c[rows])[0])}</text>"
        f'<text x="{60 + step * i + 4:.0f}" y="36">{_text(_span(c[rows])[1])}</text>'
        for i, (n, c) in enumerate(columns.items())
    )
    left = int(results.done.sum()) - rows.size
    note = f"{rows.size} cases, {left} more not drawn" if left else f"{rows.size} cases"
    return (
        f'<div class="wide"><svg role="img" aria-label="parallel coordinates" '
        f'width="{width:.0f}" height="{height:.0f}"><g fill="none" stroke-opacity=".35">'
        f"{''.join(lines)}</g>{axes}</svg></div><p>{note}; colour by the last column.</p>"
    )


def _listed(results: Results) -> str:
    derived = {f"d {name} / d {by}" for name, row in results.derivatives.items() for by in row}
    plain = {n: c for n, c in results.columns().items() if n not in derived}
    rows = [
        [
            str(k),
            *(_text(float(c[k])) if c.dtype == np.float64 else str(c[k]) for c in plain.values()),
        ]
        for k in range(min(len(results), MAX_ROWS))
    ]
    note = (
        f"<p>The first {MAX_ROWS} of {len(results)} cases.</p>" if len(results) > MAX_ROWS else ""
    )
    return _rows(["case", *plain], rows) + note
