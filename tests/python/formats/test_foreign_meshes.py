"""Meshes of other programs: GLB, 3MF, PolyData of VTK, panel files; units stated by hand."""

from __future__ import annotations

import base64
import io
import json
import os
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft import overlays
from moldloft.cli import main
from moldloft.overlays.panel_files import read_panels

ROUNDS = 200 if os.environ.get("MOLDLOFT_SOAK") == "1" else 4

BALL = """
    Model info(units = "mm"); AbsPoint O(3, -2, 5); AbsPoint N(3, -2, 7); AbsPoint E(5, -2, 5);
    AbsPoint S(3, -2, 3); Line axis(S, N); Arc half(S, N, E, type = 5);
    RevSurf ball(half, axis, divisions = {8, 12}); Line l({0, 0, 0}, {4, 0, 0});
    Line m({0, 3, 1}, {4, 3, 1}); RuledSurf plate(l, m, divisions = {3, 3});
"""


def triangles(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Corners of triangles ``(n, 3, 3)``; a quadrilateral is two along its first diagonal."""
    corners = points[np.asarray(faces, dtype=np.int64)]
    four = (corners[:, 2] != corners[:, 3]).any(axis=1)
    return np.concatenate([corners[:, :3], corners[four][:, [0, 2, 3]]])


def same_triangles(found: np.ndarray, expected: np.ndarray, near: float) -> None:
    """Equal as sets, each with its sense of rotation."""

    def sums(corners: np.ndarray) -> np.ndarray:
        # Centre and vector area do not depend on where a triangle begins.
        area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return np.concatenate([corners.mean(axis=1), area], axis=1)

    assert len(found) == len(expected)
    a, b = sums(found), sums(expected)
    distances = np.abs(a[:, None] - b[None]).max(axis=2)
    assert distances.min(axis=1).max() < near and distances.min(axis=0).max() < near


@pytest.mark.parametrize("ending", ["glb", "3mf", "vtp"])
def test_meshes_come_back_with_their_unit(ending: str, tmp_path: Path) -> None:
    model = moldloft.loads(BALL)
    path = model.write(tmp_path / f"ball.{ending}")[0]
    mesh = model.mesh()
    unit = "" if ending == "vtp" else "mm"
    found = overlays.read(path, units=unit)
    size = 1e-6 * 10
    area = np.linalg.norm(vector_areas(triangles(found.points, found.faces)), axis=1).sum() / 2
    assert area == pytest.approx(sum(p.area for p in mesh.patches), rel=1e-5)
    assert {name for name, _, _ in found.groups} >= ({"faces"} if unit == "" else set())
    assert np.abs(found.points.max(axis=0) - mesh.vertices.max(axis=0)).max() < size
    assert np.abs(found.points.min(axis=0) - mesh.vertices.min(axis=0)).max() < size
    # As a body: closed where it was, in the unit of the model.
    with pytest.warns(UserWarning, match="unit") if ending == "vtp" else no_warning():
        body = moldloft.read_mesh(path, units=unit)
    four = (mesh.faces[:, 2] != mesh.faces[:, 3]).sum()
    assert len(body.mesh().faces) == len(mesh.faces) + (0 if ending == "vtp" else four)


def vector_areas(corners: np.ndarray) -> np.ndarray:
    found: np.ndarray = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return found


def no_warning() -> Any:
    from contextlib import nullcontext

    return nullcontext()


def scene(seed: int) -> tuple[Any, np.ndarray]:
    """Boxes and balls at random positions, some mirrored, some twice; and their triangles."""
    trimesh = pytest.importorskip("trimesh")
    rng = np.random.default_rng(seed)
    made = trimesh.Scene()
    expected = []
    for k in range(rng.integers(1, 4)):
        mesh = trimesh.creation.icosphere(1) if k % 2 else trimesh.creation.box((1, 2, 3))
        outer = place(rng)
        made.add_geometry(mesh, geom_name=f"g{k}", node_name=f"n{k}", transform=outer)
        below = place(rng)
        made.add_geometry(
            mesh, geom_name=f"h{k}", node_name=f"m{k}", parent_node_name=f"n{k}", transform=below
        )
        for matrix in (outer, outer @ below):
            moved = mesh.copy().apply_transform(matrix)
            expected.append(moved.vertices[moved.faces])
    return made, np.concatenate(expected)


def place(rng: np.random.Generator) -> np.ndarray:
    """A random rotation, scale, sometimes a reflection, and translation."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    found = np.eye(4)
    found[:3, :3] = turn * rng.uniform(0.5, 2)
    found[:3, 3] = rng.uniform(-5, 5, 3)
    return found


@pytest.mark.parametrize("seed", range(ROUNDS))
def test_scenes_of_glb_files_are_where_trimesh_puts_them(seed: int, tmp_path: Path) -> None:
    made, expected = scene(seed)
    path = tmp_path / "scene.glb"
    path.write_bytes(made.export(file_type="glb"))
    found = overlays.read(path)
    # y up there, z up here.
    up = np.stack([expected[..., 0], -expected[..., 2], expected[..., 1]], axis=-1)
    same_triangles(triangles(found.points, found.faces), up, 1e-4)
    assert overlays.read(path, units="mm").points == pytest.approx(1000 * found.points)


@pytest.mark.parametrize("seed", range(ROUNDS))
def test_scenes_of_3mf_files_are_where_trimesh_puts_them(seed: int, tmp_path: Path) -> None:
    pytest.importorskip("lxml")
    pytest.importorskip("networkx")
    made, _ = scene(seed)
    path = tmp_path / "scene.3mf"
    path.write_bytes(made.export(file_type="3mf"))
    found = overlays.read(path)
    # As it reads the file: it leaves out a mesh of a node that has others below.
    theirs = pytest.importorskip("trimesh").load_scene(path).to_mesh()
    expected = np.asarray(theirs.vertices)[np.asarray(theirs.faces)]
    same_triangles(triangles(found.points, found.faces), expected, 1e-9)


def glb(text: dict[str, Any], binary: bytes = b"") -> bytes:
    """A GLB file of a text and a binary chunk."""
    body = json.dumps(text).encode()
    body += b" " * (-len(body) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<2I", len(body), 0x4E4F534A) + body
    chunks += struct.pack("<2I", len(binary), 0x004E4942) + binary
    return struct.pack("<4s2I", b"glTF", 2, 12 + len(chunks)) + chunks


def one_mesh(binary: bytes, mode: int = 4, **more: Any) -> dict[str, Any]:
    """A scene of one primitive of five points, its indices 16 bits."""
    count = (len(binary) - 60) // 2
    text = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": count, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 60},
            {"buffer": 0, "byteOffset": 60, "byteLength": 2 * count},
        ],
        "buffers": [{"byteLength": len(binary)}],
    }
    return {**text, **more}


