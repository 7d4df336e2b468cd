"""Stability against an independent solver, the example of the IS Code, weights, units."""

from __future__ import annotations

import json
import math
import os

import numpy as np
import pytest

import moldloft
from moldloft.hydro.stability import Wind
from moldloft.starter import BOX
from moldloft.units import Units

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def boxes(parts, length):
    """A program of boxes lengthwise: (y0, y1, z0, z1) each."""
    text = ""
    for k, (y0, y1, z0, z1) in enumerate(parts):
        names = {}
        for i, x in enumerate((-length / 2, length / 2)):
            for j, y in enumerate((y0, y1)):
                for m, z in enumerate((z0, z1)):
                    name = names[i, j, m] = f"p{k}_{i}{j}{m}"
                    text += f"AbsPoint {name}({x!r}, {y!r}, {z!r});\n"

        def line(name, a, b, names=names, k=k):
            return f"Line {name}{k}({names[a]}, {names[b]});\n"

        text += line("ab", (0, 0, 0), (1, 0, 0)) + line("cd", (0, 1, 0), (1, 1, 0))
        text += line("ef", (0, 0, 1), (1, 0, 1)) + line("gh", (0, 1, 1), (1, 1, 1))
        text += line("ac", (0, 0, 0), (0, 1, 0)) + line("eg", (0, 0, 1), (0, 1, 1))
        text += line("bd", (1, 0, 0), (1, 1, 0)) + line("fh", (1, 0, 1), (1, 1, 1))
        text += f"RuledSurf bottom{k}(ab{k}, cd{k}, orientation = 1);\n"
        text += f"RuledSurf top{k}(ef{k}, gh{k}); RuledSurf port{k}(ab{k}, ef{k});\n"
        text += f"RuledSurf far{k}(cd{k}, gh{k}, orientation = 1);\n"
        text += f"RuledSurf bow{k}(ac{k}, eg{k}, orientation = 1);\n"
        text += f"RuledSurf stern{k}(bd{k}, fh{k});\n"
    return text


