# ruff: noqa: E501 -- programs of one line
"""Blocks of the language in files, read by others: meshio, Gmsh, VTK, h5py.

A mapped cube is cut into blocks at random, whose indices run in random directions; whatever was cut must be one mesh again.
"""

from __future__ import annotations

import itertools
import os
import random
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft import grids
from moldloft.adapters import _kept_signals

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
FACES = ("i1", "in", "j1", "jn", "k1", "kn")
MAP = """function vector p(float u, float v, float w) { return {u + 0.1*u*v*v, v + 0.1*sin(u + w), w + 0.05*u*v}; }
subroutine fill(returned block b, float u0, float u1, float v0, float v1, float w0, float w1, int a1, int a2, int a3) {
    for (i = 1:b.d1) for (j = 1:b.d2) for (k = 1:b.d3) {
        farray t = list((i - 1)/(b.d1 - 1), (j - 1)/(b.d2 - 1), (k - 1)/(b.d3 - 1));
        float u = along(t, a1), v = along(t, a2), w = along(t, a3);
        b[i,j,k] = p(u0 + u*(u1 - u0), v0 + v*(v1 - v0), w0 + w*(w1 - w0));
    }
}
function float along(farray t, int a) { if (a > 0) return t[a]; return 1 - t[-a]; }
"""


def mapped(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
    return np.stack([u + 0.1 * u * v * v, v + 0.1 * np.sin(u + w), w + 0.05 * u * v], axis=-1)


def cut(rng: random.Random) -> tuple[str, int, np.ndarray, dict[str, int], set[str]]:
    """A program of blocks, the cells of all, the points of the whole, boundary faces by name, remarks."""
    cells = [rng.randint(2, 4) for _ in range(3)]
    axis = rng.randrange(3)
    at = rng.randint(1, cells[axis] - 1)
    parts = [(0, at), (at, cells[axis])] if rng.random() < 0.8 else [(0, cells[axis])]
    text, names = MAP, []
    remarks = {"nameless"}
    faces_of: dict[str, int] = {}
    for number, part in enumerate(parts):
        spans = [(0, n) for n in cells]
        spans[axis] = part
        # Axis k of the map runs along index |order[k]| of the block.
        order = list(rng.choice(list(itertools.permutations((1, 2, 3)))))
        signs = [rng.choice((1, -1)) for _ in range(3)]
        # An odd number of swaps and reversals makes the indices left-handed, which CGNS keeps.
        if np.linalg.det(np.eye(3)[[o - 1 for o in order]]) * np.prod(signs) < 0:
            remarks.add("left-handed")
        size = [0, 0, 0]
        for k in range(3):
            size[order[k] - 1] = spans[k][1] - spans[k][0] + 1
        ends = ", ".join(f"{a}/{cells[k]}, {b}/{cells[k]}" for k, (a, b) in enumerate(spans))
        along = ", ".join(str(s * o) for s, o in zip(signs, order, strict=True))
        text += (
            f"block b{number}[{size[0]},{size[1]},{size[2]}]; fill(b{number}, {ends}, {along});\n"
        )
        # The floor w = 0 has a name; so have the sides u = 0.
        entries = []
        for k, name in ((2, "floor wall"), (0, "left symmetry")):
            if spans[k][0] == 0:
                word = FACES[2 * (order[k] - 1) + (0 if signs[k] > 0 else 1)]
                entries.append(f"{word} = {name}")
                others = [spans[a][1] - spans[a][0] for a in range(3) if a != k]
                key = name.split()[0]
                faces_of[key] = faces_of.get(key, 0) + others[0] * others[1]
        names.append(f'b{number}, "{", ".join(entries)}"')
    arguments = ", ".join(names)
    text += f'write_su2("m.su2", {arguments}); write_gmsh("m.msh", {arguments}); write_cgns("m.cgns", {arguments});\n'
    text += f'write_blockmesh("blockMeshDict", {arguments});\n'
    bare = ", ".join(f"b{k}" for k in range(len(parts)))
    text += f'write_p3d("m.x", {bare}); write_vts("m.vts", {bare}); int n = count_p3d("m.x"); block back = read_p3d("m.x", n);\n'
    text += f"float gap = max(|back - b{len(parts) - 1}|);\n"
    grid = np.meshgrid(*[np.linspace(0, 1, n + 1) for n in cells], indexing="ij")
    a, b, c = cells
    faces_of["defaultFaces"] = 2 * (a * b + b * c + c * a) - sum(faces_of.values())
    return text, a * b * c, mapped(*grid).reshape(-1, 3), faces_of, remarks


def same_points(found: np.ndarray, wanted: np.ndarray) -> None:
    """One point for each, none twice."""
    assert found.shape == wanted.shape
    order = lambda p: p[np.lexsort(np.round(p, 9).T)]  # noqa: E731
    np.testing.assert_allclose(order(found), order(wanted), atol=1e-12)


def volumes(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The triple products at the first corners of hexahedra in VTK's order."""
    p = points[cells]
    return np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 3] - p[:, 0]), p[:, 4] - p[:, 0])


