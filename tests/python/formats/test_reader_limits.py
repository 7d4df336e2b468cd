"""Files of other programs that ask for too much are refused by name, within the limits."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import moldloft
from moldloft import overlays
from moldloft.budget import within_limits

LINE = "0\nLINE\n8\n0\n10\n0\n20\n0\n30\n0\n11\n1\n21\n1\n31\n0\n"


@pytest.fixture(autouse=True)
def _limits() -> Iterator[None]:
    before = moldloft.limits()
    yield
    moldloft.limits(**before._asdict())


def insert(block: str, more: str = "") -> str:
    return f"0\nINSERT\n8\n0\n2\n{block}\n10\n0\n20\n0\n30\n0\n{more}"


def drawing(blocks: dict[str, str], entities: str) -> str:
    inner = "".join(
        f"0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n0\n20\n0\n30\n0\n{text}0\nENDBLK\n"
        for name, text in blocks.items()
    )
    sections = {"BLOCKS": inner, "ENTITIES": entities}
    parts = (f"0\nSECTION\n2\n{name}\n{text}0\nENDSEC\n" for name, text in sections.items())
    return "".join(parts) + "0\nEOF\n"


def nested(depth: int) -> str:
    """Ten blocks in each, a line in the innermost."""
    blocks = {"B0": LINE} | {f"B{k}": insert(f"B{k - 1}") * 10 for k in range(1, depth + 1)}
    return drawing(blocks, insert(f"B{depth}"))


DRAWINGS = {
    "a thousand million lines": (nested(9), "holds 1000000000 entities"),
    "a block in itself": (drawing({"B": insert("B")}, insert("B")), "`B` is inserted in itself"),
    "blocks in each other": (
        drawing({"B": insert("C"), "C": insert("B")}, insert("B")),
        "is inserted in itself",
    ),
    "rows and columns": (
        drawing({"B": LINE}, insert("B", "70\n9999\n71\n9999\n44\n1\n45\n1\n")),
        "holds 99980001 entities",
    ),
}


@pytest.mark.parametrize("name", DRAWINGS)
def test_drawings_are_counted_before_they_are_unfolded(tmp_path: Path, name: str) -> None:
    pytest.importorskip("ezdxf")
    text, why = DRAWINGS[name]
    path = tmp_path / "bomb.dxf"
    path.write_text(text)
    with pytest.raises(moldloft.FileError, match=rf"bomb\.dxf`: .*{why}"):
        overlays.read(path)


def test_blocks_in_rows_and_columns_are_read(tmp_path: Path) -> None:
    pytest.importorskip("ezdxf")
    path = tmp_path / "rows.dxf"
    path.write_text(drawing({"B": LINE}, insert("B", "70\n3\n71\n2\n44\n5\n45\n7\n")))
    found = overlays.read(path)
    starts = sorted(tuple(curve.points[0]) for curve in found.curves.values())
    assert starts == sorted((5.0 * i, 7.0 * j, 0.0) for i in range(3) for j in range(2))


def test_reading_is_limited_in_time(tmp_path: Path) -> None:
    pytest.importorskip("ezdxf")
    path = tmp_path / "long.dxf"
    path.write_text(nested(4))
    moldloft.limits(seconds=1e-3)
    with pytest.raises(moldloft.FileError, match=r"long\.dxf`: .*longer than the 0\.001 s"):
        overlays.read(path)


GREEDY = """
import os, time
import moldloft
from moldloft.budget import within_limits

kept = []
moldloft.limits(memory="120M")
try:
    with within_limits():
        while True:
            kept.append(os.urandom(1 << 20))
            # Memory is looked at by the clock: a busy machine may be late by a second.
            time.sleep(5e-2)
except moldloft.FileError as error:
    print(len(kept), error)
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the system does not say it")
def test_python_is_limited_in_memory() -> None:
    # In a process of its own: what an earlier test gave back would be taken first.
    done = subprocess.run([sys.executable, "-c", GREEDY], capture_output=True, text=True)
    count, why = done.stdout.split(" ", 1)
    assert "GiB of memory" in why
    # No more than a fifth beyond what is allowed.
    assert int(count) < 1.2 * 120


