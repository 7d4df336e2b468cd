# ruff: noqa: E501 -- programs of one line
"""Facets of bodies face outwards in every format that has facets, whichever way the surfaces of the program run.

The reader is trimesh or meshio, the judge the divergence theorem: the volume within the facets must be that of the
body, with its sign.
"""

from __future__ import annotations

import itertools
import random
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import trimesh

import moldloft
from moldloft import formats

# Bodies as arrays: their surfaces, how many there are, and the volume within the facets of fine grids.
BALL = "surface s[49,33]; for (i = 1:49) for (j = 1:33) { float a = 2*PI*(i - 1)/48, b = PI*(j - 1)/32; s[i,j] = {2*sin(b)*cos(a) + 5, 3*sin(b)*sin(a) - 4, cos(b) + 1}; } s[49,] = s[1,];"
TORUS = "surface s[65,33]; for (i = 1:65) for (j = 1:33) { float a = 2*PI*(i - 1)/64, b = 2*PI*(j - 1)/32; s[i,j] = {(3 + cos(b))*cos(a), (3 + cos(b))*sin(a), sin(b)}; } s[65,] = s[1,]; s[,33] = s[,1];"
SPINDLE = "surface s[25,33]; for (i = 1:25) for (j = 1:33) { float x = (i - 1)/24, a = 2*PI*(j - 1)/32; s[i,j] = {4*x, x*(1 - x)*cos(a), x*(1 - x)*sin(a)}; } s[,33] = s[,1];"
BOX = (
    "surface s[3,4], t[3,4], u[3,5], v[3,5], w[4,5], x[4,5];"
    "for (i = 1:3) for (j = 1:4) { s[i,j] = {i - 1, j - 1, 0}; t[i,j] = {i - 1, j - 1, 4}; }"
    "for (i = 1:3) for (j = 1:5) { u[i,j] = {i - 1, 0, j - 1}; v[i,j] = {i - 1, 3, j - 1}; }"
    "for (i = 1:4) for (j = 1:5) { w[i,j] = {0, i - 1, j - 1}; x[i,j] = {2, i - 1, j - 1}; }"
)
BODIES = [
    (BALL, "s", 4 / 3 * np.pi * 6, 0.01),
    (TORUS, "s", 2 * np.pi**2 * 3, 0.01),
    (SPINDLE, "s", 4 * np.pi / 30, 0.01),
    (BOX, "stuvwx", 24, 1e-6),
]
TURNS = ["", " = {0}[::-1,]", " = {0}[,::-1]", " = {0}[::-1,::-1]"]


@pytest.mark.parametrize(
    ("program", "names", "volume", "share"), BODIES, ids=["ball", "torus", "spindle", "box"]
)
def test_arrays_as_stl_face_outwards(
    program: str, names: str, volume: float, share: float, tmp_path: Path
) -> None:
    rng = random.Random(names)
    choices = list(itertools.product(range(4), repeat=len(names)))
    for turns in choices if len(choices) < 9 else rng.sample(choices, 12):
        text = program
        for name, turn in zip(names, turns, strict=True):
            text += f"{name}{TURNS[turn].format(name)}; " if turn else ""
        m = moldloft.loads(text + f'write_stl("a.stl", {", ".join(names)});')
        file = tmp_path / "a.stl"
        file.write_bytes(m.written["a.stl"])
        mesh = trimesh.load_mesh(file)
        assert mesh.is_watertight and mesh.is_winding_consistent, turns
        assert mesh.volume == pytest.approx(volume, rel=share), turns


# Bodies as relational surfaces, closed, with the sides of their surfaces left to chance.
SOLIDS = {
    "drum": (
        "AbsPoint A(1, 0, 0); AbsPoint B(1, 0, 2); AbsPoint O(0, 0, 0); AbsPoint P(0, 0, 2); AbsPoint Z(0, 0, 3); Line axis(O, Z);"
        "Line mantle({0}); Line lower({1}); Line upper({2});"
        "RevSurf side(mantle, axis, 0, 2*PI, divisions = {{4, 48}}); RevSurf low(lower, axis, 0, 2*PI, divisions = {{3, 48}}); RevSurf high(upper, axis, 0, 2*PI, divisions = {{3, 48}});",
        (("A, B", "B, A"), ("O, A", "A, O"), ("P, B", "B, P")),
        2 * np.pi,
        0.01,
    ),
    "box": (
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(2, 3, 0); AbsPoint D(0, 3, 0); AbsPoint E(0, 0, 1); AbsPoint F(2, 0, 1); AbsPoint G(2, 3, 1); AbsPoint H(0, 3, 1);"
        "Line ab(A, B); Line dc(D, C); Line ef(E, F); Line hg(H, G); Line ae(A, E); Line dh(D, H); Line bf(B, F); Line cg(C, G);"
        "RuledSurf bottom({0}, divisions = {{2, 3}}); RuledSurf top({1}, divisions = {{2, 3}}); RuledSurf front(ab, ef, divisions = {{2, 2}}); RuledSurf back(dc, hg, divisions = {{2, 2}}); RuledSurf left({2}, divisions = {{2, 3}}); RuledSurf right(bf, cg, divisions = {{2, 3}});",
        (("ab, dc", "dc, ab"), ("ef, hg", "hg, ef"), ("ae, dh", "dh, ae")),
        6,
        1e-6,
    ),
}
# Formats of facets, and how they are read.
FACETS = ["stl", "stl-text", "3mf", "obj", "off", "ply", "msh", "su2", "glb", "vtp"]