def section_of(rng: random.Random, n: int) -> tuple[str, Any]:
    """A subscript, and NumPy's."""
    kind = rng.randrange(4)
    if kind == 0:
        return "", slice(None)
    if kind == 1:
        k = rng.randint(1, n)
        return str(k), k - 1
    low, high = sorted((rng.randint(1, n), rng.randint(1, n)))
    if kind == 2:
        return f"{low}:{high}", slice(low - 1, high)
    step = rng.randint(1, 3)
    stop = low - 2 if low > 1 else None
    return f"{high}:{low}:-{step}", slice(high - 1, stop, -step)


@pytest.mark.parametrize("seed", range(200 if SOAK else 10))
def test_sections_of_blocks_are_those_of_numpy(seed: int) -> None:
    """Read, assigned one value, another section, and computed with; to the bit."""
    rng = random.Random(seed)
    shape = [rng.randint(1, 4) for _ in range(3)]
    if shape[2] == 1 and rng.random() < 0.5:
        shape[2] = 2
    ni, nj, nk = shape
    text = f"block b[{ni},{nj},{nk}];\nfor (i = 1:{ni}) for (j = 1:{nj}) for (k = 1:{nk}) b[i,j,k] = {{i, 10*j, 100*k}};\n"
    i, j, k = np.meshgrid(*[np.arange(1.0, n + 1) for n in shape], indexing="ij")
    b = np.stack([i, 10 * j, 100 * k], axis=-1)
    want: dict[str, np.ndarray] = {}
    kinds = {3: "block", 2: "surface", 1: "curve", 0: "vector"}
    for number in range(12):
        parts = [section_of(rng, n) for n in shape]
        words = "[" + ", ".join(p[0] for p in parts) + "]"
        at = tuple(p[1] for p in parts)
        count = sum(isinstance(a, slice) for a in at)
        action = rng.randrange(6)
        if action < 2:
            text += f"{kinds[count]} r{number} = b{words};\n"
            want[f"r{number}"] = b[at].copy()
        elif action == 2:
            x = rng.randint(-9, 9)
            text += f"b{words} = {{{x}, 1, 2}};\n"
            b[at] = [x, 1, 2]
        elif action == 3:
            axis = rng.randrange(3)
            text += f"b{words}.{'xyz'[axis]} = {number};\n"
            b[(*at, axis)] = number
        elif action == 4:
            text += f"b{words} = 2*b{words} + {{1, 0, 0}};\n"
            b[at] = 2 * b[at] + [1, 0, 0]
        else:
            text += f"b{words} *= 3;\n"
            b[at] *= 3
    text += "block all = b; float total = sum(b.x), high = max(b.y);\n"
    model = moldloft.loads(text)
    assert not model.diagnostics, (text, model.diagnostics)

    for name, value in want.items():
        assert np.array_equal(model[name], value), (name, text)
    assert np.array_equal(model["all"], b), text
    assert (float(model["total"]), float(model["high"])) == (b[..., 0].sum(), b[..., 1].max())


