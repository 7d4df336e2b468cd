"""Display of models, objects, meshes and figures in notebooks, as HTML and SVG without a server."""

from __future__ import annotations

import base64
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any, cast

from moldloft.errors import Error
from moldloft.units import header, shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moldloft.hydro.hydrostatics import Hydrostatics, _Rows
    from moldloft.hydro.weights import WeightTable
    from moldloft.models import Model
    from moldloft.shapes.mesh import Mesh, Patch
    from moldloft.shapes.objects import Curve, Object, Surface

    Floats = NDArray[np.float64]

__all__ = [
    "mesh_html",
    "model_html",
    "object_html",
    "object_svg",
    "quality_html",
    "rows_html",
    "state_html",
    "weights_html",
    "worst_panel",
]

_MOST_ROWS = 40
_WIDTH, _HEIGHT, _MARGIN = 360.0, 220.0, 12.0
_LINES = 9
_POINTS = 49
_CELL = "padding:1px 10px 1px 0;text-align:"


def _table(header: Sequence[str], rows: Iterable[Sequence[object]], left: int = 1) -> str:
    def cells(tag: str, row: Sequence[object]) -> str:
        return "".join(
            f'<{tag} style="{_CELL}{"left" if k < left else "right"}">{escape(str(cell))}</{tag}>'
            for k, cell in enumerate(row)
        )

    head = f"<thead><tr>{cells('th', header)}</tr></thead>" if any(header) else ""
    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table>{head}<tbody>{body}</tbody></table>"


def _number(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return "–" if value is None else str(value)


def _picture(data: bytes, width: int) -> str:
    text = base64.b64encode(data).decode()
    return f'<img alt="" style="max-width:{width}px;width:100%" src="data:image/png;base64,{text}">'


def _is_points(value: object) -> bool:
    """True if a variable is an array of distinct points."""
    import numpy as np

    array = np.asarray(value) if isinstance(value, np.ndarray) else np.empty(0)
    if array.ndim < 2 or array.shape[-1] != 3:
        return False
    points = array.reshape(-1, 3)
    return bool((points != points[0]).any())


def model_html(model: Model) -> str:
    """A picture, the parameters with their ranges, the objects by kind, and diagnostics."""
    parts = [f"<strong>{escape(repr(model).strip('<>'))}</strong>"]
    try:
        shown = any(_drawn(fact) for fact in map(model.facts, model.objects))
        if shown or any(map(_is_points, model.variables.values())):
            parts.append("<br>" + _picture(model.picture(720, 405), 480))
    except Error as error:
        parts.append(f"<pre>{escape(str(error))}</pre>")
    params = list(model.params.values())
    if params:
        rows = [[p.name, _number(p.value), _number(p.low), _number(p.high)] for p in params]
        parts.append(_table(["parameter", "value", "least", "greatest"], rows[:_MOST_ROWS]))
    kinds = Counter(str(model.facts(name)["kind"]) for name in model.objects)
    if kinds:
        parts.append(f"<p>{', '.join(f'{n} {escape(kind)}' for kind, n in kinds.items())}</p>")
    wrong = model.diagnostics
    if wrong:
        parts.append(f"<pre>{escape(''.join(map(str, wrong[:5])).rstrip())}</pre>")
        if len(wrong) > 5:
            parts.append(f"<p>and {len(wrong) - 5} more in <code>diagnostics</code></p>")
    return "".join(parts)


def _drawn(fact: dict[str, Any]) -> bool:
    shapes = ("surface", "curve", "snake", "mesh", "solid", "contours")
    return bool(fact["ok"] and fact["shown"] and fact["class"] in shapes)


def object_html(thing: Object) -> str:
    """A drawing of a curve or surface, its numbers, and its dependencies."""
    try:
        fact = thing._facts()
    except Error as error:
        return f"<pre>{escape(str(error))}</pre>"
    parts = [f"<strong>{escape(thing.name)}</strong> {escape(fact['kind'])}, {fact['class']}"]
    if not fact["ok"]:
        return parts[0] + "<br>it was not made; see <code>diagnostics</code>"
    drawing = object_svg(thing)
    if drawing:
        parts.append("<br>" + drawing)
    rows = []
    for name in thing.members:
        if name in ("u0", "u1", "v0", "v1", "c00", "c10", "c11", "c01", "alternatives", "start"):
            continue
        try:
            value = thing._document.eval(f"{thing.name}.{name}")
        except Error:
            # The volume of an open surface is no number.
            continue
        if isinstance(value, float):
            rows.append([name, _number(value)])
        elif getattr(value, "shape", None) == (3,):
            rows.append([name, ", ".join(_number(float(x)) for x in value)])
    for word in ("parents", "children"):
        if fact[word]:
            names = list(fact[word])
            more = f" and {len(names) - 8} more" if len(names) > 8 else ""
            rows.append([word, ", ".join(names[:8]) + more])
    if rows:
        parts.append(_table(["", ""], rows))
    return "".join(parts)


def _lines(thing: Object) -> list[Floats]:
    """Lines that represent an object: the curve, or lines of constant u and v of the surface."""
    import numpy as np

    t = np.linspace(0, 1, _POINTS)
    # By the word of its class: `objects` imports this module.
    if thing.class_ in ("curve", "snake"):
        return [cast("Curve", thing)(t)]
    if thing.class_ == "surface":
        thing = cast("Surface", thing)
        even = np.linspace(0, 1, _LINES)
        along = thing(even[:, None], t[None, :])
        across = thing(t[None, :], even[:, None])
        return [*along, *across]
    return []


def object_svg(thing: Object) -> str:
    """A parallel view of a curve or surface as SVG; empty for other objects."""
    try:
        lines = _lines(thing)
    except Error:
        return ""
    return lines_svg(lines)


def lines_svg(lines: Sequence[Floats]) -> str:
    """Lines in space as SVG, seen from starboard forward and above, z up."""
    import numpy as np

    kept = [line for line in lines if np.all(np.isfinite(line))]
    if not kept:
        return ""
    azimuth, elevation = math.radians(-60), math.radians(25)
    right = np.array([-math.sin(azimuth), math.cos(azimuth), 0.0])
    towards = np.array(
        [
            math.cos(elevation) * math.cos(azimuth),
            math.cos(elevation) * math.sin(azimuth),
            math.sin(elevation),
        ]
    )
    up = np.cross(towards, right)
    flat = [np.column_stack([line @ right, -(line @ up)]) for line in kept]
    every = np.concatenate(flat)
    low, high = every.min(axis=0), every.max(axis=0)
    size = np.maximum(high - low, 1e-300)
    inner = (_WIDTH - 2 * _MARGIN, _HEIGHT - 2 * _MARGIN)
    scale = min(inner[0] / size[0], inner[1] / size[1])
    middle = (low + high) / 2
    paths = []
    for line in flat:
        place = (line - middle) * scale + np.array([_WIDTH / 2, _HEIGHT / 2])
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in place)
        paths.append(f'<polyline points="{points}"/>')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH:.0f}" height="{_HEIGHT:.0f}" '
        f'viewBox="0 0 {_WIDTH:.0f} {_HEIGHT:.0f}" fill="none" stroke="#2878b5" '
        f'stroke-width="1">{"".join(paths)}</svg>'
    )


