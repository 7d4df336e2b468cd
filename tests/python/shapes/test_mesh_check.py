# ruff: noqa: E501 -- programs of one line
"""`report` of a block against a reader of its own: NumPy on the SU2 file, by the formulas of OpenFOAM's checkMesh.

The reader knows nothing of blocks: faces are found by their nodes, owners and neighbours by their order, and areas,
centres and volumes are summed face by face as OpenFOAM's `primitiveMesh` does it. It is checked itself by the figures
that checkMesh of OpenFOAM 1912 prints for single cells.
"""

from __future__ import annotations

import os
import random
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
# The faces of VTK's hexahedron, outwards.
FACES = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]


def read_su2(path: Path) -> tuple[np.ndarray, list[list[int]]]:
    """Points and hexahedra."""
    words = iter(path.read_text().split("\n"))
    points: list[list[float]] = []
    cells: list[list[int]] = []
    for line in words:
        key, _, count = line.partition("=")
        if key == "NELEM":
            for _ in range(int(count)):
                kind, *nodes = map(int, next(words).split())
                assert kind == 12
                cells.append(nodes[:8])
        elif key == "NPOIN":
            for _ in range(int(count.split()[0])):
                points.append([float(x) for x in next(words).split()[:3]])
    return np.array(points), cells


class PolyMesh:
    """Faces with their cells, and OpenFOAM's geometry of them."""

    def __init__(self, points: np.ndarray, cells: list[list[int]]) -> None:
        owners: dict[frozenset[int], list[tuple[int, tuple[int, ...]]]] = {}
        for c, cell in enumerate(cells):
            for face in FACES:
                nodes = tuple(cell[k] for k in face)
                owners.setdefault(frozenset(nodes), []).append((c, nodes))
        both = [sides for sides in owners.values() if len(sides) == 2]
        self.boundary = [sides[0] for sides in owners.values() if len(sides) == 1]
        assert len(both) + len(self.boundary) == len(owners)
        inner = [(min(sides)[0], max(sides)[0], min(sides)[1]) for sides in both]
        nodes = [n for *_, n in inner] + [n for _, n in self.boundary]
        self.points, self.nodes = points, np.array(nodes)
        self.owner = np.array([o for o, *_ in inner] + [o for o, _ in self.boundary])
        self.neighbour = np.array([n for _, n, _ in inner], dtype=int)
        self.n = len(cells)
        corner = points[self.nodes]
        middle = corner.mean(axis=1)
        turned = np.roll(corner, -1, axis=1)
        triangle = np.cross(turned - corner, middle[:, None] - corner)
        size = np.linalg.norm(triangle, axis=-1)
        self.area = triangle.sum(axis=1) / 2
        self.flatness = np.linalg.norm(triangle.sum(axis=1), axis=-1) / size.sum(axis=1)
        thirds = (corner + turned + middle[:, None]) / 3
        self.centre = (thirds * size[..., None]).sum(axis=1) / size.sum(axis=1)[:, None]
        self.corner = corner
        # Cells: about the mean of the face centres, then by pyramids.
        count, rough = np.zeros(self.n), np.zeros((self.n, 3))
        for cell, sign, which in self.sides():
            del sign
            np.add.at(count, cell, 1)
            np.add.at(rough, cell, self.centre[which])
        rough /= count[:, None]
        self.volume, self.cell = np.zeros(self.n), np.zeros((self.n, 3))
        for cell, sign, which in self.sides():
            pyramid = (
                sign * np.einsum("ij,ij->i", self.area[which], self.centre[which] - rough[cell]) / 3
            )
            middle = 0.75 * self.centre[which] + 0.25 * rough[cell]
            np.add.at(self.volume, cell, pyramid)
            np.add.at(self.cell, cell, pyramid[:, None] * middle)
        self.cell /= self.volume[:, None]

    def sides(self) -> list[tuple[np.ndarray, int, slice]]:
        inner = slice(0, len(self.neighbour))
        return [(self.owner, 1, slice(None)), (self.neighbour, -1, inner)]

    def figures(self) -> dict[str, float]:
        """The figures of checkMesh by the words of `report`."""
        inner = slice(0, len(self.neighbour))
        own, other = self.cell[self.owner[inner]], self.cell[self.neighbour]
        area, d = self.area[inner], other - own
        dot = lambda a, b: np.einsum("ij,ij->i", a, b)  # noqa: E731
        norm = lambda a: np.linalg.norm(a, axis=1)  # noqa: E731
        cosine = np.clip(dot(d, area) / (norm(d) * norm(area)), -1, 1)
        angle = np.degrees(np.arccos(cosine))
        # Skewness: of inner faces along the line of centres, of the boundary along the normal.
        unit = self.area / norm(self.area)[:, None]
        q = self.centre - self.cell[self.owner]
        line = unit * dot(unit, q)[:, None]
        line[inner] = d
        share = np.full(len(line), 0.4)
        share[inner] = 0.2
        miss = q - line * (dot(self.area, q) / dot(self.area, line))[:, None]
        length = norm(miss)
        some = length > 0
        way = np.divide(miss, length[:, None], out=np.zeros_like(miss), where=some[:, None])
        reach = np.abs(np.einsum("ij,ikj->ik", way, self.corner - self.centre[:, None])).max(axis=1)
        skew = length / np.maximum(share * norm(line), reach)
        spread = np.zeros((self.n, 3))
        for cell, _, which in self.sides():
            np.add.at(spread, cell, np.abs(self.area[which]))
        aspect = np.maximum(
            spread.max(axis=1) / spread.min(axis=1),
            spread.sum(axis=1) / (6 * np.abs(self.volume) ** (2 / 3)),
        )
        near = [
            np.abs(dot(area, self.centre[inner] - own)),
            np.abs(dot(area, other - self.centre[inner])),
        ]
        volumes = np.array([self.volume[self.owner[inner]], self.volume[self.neighbour]])
        return {
            "non-orthogonality, greatest": angle.max(initial=0),
            # The angle of the mean cosine, which checkMesh calls the average.
            "non-orthogonality, mean": np.degrees(np.arccos(cosine.mean())) if len(angle) else 0.0,
            "skewness, greatest": skew.max(),
            "aspect ratio, greatest": aspect.max(),
            "face weight, least": (np.minimum(*near) / np.add(*near)).min(initial=0.5),
            "volume ratio, least": (volumes.min(axis=0) / volumes.max(axis=0)).min(initial=1),
            "face flatness, least": self.flatness.min(),
        }