def cgnscheck(path: Path) -> None:
    """CGNS's own program finds nothing, where it is installed; plane surfaces have a range of 0."""
    if program := shutil.which("cgnscheck"):
        done = subprocess.run([program, "-v", str(path)], capture_output=True, text=True)
        said = [line for line in done.stdout.splitlines() if re.search("ERROR|WARNING", line)]
        assert done.returncode == 0, done.stdout
        assert set(said) <= {"WARNING:coordinate range is 0"}, done.stdout


def check_cgns(path: Path, count: int, boundary: dict[str, int]) -> None:
    """Every face of every zone is covered once, by a joint whose points coincide or by a boundary."""
    cgnscheck(path)
    h5py = pytest.importorskip("h5py")
    with h5py.File(path) as file:
        bases = [g for g in file.values() if isinstance(g, h5py.Group)]
        (base,) = [g for g in bases if g.attrs["label"].startswith(b"CGNSBase_t")]

        def children(node: Any, label: bytes) -> list[Any]:
            groups = [g for g in node.values() if isinstance(g, h5py.Group)]
            return [g for g in groups if g.attrs["label"].strip(b"\0") == label]

        zones, cells, named = {}, 0, dict.fromkeys(boundary, 0)
        for zone in children(base, b"Zone_t"):
            (grid,) = children(zone, b"GridCoordinates_t")
            points = np.stack([grid[f"Coordinate{c}"][" data"][:].T for c in "XYZ"], axis=-1)
            zones[zone.name.rsplit("/", 1)[1]] = points
            cells += int(np.prod(np.array(points.shape[:3]) - 1))
        assert cells == count

        def span(node: Any) -> np.ndarray:
            return np.asarray(node[" data"][:]).reshape(2, 3) - 1

        def quads(ends: np.ndarray) -> list[tuple[int, ...]]:
            low, high = ends.min(axis=0), ends.max(axis=0)
            ranges = [range(a, b) if b > a else [a] for a, b in zip(low, high, strict=True)]
            flat = [k for k in range(3) if low[k] == high[k]]
            assert len(flat) == 1
            return [(flat[0], *place) for place in itertools.product(*ranges)]

        for zone in children(base, b"Zone_t"):
            name = zone.name.rsplit("/", 1)[1]
            points = zones[name]
            shape = np.array(points.shape[:3])
            covered: dict[tuple[int, ...], int] = {}
            for group in children(zone, b"ZoneGridConnectivity_t"):
                for joint in children(group, b"GridConnectivity1to1_t"):
                    donor = zones[bytes(joint[" data"][:].astype(np.uint8)).decode().strip("\0 ")]
                    own, other = span(joint["PointRange"]), span(joint["PointRangeDonor"])
                    assert (own[0] <= own[1]).all()
                    transform = joint["Transform"][" data"][:]
                    matrix = np.zeros((3, 3), int)
                    for k, t in enumerate(transform):
                        matrix[abs(t) - 1, k] = np.sign(t)
                    low, high = own.min(axis=0), own.max(axis=0)
                    for place in itertools.product(
                        *[range(a, b + 1) for a, b in zip(low, high, strict=True)]
                    ):
                        there = matrix @ (np.array(place) - own[0]) + other[0]
                        assert np.allclose(points[place], donor[tuple(there)], atol=1e-12)
                    for quad in quads(own):
                        covered[quad] = covered.get(quad, 0) + 1
            for group in children(zone, b"ZoneBC_t"):
                for patch in children(group, b"BC_t"):
                    family = (
                        bytes(patch["FamilyName"][" data"][:].astype(np.uint8))
                        .decode()
                        .strip("\0 ")
                    )
                    for quad in quads(span(patch["PointRange"])):
                        covered[quad] = covered.get(quad, 0) + 1
                    if family in named:
                        named[family] += len(quads(span(patch["PointRange"])))
            n = shape - 1
            faces = 2 * (n[0] * n[1] + n[1] * n[2] + n[2] * n[0])
            assert set(covered.values()) == {1} and len(covered) == faces
        assert all(named[name] == boundary[name] for name in boundary if name != "defaultFaces")


