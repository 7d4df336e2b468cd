# ruff: noqa: E501 -- programs of one line
"""blockMeshDicts with graded edges, by a reader with blockMesh's formulas and, where it is installed, by blockMesh."""

from __future__ import annotations

import os
import random
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import moldloft
from test_grid_blocks import MAP, cut
from test_solver_meshes import run_openfoam
from test_volume_files import BlockMeshDict

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
SIDES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))

SECTIONS = """load "topologies.sdl"; load "naca.sdl"; curve lower[21], upper[21], c[41], d[61];
naca4l(lower, 0, 0, 12); naca4(upper, 0, 0, 12); c[1:21] = lower[21:1:-1]; c[21:41] = upper; naca4s(d, 4, 4, 10);
"""

#: Programs of several blocks: the call, and the boundaries that must be there.
PROGRAMS = {
    "blunt C": (
        'surface g[] = c_blocks(c, geometric(0, 5, 5e-3, 21), 5, 16); NAMES = {"j1 = wing wall, jn = far farfield, i1 im = out outflow", "im = out outflow, i1 = base wall"};',
        {"wing": "wall", "base": "wall", "far": "patch", "out": "patch", "frontAndBack": "empty"},
    ),
    "duct": (
        'surface w[33, 6]; curve r[33]; arc(r, 0, 2*PI, 1); r[33] = r[1]; for (j = 1:6) w[, j] = r*(1 + 0.05*j) + {0.02*j*j, 0, j/2}; block g[] = butterfly(w, 6, 0.02); string s = "k1 = in inflow, kn = out outflow"; NAMES = {s + ", j1 = wall wall", s + ", j1 = wall wall", s + ", j1 = wall wall", s + ", j1 = wall wall", s};',
        {"wall": "wall", "in": "patch", "out": "patch"},
    ),
}


def written(call: str) -> tuple[str, str]:
    """The dictionary with few blocks, and that with a block for each cell, whose vertices are the points."""
    text = SECTIONS + call.replace("NAMES", "string names[]")
    files = moldloft.loads(
        text + ' write_blockmesh("few", "graded", g, names); write_blockmesh("all", g, names);'
    ).written
    return files["few"].decode(), files["all"].decode()


def check(few: str, every: str) -> BlockMeshDict:
    """The edges have the points of the grid, cells and boundaries are those of the mesh."""
    read = BlockMeshDict(few)
    numbers = r"\(([-+.\deE]+) ([-+.\deE]+) ([-+.\deE]+)\)"
    points = np.array(
        re.findall(numbers, every.split("vertices")[1].split("blocks")[0]), dtype=float
    )
    known = {tuple(p) for p in np.round(points, 9).tolist()}
    size = np.ptp(points, axis=0).max()

    def on_grid(p: np.ndarray) -> None:
        for q in p.reshape(-1, 3):
            if tuple(np.round(q, 9).tolist()) not in known:
                assert np.linalg.norm(points - q, axis=1).min() < 1e-9 * size

    cells = 0
    outer: Counter[frozenset[int]] = Counter()
    for block in read.blocks:
        corners, _, counts, _ = block
        p = read.points(block)
        for axis in range(3):
            for a in (0, -1):
                for b in (0, -1):
                    at: list[int | slice] = [a, b]
                    at.insert(axis, slice(None))
                    on_grid(p[tuple(at)])
        cells += int(np.prod(counts))
        # Right-handed, at its first corner.
        steps = [p[1, 0, 0] - p[0, 0, 0], p[0, 1, 0] - p[0, 0, 0], p[0, 0, 1] - p[0, 0, 0]]
        assert np.linalg.det(np.array(steps)) > 0
        outer.update(frozenset(corners[k] for k in side) for side in SIDES)
    assert cells == every.count("\nhex ")
    assert len(read.blocks) < cells
    # A face is one of two blocks, or in one patch, or in none and then in the default one.
    assert max(outer.values()) <= 2
    free = {face for face, n in outer.items() if n == 1}
    named = [frozenset(face) for _, faces in read.boundary.values() for face in faces]
    assert len(named) == len(set(named)) and set(named) <= free
    return read


@pytest.mark.parametrize("name", PROGRAMS)
def test_topologies(name: str, tmp_path: Path) -> None:
    call, kinds = PROGRAMS[name]
    few, every = written(call)
    read = check(few, every)
    assert {patch: kind for patch, (kind, _) in read.boundary.items()} == kinds
    run(few, every, tmp_path)