def worst_panel(patch: Patch, metric: str) -> str:
    """The largest value of a quality metric; a dash for a patch without panels."""
    figures = patch.quality.get(metric)
    return "-" if figures is None else f"{figures['max']:.3g}"


def mesh_html(mesh: Mesh) -> str:
    """The patches of a mesh with their areas and worst panels, and whether it is closed."""
    rows = []
    for patch in mesh.patches[:_MOST_ROWS]:
        worst = [worst_panel(patch, name) for name in ("aspect", "skew", "warp")]
        closed = "yes" if patch.closed else "no"
        rows.append([patch.name, patch.kind, patch.panels, _number(patch.area), closed, *worst])
    header = ["patch", "kind", "panels", "area", "closed", "aspect", "skew", "warp"]
    more = len(mesh.patches) - _MOST_ROWS
    note = f"<p>and {more} more patches</p>" if more > 0 else ""
    return f"<strong>{escape(repr(mesh).strip('<>'))}</strong>{_table(header, rows, 2)}{note}"


def quality_html(quality: dict[str, dict[str, Any]]) -> str:
    """The worst panel of each patch in each measure."""
    ends = {"aspect": "max", "skew": "max", "warp": "max", "jump": "max", "angle": "min"}
    rows = []
    for name, measures in list(quality.items())[:_MOST_ROWS]:
        values = [measures.get(word, {}).get(end) for word, end in ends.items()]
        rows.append([name, *map(_number, values)])
    return _table(["patch", *ends], rows)


def state_html(state: Hydrostatics) -> str:
    """The figures of a floating body with units and bounds; angles in degrees."""
    hidden = {"bounds", "derivatives", "iterations", "residual", "outward", "lolls", "accuracy"}
    rows = []
    for name, value in state.as_dict().items():
        if name in hidden or isinstance(value, dict):
            continue
        bound = f"± {state.bounds[name]:.1g}" if name in state.bounds else ""
        rows.append([name, _number(shown(name, value)), state.unit(name), bound])
    note = "".join(f"<p>{remark}</p>" for remark in state.remarks)
    return _table(["figure", "value", "unit", "bound"], rows) + note


def rows_html(table: _Rows, names: Sequence[str]) -> str:
    """A table of figures with units in the header; angles in degrees."""
    kept = [name for name in names if any(getattr(row, name) is not None for row in table)]
    head = [header(name, table.units) for name in kept]
    rows = [[_number(shown(name, getattr(row, name))) for name in kept] for row in table]
    more = len(rows) - _MOST_ROWS
    note = f"<p>and {more} more rows</p>" if more > 0 else ""
    return _table(head, rows[:_MOST_ROWS], 0) + note


def weights_html(table: WeightTable) -> str:
    """The weights as the command prints them."""
    return f"<pre>{escape(str(table))}</pre>"