@pytest.mark.parametrize("seed", range(300 if SOAK else 8))
def test_what_was_cut_is_one_mesh_again(seed: int, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    text, count, points, boundary, remarks = cut(random.Random(seed))
    model = moldloft.loads(text)
    assert {d.id for d in model.diagnostics} == remarks, model.diagnostics
    assert float(model["gap"]) == 0
    for name, data in model.written.items():
        (tmp_path / name).write_bytes(data)
    # SU2.
    mesh = meshio.read(tmp_path / "m.su2")
    hexes = np.concatenate([c.data for c in mesh.cells if c.type == "hexahedron"])
    same_points(mesh.points, points)
    assert len(hexes) == count and (volumes(mesh.points, hexes) > 0).all()
    su2 = (tmp_path / "m.su2").read_text()
    tags = dict(re.findall(r"MARKER_TAG= (\S+)\nMARKER_ELEMS= (\d+)", su2))
    assert {name: int(n) for name, n in tags.items()} == {k: n for k, n in boundary.items() if n}
    # Gmsh's format, by meshio.
    mesh = meshio.read(tmp_path / "m.msh")
    hexes = np.concatenate([c.data for c in mesh.cells if c.type == "hexahedron"])
    same_points(mesh.points, points)
    assert len(hexes) == count and (volumes(mesh.points, hexes) > 0).all()
    physical = np.concatenate(
        [
            np.asarray(a)
            for c, a in zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True)
            if c.type == "quad"
        ]
    )
    for name, n in boundary.items():
        if n:
            assert (physical == mesh.field_data[name][0]).sum() == n
    # blockMesh: vertices, cells and patches of the text.
    text = (tmp_path / "blockMeshDict").read_text()
    numbers = r"\(([-+.\deE]+) ([-+.\deE]+) ([-+.\deE]+)\)"
    vertices = text.split("vertices")[1].split("blocks")[0]
    places = np.array(re.findall(numbers, vertices), dtype=float)
    same_points(places, points)
    cells = np.array([list(map(int, m.split())) for m in re.findall(r"hex \(([\d ]+)\)", text)])
    assert len(cells) == count and (volumes(places, cells) > 0).all()
    assert text.count("symmetryPlane") == ("left" in boundary) and text.count("type wall") == 1
    check_cgns(tmp_path / "m.cgns", count, boundary)


def test_gmsh_reads_the_mesh(tmp_path: Path) -> None:
    gmsh = pytest.importorskip("gmsh")
    text, count, *_ = cut(random.Random(3))
    (tmp_path / "m.msh").write_bytes(moldloft.loads(text).written["m.msh"])
    with _kept_signals():
        gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Verbosity", 0)
        gmsh.open(str(tmp_path / "m.msh"))
        (kind,), (tags,), _ = gmsh.model.mesh.getElements(3)
        assert (kind, len(tags)) == (5, count)
        assert min(gmsh.model.mesh.getElementQualities(tags, "minSICN")) > 0
        names = {gmsh.model.getPhysicalName(d, t) for d, t in gmsh.model.getPhysicalGroups()}
        assert {"floor", "left", "fluid"} <= names
    finally:
        gmsh.finalize()


def test_a_wake_joins_the_block_to_itself() -> None:
    """A C-grid made a block by a second layer: its wake meets itself, reversed."""
    model = moldloft.loads(
        """load "naca.sdl"
        curve c[41]; naca4s(c, 0, 0, 12); curve s = c[::-1];
        surface g = c_grid(s, geometric(0, 1, 0.01, 12), 1, 8);
        block b = {g, g + {0, 0, 0.1}};
        write_cgns("c.cgns", b, "i1 = wing wall"); write_su2("c.su2", b, "i1 = wing wall");"""
    )
    text = model.written["c.su2"].decode()
    tags = dict(re.findall(r"MARKER_TAG= (\S+)\nMARKER_ELEMS= (\d+)", text))
    # Of the line next to the section and its wake only the section is boundary.
    assert int(tags["wing"]) == 40
    h5py = pytest.importorskip("h5py")
    import io

    with h5py.File(io.BytesIO(model.written["c.cgns"])) as file:
        found: list[str] = []
        file.visit(
            lambda name: (
                found.append(name) if "/join" in name and name.endswith("Transform") else None
            )
        )
    assert len(found) == 2


