"""3DM files as STEP text, by rhino3dm (McNeel, MIT), so that one reader has all of CAD.

B-reps, extrusions, surfaces and curves are written as they are: NURBS surfaces, edges in space, and
the topology that the file states. The curves of trims in the parameters of a surface, which
rhino3dm does not give, are found by the reader from the edges. A layer becomes a product; the
instances of a block become copies, each at its position.
"""

from __future__ import annotations

import contextlib
import re
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from moldloft.cad import needed
from moldloft.errors import FileError

__all__ = ["meshes", "step_text"]

_PREFIXES = {
    "Nanometers": (".NANO.", 1e-9),
    "Microns": (".MICRO.", 1e-6),
    "Millimeters": (".MILLI.", 1e-3),
    "Centimeters": (".CENTI.", 1e-2),
    "Decimeters": (".DECI.", 1e-1),
    "Meters": ("$", 1.0),
    "Dekameters": (".DECA.", 10.0),
    "Hectometers": (".HECTO.", 100.0),
    "Kilometers": (".KILO.", 1e3),
    "Megameters": (".MEGA.", 1e6),
    "Gigameters": (".GIGA.", 1e9),
}
"""Prefixes of Part 41 for Rhino's units of length, and metres."""

_OTHERS = {
    "Angstroms": ("ANGSTROM", 1e-10),
    "Microinches": ("MICROINCH", 2.54e-8),
    "Mils": ("MIL", 2.54e-5),
    "Inches": ("INCH", 0.0254),
    "Feet": ("FOOT", 0.3048),
    "Yards": ("YARD", 0.9144),
    "Miles": ("MILE", 1609.344),
    "PrinterPoints": ("POINT", 0.0254 / 72),
    "PrinterPicas": ("PICA", 0.0254 / 6),
    "NauticalMiles": ("NAUTICAL MILE", 1852.0),
}
"""Names and metres of Rhino's other units of length."""

_MOST_BLOCKS = 100_000
"""Maximum number of objects after all blocks are placed."""

_DEEPEST = 50
"""Maximum depth of blocks in blocks."""

_SAME_KNOT = 1e-12
"""Knots closer than this fraction of all are one."""

_RECTANGULAR = 1e-12
"""Deviation from a rectangle, relative to its size, up to which a surface is a plane."""

_APART = {"Mesh": "meshes", "SubD": "subdivision surfaces", "Point": "points"}
"""Names of content that is not read; the rest is annotation."""


def step_text(path: Path, data: bytes) -> tuple[str, list[str]]:
    """The shapes of a 3DM file as the text of a STEP file, with remarks on what it leaves out.

    Parameters
    ----------
    path
        The file, for errors.
    data
        Its content.

    Raises
    ------
    FileError
        If it is not a 3DM file, or contains no surface and no curve.
    """
    rhino: Any = needed("rhino3dm", "rhino3dm", "reading 3DM")
    try:
        file = _opened(rhino, data)
    except FileError as error:
        raise FileError(f"cannot read `{path}`: {error}") from error
    text = _StepText(rhino, file)
    text.add_all()
    if not text.products:
        raise FileError(
            f"cannot read `{path}`: it contains no visible surface and no visible curve"
            + "".join(f"; {remark}" for remark in text.remarks)
            + "\nhelp: `moldloft.read_mesh` reads its meshes"
            * any(isinstance(o.Geometry, rhino.Mesh) for o in file.Objects)
        )
    return text.whole(), text.remarks


