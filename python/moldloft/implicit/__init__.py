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
from moldloft.implicit.divisions import Division, DivisionBox
from moldloft.implicit.facets import Contour, FacetPatch, Facets, Sheet, Unresolved
from moldloft.implicit.fields import (
    Field,
    atan2,
    axes,
    cos,
    exp,
    function,
    ln,
    maximum,
    minimum,
    read_fidget,
    read_libfive,
    s_sqrt,
    sign,
    sin,
    sqrt,
    tan,
    twist,
)
from moldloft.implicit.hulls import intersection, union
from moldloft.implicit.primitives import point, segment
from moldloft.implicit.rows import *  # noqa: F403
from moldloft.implicit.rows import __all__ as _functions
from moldloft.implicit.sets import Set, load, loads

__all__ = [
    "Attributes",
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
    "cos",
    "exp",
    "function",
    "intersection",
    "ln",
    "load",
    "loads",
    "maximum",
    "minimum",
    "point",
    "read_fidget",
    "read_libfive",
    "s_sqrt",
    "segment",
    "sign",
    "sin",
    "sqrt",
    "tan",
    "twist",
    "union",
    *_functions,
]