@pytest.mark.parametrize("seed", range(20 if SOAK else 2))
def test_the_volume_grid_of_the_missile(seed: int) -> None:
    """No cell is turned over, but at the pole none collapses, and the first cell is as high as asked."""
    example = Path(__file__).resolve().parents[3] / "examples" / "missile" / "volume.sdl"
    rng = random.Random(seed)
    model = moldloft.load(example)
    ranges = {"ogive": (2, 10), "radius": (0.5, 1), "first": (0.001, 0.02), "far": (4, 12)}
    chosen = {name: rng.uniform(*ends) for name, ends in ranges.items()} if seed else {}
    if chosen:
        model.set(chosen)
    assert not [d for d in model.diagnostics if d.is_error], model.diagnostics
    g = np.array(model["grid"])
    cell = [g[1:, :-1], g[:-1, :-1], g[:-1, 1:], g[1:, 1:]]
    low = [c[:, :, :-1] for c in cell]
    up = g[:-1, :-1, 1:] - g[:-1, :-1, :-1]
    # At the corner away from the pole: along i, along j, up.
    far = low[3]
    jacobian = np.einsum(
        "...i,...i", np.cross(far - low[2], far - low[0]), g[1:, 1:, 1:] - g[1:, 1:, :-1]
    )
    sign = np.sign(np.median(jacobian))
    assert (jacobian * sign > 0).all() and up.shape[0] == 47
    first = chosen.get("first", 0.005)
    heights = np.linalg.norm(g[:, :, 1] - g[:, :, 0], axis=-1)
    assert np.allclose(heights, first, rtol=1e-6)
    assert (g[:, [0, -1], :, 2] == 0).all()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("k1 floor", "follows `=`"),
        ("k9 = floor wall", "no face"),
        ("k1 = floor wal", "no boundary"),
        ("k1 = ", "no name"),
        ("k1 = a(b wall", "not a boundary name"),
    ],
)
def test_wrong_names_of_faces_are_refused(words: str, message: str) -> None:
    program = f'surface s[2,2]; s[1,] = {{{{0, 0, 0}}, {{0, 1, 0}}}}; s[2,] = {{{{1, 0, 0}}, {{1, 1, 0}}}}; block b = {{s, s + {{0, 0, 1}}}}; write_su2("b.su2", b, "{words}");'
    with pytest.raises(moldloft.Error, match=message):
        moldloft.loads(program)


def test_poles_are_wedges(tmp_path: Path) -> None:
    """A sector about an axis, and one about its other end: wedges of Gmsh's own volume."""
    text = """surface s[3,4]; for (i = 1:3) for (j = 1:4) s[i,j] = (i - 1)*{cos(j/4), sin(j/4), 0};
    block b = {s, s + {0, 0, 1}}; write_p3d("b.x", b); %s("b", b, "k1 = floor wall");"""
    su2 = moldloft.loads(text % "write_su2").written["b"].decode().splitlines()
    kinds = [line.split()[0] for line in su2[2:8]]
    assert sorted(kinds) == ["12"] * 3 + ["13"] * 3
    floor = su2.index("MARKER_TAG= floor")
    assert [line.split()[0] for line in su2[floor + 2 : floor + 8]].count("5") == 3
    # An edge alone that has no length leaves no cell of these formats.
    odd = """surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}};
    surface t = s + {0, 0, 1}; t[1,1] = t[1,2]; block b = {s, t}; %s("b", b);"""
    for name in ("write_su2", "write_gmsh"):
        with pytest.raises(moldloft.Error, match="collapsed"):
            moldloft.loads(odd % name)
    assert b"hex" in moldloft.loads(text % "write_blockmesh").written["b"]
    gmsh = pytest.importorskip("gmsh")
    path = tmp_path / "b.msh"
    path.write_bytes(moldloft.loads(text % "write_gmsh").written["b"])
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        types, tags, _ = gmsh.model.mesh.getElements(3)
        volumes = [v for of in tags for v in gmsh.model.mesh.getElementQualities(of, "volume")]
        assert sorted(types) == [5, 6] and min(volumes) > 0
        # Triangles of the sector, by their sines.
        assert sum(volumes) == pytest.approx(3 * 0.5 * 4 * np.sin(0.25))
    finally:
        gmsh.finalize()


