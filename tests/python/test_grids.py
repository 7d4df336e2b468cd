"""Grids of points in files."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from moldloft import grids
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
    files = grids.write_vts(tmp_path / "two.vts", [body(), body()])
    assert [f.suffix for f in files] == [".vtm", ".vts", ".vts"]
    (one,) = grids.write_vts(tmp_path / "one.vts", [body()])
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