FIVE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 2, 0]], dtype=np.float32)


def five(corners: list[int]) -> bytes:
    return FIVE.tobytes() + np.array(corners, dtype=np.uint16).tobytes()


@pytest.mark.parametrize(
    ("mode", "corners", "faces"),
    [
        (4, [0, 1, 2, 0, 2, 3], [[0, 1, 2], [0, 2, 3]]),
        (5, [0, 1, 3, 2, 4], [[0, 1, 3], [3, 1, 2], [3, 2, 4]]),
        (6, [0, 1, 2, 3], [[0, 1, 2], [0, 2, 3]]),
    ],
)
def test_strips_and_fans_of_glb_files(
    mode: int, corners: list[int], faces: list[list[int]], tmp_path: Path
) -> None:
    binary = five(corners)
    path = tmp_path / "a.glb"
    path.write_bytes(glb(one_mesh(binary, mode), binary))
    found = overlays.read(path)
    up = np.stack([FIVE[:, 0], -FIVE[:, 2], FIVE[:, 1]], axis=-1).astype(np.float64)
    same_triangles(triangles(found.points, found.faces), up[np.array(faces)], 1e-12)


def sized(count: int) -> dict[str, Any]:
    text = one_mesh(five([0, 1, 2]))
    text["accessors"][1]["count"] = count
    return text


