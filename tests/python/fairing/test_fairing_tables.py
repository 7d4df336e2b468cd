"""Points as people have them: aerofoils of the wild, decimal commas, named columns, offsets."""

from __future__ import annotations

import dataclasses
import importlib.util
import json
import os
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft.errors import Error, FairingError
from moldloft.fairing.cells import sixteenths
from moldloft.fairing.files import points_text, read_points
from moldloft.fairing.tables import length

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def naca(n=33):
    s = np.linspace(-1, 1, n)
    x = s * s
    y = 0.2969 * abs(s) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4
    return np.column_stack([x, np.sign(-s) * 0.6 * y])


ROWS = "\n".join(f"{x:.6f}  {y:.6f}" for x, y in naca())

FORMS = {
    "selig": f"NACA 0012\n{ROWS}\n",
    "tabs and a trailing tab": "MH 16\tMartin Hepperle\t\n" + ROWS.replace("\n", "\t   \n"),
    "prose behind": f"HN 1\n{ROWS}\n\nModif 1.00057 ->1.00000\nDicke: 7,83 %\nhttp://a.b/c\n",
    "prose without a blank line": f"HN 1\n{ROWS}\nsource from http://a.b/c\n20 nov 2005",
    "the box of MSES": f"BOEING 737\n  -2.0  3.0  -2.6  3.4\n{ROWS}\n",
    "decimal commas": "NACA 0012\n" + ROWS.replace(".", ","),
    "semicolons": "x;y\n" + ROWS.replace("  ", ";").replace(".", ","),
    "carriage returns": f"NACA\r\n{ROWS}\r\n".replace("\n", "\r\n").replace("\r\r", "\r"),
    "columns by name": "name,station,y,x\n"
    + "\n".join(f"p{k},{k % 7},{y:.6f},{x:.6f}" for k, (x, y) in enumerate(naca())),
}


@pytest.mark.parametrize("name", FORMS)
def test_every_form_is_read(tmp_path, name):
    path = tmp_path / "foil.dat"
    path.write_bytes(FORMS[name].encode())
    file = read_points(path)
    assert file.points.shape == (33, 2)
    assert np.abs(file.points - naca()).max() <= 5.1e-7
    again = tmp_path / "again.dat"
    again.write_text(points_text(file.points, file))
    assert read_points(again).points.tobytes() == file.points.tobytes()
    if "prose" in name:
        assert any("text, not read" in note for note in file.notes)
        assert file.head == ["HN 1"]
    if name == "columns by name":
        assert any("`name`, `station`" in note for note in file.notes)


