"""OCCT (package ``cadquery-ocp-novtk``): shapes from STEP, and what CAD files hold."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.cad import identifier, needed
from moldloft.errors import Error, FileError
from moldloft.nurbs import Nurbs
from moldloft.storage import read_bytes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Imported", "ImportedFace", "read", "read_shape"]


@contextmanager
def _quiet() -> Iterator[None]:
    """OCCT prints to the terminal itself: its first descriptor is turned to nowhere."""
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
    """The shape of a STEP file's bytes, in units of so many metres."""
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    with _quiet():
        status = reader.ChangeReader().ReadStream("model.step", io.BytesIO(data))
        if not str(status).endswith("RetDone"):
            raise Error("OCCT cannot read the STEP file that was written")
        document = _document(metres)
        reader.Transfer(document)
    return _compound(document)


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


def _compound(document: Any) -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    shapes = _free(document)
    if len(shapes) == 1:
        return shapes[0]
    compound = TopoDS_Compound()
    builder = BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


@dataclass
class ImportedFace:
    """A face of a CAD file."""

    name: str
    """A name that objects of a model may have."""
    surface: Nurbs
    """Its surface."""
    loops: list[list[tuple[int, bool, Nurbs]]]
    """Its loops, the outer one first: edges by number, whether the loop runs backwards along each,
    and the curve in the parameters (u, v, 0) of the surface."""
    natural: bool
    """Whether its loops are the edges of the surface's parameters."""
    reversed: bool
    """Whether its normal is opposite to that of the surface."""


@dataclass
class Imported:
    """What a CAD file holds."""

    faces: list[ImportedFace] = field(default_factory=list)
    """Its faces."""
    curves: dict[str, Nurbs] = field(default_factory=dict)
    """Curves that bound no face."""
    metres: float = 1.0
    """The unit of length."""
    remarks: list[str] = field(default_factory=list)
    """What was left out or is doubtful."""


def read(path: Path, metres: float) -> Imported:
    """The faces and curves of a STEP or IGES file, in units of so many metres.

    Parameters
    ----------
    path
        The file.
    metres
        The unit of length of what is returned.

    Raises
    ------
    FileError
        When the file is not of its format, cut short, or holds no shape.
    """
    needed("OCP", "cadquery-ocp-novtk", "reading STEP and IGES")
    found = Imported(metres=metres)
    iges = path.suffix.lower() in (".igs", ".iges")
    _look(path, iges, found)
    if iges:
        from OCP.IGESCAFControl import IGESCAFControl_Reader

        reader: Any = IGESCAFControl_Reader()
    else:
        from OCP.Interface import Interface_Static
        from OCP.STEPCAFControl import STEPCAFControl_Reader

        reader = STEPCAFControl_Reader()
        Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    reader.SetNameMode(True)
    document = _document(metres)
    with _quiet():
        status = reader.ReadFile(str(path))
        done = str(status).endswith("RetDone") and reader.Transfer(document)
    if not done:
        kind = "an IGES" if iges else "a STEP"
        raise FileError(f"cannot read `{path}`: not {kind} file that OCCT takes, or cut short")
    _collect(document, found)
    if not found.faces and not found.curves:
        raise FileError(f"cannot read `{path}`: it holds no face and no curve")
    return found


def _look(path: Path, iges: bool, found: Imported) -> None:
    """What the text says that OCCT passes over: missing units, references to nothing."""
    import re

    text = read_bytes(path).decode("latin-1")
    if not text.strip():
        raise FileError(f"cannot read `{path}`: the file is empty")
    if iges:
        if not re.search(r"^.{72}T", text, re.M):
            raise FileError(f"cannot read `{path}`: no terminate section; the file is cut short")
        return
    if not text.lstrip().startswith("ISO-10303-21"):
        raise FileError(f"cannot read `{path}`: not a STEP file (it must begin with ISO-10303-21)")
    if "END-ISO-10303-21" not in text:
        raise FileError(f"cannot read `{path}`: the end is missing; the file is cut short")
    plain = re.sub(r"'[^']*'", "''", text)
    if "LENGTH_UNIT" not in plain:
        found.remarks.append("the file names no unit of length; millimetres are taken")
    defined = set(re.findall(r"#(\d+)\s*=", plain))
    lost = sorted({int(n) for n in re.findall(r"#(\d+)", plain) if n not in defined})
    if lost:
        few = ", ".join(f"#{n}" for n in lost[:5])
        found.remarks.append(
            f"{len(lost)} entities that others refer to are missing ({few}); faces may be lost"
        )
    faces = len(re.findall(r"=\s*ADVANCED_FACE\s*\(", plain))
    found.__dict__["_stated"] = faces


