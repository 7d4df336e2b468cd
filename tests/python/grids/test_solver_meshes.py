# ruff: noqa: E501 -- programs of one line
"""Meshes for solvers read by others: OpenFOAM's polyMesh by a reader of its own format and by checkMesh, UGRID by
meshio, neutral maps by the points of the Plot3D file beside them.
"""

from __future__ import annotations

import os
import random
import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import grids
from test_grid_blocks import FACES as SIDES
from test_grid_blocks import MAP, cut, same_points

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
FILES = ("points", "faces", "owner", "neighbour", "boundary")


def body(text: str) -> tuple[int, str]:
    """The count of a list of OpenFOAM, and what is between its parentheses."""
    match = re.search(r"^\s*(\d+)\s*\((.*)\)\s*$", text.split("}", 1)[1], re.DOTALL)
    assert match, text[:300]
    return int(match[1]), match[2]


class PolyMesh:
    """A polyMesh by the published format (OpenFOAM user guide, "Mesh description")."""

    def __init__(self, written: dict[str, bytes], folder: str) -> None:
        text = {name: written[f"{folder}/{name}"].decode() for name in FILES}
        for name, kind in zip(
            FILES,
            ("vectorField", "faceList", "labelList", "labelList", "polyBoundaryMesh"),
            strict=True,
        ):
            assert f"class {kind};" in text[name] and f"object {name};" in text[name]
        count, inside = body(text["points"])
        self.points = np.array(
            [[float(x) for x in p.split()] for p in re.findall(r"\(([^)]*)\)", inside)]
        )
        assert self.points.shape == (count, 3)
        count, inside = body(text["faces"])
        self.faces = []
        for number, nodes in re.findall(r"(\d+)\(([^)]*)\)", inside):
            self.faces.append([int(n) for n in nodes.split()])
            assert len(self.faces[-1]) == int(number)
        assert len(self.faces) == count
        self.owner = np.array(body(text["owner"])[1].split(), dtype=int)
        self.neighbour = np.array(body(text["neighbour"])[1].split(), dtype=int)
        assert (len(self.owner), len(self.neighbour)) == (count, body(text["neighbour"])[0])
        self.patches: dict[str, dict[str, str]] = {}
        count, inside = body(text["boundary"])
        for name, entries in re.findall(r"(\S+)\s*\{([^}]*)\}", inside):
            self.patches[name] = dict(
                line.strip().split(" ", 1) for line in entries.split(";") if line.strip()
            )
        assert len(self.patches) == count

    def range_of(self, name: str) -> range:
        first, count = (int(self.patches[name][k]) for k in ("startFace", "nFaces"))
        return range(first, first + count)

    def area(self, face: int) -> np.ndarray:
        p = self.points[self.faces[face]]
        return 0.5 * np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0)

    def check(self) -> np.ndarray:
        """The volumes of the cells, after the rules of the format."""
        cells = max(self.owner) + 1
        inner = len(self.neighbour)
        assert (self.owner[:inner] < self.neighbour).all()
        # Upper triangular order: by owner, then by neighbour.
        order = list(zip(self.owner[:inner], self.neighbour, strict=True))
        assert order == sorted(order)
        covered = [k for name in self.patches for k in self.range_of(name)]
        assert covered == list(range(inner, len(self.faces)))
        assert len({tuple(sorted(face)) for face in self.faces}) == len(self.faces)
        assert all(len(set(face)) == len(face) > 2 for face in self.faces)
        assert set(range(len(self.points))) == {n for face in self.faces for n in face}
        closed, volume = np.zeros((cells, 3)), np.zeros(cells)
        edges: list[Counter[tuple[int, int]]] = [Counter() for _ in range(cells)]
        for k, face in enumerate(self.faces):
            p = self.points[face]
            middle = p.mean(axis=0)
            # The triangles about the middle: the flux of x over 3.
            q = np.roll(p, -1, axis=0)
            flux = (
                np.einsum("ij,ij->i", np.cross(p - middle, q - middle), (p + q + middle) / 3).sum()
                / 6
            )
            for cell, sign in ((self.owner[k], 1), (self.neighbour[k] if k < inner else None, -1)):
                if cell is None:
                    continue
                closed[cell] += sign * self.area(k)
                volume[cell] += sign * flux
                way = face if sign > 0 else face[::-1]
                edges[cell].update(zip(way, [*way[1:], way[0]], strict=True))
        assert np.abs(closed).max() < 1e-12 * max(1.0, np.abs(self.points).max() ** 2)
        # Each cell is closed edge by edge, too.
        for own in edges:
            assert all(own[a, b] == own[b, a] == 1 for a, b in own)
        assert volume.min() > 0
        return volume


