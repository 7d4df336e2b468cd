"""Moldloft: describe a shape, relate its parts, panel it, measure it, differentiate it.

>>> import moldloft
>>> m = moldloft.loads('''
... param float beam = 5.0 in [3, 7];
... AbsPoint A(0, 0, 0);
... AbsPoint B(10, beam, 0);
... Line keel(A, B);
... ''')
>>> m["keel"](0.5)
array([5. , 2.5, 0. ])
>>> m["beam"] = 4.0
>>> m["keel"](0.5)
array([5., 2., 0.])

Angles are in radians, lengths in the model's unit, and the parameters t, u, v of curves and
surfaces run over [0, 1].
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from moldloft._core import Diagnostic, __version__
    from moldloft.budget import limits
    from moldloft.builder import Builder, model, param
    from moldloft.errors import (
        Error,
        FairingError,
        FileError,
        FormatError,
        MissingPackageError,
        ModelError,
        UnknownNameError,
    )
    from moldloft.exchange.mesh_files import read_mesh
    from moldloft.fairing import fair
    from moldloft.hydro.hydrostatics import Hydrostatics, HydrostaticTable, RightingCurve
    from moldloft.implicit import Field, Set
    from moldloft.loading import load, loads
    from moldloft.models import Model, Param
    from moldloft.shapes.blocks import Block, Blocks
    from moldloft.shapes.measures import SurfaceMeasures
    from moldloft.shapes.mesh import Mesh, Patch
    from moldloft.shapes.nurbs import Nurbs
    from moldloft.shapes.objects import (
        Bead,
        Body,
        Contours,
        Curve,
        FieldObject,
        Frame,
        Magnet,
        Object,
        Plane,
        Point,
        Relabel,
        Ring,
        SetObject,
        Snake,
        Solid,
        Surface,
    )
    from moldloft.shapes.searches import Branch, Intersection, NearestPoints
    from moldloft.shapes.sketches import Sketch, SketchError

__all__ = [
    "Bead",
    "Block",
    "Blocks",
    "Body",
    "Branch",
    "Builder",
    "Contours",
    "Curve",
    "Diagnostic",
    "Error",
    "FairingError",
    "Field",
    "FieldObject",
    "FileError",
    "FormatError",
    "Frame",
    "HydrostaticTable",
    "Hydrostatics",
    "Intersection",
    "Magnet",
    "Mesh",
    "MissingPackageError",
    "Model",
    "ModelError",
    "NearestPoints",
    "Nurbs",
    "Object",
    "Param",
    "Patch",
    "Plane",
    "Point",
    "Relabel",
    "RightingCurve",
    "Ring",
    "Set",
    "SetObject",
    "Sketch",
    "SketchError",
    "Snake",
    "Solid",
    "Surface",
    "SurfaceMeasures",
    "UnknownNameError",
    "__version__",
    "fair",
    "limits",
    "load",
    "loads",
    "model",
    "param",
    "read_mesh",
]

_HOMES = {
    "limits": "moldloft.budget",
    "Block": "moldloft.shapes.blocks",
    "Blocks": "moldloft.shapes.blocks",
    "Builder": "moldloft.builder",
    "Diagnostic": "moldloft._core",
    "__version__": "moldloft._core",
    "Error": "moldloft.errors",
    "FairingError": "moldloft.errors",
    "FileError": "moldloft.errors",
    "FormatError": "moldloft.errors",
    "MissingPackageError": "moldloft.errors",
    "ModelError": "moldloft.errors",
    "UnknownNameError": "moldloft.errors",
    "HydrostaticTable": "moldloft.hydro.hydrostatics",
    "Field": "moldloft.implicit",
    "Set": "moldloft.implicit",
    "Hydrostatics": "moldloft.hydro.hydrostatics",
    "RightingCurve": "moldloft.hydro.hydrostatics",
    "Mesh": "moldloft.shapes.mesh",
    "Patch": "moldloft.shapes.mesh",
    "Model": "moldloft.models",
    "Param": "moldloft.models",
    "load": "moldloft.loading",
    "loads": "moldloft.loading",
    "read_mesh": "moldloft.exchange.mesh_files",
    "model": "moldloft.builder",
    "param": "moldloft.builder",
    "Nurbs": "moldloft.shapes.nurbs",
    "SurfaceMeasures": "moldloft.shapes.measures",
    "Bead": "moldloft.shapes.objects",
    "Body": "moldloft.shapes.objects",
    "Contours": "moldloft.shapes.objects",
    "Curve": "moldloft.shapes.objects",
    "FieldObject": "moldloft.shapes.objects",
    "Frame": "moldloft.shapes.objects",
    "Magnet": "moldloft.shapes.objects",
    "Object": "moldloft.shapes.objects",
    "Plane": "moldloft.shapes.objects",
    "Point": "moldloft.shapes.objects",
    "Relabel": "moldloft.shapes.objects",
    "Ring": "moldloft.shapes.objects",
    "SetObject": "moldloft.shapes.objects",
    "Snake": "moldloft.shapes.objects",
    "Solid": "moldloft.shapes.objects",
    "Surface": "moldloft.shapes.objects",
    "Branch": "moldloft.shapes.searches",
    "Intersection": "moldloft.shapes.searches",
    "NearestPoints": "moldloft.shapes.searches",
    "Sketch": "moldloft.shapes.sketches",
    "SketchError": "moldloft.shapes.sketches",
    "fair": "moldloft.fairing",
}

# Submodules that may be named after `import moldloft` alone.
_MODULES = (
    "deformation",
    "fairing",
    "functions",
    "grids",
    "implicit",
    "kinds",
    "overlays",
    "study",
)


def __getattr__(name: str) -> object:
    # Names are looked up when first used, so that the command answers at once.
    from importlib import import_module

    if name in _MODULES:
        return import_module(f"moldloft.{name}")
    home = _HOMES.get(name)
    if home is None:
        if name.startswith("_"):
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from moldloft.spelling import nearest

        near = nearest(name, [*__all__, *_MODULES])
        hint = f"; did you mean `{near}`?" if near else ""
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{hint}")
    value: object = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
