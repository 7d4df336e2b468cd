"""CGNS files as written, opened by h5py and by CGNS's own program: nodes, names, sizes, damage."""

from __future__ import annotations

import os
import shutil
import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import moldloft
from moldloft import grids
from moldloft.errors import FileError

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
TYPES = {"int8": b"C1", "int32": b"I4", "float32": b"R4", "float64": b"R8"}


def checked(path: Path) -> int:
    """The number of nodes; each is laid out as the mapping of CGNS to HDF5 demands."""
    count = 0

    def node(name: str, item: Any) -> None:
        nonlocal count
        if isinstance(item, h5py.Dataset):
            assert name.rsplit("/", 1)[-1] in (" data", " format", " hdf5version")
            return
        count += 1
        attributes = {key: item.attrs[key] for key in item.attrs}
        assert set(attributes) == {"name", "label", "type", "flags"}
        assert attributes["name"] == name.rsplit("/", 1)[-1].encode()
        assert len(attributes["name"]) <= 32
        assert attributes["flags"].tolist() == [1]
        wanted = TYPES[item[" data"].dtype.name] if " data" in item else b"MT"
        assert attributes["type"] == wanted, name

    with h5py.File(path) as file:
        assert file.attrs["label"] == b"Root Node of HDF5 File"
        assert bytes(file[" format"][:]).rstrip(b"\0") == b"IEEE_LITTLE_32"
        file.visititems(node)
    if program := shutil.which("cgnscheck"):
        done = subprocess.run([program, "-v", str(path)], capture_output=True, text=True)
        assert "ERROR" not in done.stdout and done.returncode == 0, done.stdout
    return count


def sheet(ni: int, nj: int, seed: int = 0) -> np.ndarray:
    x, y = np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij")
    z = 0.1 * np.random.default_rng(seed).normal(size=x.shape)
    return np.stack([x, y, z], axis=-1)


@pytest.mark.parametrize("size", [(2, 2), (7, 3), (1000, 1000)])
def test_points_come_back_by_both_readers(tmp_path: Path, size: tuple[int, int]) -> None:
    given = sheet(*size)
    path = grids.write_cgns(tmp_path / "one.cgns", [given], ["a"])
    assert path.stat().st_size < given.nbytes + 16384
    assert np.array_equal(grids.read_cgns(path)["Z_a"], given)
    with h5py.File(path) as file:
        grid = file["one/Z_a/GridCoordinates"]
        for axis, letter in enumerate("XYZ"):
            stored = grid[f"Coordinate{letter}/ data"][:]
            assert np.array_equal(stored.T, given[..., axis])
    if size != (1000, 1000):
        checked(path)


@pytest.mark.parametrize("seed", range(60 if SOAK else 6))
def test_cut_sheets_join_where_they_were_cut(tmp_path: Path, seed: int) -> None:
    """A sheet in random pieces, each turned at random: interfaces are the inner cuts."""
    rng = np.random.default_rng(seed)
    whole = sheet(9, 8, seed)
    columns = sorted({0, 8, *rng.integers(1, 8, size=2).tolist()})
    pieces, cuts = [], 0
    for k, (a, b) in enumerate(pairwise(columns)):
        rows = sorted({0, 7, int(rng.integers(1, 7))})
        cuts += sum(d - c for c, d in pairwise(rows)) if k else 0
        cuts += b - a
        for c, d in pairwise(rows):
            piece = whole[a : b + 1, c : d + 1]
            piece = piece[:: int(rng.choice([-1, 1])), :: int(rng.choice([-1, 1]))]
            pieces.append(piece.swapaxes(0, 1) if rng.random() < 0.5 else piece)
    path = grids.write_cgns(tmp_path / "cut.cgns", pieces)
    checked(path)
    read = grids.read_cgns(path)
    joined = 0
    with h5py.File(path) as file:
        for name, zone in file["cut"].items():
            if not isinstance(zone, h5py.Group) or zone.attrs["label"] != b"Zone_t":
                continue
            for one in zone.get("ZoneGridConnectivity", {}).values():
                if not isinstance(one, h5py.Group):
                    continue
                donor = bytes(one[" data"][:]).decode()
                begin, end = one["PointRange/ data"][:]
                there, last = one["PointRangeDonor/ data"][:]
                matrix = np.zeros((2, 2), dtype=int)
                for axis, step in enumerate(one["Transform/ data"][:]):
                    matrix[abs(step) - 1, axis] = np.sign(step)
                assert ((end - begin) @ matrix.T == last - there).all()
                for k in range(max(end - begin) + 1):
                    at = begin + k * np.sign(end - begin)
                    to = there + matrix @ (at - begin)
                    assert (read[name][tuple(at - 1)] == read[donor][tuple(to - 1)]).all()
                joined += max(end - begin)
    assert joined == 2 * cuts