FAULTS = {
    "a slip in the last row": (f"{ROWS}\n1.0 O.5", "found `O.5`"),
    "a word among the rows": (ROWS.replace("\n", "\nhere ", 1) + "\n" + ROWS, "found `here`"),
    "two columns of one name": ("x,x,y\n" + "1,2,3\n" * 6, "are the same"),
    "the same offset twice": (
        "station,half-breadth,height\n"
        + "".join(f"{s},{z},{z}\n" for s in range(6) for z in range(5))
        + "3,2,2\n",
        "the same offset as line",
    ),
    "stations out of order": (
        "station,half-breadth,height\n"
        + "".join(f"{s},{z},{z}\n" for s in (0, 1, 3, 2, 4) for z in range(5)),
        "station 2 is out of order after 3",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_have_their_line(tmp_path, name):
    text, words = FAULTS[name]
    path = tmp_path / "points.csv"
    path.write_text(text)
    with pytest.raises(FairingError, match=r"points\.csv") as caught:
        read_points(path)
    assert words in str(caught.value)


def test_feet_inches_and_eighths(tmp_path):
    assert [length(t) for t in ("4-5-1", "0-54-0", "4-5-1+", "4' 5 1/8\"", "4' 1/8\"")] == [
        53.125,
        54.0,
        53.1875,
        53.125,
        48.125,
    ]
    assert length("4-5") is None and length("x") is None
    for sixteen in range(0, 4000, 7):
        assert length(sixteenths(sixteen / 16)) == sixteen / 16
    # The half-breadths of a sheer, read to eighths: the same form comes out.
    x = 16.125 * np.arange(18)
    y = 60 * np.sin(np.pi * (x + 40) / 350)
    path = tmp_path / "sheer.csv"
    rows = [f"{sixteenths(a)}, {sixteenths(round(8 * b) / 8)}" for a, b in zip(x, y, strict=True)]
    path.write_text("# sheer\n" + "\n".join(rows) + "\n")
    file = read_points(path)
    assert file.inches and any("inches" in note for note in file.notes)
    assert np.abs(file.points[:, 1] - y).max() <= 1 / 16
    assert points_text(file.points, file).splitlines()[1:] == rows


def hull(x, z):
    return 0.9 * (1 - (x / 5 - 1) ** 2) * (1 - (1 - z / 1.25) ** 2)


def test_a_table_of_offsets(cli, tmp_path):
    """Named columns: stations and waterlines that share their points; half-breadths alone move."""
    stations = [0, 0.5, 1, 1.5, 2, 3, 4, 5, 6, 7, 8, 8.5, 9, 9.5, 10]
    levels = [0, 0.1, 0.25, 0.5, 0.75, 1, 1.25]
    rows = [(s, w, round(hull(s, w), 2)) for s in stations for w in levels]
    text = "Station;Waterline;Half-breadth\n"
    text += "".join(f"{s};{w};{y}\n".replace(".", ",") for s, w, y in rows)
    path = tmp_path / "offsets.csv"
    path.write_text(text)
    file = read_points(path)
    assert file.offsets and file.comma and len(file.blocks) == 15 + 7
    done = cli("fair", path, "--tol", 0.005, "-o", "out.csv", "--json")
    reported = json.loads(done.stdout)
    assert reported["curves"] == 22 and reported["shared"] == 105
    out = read_points(tmp_path / "out.csv")
    assert out.table is not None and out.table.shape == (105, 3)
    before, after = file.table, out.table
    assert (before[:, [0, 2]] == after[:, [0, 2]]).all()
    assert np.abs(after - before).max() <= 0.005 * (1 + 1e-12)
    truth = hull(before[:, 0], before[:, 2])
    near = np.sqrt(((after[:, 1] - truth) ** 2).mean())
    assert near < 0.5 * np.sqrt(((before[:, 1] - truth) ** 2).mean())


def test_the_aerofoils_of_a_package(tmp_path):
    """The files of a package, where it is installed: all are read, or refused with a reason."""
    spec = importlib.util.find_spec("aerosandbox")
    if spec is None or spec.origin is None:
        pytest.skip("aerosandbox, which ships the files, is not installed")
    folder = Path(spec.origin).parent / "geometry" / "airfoil" / "airfoil_database"
    files = sorted(folder.glob("*.dat"))[:: 1 if SOAK else 60]
    refused, flagged, beyond, bends = [], [], [], []
    for path in files:
        try:
            points = read_points(path).points[:, :2]
        except Error as error:
            refused.append(str(error))
            continue
        if len(points) < 8:
            continue
        faired = moldloft.fair(points, 3e-4)
        if any(f.kind == "outlier" for f in faired.findings):
            flagged.append(path.name)
        if faired.deviation_data > 3e-4 * (1 + 1e-9):
            beyond.append(path.name)
        if faired.after.inflections > faired.before.inflections:
            bends.append(path.name)
    assert len(refused) <= 0.02 * len(files) + 1, refused
    assert not beyond and not bends
    assert len(flagged) <= 0.02 * len(files) + 1, flagged


def matrix_text(form):
    x, z = np.arange(9.0), np.array([0.25, 0.5, 1.0, 1.5, 2.0, 2.5])
    y = np.round(hull(x[:, None] * 10 / 8, z[None]), 3)
    if form == "waterlines":
        rows = [
            f"WL {float(b)!r}; " + "; ".join(repr(float(v)) for v in y[:, k])
            for k, b in enumerate(z)
        ]
        head = "waterline; " + "; ".join(repr(float(v)) for v in x)
    elif form == "stations, blanks":
        rows = [f"{a:g}  " + "  ".join(f"{v:7.3f}" for v in y[k]) for k, a in enumerate(x)]
        head = "station  " + "  ".join(f"{v:g}" for v in z)
    else:
        rows = [f"{a:g};" + ";".join(f"{v:.3f}" for v in y[k]).replace(".", ",") for k, a in
                enumerate(x)]  # fmt: skip
        head = ("station;" + ";".join(f"{v:g}" for v in z)).replace(".", ",")
    return "\n".join(["# of a hull", head, *rows]) + "\n", x, z, y


@pytest.mark.parametrize("form", ["waterlines", "stations, blanks", "decimal commas"])
def test_matrices_of_offsets_come_back_in_their_form(cli, tmp_path, form):
    text, x, z, y = matrix_text(form)
    path = tmp_path / "offsets.csv"
    path.write_text(text)
    file = read_points(path)
    assert file.offsets and file.table.shape == (54, 3)
    for station, breadth, level in file.table.tolist():
        assert breadth == y[list(x).index(station), list(z).index(level)]
    for (station, *_), line in zip(file.points.tolist(), file.lines, strict=True):
        assert form == "waterlines" or text.split("\n")[line - 1].startswith(f"{station:g}")
    cli("fair", path, "--tol", 0.001, "-o", "out.csv")
    out = read_points(tmp_path / "out.csv")
    assert out.cells is not None and (out.table[:, [0, 2]] == file.table[:, [0, 2]]).all()
    moved = np.abs(out.table - file.table).max()
    assert 0 < moved <= 0.001 * (1 + 1e-12)
    assert (tmp_path / "out.csv").read_text().split("\n")[:2] == text.split("\n")[:2]


def test_what_a_matrix_lacks(tmp_path):
    text, *_ = matrix_text("waterlines")
    path = tmp_path / "offsets.csv"
    head, first, *rest = text.split("\n")[1:]
    gone = "\n".join([head, first.replace("; 0.0", "; x"), *rest])
    assert gone != text
    path.write_text(gone)
    assert read_points(path).offsets
    for wrong, words in (
        (text.replace("waterline", "half-breadths"), "what the rows are"),
        (text.replace("WL 0.5", "WL 0.25"), "a second row"),
        (text.replace("WL 0.5", "keel"), "value of a row"),
        (text.replace("WL 0.5;", "WL 0.5; six;"), "found"),
    ):
        path.write_text(wrong)
        with pytest.raises(FairingError, match=words):
            read_points(path)


def drawn(rng):
    """A table with named columns: its text, its points and which rows have a missing cell."""
    inches = rng.random() < 0.2
    comma = not inches and rng.random() < 0.3
    sign = rng.choice([";", "\t"] if comma else [";", "\t", ",", ", "])
    kind = rng.choice(["curve", "waterlines", "buttocks"])
    if kind == "curve":
        names = {"x": "x", "y": "y"} | ({"z": "z"} if rng.random() < 0.5 else {})
    else:
        names = {"x": "Station", "y": "Half-breadth", "z": "Waterline"}
        if kind == "buttocks":
            names = {"x": "station", "y": "buttock", "z": "height"}
    unit = rng.choice(["", " (m)", " [mm]"])
    extra = [n for n in ("no", "remark", "name") if rng.random() < 0.4]
    columns = rng.permutation([*names, *extra]).tolist()
    stations, levels = int(rng.integers(5, 9)), int(rng.integers(5, 9))
    step = 0.125 if inches else 0.001
    if kind == "curve":
        places = [(k, 0.0) for k in range(int(rng.integers(8, 20)))]
        points = [[a * 1.5, np.sin(a / 3), np.cos(a / 3)] for a, _ in places]
    else:
        points = []
        for a in range(stations):
            for b in range(levels):
                bent = 3 + np.sin(a / 3) + 0.1 * b * b
                points.append([a * 2.0, *((bent, b) if kind == "waterlines" else (b, bent))])
    points = np.round(np.array(points) / step) * step
    gone = set()
    if kind != "curve":
        gone = set(rng.choice(len(points), int(rng.integers(0, 3)), replace=False).tolist())
    bent = 2 if kind == "buttocks" else 1
    lines = [sign.join(names.get(c, c) + (unit if c in names else "") for c in columns)]
    if rng.random() < 0.5:
        lines.insert(0, "# of a hull, 1952")
    for k, point in enumerate(points):
        cells = []
        for c in columns:
            if c not in names:
                cells.append(f"{k}" if c == "no" else f"p{k}")
                continue
            axis = "xyz".index(c)
            text = sixteenths(point[axis]) if inches else f"{point[axis]:.3f}"
            if k in gone and axis == bent:
                text = str(rng.choice(["", "x", "-"]))
            cells.append(text.replace(".", ",") if comma else text)
        lines.append(sign.join(cells))
    kept = [k for k in range(len(points)) if k not in gone]
    return "\n".join(lines) + "\n", points[kept][:, : 3 if "z" in names else 2], kind, inches


@pytest.mark.parametrize("seed", range(400 if SOAK else 40))
def test_tables_of_every_kind_come_back_in_their_form(tmp_path, seed):
    rng = np.random.default_rng(seed)
    text, points, kind, inches = drawn(rng)
    path = tmp_path / "table.csv"
    path.write_text(text)
    file = read_points(path)
    rows = file.points if file.table is None else file.table
    assert file.offsets == (kind != "curve") and file.moves == (2 if kind == "buttocks" else 1)
    assert np.abs(rows - points).max() <= 1e-12
    # Written as it was read, not a character changes; moved numbers change in their cells alone.
    one = file if file.table is None else dataclasses.replace(file, blocks=[range(len(rows))])
    assert points_text(rows, one) == text
    moved = rows.copy()
    step = 1 / 16 if inches else 1e-9
    moved[2:5, file.moves] += step * np.array([3, -5, 1])
    path.write_text(points_text(moved, one, step=0))
    again = read_points(path)
    assert ((again.points if again.table is None else again.table) == moved).all()
    changed = [a != b for a, b in zip(path.read_text().split("\n"), text.split("\n"), strict=True)]
    assert sum(changed) == 3


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name,x,y\n" + "".join(f"{k},{k},{k}\n" for k in range(8)) + "8,8,\n", "`y` is empty"),
        ("name,x,y\n" + "".join(f"{k},{k},{k}\n" for k in range(8)) + "8,8\n", "3 cells, found 2"),
        ("x (m),y (mm)\n" + "1,2\n" * 8, "one unit"),
        (
            "station,half-breadth,height\n"
            + "".join(f"{s},{z},{z}\n" for s in range(6) for z in range(5))
            + "3,2.5,2\n",
            "a second half-breadth at station 3, height 2: 2.5, and 2 in line 19",
        ),
    ],
)
def test_cells_that_lack_or_repeat(tmp_path, text, words):
    path = tmp_path / "table.csv"
    path.write_text(text)
    with pytest.raises(FairingError, match=words):
        read_points(path)


