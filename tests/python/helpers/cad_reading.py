"""What another program, OCCT, finds in a CAD file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass
class Found:
    """Counts, measures, names and colours of a file."""

    valid: bool
    solids: int
    shells: int
    faces: int
    edges: int
    area: float
    volume: float
    names: set[str] = field(default_factory=set)
    colours: set[tuple[int, ...]] = field(default_factory=set)
    layers: set[str] = field(default_factory=set)
    tolerance: float = 0.0
    closed: int = 0
    shape: Any = None


def read(path: Path, unit: float = 1.0, accuracy: float = 1e-10, *, gauss: bool = False) -> Found:
    """Reads a STEP or IGES file, in units of so many metres; areas to a relative accuracy.

    OCCT's rule of Kronrod for volumes does not end on some cut tori; that of Gauss does.
    """
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    if path.suffix in (".igs", ".iges"):
        from OCP.IGESCAFControl import IGESCAFControl_Reader

        reader = IGESCAFControl_Reader()
    else:
        from OCP.Interface import Interface_Static
        from OCP.STEPCAFControl import STEPCAFControl_Reader

        reader = STEPCAFControl_Reader()
        Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, unit)
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    reader.SetLayerMode(True)
    status = reader.ReadFile(str(path))
    assert str(status).endswith("RetDone"), status
    assert reader.Transfer(document)
    return _found(document, accuracy, gauss)


def _found(document: Any, accuracy: float, gauss: bool) -> Found:
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.collections import Sequence_TDF_Label
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import (
        TopAbs_EDGE,
        TopAbs_FACE,
        TopAbs_SHELL,
        TopAbs_SOLID,
        TopAbs_VERTEX,
    )
    from OCP.TopoDS import TopoDS, TopoDS_Compound
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    free = Sequence_TDF_Label()
    tool.GetFreeShapes(free)
    compound = TopoDS_Compound()
    builder = BRep_Builder()
    builder.MakeCompound(compound)
    for k in range(1, free.Length() + 1):
        builder.Add(compound, tool.GetShape_s(free.Value(k)))
    parts = {
        kind: _unique(compound, kind)
        for kind in (TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE, TopAbs_EDGE, TopAbs_VERTEX)
    }
    area = volume = 0.0
    for face in parts[TopAbs_FACE]:
        figures = GProp_GProps()
        BRepGProp.SurfaceProperties_s(face, figures, accuracy)
        area += figures.Mass()
    for solid in parts[TopAbs_SOLID]:
        figures = GProp_GProps()
        if gauss:
            BRepGProp.VolumeProperties_s(solid, figures, 1e-9, False, False)
        else:
            BRepGProp.VolumePropertiesGK_s(solid, figures, 1e-8)
        volume += figures.Mass()
    tolerance = max(
        [BRep_Tool.Tolerance_s(TopoDS.Edge(e)) for e in parts[TopAbs_EDGE]], default=0.0
    )
    found = Found(
        BRepCheck_Analyzer(compound).IsValid(),
        len(parts[TopAbs_SOLID]),
        len(parts[TopAbs_SHELL]),
        len(parts[TopAbs_FACE]),
        len(parts[TopAbs_EDGE]),
        area,
        volume,
        tolerance=tolerance,
        closed=sum(BRep_Tool.IsClosed_s(s) for s in parts[TopAbs_SHELL]),
        shape=compound,
    )
    _attributes(document, tool, free, found)
    return found


def _unique(shape: Any, kind: Any) -> list[Any]:
    from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as Shapes
    from OCP.TopExp import TopExp

    shapes = Shapes()
    TopExp.MapShapes_s(shape, kind, shapes)
    return [shapes.FindKey(k) for k in range(1, shapes.Extent() + 1)]


def _attributes(document: Any, tool: Any, free: Any, found: Found) -> None:
    from OCP.collections import Sequence_TDF_Label
    from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
    from OCP.TDataStd import TDataStd_Name
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    def walk(label: Any) -> None:
        if label.IsAttribute(TDataStd_Name.GetID_s()):
            name = TDataStd_Name()
            label.FindAttribute(TDataStd_Name.GetID_s(), name)
            found.names.add(name.Get().ToExtString())
        inner = Sequence_TDF_Label()
        tool.GetSubShapes_s(label, inner)
        tool.GetComponents_s(label, inner)
        for k in range(1, inner.Length() + 1):
            walk(inner.Value(k))

    labels = Sequence_TDF_Label()
    tool.GetShapes(labels)
    for k in range(1, labels.Length() + 1):
        walk(labels.Value(k))
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    all_colours = Sequence_TDF_Label()
    colours.GetColors(all_colours)
    for k in range(1, all_colours.Length() + 1):
        colour = Quantity_Color()
        colours.GetColor_s(all_colours.Value(k), colour)
        rgb = colour.Values(Quantity_TOC_sRGB)
        found.colours.add(tuple(round(255 * x) for x in rgb))
    layers = XCAFDoc_DocumentTool.LayerTool_s(document.Main())
    all_layers = Sequence_TDF_Label()
    layers.GetLayerLabels(all_layers)
    for k in range(1, all_layers.Length() + 1):
        name = TDataStd_Name()
        all_layers.Value(k).FindAttribute(TDataStd_Name.GetID_s(), name)
        found.layers.add(name.Get().ToExtString())
