"""3DM files, by rhino3dm (McNeel, MIT).

A closed shell is one B-rep, with the names and colours of its faces in its attributes. Faces of
open shells are objects: NURBS surfaces if they have all of their surface, otherwise trimmed B-reps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from moldloft import _core
from moldloft.cad import needed
from moldloft.cad.boundary import Boundary, Face, boundary
from moldloft.cad.opennurbs import brep
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
    done: set[int] = set()
    for part in shape.parts:
        for faces, closed in part.shells:
            if closed and len(faces) > 1 and _body(rhino, file, layers, shape, part.name, faces):
                done |= {*faces}
    for k, face in enumerate(shape.faces):
        if k not in done:
            _face(rhino, file, layers, shape, k, face)
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


def _body(
    rhino: Any,
    file: Any,
    layers: dict[str, int],
    shape: Boundary,
    name: str,
    faces: tuple[int, ...],
) -> bool:
    """Adds a closed shell as one B-rep, if the result is one."""
    held = [shape.faces[k] for k in faces]
    solid = _decoded(rhino, shape, faces)
    if solid is None or not solid.IsSolid:
        return False
    colours = {face.colour for face in held}
    colour = held[0].colour if len(colours) == 1 else None
    attributes = _attributes(rhino, file, layers, name, colour, held[0].layers)
    error = max(face.error for face in held)
    exact = all(face.exact for face in held)
    attributes.SetUserString("accuracy", "exact" if exact else f"{error:.3g}")
    attributes.SetUserString("faces", "\n".join(face.name for face in held))
    if len(colours) > 1:
        words = (bytes(face.colour).hex() if face.colour else "" for face in held)
        attributes.SetUserString("colours", "\n".join(words))
    file.Objects.AddBrep(solid, attributes)
    return True


def _decoded(rhino: Any, shape: Boundary, faces: tuple[int, ...]) -> Any:
    """Faces as a B-rep that openNURBS finds valid; None if there is none."""
    try:
        made = rhino.CommonObject.Decode(brep(shape, faces))
    except FormatError:
        # Some edges have no curve in the parameters of their faces.
        return None
    return made if made is not None and made.IsValid else None


def _face(
    rhino: Any, file: Any, layers: dict[str, int], shape: Boundary, number: int, face: Face
) -> None:
    attributes = _attributes(rhino, file, layers, face.name, face.colour, face.layers)
    attributes.SetUserString("accuracy", "exact" if face.exact else f"{face.error:.3g}")
    if face.surface is not None and face.natural:
        file.Objects.AddSurface(_surface(rhino, face.surface), attributes)
        return
    trimmed = _decoded(rhino, shape, (number,))
    if trimmed is not None:
        file.Objects.AddBrep(trimmed, attributes)
        return
    if face.surface is not None:
        attributes.SetUserString("trimmed", "the curves of its group bound the face")
        group = rhino.Group()
        group.Name = face.name
        file.Groups.Add(group)
        attributes.AddToGroup(len(file.Groups) - 1)
        file.Objects.AddSurface(_surface(rhino, face.surface), attributes)
    for side in (side for cycle in face.loops for side in cycle):
        file.Objects.AddCurve(_curve(rhino, shape.edges[side.edge].curve), attributes)


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
