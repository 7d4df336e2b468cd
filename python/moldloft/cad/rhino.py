"""3DM files, by rhino3dm (McNeel, MIT).

Faces with all of their surface are NURBS surfaces; trimmed planes are trimmed B-reps. rhino3dm
cannot trim other surfaces nor join faces: a trimmed surface is written whole, grouped with its
trimming curves, and its attributes record this. Joined bodies are exchanged as STEP, which Rhino
reads.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from moldloft import _core
from moldloft.cad import needed
from moldloft.cad.boundary import Boundary, Face, boundary
from moldloft.errors import FormatError

if TYPE_CHECKING:
    from moldloft.models import Model
    from moldloft.shapes.nurbs import Nurbs

__all__ = ["UNIT_SYSTEMS", "encode", "file_bytes"]

UNIT_SYSTEMS = {
    "mm": "Millimeters",
    "cm": "Centimeters",
    "m": "Meters",
    "ft": "Feet",
    "in": "Inches",
}
"""Names of units of length in Rhino."""


def encode(model: Model, stem: str, *, accuracy: float | None = None) -> bytes:
    """The bytes of a 3DM file.

    Parameters
    ----------
    model
        The model.
    stem
        The name of the file without its ending.
    accuracy
        The largest error of fits.
    """
    rhino: Any = needed("rhino3dm", "rhino3dm", "writing 3DM")
    shape = boundary(model, accuracy=accuracy, name=stem, facing=True)
    if not shape.faces and not shape.parts:
        raise FormatError("cannot write 3dm: the model shows no surface and no curve")
    file = rhino.File3dm()
    file.Settings.ModelUnitSystem = getattr(
        rhino.UnitSystem, UNIT_SYSTEMS[_core.length_unit(model._document)[0]]
    )
    file.Settings.ModelAbsoluteTolerance = max(1.5 * shape.gap, 1e-9)
    layers: dict[str, int] = {}
    for face in shape.faces:
        _face(rhino, file, layers, shape, face)
    for part in shape.parts:
        for name, colour, curve in part.wires:
            attributes = _attributes(rhino, file, layers, name, colour, ())
            file.Objects.AddCurve(_curve(rhino, curve), attributes)
        for name, colour, at in part.points:
            attributes = _attributes(rhino, file, layers, name, colour, ())
            file.Objects.AddPoint(rhino.Point3d(*at), attributes)
    data: bytes = file_bytes(file)
    return data


def file_bytes(file: Any) -> bytes:
    """The bytes of a file of rhino3dm.

    Parameters
    ----------
    file
        A `rhino3dm.File3dm`.
    """
    from pathlib import Path
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        path = Path(folder) / "model.3dm"
        if not file.Write(str(path), 8):
            raise FormatError("cannot write 3dm: rhino3dm refuses")
        return path.read_bytes()


def _face(rhino: Any, file: Any, layers: dict[str, int], shape: Boundary, face: Face) -> None:
    attributes = _attributes(rhino, file, layers, face.name, face.colour, face.layers)
    attributes.SetUserString("accuracy", "exact" if face.exact else f"{face.error:.3g}")
    if face.surface is None:
        # One curve for each loop: the plane is trimmed by them.
        curves = [_loop(rhino, shape, cycle) for cycle in face.loops]
        outer = rhino.Brep.CreateTrimmedPlane(_plane(rhino, face), curves[0])
        if outer is not None and len(curves) == 1:
            file.Objects.AddBrep(outer, attributes)
            return
        for curve in curves:
            file.Objects.AddCurve(curve, attributes)
        return
    surface = _surface(rhino, face.surface)
    if not face.natural:
        attributes.SetUserString("trimmed", "the curves of its group bound the face")
        group = rhino.Group()
        group.Name = face.name
        file.Groups.Add(group)
        index = len(file.Groups) - 1
        attributes.AddToGroup(index)
        for cycle in face.loops:
            for side in cycle:
                file.Objects.AddCurve(_curve(rhino, shape.edges[side.edge].curve), attributes)
    file.Objects.AddSurface(surface, attributes)


def _attributes(
    rhino: Any,
    file: Any,
    layers: dict[str, int],
    name: str,
    colour: tuple[int, int, int] | None,
    tags: tuple[str, ...],
) -> Any:
    attributes = rhino.ObjectAttributes()
    attributes.Name = name
    layer = tags[0] if tags else "model"
    if layer not in layers:
        made = rhino.Layer()
        made.Name = layer
        layers[layer] = file.Layers.Add(made)
    attributes.LayerIndex = layers[layer]
    if colour is not None:
        attributes.ObjectColor = (*colour, 255)
        attributes.ColorSource = rhino.ObjectColorSource.ColorFromObject
    return attributes


def _plane(rhino: Any, face: Face) -> Any:
    assert face.plane is not None
    origin, normal, _ = face.plane
    return rhino.Plane(rhino.Point3d(*origin), rhino.Vector3d(*normal))


def _curve(rhino: Any, curve: Nurbs) -> Any:
    count = len(curve.points)
    made = rhino.NurbsCurve(3, curve.weights is not None, curve.degrees[0] + 1, count)
    for k, p in enumerate(curve.points):
        w = 1.0 if curve.weights is None else float(curve.weights[k])
        made.Points[k] = rhino.Point4d(*(p * w), w)
    # rhino3dm keeps knots without the first and the last.
    for k, knot in enumerate(curve.knots[0][1:-1]):
        made.Knots[k] = float(knot)
    return made


def _loop(rhino: Any, shape: Boundary, cycle: Any) -> Any:
    joined = rhino.PolyCurve()
    for side in cycle:
        curve = _curve(rhino, shape.edges[side.edge].curve)
        if not side.forward:
            curve.Reverse()
        joined.Append(curve)
    return joined


def _surface(rhino: Any, surface: Nurbs) -> Any:
    (nu, nv), (p, q) = surface.points.shape[:2], surface.degrees
    rational = surface.weights is not None
    made = rhino.NurbsSurface.Create(3, rational, p + 1, q + 1, nu, nv)
    for i in range(nu):
        for j in range(nv):
            w = 1.0 if surface.weights is None else float(surface.weights[i, j])
            made.Points[i, j] = rhino.Point4d(*(surface.points[i, j] * w), w)
    for k, knot in enumerate(surface.knots[0][1:-1]):
        made.KnotsU[k] = float(knot)
    for k, knot in enumerate(surface.knots[1][1:-1]):
        made.KnotsV[k] = float(knot)
    return made