def test_heights_at_buttocks(cli, tmp_path):
    """Heights move, stations and buttocks stay; rows of buttocks as well as named columns."""
    x, b = np.arange(9.0), np.arange(6.0) / 4
    z = np.round(0.2 + 0.3 * b[None] ** 2 + 0.01 * (x[:, None] - 4) ** 2, 2)
    text = "buttock; " + "; ".join(f"{a:g}" for a in x) + "\n"
    text += "".join(f"{v:g}; " + "; ".join(f"{q:.2f}" for q in z[:, k]) + "\n"
                    for k, v in enumerate(b))  # fmt: skip
    (tmp_path / "b.csv").write_text(text)
    file = read_points(tmp_path / "b.csv")
    assert file.moves == 2 and file.table.shape == (54, 3)
    for station, buttock, height in file.table.tolist():
        assert height == z[list(x).index(station), list(b).index(buttock)]
    done = cli("fair", "b.csv", "--tol", 0.005, "-o", "out.csv")
    assert "heights move; stations and buttocks stay" in done.stdout + done.stderr
    out = read_points(tmp_path / "out.csv")
    assert (out.table[:, :2] == file.table[:, :2]).all()
    assert 0 < np.abs(out.table - file.table).max() <= 0.005 * (1 + 1e-12)


