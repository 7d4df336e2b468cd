"""Components of CAD files: programs that their parents place, and the statements that do."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from moldloft.cad import identifier
from moldloft.shapes.nurbs import _braced, _plain

if TYPE_CHECKING:
    from moldloft.cad.faces import Imported
    from moldloft.shapes.nurbs import Nurbs

__all__ = ["components", "control", "placing_of"]

_VARIABLES = """\
vector origin = {0, 0, 0}, x_axis = {1, 0, 0}, y_axis = {0, 1, 0};
vector z_axis = x_axis .* y_axis;
"""
"""Variables that the parent replaces."""

_FUNCTIONS = {
    "at": """\
function vector at(vector p) { return origin + p.x*x_axis + p.y*y_axis + p.z*z_axis; }
""",
    "turned": """\
function vector turned(vector v) { return v.x*x_axis + v.y*y_axis + v.z*z_axis; }
""",
    "placed": """\
function curve placed(curve c) {
    farray x = c.x, y = c.y, z = c.z;
    return {
        origin.x + x*x_axis.x + y*y_axis.x + z*z_axis.x,
        origin.y + x*x_axis.y + y*y_axis.y + z*z_axis.y,
        origin.z + x*x_axis.z + y*y_axis.z + z*z_axis.z
    };
}
""",
}
"""The place of a point, a direction, and a row of points."""


def placing_of(body: str, part: Imported) -> str:
    """The variables of a component, and the functions that it uses.

    Parameters
    ----------
    body
        Its statements, without those that place components in it.
    part
        Its content.
    """
    used = body + ("at( turned(" if part.placed else "")
    words = (word for word in _FUNCTIONS if re.search(rf"\b{word}\(", used))
    return _VARIABLES + "".join(_FUNCTIONS[word] for word in words)


def control(shape: Nurbs, named: Mapping[int, str], moved: bool) -> str:
    """The control points of a component, moved to its place; empty for other programs.

    Parameters
    ----------
    shape
        The curve or surface.
    named
        Objects that are control points, by their numbers.
    moved
        True for a component.
    """
    if not moved:
        return ""
    points = [_braced(map(_plain, p)) for p in shape.points.reshape(-1, 3)]
    if not named:
        return f"placed({_braced(points)})"
    return _braced(named.get(k) or f"at({point})" for k, point in enumerate(points))


def components(part: Imported, names: Mapping[str, str]) -> str:
    """The statements that place components in a program.

    Parameters
    ----------
    part
        Content of the file or of a component.
    names
        Files of the components, by the names of their products.
    """
    taken = {face.name for face in part.faces} | {*part.curves, *part.reserved}
    lines = []
    for place in part.placed:
        origin, x_axis, y_axis = (_braced(map(_plain, v)) for v in place[2:])
        if part.reserved:
            origin, x_axis, y_axis = f"at({origin})", f"turned({x_axis})", f"turned({y_axis})"
        # Not wrapped: the name of the file may have blanks.
        lines.append(f'Component {identifier(place.name, taken)}("{names[place.part]}",\n')
        lines.append(f"    origin = {origin}, x_axis = {x_axis}, y_axis = {y_axis});\n")
    return "".join(lines)