def meshes(data: bytes) -> tuple[Any, Any, list[tuple[str, int, int]], float | None]:
    """The visible meshes of a 3DM file.

    Returns
    -------
    tuple
        Points ``(n, 3)``; corners from 0 ``(m, 4)``, a triangle repeats its last; ranges of faces
        by name of object; metres of the unit of length, None if the file states none.

    Raises
    ------
    FileError
        If it is not a 3DM file.
    """
    rhino: Any = needed("rhino3dm", "rhino3dm", "reading 3DM")
    file = _opened(rhino, data)
    points, faces, groups = [np.empty((0, 3))], [np.empty((0, 4), dtype=np.uint32)], []
    first = start = 0
    for thing in file.Objects:
        mesh = thing.Geometry
        if not isinstance(mesh, rhino.Mesh) or not thing.Attributes.Visible:
            continue
        vertices = [mesh.Vertices[k] for k in range(len(mesh.Vertices))]
        points.append(np.array([(p.X, p.Y, p.Z) for p in vertices]).reshape(-1, 3))
        corners = [mesh.Faces[k] for k in range(mesh.Faces.Count)]
        faces.append(np.array(corners, dtype=np.uint32).reshape(-1, 4) + np.uint32(first))
        if thing.Attributes.Name:
            groups.append((str(thing.Attributes.Name), start, start + len(corners)))
        first, start = first + len(vertices), start + len(corners)
    unit = str(file.Settings.ModelUnitSystem).rsplit(".", 1)[-1]
    _, metres = {**_PREFIXES, **_OTHERS}.get(unit, ("", None))
    return np.concatenate(points), np.concatenate(faces), groups, metres


def _opened(rhino: Any, data: bytes) -> Any:
    if not data.startswith(b"3D Geometry File Format"):
        raise FileError("not a 3DM file (it must begin with 3D Geometry)")
    with tempfile.TemporaryDirectory() as folder:
        # Its reader of bytes takes no file of versions 1 to 4.
        copy = Path(folder) / "model.3dm"
        copy.write_bytes(data)
        file = rhino.File3dm.Read(str(copy))
    if file is None:
        raise FileError(
            "rhino3dm does not read it; it is damaged, or of a version that the installed rhino3dm "
            "does not know"
        )
    return file