def _collect(document: Any, found: Imported) -> None:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED
    from OCP.TopoDS import TopoDS

    names = _names(document)
    taken: set[str] = set()
    edges: Any = None
    known = 0
    for shape in _free(document):
        originals = _unique(shape, TopAbs_FACE)
        convert = BRepBuilderAPI_NurbsConvert(shape, True)
        edges = _map(convert.Shape(), TopAbs_EDGE)
        for original in originals:
            label = _called(names, original) or f"face{len(found.faces) + 1}"
            face = TopoDS.Face(convert.ModifiedShape(original))
            try:
                made = _face(face, edges, identifier(label, taken))
            except Error as error:
                found.remarks.append(f"face `{label}` is left out: {error}")
                continue
            made.reversed = face.Orientation() == TopAbs_REVERSED
            # Numbers of edges are those of all shapes of the file.
            made.loops = [[(n + known, back, t) for n, back, t in own] for own in made.loops]
            found.faces.append(made)
        known += edges.Extent()
        alone = _loose_edges(shape)
        for edge in alone:
            label = _called(names, edge) or f"curve{len(found.curves) + 1}"
            curve = _space_curve(edge)
            if curve is not None:
                found.curves[identifier(label, taken)] = curve
    stated = found.__dict__.pop("_stated", None)
    if stated is not None and stated > len(found.faces):
        found.remarks.append(f"{stated} faces stand in the file, {len(found.faces)} could be read")


def _map(shape: Any, kind: Any) -> Any:
    from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as Shapes
    from OCP.TopExp import TopExp

    shapes = Shapes()
    TopExp.MapShapes_s(shape, kind, shapes)
    return shapes


def _unique(shape: Any, kind: Any) -> list[Any]:
    shapes = _map(shape, kind)
    return [shapes.FindKey(k) for k in range(1, shapes.Extent() + 1)]


def _loose_edges(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, TopAbs_EDGE, TopAbs_FACE)
    found = []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def _names(document: Any) -> list[tuple[Any, str]]:
    from OCP.collections import Sequence_TDF_Label
    from OCP.TDataStd import TDataStd_Name
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    found: list[tuple[Any, str]] = []

    def walk(label: Any) -> None:
        if label.IsAttribute(TDataStd_Name.GetID_s()):
            name = TDataStd_Name()
            label.FindAttribute(TDataStd_Name.GetID_s(), name)
            found.append((tool.GetShape_s(label), name.Get().ToExtString()))
        inner = Sequence_TDF_Label()
        tool.GetSubShapes_s(label, inner)
        for k in range(1, inner.Length() + 1):
            walk(inner.Value(k))

    labels = Sequence_TDF_Label()
    tool.GetShapes(labels)
    for k in range(1, labels.Length() + 1):
        walk(labels.Value(k))
    return found


def _called(names: list[tuple[Any, str]], shape: Any) -> str:
    for named, name in names:
        if named.IsPartner(shape) or named.IsSame(shape):
            return name
    return ""


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
    from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
    from OCP.Geom import Geom_BSplineSurface
    from OCP.Geom2d import Geom2d_TrimmedCurve
    from OCP.Geom2dConvert import Geom2dConvert
    from OCP.GeomConvert import GeomConvert
    from OCP.TopAbs import TopAbs_REVERSED, TopAbs_WIRE
    from OCP.TopoDS import TopoDS

    surface = BRep_Tool.Surface_s(face)
    if not isinstance(surface, Geom_BSplineSurface):
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
    loops = []
    wires = _unique(face, TopAbs_WIRE)
    wires.sort(key=lambda w: not w.IsSame(outer))
    for wire in wires:
        cycle = []
        explorer = BRepTools_WireExplorer(TopoDS.Wire(wire), face)
        while explorer.More():
            edge = explorer.Current()
            explorer.Next()
            low, high = BRep_Tool.Range_s(edge, face)
            path = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
            if path is None:
                raise Error("an edge has no curve in its parameters")
            spline = Geom2dConvert.CurveToBSplineCurve_s(Geom2d_TrimmedCurve(path, low, high))
            trace = _clamped(spline, spline.FirstParameter(), spline.LastParameter(), flat=True)
            trace.points[:, 0] = (trace.points[:, 0] - u0) / (u1 - u0)
            trace.points[:, 1] = (trace.points[:, 1] - v0) / (v1 - v0)
            if np.ptp(trace.points, axis=0).max() < 1e-12:
                continue
            number = edges.FindIndex(edge)
            cycle.append((number, edge.Orientation() == TopAbs_REVERSED, trace))
        loops.append(cycle)
    traces = [trace for cycle in loops for _, _, trace in cycle]
    natural = bool(traces) and all(border(trace) for trace in traces)
    return ImportedFace(name, made, loops, natural, False)


def border(trace: Nurbs) -> str:
    """The edge of the parameters that a curve in them runs along, such as ``u0``; or nothing.

    Parameters
    ----------
    trace
        The curve, in (u, v, 0).
    """
    for k, letter in enumerate("uv"):
        for end in (0, 1):
            if np.abs(trace.points[:, k] - end).max() < 1e-9:
                return f"{letter}{end}"
    return ""


def is_whole(trace: Nurbs) -> bool:
    """Whether a curve along an edge of the parameters runs along all of it.

    Parameters
    ----------
    trace
        The curve, in (u, v, 0).
    """
    return bool(abs(np.ptp(trace.points[[0, -1]], axis=0).max() - 1) < 1e-9)


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