STATIONS = [
    (0, [0, 0.3, 0.6, 0.8, 0.9]),
    (1, [0.5, 0.8, 1.1, 1.3, 1.4]),
    (2, [0.9, 1.2, 1.5, 1.7, 1.8]),
    (3, [1.1, 1.4, 1.7, 1.9, 2.0]),
    (4, [1.2, 1.5, 1.8, 2.0, 2.1]),
]
LEVELS = [0.5, 1, 1.5, 2, 2.5]


def as_matrix(corner, heads, label="{:g}", sign=","):
    rows = [sign.join([label.format(s), *map(str, row)]) for s, row in STATIONS]
    return "\n".join([sign.join([corner, *heads]), *rows]) + "\n"


def as_list(names, row, by_levels=False):
    cells = [(s, w, y) for s, ys in STATIONS for w, y in zip(LEVELS, ys, strict=True)]
    if by_levels:
        cells.sort(key=lambda cell: (cell[1], cell[0]))
    return "\n".join([names, *(row(*cell) for cell in cells)]) + "\n"


NUMBERS = [f"{w:g}" for w in LEVELS]
PLAIN = "{0},{1},{2}".format
OFFICE_FORMS = {
    "matrix": (as_matrix("station", NUMBERS), 1, None),
    "capital": (as_matrix("Station", NUMBERS), 1, None),
    "labels": (as_matrix("St.", [f"WL {w}" for w in NUMBERS], "St {:g}"), 1, None),
    "labels in metres": (as_matrix("station", [f"WL {w} m" for w in NUMBERS]), 1, "m"),
    "heads in metres": (as_matrix("station", [f"{w} m" for w in NUMBERS]), 1, "m"),
    "corner in mm": (as_matrix("station (mm)", NUMBERS), 1, "mm"),
    "tabs": (as_matrix("station", NUMBERS, sign="\t"), 1, None),
    "pipes": (as_matrix("station", NUMBERS, sign="|"), 1, None),
    "title": ("Hull 123 half-breadths\n" + as_matrix("station", NUMBERS), 1, None),
    "comment": ("# Hull 123\n" + as_matrix("station", NUMBERS), 1, None),
    "x, z, y": (as_list("x,z,y", PLAIN), 1, None),
    "words": (as_list("station,waterline,half-breadth", PLAIN), 1, None),
    "by levels": (as_list("station,waterline,half-breadth", PLAIN, by_levels=True), 1, None),
    "words with axes": (as_list("station_x,waterline_z,half_breadth_y", PLAIN), 1, None),
    "numbers beside": (
        as_list("station_index,station_x,waterline_z,half_breadth_y", "{0},{0},{1},{2}".format),
        1,
        None,
    ),
    "decimal commas": (
        as_list(
            "Station;Waterline;Half breadth",
            lambda s, w, y: f"{s:.1f};{w:.1f};{y:.1f}".replace(".", ","),
        ),
        1,
        None,
    ),
    "from bow to stern": (
        as_list("station,waterline,half-breadth", PLAIN).replace("\n", "\r\n"),
        1,
        None,
    ),
    "mm": (
        as_list(
            "station (mm),waterline (mm),half-breadth (mm)",
            lambda s, w, y: f"{1000 * s:.0f},{1000 * w:.0f},{1000 * y:.0f}",
        ),
        1000,
        "mm",
    ),
}