WRONG_GLB = {
    "text": (b"solid a\n" * 9, "must begin with glTF"),
    "version 1": (struct.pack("<4s2I", b"glTF", 1, 20) + bytes(8), "version 2"),
    "cut short": (glb(one_mesh(five([0, 1, 2])), five([0, 1, 2]))[:-20], "cut short"),
    "compressed": (
        glb(one_mesh(five([0, 1, 2]), extensionsRequired=["KHR_draco_mesh_compression"])),
        "`KHR_draco_mesh_compression`, which is not supported",
    ),
    "in itself": (
        glb(one_mesh(five([0, 1, 2]), nodes=[{"children": [0]}])),
        "two parents, or is inside itself",
    ),
    "no view": (glb(one_mesh(five([0, 1, 2]), bufferViews=[]), b""), "one of the 0 bufferViews"),
    "far vertex": (glb(one_mesh(five([0, 1, 9])), five([0, 1, 9])), "beyond the 5 vertices"),
    "half a triangle": (glb(one_mesh(five([0, 1])), five([0, 1])), "three corners a triangle"),
    "count": (glb(sized(10**12), five([0, 1, 2])), "accessor 1 has 1000000000000 elements"),
    "beyond": (glb(sized(3000), five([0, 1, 2])), "extends beyond the numbers"),
    "negative": (glb(sized(-3), five([0, 1, 2])), "whole number of at least 0, found -3"),
    "other file": (
        glb(one_mesh(five([0, 1, 2]), buffers=[{"uri": "a.bin", "byteLength": 66}])),
        "in another file",
    ),
    "not JSON": (
        struct.pack("<4s2I", b"glTF", 2, 24) + struct.pack("<2I", 4, 0x4E4F534A) + b"{{{{",
        "JSON cannot be read",
    ),
    "deep JSON": (
        struct.pack("<4s2I", b"glTF", 2, 20 + 200_000)
        + struct.pack("<2I", 200_000, 0x4E4F534A)
        + b"[" * 200_000,
        "JSON cannot be read",
    ),
    "endless": (
        glb(one_mesh(np.full((5, 3), np.inf, np.float32).tobytes() + five([0, 1, 2])[60:]),
            np.full((5, 3), np.inf, np.float32).tobytes() + five([0, 1, 2])[60:]),
        "not a finite number",
    ),
    "copies": (
        glb(
            one_mesh(
                five([0, 1, 2]),
                nodes=[{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {}}}],
            )
        ),
        "EXT_mesh_gpu_instancing are unsupported",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG_GLB)
def test_wrong_glb_files_are_refused(name: str, tmp_path: Path) -> None:
    data, why = WRONG_GLB[name]
    path = tmp_path / "a.glb"
    path.write_bytes(data)
    with pytest.raises(moldloft.FileError, match=rf"a\.glb`: .*{why}"):
        overlays.read(path)


def test_scenes_with_many_copies_are_counted(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr("moldloft.overlays.gltf.MOST_FACES", 50)
    nodes = [{"mesh": 0} for _ in range(60)]
    binary = five([0, 1, 2])
    path = tmp_path / "a.glb"
    path.write_bytes(
        glb(one_mesh(binary, nodes=nodes, scenes=[{"nodes": list(range(60))}]), binary)
    )
    with pytest.raises(moldloft.FileError, match="more than 50 faces"):
        overlays.read(path)


TETRA = """<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles>
<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
<triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh>"""

NAMESPACES = (
    'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'
    ' xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"'
)


def package(resources: str, build: str, words: str = "", **files: bytes) -> bytes:
    """A 3MF file of one model, and further files by path."""
    text = f"<model {NAMESPACES} {words}><resources>{resources}</resources>"
    text += f"<build>{build}</build></model>"
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", text)
        for name, data in files.items():
            archive.writestr(f"3D/{name}.model", data)
    return out.getvalue()


def test_components_of_3mf_files_and_their_units(tmp_path: Path) -> None:
    # Twice as large, moved by (5, 0, 0), then all of it by (0, 7, 0).
    inner = '<component objectid="1" transform="2 0 0 0 2 0 0 0 2 5 0 0"/>'
    mirrored = '<component objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
    outside = '<component p:path="/3D/other.model" objectid="9"/>'
    other = f'<model {NAMESPACES}><resources><object id="9">{TETRA}</object></resources></model>'
    resources = f'<object id="1" name="block">{TETRA}</object>'
    resources += f'<object id="2"><components>{inner}{mirrored}{outside}</components></object>'
    resources += f'<object id="3" type="support">{TETRA}</object>'
    build = '<item objectid="2" transform="1 0 0 0 1 0 0 0 1 0 7 0"/><item objectid="3"/>'
    path = tmp_path / "a.3mf"
    path.write_bytes(package(resources, build, 'unit="inch"', other=other.encode()))
    found = overlays.read(path)
    assert found.remarks == ("1 objects that support others are omitted",)
    assert found.points.min(axis=0).tolist() == [-1, 7, 0]
    assert found.points.max(axis=0).tolist() == [7, 9, 2]
    corners = triangles(found.points, found.faces) - np.array([0, 7, 0])
    volume = np.einsum("ij,ij->i", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]).sum() / 6
    # All three face outwards, the mirrored one too.
    assert volume == pytest.approx((8 + 1 + 1) / 6)
    assert overlays.read(path, units="mm").points == pytest.approx(25.4 * found.points)
    with pytest.warns(UserWarning, match="support others"):
        body = moldloft.read_mesh(path, units="in")
    assert body.mesh().volume == pytest.approx(10 / 6)