def test_names_differ_as_far_as_a_node_can(tmp_path: Path) -> None:
    """Names of 40 characters, of other nodes, with slashes: all zones are there."""
    long = "a name of more than thirty-two characters"
    names = [long, long, f"Z_{long}", "DataClass", "x/y", "x\\y", "Rümpf", "a", "Z_a", " "]
    given = [sheet(3, 2, k) + np.array([0, 0, 5 * k]) for k in range(len(names))]
    path = grids.write_cgns(tmp_path / "CGNSLibraryVersion.cgns", given, names)
    checked(path)
    read = grids.read_cgns(path)
    assert [points.tolist() for points in read.values()] == [g.tolist() for g in given]
    # A boundary may have the name of a block.
    model = moldloft.loads(
        "surface s[2,2]; s[1,] = {{0,0,0}, {0,1,0}}; s[2,] = {{1,0,0}, {1,1,0}};"
        'block hull = {s, s + {0,0,1}}; write_cgns("b.cgns", hull, "k1 = hull wall");'
    )
    (tmp_path / "b.cgns").write_bytes(model.written["b.cgns"])
    checked(tmp_path / "b.cgns")
    assert list(grids.read_cgns(tmp_path / "b.cgns")) == ["hull"]


def test_other_programs_may_add_to_a_file(tmp_path: Path) -> None:
    """HDF5 checks each header that it changes."""
    path = grids.write_cgns(tmp_path / "a.cgns", [sheet(3, 3, k) + k for k in range(12)])
    before = grids.read_cgns(path)
    with h5py.File(path, "r+") as file:
        for k in range(20):
            file["a"].create_group(f"extra {k}").attrs["label"] = np.bytes_("UserDefinedData_t")
        file["a/Z_grid3"].attrs["flags"] = np.array([2], dtype=np.int32)
        del file["a/Z_grid12"]
    after = grids.read_cgns(path)
    assert list(after) == list(before)[:-1]
    assert all(np.array_equal(after[name], before[name]) for name in after)


def test_damaged_files_are_refused(tmp_path: Path) -> None:
    path = grids.write_cgns(tmp_path / "a.cgns", [sheet(3, 3)], ["a"])
    data = path.read_bytes()
    damaged = tmp_path / "damaged.cgns"
    for end in range(0, len(data) - 4, 37):
        damaged.write_bytes(data[:end])
        with pytest.raises(FileError):
            grids.read_cgns(damaged)
    sizes = np.array([[3, 3], [2, 2], [0, 0]], dtype=np.int32).tobytes()
    assert data.count(sizes) == 1
    for huge in ([2**31 - 1, 2**31 - 1], [-3, 3], [0, 3]):
        other = np.array([huge, [2, 2], [0, 0]], dtype=np.int64).astype(np.int32).tobytes()
        damaged.write_bytes(data.replace(sizes, other))
        with pytest.raises(FileError):
            grids.read_cgns(damaged)