def clipped(polygon, heel, level):
    """Area and first moments of the part of a polygon (y, z) below the water, by its corners."""
    c, s = math.cos(heel), math.sin(heel)
    points = [(y * c + z * s, z * c - y * s) for y, z in polygon]
    kept = []
    for (p, q), (r, t) in zip(points, points[1:] + points[:1], strict=True):
        if q <= level:
            kept.append((p, q))
        if (q < level) != (t < level):
            share = (level - q) / (t - q)
            kept.append((p + share * (r - p), level))
    if len(kept) < 3:
        return np.zeros(3)
    a = np.array(kept)
    b = np.roll(a, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
    return np.array(
        [cross.sum() / 2, ((a + b)[:, 0] * cross).sum() / 6, ((a + b)[:, 1] * cross).sum() / 6]
    )


def arm(parts, area, centre, heel):
    """The righting arm of a prism that displaces `area` of its section."""
    polygons = [[(a, c), (b, c), (b, d), (a, d)] for a, b, c, d in parts]
    low, high = -100.0, 100.0
    for _ in range(200):
        level = 0.5 * (low + high)
        if sum(clipped(p, heel, level)[0] for p in polygons) > area:
            high = level
        else:
            low = level
    total = sum(clipped(p, heel, level) for p in polygons)
    across = centre[0] * math.cos(heel) + centre[1] * math.sin(heel)
    return total[1] / total[0] - across


@pytest.mark.parametrize("seed", range(100 if SOAK else 4))
def test_prisms_against_an_independent_solver(seed):
    random = np.random.default_rng(seed)
    beam, depth, length = random.uniform([2, 1, 8], [5, 4, 20])
    if seed % 2:
        gap = random.uniform(1, 4)
        parts = [(-gap - beam, -gap, 0.0, depth), (gap, gap + beam, 0.0, depth)]
    else:
        parts = [(-beam, beam, 0.0, depth)]
    parts = [tuple(float(x) for x in part) for part in parts]
    area = sum((b - a) * (d - c) for a, b, c, d in parts) * random.uniform(0.25, 0.7)
    kg = float(depth * random.uniform(0.2, 1.4))
    model = moldloft.loads(boxes(parts, float(length)))
    stability = model.stability(area * length, cg=(0, 0, kg), density=1, free_trim=False)
    heels = [math.radians(a) for a in (4, 17, 38, 88, 130)]
    for heel in heels:
        exact = arm(parts, area, (0, kg), heel)
        assert stability.gz(heel) == pytest.approx(exact, abs=1e-9 * (1 + beam)), heel
    # Metacentre: the slope at the origin.
    slope = arm(parts, area, (0, kg), 1e-5) / 1e-5
    assert stability.gmt == pytest.approx(slope, abs=1e-6)
    assert stability.stable == (slope > 0)
    loll = stability.loll()
    if loll is not None:
        assert arm(parts, area, (0, kg), loll) == pytest.approx(0, abs=1e-8)
        assert arm(parts, area, (0, kg), loll / 2) < 0
    vanishing = stability.vanishing()
    if vanishing is not None:
        assert arm(parts, area, (0, kg), vanishing) == pytest.approx(0, abs=1e-8)
    # The area is exact: trapezoids of the oracle's arms come near it, corners or not.
    fine = np.linspace(0.1, 0.4, 201)
    arms = np.array([arm(parts, area, (0, kg), h) for h in fine])
    near = float((arms[1:] + arms[:-1]).sum() * 0.3 / 400)
    assert stability.area(0.1, 0.4) == pytest.approx(near, abs=2e-5 * beam)


def test_the_angle_of_loll_of_a_box():
    model = moldloft.loads(BOX)
    found = model.equilibrium(40, cg=(0, 0, 0.9), density=1)
    # KG 1.9 over a draught of 1: BM 4/3, GM -1/15.
    assert found.lolls and found.stable
    assert found.heel == pytest.approx(math.atan(math.sqrt(0.1)), abs=1e-9)
    stability = model.stability(40, cg=(0, 0, 0.9), density=1)
    assert not stability.stable
    assert stability.loll() == pytest.approx(math.atan(math.sqrt(0.1)), abs=1e-9)
    assert math.degrees(stability.vanishing()) == pytest.approx(49.2098952, abs=1e-6)
    # With KG 2.4 it overturns at every angle.
    high = model.stability(40, cg=(0, 0, 1.4), density=1)
    assert high.loll() is None and high.vanishing() is None and high.range() == 0
    upside_down = model.equilibrium(40, cg=(0, 0, 1.4), density=1)
    assert upside_down.stable and abs(upside_down.heel) == pytest.approx(math.pi, abs=1e-6)


def test_an_unstable_state_is_told_so(cli, tmp_path):
    path = tmp_path / "box.sdl"
    path.write_text(BOX)
    options = ["--displacement", 40, "--cg=0,0,1.4", "--density", 1, "--fixed", "both"]
    done = cli("hydro", path, *options)
    assert "unstable" in done.stderr and "stable" in done.stdout
    held = moldloft.loads(BOX).equilibrium(40, cg=(0, 0, 1.4), free=(), density=1)
    assert held.stable is False and held.gmt < 0


# The worked example: L 60, B 12, D 7, d 3.5, KG 4.4, rho 1.025, A 250 m², Z 5 m.
SHIP = 'Model info(units = "m t");\n' + boxes([(-6.0, 6.0, 0.0, 7.0)], 60.0)


def test_the_worked_example_of_the_weather_criterion(tmp_path, cli):
    ship = moldloft.loads(SHIP)
    s = ship.stability(2583, cg=(0, 0, 4.4), density="salt", free_trim=False)
    assert s.gmt == pytest.approx(0.7785714286, abs=1e-9)
    arms = {10: 0.144452820, 20: 0.343959494, 30: 0.675, 40: 0.828068153, 60: 0.323586396}
    for heel, exact in arms.items():
        assert s.gz(math.radians(heel)) == pytest.approx(exact, abs=2e-9), heel
    heel, largest = s.largest()
    assert (math.degrees(heel), largest) == pytest.approx((38.0809561, 0.834379101), abs=1e-6)
    assert math.degrees(s.vanishing()) == pytest.approx(68.3360999, abs=1e-6)
    edge = math.radians(30.2564372)
    found = s.assess(wind=Wind(250, 5), deck_edge=edge)
    assert [c.result for c in found.checks] == ["pass"] * 7 and found.passed
    attained = [c.attained for c in found.checks]
    exact = [0.139838979, 0.278454735, 0.138615756, 0.834379101, 38.0809561, 0.7785714286]
    assert attained[:6] == pytest.approx(exact, abs=5e-7)
    details = {
        "lw1": 0.024862634,
        "lw2": 0.037293951,
        "X1": 0.8142857,
        "X2": 1.0,
        "roll_period": 11.5885703,
        "s": 0.06788001,
        "r": 0.88428571,
        "phi0": 1.8258880,
        "phi1": 21.7455581,
        "phi2": 50.0,
        "first_intercept": 2.7318408,
        "second_intercept": 67.4126809,
        "a": 0.066964615,
        "b": 0.378521388,
    }
    for name, value in details.items():
        assert found.details[name] == pytest.approx(value, rel=2e-6), name
    margin = found.checks[0]
    assert margin.margin == pytest.approx(0.139838979 - 0.055, abs=1e-7)
    path = tmp_path / "ship.sdl"
    path.write_text(SHIP)
    options = ["--displacement", 2583, "--cg=0,0,4.4", "--density", "salt", "--fixed", "trim"]
    done = cli("hydro", path, *options, "--criteria", "--wind", "250,5")
    assert "2.3" in done.stdout and "pass" in done.stdout
    data = json.loads(cli("hydro", path, *options, "--criteria", "--json", status=1).stdout)
    assert data["passed"] is False
    assert data["checks"][-1]["result"] == "data missing"


def test_flooding_ends_the_areas():
    ship = moldloft.loads(SHIP)
    opening = {"door": (0, 6, 5.5)}
    s = ship.stability(2583, cg=(0, 0, 4.4), density="salt", free_trim=False, openings=opening)
    angle, name = s.flooding()
    assert name == "door" and angle < math.radians(30)
    found = s.assess()
    assert found.checks[0].result == "fail" and "floods" in found.checks[0].note
    assert not found.passed


def test_criteria_of_a_file(tmp_path):
    rule = tmp_path / "own.json"
    clause = {"clause": "1", "what": "GM", "kind": "GM", "least": 1.0}
    rule.write_text(json.dumps({"title": "own", "clauses": [clause]}))
    ship = moldloft.loads(SHIP)
    s = ship.stability(2583, cg=(0, 0, 4.4), density="salt", free_trim=False)
    found = s.assess(str(rule))
    assert found.rule == "own" and found.checks[0].result == "fail"
    rule.write_text(json.dumps({"clauses": [{"clause": "1", "what": "?", "kind": "beauty"}]}))
    with pytest.raises(moldloft.Error, match="beauty"):
        s.assess(str(rule))
    rule.write_text(json.dumps({"clauses": [{"clause": "1", "what": "GM", "kind": "GM"}]}))
    with pytest.raises(moldloft.Error, match="least"):
        s.assess(str(rule))
    rule.write_text("[]")
    with pytest.raises(moldloft.Error, match="clauses"):
        s.assess(str(rule))
    with pytest.raises(moldloft.Error, match="unknown rule"):
        s.assess("solas")


def test_cross_curves_of_the_box():
    from moldloft.hydro.stability import cross_curves

    ship = moldloft.loads(SHIP)
    found = cross_curves(ship, [2520.0], [math.radians(10), math.radians(30)], free_trim=False)
    gz = [0.144452820, 0.675]
    exact = [g + 4.4 * math.sin(h) for g, h in zip(gz, found.heels, strict=True)]
    assert found.kn[0] == pytest.approx(exact, abs=1e-8)
    assert found.csv().startswith("volume [m³],KN [m] at 10 deg")


LOADED = (
    'Model info(units = "m t");\nparam float light = 30 in [10, 60];\n'
    + boxes([(-2.0, 2.0, -1.0, 1.5)], 10.0)
    + 'Weight shell({0, 0, 0}, mass = light, group = "structure");\n'
    'Weight engine({0.5, 0, -0.5}, mass = 10, group = "machinery", margin = 10);\n'
    "Weight plate(bottom0, per = 0.01);\nWeightSum all({shell, engine, plate});\n"
)


def test_weights_float_the_model(cli, tmp_path):
    model = moldloft.loads(LOADED)
    table = model.weights()
    assert table.mass == pytest.approx(30 + 11 + 0.4)
    assert model.eval("all.mass") == pytest.approx(table.mass)
    assert model.eval("all.centre") == pytest.approx(table.centre)
    assert table.groups["machinery"][0] == pytest.approx(11)
    found = model.equilibrium(density=1.025, by=["light"])
    assert found.volume == pytest.approx(table.mass / 1.025)
    assert found.derivatives["volume"]["light"] == pytest.approx(1 / 1.025)
    path = tmp_path / "loaded.sdl"
    path.write_text(LOADED)
    done = cli("hydro", path, "--weights", "--density", "salt")
    assert "engine" in done.stdout and "mass [t]" in done.stdout and "volume" in done.stdout


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Weight w({0, 0, 0});", "without mass"),
        ("Weight w({0, 0, 0}, mass = -1);", "not negative"),
        ("Weight w({0, 0, 0}, per = 1);", "no size"),
        ("Weight w({0, 0, 0}, mass = 1, per = 1);", "twice"),
        ('Weight w({0, 0, 0}, mass = 1, status = "guessed");', "unknown status"),
        ("Weight w({0, 0, 0}, mass = 0); WeightSum s({w});", "no mass"),
        ("AbsPoint p(0, 0, 0); WeightSum s({p});", "of weights"),
        ('Model info(units = "furlong");', "not a unit"),
        ('Model info(units = "m ft");', "not a unit"),
    ],
)
def test_bad_weights_and_units(text, words):
    with pytest.raises(moldloft.ModelError, match=words):
        moldloft.loads(text)


