"""Volume grids: the wing and body's layers, their joins, and their files read back."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import blockmesh

pyvista = pytest.importorskip("pyvista")

LAYERS = Path(__file__).parents[3] / "examples/wingbody/layers.sdl"


@pytest.fixture(scope="module")
def blocks() -> moldloft.Blocks:
    return moldloft.load(LAYERS).blocks()


def _range(begin, end):
    """All places of a rectangle, in order from its begin to its end."""
    steps = [
        range(a, b + 1) if a <= b else range(a, b - 1, -1) for a, b in zip(begin, end, strict=True)
    ]
    return np.array(list(itertools.product(*steps)))


def test_interfaces_are_the_same_vertices(blocks):
    pairs = {(i.block, i.donor) for i in blocks.interfaces}
    # Above and below meet, each meets the root's, that the wing's, that the tip's; two are rings.
    assert pairs == {(0, 1), (0, 2), (1, 2), (2, 2), (2, 3), (3, 3), (3, 4)}
    for joint in blocks.interfaces:
        matrix = np.zeros((3, 3), dtype=int)
        for own, number in enumerate(joint.transform):
            matrix[abs(number) - 1, own] = np.sign(number)
        assert abs(np.linalg.det(matrix)) == 1
        begin, there = np.array(joint.begin), np.array(joint.donor_begin)
        own, donor = (blocks.blocks[k].indices for k in (joint.block, joint.donor))
        for place in _range(joint.begin, joint.end):
            partner = there + matrix @ (place - begin)
            assert own[tuple(place)] == donor[tuple(partner)]
        assert tuple(there + matrix @ (np.array(joint.end) - begin)) == joint.donor_end
        back = joint.reversed()
        assert back.reversed() == joint
        assert (back.block, back.begin) == (joint.donor, joint.donor_begin)


def test_every_face_is_inside_or_a_boundary(blocks):
    count: dict[frozenset[int], int] = {}
    for block in blocks.blocks:
        g = block.indices
        for face in (g[0], g[-1], g[:, 0], g[:, -1], g[:, :, 0], g[:, :, -1]):
            corners = np.stack([face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]], -1)
            for corner in corners.reshape(-1, 4).tolist():
                if len(set(corner)) > 2:
                    count[frozenset(corner)] = count.get(frozenset(corner), 0) + 1
    assert set(count.values()) == {1, 2}
    free = sum(
        np.prod([b - a for a, b in zip(part.begin, part.end, strict=True) if a != b])
        for part in blocks.boundaries
    )
    # Panels at poles are lines in some faces: those are counted in the rectangles only.
    assert free >= sum(n == 1 for n in count.values()) > 0
    assert {part.kind for part in blocks.boundaries} == {"symmetry", "wall"}
    symmetric = [part.name for part in blocks.boundaries if part.kind == "symmetry"]
    assert symmetric == ["above.v0", "below.v1"]


def test_draws_have_positive_cells():
    model = moldloft.load(LAYERS)
    joints = len(model.blocks().interfaces)
    rng = np.random.default_rng(4)
    for _ in range(12):
        values = {p.name: rng.uniform(p.low, p.high) for p in model.params.values()}
        model.set(values)
        made = model.blocks()
        assert made.positive, values
        assert len(made.interfaces) == joints


def test_plot3d_and_vtk_read_back(blocks, tmp_path):
    path = tmp_path / "layers.p3d"
    blocks.write(path)
    reader = pyvista.MultiBlockPlot3DReader(str(path))
    reader.auto_detect_format = True
    grids = [reader.read()[k] for k in range(len(blocks))]
    (main, *_) = blocks.write(tmp_path / "layers.vts")
    assert main.suffix == ".vtm"
    several = pyvista.read(main)
    for grid, other, block in zip(grids, several, blocks.blocks, strict=True):
        for one in (grid, other):
            assert one.dimensions == tuple(n + 1 for n in block.divisions)
            ours = block.points.transpose(2, 1, 0, 3).reshape(-1, 3)
            assert np.array_equal(one.points, ours)
            assert one.volume == pytest.approx(block.volume, rel=2e-3)
    blocks.write(tmp_path / "layers.vtu")
    whole = pyvista.read(tmp_path / "layers.vtu")
    assert whole.n_cells == blocks.cells
    assert np.array_equal(whole.points, blocks.vertices)


def test_cgns_read_back(blocks, tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "layers.cgns"
    blocks.write(path)

    def grids(group):
        for one in group:
            if isinstance(one, pyvista.MultiBlock):
                yield from grids(one)
            elif isinstance(one, pyvista.StructuredGrid):
                yield one

    zones = [z for z in grids(pyvista.CGNSReader(path).read()) if min(z.dimensions) > 1]
    assert len(zones) == len(blocks)
    for zone, block in zip(zones, blocks.blocks, strict=True):
        assert zone.dimensions == tuple(n + 1 for n in block.divisions)
        assert np.abs(zone.points - block.points.transpose(2, 1, 0, 3).reshape(-1, 3)).max() == 0
    with h5py.File(path) as file:
        base = file["layers"]
        assert list(base[" data"][:]) == [3, 3]
        joins = sum(len(base[b.name].get("ZoneGridConnectivity", ())) for b in blocks.blocks)
        assert joins == 2 * len(blocks.interfaces)
        wing = base["ship.wing/FamilyBC"]
        assert bytes(wing[" data"][:]) == b"BCWall"
        ranges = [one["PointRange/ data"][:] for one in base["round_wing/ZoneBC"].values()]
        assert {tuple(map(tuple, r)) for r in ranges} == {
            ((1, 1, 1), (41, 21, 1)),
            ((1, 1, 7), (41, 21, 7)),
        }


class BlockMeshDict:
    """A reader of blockMeshDict of its own, with blockMesh's interpolation of blocks."""

    def __init__(self, text: str) -> None:
        number = r"[-+\d.e]+"
        part = dict(
            re.findall(r"^(vertices|blocks|edges|boundary)\n\((.*?)^\);", text, re.S | re.M)
        )
        triple = re.compile(rf"\(({number}) ({number}) ({number})\)")
        self.vertices = np.array([list(map(float, t)) for t in triple.findall(part["vertices"])])
        self.edges = {}
        for first, last, inner in re.findall(r"polyLine (\d+) (\d+) \((.*)\)", part["edges"]):
            points = np.array([list(map(float, t)) for t in triple.findall(inner)])
            self.edges[int(first), int(last)] = points
        self.blocks = []
        for line in part["blocks"].strip().splitlines():
            corners, name, cells, grading = re.match(
                r"\s*hex \(([\d ]+)\) (\S+) \(([\d ]+)\) edgeGrading \((.*)\)$", line
            ).groups()
            gradings = re.findall(r"\((?:\([^()]*\) ?)+\)|[\d.]+", grading)
            assert len(gradings) == 12
            self.blocks.append(
                ([int(c) for c in corners.split()], name, [int(n) for n in cells.split()], gradings)
            )
        self.boundary = {
            name: (kind, [tuple(map(int, f.split())) for f in re.findall(r"\(([\d ]+)\)", faces)])
            for name, kind, faces in re.findall(
                r"(\S+)\s*\{\s*type (\w+);[^{}]*?faces\s*\((.*?)\);\s*\}", part["boundary"], re.S
            )
        }

    def along(self, first: int, last: int, cells: int, grading: str):
        """Points and parameters of an edge: the polyline by length, graded."""
        if (first, last) in self.edges:
            inner = self.edges[first, last]
        else:
            inner = self.edges.get((last, first), np.zeros((0, 3)))[::-1]
        line = np.vstack([self.vertices[first], inner, self.vertices[last]])
        if grading == "1":
            share = np.linspace(0, 1, cells + 1)
        else:
            parts = re.findall(r"\(([^()]*)\)", grading)
            lengths = np.array([float(p.split()[0]) for p in parts])
            assert len(parts) == cells
            share = np.concatenate([[0], np.cumsum(lengths / lengths.sum())])
        at = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        if at[-1] > 0:
            at /= at[-1]
            points = np.stack([np.interp(share, at, line[:, k]) for k in range(3)], -1)
        else:
            points = np.repeat(line[:1], cells + 1, axis=0)
        return points, share

    def points(self, block):
        """The points of a block: edges weighted as in OpenFOAM's blockCreate.C."""
        corners, _, cells, gradings = block
        ni, nj, nk = cells
        pairs = [*((0, 1), (3, 2), (7, 6), (4, 5)), *((0, 3), (1, 2), (5, 6), (4, 7))]
        pairs += [(0, 4), (1, 5), (2, 6), (3, 7)]
        edges = [
            self.along(corners[a], corners[b], cells[e // 4], gradings[e])
            for e, (a, b) in enumerate(pairs)
        ]
        p = self.vertices[corners]
        i, j, k = np.meshgrid(*(np.arange(n + 1) for n in (ni, nj, nk)), indexing="ij")
        w = [share for _, share in edges]
        x, y, z = (
            np.stack([w[4 * axis + e][index] for e in range(4)])
            for axis, index in enumerate((i, j, k))
        )
        # Weights of the four edges along each axis from the two others.
        wx = np.stack([
            (1 - x[0]) * (1 - y[0]) * (1 - z[0]) + x[0] * (1 - y[1]) * (1 - z[1]),
            (1 - x[1]) * y[0] * (1 - z[3]) + x[1] * y[1] * (1 - z[2]),
            (1 - x[2]) * y[3] * z[3] + x[2] * y[2] * z[2],
            (1 - x[3]) * (1 - y[3]) * z[0] + x[3] * (1 - y[2]) * z[1],
        ])  # fmt: skip
        wy = np.stack([
            (1 - y[0]) * (1 - x[0]) * (1 - z[0]) + y[0] * (1 - x[1]) * (1 - z[3]),
            (1 - y[1]) * x[0] * (1 - z[1]) + y[1] * x[1] * (1 - z[2]),
            (1 - y[2]) * x[3] * z[1] + y[2] * x[2] * z[2],
            (1 - y[3]) * (1 - x[3]) * z[0] + y[3] * (1 - x[2]) * z[3],
        ])  # fmt: skip
        wz = np.stack([
            (1 - z[0]) * (1 - x[0]) * (1 - y[0]) + z[0] * (1 - x[3]) * (1 - y[3]),
            (1 - z[1]) * x[0] * (1 - y[1]) + z[1] * x[3] * (1 - y[2]),
            (1 - z[2]) * x[1] * y[1] + z[2] * x[2] * y[2],
            (1 - z[3]) * (1 - x[1]) * y[0] + z[3] * (1 - x[2]) * y[3],
        ])  # fmt: skip
        out = np.zeros((ni + 1, nj + 1, nk + 1, 3))
        for axis, (weights, index) in enumerate(zip((wx, wy, wz), (i, j, k), strict=True)):
            weights = weights / weights.sum(axis=0)
            for e in range(4):
                a, b = pairs[4 * axis + e]
                line, share = edges[4 * axis + e]
                straight = p[a] + share[:, None] * (p[b] - p[a])
                out += weights[e][..., None] * (line - straight)[index]
                out += weights[e][..., None] * straight[index] / 3
        return out


def test_block_mesh_dict_read_back(blocks):
    read = BlockMeshDict(blockmesh.write(blocks).decode())
    parts = blockmesh.cut(blocks)
    assert len(read.blocks) == len(parts) == 18
    # Each face of the boundary is a face of one block; every other face is one of two.
    faces: dict[frozenset[int], int] = {}
    sides = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]
    for corners, *_ in read.blocks:
        for side in sides:
            face = frozenset(corners[k] for k in side)
            if len(face) > 2:
                faces[face] = faces.get(face, 0) + 1
    outer = [frozenset(f) for _, patch in read.boundary.values() for f in patch]
    assert len(outer) == len(set(outer))
    assert {face for face, n in faces.items() if n == 1} == set(outer)
    assert max(faces.values()) == 2
    kinds = {name: kind for name, (kind, _) in read.boundary.items()}
    assert kinds["ship.wing"] == "wall" and kinds["above.v0"] == "symmetryPlane"

    worst = volume = 0.0
    for part, block in zip(parts, read.blocks, strict=True):
        own = blocks.blocks[part.block]
        grid = own.points[tuple(slice(a, b + 1) for a, b in zip(part.begin, part.end, strict=True))]
        points = read.points(block)
        assert points.shape == grid.shape
        # The edges are those of the grid.
        for a, b in itertools.product((0, -1), repeat=2):
            for edge in (np.s_[:, a, b], np.s_[a, :, b], np.s_[a, b, :]):
                assert np.abs(points[edge] - grid[edge]).max() < 1e-12
        worst = max(worst, float(np.abs(points - grid).max()))
        volume += pyvista.StructuredGrid(*points.transpose(3, 0, 1, 2)).volume
    # blockMesh puts points between edges, not on the hull: whole blocks are off by some percent.
    assert worst < 0.3
    assert volume == pytest.approx(blocks.volume, rel=5e-2)


def _off(blocks: moldloft.Blocks, every: int) -> tuple[float, float]:
    """How far what blockMesh makes is from the grid, and its volume from the grid's."""
    read = BlockMeshDict(blockmesh.write(blocks, every).decode())
    parts = blockmesh.cut(blocks, every)
    worst = volume = 0.0
    for part, block in zip(parts, read.blocks, strict=True):
        own = blocks.blocks[part.block].points
        grid = own[tuple(slice(a, b + 1) for a, b in zip(part.begin, part.end, strict=True))]
        points = read.points(block)
        worst = max(worst, float(np.abs(points - grid).max()))
        volume += pyvista.StructuredGrid(*points.transpose(3, 0, 1, 2)).volume
    return worst, abs(volume - blocks.volume) / blocks.volume


def test_more_cuts_come_closer(blocks):
    (few, few_volume), (many, many_volume) = _off(blocks, 0), _off(blocks, 5)
    assert many < few / 4
    assert many_volume < min(few_volume / 4, 5e-3)


def test_folded_blocks_are_refused(tmp_path):
    model = moldloft.loads(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0);"
        "AbsPoint E(0, 0, -1); Line a(A, B); Line b(C, D); Line down(A, E);"
        "RuledSurf floor(a, b); TranSolid box(floor, down, divisions = {2, 2, 2});"
    )
    with pytest.raises(moldloft.Error, match="`box` has cells without positive volume"):
        model.blocks().write(tmp_path / "blockMeshDict")
    assert not list(tmp_path.iterdir())
    with pytest.raises(moldloft.Error, match="unknown volume format `step`"):
        model.blocks().write(tmp_path / "box.step")


