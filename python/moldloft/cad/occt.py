"""Reading of CAD files with OCCT (package ``cadquery-ocp-novtk``)."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.budget import limits
from moldloft.cad import identifier, needed
from moldloft.cad.assemblies import NOWHERE, Assemblies, Content, Inside, label_name
from moldloft.cad.faces import (
    RESERVED,
    Imported,
    ImportedFace,
    ImportedSide,
    border,
    is_whole,
    part_seams,
)
from moldloft.cad.iges_text import IgesText
from moldloft.cad.part21 import StepText
from moldloft.cad.rhino_reading import step_text
from moldloft.cad.sewing import Sewn, faces_of, is_sheet, map_of
from moldloft.cad.tracing import traced
from moldloft.errors import Error, FileError
from moldloft.shapes.nurbs import Nurbs
from moldloft.storage import read_bytes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["of_part", "read_shape"]

_OUTSIDE = 1e-6
"""Parameters this far outside of a surface's are rounded onto its border."""

_BEYOND = 0.05
"""A trace that leaves the surface's parameters by more is compared with its curve."""

_ASTRAY = 1e-4
"""Distance of a trace from its curve, relative to the surface, from which it is not the curve's."""

_NOTHING = 1e-8
"""A side is left out that spans no more of its surface's parameters."""


@contextmanager
def _quiet() -> Iterator[None]:
    """Silences OCCT, which prints to the terminal directly, by redirecting its standard output."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def read_shape(data: bytes, metres: float) -> Any:
    """The shape of a STEP file's bytes; ``metres`` is the size of its unit."""
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    with _quiet():
        status = reader.ChangeReader().ReadStream("model.step", io.BytesIO(data))
        if not str(status).endswith("RetDone"):
            raise Error("OCCT cannot read the STEP file that was written")
        document = _document(metres)
        reader.Transfer(document)
    return _compound(_free(document))


def _document(metres: float) -> Any:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, metres)
    return document


def _free(document: Any) -> list[Any]:
    from OCP.collections import Sequence_TDF_Label
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = Sequence_TDF_Label()
    tool.GetFreeShapes(labels)
    return [tool.GetShape_s(labels.Value(k)) for k in range(1, labels.Length() + 1)]


def _compound(shapes: list[Any]) -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    if len(shapes) == 1:
        return shapes[0]
    compound = TopoDS_Compound()
    builder = BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def cad_bytes(path: Path) -> bytes:
    """Content of a file: without a byte-order mark, and unpacked if it is a compressed STEP file.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    FileError
        If it cannot be read, or an archive contains no STEP file or one beyond the size limit.
    """
    data = read_bytes(path)
    if data[:2] == b"PK":
        try:
            with zipfile.ZipFile(io.BytesIO(data)) as packed:
                ends = (".stp", ".step")
                parts = [i for i in packed.infolist() if i.filename.lower().endswith(ends)]
                if not parts:
                    raise FileError(f"cannot read `{path}`: no STEP file is packed in it")
                if parts[0].file_size > limits().memory // 8:
                    raise FileError(
                        f"cannot read `{path}`: {parts[0].file_size} bytes are packed in it, more "
                        "than the limit of memory allows"
                    )
                data = packed.read(parts[0])
        except (zipfile.BadZipFile, NotImplementedError, RuntimeError, zlib.error) as error:
            raise FileError(f"cannot read `{path}`: it cannot be unpacked ({error})") from error
    return data.removeprefix(b"\xef\xbb\xbf")


def _step_of_brep(path: Path, data: bytes) -> str:
    """A BREP shape, taken to be in millimetres, as the text of a STEP file.

    Reading it, OCCT mends what a BREP file may have: curves of trims off their edges, and faces
    that close upon themselves without a seam.
    """
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
    from OCP.TopoDS import TopoDS_Shape

    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, io.BytesIO(data), BRep_Builder())
    if shape.IsNull():
        raise FileError(f"cannot read `{path}`: not a BREP file that OCCT takes")
    with tempfile.TemporaryDirectory() as folder, _quiet():
        copy = Path(folder) / "model.step"
        writer = STEPControl_Writer()
        writer.Transfer(shape, STEPControl_AsIs)
        writer.Write(str(copy))
        return copy.read_text(encoding="latin-1") if copy.exists() else ""