@pytest.mark.parametrize("form", OFFICE_FORMS)
def test_forms_of_one_table_are_the_same_offsets(form, tmp_path):
    text, scale, unit = OFFICE_FORMS[form]
    path = tmp_path / "t.csv"
    path.write_text(text)
    file = read_points(path)
    wanted = sorted((s, y, w) for s, ys in STATIONS for w, y in zip(LEVELS, ys, strict=True))
    assert file.offsets and file.unit == unit
    assert np.abs(np.array(sorted(map(tuple, file.table / scale))) - wanted).max() < 1e-12
    assert len(file.blocks) == len(STATIONS) + len(LEVELS)


def test_a_sheer_beside_waterlines_is_a_line_of_its_own(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text(as_matrix("station", [*NUMBERS, "sheer"]).replace("0.9\n", "0.9,1\n"))
    file = read_points(path)
    assert file.table.shape == (26, 3) and len(file.blocks) == len(STATIONS) + len(LEVELS)
    assert any("sheer (plan)" in note for note in file.notes)
    assert file.point_names[0] == "station 0, waterline 0.5"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (as_matrix("", NUMBERS), "line 1: a matrix of offsets?"),
        (as_matrix("station", [*NUMBERS, "about"]), "line 1: .* found `about`"),
        (as_matrix("station", ["0.5 m", "1 ft", *NUMBERS[2:]]), "line 1: positions in ft and m"),
        (as_list("station (m),waterline (m),half-breadth (mm)", PLAIN), "columns in m and mm"),
    ],
)
def test_forms_that_say_too_little_are_refused_at_the_cell(text, said, tmp_path):
    path = tmp_path / "t.csv"
    path.write_text(text)
    with pytest.raises(FairingError, match=said):
        read_points(path)


def test_a_curve_in_space_is_no_table(tmp_path):
    t = np.linspace(0, 1, 30)
    path = tmp_path / "t.csv"
    rows = [f"{x:.3f},{y:.3f},{z:.3f}" for x, y, z in zip(t, t**2, np.sin(t), strict=True)]
    path.write_text("x,y,z\n" + "\n".join(rows) + "\n")
    assert not read_points(path).offsets


@pytest.mark.parametrize(("unit", "flag"), [(None, 2), ("m", 6), ("in", 1), ("ft", 4), ("cm", 10)])
def test_splines_are_written_in_the_unit_of_the_table(unit, flag, tmp_path):
    from moldloft.fairing import Spline
    from moldloft.fairing.spline_files import encoded

    x = np.linspace(0, 3, 9)
    curve = Spline.interpolate(np.c_[x, np.sin(x)])
    lines = encoded([curve], tmp_path / "o.igs", unit).decode().splitlines()
    words = "".join(s[:72].rstrip() for s in lines if s[72] == "G").split(",")
    # The first word is a comma.
    assert int(words[14]) == flag
    dxf = encoded([curve], tmp_path / "o.dxf", unit).decode().splitlines()
    assert ("$INSUNITS" in dxf) == (unit is not None)