def test_the_command_writes_them(cli, tmp_path):
    formats = ["volume-p3d", "volume-vts", "volume-vtu", "volume-cgns", "blockmesh"]
    cli("build", LAYERS, "--to", *formats, "-o", tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"layers.volume.p3d", "layers.volume.vtm", "layers.volume.cgns"} <= names
    assert {"layers.volume.vtu", "layers.blockMeshDict"} <= names
    assert (tmp_path / "layers.blockMeshDict").read_text().startswith("FoamFile")
    nothing = tmp_path / "none.sdl"
    nothing.write_text("AbsPoint a(0, 0, 0);")
    said = cli("build", nothing, "--to", "volume-p3d", "-o", tmp_path / "out", status=1)
    assert "the model has no solids" in said.stderr
    assert not (tmp_path / "out").exists()


def test_a_ring_is_cut_for_block_mesh():
    model = moldloft.loads(
        "AbsPoint a(1, 0, 0); AbsPoint o(0, 0, 0); AbsPoint b(0, 1, 0); AbsPoint c(3, 0, 0);"
        "AbsPoint d(0, 3, 0); AbsPoint z(0, 0, 2); Line up(o, z);"
        "Arc inner(a, o, b, type = 6); Arc outer(c, o, d, type = 6);"
        "RuledSurf disc(outer, inner); TranSolid tube(disc, up, divisions = {12, 2, 2});"
    )
    made = model.blocks()
    assert len(made.interfaces) == 1
    assert len(blockmesh.cut(made)) >= 3
    assert max(_off(made, 0)) < 1e-12
    assert max(_off(made, 1)) < 1e-12