class _StepText:
    """Entities of a STEP file, as they are added."""

    def __init__(self, rhino: Any, file: Any) -> None:
        self._rhino = rhino
        self._file = file
        self._lines: list[str] = []
        self.remarks: list[str] = []
        self._left: Counter[str] = Counter()
        self._count = 0
        self._move: Any = np.eye(4)
        """From a shape in its block to its position. It is applied to control points: an arc or a
        surface of revolution of rhino3dm cannot take every map."""
        self.products: dict[str, list[int]] = {}
        self._layers = {layer.Index: layer for layer in file.Layers}
        self._objects = {str(o.Attributes.Id): o for o in file.Objects}
        self._blocks = {str(b.Id): b for b in file.InstanceDefinitions}
        self._context = self._units()

    def add(self, body: str) -> int:
        self._lines.append(body)
        return len(self._lines)

    def _several(self, numbers: list[int]) -> str:
        return "(" + ",".join(f"#{n}" for n in numbers) + ")"

    def _units(self) -> int:
        name = str(self._file.Settings.ModelUnitSystem).rsplit(".", 1)[-1]
        if name in _OTHERS:
            label, metres = _OTHERS[name]
            base = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))")
            exponents = self.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")
            measure = f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({_number(metres)}),#{base})"
            unit = self.add(
                f"(CONVERSION_BASED_UNIT('{label}',#{self.add(measure)})LENGTH_UNIT()"
                f"NAMED_UNIT(#{exponents}))"
            )
        else:
            if name not in _PREFIXES:
                self.remarks.append(
                    "the file states no unit of length: its numbers are taken as millimetres"
                )
            prefix, _ = _PREFIXES.get(name, _PREFIXES["Millimeters"])
            unit = self.add(f"(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.))")
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        tolerance = float(self._file.Settings.ModelAbsoluteTolerance)
        tolerance = tolerance if np.isfinite(tolerance) and tolerance > 0 else 1e-3
        near = self.add(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({_number(tolerance)}),#{unit},"
            "'distance_accuracy_value','')"
        )
        return self.add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{near}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{unit},#{angle},#{solid}))"
            "REPRESENTATION_CONTEXT('','3D'))"
        )

    def add_all(self) -> None:
        for thing in self._file.Objects:
            attributes = thing.Attributes
            if attributes.IsInstanceDefinitionObject:
                continue
            layer = self._layers.get(attributes.LayerIndex)
            hidden = not attributes.Visible or (layer is not None and not layer.Visible)
            if hidden:
                self._left["hidden objects"] += 1
                continue
            name = "" if layer is None else str(layer.FullPath or layer.Name)
            self._object(thing, name or "model", [], None)
        if self._left:
            what = ", ".join(f"{name} ({count})" for name, count in sorted(self._left.items()))
            self.remarks.append(f"left out: {what}")

    def _object(self, thing: Any, product: str, moves: list[Any], colour: Any) -> None:
        """An object at its position, the product of the moves."""
        geometry, attributes = thing.Geometry, thing.Attributes
        own = self._colour(attributes) or colour
        if isinstance(geometry, self._rhino.InstanceReference):
            block = self._blocks.get(str(geometry.ParentIdefId))
            if block is None or len(moves) >= _DEEPEST:
                self._left["instances of blocks that the file does not have"] += 1
                return
            for part in map(str, block.GetObjectIds()):
                if part in self._objects:
                    label = str(block.Name) or product
                    self._object(self._objects[part], label, [*moves, geometry.Xform], own)
            return
        self._count += 1
        if self._count > _MOST_BLOCKS:
            raise FileError(
                f"cannot read the file: its blocks place more than {_MOST_BLOCKS} objects"
            )
        self._move = np.linalg.multi_dot([np.eye(4), np.eye(4), *map(_matrix, moves)])
        name = str(attributes.Name or "")
        # What our own files have, in the order of the faces.
        labels, colours = (
            str(attributes.GetUserString(key) or "").split("\n") for key in ("faces", "colours")
        )
        try:
            items = list(self._items(geometry, name, labels, colours))
        except ValueError as error:
            self.remarks.append(f"`{name or 'an object'}` is left out: {error}")
            return
        if own is not None:
            for item in items:
                self._style(item, own)
        if items:
            self.products.setdefault(product, []).extend(items)

    def _colour(self, attributes: Any) -> tuple[int, int, int] | None:
        source = self._rhino.ObjectColorSource
        if attributes.ColorSource == source.ColorFromObject:
            return tuple(attributes.ObjectColor[:3])
        layer = self._layers.get(attributes.LayerIndex)
        # Black is the colour of a layer that nobody coloured.
        if attributes.ColorSource == source.ColorFromLayer and layer and any(layer.Color[:3]):
            return tuple(layer.Color[:3])
        return None

    def _style(self, item: int, colour: tuple[int, int, int]) -> None:
        red, green, blue = (_number(c / 255) for c in colour)
        made = self.add(f"COLOUR_RGB('',{red},{green},{blue})")
        made = self.add(f"FILL_AREA_STYLE_COLOUR('',#{made})")
        made = self.add(f"FILL_AREA_STYLE('',(#{made}))")
        made = self.add(f"SURFACE_STYLE_FILL_AREA(#{made})")
        made = self.add(f"SURFACE_SIDE_STYLE('',(#{made}))")
        made = self.add(f"SURFACE_STYLE_USAGE(.BOTH.,#{made})")
        made = self.add(f"PRESENTATION_STYLE_ASSIGNMENT((#{made}))")
        made = self.add(f"STYLED_ITEM('color',(#{made}),#{item})")
        self.add(
            f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#{made}),#{self._context})"
        )

    def _items(
        self, geometry: Any, name: str, labels: list[str], colours: list[str]
    ) -> Iterator[int]:
        """The representation items of an object."""
        rhino = self._rhino
        if isinstance(geometry, rhino.Curve):
            curve = geometry.ToNurbsCurve()
            if curve is not None:
                made = self.add(f"GEOMETRIC_CURVE_SET({_text(name)},(#{self._curve(curve, name)}))")
                yield made
            return
        solid = isinstance(geometry, rhino.Brep | rhino.Extrusion | rhino.Surface)
        brep = rhino.Brep.TryConvertBrep(geometry) if solid else None
        if brep is None or len(brep.Faces) == 0:
            kind = type(geometry).__name__
            self._left[_APART.get(kind, "annotations, lights and the like")] += 1
            return
        faces = self._faces(brep, name, labels)
        if not faces:
            return
        if len(colours) == len(faces) == len(brep.Faces):
            for made, colour in zip(faces, colours, strict=True):
                if re.fullmatch("[0-9a-f]{6}", colour):
                    red, green, blue = bytes.fromhex(colour)
                    self._style(made, (red, green, blue))
        several = self._several(faces)
        if brep.IsSolid:
            shell = self.add(f"CLOSED_SHELL({_text(name)},{several})")
            yield self.add(f"MANIFOLD_SOLID_BREP({_text(name)},#{shell})")
        else:
            shell = self.add(f"OPEN_SHELL({_text(name)},{several})")
            yield self.add(f"SHELL_BASED_SURFACE_MODEL({_text(name)},(#{shell}))")

    def _faces(self, brep: Any, name: str, labels: list[str]) -> list[int]:
        rhino = self._rhino
        ends: dict[int, tuple[int, int]] = {}
        loops: list[list[tuple[bool, list[Any]]]] = []
        for k in range(len(brep.Faces)):
            face = brep.Faces[k]
            own = []
            for j in range(len(face.Loops)):
                loop = face.Loops[j]
                if loop.LoopType not in (rhino.BrepLoopType.Outer, rhino.BrepLoopType.Inner):
                    self._left["slits and marks on faces"] += 1
                    continue
                trims = [loop.Trims[i] for i in range(loop.TrimCount)]
                # A pole of the surface is a trim without an edge.
                trims = [trim for trim in trims if trim.EdgeIndex >= 0]
                for trim in trims:
                    pair = (trim.StartVertexIndex, trim.EndVertexIndex)
                    ends.setdefault(trim.EdgeIndex, pair[::-1] if trim.IsReversed else pair)
                own.append((loop.LoopType == rhino.BrepLoopType.Outer, trims))
            loops.append(own)
        points = [
            self.add(f"VERTEX_POINT('',#{self._point(brep.Vertices[k].Location)})")
            for k in range(len(brep.Vertices))
        ]
        edges = {}
        for k, (a, b) in ends.items():
            curve = self._curve(brep.Edges[k].ToNurbsCurve(), "")
            edges[k] = self.add(f"EDGE_CURVE('',#{points[a]},#{points[b]},#{curve},.T.)")
        made = []
        for k, own in enumerate(loops):
            face = brep.Faces[k]
            surface = face.UnderlyingSurface().ToNurbsSurface()
            if surface is None or not any(trims for _, trims in own):
                self.remarks.append(f"a face of `{name or 'an object'}` is left out: no border")
                continue
            mirrored = np.linalg.det(self._move[:3, :3]) < 0
            along = face.OrientationIsReversed == mirrored
            bounds = []
            for outer, trims in own:
                if not trims:
                    continue
                sides = [
                    self.add(
                        f"ORIENTED_EDGE('',*,*,#{edges[t.EdgeIndex]},{_flag(not t.IsReversed)})"
                    )
                    for t in trims
                ]
                loop = self.add(f"EDGE_LOOP('',{self._several(sides)})")
                kind = "FACE_OUTER_BOUND" if outer else "FACE_BOUND"
                bounds.append(self.add(f"{kind}('',#{loop},{_flag(along)})"))
            label = name if len(loops) == 1 or not name else f"{name}_{k + 1}"
            label = labels[k] if len(labels) == len(loops) > 1 else label
            made.append(
                self.add(
                    f"ADVANCED_FACE({_text(label)},{self._several(bounds)},"
                    f"#{self._surface(surface)},{_flag(along)})"
                )
            )
        return made

    def _point(self, p: Any) -> int:
        return self._at(np.array([p.X, p.Y, p.Z]))

    def _at(self, p: Any) -> int:
        p = self._move[:3, :3] @ p + self._move[:3, 3]
        return self.add(f"CARTESIAN_POINT('',({','.join(map(_number, p))}))")

    def _curve(self, curve: Any, name: str) -> int:
        poles, weights = _poles(curve.Points[k] for k in range(len(curve.Points)))
        knots, counts = _knots([curve.Knots[k] for k in range(len(curve.Knots))], curve.Degree)
        closed = _flag(bool(curve.IsClosed))
        points = self._several([self._at(p) for p in poles])
        spline = f"{curve.Degree},{points},.UNSPECIFIED.,{closed},.F."
        ends = f"{counts},{knots},.UNSPECIFIED."
        if weights is None:
            return self.add(f"B_SPLINE_CURVE_WITH_KNOTS({_text(name)},{spline},{ends})")
        return self.add(
            f"(BOUNDED_CURVE()B_SPLINE_CURVE({spline})B_SPLINE_CURVE_WITH_KNOTS({ends})CURVE()"
            f"GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({_numbers(weights)})"
            f"REPRESENTATION_ITEM({_text(name)}))"
        )

    def _surface(self, surface: Any) -> int:
        p, q = surface.OrderU - 1, surface.OrderV - 1
        rows, columns = surface.Points.CountU, surface.Points.CountV
        poles, weights = _poles(surface.Points[i, j] for i in range(rows) for j in range(columns))
        u, u_counts = _knots([surface.KnotsU[k] for k in range(len(surface.KnotsU))], p)
        v, v_counts = _knots([surface.KnotsV[k] for k in range(len(surface.KnotsV))], q)
        moved = poles @ self._move[:3, :3].T
        if (plane := _plane(moved, weights, (p, q))) is not None:
            normal, along = plane
            origin = poles[0]
            place = self.add(
                f"AXIS2_PLACEMENT_3D('',#{self._at(origin)},#{self._direction(normal)},"
                f"#{self._direction(along)})"
            )
            return self.add(f"PLANE('',#{place})")
        points = [self._at(x) for x in poles]
        net = ",".join(self._several(points[i * columns : (i + 1) * columns]) for i in range(rows))
        closed = f"{_flag(bool(surface.IsClosed(0)))},{_flag(bool(surface.IsClosed(1)))}"
        spline = f"{p},{q},({net}),.UNSPECIFIED.,{closed},.F."
        ends = f"{u_counts},{v_counts},{u},{v},.UNSPECIFIED."
        if weights is None:
            return self.add(f"B_SPLINE_SURFACE_WITH_KNOTS('',{spline},{ends})")
        grid = weights.reshape(rows, columns)
        return self.add(
            f"(BOUNDED_SURFACE()B_SPLINE_SURFACE({spline})B_SPLINE_SURFACE_WITH_KNOTS({ends})"
            "GEOMETRIC_REPRESENTATION_ITEM()"
            f"RATIONAL_B_SPLINE_SURFACE(({','.join(map(_numbers, grid))}))"
            "REPRESENTATION_ITEM('')SURFACE())"
        )

    def _direction(self, d: Any) -> int:
        return self.add(f"DIRECTION('',({','.join(map(_number, d))}))")

    def whole(self) -> str:
        """The text of the file."""
        context = self.add("APPLICATION_CONTEXT('automotive design')")
        self.add(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,"
            f"#{context})"
        )
        mechanical = self.add(f"PRODUCT_CONTEXT('',#{context},'mechanical')")
        design = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{context},'design')")
        for name, items in self.products.items():
            label = _text(name.replace("::", "_"))
            shape = self.add(
                f"SHAPE_REPRESENTATION({label},{self._several(items)},#{self._context})"
            )
            product = self.add(f"PRODUCT({label},{label},'',(#{mechanical}))")
            made = self.add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
            made = self.add(f"PRODUCT_DEFINITION('','',#{made},#{design})")
            made = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{made})")
            self.add(f"SHAPE_DEFINITION_REPRESENTATION(#{made},#{shape})")
        lines = "".join(f"#{k + 1}={body};\n" for k, body in enumerate(self._lines))
        return (
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
            "FILE_NAME('','',(''),(''),'','','');\n"
            "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
            f"{lines}ENDSEC;\nEND-ISO-10303-21;\n"
        )