CUBE = """surface low[2,2], up[2,2];
low[1,] = {{0, 0, 0}, {0, 1, 0}}; low[2,] = {{1, 0, 0}, {1, 1, 0}};
up = low + {0, 0, 1};
"""


@pytest.mark.parametrize(
    ("change", "metric", "value"),
    [
        ("", "sj", 1),
        ("", "skew", 0),
        ("", "volume", 1),
        ("up += {1, 0, 0};", "sj", 0.7071067811865476),
        ("up += {1, 0, 0};", "skew", 0.5),
        ("up += {1, 0, 0};", "volume", 1),
        ("up[2,2] = {.4, .4, .4};", "sj", -0.969094),
        ("up[2,2] = {.4, .4, .4};", "volume", 0.55),
        ("up += {0, 0, 9};", "aspect", 10),
        ("up += {0, 0, 9};", "edge_ratio", 10),
        ("up += {1, 0, 0};", "edge_ratio", 2**0.5),
        # A pole: two edges without length.
        ("low[2,2] = low[2,1]; up[2,2] = up[2,1];", "volume", 0.5),
        ("low[2,2] = low[2,1]; up[2,2] = up[2,1];", "sj", 0.7071067811865476),
        # A left-handed block is its mirror image.
        ("surface s = low; low = up; up = s;", "sj", 1),
        ("surface s = low; low = up; up = s;", "volume", 1),
    ],
)
def test_metrics_of_single_cells(change: str, metric: str, value: float) -> None:
    """Figures of Verdict and closed forms."""
    m = moldloft.loads(
        f'{CUBE}{change} block b = {{low, up}}; float q = min(quality(b, "{metric}"));'
    )
    assert m["q"] == pytest.approx(value, abs=1e-6)


def test_metrics_of_blocks_against_numpy() -> None:
    m = moldloft.loads(
        "surface wall[6,5]; for (i = 1:6) for (j = 1:5) wall[i,j] = {i^1.3, j + .1*i, .2*sin(i*j)};\n"
        "block b = hyperbolic(wall, geometric(0, 2, .1, 7));\n"
        'block sj = quality(b, "sj"), v = quality(b, "volume"), g = quality(b, "growth_k");\n'
        "assert sj.d1 == 5 and sj.d2 == 4 and sj.d3 == 6 and min(sj) > 0;\n"
    )
    p = np.asarray(m["b"])
    corner = {
        (a, b, c): p[a : a + 5, b : b + 4, c : c + 6]
        for a in (0, 1)
        for b in (0, 1)
        for c in (0, 1)
    }
    least = np.full((5, 4, 6), np.inf)
    for (a, b, c), here in corner.items():
        u = (corner[1 - a, b, c] - here) * (1 - 2 * a)
        v = (corner[a, 1 - b, c] - here) * (1 - 2 * b)
        w = (corner[a, b, 1 - c] - here) * (1 - 2 * c)
        scale = np.prod([np.linalg.norm(x, axis=-1) for x in (u, v, w)], axis=0)
        least = np.minimum(least, np.einsum("...i,...i", np.cross(u, v), w) / scale)
    middle = [sum(corner[k][...] * (1 if k[axis] else -1) for k in corner) / 4 for axis in range(3)]
    length = np.linalg.norm(middle[2], axis=-1)
    ratio = np.maximum(length[..., 1:] / length[..., :-1], length[..., :-1] / length[..., 1:])
    growth = np.ones((5, 4, 6))
    growth[..., 1:] = np.maximum(growth[..., 1:], ratio)
    growth[..., :-1] = np.maximum(growth[..., :-1], ratio)
    for name, expected in (("sj", least), ("g", growth)):
        np.testing.assert_allclose(m[name], expected, rtol=1e-12)
    # The volumes of the cells add up to that of the block, by its faces.
    total = 0.0
    n, w = np.polynomial.legendre.leggauss(2)
    for i, x in enumerate(n):
        for j, y in enumerate(n):
            for k, z in enumerate(n):
                t = {0: [(1 - s) / 2 for s in (x, y, z)], 1: [(1 + s) / 2 for s in (x, y, z)]}
                rate = []
                for axis in range(3):
                    others = [d for d in range(3) if d != axis]
                    rate.append(
                        sum(
                            q
                            * (1 if key[axis] else -1)
                            * t[key[others[0]]][others[0]]
                            * t[key[others[1]]][others[1]]
                            for key, q in corner.items()
                        )
                    )
                det = np.einsum("...i,...i", np.cross(rate[0], rate[1]), rate[2])
                total += (det * w[i] * w[j] * w[k] / 8).sum()
    assert float(np.asarray(m["v"]).sum()) == pytest.approx(total, rel=1e-12)