def of_3mf(path: Path) -> list[tuple[np.ndarray, np.ndarray]]:
    """Vertices and triangles of each mesh in the archive."""
    space = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    with zipfile.ZipFile(path) as archive:
        tree = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    parts = []
    for mesh in tree.iter(f"{space}mesh"):
        points = [[float(v.attrib[c]) for c in "xyz"] for v in mesh.iter(f"{space}vertex")]
        faces = [
            [int(t.attrib[k]) for k in ("v1", "v2", "v3")] for t in mesh.iter(f"{space}triangle")
        ]
        parts.append((np.array(points), np.array(faces)))
    return parts


def of_su2(path: Path) -> list[tuple[np.ndarray, np.ndarray]]:
    """Points and the elements themselves, not those of the markers once more."""
    lines = iter(path.read_text().splitlines())
    faces, points = [], []
    for line in lines:
        if line.startswith("NELEM"):
            for _ in range(int(line.split("=")[1])):
                kind, *nodes = map(int, next(lines).split())
                faces.append(nodes[:3] if kind == 5 else nodes[:4])
        elif line.startswith("NPOIN"):
            for _ in range(int(line.split("=")[1].split()[0])):
                points.append([float(x) for x in next(lines).split()[:3]])
    return [(np.array(points), np.array([face])) for face in faces]


def signed_volume(path: Path, name: str) -> float:
    if name == "3mf":
        parts = of_3mf(path)
    elif name == "su2":
        parts = of_su2(path)
    elif name == "msh":
        cells = meshio.read(path)
        parts = [
            (cells.points, block.data)
            for block in cells.cells
            if block.type in ("triangle", "quad")
        ]
    elif name == "vtp":
        pyvista = pytest.importorskip("pyvista")
        mesh = pyvista.read(path).triangulate()
        parts = [(mesh.points, mesh.faces.reshape(-1, 4)[:, 1:])]
    else:
        scene = trimesh.load(path, process=False)
        mesh = scene.to_geometry() if isinstance(scene, trimesh.Scene) else scene
        parts = [(mesh.vertices, mesh.faces)]
    total = 0.0
    for points, faces in parts:
        p = np.asarray(points, float)[np.asarray(faces)]
        for k in range(1, p.shape[1] - 1):
            total += np.einsum("ij,ij->", p[:, 0], np.cross(p[:, k], p[:, k + 1])) / 6
    return total


@pytest.mark.parametrize("format", FACETS)
@pytest.mark.parametrize("body", SOLIDS)
def test_surfaces_face_outwards_in_every_format(body: str, format: str, tmp_path: Path) -> None:
    program, ways, volume, share = SOLIDS[body]
    for chosen in itertools.product(*ways):
        model = moldloft.loads(program.format(*chosen))
        (path,) = model.write(tmp_path / f"body.{format.removesuffix('-text')}", format=format)
        assert signed_volume(path, format) == pytest.approx(volume, rel=share), (chosen, format)


def test_the_list_has_all_formats_of_facets() -> None:
    rest = {
        "gdf",
        "gdf-high",
        "nemoh",
        "hydrostar",
        "hams",
        "aqwa",
    }  # of panel codes: into the water's side by their rules
    rest |= {
        "vts",
        "p3d",
        "volume-p3d",
        "volume-vts",
        "volume-vtu",
        "cgns",
        "volume-cgns",
        "blockmesh",
    }  # of indices
    rest |= {"step", "iges", "3dm", "sdl", "ms2", "offsets"}  # of exact surfaces, or of the model
    rest |= {"svg", "png", "dxf", "lines-svg", "lines-pdf", "lines-dxf"}  # pictures
    assert set(FACETS) | rest == set(formats.formats())


PAPER = Path(__file__).parents[3] / "crates/document/tests/it/fixtures/figure1.sdl"


@pytest.mark.parametrize("turn", ["", "body = body[::-1,];", "body = body[,::-1];"])
def test_the_half_body_of_the_paper_faces_outwards(turn: str, tmp_path: Path) -> None:
    # Its symmetry plane and its open base close it.
    m = moldloft.loads(PAPER.read_text() + turn + 'write_stl("a.stl", body);')
    file = tmp_path / "a.stl"
    file.write_bytes(m.written["a.stl"])
    mesh = trimesh.load_mesh(file, process=False)
    # Away from the axis, which is y = z = 0.
    radial = mesh.triangles_center * (0, 1, 1)
    assert (np.einsum("ij,ij->i", radial, mesh.face_normals) > 0).all()


def test_sheets_that_no_plane_closes_keep_their_side(tmp_path: Path) -> None:
    sheet = "surface s[6,7]; for (i = 1:6) for (j = 1:7) s[i,j] = {i, j, 5 - .1*i*i - .1*j*j + .05*i*j};"
    for turn, sign in (("", 1), ("s = s[::-1,];", -1)):
        m = moldloft.loads(sheet + turn + 'write_stl("a.stl", s);')
        file = tmp_path / "a.stl"
        file.write_bytes(m.written["a.stl"])
        assert (sign * trimesh.load_mesh(file, process=False).face_normals[:, 2] > 0).all()
