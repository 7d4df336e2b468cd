"""CGNS files of other programs, read without h5py: HDF5 of all ages, and damaged."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft import _core, grids
from moldloft.errors import FileError, ModelError

h5py = pytest.importorskip("h5py")


def block(shape: tuple[int, ...], seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(*shape, 3))


def node(parent: Any, name: str, label: str, data: Any = None, **how: Any) -> Any:
    """A node as the CGNS library makes it: a group with attributes, its data in ` data`."""
    group = parent.create_group(name)
    group.attrs["label"] = np.bytes_(label)
    group.attrs["name"] = np.bytes_(name)
    group.attrs["type"] = np.bytes_("MT" if data is None else "R8")
    if data is not None:
        if isinstance(data, str):
            data = np.frombuffer(data.encode(), dtype=np.int8)
        group.create_dataset(" data", data=data, **how)
    return group


def written(
    path: Path,
    zones: dict[str, np.ndarray],
    *,
    dtype: Any = np.float64,
    rind: tuple[int, ...] = (),
    sizes: Any = np.int32,
    data: dict[str, Any] | None = None,
    **how: Any,
) -> Path:
    """A file with these zones; ``how`` is for the file, ``data`` for the arrays in it."""
    h5py.get_config().track_order = how.pop("track_order", False)
    with h5py.File(path, "w", **how) as file:
        base = node(file, "Base", "CGNSBase_t", np.array([3, 3], dtype=np.int32))
        for name, points in zones.items():
            inner = points
            if rind:
                cut = [
                    slice(a, n - b)
                    for n, a, b in zip(points.shape[:-1], rind[::2], rind[1::2], strict=True)
                ]
                inner = points[tuple(cut)]
            shape = np.array(inner.shape[:-1])
            zone = node(base, name, "Zone_t", np.array([shape, shape - 1, 0 * shape], dtype=sizes))
            node(zone, "ZoneType", "ZoneType_t", "Structured")
            grid = node(zone, "GridCoordinates", "GridCoordinates_t")
            if rind:
                node(grid, "Rind", "Rind_t", np.array(rind, dtype=np.int32))
            for c, axis in enumerate("XYZ"):
                values = np.ascontiguousarray(points[..., c].T).astype(dtype)
                node(grid, f"Coordinate{axis}", "DataArray_t", values, **(data or {}))
    h5py.get_config().track_order = False
    return path


def same(path: Path, zones: dict[str, np.ndarray], rtol: float = 0.0) -> None:
    found = grids.read_cgns(path)
    assert set(found) == set(zones)
    for name, points in zones.items():
        if rtol:
            np.testing.assert_allclose(found[name], points, rtol=rtol)
        else:
            assert np.array_equal(found[name], points), name


SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
AGES = [
    (libver, track, count)
    for libver in ("earliest", "v108", "v110", "latest")
    for track in (False, True)
    for count in (1, 3, 12, 70, 700)
    # A file of 700 zones takes h5py seconds to write.
    if SOAK or count < 700 or (libver == "latest" and not track)
]


@pytest.mark.parametrize(("libver", "track", "count"), AGES)
def test_files_of_every_age(tmp_path: Path, libver: str, track: bool, count: int) -> None:
    """Few zones stand in the group's header, more in heaps and trees of several levels."""
    zones = {f"zone{k}": block((2, 3, 2), k) for k in range(count)}
    path = written(tmp_path / "a.cgns", zones, libver=(libver, "latest"), track_order=track)
    same(path, zones)
    order = list(grids.read_cgns(path))
    assert order == (list(zones) if track else sorted(zones))


@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", ">f4"])
def test_numbers_of_every_kind(tmp_path: Path, dtype: str) -> None:
    zones = {"a": block((4, 3, 5)), "flat": block((3, 4))}
    path = written(tmp_path / "a.cgns", zones, dtype=dtype)
    same(path, zones, rtol=1e-6 if "4" in dtype else 0.0)
    path = written(tmp_path / "b.cgns", zones, sizes=np.int64)
    same(path, zones)


@pytest.mark.parametrize("chunks", [(2, 2, 3), (5, 1, 4), (1, 1, 1), True])
def test_arrays_in_chunks(tmp_path: Path, chunks: Any) -> None:
    zones = {"a": block((7, 4, 9))}
    same(written(tmp_path / "a.cgns", zones, data={"chunks": chunks}), zones)