def of_part(
    path: Path, metres: float, numbers: list[int] | None, *, components: bool = False
) -> Imported:
    """The faces and curves of a CAD file, read in this process.

    ``metres`` is the size of its unit.

    Of a truncated file the complete faces are read, with remarks.

    Parameters
    ----------
    path
        The file.
    metres
        Unit of length of the result, in metres.
    numbers
        The faces of a STEP file that are wanted, by the numbers of their entities; None for all.
    components
        True for products of a STEP file that are placed more than once as parts of their own.

    Raises
    ------
    FileError
        If the file is not of its format, or contains no shape.
    """
    needed("OCP", "cadquery-ocp-novtk", "reading STEP, IGES and BREP")
    data = cad_bytes(path)
    if not data.strip():
        raise FileError(f"cannot read `{path}`: the file is empty")
    iges = path.suffix.lower() in (".igs", ".iges")
    text, said = data.decode("latin-1"), list[str]()
    if path.suffix.lower() == ".3dm":
        text, said = step_text(path, data)
    if path.suffix.lower() in (".brep", ".brp"):
        text = _step_of_brep(path, data)
        said = ["a BREP file states no unit: its numbers are taken as millimetres"]
    source = IgesText.of(path, text) if iges else StepText.of(path, text)
    source.remarks[:0] = said
    if isinstance(source, StepText) and numbers is not None:
        source = source.only_faces(numbers)
    # OCCT may end the process over an entity that is missing: it gets what needs none.
    sound = source.sound() if isinstance(source, StepText) else source
    found, done = _held(sound, metres, components and numbers is None)
    fewer = isinstance(source, StepText) and found.count < len(source.whole_faces)
    if isinstance(source, StepText) and fewer and numbers is None:
        # One missing vertex may take a body with it.
        rest, again = _held(source.only_faces().sound(), metres, False)
        if again and len(rest.faces) > found.count:
            rest.remarks.append(
                f"the {len(rest.faces)} faces that are whole are kept, their body is not"
            )
            found, done = rest, again
    if not done and source.remarks:
        raise FileError(f"cannot read `{path}`: {'; '.join(source.remarks)}")
    if not done:
        kind = {".igs": "an IGES", ".iges": "an IGES", ".3dm": "a 3DM"}
        what = kind.get(path.suffix.lower(), "a STEP")
        raise FileError(f"cannot read `{path}`: not {what} file that OCCT takes")
    if not found.count and not found.curves:
        why = "".join(f"; {remark}" for remark in source.remarks)
        raise FileError(f"cannot read `{path}`: it contains no face and no curve{why}")
    return found


def _held(source: StepText | IgesText, metres: float, components: bool) -> tuple[Imported, bool]:
    """The content that OCCT finds in a file, and True if it is readable."""
    found = Imported(metres=metres, remarks=list(source.remarks))
    document = _document(metres)
    iges = isinstance(source, IgesText)
    done = _transferred(source.text.encode("latin-1"), iges, document)
    if not done:
        return found, False
    named = _Names(document, levels=source.levels if isinstance(source, IgesText) else None)
    seen: set[int] = set()
    shapes = _free(document)
    if isinstance(source, IgesText):
        originals = 0
        if shapes:
            # Faces of IGES do not share their edges.
            whole = Sewn.of(_compound(shapes), source.resolution / metres)
            originals = _collect(named, [(whole, NOWHERE)], found, source.names, seen)
            whole.say(found.remarks, iges=True)
        _say_lost(found, source.names, seen, originals)
        return found, True
    tree = Assemblies(document, named.product, _colour, components)
    if tree.names or tree.coloured:
        originals = _collect_content(tree.content(), named, found, source.names, seen)
        for name in tree.names:
            part = found.parts[name] = Imported(metres=metres, reserved=RESERVED)
            content = tree.content(name)
            originals += _collect_content(content, named, part, source.names, seen)
    else:
        content = Content([(shape, NOWHERE) for shape in shapes])
        originals = _collect_content(content, named, found, source.names, seen)
        _name_curves(found, source.curve_names)
    _say_lost(found, source.names, seen, originals)
    return found, True


def _collect_content(
    content: Content, named: _Names, found: Imported, numbered: dict[int, str], seen: set[int]
) -> int:
    """The faces and curves of a product or a file; their number before faces were halved."""
    parts = [(Sewn(shape), inside) for shape, inside in content.shapes if not is_sheet(shape)]
    sheets = [(shape, inside) for shape, inside in content.shapes if is_sheet(shape)]
    # Many programs write the faces of a hull one by one.
    whole = Sewn.of(_compound([shape for shape, _ in sheets]), 0.0)
    sewn = whole.found and len({inside for _, inside in sheets}) == 1
    if sewn:
        parts.append((whole, sheets[0][1]))
    else:
        parts += [(Sewn(sheet), inside) for sheet, inside in sheets]
    count = _collect(named, parts, found, numbered, seen)
    if sewn:
        whole.say(found.remarks, iges=False)
    found.placed += content.placed
    return count