def run(few: str, every: str, path: Path) -> None:
    """blockMesh makes as many points, cells and faces of each boundary as of the dictionary with all points."""
    counts, failed = [], []
    for name, text in (("few", few), ("all", every)):
        case = path / name
        (case / "system").mkdir(parents=True)
        (case / "system" / "blockMeshDict").write_text(text)
        said = run_openfoam("blockMesh", case)
        if said is None:
            return
        assert "FATAL" not in said and "End" in said, said[-2000:]
        mesh = case / "constant" / "polyMesh"
        boundary = dict(
            re.findall(r"(\w+)\s*\{[^}]*nFaces\s+(\d+);", (mesh / "boundary").read_text())
        )
        lists = re.search(r"nPoints: ?(\d+)\s+nCells: ?(\d+)", (mesh / "owner").read_text())
        assert lists
        counts.append((lists.groups(), {k: int(n) for k, n in boundary.items() if int(n)}))
        count = re.search(r"^(\d+)\s*\(", (mesh / "points").read_text(), re.MULTILINE)
        assert count and count[1] == lists[1]
        report = run_openfoam("checkMesh", case)
        assert report and "End" in report
        failed.append(set(re.findall(r"\*\*\*(\w+ \w+)", report)))
    # Between edges the points of few blocks are others, but no check fails that the grid itself passes.
    assert counts[0] == counts[1] and failed[0] <= failed[1] <= {"High aspect"}


@pytest.mark.parametrize("seed", range(200 if SOAK else 8))
def test_cut_blocks(seed: int, tmp_path: Path) -> None:
    text, count, *_ = cut(random.Random(seed))
    head, calls = text.split("write_su2", 1)
    arguments = calls[calls.index(", ") + 2 : calls.index(");")]
    files = moldloft.loads(
        head
        + f'write_blockmesh("few", "graded", {arguments}); write_blockmesh("all", {arguments});'
    ).written
    few, every = files["few"].decode(), files["all"].decode()
    read = check(few, every)
    assert sum(int(np.prod(block[2])) for block in read.blocks) == count
    if seed < 2 or SOAK:
        run(few, every, tmp_path)


def test_boxes_are_exact() -> None:
    """Between straight edges of equal gradings blockMesh's points are the grid's."""
    text = re.sub(r"return \{.*?\};", "return {u^2 + u, 2*v, w^3 + w};", MAP, count=1)
    files = moldloft.loads(
        text
        + 'block b[5,4,6]; fill(b, 0, 1, 0, 1, 0, 1, 1, 2, 3); write_blockmesh("few", "graded", b); block c = b;'
    )
    read = BlockMeshDict(files.written["few"].decode())
    assert len(read.blocks) == 1
    assert np.abs(read.points(read.blocks[0]) - np.asarray(files["c"])).max() < 1e-12


CASCADE = 'surface g[] = h_o_h(d, geometric(0, 0.08, 2e-3, 9), 0.8, 0.6, 0.8, 10, 8); string s = "j1 = low periodic, jn = high periodic", names[] = {"j1 = blade wall, jn = low periodic", "jn = high periodic", "i1 = inlet inflow, " + s, "im = outlet outflow, " + s};'


def test_cascades_are_cyclic(tmp_path: Path) -> None:
    """A block for each cell: blockMesh takes the faces of periodic boundaries in their order. Few blocks: refused."""
    text = SECTIONS + CASCADE
    with pytest.raises(moldloft.ModelError, match="no periodic boundary"):
        moldloft.loads(text + 'write_blockmesh("d", "graded", g, names);')
    content = moldloft.loads(text + 'write_blockmesh("d", g, names);').written["d"]
    (tmp_path / "system").mkdir()
    (tmp_path / "system" / "blockMeshDict").write_bytes(content)
    read = content.decode()
    points = np.array(re.findall(r"^\((\S+) (\S+) (\S+)\)$", read, re.MULTILINE), dtype=float)
    sides = []
    for name in ("low", "high"):
        faces = re.search(
            rf"^{name}\n\{{[^{{}}]*?faces\s*\((.*?)\);\s*\}}", read, re.MULTILINE | re.DOTALL
        )
        assert faces
        nodes = np.array(re.findall(r"\((\d+) (\d+) (\d+) (\d+)\)", faces[1]), dtype=int)
        sides.append(points[nodes].mean(axis=1))
    # Face by face, a pitch apart.
    assert (
        len(sides[0]) == len(sides[1]) and np.abs(sides[1] - sides[0] - [0, 0.8, 0]).max() < 1e-12
    )
    said = run_openfoam("blockMesh", tmp_path)
    if said is not None:
        assert "FATAL" not in said, said[-1500:]
        report = run_openfoam("checkMesh", tmp_path)
        assert report and "Mesh OK" in report, report[-1500:]


def test_a_wrong_word_is_refused() -> None:
    with pytest.raises(moldloft.ModelError, match="has no option"):
        moldloft.loads(
            MAP
            + 'block b[3,3,3]; fill(b, 0, 1, 0, 1, 0, 1, 1, 2, 3); write_blockmesh("d", "grades", b);'
        )