def test_planes_beyond_the_zone_are_left_out(tmp_path: Path) -> None:
    points = block((7, 6, 5))
    path = written(tmp_path / "a.cgns", {"a": points}, rind=(1, 2, 0, 1, 1, 0))
    same(path, {"a": points[1:5, :5, 1:]})


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    zones = {"a": block((9, 8, 7))}
    cases: list[tuple[Path, str]] = [
        (written(tmp_path / "z.cgns", zones, data={"compression": 4}), "compressed"),
    ]
    path = written(tmp_path / "u.cgns", zones)
    with h5py.File(path, "a") as file:
        del file["Base/a/ZoneType"]
        node(file["Base/a"], "ZoneType", "ZoneType_t", "Unstructured")
    cases.append((path, "a structured zone"))
    path = written(tmp_path / "c.cgns", zones)
    with h5py.File(path, "a") as file:
        grid = file["Base/a/GridCoordinates"]
        for axis, other in zip("XYZ", ("R", "Theta", "Phi"), strict=True):
            grid.move(f"Coordinate{axis}", f"Coordinate{other}")
    cases.append((path, "CoordinateX, CoordinateY, CoordinateZ"))
    path = written(tmp_path / "s.cgns", zones)
    with h5py.File(path, "a") as file:
        del file["Base/a/GridCoordinates/CoordinateY"]
        node(file["Base/a/GridCoordinates"], "CoordinateY", "DataArray_t", np.zeros((3, 3)))
    cases.append((path, "CoordinateY of the zone's points"))
    path = tmp_path / "other.cgns"
    with h5py.File(path, "w") as file:
        file["numbers"] = np.arange(3)
    cases.append((path, "CGNSBase_t"))
    path = tmp_path / "adf.cgns"
    path.write_bytes(b"@(#)ADF Database Version B02012>")
    cases.append((path, "adf2hdf"))
    path = tmp_path / "text.cgns"
    path.write_text("no HDF5 at all")
    cases.append((path, "an HDF5 file"))
    for path, match in cases:
        with pytest.raises(FileError, match=match) as caught:
            grids.read_cgns(path)
        assert path.name in str(caught.value)


def test_a_program_reads_zones_by_number_and_name(tmp_path: Path) -> None:
    zones = {"body": block((4, 3)), "wake": block((2, 3, 5))}
    written(tmp_path / "two.cgns", zones, track_order=True)
    program = tmp_path / "p.sdl"
    program.write_text(
        'surface s = read_cgns("two.cgns"); block b = read_cgns("two.cgns", "wake");\n'
        'int n = count_cgns("two.cgns"); string names[2] = names_cgns("two.cgns");\n'
        'assert names[2] == "wake"; block c = read_cgns("two.cgns", 2);\n'
        'write_cgns("again.cgns", b, "k1 = hull wall");\n'
        'block d = read_cgns("again.cgns", "b"); assert max(|d - b|) == 0;\n'
    )
    model = moldloft.load(program)
    assert np.array_equal(np.asarray(model["s"]), zones["body"])
    assert np.array_equal(model["b"], zones["wake"])
    assert np.array_equal(model["c"], zones["wake"])
    assert model["n"] == 2
    (tmp_path / "again.cgns").write_bytes(model.written["again.cgns"])
    same(tmp_path / "again.cgns", {"b": zones["wake"]})
    for call, match in [
        ('read_cgns("two.cgns", 3)', "from 1 to 2"),
        ('read_cgns("two.cgns", 0)', "from 1 to 2"),
        ('read_cgns("two.cgns", "wakes")', "did you mean"),
        ('read_cgns("p.sdl")', "an HDF5 file"),
        ('read_cgns("none.cgns")', "no such file"),
    ]:
        (tmp_path / "q.sdl").write_text(f"print {call};")
        with pytest.raises(ModelError, match=match):
            moldloft.load(tmp_path / "q.sdl")


def test_files_of_the_cgns_library(tmp_path: Path) -> None:
    """What ``plot3d_to_cgns`` makes, which is the library's own work."""
    if shutil.which("plot3d_to_cgns") is None:
        pytest.skip("the tools of CGNS are not installed")
    blocks = [block((4, 3, 5)), block((3, 6, 2), 2)]
    grids.write_plot3d(tmp_path / "v.x", blocks)
    subprocess.run(
        ["plot3d_to_cgns", "-d", "v.x", "v.cgns"], cwd=tmp_path, check=True, capture_output=True
    )
    path = tmp_path / "v.cgns"
    if path.read_bytes().startswith(b"@(#)ADF"):
        with pytest.raises(FileError, match="adf2hdf"):
            grids.read_cgns(path)
        subprocess.run(["adf2hdf", "v.cgns", "h.cgns"], cwd=tmp_path, check=True)
        path = tmp_path / "h.cgns"
    found = list(grids.read_cgns(path).values())
    assert len(found) == 2
    assert all(np.array_equal(a, b) for a, b in zip(found, blocks, strict=True))


def test_damaged_files_are_faults(tmp_path: Path) -> None:
    """Bytes changed, cut off, doubled: an error or a grid, at once, never a crash."""
    random = np.random.default_rng(7)
    files = []
    for k, how in enumerate([{}, {"track_order": True}, {"libver": "latest"}]):
        zones = {f"z{j}": block((3, 2, 2)) for j in range(3 if k else 12)}
        files.append(written(tmp_path / f"{k}.cgns", zones, **how).read_bytes())
    tries = 60_000 if os.environ.get("MOLDLOFT_SOAK") else 1_500
    outcomes = {"read": 0, "refused": 0}
    for _ in range(tries):
        data = bytearray(files[random.integers(len(files))])
        for _ in range(random.integers(1, 5)):
            at = int(random.integers(len(data)))
            match random.integers(4):
                case 0:
                    data[at] = int(random.integers(256))
                case 1:
                    data[at : at + 8] = int(random.integers(2**62)).to_bytes(8, "little")
                case 2:
                    data[at : at + 8] = random.choice([b"\xff" * 8, bytes(8), b"\x01" + bytes(7)])
                case _:
                    if random.integers(5) == 0:
                        del data[at:]
            if not data:
                data = bytearray(b"\0")
        try:
            _core.read_cgns(bytes(data))
            outcomes["read"] += 1
        except Exception as error:
            assert type(error).__name__ == "FormatError", repr(error)
            outcomes["refused"] += 1
    assert min(outcomes.values()) > tries // 50, outcomes
