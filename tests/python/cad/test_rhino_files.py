"""Reading of 3DM files: closed forms, positions in blocks, names, colours, units, damage."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft.cad.importing import program

pytest.importorskip("OCP")
# Its annotations are incomplete.
R: Any = pytest.importorskip("rhino3dm")


def file_of(unit: str = "Meters") -> Any:
    file = R.File3dm()
    file.Settings.ModelUnitSystem = getattr(R.UnitSystem, unit)
    return file


def written(file: Any, path: Path) -> Path:
    assert file.Write(str(path), 8)
    return path


def add(file: Any, shape: Any, **named: Any) -> Any:
    attributes = R.ObjectAttributes()
    for name, value in named.items():
        setattr(attributes, name, value)
    kinds = ((R.Brep, "Brep"), (R.Extrusion, "Extrusion"), (R.Surface, "Surface"))
    how = next((word for kind, word in kinds if isinstance(shape, kind)), "Curve")
    return getattr(file.Objects, f"Add{how}")(shape, attributes)


def point(p: Any) -> Any:
    return R.Point3d(*(float(x) for x in p))


def solids(rng: Any) -> list[tuple[str, Any, float, float]]:
    """Solids of random size with their volume and area."""
    at = point(rng.uniform(-3, 3, 3) - (0, 0, 10))
    r, h, t = rng.uniform(0.5, 2), rng.uniform(0.5, 4), rng.uniform(0.1, 0.3)
    a, b, c = rng.uniform(0.3, 3, 3)
    axis = R.Circle(at, r)
    cylinder = R.Cylinder(axis, h)
    corner = R.Point3d(at.X + a, at.Y + b, at.Z + c)
    box = R.Brep.CreateFromBox(R.Box(R.BoundingBox(at, corner)))
    pi = math.pi
    inner = r - t
    ring = pi * (r * r - inner * inner)
    return [
        ("ball", R.Brep.CreateFromSphere(R.Sphere(at, r)), 4 / 3 * pi * r**3, 4 * pi * r * r),
        (
            "can",
            R.Brep.CreateFromCylinder(cylinder, True, True),
            pi * r * r * h,
            2 * pi * r * (r + h),
        ),
        ("box", box, a * b * c, 2 * (a * b + b * c + c * a)),
        (
            "rod",
            R.Extrusion.CreateCylinderExtrusion(cylinder, True, True),
            pi * r * r * h,
            2 * pi * r * (r + h),
        ),
        (
            "pipe",
            R.Extrusion.CreatePipeExtrusion(cylinder, inner, True, True),
            ring * h,
            2 * ring + 2 * pi * (r + inner) * h,
        ),
    ]


@pytest.mark.parametrize("seed", range(4))
def test_solids_come_in_closed_and_outward(seed: int, tmp_path: Path) -> None:
    """Volume and area against the closed forms, each solid alone and all together."""
    rng = np.random.default_rng(seed)
    together = file_of()
    volumes = 0.0
    for number, (name, shape, volume, area) in enumerate(solids(rng)):
        file = file_of()
        add(file, shape, Name=name)
        text, _ = program(written(file, tmp_path / f"{name}.3dm"))
        assert measured(text) == pytest.approx((area, volume), rel=1e-6), name
        mesh = moldloft.loads(text).mesh()
        assert not mesh.closure()["edges"]
        assert mesh.volume == pytest.approx(volume, rel=5e-3), name
        shape.Translate(R.Vector3d(20.0 * number, 0, 0))
        add(together, shape, Name=name)
        volumes += volume
    text, _ = program(written(together, tmp_path / "all.3dm"))
    assert measured(text)[1] == pytest.approx(volumes, rel=1e-6)
    tags = {tag for face in shown(text) for tag in face.tags}
    assert {"ball", "can", "box", "rod", "pipe"} <= tags


@dataclass
class Face:
    """A visible surface of a program."""

    name: str
    tags: set[str]


def shown(text: str) -> list[Face]:
    found = []
    for statement in re.findall(r"^(?:NURBSurf|TrimSurf) [^;]*;", text, re.MULTILINE):
        if "visible" in statement:
            continue
        tags = re.search(r"tags = (\{[^}]*\}|\"[^\"]*\")", statement)
        words = set(re.findall(r"\"([^\"]*)\"", tags[1])) if tags else set()
        found.append(Face(statement.split()[1].partition("(")[0], words))
    return found


def measured(text: str) -> tuple[float, float]:
    """Area of the visible surfaces, and the volume in them below z = 0."""
    model = moldloft.loads(text)
    area = sum(model[face.name].area for face in shown(text))
    return area, model.hydrostatics().volume


def test_blocks_are_placed_layers_are_tags(tmp_path: Path) -> None:
    """A block in a block: places by the product of their motions."""
    text = written_blocks(tmp_path / "blocks.3dm")
    model = moldloft.loads(text)
    middles = np.array([model[face.name].centroid for face in shown(text)])
    # Four boxes of side 1 about their centres, six faces each.
    assert middles.shape == (24, 3)
    expected = [(10, 0, 0), (10, 0, 5), (0, 20, 0), (0, 20, 5)]
    for middle in expected:
        near = np.linalg.norm(middles - middle, axis=1) < 0.51
        assert near.sum() == 6, middle
    assert all("one" in face.tags for face in shown(text))


def written_blocks(path: Path) -> str:
    file = file_of()
    layer = R.Layer()
    layer.Name = "Hull"
    file.Layers.Add(layer)
    file.Write(str(path), 8)
    box = R.Brep.CreateFromBox(R.Box(R.BoundingBox(point([-0.5] * 3), point([0.5] * 3))))
    unit, turned = R.Transform.Translation(0, 0, 0), R.Transform.Translation(0, 0, 5)
    attributes = R.ObjectAttributes()
    number = file.InstanceDefinitions.Add(
        "one", "", "", "", point([0, 0, 0]), (box,), (attributes,)
    )
    one = file.InstanceDefinitions[number].Id
    parts = [R.InstanceReference(one, move) for move in (unit, turned)]
    number = file.InstanceDefinitions.Add(
        "pair", "", "", "", point([0, 0, 0]), tuple(parts), (attributes, attributes)
    )
    pair = file.InstanceDefinitions[number].Id
    for move in ((10, 0, 0), (0, 20, 0)):
        file.Objects.AddInstanceObject(
            R.InstanceReference(pair, R.Transform.Translation(*move)), attributes
        )
    return program(written(file, path))[0]


@pytest.mark.parametrize("seed", range(4))
def test_any_map_of_a_block_is_that_of_its_volume(seed: int, tmp_path: Path) -> None:
    """A ring and a can in blocks, sheared, scaled and mirrored: volume times the determinant."""
    rng = np.random.default_rng(seed)
    big, small = rng.uniform(3, 6), rng.uniform(0.5, 2)
    circle = R.NurbsCurve.CreateFromCircle(R.Circle(point([0, 0, 0]), small))
    circle.Rotate(math.pi / 2, R.Vector3d(1, 0, 0), point([0, 0, 0]))
    circle.Translate(R.Vector3d(big, 0, 0))
    axis = R.Line(point([0, 0, 0]), point([0, 0, 1]))
    ring = R.Brep.CreateFromRevSurface(
        R.RevSurface.Create(circle, axis, 0, 2 * math.pi), False, False
    )
    can = R.Brep.CreateFromCylinder(R.Cylinder(R.Circle(point([0, 0, 9]), small), 2.0), True, True)
    exact = 2 * math.pi**2 * big * small**2 + 2 * math.pi * small**2
    file = file_of()
    attributes = R.ObjectAttributes()
    number = file.InstanceDefinitions.Add(
        "pair", "", "", "", point([0, 0, 0]), (ring, can), (attributes, attributes)
    )
    linear = np.eye(3) + rng.uniform(-0.4, 0.4, (3, 3))
    linear[0] *= (-1) ** seed
    move = R.Transform(1.0)
    for i, j in np.ndindex(3, 3):
        setattr(move, f"M{i}{j}", float(linear[i, j]))
    move.M23 = -40.0
    pair = file.InstanceDefinitions[number].Id
    file.Objects.AddInstanceObject(R.InstanceReference(pair, move), attributes)
    text, remarks = program(written(file, tmp_path / "moved.3dm"))
    if remarks:
        # OCCT misplaces one seam of some rings; then there is no figure.
        assert seed == 1 and "are not joined" in remarks[0]
        with pytest.raises(moldloft.ModelError, match="open"):
            moldloft.loads(text).hydrostatics()
        return
    expected = exact * abs(np.linalg.det(linear))
    assert measured(text)[1] == pytest.approx(expected, rel=1e-6)
    assert moldloft.loads(text).mesh().volume == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize(
    ("unit", "metres"),
    [
        ("Millimeters", 1e-3),
        ("Centimeters", 1e-2),
        ("Meters", 1.0),
        ("Kilometers", 1e3),
        ("Inches", 0.0254),
        ("Feet", 0.3048),
        ("Yards", 0.9144),
        ("Mils", 2.54e-5),
        ("Microns", 1e-6),
    ],
)
def test_units_are_those_of_the_file(unit: str, metres: float, tmp_path: Path) -> None:
    file = file_of(unit)
    size = 1 / metres
    add(
        file,
        R.Brep.CreateFromBox(
            R.Box(R.BoundingBox(point([0, 0, -size]), point([size, 2 * size, 0])))
        ),
    )
    text, remarks = program(written(file, tmp_path / "box.3dm"))
    assert measured(text)[1] == pytest.approx(2, rel=1e-9)
    assert not remarks


def test_names_colours_curves_and_what_is_left_out(tmp_path: Path) -> None:
    file = file_of("None")
    box = R.Brep.CreateFromBox(R.Box(R.BoundingBox(point([0, 0, 0]), point([1, 1, 1]))))
    add(
        file,
        box,
        Name="Größe 1",
        ObjectColor=(255, 0, 0, 255),
        ColorSource=R.ObjectColorSource.ColorFromObject,
    )
    add(file, R.NurbsCurve.CreateFromCircle(R.Circle(point([0, 0, 0]), 2.0)), Name="rim")
    hidden = R.ObjectAttributes()
    hidden.Visible = False
    file.Objects.AddBrep(box, hidden)
    file.Objects.AddPoint(point([0, 0, 0]))
    file.Objects.AddTextDot("note", point([0, 0, 0]), R.ObjectAttributes())
    text, remarks = program(written(file, tmp_path / "mixed.3dm"), units="mm")
    model = moldloft.loads(text)
    # Red is the fourth colour of a model.
    assert len(re.findall(r"colour = 4\b", text)) == 6
    assert model["rim"].length == pytest.approx(4 * math.pi, rel=1e-9)
    assert sum("Gr" in face.name for face in shown(text)) == 6
    said = " ".join(remarks)
    for words in ("no unit of length", "hidden", "point", "annotation"):
        assert words in said, remarks


def test_own_surfaces_come_back(tmp_path: Path) -> None:
    model = moldloft.loads(
        """AbsPoint A(0,0,0); AbsPoint B(4,0,1); BCurve a({A, {2, 1, 0.5}, B});
        BCurve b({{0, 3, 0}, {2, 2.5, 1}, {4, 3, 0}}); RuledSurf wing(a, b);
        AbsPoint S(0, 0, 5); AbsPoint N(0, 0, 7); AbsPoint E(1, 0, 6); Line axis(S, N);
        Arc half(S, N, E, type = 5); RevSurf ball(half, axis);"""
    )
    (path,) = model.write(tmp_path / "own.3dm")
    text, _ = program(path, units="m")
    area = model["wing"].area + model["ball"].area
    assert measured(text)[0] == pytest.approx(area, rel=1e-6)
    assert {"wing", "ball"} <= {face.name for face in shown(text)}


@pytest.mark.parametrize("length", [0, 10, 40, 1000, 5000])
def test_damaged_files_are_refused(length: int, tmp_path: Path) -> None:
    file = file_of()
    add(file, R.Brep.CreateFromSphere(R.Sphere(point([0, 0, 0]), 1.0)))
    whole = written(file, tmp_path / "whole.3dm").read_bytes()
    path = tmp_path / "cut.3dm"
    path.write_bytes(whole[:length])
    with pytest.raises(moldloft.FileError, match=r"cut\.3dm"):
        program(path)


def test_files_without_shapes_are_refused(tmp_path: Path) -> None:
    file = file_of()
    file.Objects.AddPoint(point([0, 0, 0]))
    path = written(file, tmp_path / "points.3dm")
    with pytest.raises(moldloft.FileError, match="no visible surface and no visible curve"):
        program(path)


def test_meshes_are_read(tmp_path: Path) -> None:
    """A box of triangles and quadrilaterals, in inches."""
    file = file_of("Inches")
    mesh = R.Mesh()
    for x, y, z in np.ndindex(2, 2, 2):
        mesh.Vertices.Add(3.0 * x, 2.0 * y, -1.0 * z)
    for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (1, 5, 7, 3)):
        mesh.Faces.AddFace(a, d, c, b)
    mesh.Faces.AddFace(0, 2, 6)
    mesh.Faces.AddFace(0, 6, 4)
    file.Objects.AddMesh(mesh, R.ObjectAttributes())
    path = written(file, tmp_path / "box.3dm")
    with pytest.raises(moldloft.FileError, match="read_mesh"):
        program(path)
    model = moldloft.read_mesh(path)
    found = model.mesh()
    assert found.closed
    assert abs(found.volume) == pytest.approx(6 * 0.0254**3, rel=1e-6)
    assert len(moldloft.read_mesh(path, units="in").mesh().faces) == 7
