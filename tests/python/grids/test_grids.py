"""Grids of points in files."""

from __future__ import annotations

import itertools
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import grids
from moldloft.cli import main
from moldloft.errors import Error, FileError
from moldloft.grids import Plot3DVariant


def body(three: bool = True) -> np.ndarray:
    u, a = np.linspace(0, 1, 60)[:, None], np.linspace(0, np.pi, 20)[None, :]
    r = 0.5 * np.sqrt(u)
    x, y, z = 3 * u + 0 * a, r * np.cos(a), r * np.sin(a)
    return np.stack([x, y, z if three else 0 * z], axis=-1)


# Text has neither precision nor byte order.
VARIANTS = [
    variant
    for variant in itertools.product(("text", "stream", "records"), *[(True, False)] * 5)
    if variant[0] != "text" or (variant[1] and not variant[4])
]


@pytest.mark.parametrize(
    ("layout", "double", "multi", "three", "big", "blank"),
    VARIANTS,
)
def test_plot3d_comes_back(
    tmp_path: Path, layout: str, double: bool, multi: bool, three: bool, big: bool, blank: bool
) -> None:
    given = [body(three), body(three)[:7]] if multi else [body(three)]
    if not double:
        given = [grid.astype(np.float32).astype(float) for grid in given]
    blanks = [np.arange(g.size // 3).reshape(g.shape[:2]) % 3 for g in given] if blank else None
    variant = Plot3DVariant(layout, double, multi, three, big)
    path = grids.write_plot3d(tmp_path / "body.p3d", given, variant, iblank=blanks)
    back, found, holes = grids.read_plot3d(path)
    assert found == variant
    for a, b in zip(given, back, strict=True):
        assert np.array_equal(a + 0.0, b)
    if blanks is None:
        assert holes is None
    else:
        assert holes is not None
        assert all(np.array_equal(a, b) for a, b in zip(blanks, holes, strict=True))


def test_sizes_of_files(tmp_path: Path) -> None:
    def size(**changes: object) -> int:
        path = grids.write_plot3d(tmp_path / "b", [body()], Plot3DVariant(**changes))  # type: ignore[arg-type]
        return path.stat().st_size

    assert size() == 28816
    assert size(layout="records") == 28840
    assert size(layout="records", multi=False) == 28828
    path = grids.write_plot3d(tmp_path / "c", [body()], iblank=[np.ones((60, 20))])
    assert path.stat().st_size == 28816 + 4800
    assert grids.write_stl(tmp_path / "b.stl", [body()]).stat().st_size == 111234


def test_refusals(tmp_path: Path) -> None:
    with pytest.raises(Error, match="several blocks in a single-block file"):
        grids.write_plot3d(tmp_path / "x", [body(), body()], Plot3DVariant(multi=False))
    with pytest.raises(Error, match="shape"):
        grids.write_plot3d(tmp_path / "x", [np.zeros((3, 4))])
    with pytest.raises(Error, match="layout"):
        grids.write_plot3d(tmp_path / "x", [body()], Plot3DVariant(layout="hdf"))
    with pytest.raises(Error, match="blanking"):
        grids.write_plot3d(tmp_path / "x", [body()], iblank=[np.ones(3)])
    assert list(tmp_path.iterdir()) == []
    path = grids.write_plot3d(tmp_path / "cut.p3d", [body()])
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(FileError, match=r"cut\.p3d.*28800 bytes of coordinates.*28791 bytes"):
        grids.read_plot3d(path)
    with pytest.raises(FileError, match="no such file"):
        grids.read_plot3d(tmp_path / "nothing")


def test_vts_and_points(tmp_path: Path) -> None:
    files = grids.write(tmp_path / "two.vts", [body(), body()], names=["hull", "fin"])
    assert [f.name for f in files] == ["two.vtm", "two-1-hull.vts", "two-2-fin.vts"]
    (one,) = grids.write(tmp_path / "one.vts", [body()])
    assert b'WholeExtent="0 59 0 19 0 0"' in one.read_bytes()
    points = body()[:, 3]
    path = grids.write_csv(tmp_path / "line.csv", points)
    assert np.array_equal(grids.read_points(path), points + 0.0)
    path.write_text("x y\n1 2\n3\n")
    with pytest.raises(FileError, match="line 3"):
        grids.read_points(path)


def test_aerofoils(tmp_path: Path) -> None:
    path = tmp_path / "wedge.dat"
    path.write_text("WEDGE\n1 0\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n")
    wedge = grids.read_aerofoil(path)
    assert (wedge.name, wedge.nose, wedge.listing) == ("WEDGE", 2, "selig")
    assert wedge.upper.tolist() == [[0, 0], [0.5, 0.1], [1, 0]]
    assert wedge.lower.tolist() == [[0, 0], [0.5, -0.1], [1, 0]]
    path.write_text("WEDGE\n3. 3.\n\n0 0\n0.5 0.1\n1 0\n\n0 0\n0.5 -0.1\n1 0\n")
    other = grids.read_aerofoil(path)
    assert other.listing == "lednicer"
    assert np.array_equal(other.points, wedge.points)


def nodes(group: object, label: str) -> dict[str, object]:
    """The children of a CGNS node with a label."""
    kinds = {k: g.attrs["label"].decode() for k, g in group.items() if "label" in g.attrs}  # type: ignore[attr-defined]
    return {k: group[k] for k, kind in kinds.items() if kind == label}  # type: ignore[index]


def check_cgns(path: Path, given: dict[str, np.ndarray]) -> list[tuple[str, str]]:
    """Coordinates come back, interfaces join equal points; the pairs of zones that are joined."""
    h5py = pytest.importorskip("h5py")
    joined = []
    with h5py.File(path) as file:
        (base,) = nodes(file, "CGNSBase_t").values()
        assert base[" data"][:].tolist() == [2, 3]
        zones = nodes(base, "Zone_t")
        assert list(zones) == [f"Z_{name}" for name in given]

        def points(zone: str) -> np.ndarray:
            grid = zones[zone]["GridCoordinates"]
            return np.stack([grid[f"Coordinate{c}"][" data"][:].T for c in "XYZ"], axis=-1)

        for name, grid in given.items():
            ni, nj = grid.shape[:2]
            sizes = zones[f"Z_{name}"][" data"][:].tolist()
            assert sizes == [[ni, nj], [ni - 1, nj - 1], [0, 0]]
            assert np.array_equal(points(f"Z_{name}"), grid + 0.0)
        for name, zone in zones.items():
            grid = points(name)
            ni, nj = grid.shape[:2]
            covered: dict[tuple[tuple[int, ...], ...], int] = {}
            for group, label in (
                ("ZoneGridConnectivity", "GridConnectivity1to1_t"),
                ("ZoneBC", "BC_t"),
            ):
                for one in nodes(zone.get(group, {}), label).values():
                    (a, b), (c, d) = one["PointRange"][" data"][:] - 1
                    assert a <= c and b <= d
                    line = [(i, j) for i in range(a, c + 1) for j in range(b, d + 1)]
                    for pair in pairwise(line):
                        covered[pair] = covered.get(pair, 0) + 1
            rim = [((i, j), (i + 1, j)) for j in (0, nj - 1) for i in range(ni - 1)]
            rim += [((i, j), (i, j + 1)) for i in (0, ni - 1) for j in range(nj - 1)]
            # Every edge of a cell at the rim is covered once; poles are not.
            wanted = {e: 1 for e in rim if np.abs(grid[e[0]] - grid[e[1]]).max() > 1e-9}
            assert covered == wanted
            for one in nodes(
                zone.get("ZoneGridConnectivity", {}), "GridConnectivity1to1_t"
            ).values():
                donor = bytes(one[" data"][:].tobytes()).decode().rstrip("\0")
                here, there = one["PointRange"][" data"][:], one["PointRangeDonor"][" data"][:]
                run = [
                    np.rint(np.linspace(a, b, np.abs(b - a).max() + 1)).astype(int) - 1
                    for a, b in ((here[0], here[1]), (there[0], there[1]))
                ]
                p, q = points(name)[tuple(run[0].T)], points(donor)[tuple(run[1].T)]
                assert np.abs(p - q).max() <= 1e-9 * 4
                joined.append((name, donor))
    return joined


def test_cgns_of_arrays(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    upper, lower = body()[:, :10], body()[::-1, 9:] + 1e-12
    path = grids.write_cgns(tmp_path / "b.cgns", [upper, lower], ["upper", "lower"])
    joined = check_cgns(path, {"upper": upper, "lower": lower})
    assert joined == [("Z_upper", "Z_lower"), ("Z_lower", "Z_upper")]
    # An edge that meets a shorter one is free beside it.
    strip = np.stack(np.meshgrid(np.arange(7.0), np.arange(3.0), [0.0], indexing="ij"), -1)[:, :, 0]
    short = strip[2:5] + np.array([0, 2, 0])
    path = grids.write_cgns(tmp_path / "part.cgns", [strip, short], ["strip", "short"])
    check_cgns(path, {"strip": strip, "short": short})
    # A closed grid meets itself, its poles meet nothing.
    turn = np.linspace(0, 2 * np.pi, 9)
    along = np.linspace(0, np.pi, 5)[:, None]
    ball = np.stack(
        [np.cos(along) + 0 * turn, np.sin(along) * np.cos(turn), np.sin(along) * np.sin(turn)], -1
    )
    path = grids.write_cgns(tmp_path / "ball.cgns", [ball])
    assert check_cgns(path, {"grid1": ball}) == [("Z_grid1", "Z_grid1")] * 2
    for bad, match in [
        ([], "no structured grid"),
        ([np.zeros((3, 1, 3))], "two lines"),
        ([np.full((2, 2, 3), np.nan)], "finite"),
    ]:
        with pytest.raises(Error, match=match):
            grids.write_cgns(tmp_path / "bad.cgns", bad)
    with pytest.raises(Error, match="names"):
        grids.write_cgns(tmp_path / "bad.cgns", [ball], ["a", "b"])


PROGRAM = """load "stdsubs.sdl"
surface lower[4,3], upper[4,3];
for (j = 1:3) {
    lower[,j] = {uniform(0, 3, 4), j*uniform(1, 1, 4), uniform(0, 0, 4)};
    upper[,j] = {uniform(0, 3, 4), (2 + j)*uniform(1, 1, 4), uniform(0, 1, 4)*(j - 1)};
}
surface nose[3,3];
for (j = 1:3) nose[,j] = {{0, 0, 0}, {1, j - 2, 0}, {2, 2*j - 4, 1}};
"""


def test_a_program_writes_every_format(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    program = tmp_path / "p.sdl"
    calls = """
write_p3d("plain.x", lower, upper);
write_p3d("odd.x", "records single big 2d mark8", lower);
write_p3d("holes.x", "text single-block", lower, {{1, 0, 1}, {1, 1, 1}, {1, 1, 1}, {0, 1, 1}}.x*0);
write_vts("two.vts", lower, upper);
write_vts("out/one.vts", lower);
write_stl("nose.stl", nose);
write_stl("turned.stl", "flip", nose);
write_cgns("both.cgns", lower, upper);
write_csv("edge.csv", lower[,1], upper[4,]);
surface back = read_p3d("plain.x", 2);
assert max(|back - upper|) == 0;
curve edge = read_points("edge.csv");
assert edge.d1 == 7 and max(|edge[1:4] - lower[,1]|) == 0;
"""
    calls = calls.replace("{{1, 0, 1}, {1, 1, 1}, {1, 1, 1}, {0, 1, 1}}.x*0", "lower.z")
    program.write_text(PROGRAM + calls)
    out = tmp_path / "out"
    assert main(["run", str(program), "-o", str(out)]) == 0
    m = moldloft.load(program)
    lower, upper, nose = (np.asarray(m[name]) for name in ("lower", "upper", "nose"))
    blocks, found, _ = grids.read_plot3d(out / "plain.x")
    assert found == Plot3DVariant()
    assert np.array_equal(blocks[0], lower) and np.array_equal(blocks[1], upper)
    blocks, found, _ = grids.read_plot3d(out / "odd.x")
    assert found == Plot3DVariant("records", False, True, False, True, 8)
    assert np.array_equal(blocks[0], lower)
    _, found, holes = grids.read_plot3d(out / "holes.x")
    assert (found.layout, found.multi) == ("text", False)
    assert holes is not None and not holes[0].any()
    assert (out / "two.vtm").exists() and (out / "out" / "one.vts").exists()
    # Four quads, two triangles each, less the two at the pole.
    assert (out / "nose.stl").stat().st_size == 84 + 50 * 6
    joined = check_cgns(out / "both.cgns", {"lower": lower, "upper": upper})
    assert joined == [("Z_lower", "Z_upper"), ("Z_upper", "Z_lower")]
    assert np.array_equal(grids.read_points(out / "edge.csv")[4:], upper[3])
    meshio = pytest.importorskip("meshio")
    facets = [meshio.read(out / name) for name in ("nose.stl", "turned.stl")]
    for mesh, sign in zip(facets, (1, -1), strict=True):
        a, b, c = (mesh.points[mesh.cells_dict["triangle"][:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        assert (area > 0).all()
        # r_i x r_j of a nose that opens forward along y points along z.
        assert (sign * np.cross(b - a, c - a)[:, 2] > 0).all()
    # The same from the command, for all surfaces of the program.
    assert main(["run", str(program), "-o", str(out), "--to", "cgns", "p3d", "stl", "vts"]) == 0
    check_cgns(out / "p.cgns", {"lower": lower, "upper": upper, "nose": nose, "back": upper})


@pytest.mark.parametrize(
    ("call", "match"),
    [
        ('write_p3d("a.x", "purple", lower);', "no variant"),
        ('write_p3d("a.x", "single-block", lower, upper);', "single-block"),
        ('write_p3d("a.x", "2d", upper);', "2-D"),
        ('write_p3d("a.x", lower, upper.z);', "whole number"),
        ('write_p3d("a.x");', "needs `s`"),
        ('write_p3d("a.x", "text");', "nothing to write"),
        ('write_p3d("../a.x", lower);', "outside-folder"),
        ('write_stl("/a.stl", lower);', "outside-folder"),
        ('write_stl("a.stl", "upside", lower);', 'no option "upside"'),
        ('write_stl("a.stl", lower[1,]);', "grids"),
        ('write_cgns("a.cgns", lower[1,]);', "no cells"),
        ('write_vts("a.vts", 3);', "found a number"),
        ('write_csv("a.csv", lower/0);', "finite"),
        ('write_p3d("a.x", lower); surface q = read_p3d("a.x", 2);', "no block 2"),
        ('curve q = read_points("none.csv");', "none.csv"),
        ('curve q = read_aerofoil("../secret.dat");', "cannot read|outside"),
    ],
)
def test_a_program_writes_wrongly(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], call: str, match: str
) -> None:
    program = tmp_path / "p.sdl"
    program.write_text(PROGRAM + call)
    assert main(["run", str(program), "-o", str(tmp_path / "out")]) == 1
    import re

    assert re.search(match, capsys.readouterr().err)
    assert not (tmp_path / "out").exists()
