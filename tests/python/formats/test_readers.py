"""Every command that takes points or grids takes every variant that any reader of ours knows."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import grids
from moldloft.cli import main
from moldloft.errors import FairingError, FileError
from moldloft.fairing import files
from moldloft.grids import Plot3DVariant

RNG = np.random.default_rng(1)
BLOCKS = [RNG.normal(size=(7, 6, 3)) + 10, RNG.normal(size=(6, 9, 3))]


def variants() -> list[tuple[Plot3DVariant, bool]]:
    """Every variant that the writer takes, with and without blanking."""
    found = []
    both = (True, False)
    for layout, double, multi, three, big, mark, blank in itertools.product(
        ("text", "stream", "records"), both, both, both, both, (4, 8), both
    ):
        if layout == "text" and (big or mark == 8 or not double):
            continue
        if layout == "stream" and mark == 8:
            continue
        found.append((Plot3DVariant(layout, double, multi, three, big, mark), blank))
    return found


def written(path: Path, variant: Plot3DVariant, blank: bool) -> list[np.ndarray]:
    """A file of that variant, and its grids as they can be read back."""
    given = [b.copy() for b in (BLOCKS if variant.multi else BLOCKS[:1])]
    if not variant.three:
        for grid in given:
            grid[..., 2] = 0
    if variant.layout != "text" and not variant.double:
        given = [g.astype(np.float32).astype(np.float64) for g in given]
    holes = [np.arange(g[..., 0].size).reshape(g.shape[:2]) % 2 for g in given] if blank else None
    grids.write_plot3d(path, given, variant, iblank=holes)
    return given


def test_every_variant_of_plot3d_is_faired(tmp_path: Path) -> None:
    path, out = tmp_path / "a.p3d", tmp_path / "b.p3d"
    tried = 0
    for variant, blank in variants():
        given = written(path, variant, blank)
        read = grids.read_plot3d(path)
        faired = files.read_grids(path)
        assert faired.variant == read[1], variant
        for a, b, c in zip(given, read[0], faired.grids, strict=True):
            assert np.array_equal(a, b) and np.array_equal(a, c), variant
        assert (faired.iblank is not None) == blank
        # Out again: the same variant, in double precision.
        faired.write(out, faired.grids)
        again = files.read_grids(out)
        assert (again.layout, again.variant.big_endian) == (variant.layout, variant.big_endian)
        assert again.variant.double and (again.iblank is not None) == blank
        assert all(np.array_equal(a, b) for a, b in zip(given, again.grids, strict=True))
        tried += 1
    assert tried == 104


@pytest.mark.parametrize("layout", ["text", "records"])
def test_the_command_and_a_program_read_what_the_library_does(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], layout: str
) -> None:
    path = tmp_path / "a.x"
    i, j = np.meshgrid(np.arange(8.0), np.arange(7.0), indexing="ij")
    grid = np.stack([i, j, 0 * i], axis=-1)
    variant = Plot3DVariant(layout, multi=False, three=False, big_endian=layout != "text")
    grids.write_plot3d(path, [grid], variant, iblank=[np.ones((8, 7))])
    assert main(["fair", str(path), "--tol", "0.1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["points"] == [8, 7]
    program = tmp_path / "p.sdl"
    program.write_text('surface s = read_p3d("a.x");')
    assert np.array_equal(moldloft.load(program)["s"], grid)


TABLES = {
    "commas": "x,y\n{0[0]},{0[1]}\n{1[0]},{1[1]}\n",
    "trailing commas": "{0[0]},{0[1]},\n{1[0]},{1[1]},\n",
    "a title with a number": "NACA 0012\n{0[0]} {0[1]}\n{1[0]} {1[1]}\n",
    "comments": "# one\n{0[0]} {0[1]} # two\n\n{1[0]} {1[1]}\n",
    "mixed": "{0[0]}; {0[1]}\n{1[0]}\t{1[1]}\n",
    "old ends of lines": "{0[0]} {0[1]}\r{1[0]} {1[1]}\r",
    "Fortran": " {0[0]}D0, {0[1]}d0\n {1[0]}D0, {1[1]}d0\n",
}


@pytest.mark.parametrize("name", TABLES)
def test_all_readers_of_points_agree(tmp_path: Path, name: str) -> None:
    rows = np.array([[0.25, -1.5], [0.125, 2.0]])
    path = tmp_path / "t.txt"
    path.write_bytes(TABLES[name].format(*rows.tolist()).encode())
    assert np.array_equal(files.read_points(path).points, rows)
    assert np.array_equal(grids.read_points(path)[:, :2], rows)
    program = tmp_path / "p.sdl"
    program.write_text('curve c = read_points("t.txt");')
    assert np.array_equal(moldloft.load(program)["c"][:, :2], rows)


@pytest.mark.parametrize("text", ["1,,3\n4,,6\n", "1\t\t3\n", "1 x\n2 3\n", "1 2\n3\n", "1 nan\n"])
def test_all_readers_of_points_refuse_alike(tmp_path: Path, text: str) -> None:
    path = tmp_path / "t.csv"
    path.write_text(text)
    with pytest.raises(FairingError, match=r":\d: expected"):
        files.read_points(path)
    with pytest.raises(FileError, match=r"line \d: expected"):
        grids.read_points(path)
    program = tmp_path / "p.sdl"
    program.write_text('curve c = read_points("t.csv");')
    with pytest.raises(moldloft.ModelError, match=r"line \d: expected"):
        moldloft.load(program)