def _matrix(move: Any) -> Any:
    return np.array([[getattr(move, f"M{i}{j}") for j in range(4)] for i in range(4)])


def _poles(points: Iterator[Any]) -> tuple[Any, Any]:
    """Points and, unless all are equal, weights: rhino3dm gives homogeneous coordinates."""
    found = np.array([(p.X, p.Y, p.Z, p.W) for p in points])
    weights = found[:, 3]
    if not (np.isfinite(found).all() and (weights > 0).all()):
        raise ValueError("expected finite coordinates and positive weights")
    poles = found[:, :3] / weights[:, None]
    plain = np.ptp(weights) <= 1e-14 * abs(weights).max()
    return poles, None if plain else weights


def _plane(poles: Any, weights: Any, degrees: tuple[int, int]) -> tuple[Any, Any] | None:
    """Normal and first direction of a rectangle, on whose plane trims are exact."""
    if degrees != (1, 1) or len(poles) != 4 or weights is not None:
        return None
    u, v = poles[2] - poles[0], poles[1] - poles[0]
    sides = np.linalg.norm(u), np.linalg.norm(v)
    skew = np.linalg.norm(poles[3] - poles[2] - v) / max(sides)
    if min(sides) == 0 or skew > _RECTANGULAR or abs(u @ v) > _RECTANGULAR * sides[0] * sides[1]:
        return None
    return np.cross(u, v) / (sides[0] * sides[1]), u / sides[0]