def test_what_cannot_float_says_why():
    box = moldloft.loads(BOX)
    with pytest.raises(moldloft.Error, match="density"):
        box.equilibrium(40)
    with pytest.raises(moldloft.Error, match="no floating mass"):
        box.equilibrium(density=1)
    with pytest.raises(moldloft.Error, match="unit of length"):
        box.hydrostatics(density="salt")
    with pytest.raises(moldloft.Error, match="density"):
        box.stability(40, cg=(0, 0, 0))
    with pytest.raises(moldloft.Error, match="no mass and centre"):
        box.stability(density=1)
    with pytest.raises(moldloft.Error, match="converted"):
        box.hydrostatics(density=1).converted("m")
    with pytest.raises(moldloft.Error, match="not a unit"):
        Units.parse("furlong")


def test_units_stand_beside_every_figure(cli, tmp_path):
    path = tmp_path / "ship.sdl"
    path.write_text(SHIP)
    done = cli("hydro", path, "--level", 3.5, "--density", "salt")
    assert "volume" in done.stdout and "2520 m³" in done.stdout and "2583 t" in done.stdout
    done = cli("hydro", path, "--level", 3.5, "--density", "salt", "--units", "ft LT")
    assert "88992.96 ft³" in done.stdout and "2542.2" in done.stdout
    cli("hydro", path, "--table", "1,3,3", "--density", "fresh", "--csv", tmp_path / "t.csv")
    head = (tmp_path / "t.csv").read_text().splitlines()[0]
    assert "volume [m³]" in head and "displacement [t]" in head and "heel [deg]" in head
    data = json.loads(cli("hydro", path, "--level", 1, "--heel", 5, "--json").stdout)
    assert data["units"]["volume"] == "m³" and data["heel"] == pytest.approx(5)
    # Without water there is no mass.
    assert "displacement" not in data


