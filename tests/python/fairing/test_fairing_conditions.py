"""Fairing under conditions: joins, rims, points; knots and weights of one's own."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_interp_spline

import moldloft
from conftest import ROOT
from moldloft import fairing

DATA = ROOT / "examples" / "fairing"
sys.path.insert(0, str(DATA))

import make_data  # noqa: E402


def reported(cli, *arguments):
    return json.loads(cli("fair", *arguments, "--json").stdout)


def line():
    """A long noisy line cut in three, whose ends are common points."""
    t = np.arange(31) / 15
    random = np.random.default_rng(4)
    y = 0.4 * np.sin(2 * t) + 1e-3 * random.standard_normal(31)
    points = np.column_stack([t, y])
    return points[:10], points[9:22], points[21:]


def bend(spline, t):
    """Unit tangent and curvature vector."""
    s = spline.at([t])
    d1, d2 = s.first[0], s.second[0]
    tangent = d1 / np.linalg.norm(d1)
    return tangent, (d2 - tangent * (d2 @ tangent)) / (d1 @ d1)


def test_a_curve_runs_on_from_others():
    fore, middle, aft = line()
    a, b = (fairing.Spline.interpolate(p) for p in (fore, aft))
    turned = fairing.Spline.interpolate(fore[::-1])
    for first in (a, turned):
        joined = moldloft.fair(middle, 0.02, as_="fit", joins=[b, first])
        assert joined.deviation_data <= 0.02 * (1 + 1e-12)
        assert np.abs(joined.points[[0, -1]] - middle[[0, -1]]).max() < 1e-14
        for own, other in (((0.0), bend(a, 1.0)), ((1.0), bend(b, 0.0))):
            tangent, curvature = bend(joined.spline, own)
            assert np.abs(tangent - other[0]).max() < 1e-8
            assert np.abs(curvature - other[1]).max() < 1e-6
    free = moldloft.fair(middle, 0.02, as_="fit")
    assert np.abs(bend(free.spline, 0.0)[1] - bend(a, 1.0)[1]).max() > 1e-2
    assert joined.value > 0.99 * free.value


def test_a_join_by_the_command(cli, model_file, tmp_path):
    fore, middle, _ = line()

    def text(points):
        return "\n".join(f"{x!r}, {y!r}" for x, y in points.tolist())

    path, other = model_file(text(middle), "m.csv"), model_file(text(fore), "f.csv")
    asked = [path, "--tol", "0.02", "--as", "fit", "--join", other]
    reported(cli, *asked, "-o", "out.csv")
    out = np.loadtxt(tmp_path / "out.csv", delimiter=",")
    a = fairing.Spline.interpolate(fore)
    wanted = moldloft.fair(middle, 0.02, as_="fit", joins=[a])
    assert out.tobytes() == wanted.points.tobytes()
    error = cli("fair", path, "--tol", "1e-6", "--as", "fit", "--join", other, status=1).stderr
    assert "join 1" in error and "within the tolerance" in error
    control = ("--as", "control", "--join", other)
    error = cli("fair", path, "--tol", "0.02", *control, status=1).stderr
    assert "as `fit`" in error


def test_contradictions_say_which():
    points = np.loadtxt(DATA / "waisted-noise.csv", delimiter=",", skiprows=1)
    middle = fairing.Spline(points, clamped=False)(0.5)
    with pytest.raises(moldloft.FairingError, match=r"through at 0\.5; through at 0\.5"):
        moldloft.fair(points, 2e-4, through=[(0.5, middle), (0.5, middle + np.array([0, 1e-4, 0]))])
    with pytest.raises(moldloft.FairingError, match=r"through at 0\.5"):
        moldloft.fair(points, 2e-4, through=[(0.5, middle + np.array([0, 1, 0]))], keep=["volume"])
    hull = make_data.wigley()
    place = fairing.SplineSurface(hull, clamped=False).grid([0.5, 0.6], [0.5, 0.6])[0, 0]
    with pytest.raises(moldloft.FairingError) as caught:
        moldloft.fair(
            hull, 2e-4, through=[((0.5, 0.5), place), ((0.5, 0.5), place + np.array([0, 1e-4, 0]))]
        )
    said = str(caught.value)
    assert "conditions 1, 2" in said and "through at 0.5, 0.5" in said
    with pytest.raises(moldloft.FairingError, match=r"keep volume|through at 0\.2"):
        moldloft.fair(hull, 2e-4, keep=["volume"], through=[((0.2, 0.2), (0, 1, 0))])


def test_surfaces_keep_rims_points_and_areas(cli, tmp_path):
    hull = make_data.wigley()
    before = fairing.SplineSurface.interpolate(hull)
    for rims, rows in (("position", 1), ("tangent", 2), ("curvature", 3)):
        faired = moldloft.fair(before, 2e-4, rims=rims)
        same = (faired.surface.control_points == before.control_points).all(axis=2)
        assert same[:rows].all() and same[-rows:].all()
        assert same[:, :rows].all() and same[:, -rows:].all()
        assert not same[rows + 1 : -rows - 1, rows + 1 : -rows - 1].any()
        assert 0 < faired.deviation_certified <= 2e-4
    some = moldloft.fair(before, 2e-4, rims={"v0": "curvature"})
    same = (some.surface.control_points == before.control_points).all(axis=2)
    assert same[:, :3].all() and not same[3:-3, 4:-3].any()
    place = before.grid([0.3, 0.4], [0.6, 0.7])[0, 0] + [0, 1e-4, 0]
    faired = moldloft.fair(
        before, 2e-4, through=[((0.3, 0.6), place)], normals=[((0.5, 0.5), (0, 1, -0.8))]
    )
    look = faired.surface.look([0.3, 0.5], [0.5, 0.6])
    assert np.abs(look.points[0, 1] - place).max() < 1e-12
    normal = look.normals[1, 0] / np.sign(look.normals[1, 0, 1])
    assert np.abs(np.cross(normal, [0, 1, -0.8])).max() < 1e-8

    def area(surface):
        p = surface.grid(161, 161)
        du, dv = p[1:, 1:] - p[:-1, :-1], p[1:, :-1] - p[:-1, 1:]
        return 0.5 * np.linalg.norm(np.cross(du, dv), axis=-1).sum()

    free, kept = moldloft.fair(before, 2e-4), moldloft.fair(before, 2e-4, keep=["area"])
    was = area(before)
    assert abs(area(kept.surface) - was) < 0.7 * abs(area(free.surface) - was)
    # The same by the command.
    data = reported(
        cli, DATA / "wigley.p3d", "--as", "fit", "--tol", "2e-4",
        "--rims", "u0=curvature,v1=position",
        "--through", f"0.3,0.6={','.join(map(repr, place.tolist()))}", "--keep", "volume",
        "-o", "hull.p3d",
    )  # fmt: skip
    assert data["deviation_data"] <= 2e-4 * (1 + 1e-9)
    error = cli("fair", DATA / "wigley.p3d", "--tol", "1", "--rims", "soft", status=1).stderr
    assert "`soft`" in error and "tangent" in error
    error = cli("fair", DATA / "wigley.p3d", "--tol", "1", "--rims", "w=tangent", status=1).stderr
    assert "u0, u1, v0, v1" in error and "`w`" in error
    place = "0.5=1,1,1"
    error = cli("fair", DATA / "wigley.p3d", "--tol", "1", "--through", place, status=1).stderr
    assert "U,V" in error


def test_fitted_surfaces_of_every_form():
    angle = np.arange(20) * 2 * np.pi / 20
    random = np.random.default_rng(2)
    z = np.linspace(0, 2, 9)
    around, up = np.meshgrid(angle, z, indexing="ij")
    ring = np.stack([np.cos(around), np.sin(around), up], axis=-1)
    noisy = ring + 1e-3 * random.uniform(-1, 1, ring.shape)
    for degree in ((3, 2), (5, 3), 4):
        faired = fairing.fair(noisy, 2e-3, as_="fit", degree=degree, closed=(True, False))
        assert faired.surface.closed == (True, False) and faired.points.shape == noisy.shape
        assert np.linalg.norm(faired.points - noisy, axis=2).max() <= 2e-3 * (1 + 1e-9)
        assert faired.jumps_after < faired.jumps_before and faired.gap_relative < 1e-6
        seam = faired.surface.grid([0.0, 1.0], z / 2)
        assert np.abs(seam[0] - seam[1]).max() < 1e-12
    torus_angle = np.arange(12) * 2 * np.pi / 12
    u, v = np.meshgrid(angle, torus_angle, indexing="ij")
    torus = np.stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1)
    faired = fairing.fair(torus, 1e-3, as_="fit", closed=(True, True))
    assert faired.surface.closed == (True, True) and faired.deviation_certified <= 1e-3
    # Knots of one's own: as many control points as points pass through them, fewer come near.
    x, y = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 8), indexing="ij")
    wave = np.stack([x, y, 0.1 * np.sin(3 * x) * np.cos(2 * y)], axis=-1)
    ku = np.array([0, 0, 0, 0, 0.2, 0.35, 0.5, 0.6, 0.8, 1, 1, 1, 1])
    made = fairing.SplineSurface.interpolate(wave, knots=(ku, None))
    at = np.linspace(0, 1, 9), np.linspace(0, 1, 8)
    assert np.abs(made.grid(*at) - wave).max() < 1e-12
    assert np.array_equal(made.knots[0], ku)
    few = fairing.SplineSurface.interpolate(wave, knots=(ku[[0, 0, 0, 0, 5, 7, 9, 9, 9, 9]], None))
    assert few.control_points.shape == (6, 8, 3)
    assert 1e-9 < np.abs(few.grid(*at) - wave).max() < 1e-2
    # Weights that stay: the surface still passes through the points.
    weights = 1 + 0.5 * random.random((9, 8))
    rational = fairing.SplineSurface.interpolate(wave, degree=(3, 2), weights=weights)
    assert np.abs(rational.grid(*at) - wave).max() < 1e-12
    faired = fairing.fair(wave, 1e-3, as_="fit", weights=weights, closed=(False, False))
    assert faired.deviation_certified <= 1e-3
    for bad, words in (
        ({"weights": np.ones((3, 3))}, "(9, 8)"),
        ({"weights": np.zeros((9, 8))}, "weight (1, 1) is 0"),
        ({"knots": (ku[::-1], None)}, "not larger"),
        ({"knots": (ku[:6], None)}, "knots"),
        ({"closed": (True, False), "breaks": ((2,), ())}, "breaks"),
        ({"degree": (3, 9)}, "along v"),
    ):
        with pytest.raises(moldloft.FairingError) as caught:
            fairing.fair(wave, 1e-3, as_="fit", **bad)
        assert words in str(caught.value), (bad, caught.value)


def test_curves_of_every_form(cli, model_file):
    points = np.loadtxt(DATA / "waisted-noise.csv", delimiter=",", skiprows=1)
    n = len(points)
    random = np.random.default_rng(7)
    knots = np.concatenate([[0] * 5, np.sort(random.random(n - 5)), [1] * 5])
    weights = 1 + 0.4 * random.random(n)
    for as_ in ("control", "fit"):
        if as_ == "fit":
            # Knots near the points' own, so that these determine the curve.
            knots = fairing.Spline.interpolate(points, degree=4).knots
        faired = moldloft.fair(points, 2e-4, as_=as_, degree=4, knots=knots, weights=weights)
        assert np.array_equal(faired.spline.knots, knots)
        assert np.array_equal(faired.spline.weights, weights)
        assert faired.deviation_sampled <= faired.deviation_certified <= 2e-4 * (1 + 1e-12)
        assert faired.jumps_after < faired.jumps_before
    assert np.abs(faired.points - points).max() <= 2e-4
    through = fairing.Spline.fit(points, degree=4, weights=weights)
    t = fairing.Spline._fit(points, 4, None, None, weights, False, None, "chord", None)[1]
    assert np.abs(through(t)[:, :2] - points).max() < 1e-11
    few = fairing.Spline.fit(points, count=20, weights=np.ones(20))
    assert len(few.control_points) == 20

    def numbers(values, name):
        return model_file("\n".join(repr(float(v)) for v in values), name)

    path = DATA / "waisted-noise.csv"
    given = ["--knots", numbers(knots, "k.txt"), "--weights", numbers(weights, "w.txt")]
    data = reported(cli, path, "--tol", "2e-4", "--as", "fit", "--degree", "4", *given)
    assert data["degree"] == 4 and data["measure_after"] == pytest.approx(faired.after.measure)
    swapped = knots.copy()
    swapped[[20, 30]] = swapped[[30, 20]]
    zero = weights.copy()
    zero[6] = 0
    for option, values, words in (
        ("--knots", swapped, "not larger"),
        ("--knots", knots[:-1], "expected"),
        ("--weights", zero, "weight 7 is 0"),
        ("--weights", weights[:-1], "weights"),
    ):
        file = numbers(values, "bad.txt")
        own = ("--as", "control", "--degree", 4, option, file)
        done = cli("fair", path, "--tol", 1, *own, status=1)
        assert words in done.stderr, done.stderr
    bad = model_file("0 0 0 0\n0.5 half", "bad.txt")
    done = cli("fair", path, "--tol", 1, "--knots", bad, status=1)
    assert ":2: expected a number, found `half`" in done.stderr


def test_networks_refuse_what_is_for_curves(cli):
    done = cli("fair", DATA / "lines.csv", "--tol", "0.01", "--keep", "area", status=1)
    assert "`area` of a network cannot be kept" in done.stderr
    for option in (["--closed"], ["--through", "0.5=1,1"], ["--as", "fit"]):
        done = cli("fair", DATA / "lines.csv", "--tol", "0.01", *option, status=1)
        assert option[0] in done.stderr and "networks" in done.stderr


MODEL = """
AbsPoint A(0, 0, 0); AbsPoint B(1, 0.5, 0); AbsPoint C(2, 0.83, 0); AbsPoint D(3, 0.88, 0);
AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.49, 0); AbsPoint G(6, 0, 0);
AbsPoint H(-1, -0.64, 0); AbsPoint I(-2, -1.4, 0); AbsPoint J(-3, -2.3, 0); AbsPoint K(-4, -3.4, 0);
FairCurve run({K, J, I, H, A}, 0.01, ends = "position");
FairCurve keel({A, B, C, D, E, F, G}, 0.2, joins = {run});
FairNet net({{A, B, C, D, E, F, G}, {A, H, I, J, K}}, 0.05, mode = "faithful", passes = 2);
curve rough = distc(keel, uniform(0, 1, 9));
curve smooth = fair(rough, 0.01, mode = "faithful");
farray bumps = jumps(rough);
float bend = curvature(keel, 0.5);
farray bends = curvature(keel, uniform(0, 1, 3));
"""


def test_the_language_joins_and_asks():
    m = moldloft.loads(MODEL)
    a, b = m.eval("curvature(run, 1)"), m.eval("curvature(keel, 0)")
    assert a == pytest.approx(b, rel=1e-7)
    bends = np.asarray(m.eval("bends"))
    assert bends.shape == (3,) and bends[1] == pytest.approx(m.eval("bend"))
    assert m.eval("smooth").shape == (9, 3) and m.eval("bumps").shape == (5,)
    # The curve follows what it is joined to.
    before = m["keel"](0.1)
    m["H"].y = -0.641
    assert np.abs(m["keel"](0.1) - before).max() > 1e-6
    assert m.eval("curvature(run, 1)") == pytest.approx(m.eval("curvature(keel, 0)"), rel=1e-7)
    with pytest.raises(moldloft.ModelError) as caught:
        moldloft.loads(MODEL.replace("joins = {run}", "joins = {run}, closed = 1"))
    assert "has ends" in str(caught.value)


@pytest.mark.parametrize("end", ["first", "last", "both"])
def test_fixed_ends_stay(end):
    """Whatever the spacing, motion and goal; the rest moves as it does without."""
    rng = np.random.default_rng(11)
    for n in (9, 30):
        for spacing in ("even", "random"):
            x = np.linspace(0, 6, n)
            if spacing == "random":
                x[1:-1] += rng.uniform(-0.4, 0.4, n - 2) * 6 / n
            points = np.column_stack([x, np.sin(x) + rng.uniform(-0.01, 0.01, n)])
            fixed = {"first": [0], "last": [n - 1], "both": [0, n - 1]}[end]
            for motion in ("ball", (0, 1), "box"):
                for goal in ("near", "fairest", ("budget", 0.6), ("nearest", 0.2)):
                    made = moldloft.fair(points, 0.015, fixed=fixed, motion=motion, goal=goal)
                    case = (n, spacing, motion, goal)
                    # Those of the curve, and those that are written.
                    at = made.spline(np.array([float(k > 0) for k in fixed]))[:, :2]
                    assert np.abs(at - points[fixed]).max() < 1e-14, case
                    assert np.abs(made.points[fixed, :2] - points[fixed]).max() < 1e-14, case
                    # In a box each coordinate has the tolerance.
                    most = 0.015 * (np.sqrt(2) if motion == "box" else 1)
                    assert made.deviation_data <= most * (1 + 1e-9), case
                    if goal in ("fairest", ("budget", 0.6)):
                        assert made.deviation_data > 1e-3, case
    tolerances = np.full(len(points), 0.015)
    tolerances[fixed] = 0
    assert moldloft.fair(points, tolerances, goal="fairest").deviation_data > 1e-3


@pytest.mark.parametrize("goal", ["near", "fairest", ("budget", 0.7)])
@pytest.mark.parametrize("motion", ["ball", "box", (0, 1), (0.6, 0.8)])
def test_conditions_hold_whatever_way_points_move(motion, goal):
    """Ends are accepted, and ranges stay, where a direction leaves some coordinates no move."""
    x = np.linspace(0, 100, 60)
    noise = np.random.default_rng(3).uniform(-0.02, 0.02, 60)
    points = np.column_stack([x, 10 * np.sin(np.pi * x / 100) + noise])
    for orders, end in ((2, "tangent"), (3, "curvature")):
        faired = moldloft.fair(points, 0.02, motion=motion, goal=goal, ends=end, spacing="chord")
        assert faired.deviation_sampled > 1e-3
        # The ends of the curve through the points at the same parameters, by SciPy.
        at, own = np.asarray(faired.parameters), faired.spline
        knots = np.r_[[at[0]] * 4, at[2:-2], [at[-1]] * 4]
        through = make_interp_spline(at, points, k=3, t=knots)
        curve = BSpline(np.asarray(own.knots), np.asarray(own.control_points)[:, :2], own.degree)
        for t in (0.0, 1.0):
            for order in range(orders):
                wanted = through(t, order)
                assert np.abs(curve(t, order) - wanted).max() <= 1e-11 * (1 + np.abs(wanted).max())
    within = np.zeros(60)
    within[20:40] = 0.02
    faired = moldloft.fair(points, within, motion=motion, goal=goal, spacing="chord")
    moved = np.abs(faired.points - points).max(axis=1)
    assert (moved[within == 0] < 1e-12).all() and 5e-3 < moved.max() <= 0.02 * (1 + 1e-12)


def test_the_command_has_parameters_tolerances_and_stops_of_the_users(cli, tmp_path):
    """What the command reads from files and words is what Python takes."""
    n = 24
    rng = np.random.default_rng(9)
    t = np.sort(np.r_[0, 1, rng.uniform(0, 1, n - 2)])
    points = np.column_stack([t, 0.3 * np.sin(3 * t), 0.1 * t**2]) + 2e-3 * rng.normal(size=(n, 3))
    np.savetxt(tmp_path / "p.csv", points, delimiter=",", fmt="%.17g")
    at, each = np.linspace(0, 1, n) ** 1.2, 2e-3 * (1 + rng.random(n))
    np.savetxt(tmp_path / "at.txt", at, fmt="%.17g")
    np.savetxt(tmp_path / "tol.txt", each, fmt="%.17g")
    np.savetxt(tmp_path / "first.csv", points + 1e-4, delimiter=",", fmt="%.17g")
    data = ["p.csv", "--tol", "0.003"]
    vertex = {"mode": "vertex", "as_": "control", "steps": 999}
    stop = [*data, "--mode", "vertex", "--steps", "999", "--stop"]
    for arguments, options in (
        (["p.csv", "--tol", "tol.txt"], {"tol": each}),
        ([*data, "--at", "at.txt"], {"at": at}),
        ([*data, "--across", "1,0,0"], {"motion": ("across", (1, 0, 0))}),
        ([*data, "--accuracy", "1e-3"], {"accuracy": 1e-3}),
        ([*data, "--original", "first.csv"], {"original": points + 1e-4}),
        ([*stop, "move=0.2"], {**vertex, "least_move": 0.2}),
        ([*stop, "drop=0.01"], {**vertex, "least_drop": 0.01}),
        ([*stop, "gap=0.5"], {**vertex, "stop_gap": 0.5}),
        ([*stop, "pieces"], {**vertex, "stop_pieces": True}),
    ):
        made = reported(cli, *arguments)
        tol = options.pop("tol", 0.003)
        wanted = moldloft.fair(points, tol, **options)
        assert made["value"] == pytest.approx(wanted.value, rel=1e-12), arguments
        assert made["steps"] == wanted.steps, arguments
    for arguments, words in (
        ([*data, "--stop", "soup"], "expected move=FRACTION"),
        ([*data, "--across", "1,0", "--box"], "one of these"),
        ([*data, "--original", "tol.txt"], "columns"),
        (["p.csv", "--tol", "soup"], "nor a file of lengths"),
        ([*data, "--at", "at.txt", "--bound", "curve"], "parameters of your own"),
    ):
        status = 2 if "soup" in arguments else 1
        assert words in cli("fair", *arguments, status=status).stderr, arguments
    lines = DATA / "lines.csv"
    assert (
        "expected a line"
        in cli("fair", lines, "--tol", "0.006", "--shape", "convex", status=1).stderr
    )
    for words in (["--bends"], ["--at", "at.txt"]):
        done = cli("fair", lines, "--tol", "0.006", *words, status=1)
        assert f"{words[0]} is for single curves" in done.stderr


def test_a_run_beside_a_break_has_a_reason():
    x = np.linspace(0, 1, 20)
    points = np.column_stack([x, 0.2 * np.maximum(x - 0.3, 0) ** 2])
    with pytest.raises(moldloft.Error, match="a run ends at a break, or three points from it"):
        moldloft.fair(points, 1e-3, shape=["straight=1-5"], breaks=[5])
    made = moldloft.fair(points, 1e-3, shape=["straight=1-5"], breaks=[4])
    assert made.deviation_data <= 1e-3 * (1 + 1e-9)