CUBE = np.array(
    [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float
)
# What checkMesh of OpenFOAM 1912 says of them: non-orthogonality, skewness, aspect, weight, volume ratio.
KNOWN = [
    (
        "box",
        {1: (10, 0, 0), 2: (10, 1, 0), 5: (10, 0, 1), 6: (10, 1, 1)},
        None,
        (None, 0, 10, None, None),
    ),
    (
        "sheared",
        {k: tuple(CUBE[k] + (1, 0, 0)) for k in range(4, 8)},
        None,
        (None, 1, 2, None, None),
    ),
    ("turned over", {6: (0.4, 0.4, 0.4)}, None, (None, 0.864073045, 1.489675038, None, None)),
    ("two", {}, {}, (0, 0, 1, 0.5, 1)),
    (
        "far face moved",
        {},
        {k: tuple(CUBE[k] + (1, 1, 0)) for k in (1, 2, 5, 6)},
        (26.56505118, 1, 2, 0.5, 1),
    ),
    (
        "leaning",
        {k: (1.5, 1, CUBE[k][2]) for k in (2, 6)},
        {},
        (21.37062227, 0.555555556, 1.5, 0.380434783, 0.6),
    ),
    (
        "one vertex",
        {6: (1.4, 1.4, 1.4)},
        {},
        (8.694979802, 0.173341211, 1.188686194, 0.460837918, 0.846153846),
    ),
]


@pytest.mark.parametrize(
    ("first", "second", "want"), [k[1:] for k in KNOWN], ids=[k[0] for k in KNOWN]
)
def test_the_reader_has_the_figures_of_checkmesh(
    first: dict[int, tuple[float, ...]],
    second: dict[int, tuple[float, ...]] | None,
    want: tuple[float | None, ...],
) -> None:
    points = list(CUBE)
    for k, p in first.items():
        points[k] = np.array(p)
    cells = [list(range(8))]
    if second is not None:
        # The second cube stands behind face x = 1 of the first.
        far = [8 + k for k in range(4)]
        for k in (1, 2, 5, 6):
            points.append(np.array(second.get(k, tuple(CUBE[k] + (1, 0, 0)))))
        cells.append([1, far[0], far[1], 2, 5, far[2], far[3], 6])
    found = PolyMesh(np.array(points), cells).figures()
    names = (
        "non-orthogonality, greatest",
        "skewness, greatest",
        "aspect ratio, greatest",
        "face weight, least",
        "volume ratio, least",
    )
    for name, value in zip(names, want, strict=True):
        if value is not None:
            assert found[name] == pytest.approx(value, abs=5e-9), name


def bent(rng: random.Random) -> str:
    """A block of an ordinary kind: a bent and graded box, a bend, layers off a wavy wall, an aerofoil's."""
    size = [rng.randint(3, 7) for _ in range(3)]
    s = "block b[{},{},{}];".format(*size)
    grade = [round(rng.uniform(1.0, 1.6), 3) for _ in range(3)]
    move = [round(rng.uniform(-0.12, 0.12), 4) for _ in range(6)]
    u = [
        f"({g if g != 1 else 1.01}^({n} - 1) - 1)/({g if g != 1 else 1.01}^({e} - 1) - 1)"
        for g, n, e in zip(grade, "ijk", size, strict=True)
    ]
    head = f"for (i = 1:{size[0]}) for (j = 1:{size[1]}) for (k = 1:{size[2]}) {{ float u = {u[0]}, v = {u[1]}, w = {u[2]};"
    kind = rng.randrange(3)
    if kind == 0:
        x = [
            f"{a} + {move[n]}*sin(5*{b}) + {move[n + 3]}*{c}^2"
            for n, (a, b, c) in enumerate(("uvw", "vwu", "wuv"))
        ]
        size_of = [round(rng.uniform(0.3, 5), 2) for _ in range(3)]
        x = [f"{a}*({e})" for a, e in zip(size_of, x, strict=True)]
        body = f"b[i,j,k] = {{{', '.join(x)}}};"
    elif kind == 1:
        turn, long = round(rng.uniform(0.2, 1.4), 3), round(rng.uniform(0.5, 3), 2)
        body = f"b[i,j,k] = {{(1 + v)*sin({turn}*u), {long}*w + {move[0]}*u*v, (1 + v)*cos({turn}*u)}};"
    else:
        body = f"b[i,j,k] = {{2*u, v + {move[1]}*cos(4*u), w + (1 - w)*{abs(move[2])}*sin(6*u)*sin(4*v)}};"
    return f'{s} {head} {body} }} print report(b); write_su2("a.su2", b);'


def compared(text: str, folder: Path) -> None:
    m = moldloft.loads(text)
    assert not [d for d in m.diagnostics if d.severity == "error"], (text, m.diagnostics)
    lines = "\n".join(m.printed).splitlines()
    file = folder / "a.su2"
    file.write_bytes(m.written["a.su2"])
    found = PolyMesh(*read_su2(file)).figures()
    for name, value in found.items():
        (line,) = (x for x in lines if x.startswith(name))
        told = float(line[len(name) :])
        assert told == pytest.approx(value, rel=1e-6, abs=6e-7), (name, told, value, text)


@pytest.mark.parametrize("seed", range(300 if SOAK else 25))
def test_the_report_is_that_of_an_independent_reader(seed: int, tmp_path: Path) -> None:
    compared(bent(random.Random(seed)), tmp_path)


MARCHED = [
    "surface s[9,9]; for (i = 1:9) for (j = 1:9) s[i,j] = {i, j, .3*sin(i)*cos(j)}; block b = hyperbolic(s, geometric(0, 3, .05, 12));",
    "surface s[9,9]; for (i = 1:9) for (j = 1:9) s[i,j] = {i, j, max(0, i - 5)*.7}; block b = hyperbolic(s, geometric(0, 2, .1, 9));",
]


@pytest.mark.parametrize("program", MARCHED)
def test_marched_blocks_as_well(program: str, tmp_path: Path) -> None:
    compared(program + ' print report(b); write_su2("a.su2", b);', tmp_path)


def test_pairs_are_of_neighbours() -> None:
    # The reader itself: two cells of unlike volumes have one face between them.
    points = np.array([(x, y, z) for x in (0, 1, 3) for y in (0, 1) for z in (0, 1)], dtype=float)
    at = lambda i, j, k: 4 * i + 2 * j + k  # noqa: E731
    cells = [
        [
            at(a, 0, 0),
            at(b, 0, 0),
            at(b, 1, 0),
            at(a, 1, 0),
            at(a, 0, 1),
            at(b, 0, 1),
            at(b, 1, 1),
            at(a, 1, 1),
        ]
        for a, b in pairwise(range(3))
    ]
    mesh = PolyMesh(points, cells)
    assert len(mesh.neighbour) == 1 and mesh.volume == pytest.approx([1, 2])