TABLE = """
import pathlib, sys, time
import moldloft
from moldloft import offsets
from moldloft.fairing.files import read_numbers, read_points

status = pathlib.Path("/proc/self/status")
moldloft.limits(memory="60M")
before = int(status.read_text().split("VmRSS:")[1].split()[0]) // 1024
for read, text in (
    (read_points, "0,0.5,1\\n"), (read_numbers, "1 2 3\\n"),
    (offsets.read, "{0},{1},0.5\\n"),
):
    path = pathlib.Path("table.csv")
    head = "station,waterline,half-breadth\\n" if read is offsets.read else ""
    rows = (text.format(k // 1000, k % 1000) for k in range(1_000_000))
    path.write_text(head + "".join(rows))
    try:
        read(path)
        print(read.__name__, "done")
    except moldloft.FileError as error:
        print(read.__name__, str(error).splitlines()[0])
peak = int(status.read_text().split("VmHWM:")[1].split()[0]) // 1024
print(peak - before)
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the system does not say it")
def test_readers_of_tables_are_limited_in_memory(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", TABLE], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr[-2000:]
    *said, grown = done.stdout.splitlines()
    for name, line in zip(("read_points", "read_numbers", "read"), said, strict=True):
        assert line.startswith(f"{name} cannot read `table.csv`: this needs"), line
    # The file and its text besides; memory is looked at by the clock.
    assert int(grown) < 300


def test_tables_and_cad_files_are_limited_in_time(tmp_path: Path) -> None:
    from moldloft import offsets, study
    from moldloft.study.plans import points

    path = tmp_path / "table.csv"
    path.write_text("a,b\n" + "1,2\n" * 400_000)
    (tmp_path / "m.sdl").write_text("param float a = 1 in [0, 9]; param float b = 1 in [0, 9];")
    definition = study.Study(
        tmp_path / "m.sdl",
        (study.Input("a"), study.Input("b")),
        {"c": "a"},
        plan=study.Plan("table", file=str(path)),
    )
    model = moldloft.load(definition.model)
    moldloft.limits(seconds=1e-3)
    for read in (lambda: points(definition, model), lambda: offsets.read(path)):
        with pytest.raises(moldloft.FileError, match=r"table\.csv`: .*longer than the 0\.001 s"):
            read()


def test_watches_within_another_change_nothing() -> None:
    moldloft.limits(seconds=1e-3)
    outer = pytest.raises(moldloft.FileError, match="outer: this takes longer")
    with outer, within_limits("outer"), within_limits("inner"):
        while True:
            time.sleep(1e-3)
    moldloft.limits(seconds=10)
    with within_limits():
        pass


def test_an_interruption_is_over_with_the_work() -> None:
    moldloft.limits(seconds=1e-9)
    for _ in range(50):
        try:
            with within_limits():
                sum(range(10_000))
        except moldloft.FileError as error:
            assert "s that are allowed" in str(error)
        # Nothing arrives late.
        sum(range(1_000))
    # What a reader takes for a fault of its file is none.
    with pytest.raises(moldloft.FileError, match="allowed"), within_limits():
        while True:
            try:
                time.sleep(1e-3)
            except Exception:
                continue


SVG = '<svg xmlns="http://www.w3.org/2000/svg">{}</svg>'


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (SVG.format("<g>" * 20_000 + '<path d="M0 0L1 1"/>' + "</g>" * 20_000), "nested too deep"),
        ('<!DOCTYPE s [<!ENTITY a "b">]>' + SVG.format("&a;"), "it declares entities"),
        (SVG.format('<g id="a"><use href="#a"/></g>'), "no points, faces or curves"),
    ],
    ids=["deep", "entities", "use of itself"],
)
def test_svg_bombs(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "bomb.svg"
    path.write_text(text)
    with pytest.raises(moldloft.FileError, match=rf"bomb\.svg`.*{why}"):
        overlays.read(path)
