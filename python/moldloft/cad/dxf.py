"""DXF files, by ezdxf (mozman, MIT): edges of faces and curves as splines, layers by name."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from moldloft import _core
from moldloft.cad import needed
from moldloft.cad.boundary import boundary
from moldloft.errors import FormatError

if TYPE_CHECKING:
    from moldloft.models import Model
    from moldloft.shapes.nurbs import Nurbs

__all__ = ["UNITS", "encode", "saved"]

UNITS = {"in": 1, "ft": 2, "mm": 4, "cm": 5, "m": 6}
"""$INSUNITS of DXF."""

_CLOSED, _RATIONAL, _PLANAR = 1, 4, 8


def encode(model: Model, stem: str, *, accuracy: float | None = None) -> bytes:
    """The bytes of a DXF file, R2018.

    Edges are on the layer of the first face that has them; each edge is written once.

    Parameters
    ----------
    model
        The model.
    stem
        The name of the file without its ending.
    accuracy
        The largest error of fits.
    """
    ezdxf: Any = needed("ezdxf", "ezdxf", "writing DXF")
    shape = boundary(model, accuracy=accuracy, name=stem)
    document = ezdxf.new("R2018", setup=False)
    document.header["$INSUNITS"] = UNITS[_core.length_unit(model._document)[0]]
    space = document.modelspace()
    done: set[int] = set()
    for face in shape.faces:
        layer = _layer(document, face.name, face.colour)
        for cycle in face.loops:
            for side in cycle:
                if side.edge not in done:
                    done.add(side.edge)
                    _spline(space, shape.edges[side.edge].curve, layer)
    for part in shape.parts:
        for name, colour, curve in part.wires:
            _spline(space, curve, _layer(document, name, colour))
        for name, colour, at in part.points:
            space.add_point(at, dxfattribs={"layer": _layer(document, name, colour)})
    if not len(space):
        raise FormatError("cannot write dxf: the model shows no surface and no curve")
    return saved(document)


def saved(document: Any) -> bytes:
    """The bytes of a document of ezdxf, reproducible: without times and random names."""
    ezdxf: Any = needed("ezdxf", "ezdxf", "writing DXF")
    document.ezdxf_metadata()["CREATED_BY_EZDXF"] = "moldloft"
    out = io.StringIO()
    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        document.write(out)
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before
    data: bytes = out.getvalue().encode("utf-8")
    return data


def _layer(document: Any, name: str, colour: tuple[int, int, int] | None) -> str:
    # Characters that names of layers may not have.
    plain = "".join("_" if c in '<>/\\":;?*|=`' else c for c in name) or "model"
    if plain not in document.layers:
        layer = document.layers.add(plain)
        if colour is not None:
            layer.rgb = colour
    return plain


def _spline(space: Any, curve: Nurbs, layer: str) -> None:
    """A spline with all data set directly: ezdxf's methods for weights make uniform knots."""
    if curve.degrees == (1,) and len(curve.points) == 2:
        space.add_line(*curve.points.tolist(), dxfattribs={"layer": layer})
        return
    spline = space.add_spline(dxfattribs={"layer": layer})
    spline.dxf.degree = curve.degrees[0]
    spline.control_points = curve.points.tolist()
    spline.knots = curve.knots[0].tolist()
    flags = 0
    if curve.weights is not None:
        spline.weights = curve.weights.tolist()
        flags |= _RATIONAL
    if (curve.points[0] == curve.points[-1]).all():
        flags |= _CLOSED
    if any((curve.points[:, k] == curve.points[0, k]).all() for k in range(3)):
        flags |= _PLANAR
    spline.dxf.flags = flags