def _name_curves(found: Imported, named: list[tuple[str, int, int]]) -> None:
    """Names the curves as the file does, which OCCT does not say, if they are in its order."""
    curves = list(found.curves.items())
    stated = [(degree, count) for _, degree, count in named]
    if [(c.degrees[0], len(c.points)) for _, c in curves] != stated:
        return
    taken = {face.name for face in found.faces}
    found.curves = {
        identifier(label or known, taken): curve
        for (known, curve), (label, _, _) in zip(curves, named, strict=True)
    }


def _transferred(data: bytes, iges: bool, document: Any) -> bool:
    """True if OCCT reads a file's bytes into a document."""
    if iges:
        from OCP.IGESCAFControl import IGESCAFControl_Reader

        reader: Any = IGESCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetLayerMode(True)
        # This reader takes files only.
        with tempfile.TemporaryDirectory() as folder, _quiet():
            path = Path(folder) / "model.igs"
            path.write_bytes(data)
            status = reader.ReadFile(str(path))
            return str(status).endswith("RetDone") and reader.Transfer(document)
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    reader.SetNameMode(True)
    reader.SetLayerMode(True)
    with _quiet():
        status = reader.ChangeReader().ReadStream("model.step", io.BytesIO(data))
        return str(status).endswith("RetDone") and reader.Transfer(document)


def _collect(
    named: _Names,
    shapes: list[tuple[Sewn, Inside]],
    found: Imported,
    numbered: dict[int, str],
    seen: set[int],
) -> int:
    """The faces and curves of shapes; faces of STEP files are named by their entity numbers.

    The answer is the number of faces before any are halved.
    """
    taken = set(found.reserved)
    known = 0
    originals = 0
    bodies: set[str] = set()
    several = sum(len(_solids(shape.shape)) for shape, _ in shapes) > 1
    for shape, inside in shapes:
        places = _Places(shape, named, bodies, several, inside)
        labels = _Labels(named, numbered, taken.copy(), seen, len(found.faces))
        faces, count, left_out = _shape_faces(shape, labels, places, False)
        if any(not face.natural and _own_seam(face) for face in faces):
            # Trimmed faces cannot be joined to themselves.
            again = _Labels(named, numbered, taken.copy(), seen, len(found.faces))
            try:
                faces, count, left_out = _shape_faces(shape, again, places, True)
                labels = again
            except Exception as error:
                # OCCT's own exceptions have no common class here.
                left_out.append(f"closed faces are not halved: {_said(error)}")
        taken |= labels.taken
        originals += labels.count - len(found.faces)
        found.remarks += left_out
        for face in faces:
            # Numbers of edges are those of all shapes of the file.
            face.renumber(known)
        found.faces += faces
        known += count
        for edge in _loose_edges(shape.shape):
            label = named.of(edge) or f"curve{len(found.curves) + 1}"
            curve = _space_curve(edge)
            if curve is not None:
                found.curves[identifier(label, taken)] = curve
    return originals


def _say_lost(found: Imported, numbered: dict[int, str], seen: set[int], originals: int) -> None:
    """A remark on the faces of a file that OCCT does not give."""
    lost = [n for n in numbered if n not in seen]
    count = len(numbered) - originals
    if lost and count > 0:
        few = ", ".join(f"#{n}" for n in lost[:20]) + (", ..." if len(lost) > 20 else "")
        # OCCT does not say which the faces round a cavity are.
        which = few if count >= len(lost) else f"they are among {few}"
        found.remarks.append(
            f"{count} of the file's {len(numbered)} faces could not be read: {which}"
        )


@dataclass
class _Labels:
    """Names of faces."""

    named: _Names
    numbered: dict[int, str]
    taken: set[str]
    seen: set[int]
    count: int

    def of(self, face: Any) -> tuple[str, str]:
        """Name of the face in the program, and in remarks."""
        self.count += 1
        label = self.named.of(face)
        number = int(label[1:]) if label[:1] == "#" and label[1:].isdecimal() else 0
        known = number in self.numbered
        if known:
            self.seen.add(number)
            label = self.numbered[number]
        label = f"face{self.count}" if label in _UNNAMED else label
        return label, f"face #{number} (`{label}`)" if known else f"face `{label}`"