def stored(text: str) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr("3D/3dmodel.model", text)
    return out.getvalue()


ITEM = '<item objectid="1"/>'
WRONG_3MF = {
    "text": (b"solid a\n" * 9, "not a 3MF file"),
    "cut short": (package(f'<object id="1">{TETRA}</object>', ITEM)[:-30], "cut short"),
    "another archive": (zipped := stored("").replace(b"3dmodel", b"3dnodel"), "contains no `3D"),
    "no object": (package("", ITEM), "expected an object 1, found none"),
    "in itself": (
        package('<object id="1"><components><component objectid="1"/></components></object>', ITEM),
        "component of itself",
    ),
    "a unit": (package("", "", 'unit="parsec"'), "found `parsec`"),
    "a word": (
        package(f'<object id="1">{TETRA.replace("x=", "w=", 1)}</object>', ITEM),
        "line 1: the attribute 'x' is missing",
    ),
    "no number": (
        package(f'<object id="1">{TETRA.replace("v1=" + chr(34) + "0", "v1=" + chr(34) + "a", 1)}'
                "</object>", ITEM),
        "expected a number",
    ),
    "far vertex": (
        package(f'<object id="1">{TETRA.replace("v2=" + chr(34) + "2", "v2=" + chr(34) + "7", 1)}'
                "</object>", ITEM),
        "beyond the 4 vertices",
    ),
    "no XML": (stored("<model><a></model>"), "not well-formed"),
    "entities": (
        stored('<!DOCTYPE m [<!ENTITY a "b">]><model>&a;</model>'), "it declares entities",
    ),
    "an extension": (
        package("", "", 'xmlns:b="http://a.b/beams" requiredextensions="b"'),
        "needs the extension `http://a.b/beams`",
    ),
    "empty": (package("", ""), "no points, faces or curves"),
    "endless": (
        package(f'<object id="1">{TETRA.replace("x=" + chr(34) + "1", "x=" + chr(34) + "1e999")}'
                "</object>", ITEM),
        "a coordinate exceeds 1e",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG_3MF)
def test_wrong_3mf_files_are_refused(name: str, tmp_path: Path) -> None:
    data, why = WRONG_3MF[name]
    path = tmp_path / "a.3mf"
    path.write_bytes(data)
    with pytest.raises(moldloft.FileError, match=rf"a\.3mf`: .*{why}") as error:
        overlays.read(path)
    assert ("cut short" in str(error.value)) == (name in ("text", "cut short"))


def test_bombs_of_3mf_files_are_refused_before_they_unfold(tmp_path: Path) -> None:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", b" " * (100 << 20))
    path = tmp_path / "a.3mf"
    path.write_bytes(out.getvalue())
    doubling = "".join(
        f'<object id="{k}"><components>{f"<component objectid={chr(34)}{k - 1}{chr(34)}/>" * 10}'
        "</components></object>"
        for k in range(1, 12)
    )
    copies = tmp_path / "b.3mf"
    copies.write_bytes(
        package(f'<object id="0">{TETRA}</object>{doubling}', '<item objectid="11"/>')
    )
    before = moldloft.limits()
    moldloft.limits(memory="300M")
    try:
        with pytest.raises(moldloft.FileError, match="unfolds to 105 MB"):
            overlays.read(path)
        with pytest.raises(moldloft.FileError, match="holds 400000000000 faces"):
            overlays.read(copies)
    finally:
        moldloft.limits(**before._asdict())


POLYGONS = [[0, 1, 2, 3], [3, 2, 4], [0, 1, 2, 4, 3]]
PLACES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 2, 0.25]])