def run_openfoam(program: str, path: Path) -> str | None:
    """What a program of OpenFOAM prints for a case; none without OpenFOAM."""
    # Packages of Debian set no variables.
    project = os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam")
    if not shutil.which(program) or not Path(project, "etc", "controlDict").exists():
        return None
    (path / "system").mkdir(exist_ok=True)
    head = "FoamFile {{ version 2.0; format ascii; class dictionary; object {0}; }}\n"
    (path / "system" / "controlDict").write_text(
        head.format("controlDict")
        + "application a; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;\n"
    )
    schemes = "".join(
        f"{kind}Schemes {{}}\n"
        for kind in ("ddt", "grad", "div", "laplacian", "interpolation", "snGrad")
    )
    (path / "system" / "fvSchemes").write_text(head.format("fvSchemes") + schemes)
    (path / "system" / "fvSolution").write_text(head.format("fvSolution"))
    done = subprocess.run(
        [program, "-case", str(path)],
        env=os.environ | {"WM_PROJECT_DIR": project},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    return done.stdout + done.stderr


def checked_by_openfoam(written: dict[str, bytes], path: Path) -> str | None:
    """What checkMesh prints; none without OpenFOAM."""
    for name, content in written.items():
        if "polyMesh/" in name:
            target = path / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
    report = run_openfoam("checkMesh", path)
    # It warns of vectors of separation other than those of the faces.
    assert report is None or "differs" not in report, report
    return report


@pytest.mark.parametrize("seed", range(100 if SOAK else 5))
def test_a_cut_block_is_one_polymesh(seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    text, cells, points, faces, _ = cut(rng)
    arguments = re.search(r'write_su2\("m.su2", (.*?)\); write_gmsh', text)
    assert arguments
    given = arguments[1]
    text += f'write_polymesh("constant/polyMesh", {given}); string found = interfaces({given});\n'
    model = moldloft.loads(text)
    mesh = PolyMesh(model.written, "constant/polyMesh")
    volume = mesh.check()
    assert len(volume) == cells
    same_points(mesh.points, points)
    assert {name: int(patch["nFaces"]) for name, patch in mesh.patches.items()} == faces
    report = checked_by_openfoam(model.written, tmp_path)
    if report is not None:
        assert "Mesh OK." in report or "non-orthogonal" in report, report
        assert "***" not in report, report
    # The connections are those of the mesh: one for two parts, none for one.
    parts = len(re.findall(r"block b\d", text))
    assert model["found"].count(" = ") == parts - 1


SECTOR = """block b[4,5,{layers}]; for (k = 1:{layers}) {{ float a = {angle}*(k - 1)/({layers} - 1); for (i = 1:4) for (j = 1:5) {{ float r = {inner} + (i - 1)/3; b[i,j,k] = {{r*cos(a + {start}), r*sin(a + {start}), (j - 1)/4}}; }} }}
"""


@pytest.mark.parametrize("inner", [0.0, 0.5])
@pytest.mark.parametrize("kind", ["periodic", "wedge"])
def test_sectors(inner: float, kind: str, tmp_path: Path) -> None:
    """Rotational cyclic faces, and wedges symmetric about y = 0, of closed form; poles are prisms."""
    angle, layers = (0.6, 4) if kind == "periodic" else (0.1, 2)
    start = 0.0 if kind == "periodic" else -0.05
    text = SECTOR.format(inner=inner, angle=angle, layers=layers, start=start)
    axis = "" if inner == 0 else "i1 = hub wall, "
    text += f'write_polymesh("constant/polyMesh", b, "{axis}in = shroud wall, j1 = inlet inflow, jn = outlet outflow, k1 = low {kind}, kn = high {kind}");'
    model = moldloft.loads(text)
    mesh = PolyMesh(model.written, "constant/polyMesh")
    volume = mesh.check()
    sectors = layers - 1
    flat = 0.5 * np.sin(angle / sectors) * sectors * ((inner + 1) ** 2 - inner**2)
    assert volume.sum() == pytest.approx(flat, rel=1e-12)
    low, high = (mesh.range_of(name) for name in ("low", "high"))
    if kind == "periodic":
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        for a, b in zip(low, high, strict=True):
            p, q = mesh.points[mesh.faces[a]] @ turn.T, mesh.points[mesh.faces[b]]
            # The first nodes correspond, the others run the other way round.
            np.testing.assert_allclose(p, q[[0, *range(len(q) - 1, 0, -1)]], atol=1e-12)
        assert mesh.patches["low"]["neighbourPatch"] == "high"
    report = checked_by_openfoam(model.written, tmp_path)
    if report is not None:
        assert "Mesh OK." in report, report


@pytest.mark.parametrize("dimensions", [2, 3])
def test_channels_are_cyclic(dimensions: int, tmp_path: Path) -> None:
    """Two blocks with common names: one pair of cyclic patches."""
    text = "surface g[5,4]; for (i=1:5) for (j=1:4) g[i,j] = {i + 0.2*j*j, j + 0.1*sin(2*PI*(i - 1)/4), 0};\nsurface h = g + {0, 3, 0}; h[,1] = g[,4];\n"
    names = (
        '"i1 = low periodic, im = high periodic, j1 = floor wall"',
        '"i1 = low periodic, im = high periodic, jn = roof wall"',
    )
    if dimensions == 3:
        text += "block a = {g, g + {0,0,1}, g + {0,0,2}}, c = {h, h + {0,0,1}, h + {0,0,2}};\n"
        names = (
            names[0].replace("im", "in")[:-1] + ', k1 kn = ends symmetry"',
            names[1].replace("im", "in")[:-1] + ', k1 kn = ends symmetry"',
        )
    blocks = ("g", "h") if dimensions == 2 else ("a", "c")
    given = f"{blocks[0]}, {names[0]}, {blocks[1]}, {names[1]}"
    model = moldloft.loads(
        text + f'write_polymesh("constant/polyMesh", {given}); string s = interfaces({given});'
    )
    mesh = PolyMesh(model.written, "constant/polyMesh")
    mesh.check()
    for a, b in zip(mesh.range_of("low"), mesh.range_of("high"), strict=True):
        p, q = mesh.points[mesh.faces[a]], mesh.points[mesh.faces[b]]
        np.testing.assert_allclose(
            p + np.array([4, 0, 0]), q[[0, *range(len(q) - 1, 0, -1)]], atol=1e-12
        )
    assert model["s"].count("periodic: moved by") == 2
    report = checked_by_openfoam(model.written, tmp_path)
    if report is not None:
        assert "Mesh OK." in report, report


PERIODIC_MAP = "return {u + 0.1*v*v, v + 0.1*sin(2*PI*u), w + 0.05*v};"


@pytest.mark.parametrize("seed", range(60 if SOAK else 4))
def test_cut_blocks_are_periodic_along_two_axes(seed: int, tmp_path: Path) -> None:
    """Sides u = 0 and 1, w = 0 and 1 of cut blocks, named in any order: each pair by its own period."""
    rng = random.Random(2000 + seed)
    text, cells, _, _, _ = cut(rng)
    program = text[: text.index("write_su2")]
    program = re.sub(r"return \{u \+.*?\};", PERIODIC_MAP, program, count=1)
    assert PERIODIC_MAP in program and PERIODIC_MAP not in MAP
    arguments = []
    for block, spans in re.findall(r"fill\((b\d), ([^)]*)\);", program):
        *ends, a1, _, a3 = spans.split(", ")
        entries = []
        for axis, along in ((0, int(a1)), (2, int(a3))):
            for side, name in enumerate((("west", "east"), (), ("down", "up"))[axis]):
                numerator, denominator = ends[2 * axis + side].split("/")
                if int(numerator) == side * int(denominator):
                    # The side at which the index begins, or at which it ends.
                    last = side if along > 0 else 1 - side
                    entries.append(f"{SIDES[2 * (abs(along) - 1) + last]} = {name} periodic")
        rng.shuffle(entries)
        arguments.append(f'{block}, "{", ".join(entries)}"')
    rng.shuffle(arguments)
    model = moldloft.loads(f'{program}write_polymesh("constant/polyMesh", {", ".join(arguments)});')
    mesh = PolyMesh(model.written, "constant/polyMesh")
    assert len(mesh.check()) == cells
    for low, high, period in (("west", "east", [1, 0, 0]), ("down", "up", [0, 0, 1])):
        assert mesh.patches[low]["neighbourPatch"] == high
        vector = mesh.patches[low]["separationVector"].strip("()").split()
        np.testing.assert_allclose([float(x) for x in vector], period, atol=1e-12)
        for a, b in zip(mesh.range_of(low), mesh.range_of(high), strict=True):
            p, q = mesh.points[mesh.faces[a]], mesh.points[mesh.faces[b]]
            np.testing.assert_allclose(
                p + np.array(period), q[[0, *range(len(q) - 1, 0, -1)]], atol=1e-12
            )
    report = checked_by_openfoam(model.written, tmp_path)
    if report is not None:
        assert "Mesh OK." in report, report


def test_what_is_no_mesh_is_refused() -> None:
    square = (
        "surface g[3,3]; for (i=1:3) for (j=1:3) g[i,j] = {i, j, 0}; block b = {g, g + {0,0,1}};\n"
    )
    for call, match in [
        ('write_polymesh("p", b, b)', "same side"),
        ('write_gmsh("p", b, b, b)', "more than two cells"),
        ('write_su2("p", b, b)', "same side"),
        ('write_cgns("p", b, b[::-1, , ])', "same side"),
        ('write_polymesh("p", b, "k1 = low wedge, kn = high wedge")', "mirror image"),
        ('write_ugrid("p.ugrid", b)', "have no name"),
        ('write_ugrid("p.dat", b, "i1 in j1 jn k1 kn = all wall")', "name of a UGRID file"),
        ('write_ugrid("p.ugrid", b, "i1 in j1 jn k1 kn = all symmetry")', "not in a plane"),
        ('write_nmf("p.nmf", b, "i1 = a wall")', "have no name"),
        ('write_nmf("p.nmf", g)', "is a surface"),
        ('write_su2("p", b, "k1 = low wall", b + {0,0,1}, "i1 = low")', "two types"),
    ]:
        with pytest.raises(moldloft.Error, match=match):
            moldloft.loads(f"{square}{call};")
    two = "block c = {2*g + {9,9,0}, 2*g + {9,9,2}};\n"
    with pytest.raises(moldloft.Error, match="no partner"):
        moldloft.loads(
            square
            + two
            + 'write_polymesh("p", b, "k1 = low periodic, kn = high periodic", c, "k1 = low periodic, kn = high periodic");'
        )


@pytest.mark.parametrize("seed", range(40 if SOAK else 4))
def test_ugrid_and_neutral_map(seed: int, tmp_path: Path) -> None:
    """UGRID as meshio reads it, in three arrangements; each face of the map once, joined ones with equal points."""
    meshio = pytest.importorskip("meshio")
    rng = random.Random(1000 + seed)
    text, cells, points, _, _ = cut(rng)
    given = re.search(r'write_su2\("m.su2", (.*?)\); write_gmsh', text)
    assert given
    # All other faces are called far.
    parts = re.findall(r'(b\d+), "([^"]*)"', given[1])
    arguments = []
    for name, words in parts:
        rest = [
            f for f in ("i1", "in", "j1", "jn", "k1", "kn") if not re.search(rf"\b{f}\b", words)
        ]
        entries = [e for e in (words, f"{' '.join(rest)} = far farfield") if e]
        arguments.append(f'{name}, "{", ".join(entries)}"')
    listed = ", ".join(arguments).replace("left symmetry", "left inflow")
    bare = ", ".join(name for name, _ in parts)
    endings = (".ugrid", ".b8.ugrid", ".lb8.ugrid")
    text += "".join(f'write_ugrid("m{end}", {listed});\n' for end in endings)
    text += f'write_nmf("m.nmf", {listed}); write_p3d("n.x", {bare});'
    model = moldloft.loads(text)
    for end in endings:
        path = tmp_path / f"m{end}"
        path.write_bytes(model.written[f"m{end}"])
        mesh = meshio.read(path)
        same_points(mesh.points, points)
        hexes = mesh.cells_dict["hexahedron"]
        assert len(hexes) == cells
        p = mesh.points[hexes]
        volume = np.einsum(
            "ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 3] - p[:, 0]), p[:, 4] - p[:, 0]
        )
        assert volume.min() > 0
    lines = [line.split() for line in model.written["m.mapbc"].decode().splitlines()]
    conditions = {name: int(number) for _, number, name in lines[1:]}
    assert int(lines[0][0]) == len(conditions)
    assert conditions["far"] == 5000 and conditions["floor"] == 4000
    path = tmp_path / "n.x"
    path.write_bytes(model.written["n.x"])
    blocks, _, _ = grids.read_plot3d(path)
    check_map(model.written["m.nmf"].decode(), blocks)


OCTANT = """block b[4,4,5]; for (i = 1:4) for (j = 1:4) for (k = 1:5) { float r = (i - 1)/3, t = PI*(j - 1)/6, f = PI*(k - 1)/8; b[i,j,k] = {r*sin(t)*cos(f), r*sin(t)*sin(f), r*cos(t)}; }
"""
# Tetrahedra that an element of UGRID consists of: tetrahedron, pyramid (quadrilateral 1-4-5-2,
# apex 3), prism (triangle 1-2-3 towards 4-5-6), hexahedron.
TETRAHEDRA = [
    [(0, 1, 2, 3)],
    [(1, 0, 3, 2), (1, 3, 4, 2)],
    [(0, 1, 2, 3), (1, 2, 3, 4), (2, 4, 5, 3)],
    [(0, 1, 2, 5), (0, 2, 3, 7), (0, 5, 7, 4), (2, 7, 5, 6), (0, 2, 7, 5)],
]


def test_poles_of_ugrid() -> None:
    """An octant of a sphere about its centre: tetrahedra, pyramids, prisms and hexahedra with plane faces, together
    the volume of the polyhedra of OpenFOAM.
    """
    given = 'b, "i1 j1 = point patch, in = ball wall, jn = ground symmetry, k1 = west symmetry, kn = south symmetry"'
    model = moldloft.loads(
        f'{OCTANT}write_polymesh("constant/polyMesh", {given}); write_ugrid("o.ugrid", {given});'
    )
    wanted = PolyMesh(model.written, "constant/polyMesh").check().sum()
    numbers = model.written["o.ugrid"].decode().split()
    nodes, triangles, quads, *counts = (int(n) for n in numbers[:7])
    assert all(counts) and counts == [4, 8, 8, 16]
    points = np.array(numbers[7 : 7 + 3 * nodes], dtype=float).reshape(-1, 3)
    rest = np.array(numbers[7 + 3 * nodes :], dtype=int)

    def take(count: int, width: int) -> np.ndarray:
        nonlocal rest
        taken, rest = rest[: count * width].reshape(count, width), rest[count * width :]
        return taken

    faces = [take(triangles, 3) - 1, take(quads, 4) - 1]
    tags = take(triangles + quads, 1)
    lines = model.written["o.mapbc"].decode().splitlines()
    assert lines[0] == str(tags.max()) == "4"
    conditions = {line.split()[2]: line.split()[1] for line in lines[1:]}
    assert conditions == {"ball": "4000", "ground": "6663", "west": "6662", "south": "6661"}
    total = 0.0
    for count, width, parts in zip(counts, (4, 5, 6, 8), TETRAHEDRA, strict=True):
        cells = points[take(count, width) - 1]
        for part in parts:
            a, b, c, d = (cells[:, k] for k in part)
            volume = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
            assert volume.min() > 0
            total += volume.sum()
    assert not len(rest)
    assert total == pytest.approx(wanted, rel=1e-12)
    # The boundary faces are outward and closed.
    inside = 0.0
    for list_of in faces:
        p = points[list_of]
        for k in range(1, list_of.shape[1] - 1):
            inside += np.einsum("ij,ij->i", np.cross(p[:, 0], p[:, k]), p[:, k + 1]).sum() / 6
    assert inside == pytest.approx(wanted, rel=1e-12)


def check_map(text: str, blocks: list[np.ndarray]) -> int:
    """The joints of a neutral map, after its rules (NASA Langley, "The Neutral Map File")."""
    numbers = [line.split() for line in text.splitlines() if line.strip() and line[0] != "#"]
    count = int(numbers[0][0])
    assert [[int(x) for x in row[1:]] for row in numbers[1 : count + 1]] == [
        list(b.shape[:3]) for b in blocks
    ]
    # Faces kmin, kmax, imin, imax, jmin, jmax: constant axis, primary and secondary axis.
    axes = [(2, 0, 1), (2, 0, 1), (0, 1, 2), (0, 1, 2), (1, 2, 0), (1, 2, 0)]
    seen: Counter[tuple[int, int, int, int]] = Counter()

    def part(words: list[str]) -> np.ndarray:
        block, face, s1, e1, s2, e2 = (int(w) for w in words)
        constant, first, second = axes[face - 1]
        run = lambda s, e: np.arange(s - 1, e - 2, -1) if s > e else np.arange(s - 1, e)  # noqa: E731
        side = np.moveaxis(blocks[block - 1], (constant, first, second), (0, 1, 2))
        a, b = run(s1, e1), run(s2, e2)
        for i in range(min(a), max(a)):
            for j in range(min(b), max(b)):
                seen[block, face, i, j] += 1
        return side[0 if face % 2 else -1][np.ix_(a, b)]

    joints = 0
    for row in numbers[count + 1 :]:
        if row[0] == "'one-to-one'":
            own, other = part(row[1:7]), part(row[7:13])
            if row[13] == "TRUE":
                other = other.transpose(1, 0, 2)
            np.testing.assert_allclose(own, other, atol=1e-12)
            joints += 1
        else:
            part(row[1:7])
    wanted = sum(
        2 * ((b.shape[i] - 1) * (b.shape[j] - 1))
        for b in blocks
        for i, j in ((0, 1), (1, 2), (0, 2))
    )
    assert set(seen.values()) == {1} and len(seen) == wanted
    return joints
