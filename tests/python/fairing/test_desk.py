"""The fairing desk as an API: commands, their log, and what it comes to."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

import moldloft
from hull_table import hull
from moldloft.errors import FairingError
from moldloft.fairing import Desk, Spline, fair
from moldloft.fairing.desk_source import DeskSource

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
ROUNDING = 1e-13
"""A model has the spline over [0, 1]: of sizes of 10 some of the last bits."""


def sine(n: int = 41, noise: float = 0.01, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    x = np.linspace(0, 10, n)
    return np.column_stack([x, 2 * np.sin(0.3 * x)]) + rng.uniform(-noise, noise, (n, 2))


def same(a: Desk, b: Desk) -> bool:
    """Equal bit for bit: points and control points of all lines."""
    one, two = a.result, b.result
    return one.points == two.points and all(
        (p.after.control_points == q.after.control_points).all()
        and (p.after.knots == q.after.knots).all()
        for p, q in zip(one.curves, two.curves, strict=True)
    )


def test_a_desk_is_what_fair_says() -> None:
    points = sine()
    desk = Desk(points, 0.02)
    expected = fair(points, 0.02)
    assert (desk.result.curves[0].after.control_points == expected.control_points).all()
    desk.run("goal fairest")
    desk.run("tolerance 0.03")
    expected = fair(points, 0.03, goal="fairest")
    assert (desk.result.curves[0].after.control_points == expected.control_points).all()
    assert desk.result.curves[0].certified and desk.result.curves[0].kept
    # Own tolerances and weights.
    desk.run("tolerance 0.001 point 20")
    desk.run("weight 2 point 10")
    limits = np.full(41, 0.03)
    limits[19], limits[9] = 0.001, 0.015
    expected = fair(points, limits, goal="fairest")
    assert (desk.result.curves[0].after.control_points == expected.control_points).all()


def test_marks_are_those_of_fair() -> None:
    angle = np.linspace(0, np.pi / 2, 9)[1:-1]
    bilge = np.column_stack([2 + np.sin(angle), 1 - np.cos(angle)])
    flat = np.column_stack([np.linspace(0, 2, 9), np.zeros(9)])
    side = np.column_stack([np.full(9, 3.0), np.linspace(1, 3, 9)])
    points = np.vstack([flat, bilge, side])
    points += np.random.default_rng(1).uniform(-0.003, 0.003, points.shape)
    desk = Desk(points, 0.005)
    for command in ("flat 1-9", "flat 17-25", "arc 9-17"):
        desk.run(command)
    shape = ["straight=1-9:1,0,0", "straight=17-25:0,1,0", "arc=9-17"]
    expected = fair(points, 0.005, shape=shape)
    assert (desk.result.curves[0].after.control_points == expected.control_points).all()
    # Marking again takes the mark away.
    desk.run("arc 9-17")
    assert [text for _, text in desk.state.shapes] == shape[:2]
    desk.run("clear line 1")
    desk.run("one-way 1-25")
    assert desk.result.curves[0].inflections[1] == 0
    with pytest.raises(FairingError, match="expected points A-B from 1 to 25"):
        desk.run("arc 3-40")
    assert desk.log[-1] == "one-way 1-25"


def test_a_range_leaves_the_outside_to_the_bit() -> None:
    points = sine(60, 0.01)
    desk = Desk(points, 0.02)
    desk.run("range 20-42")
    curve = desk.result.curves[0]
    before, after = curve.before, curve.after
    outside = np.r_[0:20, 41:60]
    assert (np.array(desk.result.points)[outside, :2] == points[outside]).all()
    _, at, _ = Spline._interpolated(points, 3, "chord", False, ())
    t = np.r_[np.linspace(0, at[19], 200), np.linspace(at[41], 1, 200)]
    assert (before(t) == after(t)).all()
    # What is inside has moved, is fairer and stays within the tolerance.
    inside = np.linspace(at[21], at[39], 300)
    moved = np.linalg.norm(before(inside) - after(inside), axis=1)
    assert 1e-3 < moved.max() <= 0.02 * (1 + 1e-9)
    k = np.sign(after.curvature(inside))
    assert (k[:-1] != k[1:]).sum() < (np.diff(np.sign(before.curvature(inside))) != 0).sum() / 3
    assert curve.kept and curve.certified
    with pytest.raises(FairingError, match="at least 5 points"):
        desk.run("range 20-22")
    desk.run("range off")
    assert (desk.result.curves[0].after.control_points == fair(points, 0.02).control_points).all()


def test_points_are_dragged_pinned_and_freed() -> None:
    points = sine()
    desk = Desk(points, 0.02)
    first = desk.result
    desk.run("move 21 5 2.05")
    assert np.abs(np.array(desk.result.points[20]) - (5, 2.05, 0)).max() < 1e-12
    assert np.isfinite(desk.compared()).all() and desk.compared()[0] > 0.02
    desk.run("free 21")
    assert desk.result.points == first.points


def test_suspects_are_accepted_one_by_one() -> None:
    points = sine(41, 0.004)
    points[12, 1] += 0.3
    desk = Desk(points, 0.01)
    [found] = [s for s in desk.result.suspects if s.kind == "outlier"]
    assert found.point == 12 and not found.accepted and found.reading is not None
    # Its neighbours say that it is on the curve.
    assert abs(found.reading[1] - 2 * np.sin(0.3 * found.reading[0])) < 0.01
    bends = desk.result.curves[0].inflections[1]
    desk.run("accept 13")
    assert desk.result.curves[0].inflections[1] == 0 < bends
    assert next(s for s in desk.result.suspects if s.point == 12).accepted
    desk.run("accept 13")
    assert desk.result.curves[0].inflections[1] == bends


def test_wrong_readings_of_a_network_are_suspects(tmp_path: Path) -> None:
    # Every inner cell but those beside the rim, one at a time.
    clean = [row.split(",") for row in hull().splitlines()]
    (tmp_path / "clean.csv").write_text(hull())
    desk = Desk.open(tmp_path / "clean.csv", 0.006)
    assert not [s for s in desk.result.suspects if s.kind == "outlier"]
    cells = [(i, j) for i in range(3, 6) for j in range(3, 10)]
    found = 0
    for number, (i, j) in enumerate(cells if SOAK else cells[::3]):
        rows = [list(row) for row in clean]
        off = (0.05, -0.1, 0.3)[number % 3]
        rows[i][j] = f"{float(rows[i][j]) + off:.3f}"
        (tmp_path / "hull.csv").write_text("\n".join(map(",".join, rows)) + "\n")
        desk = Desk.open(tmp_path / "hull.csv", 0.006)
        listed = [s for s in desk.result.suspects if s.kind == "outlier"]
        x, z = float(rows[0][j]), float(rows[i][0])
        place = np.array(desk.state.points)[:, [0, 2]]
        point = int(np.flatnonzero((np.abs(place - (x, z)) < 1e-9).all(axis=1))[0])
        if listed and listed[0].point == point:
            found += 1
            reading = listed[0].reading
            assert reading is not None and abs(reading[1] - float(clean[i][j])) < abs(off) / 2
            desk.run(f"accept {point + 1}")
            assert desk.state.points[point] == reading
            assert not [s for s in desk.result.suspects if s.point == point]
            desk.run(f"accept {point + 1}")
            assert desk.state.points[point][1] == float(rows[i][j])
    assert found >= 0.9 * len(cells if SOAK else cells[::3]), found


def test_swapped_neighbours_are_swapped_and_freed() -> None:
    points = sine(31, 0.002)
    points[[12, 13]] = points[[13, 12]]
    desk = Desk(points, 0.005)
    [found] = [s for s in desk.result.suspects if s.kind == "order"]
    assert found.point in (12, 13)
    desk.run(f"accept {found.point + 1}")
    assert not [s for s in desk.result.suspects if s.kind == "order"]
    right = sine(31, 0.002)
    assert (np.array(desk.state.points)[:, :2] == right).all()
    desk.run(f"free {found.point + 1}")
    assert (np.array(desk.state.points)[:, :2] == points).all()


def test_a_name_is_no_statement() -> None:
    desk = Desk(DeskSource.of(sine(9), name="a\nAbsPoint evil(0, 0, 0);\r\n"), 0.02)
    assert "AbsPoint" not in desk.program("b").splitlines()[1]
    assert all(s.startswith(("#", "FairCurve", "  ")) for s in desk.program("b").splitlines())


def table(tmp_path: Path) -> Desk:
    (tmp_path / "hull.csv").write_text(hull())
    return Desk.open(tmp_path / "hull.csv", 0.006)


def test_a_network_is_locked_cut_and_put_back(tmp_path: Path) -> None:
    desk = table(tmp_path)
    assert desk.source.kind == "network"
    names = [line.name for line in desk.source.lines]
    assert "station 10" in names and "waterline 2" in names
    k = names.index("waterline 1.1") + 1
    locked = desk.result
    desk.run(f"lock {k}")
    held = [locked.points[p] for p in locked.curves[k - 1].points]
    desk.run("tolerance 0.012")
    desk.run("goal fairest")
    now = desk.result
    assert [now.points[p] for p in now.curves[k - 1].points] == held
    assert now.points != locked.points and now.curves[k - 1].locked
    # Stations and heights stay, half-breadths alone move.
    assert (np.array(now.points)[:, [0, 2]] == np.array(desk.source.points)[:, [0, 2]]).all()
    # A new waterline, between two others.
    desk.run("cut z 1.25")
    cut = desk.cut
    assert cut is not None and np.abs(cut.data[:, 2] - 1.25).max() < 1e-9
    assert len(cut.data) == sum("station" in name for name in names)
    desk.run("put back")
    assert desk.state.draft is None and desk.result.curves[-1].name == "z = 1.25"
    added = desk.result.curves[-1].points
    assert all(
        len(set(added) & set(c.points)) == 1
        for c in desk.result.curves
        if c.name.startswith("station")
    )
    on = np.array([desk.result.points[p] for p in added])
    assert np.abs(on[:, 2] - 1.25).max() < 1e-9
    with pytest.raises(FairingError, match="is in this plane"):
        desk.run("cut x 10")
    assert same(desk, Desk.replay(desk.text))


def test_a_buttock_meets_stations_and_waterlines(tmp_path: Path) -> None:
    desk = table(tmp_path)
    desk.run("cut y 1.5")
    cut = desk.cut
    assert cut is not None and np.abs(cut.data[:, 1] - 1.5).max() < 1e-9
    # Of stations and of waterlines, in order from one end to the other.
    assert len(cut.data) > 8 and (np.diff(cut.data[:, 0]) > 0).all()
    assert np.abs(cut.points[:, 1] - 1.5).max() < 1e-9
    # A diagonal, down from the centreline.
    desk.run("cut 0,1,1:3")
    cut = desk.cut
    assert cut is not None and np.abs(cut.data[:, 1] + cut.data[:, 2] - 3).max() < 1e-8
    assert np.abs(cut.points[:, 1] + cut.points[:, 2] - 3).max() < 1e-8
    desk.run("drop")
    assert desk.cut is None


def test_a_surface(tmp_path: Path) -> None:
    u, v = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(0, 1, 7), indexing="ij")
    grid = np.stack([u, v, (1 - u**2) * (1 - v**2)], -1)
    grid += np.random.default_rng(5).uniform(-0.004, 0.004, grid.shape)
    desk = Desk(grid, 0.01)
    assert desk.source.kind == "surface" and len(desk.result.curves) == 16
    expected = fair(grid, 0.01, as_="fit")
    assert (np.array(desk.result.points).reshape(9, 7, 3) == expected.points).all()
    desk.run("fix 32")
    desk.run("lock 5")
    desk.run("tolerance 0.02")
    assert same(desk, Desk.replay(desk.text))


def of_model(text: str, name: str, t: np.ndarray) -> np.ndarray:
    return np.asarray(moldloft.loads(text)[name](t))


def test_what_is_applied_is_the_same(tmp_path: Path) -> None:
    t = np.linspace(0, 1, 101)
    for log in (
        [], ["goal fairest"], ["fix 7", "knuckle 20", "tolerance 0.001 point 5"],
        ["one-way 1-41", "accept 9"], ["range 9-30"], ["move 12 2.75 1.6"],
        ["straight 1-6", "goal fairest"],
    ):  # fmt: skip
        desk = Desk(sine(), 0.02, log)
        made = of_model(desk.program("rail"), "rail", t)
        assert np.abs(made - desk.result.curves[0].after(t)).max() < ROUNDING, log
    desk = table(tmp_path)
    for command in ("tolerance 0.01", "fix 12", "tolerance 0.002 point 30", "move 40 0 1.5 0"):
        desk.run(command)
    model = moldloft.loads(desk.program("hull"))
    for curve in desk.result.curves:
        name = "hull_" + curve.name.replace(" ", "_").replace(".", "_")
        assert np.abs(np.asarray(model[name](t)) - curve.after(t)).max() < ROUNDING, name


def test_an_applied_surface_is_the_same() -> None:
    u, v = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(0, 1, 6), indexing="ij")
    grid = np.stack([u, v, (1 - u**2) * (1 - v**2)], -1)
    grid += np.random.default_rng(5).uniform(-0.004, 0.004, grid.shape)
    desk = Desk(grid, 0.01, ["fix 20", "goal fairest"])
    model = moldloft.loads(desk.program("shell"))
    [part] = desk.result.parts
    assert np.abs(model["shell"].grid(9, 9) - part.surface.grid(9, 9)).max() < ROUNDING


def test_the_desk_opens_objects_of_a_model() -> None:
    rows = "".join(
        f"AbsPoint P{k}({x!r}, {y!r}, 0);\n" for k, (x, y) in enumerate(sine(9).tolist())
    )
    text = rows + "FairCurve keel({" + ", ".join(f"P{k}" for k in range(9)) + "}, 0.02);\n"
    text += "BCurve rail({P0, P2, P4, P6, P8});\n"
    model = moldloft.loads(text)
    desk = Desk.of_object(model, "keel", 0.02)
    assert desk.source.objects[:2] == ("P0", "P1")
    t = np.linspace(0, 1, 50)
    made = of_model(text + desk.program("again"), "again", t)
    assert (made == np.asarray(model["keel"](t))).all()
    rail = Desk.of_object(model, "rail", 1e-4)
    dense = np.asarray(model["rail"](np.linspace(0, 1, 4001)))
    far = [np.linalg.norm(dense - p, axis=1).min() for p in rail.result.curves[0].before(t)]
    assert max(far) < 2e-3


POLYGON = [(0, 0), (1, 1.2), (2.5, 1.4), (4, 0.4), (5.5, 0.9), (7, 1.1), (8, 0)]


@pytest.mark.parametrize(
    "call",
    [
        "BCurve c({points});",
        "BCurve c({points}, degree = 2);",
        "NURBCurve c({points}, 3, {{0, 0, 0, 0, 0.3, 0.5, 0.9, 1, 1, 1, 1}});",
        "NURBCurve c({points}, weights = {{1, 1, 2, 1, 1, 0.5, 1}});",
        'FairCurve c({points}, 0, as = "control");',
        'FairCurve c({points}, 0.05, as = "control", closed = 1, degree = 2, breaks = {{4}});',
        'FairCurve c({points}, 0.1, as = "control", ends = "tangent", measure = "jumps");',
    ],
)
def test_control_points_are_moved_by_hand(call: str) -> None:
    text = "".join(f"AbsPoint P{k}({x}, {y}, 0);\n" for k, (x, y) in enumerate(POLYGON))
    points = "{" + ", ".join(f"P{k}" for k in range(len(POLYGON))) + "}"
    model = moldloft.loads(text + call.format(points=points))
    desk, t = Desk.of_object(model, "c"), np.linspace(0, 1, 90)
    assert desk.source.control and desk.source.objects == tuple(f"P{k}" for k in range(7))
    # Opened it is the object, and so it is in the text.
    own = np.asarray(model["c"](t))
    assert np.abs(desk.result.curves[0].after(t) - own).max() < 1e-12
    assert np.abs(of_model(text + desk.program("again"), "again", t) - own).max() < 1e-12
    assert desk.result.curves[0].certified and not desk.result.suspects
    # A control point that is moved is there, and the text has its curve.
    desk.run("move 3 2.6 2.2")
    assert desk.result.points[2] == (2.6, 2.2, 0) and desk.state.fixed == {2}
    made = desk.result.curves[0].after(t)
    assert np.abs(of_model(text + desk.program("again"), "again", t) - made).max() < 1e-12
    assert 0.1 < np.abs(made - own).max() < 0.9
    assert "{2.6, 2.2, 0}" in desk.program("again") and "P1" in desk.program("again")
    # What is given back is the object again, to the bit, also from the text of the session.
    again = Desk.replay(desk.text)
    assert again.result.points == desk.result.points
    again.run("free 3")
    assert again.result.points == Desk.of_object(model, "c").result.points


def test_a_range_of_control_points(tmp_path: Path) -> None:
    text = "".join(f"AbsPoint P{k}({x}, {y}, 0);\n" for k, (x, y) in enumerate(POLYGON))
    points = "{" + ", ".join(f"P{k}" for k in range(len(POLYGON))) + "}"
    desk = Desk.of_object(moldloft.loads(text + f"BCurve c({points});"), "c")
    desk.run("tolerance 0.3")
    desk.run("weight 2 point 4")
    desk.run("range 3-5")
    moved, limits = desk.result.curves[0].moved, desk.result.curves[0].limits
    assert not moved[[0, 1, 5, 6]].any() and limits.tolist() == [0, 0, 0.3, 0.15, 0.3, 0, 0]
    assert moved.max() > 0.05 and desk.result.curves[0].kept and desk.result.curves[0].certified
    t = np.linspace(0, 1, 90)
    made = of_model(text + desk.program("again"), "again", t)
    assert np.abs(made - desk.result.curves[0].after(t)).max() < 1e-12
    with pytest.raises(FairingError, match="optima of data"):
        desk.run("one-way 1-7")
    assert desk.log[-1] == "range 3-5"


def test_doubled_control_points_are_sampled() -> None:
    text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 1, 0); AbsPoint C(2, 0, 0); AbsPoint D(3, 1, 0);\n"
    desk = Desk.of_object(moldloft.loads(text + "BCurve c({A, B, B, C, C, D});"), "c")
    assert not desk.source.control and len(desk.source.points) > 6


def test_files(tmp_path: Path) -> None:
    desk = table(tmp_path)
    desk.run("goal fairest")
    again = Desk.open(desk.save(tmp_path / "out.csv"), 0.006)
    # The table is written to the thousandths that it was read with.
    assert np.abs(np.array(again.source.points) - np.array(desk.result.points)).max() <= 5.001e-4
    found = json.loads(desk.encoded("out.json"))
    assert len(found.get("curves", found)) > 0
    sheet = desk.encoded("out.html").decode()
    assert "goal fairest" in sheet and "station 10" in sheet and "program" in sheet
    with pytest.raises(FairingError, match="expected an ending"):
        desk.encoded("out.xyzzy")
    # What did not move stays as it was written.
    still = Desk.open(tmp_path / "hull.csv", 0.0)
    assert still.encoded("still.csv").decode() == (tmp_path / "hull.csv").read_text()


def test_lines_are_faired_one_by_one_and_stopped() -> None:
    blocks = [sine(15, 0.01, seed) + np.array([0, 3 * seed]) for seed in range(30)]
    source = DeskSource.of(np.vstack(blocks))
    parts = [tuple(range(15 * k, 15 * k + 15)) for k in range(30)]
    lines = [{"name": f"line {k + 1}", "points": p, "closed": False} for k, p in enumerate(parts)]
    desk = Desk(DeskSource.from_dict({**source.as_dict(), "lines": lines}), 0.02)
    told: list[tuple[int, int, str]] = []
    desk.fair(lambda *at: told.append(at))
    assert [k for k, _, _ in told] == list(range(30)) and told[4] == (4, 30, "line 5")
    again = Desk(desk.source, 0.02)
    with pytest.raises(FairingError, match="stopped before line 8"):
        again.fair(lambda done, of, name: done < 7)
    assert same(again, desk)


def test_a_preview_is_a_draft_within_the_limits() -> None:
    for seed in range(4):
        desk = Desk(sine(80, 0.01, seed), 0.015)
        for tolerance in (0.003, 0.006, 0.01, 0.02, 0.03):
            draft = desk.preview(f"tolerance {tolerance}").curves[0]
            done = desk.preview(f"tolerance {tolerance}", draft=False).curves[0]
            assert draft.draft and not draft.certified and not done.draft
            assert draft.kept and done.kept
            # Under the same budget as the goal's own curve.
            share = np.mean((draft.moved / tolerance) ** 2) * 3
            assert share <= 0.5 * (1 + 1e-6)
        assert desk.log == ()


def acts(desk: Desk, rng: np.random.Generator) -> str:
    """A command that a hand might give."""
    count, lines = len(desk.state.points), len(desk.state.lines)
    line = desk.state.lines[int(rng.integers(lines))]
    a, b = sorted(rng.choice(len(line.points), 2, replace=False))
    p, q = line.points[a] + 1, line.points[b] + 1
    k = int(rng.integers(1, count + 1))
    x = desk.state.points[k - 1]
    return str(
        rng.choice(
            [
                f"tolerance {rng.uniform(0.005, 0.03):.4g}",
                f"tolerance {rng.uniform(0.001, 0.03):.4g} point {k}",
                f"tolerance {rng.uniform(0.004, 0.03):.4g} line {int(rng.integers(lines)) + 1}",
                f"weight {rng.uniform(0.5, 3):.3g} point {k}",
                "goal fairest", "goal near", f"knuckle {k}", f"fix {k}", f"free {k}",
                f"move {k} {x[0]:.4f} {x[1] + rng.uniform(-0.02, 0.02):.4f} {x[2]:.4f}",
                f"accept {k}", f"one-way {p}-{q}", f"straight {p}-{q}", f"arc {p}-{q}",
                f"range {p}-{q}", "range off", f"clear line {int(rng.integers(lines)) + 1}",
                f"lock {int(rng.integers(lines)) + 1}", f"unlock {int(rng.integers(lines)) + 1}",
                f"cut z {rng.uniform(0.3, 1.9):.3f}", "put back", "drop",
            ]
        )
    )  # fmt: skip


@pytest.mark.parametrize("what", ["curve", "network"])
def test_random_acts(tmp_path: Path, what: str) -> None:
    """Commands, undone and done again at random: the same bits as from the log, and the start."""
    rng = np.random.default_rng(11)
    desk = table(tmp_path) if what == "network" else Desk(sine(25), 0.02)
    begin = desk.result
    done = refused = 0
    seen: dict[tuple[str, ...], tuple[tuple[float, ...], ...]] = {}
    for _ in range(2000 if SOAK else 60):
        way = rng.uniform()
        if way < 0.12 and desk.log:
            desk.undo()
        elif way < 0.2 and desk.undone:
            desk.redo()
        else:
            try:
                desk.run(acts(desk, rng))
                done += 1
            except FairingError:
                refused += 1
        now = desk.result.points
        assert seen.setdefault(desk.log, now) == now
        assert all(c.kept for c in desk.result.curves)
    assert done > 20 and refused
    assert same(desk, Desk.replay(desk.text))
    while desk.undo():
        pass
    assert desk.result.points == begin.points and desk.log == ()