def legacy(binary: bool, version: str, kind: str = "float") -> bytes:
    """PolyData of three polygons, a strip, a line and a point."""
    cells = {"POLYGONS": POLYGONS, "LINES": [[0, 1]], "VERTICES": [[2]],
             "TRIANGLE_STRIPS": [[0, 1, 3, 2]]}  # fmt: skip
    code = {"float": ">f4", "double": ">f8"}[kind]

    def numbers(values: Any, dtype: str) -> bytes:
        if binary:
            return np.asarray(values, dtype=dtype).tobytes() + b"\n"
        return " ".join(map(str, np.asarray(values).ravel().tolist())).encode() + b"\n"

    out = f"# vtk DataFile Version {version}\ntitle\n{'BINARY' if binary else 'ASCII'}\n".encode()
    out += b"DATASET POLYDATA\n"
    out += f"POINTS {len(PLACES)} {kind}\n".encode() + numbers(PLACES, code)
    out += b"METADATA\nINFORMATION 0\n\n" if version > "4" else b""
    for word, rows in cells.items():
        flat = [k for row in rows for k in row]
        if version >= "5":
            ends = np.cumsum([0, *map(len, rows)])
            out += f"{word} {len(ends)} {len(flat)}\nOFFSETS vtktypeint64\n".encode()
            out += numbers(ends, ">i8") + b"CONNECTIVITY vtktypeint64\n" + numbers(flat, ">i8")
        else:
            listed = [k for row in rows for k in (len(row), *row)]
            out += f"{word} {len(rows)} {len(listed)}\n".encode() + numbers(listed, ">i4")
    out += b"CELL_DATA 6\nSCALARS a float 1\nLOOKUP_TABLE default\n"
    return out + numbers(np.arange(6.0), ">f4")


FACES = [[0, 1, 2, 3], [3, 2, 4, 4], [0, 1, 2, 2], [0, 2, 4, 4], [0, 4, 3, 3], [0, 1, 3, 3],
         [3, 1, 2, 2]]  # fmt: skip