def test_measures_of_blocks_and_h_grids_have_derivatives() -> None:
    text = """load "naca.sdl"; param float h = 0.3 in [0.1, 0.6];
surface wall[4,4]; for (i = 1:4) for (j = 1:4) wall[i,j] = {i, j + h*i, h*sin(i*j)};
block b = hyperbolic(wall, {0, h, 3*h});
float worst = min(quality(b, "sj")), skew = max(quality(b, "skew")), v = sum(quality(b, "volume"));
float aspect = max(quality(b, "aspect")), edge = max(quality(b, "edge_ratio")), g = max(quality(b, "growth_k"));
curve c[17]; naca4s(c, 0, 0, 12); c.y = c.y*(1 + h);
surface u = h_grid(c, geometric(0, 2, .1, 6), 1, 1, 4, 60)[2];
vector p = u[8, 3];
"""
    m = moldloft.loads(text)
    step = 1e-5
    high, low = (moldloft.loads(text.replace("h = 0.3", f"h = {0.3 + d!r}")) for d in (step, -step))
    for name in ("worst", "skew", "v", "aspect", "edge", "g", "p.x", "p.y"):
        differences = (high.eval(name) - low.eval(name)) / (2 * step)
        assert m.derivative(name, "h") == pytest.approx(differences, rel=1e-5, abs=1e-6), name


@pytest.mark.parametrize("section", ["0, 0, 12", "2, 4, 12", "4, 4, 9", "0, 0, 21"])
@pytest.mark.parametrize("n", [41, 61])
def test_h_grids(section: str, n: int) -> None:
    m = moldloft.loads(
        f'load "naca.sdl"; curve c[{n}]; naca4s(c, {section});\n'
        "surface both[] = h_grid(c, geometric(0, 2, .02, 25), 2, 3, 15);\n"
        "surface lower = both[1], upper = both[2];\n"
        "assert folds(lower) == 0 and folds(upper) == 0;\n"
        'write_cgns("h.cgns", stack(lower, lower + {0,0,1}), stack(upper, upper + {0,0,1}));'
    )
    lower, upper = np.asarray(m["lower"]), np.asarray(m["upper"])
    # Ahead and behind both are the same points, the lower one running upstream.
    assert np.array_equal(lower[::-1, 0][:16], upper[:16, 0])
    assert np.array_equal(lower[::-1, 0][-16:], upper[-16:, 0])
    for grid in (lower, upper):
        along, across = np.diff(grid[:, :-1], axis=0), np.diff(grid[:-1], axis=1)
        assert (np.cross(along, across)[..., 2] > 0).all()
    # The program names no boundary.
    remarks = {d.id for d in m.diagnostics} - {"nameless"}
    if not remarks:
        # What has settled has the first cell asked for, at right angles, between the ends.
        first = np.linalg.norm(upper[1:-1, 1] - upper[1:-1, 0], axis=-1)
        assert np.abs(first / 0.02 - 1).max() < 1e-4
    assert remarks <= {"not-converged"}, m.diagnostics