def _knots(knots: list[float], degree: int) -> tuple[str, str]:
    """Distinct knots and their multiplicities; those of Rhino lack the first and the last."""
    span = knots[-1] - knots[0]
    if not (np.isfinite(knots).all() and span > 0 and (np.diff(knots) >= 0).all()):
        raise ValueError("expected finite knots in ascending order")
    # At a clamped end the missing one is as the next, otherwise no value of it matters.
    first = knots[0] if knots[0] == knots[degree - 1] else knots[0] - (knots[1] - knots[0])
    last = knots[-1] if knots[-1] == knots[-degree] else knots[-1] + (knots[-1] - knots[-2])
    distinct: list[float] = []
    counts: list[int] = []
    for knot in [first, *knots, last]:
        if distinct and knot - distinct[-1] <= _SAME_KNOT * span:
            counts[-1] += 1
        else:
            distinct.append(knot)
            counts.append(1)
    distinct = [(knot - knots[0]) / span for knot in distinct]
    return _numbers(distinct), "(" + ",".join(map(str, counts)) + ")"


def _number(x: float) -> str:
    """A real number of Part 21, which has a point."""
    text = repr(float(x)).upper()
    if "." in text.partition("E")[0]:
        return text
    with contextlib.suppress(ValueError):
        mantissa, _, exponent = text.partition("E")
        return f"{mantissa}.E{exponent}" if exponent else f"{mantissa}."
    return text


def _numbers(values: Any) -> str:
    return "(" + ",".join(map(_number, values)) + ")"


def _flag(yes: bool) -> str:
    return ".T." if yes else ".F."


def _text(words: str) -> str:
    """A string of Part 21 (ISO 10303-21, 6.4.3)."""
    plain = words.replace("\\", "\\\\").replace("'", "''")
    return "'" + "".join(c if " " <= c <= "~" else f"\\X4\\{ord(c):08X}\\X0\\" for c in plain) + "'"