@pytest.mark.parametrize("version", ["2.0", "3.0", "4.2", "5.1"])
@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("kind", ["float", "double"])
def test_polydata_of_the_legacy_format(
    version: str, binary: bool, kind: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.vtk"
    path.write_bytes(legacy(binary, version, kind))
    found = overlays.read(path)
    assert found.points.tolist() == PLACES.tolist()
    assert found.faces.tolist() == FACES
    assert found.remarks == ("1 cells of points are omitted", "1 cells of lines are omitted")


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("ending", ["vtk", "vtp"])
def test_polydata_as_pyvista_writes_it(ending: str, binary: bool, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    for made in (pyvista.Sphere(), pyvista.Box(), pyvista.Cylinder(resolution=9)):
        path = tmp_path / f"a.{ending}"
        made.save(str(path), binary=binary)
        found = overlays.read(path)
        theirs = made.triangulate()
        area = np.linalg.norm(vector_areas(triangles(found.points, found.faces)), axis=1).sum() / 2
        assert area == pytest.approx(theirs.area, rel=1e-6)
        assert found.points == pytest.approx(np.asarray(made.points), abs=1e-6)


@pytest.mark.parametrize("mode", ["ascii", "binary", "appended", "raw"])
@pytest.mark.parametrize("packed", ["none", "zlib", "lzma"])
@pytest.mark.parametrize("wide", [False, True])
def test_every_encoding_of_xml(mode: str, packed: str, wide: bool, tmp_path: Path) -> None:
    vtk = pytest.importorskip("vtkmodules.vtkIOXML")
    pyvista = pytest.importorskip("pyvista")
    made = pyvista.Sphere(theta_resolution=40, phi_resolution=40).strip()
    made = made + pyvista.Box()
    writer = vtk.vtkXMLPolyDataWriter()
    path = tmp_path / "a.vtp"
    writer.SetFileName(str(path))
    writer.SetInputData(made)
    {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary}.get(
        mode, writer.SetDataModeToAppended
    )()
    writer.SetEncodeAppendedData(mode == "appended")
    {"none": writer.SetCompressorTypeToNone, "zlib": writer.SetCompressorTypeToZLib,
     "lzma": writer.SetCompressorTypeToLZMA}[packed]()  # fmt: skip
    (writer.SetHeaderTypeToUInt64 if wide else writer.SetHeaderTypeToUInt32)()
    writer.SetBlockSize(4096)
    assert writer.Write()
    found = overlays.read(path)
    theirs = made.triangulate()
    area = np.linalg.norm(vector_areas(triangles(found.points, found.faces)), axis=1).sum() / 2
    assert area == pytest.approx(theirs.area, rel=1e-6)
    assert len(triangles(found.points, found.faces)) == theirs.n_cells


XML = (
    '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"{}><PolyData>'
    '<Piece NumberOfPoints="3" NumberOfPolys="1"><Points>'
    '<DataArray type="Float64" NumberOfComponents="3" format="{}">{}</DataArray></Points><Polys>'
    '<DataArray type="Int64" Name="connectivity" format="ascii">{}</DataArray>'
    '<DataArray type="Int64" Name="offsets" format="ascii">{}</DataArray></Polys></Piece>'
    "</PolyData></VTKFile>"
)
NINE = "0 0 0 1 0 0 0 1 0"
HUGE = base64.b64encode(struct.pack("<3I", 1 << 20, 1 << 30, 0)).decode()
WRONG_VTK = {
    "vtp": {
        "text": (b"solid", "not a file of VTK's XML"),
        "a grid": (b'<VTKFile type="UnstructuredGrid"/>', "expected PolyData of VTK"),
        "points": (XML.format("", "ascii", "0 0", "0 1 2", "3"), "expected 9 numbers, found 2"),
        "far vertex": (XML.format("", "ascii", NINE, "0 1 5", "3"), "beyond the 3 vertices"),
        "offsets": (XML.format("", "ascii", NINE, "0 1 2", "4"), "do not divide"),
        "falling": (XML.format("", "ascii", NINE, "0 1 2", "3 2"), "expected 1 offsets, found 2"),
        "no number": (XML.format("", "ascii", NINE.replace("1", "a"), "0 1 2", "3"), "numbers"),
        "no base64": (XML.format("", "binary", "AA", "0 1 2", "3"), "Points: "),
        "a bomb": (
            XML.format(' compressor="vtkZLibDataCompressor"', "binary", HUGE, "0 1 2", "3"),
            "Points: |more than the memory",
        ),
        "LZ4": (
            XML.format(' compressor="vtkLZ4DataCompressor"', "binary", "", "0 1 2", "3"),
            "vtkLZ4DataCompressor are not supported",
        ),
        "entities": ('<!DOCTYPE a [<!ENTITY b "c">]><VTKFile/>', "it declares entities"),
    },
    "vtk": {
        "cut short": (legacy(True, "3.0")[:120], "expected 60 bytes"),
        "count": (legacy(False, "3.0").replace(b"POINTS 5", b"POINTS 6"), "expected 18 numbers"),
        "no count": (legacy(False, "3.0").replace(b"POINTS 5", b"POINTS x"), "expected a count"),
        "cells": (legacy(False, "3.0").replace(b"POLYGONS 3 ", b"POLYGONS 9 "), "POLYGONS: "),
        "far vertex": (legacy(False, "3.0").replace(b"3 3 2 4", b"3 3 2 9"), "beyond the 5"),
        "a section": (legacy(False, "3.0").replace(b"LINES", b"LIMES"), "found `LIMES`"),
        "a type": (legacy(False, "3.0").replace(b"5 float", b"5 string"), "a type of numbers"),
    },
}  # fmt: skip


@pytest.mark.parametrize(
    ("ending", "name"), [(ending, name) for ending, rows in WRONG_VTK.items() for name in rows]
)
def test_wrong_files_of_polygons_are_refused(ending: str, name: str, tmp_path: Path) -> None:
    data, why = WRONG_VTK[ending][name]
    path = tmp_path / f"a.{ending}"
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    with pytest.raises(moldloft.FileError, match=rf"a\.{ending}`: .*(?:{why})"):
        overlays.read(path)


GDF = "title\n1 9.81\n0 1\n1\n0 0 -1  1 0 -1  1 1 -1  0 1 -1\n"


def test_numbers_after_the_last_panel_are_remarked(tmp_path: Path) -> None:
    path = tmp_path / "a.gdf"
    path.write_text(GDF + "7\n")
    found = overlays.read(path)
    assert len(found.faces) == 2
    assert found.remarks == ("NPAN is 1: 1 numbers after the last panel are omitted",)
    path.write_text(GDF)
    assert overlays.read(path).remarks == ()


HST = "NBBODY 1\n{}\nCOORDINATES\n1 0 1 -1\n2 1 1 -1\n3 1 2 -1\nENDCOORDINATES\n"
HST += "PANEL TYPE 0\n1 2 3 3\nENDPANEL\nENDFILE\n"


@pytest.mark.parametrize(
    ("line", "count"),
    [
        ("SYMMETRY_BODY 1 0", 1),
        ("SYMMETRY_BODY 1 1", 2),
        ("SYMMETRY_BODY 1 2", 4),
        ("SYMMETRY : 2", 4),
        ("SYMMETRY_BODY 1 1\nSYMMETRY_BODY 2 1", 2),
    ],
)
def test_symmetry_of_a_body_of_hydrostar(line: str, count: int) -> None:
    points, faces, _ = read_panels(HST.format(line).encode(), "hst")
    assert len(faces) == count and len(points) == 3 * count


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("SYMMETRY_BODY 1 7", "line 2: expected a symmetry of 0, 1 or 2"),
        ("SYMMETRY_BODY 1", "line 2: .*"),
        ("SYMMETRY_BODY 1 1\nSYMMETRY_BODY 2 2", "line 3: expected one symmetry for all bodies"),
    ],
)
def test_wrong_symmetries_are_refused(line: str, why: str) -> None:
    if line == "SYMMETRY_BODY 1":
        # Without the number of the body it is the symmetry.
        assert len(read_panels(HST.format(line).encode(), "hst")[1]) == 2
        return
    with pytest.raises(moldloft.FileError, match=why):
        read_panels(HST.format(line).encode(), "hst")