@pytest.mark.parametrize(
    ("call", "match"),
    [
        ("h_grid(c, {0, .1, .2}, 0, 1, 5)", "positive length"),
        ("h_grid(c, {0, .1}, 1, 1, 5)", "at least 3 heights"),
        ("h_grid(c, {0, .2, .1}, 1, 1, 5)", "at least 3 heights"),
        ("h_grid(-c, {0, .1, .2}, 1, 1, 5)", "from its trailing edge"),
        ("h_grid(c[1:40], {0, .1, .2}, 1, 1, 5)", "ends in its first point"),
        ('quality({c, c}, "sj")', "surface"),
        ('quality(b, "warp")', "growth_k"),
    ],
)
def test_refusals_of_h_grids_and_metrics(call: str, match: str) -> None:
    text = f'load "naca.sdl"; curve c[41]; naca4s(c, 0, 0, 12); {CUBE} block b = {{low, up}};'
    with pytest.raises(moldloft.ModelError, match=match):
        moldloft.loads(f"{text} print {call};")


def viscous(fewer: bool = False, **parameters: float) -> moldloft.Model:
    """The example, also with fewer points, at a place of its parameters' ranges."""
    path = Path(__file__).parents[3] / "examples/wingbody/viscous.sdl"
    text = path.read_text()
    for name, n in (("ni = 65", "ni = 41"), ("layers = 31", "layers = 21")) if fewer else ():
        assert name in text
        text = text.replace(name, n)
    for name, x in parameters.items():
        text, count = re.subn(rf"(param float {name} = )[0-9.]+", rf"\g<1>{x!r}", text)
        assert count == 1
    return moldloft.loads(text)


def draw(seed: int) -> dict[str, float]:
    """Parameters: the corners of their ranges, then places in them."""
    ranges = {"first": (0.0002, 0.003), "a": (1.6, 2.4), "b": (0.25, 0.35)}
    if seed < 8:
        return {name: ends[seed >> k & 1] for k, (name, ends) in enumerate(ranges.items())}
    rng = random.Random(seed)
    return {name: round(rng.uniform(*ends), 5) for name, ends in ranges.items()}


@pytest.mark.parametrize("seed", range(40) if SOAK else (5, 8))
def test_a_viscous_wing_body_is_sound_in_all_its_range(seed: int) -> None:
    parameters = draw(seed)
    p = np.asarray(viscous(**parameters)["grid"])
    # Its own assertions are of folds and scaled Jacobians.
    for axis in range(3):
        assert np.linalg.norm(np.diff(p, axis=axis), axis=-1).min() > 0.1 * parameters["first"]
    assert np.abs(p[:, 0, :, 1]).max() == 0
    # Beside the root of the wing a node goes farther to be that far from both walls.
    first = np.linalg.norm(p[:, :, 1] - p[:, :, 0], axis=-1)
    assert first.min() > 0.99 * parameters["first"]


def test_a_viscous_wing_body_has_no_collapsed_corners(tmp_path: Path) -> None:
    m = viscous(fewer=True)
    p = np.asarray(m["grid"])
    for axis in range(3):
        assert np.linalg.norm(np.diff(p, axis=axis), axis=-1).min() > 1e-5
    assert np.abs(p[:, 0, :, 1]).max() == 0
    first = np.linalg.norm(p[:, :, 1] - p[:, :, 0], axis=-1)
    assert first.min() > 0.00099
    file = tmp_path / "viscous.cgns"
    file.write_bytes(m.written["viscous.cgns"])
    assert np.array_equal(grids.read_cgns(file)["grid"], p)
    cgnscheck(file)


@pytest.mark.skipif(not shutil.which("cgnscheck"), reason="needs cgnscheck")
def test_cgns_files_of_examples_are_clean(tmp_path: Path) -> None:
    examples = sorted((Path(__file__).parents[3] / "examples").glob("*/*.sdl"))
    for path in examples if SOAK else examples[::9]:
        m = moldloft.load(path)
        for name, data in m.written.items():
            if name.endswith(".cgns"):
                (tmp_path / "written.cgns").write_bytes(data)
                cgnscheck(tmp_path / "written.cgns")
        for form in ("cgns", "volume-cgns"):
            try:
                m.write(tmp_path / f"{form}.cgns", format=form)
            except moldloft.Error as error:
                words = ("no structured grid", "no solids", "no panels", "cannot hold the wires")
                assert any(word in str(error) for word in words)
                continue
            cgnscheck(tmp_path / f"{form}.cgns")
