"""Implicit solids: primitives by arithmetic, sets, blends, and meshes of their boundaries.

A :class:`Field` is a function of space, negative in the solid, zero on the surface, positive in
air. A :class:`Set` combines the solid sides of fields by ``|``, ``&``, ``-`` and ``^``.
:class:`Facets` are its surface as triangles.

>>> from moldloft import implicit as im
>>> ball = im.sphere((0, 0, 0), 1)
>>> hole = im.cylinder((0, 0, 0), (0, 0, 1), 0.5)
>>> bead = im.Set(ball, name="ball") - im.Set(hole, name="hole")
>>> mass = bead.mass(depth=5)
>>> low, high = mass.volume_bracket
>>> low < mass.volume < high
True
>>> facets = bead.facets(depth=5)
>>> facets.closed, [patch.name for patch in facets.patches]
(True, ['ball', 'hole'])
"""

from moldloft.implicit.answers import Attributes, Distance, Hit, Lamp, Leaf, Mass, Nearest, Sun
from moldloft.implicit.blends import (
    Blend,
    fillet,
    liming,
    rounded,
    setback,
    transition,
    zhang,
)
from moldloft.implicit.divisions import Division, DivisionBox
from moldloft.implicit.facets import Contour, FacetPatch, Facets, Sheet, Unresolved
from moldloft.implicit.fields import (
    Field,
    atan2,
    axes,
    cone,
    cos,
    cyclide,
    cylinder,
    exp,
    function,
    ln,
    maximum,
    minimum,
    plane,
    read_fidget,
    read_libfive,
    s_sqrt,
    sign,
    sin,
    sphere,
    sqrt,
    tan,
    torus,
    twist,
)
from moldloft.implicit.hulls import convex_hull, intersection, minkowski_sum, union
from moldloft.implicit.primitives import cuboid, everything, nothing, point, segment, tetrahedron
from moldloft.implicit.sets import Set, load, loads
from moldloft.implicit.smooth import smooth_difference, smooth_intersection, smooth_union

__all__ = [
    "Attributes",
    "Blend",
    "Contour",
    "Distance",
    "Division",
    "DivisionBox",
    "FacetPatch",
    "Facets",
    "Field",
    "Hit",
    "Lamp",
    "Leaf",
    "Mass",
    "Nearest",
    "Set",
    "Sheet",
    "Sun",
    "Unresolved",
    "atan2",
    "axes",
    "cone",
    "convex_hull",
    "cos",
    "cuboid",
    "cyclide",
    "cylinder",
    "everything",
    "exp",
    "fillet",
    "function",
    "intersection",
    "liming",
    "ln",
    "load",
    "loads",
    "maximum",
    "minimum",
    "minkowski_sum",
    "nothing",
    "plane",
    "point",
    "read_fidget",
    "read_libfive",
    "rounded",
    "s_sqrt",
    "segment",
    "setback",
    "sign",
    "sin",
    "smooth_difference",
    "smooth_intersection",
    "smooth_union",
    "sphere",
    "sqrt",
    "tan",
    "tetrahedron",
    "torus",
    "transition",
    "twist",
    "union",
    "zhang",
]