CUBE = """OFF
8 6 0
0 0 -500
1000 0 -500
1000 1000 -500
0 1000 -500
0 0 500
1000 0 500
1000 1000 500
0 1000 500
4 0 3 2 1
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
"""


def test_commands_take_the_unit_of_a_mesh(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cube, program = tmp_path / "cube.off", tmp_path / "cube.sdl"
    cube.write_text(CUBE)
    assert main(["hydro", str(cube), "--file-units", "mm", "--units", "m", "--json"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["volume"] == pytest.approx(0.5)
    assert "unit" not in said.err
    words = ["convert", str(cube), "-o", str(program), "--file-units", "mm"]
    assert main(words) == 0
    assert moldloft.load(program).mesh().volume == pytest.approx(1e9)
    assert main([*words, "--units", "ft"]) == 0
    assert moldloft.load(program).mesh().volume == pytest.approx(1 / 0.3048**3)
    capsys.readouterr()
    assert main(["hydro", str(program), "--file-units", "mm"]) == 1
    assert "--file-units is the unit of a mesh file" in capsys.readouterr().err


def test_the_comparison_with_trimesh_sees_differences(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import runpy

    pytest.importorskip("trimesh")
    compare = runpy.run_path(str(Path(__file__).parents[2] / "mesh_twins.py"))["main"]
    model = moldloft.loads(BALL)
    for ending in ("stl", "glb", "obj", "ply", "off"):
        model.write(tmp_path / f"ball.{ending}")
    (tmp_path / "bad.off").write_text("OFF\n3 1 0\n0 0\n")
    assert compare([tmp_path]) == 0
    assert capsys.readouterr().out.count("the same") == 5
    monkeypatch.setitem(compare.__globals__, "ours", lambda path: (1, 1.0, 1.0))
    assert compare([tmp_path]) == 1
    assert "DIFFERS" in capsys.readouterr().out
