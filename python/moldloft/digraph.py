"""The dependency digraph of a model as a picture: parents above, children below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

from moldloft.colours import COLOURS

__all__ = ["Node", "digraph_svg", "layers"]

_CHARACTER = 7.2
_BOX_HEIGHT = 34
_GAP_X = 14
_GAP_Y = 46
_MARGIN = 16
_SWEEPS = 8

_FILLED = ("point", "bead", "magnet", "ring", "curve", "snake", "surface")


@dataclass(frozen=True)
class Node:
    """An object of the graph."""

    name: str
    """Its name."""
    kind: str
    """Its entity kind."""
    class_: str
    """Its class, which decides the colour."""
    parents: Sequence[str]
    """Direct dependencies."""
    ok: bool = True
    """False when it failed; drawn with a red frame."""


def layers(nodes: Sequence[Node]) -> list[list[Node]]:
    """Nodes by depth, each below all its parents, ordered to keep lines short.

    >>> a, b = Node("a", "AbsPoint", "point", []), Node("b", "Line", "curve", ["a"])
    >>> [[node.name for node in layer] for layer in layers([a, b])]
    [['a'], ['b']]
    """
    known = {node.name for node in nodes}
    depth: dict[str, int] = {}
    # Parents come first in the order of declaration.
    for node in nodes:
        above = [depth[parent] for parent in node.parents if parent in depth]
        depth[node.name] = max(above, default=-1) + 1
    # An object without parents is directly above its first child.
    children: dict[str, list[str]] = {name: [] for name in known}
    for node in nodes:
        for parent in node.parents:
            if parent in known:
                children[parent].append(node.name)
    for node in nodes:
        if not node.parents and children[node.name]:
            depth[node.name] = min(depth[child] for child in children[node.name]) - 1
    rows: list[list[Node]] = [[] for _ in range(max(depth.values(), default=-1) + 1)]
    for node in nodes:
        rows[depth[node.name]].append(node)
    parents = {node.name: [p for p in node.parents if p in known] for node in nodes}
    for sweep in range(_SWEEPS):
        down = sweep % 2 == 0
        order = rows[1:] if down else rows[-2::-1]
        _sort_by_neighbours(order, rows, parents if down else children)
    return rows


def _sort_by_neighbours(
    order: Sequence[list[Node]], rows: Sequence[list[Node]], neighbours: Mapping[str, list[str]]
) -> None:
    """Sorts each row by the mean position of its neighbours (Sugiyama, Tagawa and Toda 1981)."""
    place = {node.name: k / max(len(row), 1) for row in rows for k, node in enumerate(row)}
    for row in order:
        mean = {
            node.name: sum(place[n] for n in neighbours[node.name]) / len(neighbours[node.name])
            if neighbours[node.name]
            else place[node.name]
            for node in row
        }
        row.sort(key=lambda node: mean[node.name])
        place.update({node.name: k / len(row) for k, node in enumerate(row)})


def digraph_svg(nodes: Sequence[Node], title: str) -> str:
    """The picture as SVG text; its size follows from the number of nodes."""
    rows = layers(nodes)
    size = {n.name: _CHARACTER * max(len(n.name), len(n.kind)) + 16 for n in nodes}
    spans = [sum(size[n.name] + _GAP_X for n in row) - _GAP_X for row in rows]
    width = max(spans, default=0) + 2 * _MARGIN
    height = len(rows) * (_BOX_HEIGHT + _GAP_Y) - _GAP_Y + 2 * _MARGIN
    place: dict[str, tuple[float, float]] = {}
    for k, (row, span) in enumerate(zip(rows, spans, strict=True)):
        x = (width - span) / 2
        for node in row:
            half = size[node.name] / 2
            place[node.name] = (x + half, _MARGIN + k * (_BOX_HEIGHT + _GAP_Y))
            x += 2 * half + _GAP_X
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
            f'viewBox="0 0 {width:.0f} {height:.0f}" font-family="sans-serif" font-size="12">',
            f"<title>{escape(title)}</title>",
            '<rect width="100%" height="100%" fill="white"/>',
            *(_line(place[p], place[n.name]) for n in nodes for p in n.parents if p in place),
            *(_box(node, *place[node.name], size[node.name]) for node in nodes),
            "</svg>\n",
        ]
    )


def _line(parent: tuple[float, float], child: tuple[float, float]) -> str:
    (x0, y0), (x1, y1) = parent, child
    y0 += _BOX_HEIGHT
    middle = (y0 + y1) / 2
    return (
        f'<path d="M{x0:.1f} {y0:.1f}'
        f'C{x0:.1f} {middle:.1f} {x1:.1f} {middle:.1f} {x1:.1f} {y1:.1f}"'
        ' fill="none" stroke="#777"/>'
    )


def _box(node: Node, x: float, y: float, width: float) -> str:
    fill = COLOURS[node.class_] if node.class_ in _FILLED else "#e6e6e6"
    frame = "#777" if node.ok else "#c00"
    return (
        f'<g text-anchor="middle"><rect x="{x - width / 2:.1f}" y="{y:.1f}" width="{width:.1f}" '
        f'height="{_BOX_HEIGHT}" rx="4" fill="{fill}" stroke="{frame}"/>'
        f'<text x="{x:.1f}" y="{y + 14:.1f}" font-weight="bold">{escape(node.name)}</text>'
        f'<text x="{x:.1f}" y="{y + 28:.1f}" fill="#555">{escape(node.kind)}</text></g>'
    )