def test_mass_is_never_volume_by_accident():
    ship = moldloft.loads(SHIP)
    assert ship.hydrostatics(level=3.5).displacement is None
    assert ship.hydrostatics(level=3.5, density="salt").displacement == pytest.approx(2583)
    assert ship.hydrostatics(level=3.5, density="fresh").displacement == pytest.approx(2520)
    assert ship.hydrostatics(level=3.5, density=1.025).displacement == pytest.approx(2583)


@pytest.mark.parametrize(
    "rows",
    [
        ["--kn", "1000,2000", "--gz", "0,40,5"],
        ["--sections", "-9,9,7", "--table", "1,3,3"],
        ["--table", "1,3,3"],
        ["--gz", "0,40,5", "--displacement", "1500", "--cg", "0,0,3"],
    ],
)
def test_rows_as_csv_json_and_plot(rows, cli, tmp_path):
    path = tmp_path / "ship.sdl"
    path.write_text(SHIP)
    words = ["hydro", path, "--density", "salt", *rows]
    data = json.loads(cli(*words, "--json", "--plot", "p.svg", "--csv", "t.csv").stdout)
    assert data
    lines = (tmp_path / "t.csv").read_text().splitlines()
    assert "[" in lines[0] and len(lines) > 2
    assert "<svg" in (tmp_path / "p.svg").read_text()
    assert cli(*words, "--csv", "-").stdout.splitlines() == lines


def test_criteria_as_csv(cli, tmp_path):
    path = tmp_path / "ship.sdl"
    path.write_text(SHIP)
    words = ["hydro", path, "--density", "salt", "--displacement", "1500", "--cg", "0,0,3"]
    lines = cli(*words, "--criteria", "--csv", "-", status=1).stdout.splitlines()
    assert len(lines) > 6 and lines[0].startswith("clause")
    assert "--plot is of" in cli(*words, "--criteria", "--plot", "c.png", status=1).stderr
