"""Tables of offsets with names, in blocks: read, faired and written back in their form."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path

import numpy as np
import pytest

from moldloft.errors import FairingError
from moldloft.fairing import suspects
from moldloft.fairing.cells import rounded, sixteenths, step_of, written_as
from moldloft.fairing.files import points_text, read_points
from moldloft.fairing.tables import length

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

LENGTH, DEPTH, BREADTH = 340.0, 54.0, 56.0
STATIONS = [26.25, 42.375, 58.5, 74.75, 90.75, 106.875, 139.125, 171.375, 203.625, 235.875]
STATIONS += [252.0, 268.125, 284.25, 300.375, 316.5]
NAMES = ["1", "2", "3", "4", "5", "6", "8", "10", "12", "14", "15", "16", "17", "18", "19"]
WATERLINES = [9.0, 18.0, 27.0, 36.0, 45.0]
BUTTOCKS = [9.0, 18.0, 27.0, 36.0]
KEEL = 0.75


def ends(z):
    """Where stem and post are at a height."""
    return 40.0 * (1 - z / 62) ** 2, LENGTH - 25.0 * (1 - z / 62)


def half_breadth(x, z):
    stem, post = ends(z)
    s = (x - stem) / (post - stem)
    if not 0 < s < 1:
        return None
    y = BREADTH * (1 - (1 - z / 70) ** 2) * np.sin(np.pi * s)
    return y if y > KEEL else None


def sheer_height(x):
    return DEPTH + 9 * (2 * x / LENGTH - 1) ** 2


def height(x, y):
    """Where a buttock is at a station, below the sheer."""
    z = np.linspace(0.5, sheer_height(x), 4000)
    own = np.array([half_breadth(x, h) or 0.0 for h in z])
    k = int(np.argmax(own >= y))
    return z[k] if own[k] >= y and k > 0 else None


def eighths(x):
    return sixteenths(round(8 * x) / 8) if x is not None else "x"


def boat(end="\n", *, noise=None, last=True):
    """A boat in feet, inches and eighths: blocks, sheer, wale, own ends on stem and post."""
    shake = (lambda: 0.0) if noise is None else (lambda: noise.uniform(-0.06, 0.06))

    def cell(x):
        return eighths(None if x is None else x + shake())

    every = ["Sheer", *(sixteenths(w) for w in reversed(WATERLINES))]
    heights = [sheer_height(0), *reversed(WATERLINES)]
    rows = [["Stations", "Stem", *NAMES, "Post"], ["FORE-AFT POSITION"]]
    for name, z in zip(every, heights, strict=True):
        stem, post = (0.0, LENGTH + 3) if name == "Sheer" else ends(z)
        rows.append([name, eighths(stem), *map(eighths, STATIONS), eighths(post)])
    rows.append(["HEIGHT"])
    rows.append(["Sheer", *(cell(sheer_height(x)) for x in (0, *STATIONS, LENGTH + 3))])
    rows.append(["Wale", *(cell(sheer_height(x) - 6) for x in (0, *STATIONS, LENGTH + 3))])
    for y in reversed(BUTTOCKS):
        rows.append([sixteenths(y), "x", *(cell(height(x, y)) for x in STATIONS), "x"])
    rows.append(["BREADTH"])
    own = [cell(half_breadth(x, sheer_height(x))) for x in STATIONS]
    rows.append(["Sheer", "0-0-6", *own, "0-0-6"])
    for z in reversed(WATERLINES):
        own = [cell(half_breadth(x, z)) for x in STATIONS]
        rows.append([sixteenths(z), "0-0-6", *own, "0-0-6"])
    rows.append(["DIAGONAL"])
    rows.append(["A", "x", *(cell(40 * np.sin(np.pi * x / LENGTH)) for x in STATIONS), "x"])
    width = len(rows[0])
    text = end.join(",".join(row + [""] * (width - len(row))) for row in rows)
    return text + (end if last else "")


def rows_of(file):
    return [[file.places[i] for i in block] for block in file.blocks]


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("start", ["", "\ufeff"])
def test_a_boat_in_blocks_comes_back_to_the_byte(tmp_path, end, start):
    path = tmp_path / "boat.csv"
    data = (start + boat(end, last=not start)).encode()
    path.write_bytes(data)
    file = read_points(path)
    assert file.offsets and file.inches and file.unit == "in"
    assert points_text(file.table, file).encode(file.encoding) == data
    assert file.names[:2] == ["Sheer".lower(), "wale (profile)"]
    assert {"waterline 3-0-0", "buttock 1-6-0", "diagonal A (expanded)", "station 8"} <= {
        *file.names
    }
    # The ends of a waterline are where stem and post are at its height, and stay.
    own = rows_of(file)[file.names.index("waterline 2-3-0")]
    stem, post = ends(27.0)
    x = file.table[own, 0]
    assert abs(x[0] - stem) <= 1 / 16 and abs(x[-1] - post) <= 1 / 16
    assert [file.motions[k] for k in (own[0], own[1], own[-1])] == ["", "y", ""]
    assert file.point_names[own[3]].startswith("station ")
    sheer = rows_of(file)[0]
    assert {file.motions[k] for k in sheer[1:-1]} == {"yz"}
    # One offset moved is one cell changed, in its notation.
    moved = file.table.copy()
    moved[own[4], 1] += 0.0625
    text = points_text(moved, file).lstrip("\ufeff")
    old, new = (t.replace("\r\n", "\n").split("\n") for t in (boat(end, last=not start), text))
    pairs = [(a, b) for r, s in zip(old, new, strict=True)
             for a, b in zip(r.split(","), s.split(","), strict=True) if a != b]  # fmt: skip
    assert pairs == [(pairs[0][0], pairs[0][0] + "+")]


def test_a_boat_is_faired_on_its_own_lines(cli, tmp_path):
    """Half-breadths of waterlines, heights of buttocks, both of the sheer; nothing else moves."""
    noise = np.random.default_rng(1)
    # Few lines: development builds are slow.
    lines = boat(noise=noise).split("\n")
    kept = [s for s in lines if not s.startswith(("3-9-0", "0-9-0", "A,"))]
    path = tmp_path / "boat.csv"
    path.write_text("\n".join(kept))
    done = cli("fair", path, "--tol", "0,125", "--goal", "fairest", "-o", "out.csv", "--json")
    reported = json.loads(done.stdout)
    before, after = read_points(path), read_points(tmp_path / "out.csv")
    off = np.abs(after.table - before.table)
    assert reported["deviation_certified"] <= 0.125 * (1 + 1e-9)
    for row, axes in enumerate(before.motions):
        for axis in range(3):
            if "xyz"[axis] not in axes:
                assert off[row, axis] == 0
    assert np.linalg.norm(off, axis=1).max() <= 0.125 * (1 + 1e-9)
    assert (off > 0).sum() > 30
    # Every number that was written is a whole sixteenth, and nothing but numbers changed.
    assert np.abs(after.table * 16 - np.round(after.table * 16)).max() < 1e-9
    assert before.names == after.names and before.point_names == after.point_names


POSITION = boat().split("\n")[3].split(",")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        # A slip in one position of a station.
        (lambda t: t.replace(POSITION[5], POSITION[5][:-1] + "7", 1), "station `4` is at"),
        (lambda t: "\n".join(s for s in t.split("\n") if "FORE" not in s), "found `Stem`"),
        (lambda t: t.replace("BREADTH,", "BREADTH,", 1).replace("0-0-6", "six", 1), "found `six`"),
        (
            lambda t: "\n".join(["Stations,A,B,C,D,E", "HEIGHT", "Sheer,1,2,3,4,5"]),
            "expected the place of a station, found `A`",
        ),
        (lambda t: t.replace("Wale", "Sheer", 1), "a second row of `Sheer`"),
    ],
)
def test_what_blocks_lack_is_refused_at_its_line(tmp_path, change, said):
    path = tmp_path / "boat.csv"
    path.write_text(change(boat()))
    with pytest.raises(FairingError, match="line") as caught:
        read_points(path)
    assert said in str(caught.value)


def test_a_matrix_with_a_sheer_and_positions(tmp_path):
    heads = "station,x,WL 1,WL 2,WL 3,WL 4,sheer half-breadth,sheer height"
    rows = [
        f"{name},{x},{x / 10},{x / 8},{x / 6},{x / 5},{x / 4},{5 + x / 20}"
        for name, x in zip("ABCDEF", (10, 20, 30, 40, 50, 60), strict=True)
    ]
    path = tmp_path / "t.csv"
    path.write_text("\n".join([heads, *rows]))
    file = read_points(path)
    assert file.names[:5] == ["WL 1", "WL 2", "WL 3", "WL 4", "sheer"]
    assert "station C" in file.names and file.point_names[0] == "station A, WL 1"
    sheer = file.table[rows_of(file)[4]]
    assert sheer[2].tolist() == [30, 7.5, 6.5]
    assert points_text(file.table, file) == path.read_text()


#: Tables that others published without a licence: their hashes, and the folder with them.
PUBLIC = {
    "32e7f685e9817d9d8cca4f08df6a972b75c58b097f88f135e130f9216fcd2123": (204, 29),
    "43abf046ecef923184b9bbd5f886c89c3292f1b7e77bfad2f05c9ac767ee3e76": (254, 33),
}


def test_public_tables_come_back_to_the_byte():
    """Two boats of e-matteson/lapstrake (input/data.csv, input/data.csv.original)."""
    folder = os.environ.get("MOLDLOFT_PUBLIC_TABLES")
    if folder is None:
        pytest.skip("MOLDLOFT_PUBLIC_TABLES names no folder with the tables")
    found = {hashlib.sha256(p.read_bytes()).hexdigest(): p for p in Path(folder).iterdir()}
    for digest, (rows, curves) in PUBLIC.items():
        file = read_points(found[digest])
        assert file.table.shape == (rows, 3) and len(file.blocks) == curves
        assert points_text(file.table, file).encode() == found[digest].read_bytes()


@pytest.mark.parametrize("seed", range(2000 if SOAK else 200))
def test_rounding_keeps_the_tolerance(seed):
    rng = np.random.default_rng(seed)
    digits = int(rng.integers(0, 4))
    given = round(float(rng.normal() * 10), digits)
    tol = float(10.0 ** -rng.uniform(0, 4))
    value = given + tol * float(rng.uniform(-1, 1))
    cell = f"{given:.{digits}f}"
    step = step_of([cell], tol)
    near = rounded(value, given, step, tol)
    assert abs(near - given) <= tol * (1 + 1e-12)
    assert abs(near - value) <= max(step, 1e-15) * (1 + 1e-9)
    assert float(written_as(near, cell, step)) == pytest.approx(near, abs=1e-12)
    inch = rounded(53.125 + value - given, 53.125, 0.0625, tol)
    assert abs(inch - 53.125) <= tol * (1 + 1e-12)
    assert length(written_as(inch, "4-5-1", 0.0625)) == inch


def planted(seed):
    """A boat with an inch planted, at least third from the ends of its lines."""
    rng = np.random.default_rng(seed)
    return rng, boat(noise=rng)


@pytest.mark.parametrize("in_network", [True, False])
def test_an_inch_is_among_the_first_five_suspects(tmp_path, in_network):
    cases = (400 if in_network else 1500) if SOAK else (6 if in_network else 40)
    path = tmp_path / "boat.csv"
    rng = np.random.default_rng(7)
    path.write_text(boat(noise=rng))
    file = read_points(path)
    lists = rows_of(file)
    inner = [k for own in lists for k in own[2:-2]]
    cells = [(k, "xyz".index(a)) for k in sorted({*inner}) for a in file.motions[k]]
    hits, meant = 0, 0
    for _ in range(cases):
        k, axis = cells[int(rng.integers(len(cells)))]
        table = file.table.copy()
        table[k, axis] += rng.choice([-1.0, 1.0])
        texts = {owner: sixteenths(table[owner]) for owner in file.cells.owners}
        if in_network:
            found = suspects(table, 0.125, lists, motion=file.motions, readings=texts, most=5)
            places = [(s.index, s.axis) for s in found]
        else:
            own = max((o for o in lists if k in o and np.ptp(table[o, axis]) > 0), key=len)
            found = suspects(table[own], 0.125, motion=[file.motions[i] for i in own], most=5)
            places = [(own[s.index], s.axis) for s in found]
        if (k, axis) in places:
            hits += 1
            meant += found[places.index((k, axis))].meant == file.table[k, axis]
    assert hits >= 0.8 * cases, (hits, meant, cases)
    if in_network:
        assert meant >= 0.5 * hits


def test_suspects_name_the_slip():
    x = np.arange(20.0)
    y = np.round(30 + 20 * np.sin(x / 6), 2)
    first = y.copy()
    first[[8, 9]] = first[[9, 8]]
    second = y.copy()
    second[11] = float(f"{y[11]:.2f}"[1] + f"{y[11]:.2f}"[0] + f"{y[11]:.2f}"[2:])
    third = y.copy()
    third[6] = -third[6]
    for wrong, at, slips in (
        (first, (8, 9), {"swapped with its neighbour"}),
        (second, (11,), {"two digits swapped"}),
        (third, (6,), {"the sign"}),
    ):
        best = suspects(np.column_stack([x, wrong]), 0.01, motion="y")[0]
        assert best.index in at and best.slip in slips, (best, slips)
        assert best.meant == y[best.index] and best.gain > 0.9
    assert suspects(np.column_stack([x, y]), 0.01, motion="y", most=3) == ()


def test_a_chine_is_no_suspect():
    x = np.linspace(-5, 5, 15)
    y = 0.02 * x**2 + np.maximum(x, 0)
    assert all(s.index != 7 for s in suspects(np.column_stack([x, y]), 1e-3, motion="y"))
