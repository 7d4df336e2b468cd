"""Sewing of faces whose edges coincide within a tolerance."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

__all__ = ["Sewn", "faces_of", "is_sheet", "map_of"]

_LEAST = 1e-6
_MOST = 1e-4
"""Tolerance relative to the size."""


def map_of(shape: Any, kind: Any) -> Any:
    """The parts of a shape with a given type, each once."""
    from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as Shapes
    from OCP.TopExp import TopExp

    shapes = Shapes()
    TopExp.MapShapes_s(shape, kind, shapes)
    return shapes


def faces_of(shape: Any, kind: Any) -> list[Any]:
    """The parts of a shape with a given type as a list, each once."""
    shapes = map_of(shape, kind)
    return [shapes.FindKey(k) for k in range(1, shapes.Extent() + 1)]


@dataclass
class Sewn:
    """A sewn shape with the result of sewing."""

    shape: Any
    """The shape as read."""
    passes: list[Any] = field(default_factory=list)
    """Sewing operations in order; empty if there was nothing to sew."""
    body: Any = None
    """Its faces with their common edges."""
    tolerance: float = 0.0
    """Maximum distance between edges that were united."""

    @classmethod
    def of(cls, shape: Any, resolution: float) -> Sewn:
        """The faces of a shape, sewn.

        Parameters
        ----------
        shape
            A compound of faces.
        resolution
            The least distance of two points that the file distinguishes.
        """
        from OCP.Bnd import Bnd_Box
        from OCP.BRepBndLib import BRepBndLib
        from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
        from OCP.TopAbs import TopAbs_FACE

        faces = faces_of(shape, TopAbs_FACE)
        if len(faces) < 2:
            return cls(shape)
        box = Bnd_Box()
        BRepBndLib.Add_s(shape, box)
        size = box.SquareExtent() ** 0.5
        tolerance = min(max(resolution, _LEAST * size), _MOST * size)
        passes: list[Any] = []
        # One pass of OCCT may leave edges that the next one finds, whatever the tolerance.
        while not passes or (
            passes[-1].NbFreeEdges()
            and (len(passes) == 1 or passes[-1].NbFreeEdges() < passes[-2].NbFreeEdges())
        ):
            sewing = BRepBuilderAPI_Sewing(tolerance)
            for face in faces:
                sewing.Add(face)
            sewing.Perform()
            passes.append(sewing)
            faces = faces_of(sewing.SewedShape(), TopAbs_FACE)
        return cls(shape, passes, _outward(passes[-1].SewedShape()), tolerance)

    @property
    def whole(self) -> Any:
        """The shape that contains its faces."""
        return self.shape if self.body is None else self.body

    @cached_property
    def _faces(self) -> Any:
        from OCP.TopAbs import TopAbs_FACE

        return map_of(self.body, TopAbs_FACE)

    def face(self, original: Any) -> Any:
        """A face of the shape, as part of the sewn whole."""
        if not self.passes:
            return original
        made = original
        for sewing in self.passes:
            made = sewing.Modified(made) if sewing.IsModified(made) else made
        number = self._faces.FindIndex(made)
        return self._faces.FindKey(number) if number else made

    @property
    def found(self) -> int:
        """Number of coincident edges that the file lists separately."""
        return 0 if self.body is None else _shared(self.body) - _shared(self.shape)

    def say(self, remarks: list[str], *, iges: bool) -> None:
        """Reports the number of merged edges and, for IGES, of open ones.

        Parameters
        ----------
        remarks
            Remarks on the file.
        iges
            True for an IGES file, which never states connections.
        """
        if not self.passes:
            return
        who = "IGES does" if iges else "the file does"
        if shared := self.found:
            remarks.append(
                f"{who} not say which faces hang together: {shared} edges of two faces are "
                f"within {self.tolerance:.2g} of one another and are taken as one"
            )
        if not iges:
            return
        alone = self.passes[-1].NbFreeEdges()
        if alone:
            remarks.append(
                f"{alone} edges belong to a single face, none other within {self.tolerance:.2g}: "
                "what the faces bound is open there"
            )


def _shared(shape: Any) -> int:
    """Number of edges common to two or more faces."""
    return sum(n > 1 for n in _uses(shape).values())


def _uses(shape: Any) -> dict[int, int]:
    """Number of faces at each edge."""
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE

    edges = map_of(shape, TopAbs_EDGE)
    uses: dict[int, int] = {}
    for face in faces_of(shape, TopAbs_FACE):
        for edge in faces_of(face, TopAbs_EDGE):
            number = edges.FindIndex(edge)
            uses[number] = uses.get(number, 0) + 1
    return uses


def is_sheet(shape: Any) -> bool:
    """True if the faces of a shape bound no solid."""
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID

    return not faces_of(shape, TopAbs_SOLID) and bool(faces_of(shape, TopAbs_FACE))


def _outward(shape: Any) -> Any:
    """The same shape with solids for closed shells, so that their faces are oriented outward."""
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.BRepLib import BRepLib
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL
    from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Solid

    compound = TopoDS_Compound()
    builder = BRep_Builder()
    builder.MakeCompound(compound)
    held = set()
    for found in faces_of(shape, TopAbs_SHELL):
        shell = TopoDS.Shell(found)
        held |= {hash(face) for face in faces_of(shell, TopAbs_FACE)}
        if not BRep_Tool.IsClosed_s(shell):
            builder.Add(compound, shell)
            continue
        solid = TopoDS_Solid()
        builder.MakeSolid(solid)
        builder.Add(solid, shell)
        BRepLib.OrientClosedSolid_s(solid)
        builder.Add(compound, solid)
    for face in faces_of(shape, TopAbs_FACE):
        if hash(face) not in held:
            builder.Add(compound, face)
    return compound