def _said(error: Exception) -> str:
    """An exception of OCCT in one line."""
    return f"{type(error).__name__}: {error}".splitlines()[0][:200]


def _solids(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_SOLID

    return faces_of(shape, TopAbs_SOLID)


_UNNAMED = {"", "NONE", "FACE", "SOLID", "SHELL", "COMPOUND", "ASSEMBLY"}
"""Default names of unnamed shapes."""


class _Places:
    """Products, layers and colours of the faces of a shape."""

    def __init__(
        self,
        sewn: Sewn,
        named: _Names,
        bodies: set[str],
        several: bool,
        inside: Inside,
    ) -> None:
        from OCP.BRepClass3d import BRepClass3d
        from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
        from OCP.TopoDS import TopoDS, TopoDS_Iterator

        self._cavities: set[int] = set()
        self._faces = map_of(sewn.shape, TopAbs_FACE)
        self._found: dict[int, tuple[tuple[str, ...], tuple[float, float, float] | None]] = {}

        def walk(
            shape: Any, path: tuple[str, ...], layers: tuple[str, ...], colour: Any, body: bool
        ) -> None:
            # A placement may have a colour in place of its product's.
            colour = colour if shape is sewn.shape and colour else named.colour(shape) or colour
            layers = (*layers, *named.layers(shape))
            kind = shape.ShapeType()
            if kind == TopAbs_FACE:
                tags = tuple(dict.fromkeys((*path, *layers)))
                self._found.setdefault(self._faces.FindIndex(shape), (tags, colour))
                return
            if kind == TopAbs_SOLID and len(shells := faces_of(shape, TopAbs_SHELL)) > 1:
                outer = BRepClass3d.OuterShell_s(TopoDS.Solid(shape))
                for shell in (shell for shell in shells if not shell.IsSame(outer)):
                    inner = faces_of(shell, TopAbs_FACE)
                    self._cavities |= {self._faces.FindIndex(face) for face in inner}
            label = named.product(shape)
            known = identifier(label, set()) if label else ""
            if known and known not in path:
                path = (*path, known)
            if several and not body and kind in (TopAbs_SOLID, TopAbs_SHELL):
                # The same product may be placed many times.
                taken = bodies | set(path[:-1])
                name = identifier(path[-1] if path else "body", taken)
                bodies.add(name)
                path, body = (*path, name) if name not in path else path, True
            parts = TopoDS_Iterator(shape)
            while parts.More():
                walk(parts.Value(), path, layers, colour, body)
                parts.Next()

        walk(sewn.shape, inside.products, (), inside.colour, False)

    def is_cavity(self, face: Any) -> bool:
        """True for a face of a shell inside another one of the same solid."""
        return self._faces.FindIndex(face) in self._cavities

    def of(self, face: Any) -> tuple[tuple[str, ...], tuple[float, float, float] | None]:
        """Products, body and layers, and the colour, of a face."""
        return self._found.get(self._faces.FindIndex(face), ((), None))


class _Converted:
    """A shape as NURBS.

    Faces on planes are as they are, the others converted together, or face by face if that fails in
    OCCT.
    """

    def __init__(self, shape: Any) -> None:
        from OCP.BRep import BRep_Builder
        from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
        from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
        from OCP.TopoDS import TopoDS_Compound

        self.edges = map_of(shape, TopAbs_EDGE)
        curved = [face for face in faces_of(shape, TopAbs_FACE) if not _is_own(face)]
        self._together = None
        if curved:
            compound = TopoDS_Compound()
            builder = BRep_Builder()
            builder.MakeCompound(compound)
            for face in curved:
                builder.Add(compound, face)
            with contextlib.suppress(Exception):
                # OCCT's own exceptions have no common class here.
                self._together = BRepBuilderAPI_NurbsConvert(compound, True)

    def fault(self, area: float) -> float:
        """How far the faces are from a shape of this area without planes, relative to its size."""
        from OCP.BRep import BRep_Tool
        from OCP.TopAbs import TopAbs_EDGE
        from OCP.TopoDS import TopoDS

        if self._together is None or not area:
            return np.inf
        made = self._together.Shape()
        apart = [BRep_Tool.Tolerance_s(TopoDS.Edge(edge)) for edge in faces_of(made, TopAbs_EDGE)]
        return float(abs(_curved_area(made) / area - 1) + max(apart, default=0.0) / area**0.5)

    def takes(self, part: Any) -> bool:
        """True if OCCT can convert a face."""
        if self._together is not None or _is_own(part):
            return True
        try:
            self.face(part)
        except Exception:
            # OCCT's own exceptions have no common class here.
            return False
        return True

    def face(self, part: Any) -> tuple[Any, Any]:
        """A face as NURBS, with the numbering of its edges."""
        from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
        from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD
        from OCP.TopoDS import TopoDS

        if _is_own(part):
            # Loops are those of the surface's side.
            return TopoDS.Face(part.Oriented(TopAbs_FORWARD)), self.edges
        convert = self._together or BRepBuilderAPI_NurbsConvert(part, True)
        own = _Renumbered()
        for edge in faces_of(part, TopAbs_EDGE):
            # An edge that is not of the whole gets a number of its own.
            number = self.edges.FindIndex(edge) or self.edges.Add(edge)
            own.add(convert.ModifiedShape(edge), number)
        return TopoDS.Face(convert.ModifiedShape(part)), own


def _curved_area(shape: Any) -> float:
    """The area of the faces of a shape that are not on planes."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_FACE

    area = GProp_GProps()
    for face in faces_of(shape, TopAbs_FACE):
        if not _is_own(face):
            BRepGProp.SurfaceProperties_s(face, area)
    return float(area.Mass())


def _is_own(face: Any) -> bool:
    """True for a face on a plane, whose loops are exact in its parameters."""
    from OCP.BRep import BRep_Tool
    from OCP.Geom import Geom_Plane
    from OCP.TopoDS import TopoDS

    return isinstance(BRep_Tool.Surface_s(TopoDS.Face(face)), Geom_Plane)


class _Renumbered:
    """Edges of one face with their numbers in the whole shape."""

    def __init__(self) -> None:
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as Shapes

        self._shapes = Shapes()
        self._numbers: list[int] = []

    def add(self, edge: Any, number: int) -> None:
        if self._shapes.Add(edge) > len(self._numbers):
            self._numbers.append(number)

    def FindIndex(self, edge: Any) -> int:  # noqa: N802 (as OCCT's maps)
        index = self._shapes.FindIndex(edge)
        return self._numbers[index - 1] if index else 0


def _shape_faces(
    sewn: Sewn, labels: _Labels, places: _Places, divided: bool
) -> tuple[list[ImportedFace], int, list[str]]:
    """The faces of a shape, their numbers of edges, and remarks; closed faces may be halved."""
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.ShapeFix import ShapeFix_Shape
    from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideClosed
    from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED

    originals = faces_of(sewn.shape, TopAbs_FACE)
    held = [sewn.face(original) for original in originals]
    parts = {k: [face] for k, face in enumerate(held)}
    whole = sewn.whole
    if divided:
        divide = ShapeUpgrade_ShapeDivideClosed(whole)
        with _quiet():
            divide.Perform()
        whole = divide.Result()
        context = divide.GetContext()
        parts = {k: faces_of(context.Apply(f), TopAbs_FACE) for k, f in enumerate(held)}
    converted = _Converted(whole)
    if divided and not BRepCheck_Analyzer(whole).IsValid():
        # OCCT may convert halves that it finds faulty to others, and so may be what it mends.
        fix = ShapeFix_Shape(whole)
        with _quiet():
            fix.Perform()
        mended = _Converted(fix.Shape())
        area = _curved_area(sewn.whole)
        if mended.fault(area) < converted.fault(area):
            converted, context = mended, fix.Context()
            parts = {
                k: [f for half in halves for f in faces_of(context.Apply(half), TopAbs_FACE)]
                for k, halves in parts.items()
            }
    faces: list[ImportedFace] = []
    remarks = []
    for k, original in enumerate(originals):
        label, where = labels.of(original)
        pieces = parts[k]
        if divided and not all(converted.takes(part) for part in pieces):
            # As it was read: its halves may be what OCCT cannot convert.
            pieces = [held[k]]
        for part in pieces:
            try:
                face, edges = converted.face(part)
                made = _face(face, edges, identifier(label, labels.taken))
            except Error as error:
                remarks.append(f"{where} is left out: {error}")
                continue
            except Exception as error:
                # OCCT's own exceptions have no common class here.
                remarks.append(f"{where} is left out: OCCT cannot convert it ({_said(error)})")
                continue
            # The converted face has lost its sense.
            made.reversed = part.Orientation() == TopAbs_REVERSED
            part_seams(made)
            made.tags, made.colour = places.of(original)
            made.cavity = places.is_cavity(original)
            faces.append(made)
    uses: dict[int, int] = {}
    for face in faces:
        for side in face.sides:
            uses[side.edge] = uses.get(side.edge, 0) + 1
    for face in faces:
        # Whole surfaces have no sides that are parts of their edges.
        if any(uses[s.edge] > 1 and border(s.trace) and not is_whole(s.trace) for s in face.sides):
            face.natural = False
    return faces, converted.edges.Extent(), remarks


def _own_seam(face: ImportedFace) -> bool:
    """True if a face meets itself along an edge."""
    numbers = [side.edge for side in face.sides]
    return len({*numbers}) < len(numbers)


def _loose_edges(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, TopAbs_EDGE, TopAbs_FACE)
    found = []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


class _Names:
    """The names, colours and layers of a document's shapes."""

    def __init__(self, document: Any, *, levels: dict[int, str] | None = None) -> None:
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as Shapes
        from OCP.collections import Sequence_TDF_Label
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        self._nowhere = TopLoc_Location()
        self._shapes = Shapes()
        self._names: dict[int, str] = {}
        self._colours: dict[int, tuple[float, float, float]] = {}
        self._layers: dict[int, tuple[str, ...]] = {}
        layer_tool = XCAFDoc_DocumentTool.LayerTool_s(document.Main())

        def walk(label: Any) -> None:
            shape = tool.GetShape_s(label)
            colour = None if shape.IsNull() else _colour(label)
            if colour is not None:
                self._colours.setdefault(self._shapes.Add(shape.Located(self._nowhere)), colour)
            layers = () if shape.IsNull() else _layers(layer_tool, label)
            if levels is not None:
                # IGES has numbers, 0 for none.
                layers = tuple(
                    "_".join(levels.get(int(number), "").replace('"', " ").split())
                    or f"level_{number}"
                    for number in layers
                    if number != "0"
                )
            if layers:
                self._layers.setdefault(self._shapes.Add(shape.Located(self._nowhere)), layers)
            name = "" if shape.IsNull() else label_name(label)
            if name:
                index = self._shapes.Add(shape.Located(self._nowhere))
                self._names.setdefault(index, name)
            inner = Sequence_TDF_Label()
            tool.GetSubShapes_s(label, inner)
            for k in range(1, inner.Length() + 1):
                walk(inner.Value(k))

        labels = Sequence_TDF_Label()
        tool.GetShapes(labels)
        for k in range(1, labels.Length() + 1):
            walk(labels.Value(k))

    def of(self, shape: Any) -> str:
        """The name of a shape or of one that contains it; may be empty."""
        return self._names.get(self._shapes.FindIndex(shape.Located(self._nowhere)), "")

    def product(self, shape: Any) -> str:
        """The name of a shape; empty for one that a program gives to unnamed shapes."""
        name = self.of(shape)
        return "" if name in _UNNAMED or name.startswith("Open CASCADE") else name

    def colour(self, shape: Any) -> tuple[float, float, float] | None:
        """The colour of a shape or of one that contains it, sRGB."""
        return self._colours.get(self._shapes.FindIndex(shape.Located(self._nowhere)))

    def layers(self, shape: Any) -> tuple[str, ...]:
        """The layers that a shape itself is on, as tags."""
        return self._layers.get(self._shapes.FindIndex(shape.Located(self._nowhere)), ())


def _layers(tool: Any, label: Any) -> tuple[str, ...]:
    """The names of a label's layers as words without blanks."""
    from OCP.collections import Sequence_TDF_Label

    held = Sequence_TDF_Label()
    tool.GetLayers(label, held)
    names = (label_name(held.Value(k)) for k in range(1, held.Length() + 1))
    words = ("_".join(name.replace('"', " ").split()) for name in names)
    return tuple(word for word in words if word not in ("", "NONE"))


def _colour(label: Any) -> tuple[float, float, float] | None:
    """The colour of a label of a document, sRGB."""
    from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
    from OCP.XCAFDoc import XCAFDoc_ColorGen, XCAFDoc_ColorSurf, XCAFDoc_ColorTool

    colour = Quantity_Color()
    for kind in (XCAFDoc_ColorSurf, XCAFDoc_ColorGen):
        if XCAFDoc_ColorTool.GetColor_s(label, kind, colour):
            values = colour.Values(Quantity_TOC_sRGB)
            red, green, blue = (float(x) for x in values)
            return red, green, blue
    return None


def _clamped(curve: Any, low: float, high: float, flat: bool) -> Nurbs:
    """A B-spline curve of OCCT between two parameters, its knots over [0, 1]."""
    if curve.IsPeriodic():
        curve.SetNotPeriodic()
    if low > curve.FirstParameter() + 1e-12 or high < curve.LastParameter() - 1e-12:
        curve.Segment(max(low, curve.FirstParameter()), min(high, curve.LastParameter()), 1e-12)
    degree = curve.Degree()
    knots = np.concatenate(
        [np.repeat(curve.Knot(k), curve.Multiplicity(k)) for k in range(1, curve.NbKnots() + 1)]
    )
    poles = [curve.Pole(k) for k in range(1, curve.NbPoles() + 1)]
    points = np.array([(p.X(), p.Y(), 0.0) if flat else (p.X(), p.Y(), p.Z()) for p in poles])
    weights = np.array([curve.Weight(k) for k in range(1, curve.NbPoles() + 1)])
    knots = (knots - knots[degree]) / (knots[-degree - 1] - knots[degree])
    plain = np.ptp(weights) <= 1e-14 * weights.max()
    return Nurbs((degree,), (knots,), points, None if plain else weights)


def _space_curve(edge: Any) -> Nurbs | None:
    from OCP.BRep import BRep_Tool
    from OCP.Geom import Geom_TrimmedCurve
    from OCP.GeomConvert import GeomConvert
    from OCP.TopoDS import TopoDS

    edge = TopoDS.Edge(edge)
    if BRep_Tool.Degenerated_s(edge):
        return None
    curve = BRep_Tool.Curve_s(edge, 0.0, 1.0)
    if curve is None:
        return None
    low, high = BRep_Tool.Range_s(edge)
    trimmed = Geom_TrimmedCurve(curve, low, high)
    spline = GeomConvert.CurveToBSplineCurve_s(trimmed)
    return _clamped(spline, spline.FirstParameter(), spline.LastParameter(), flat=False)


def _face(face: Any, edges: Any, name: str) -> ImportedFace:
    from OCP.BRep import BRep_Tool
    from OCP.BRepTools import BRepTools
    from OCP.Geom import Geom_BSplineSurface, Geom_Plane, Geom_RectangularTrimmedSurface
    from OCP.GeomConvert import GeomConvert
    from OCP.TopAbs import TopAbs_WIRE
    from OCP.TopoDS import TopoDS

    surface = BRep_Tool.Surface_s(face)
    if not isinstance(surface, Geom_BSplineSurface):
        if isinstance(surface, Geom_Plane):
            surface = Geom_RectangularTrimmedSurface(surface, *BRepTools.UVBounds_s(face))
        surface = GeomConvert.SurfaceToBSplineSurface_s(surface)
    surface = surface.Copy()
    if surface.IsUPeriodic():
        surface.SetUNotPeriodic()
    if surface.IsVPeriodic():
        surface.SetVNotPeriodic()
    bounds = BRepTools.UVBounds_s(face)
    whole = surface.Bounds()
    u0, u1, v0, v1 = (
        max(bounds[0], whole[0]),
        min(bounds[1], whole[1]),
        max(bounds[2], whole[2]),
        min(bounds[3], whole[3]),
    )
    if not (u1 > u0 and v1 > v0):
        raise Error("its parameters span nothing")
    surface.Segment(u0, u1, v0, v1, 1e-12, 1e-12)
    made = _surface(surface)
    outer = BRepTools.OuterWire_s(face)
    wires = faces_of(face, TopAbs_WIRE)
    wires.sort(key=lambda w: not w.IsSame(outer))
    frame = np.array([u0, v0, 0.0]), np.array([u1 - u0, v1 - v0, 1.0])
    loops = [_cycle(TopoDS.Wire(wire), face, edges, frame, made) for wire in wires]
    sides = [side for cycle in loops for side in cycle]
    natural = bool(sides) and all(border(side.trace) for side in sides)
    if sides and not natural:
        paths = [(side.trace._data(), side.tolerance) for side in sides]
        moved = _core.on_border(made._data(), paths)
        found = iter([path for path in moved if path is not None])
        if natural := None not in moved:
            loops = [[s._replace(trace=Nurbs._of(next(found))) for s in own] for own in loops]
    return ImportedFace(name, made, loops, natural, False)


def _cycle(
    wire: Any, face: Any, edges: Any, frame: tuple[Floats, Floats], surface: Nurbs
) -> list[ImportedSide]:
    """The sides of a loop, in its order."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepTools import BRepTools_WireExplorer
    from OCP.Geom2d import Geom2d_TrimmedCurve
    from OCP.Geom2dConvert import Geom2dConvert
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopoDS import TopoDS, TopoDS_Iterator

    held = []
    parts = TopoDS_Iterator(wire)
    while parts.More():
        held.append(TopoDS.Edge(parts.Value()))
        parts.Next()
    found = []
    explorer = BRepTools_WireExplorer(wire, face)
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    # The explorer stops at some poles and seams.
    ordered = len(found) == len(held)
    cycle = []
    for edge in found if ordered else held:
        low, high = BRep_Tool.Range_s(edge, face)
        path = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
        if path is None:
            raise Error("an edge has no curve in its parameters")
        spline = Geom2dConvert.CurveToBSplineCurve_s(Geom2d_TrimmedCurve(path, low, high))
        trace = _clamped(spline, spline.FirstParameter(), spline.LastParameter(), flat=True)
        trace.points[:] = (trace.points - frame[0]) / frame[1]
        # What is outside by rounding alone would be a place of the surface's continuation.
        inside = np.clip(trace.points, 0, 1)
        near = np.abs(trace.points - inside) < _OUTSIDE
        trace.points[near] = inside[near]
        # Some programs leave an edge of no length where they cut a closed face.
        if np.ptp(trace.points, axis=0).max() < _NOTHING:
            continue
        backwards = edge.Orientation() == TopAbs_REVERSED
        near = BRep_Tool.Tolerance_s(edge)
        if np.abs(trace.points - np.clip(trace.points, 0, 1)).max() > _BEYOND:
            trace = _followed(surface, edge, trace)
        cycle.append(ImportedSide(edges.FindIndex(edge), backwards, trace, near))
    return cycle if ordered else _chained(cycle)


def _followed(surface: Nurbs, edge: Any, trace: Nurbs) -> Nurbs:
    """A trace, or the one of the edge's curve where OCCT has put it beside the surface."""
    curve = _space_curve(edge)
    if curve is None:
        return trace
    t = np.linspace(0, 1, 9)
    at = np.clip(trace(t)[:, :2], 0, 1)
    off = np.linalg.norm(surface(at[:, 0], at[:, 1]) - curve(t), axis=1).max()
    size = float(np.ptp(surface.points.reshape(-1, 3), axis=0).max())
    if off <= _ASTRAY * size:
        return trace
    found = traced(surface, curve, 0.0)
    return found[0] if found else trace


def _chained(sides: list[ImportedSide]) -> list[ImportedSide]:
    """Sides in the order in which they follow each other in the parameters."""
    left = list(sides)
    chain = left[:1]
    del left[:1]
    while left:
        _, back, trace, _ = chain[-1]
        end = trace.points[0 if back else -1]
        away = [float(np.linalg.norm(t.points[-1 if b else 0] - end)) for _, b, t, _ in left]
        chain.append(left.pop(int(np.argmin(away))))
    return chain


def _surface(surface: Any) -> Nurbs:
    degrees = (surface.UDegree(), surface.VDegree())
    knots = []
    for letter, degree in zip("UV", degrees, strict=True):
        count = getattr(surface, f"Nb{letter}Knots")()
        raw = np.concatenate(
            [
                np.repeat(
                    getattr(surface, f"{letter}Knot")(k),
                    getattr(surface, f"{letter}Multiplicity")(k),
                )
                for k in range(1, count + 1)
            ]
        )
        knots.append((raw - raw[degree]) / (raw[-degree - 1] - raw[degree]))
    nu, nv = surface.NbUPoles(), surface.NbVPoles()
    points = np.empty((nu, nv, 3))
    weights = np.empty((nu, nv))
    for i in range(nu):
        for j in range(nv):
            p = surface.Pole(i + 1, j + 1)
            points[i, j] = p.X(), p.Y(), p.Z()
            weights[i, j] = surface.Weight(i + 1, j + 1)
    plain = np.ptp(weights) <= 1e-14 * weights.max()
    return Nurbs(degrees, (knots[0], knots[1]), points, None if plain else weights)
