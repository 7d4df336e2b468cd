"""Fairing from outside: the figures of the notes, the files, the faults."""

from __future__ import annotations

import json
import math
import struct
import sys

import numpy as np
import pytest

import moldloft
from conftest import ROOT
from moldloft import fairing
from moldloft.errors import FairingError
from moldloft.fairing import files

DATA = ROOT / "examples" / "fairing"
sys.path.insert(0, str(DATA))

import make_data  # noqa: E402


def reported(cli, *arguments):
    """The report of ``moldloft fair`` as data."""

    def refuse(word):
        raise ValueError(word)

    return json.loads(cli("fair", *arguments, "--json").stdout, parse_constant=refuse)


# Figures of the notes, section 4: input, optimum, 1n and 10n steps.
TABLE = {
    "naca0012-4.csv": {
        "tol": 1e-4,
        "input": (5.385165e-4, 5.700000e-6, 1.313000e-4),
        "second": 1.30816311e-4,
        "active": 14,
        "jumps": 3.2333e-10,
        "jump-lengths": 9.830e-5,
        "steps": ((1.308567e-4, 3.89e-8), (1.308287e-4, 1.18e-9)),
        "pieces": (19, 2),
        "inflections": (0, 0),
        "stalls": 1165,
        "rms": (3.36e-5, 2.79e-5, 7.26e-5),
    },
    "naca0012-3.csv": {
        "tol": 1e-3,
        "input": (6.403124e-3, 1.684000e-3, 2.580000e-4),
        "second": 1.29637452e-4,
        "active": 12,
        "jumps": 6.8630e-9,
        "jump-lengths": 3.078e-4,
        "steps": ((1.314760e-4, 3.65e-6), (1.298344e-4, 1.16e-7)),
        "pieces": (56, 4),
        "inflections": (44, 0),
        "stalls": 221,
        "rms": (4.61e-4, 4.13e-4, 4.82e-4),
    },
    "waisted-4.csv": {
        "tol": 1e-4,
        "input": (5.830952e-4, 5.660000e-6, 2.660000e-6),
        "second": 1.98586493e-6,
        "active": 23,
        "jumps": 9.3875e-9,
        "jump-lengths": 4.182e-4,
        "steps": ((2.077217e-6, 5.17e-8), (2.000237e-6, 1.89e-8)),
        "pieces": (36, 6),
        "inflections": (15, 2),
        "stalls": 126,
        "rms": (3.84e-5, 3.34e-5, 8.16e-5),
    },
    "waisted-noise.csv": {
        "tol": 2e-4,
        "input": (1.291809e-3, 1.866561e-5, 3.519791e-6),
        "second": 1.93909366e-6,
        "active": 11,
        "jumps": 8.4941e-9,
        "jump-lengths": 4.048e-4,
        "steps": ((2.094699e-6, 5.36e-8), (1.967644e-6, 2.10e-8)),
        "pieces": (48, 8),
        "inflections": (32, 2),
        "stalls": 161,
        "rms": (5.69e-5, 5.21e-5, 13.5e-5),
    },
    "circle.csv": {
        "tol": 2e-3,
        "input": (1.315213e-2, 2.879147e-3, 6.174782e-3),
        "second": 5.92044830e-3,
        "active": 19,
        "steps": ((5.941748e-3, 1.41e-5), (5.931647e-3, 7.1e-7)),
        "inflections": (0, 0),
        "stalls": 1040,
        "rms": (0.80e-3, None, 1.47e-3),
    },
}


def truth(name):
    if name.startswith("naca"):
        return make_data.naca0012()
    if name.startswith("waist"):
        return make_data.waisted()
    angle = 2 * np.pi * np.arange(64) / 64
    return np.column_stack([np.cos(angle), np.sin(angle)])


def rms(points, name):
    return math.sqrt(((points - truth(name)) ** 2).sum(axis=1).mean())


def close(got, wanted, share):
    assert got == pytest.approx(wanted, rel=share)


@pytest.mark.parametrize("name", TABLE)
def test_the_table_by_the_command(cli, tmp_path, name):
    row = TABLE[name]
    closed = ["--closed"] if name == "circle.csv" else []
    asked = [DATA / name, "--tol", row["tol"], *closed, "--as", "control"]
    best = reported(cli, *asked, "-o", "faired.csv")
    largest, jumps, second = row["input"]
    close(best["largest_jump_before"], largest, 1e-6)
    close(best["jumps_before"], jumps, 1e-6)
    close(best["measure_before"], second, 1e-6)
    close(best["measure_after"], row["second"], 1e-6)
    assert best["gap_relative"] <= 1e-9
    assert best["active"] == row["active"]
    assert best["deviation_sampled"] <= best["deviation_certified"] <= row["tol"]
    assert 0.86 * row["tol"] <= best["deviation_sampled"]
    read = fairing.fair(make_data_points(name), row["tol"], as_="control", closed=bool(closed))
    points = np.loadtxt(tmp_path / "faired.csv", delimiter=",", skiprows=1)
    assert points.tobytes() == read.points.tobytes()
    close(rms(points, name), row["rms"][2], 0.1)
    close(rms(make_data_points(name), name), row["rms"][0], 0.1)
    n = len(points)
    for times, (second, jumps) in zip((1, 10), row["steps"], strict=True):
        stepped = reported(cli, *asked, "--mode", "faithful", "--passes", times)
        assert stepped["steps"] == times * n and stepped["stopped"] == "steps"
        close(stepped["measure_after"], second, 0.05)
        close(stepped["jumps_after"], jumps, 0.3)
        # The certificate bounds what the optimum has shown to be left.
        assert stepped["gap"] >= stepped["value"] - best["value"]
        if times == 10:
            for word, key in (("pieces", "monotone_pieces"), ("inflections", "inflections")):
                for k, when in enumerate(("before", "after")):
                    if word in row:
                        assert abs(stepped[f"{key}_{when}"] - row[word][k]) <= 1
    literal = reported(cli, *asked, "--mode", "literal", "--steps", 100_000)
    assert literal["stopped"] == "stalled"
    assert row["stalls"] / 10 <= literal["steps"] <= row["stalls"] * 10
    for measure in ("jumps", "jump-lengths"):
        if measure in row:
            close(reported(cli, *asked, "--measure", measure)["value"], row[measure], 1e-3)


def make_data_points(name):
    return np.loadtxt(DATA / name, delimiter=",", skiprows=1)


def test_the_surface_of_the_notes(cli):
    hull = DATA / "wigley.p3d"
    plain = reported(cli, hull, "--tol", "0")
    close(plain["jumps_u_before"], 1.5976e-4, 1e-4)
    close(plain["jumps_v_before"], 1.0820e-4, 1e-4)
    close(plain["measure_before"], 3.59334e-5 + 5.98370e-5, 1e-6)
    assert plain["deviation_certified"] == 0 and plain["measure_after"] == plain["measure_before"]
    for tol, second in ((2e-4, 6.221144e-5), (1e-4, 6.672774e-5)):
        best = reported(cli, hull, "--tol", tol)
        close(best["value"], second, 1e-6)
        assert best["gap_relative"] < 1e-7 and best["deviation_certified"] <= tol
    for tol, (u, v) in ((2e-4, (8.9e-10, 6.9e-10)), (1e-4, (1.8e-8, 6.4e-9))):
        best = reported(cli, hull, "--tol", tol, "--measure", "jumps")
        close(best["jumps_u_after"], u, 0.1)
        close(best["jumps_v_after"], v, 0.1)
    for passes, (u, v) in ((1, (4.59e-6, 4.2e-8)), (2, (1.5e-7, 1.6e-8)), (10, (2.66e-6, 5.5e-8))):
        faithful = reported(cli, hull, "--tol", 2e-4, "--passes", passes)
        assert faithful["mode"] == "faithful"
        close(faithful["jumps_u_after"], u, 0.3)
        close(faithful["jumps_v_after"], v, 0.3)
        assert faithful["deviation_certified"] <= 2e-4
    # The last figures of the report: ten passes, nothing to hold them.
    done = cli("fair", hull, "--tol", "none", "--passes", 10)
    assert "warning: without a tolerance" in done.stderr


def test_the_distance_to_the_true_hull():
    exact, noisy = make_data.wigley(0.0), make_data.wigley()

    def off(points):
        return math.sqrt(((points - exact) ** 2).sum(axis=2).mean())

    close(off(noisy), 5.699e-5, 0.1)
    for passes, wanted in ((1, 4.25e-5), (2, 4.35e-5), (10, 5.98e-5)):
        close(off(fairing.fair(noisy, 2e-4, mode="faithful", passes=passes).points), wanted, 0.1)
    other = fairing.fair(noisy, 2e-4, mode="faithful", passes=10, order="uv").points
    first = fairing.fair(noisy, 2e-4, mode="faithful", passes=10).points
    close(np.linalg.norm(other - first, axis=2).max(), 9.5e-5, 0.1)
    for tol, wanted in ((2e-4, 8.2e-5), (1e-4, 1.90e-5)):
        close(off(fairing.fair(noisy, tol, measure="jumps").points), wanted, 0.1)


def test_the_claim_of_the_report():
    """Squared jumps down some 450 times within n steps, the curve moved 6.7e-4 at most.

    Rounded data hold exact ties: the last bit decides which knot comes first, and the factor is 380
    to 470 with it.
    """
    points = make_data_points("naca0012-3.csv")
    faired = moldloft.fair(points, 1e-3, mode="faithful")
    assert faired.jumps_before > 370 * faired.jumps_after
    other = moldloft.fair(points * (1 + 3e-13), 1e-3, mode="faithful")
    assert other.jumps_before > 370 * other.jumps_after
    assert faired.deviation_sampled <= 6.8e-4
    inside = math.sqrt(2) * 0.5e-3
    for times, wanted in ((10, 2.46e-4), (100, 1.86e-4)):
        stepped = moldloft.fair(points, inside, mode="faithful", steps=times * 81)
        close(rms(stepped.points, "naca"), wanted, 0.1)
    # The nose radius comes back.
    middle = moldloft.fair(points, inside, as_="control").spline
    radius = 1 / np.abs(middle.samples().curvature).max()
    assert 0.013 < radius < 0.016
    assert 1 / np.abs(fairing.Spline(points, clamped=False).samples().curvature).max() < 0.009


def test_a_log_replays_to_the_bit(cli, tmp_path):
    points = make_data_points("waisted-noise.csv")
    faired = moldloft.fair(points, 2e-4, mode="faithful", steps=100, log=True)
    again = np.column_stack([points, np.zeros(len(points))])
    index, to = faired.log
    again[index] = to  # the last step of a point wins
    assert again.tobytes() == faired.control_points.tobytes()
    cli("fair", DATA / "waisted-noise.csv", "--tol", "2e-4", "--mode", "faithful", "--log", "l.csv")
    assert len((tmp_path / "l.csv").read_text().splitlines()) == 62


def test_zero_changes_no_bit(cli, tmp_path):
    for role in ("control", "points"):
        reported(cli, DATA / "section.csv", "--tol", 0, "--as", role, "-o", "same.csv")
        assert np.array_equal(
            np.loadtxt(tmp_path / "same.csv", delimiter=",", skiprows=1),
            make_data_points("section.csv"),
        )
    same = moldloft.fair(make_data_points("section.csv"), 0, as_="fit")
    assert same.deviation_certified == 0 and same.after == same.before


def test_roles_of_points():
    points = make_data_points("naca0012-3.csv")
    for role in ("control", "points", "fit"):
        faired = moldloft.fair(points, 1e-3, as_=role)
        assert faired.points.shape == points.shape
        assert faired.deviation_sampled <= faired.deviation_certified
        assert faired.deviation_data <= 1e-3 * (1 + 1e-12)
        moved = np.linalg.norm(faired.points - points, axis=1).max()
        assert moved <= 1e-3 * (1 + 1e-12)
        assert faired.after.pieces < faired.before.pieces / 4
    # Points moved themselves lie on the faired curve.
    faired = moldloft.fair(points, 1e-3, as_="points", spacing="index")
    t = np.linspace(0, 1, len(points))
    assert np.abs(faired.spline(t)[:, :2] - faired.points).max() < 1e-12
    # A fit uses the tolerance better than balls round control points.
    close(moldloft.fair(points, 1e-3, as_="control", bound="curve").deviation_control, 1.7e-3, 0.3)
    least = moldloft.fair(points, 1e-3, as_="fit", count=40)
    assert len(least.control_points) == 40


def test_corners_and_wrong_digits():
    points = make_data_points("section.csv")
    smeared = moldloft.fair(points, 0.006, as_="control")
    assert {(f.kind, f.index) for f in smeared.findings} == {("outlier", 32), ("corner", 20)}
    for role in ("control", "points", "fit"):
        release = () if role == "control" else "auto"
        faired = moldloft.fair(points, 0.006, as_=role, breaks="auto", release=release)
        assert faired.breaks == (20,) and not faired.findings
        wrong = next(f for f in faired.corrected if f.kind == "outlier")
        assert wrong.index == 32 and wrong.vector[0] == pytest.approx(0.3, abs=0.02)
        assert faired.points[20].tobytes() == points[20].tobytes()
        # It has found its place among the others, and these have kept theirs.
        assert faired.points[32, 0] == pytest.approx(points[32, 0] - 0.3, abs=0.012)
        others = np.delete(np.linalg.norm(faired.points - points, axis=1), 32)
        assert others.max() <= 0.006 * (1 + 1e-12)
    # The curve has its corner there: the tangent turns at once.
    spline = moldloft.fair(points, 0.006, as_="fit", breaks="auto").spline
    t = spline.samples()
    turn = np.arctan2(t.first[:, 1], t.first[:, 0])
    assert np.abs(np.diff(turn)).max() > 0.4


def test_conditions_of_an_optimum():
    points = make_data_points("waisted-noise.csv")
    middle = fairing.Spline(points, clamped=False)(0.5)
    faired = moldloft.fair(
        points,
        2e-4,
        as_="control",
        through=[(0.5, middle)],
        tangents=[(0.25, (1, 0.0))],
        keep=["area", "volume"],
    )
    assert np.abs(faired.spline(0.5) - middle).max() < 1e-12
    slope = faired.spline.at([0.25]).first[0]
    assert abs(slope[1] / slope[0]) < 1e-9
    plain = moldloft.fair(points, 2e-4, as_="control")
    assert faired.value >= plain.value and faired.deviation_certified <= 2e-4

    def volume(spline):
        s = spline.samples(32).points
        return np.pi * np.trapezoid(s[:, 1] ** 2, s[:, 0])

    before = volume(faired.original)
    assert abs(volume(faired.spline) - before) < 0.02 * abs(volume(plain.spline) - before) + 1e-9
    with pytest.raises(moldloft.FairingError, match=r"condition.* 1"):
        moldloft.fair(points, 2e-4, as_="control", through=[(0.5, (0.5, 0.3)), (0.5, middle)])
    with pytest.raises(moldloft.FairingError, match="conditions 1, 2"):
        twice = [(0.5, middle), (0.5, middle + np.array([0, 1e-4, 0]))]
        moldloft.fair(points, 2e-4, as_="control", through=twice)


def test_motion_and_limits():
    points = make_data_points("waisted-noise.csv")
    offsets = moldloft.fair(points, 2e-4, as_="control", motion=(0, 1))
    assert np.array_equal(offsets.points[:, 0], points[:, 0])
    assert offsets.deviation_certified <= 2e-4
    boxed = moldloft.fair(points, 2e-4, as_="control", motion="box")
    assert np.abs(boxed.points - points).max() <= 2e-4
    each = np.full(len(points), 2e-4)
    each[30] = 0
    kept = moldloft.fair(points, each, as_="control")
    assert kept.points[30].tobytes() == points[30].tobytes()
    for ends in ("free", "position", "tangent", "curvature", 3, ("free", 2)):
        assert moldloft.fair(points, 2e-4, as_="control", ends=ends).jumps_after < 1e-6


def test_nets_and_networks_keep_what_is_meant():
    noisy = make_data.wigley()
    knuckled = moldloft.fair(noisy, 2e-4, breaks=((20,), ()))
    assert knuckled.points[20].tobytes() == noisy[20].tobytes()
    assert knuckled.jumps_along[0][1] < 0.5 * knuckled.jumps_along[0][0]

    def volume(grid):
        # Between the hull and its plane: the integral of y dx dz.
        x, y, z = np.moveaxis(grid, 2, 0)
        (xu, xv), (zu, zv) = np.gradient(x), np.gradient(z)
        return np.trapezoid(np.trapezoid(y * (xu * zv - xv * zu)))

    kept = moldloft.fair(noisy, 2e-4, keep=["volume"])
    assert kept.value > moldloft.fair(noisy, 2e-4).value
    before = kept.original.grid(161, 161)
    drift = [abs(volume(f.surface.grid(161, 161)) - volume(before)) for f in (kept,)]
    free = abs(volume(moldloft.fair(noisy, 2e-4).surface.grid(161, 161)) - volume(before))
    assert drift[0] < 0.05 * free
    grid = np.arange(41 * 17).reshape(41, 17)
    lines = fairing.network(
        noisy.reshape(-1, 3), [*grid, *grid.T], 2e-4, motion=(0, 1, 0), spacing="index"
    )
    assert lines.deviation_certified <= 2e-4 and lines.shared == 697
    # Two curves that share a point still meet in it.
    a, b = lines.curves[20], lines.curves[41 + 8]
    assert np.abs(a(8 / 16) - b(20 / 40)).max() < 1e-12


def test_interrogation():
    angle = 2 * np.pi * np.arange(24) / 24
    ring = fairing.Spline.interpolate(
        np.column_stack([2 * np.cos(angle), 2 * np.sin(angle)]), closed=True, spacing="index"
    )
    assert ring.curvature([0.1, 0.7]) == pytest.approx([0.5, 0.5], rel=5e-3)
    assert ring.length == pytest.approx(4 * np.pi, rel=1e-5) and ring.inflections() == 0
    feet, tips = ring.comb(scale=2.0)
    assert np.linalg.norm(tips[:, :2], axis=1) == pytest.approx(3.0, rel=1e-2)
    assert np.linalg.norm(feet[:, :2], axis=1) == pytest.approx(2.0, rel=1e-4)
    pedal = ring.orthotomic((0, 0), k=1)
    assert np.linalg.norm(pedal, axis=1) == pytest.approx(2.0, rel=1e-3)
    t = np.linspace(0, 1, 60)
    turn = 6 * t
    helix = fairing.Spline.interpolate(np.column_stack([np.cos(turn), np.sin(turn), 0.5 * turn]))
    assert helix.curvature(0.5) == pytest.approx(1 / 1.25, rel=1e-3)
    assert helix.torsion(0.5) == pytest.approx(0.5 / 1.25, rel=1e-2)
    assert helix.samples().plane is None
    # A logarithmic spiral is a straight line of slope 1.
    spiral = np.exp(0.2 * turn)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    graph = fairing.Spline.interpolate(spiral, degree=5).logarithmic_curvature()
    inner = graph[len(graph) // 4 : -len(graph) // 4]
    assert np.polyfit(inner[:, 0], inner[:, 1], 1)[0] == pytest.approx(1, abs=0.05)
    at, jumps = ring.jumps()
    assert len(at) == 24 and jumps.shape == (24, 3)
    u, v = np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12), indexing="ij")
    around, up = 1.5 * u, 0.3 + 0.8 * v
    ball = 3 * np.stack(
        [np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), np.cos(up)], axis=-1
    )
    look = fairing.SplineSurface.interpolate(ball).look(9, 9)
    inner = (slice(1, -1), slice(1, -1))
    assert look.gaussian[inner] == pytest.approx(1 / 9, rel=5e-3)
    assert np.abs(look.mean[inner]) == pytest.approx(1 / 3, rel=5e-3)
    assert look.absolute[inner] == pytest.approx(2 / 3, rel=5e-3)
    # On a ball about the origin normals run through the middle: z / r is the isophote of +z.
    heights = look.points[..., 2] / 3
    assert np.abs(look.isophotes((0, 0, 1))) == pytest.approx(np.abs(heights), abs=1e-3)
    assert np.abs(look.highlight((0, 0, 0), (0, 0, 1))).max() < 1e-2
    assert set(np.unique(look.zebra())) <= {-1.0, 1.0}
    assert look.reflection((1, 1, 1), (0, 0, 9), (0, 1, 0)).shape == (9, 9)
    assert look.orthotomic((0, 0, 0), 1.0)[4, 4] == pytest.approx(look.points[4, 4], rel=1e-3)
    plate = np.stack(np.meshgrid(np.arange(5.0), np.arange(4.0) * 0.5, indexing="ij"), axis=-1)
    assert fairing.grid_metric(plate) == pytest.approx(2.0)
    assert fairing.divided_differences([(0, 0), (1, 1), (3, 9)], [0, 1, 3])[0, 1] == 1.0


def test_equivariance_and_reversal():
    points = make_data_points("waisted-noise.csv")
    best = moldloft.fair(points, 2e-4, as_="control").points
    c, s = math.cos(0.7), math.sin(0.7)
    turn = 3 * np.array([[c, -s], [s, c]])
    moved = moldloft.fair(points @ turn.T + [5, -2], 6e-4, as_="control").points
    assert np.abs(moved - (best @ turn.T + [5, -2])).max() < 1e-9
    back = moldloft.fair(points[::-1], 2e-4, as_="control").points[::-1]
    assert np.abs(back - best).max() < 1e-10
    ring = make_data_points("circle.csv")
    whole = moldloft.fair(ring, 2e-3, as_="control", closed=True).points
    shifted = moldloft.fair(np.roll(ring, 11, axis=0), 2e-3, as_="control", closed=True).points
    assert np.abs(np.roll(shifted, -11, axis=0) - whole).max() < 1e-10


PROGRAM = """
param float bulge = 0.5 in [0.3, 0.7];
AbsPoint A(0, 0, 0); AbsPoint B(1, bulge, 0); AbsPoint C(2, 0.83, 0); AbsPoint D(3, 0.88, 0);
AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.49, 0); AbsPoint G(6, 0, 0);
AbsPoint H(2, 0.9, 1); AbsPoint I(2, 0.93, 2); AbsPoint J(2, 0.9, 3); AbsPoint K(2, 0.7, 4);
FairCurve keel({A, B, C, D, E, F, G}, 0.02);
FairNet net({{A, B, C, D, E, F, G}, {C, H, I, J, K}}, 0.03);
NetCurve station(net, 2);
Line side({0, 2, 0}, {6, 2, 0});
RuledSurf deck(keel, side);
curve rough = distc(keel, uniform(0, 1, 9));
curve smooth = fair(rough, 0.01);
farray bumps = jumps(rough);
float bend = curvature(keel, 0.5);
"""


def test_fairing_in_a_model():
    m = moldloft.loads(PROGRAM)
    before = m["keel"](np.linspace(0, 1, 5))
    exact = m.derivative("keel(0.3)", "bulge")
    h = 1e-6
    m["bulge"] = 0.5 + h
    high = m["keel"](0.3)
    m["bulge"] = 0.5 - h
    low = m["keel"](0.3)
    assert exact == pytest.approx((high - low) / (2 * h), rel=1e-5, abs=1e-9)
    # Back again: the same bits, whatever came between.
    m["bulge"] = 0.5
    assert m["keel"](np.linspace(0, 1, 5)).tobytes() == before.tobytes()
    assert m.eval("bumps").shape == (5,) and m.eval("smooth").shape == (9, 3)
    assert m.eval("bend") > 0
    assert m.eval("net[2](0)") == pytest.approx(m["station"](0.0))
    look = m["deck"].look(5, 5)
    assert look.gaussian.shape == (5, 5)


def test_objects_of_models_by_the_command(cli, model_file, tmp_path):
    path = model_file(PROGRAM)
    curve = reported(cli, f"{path}:keel", "--tol", "0.01", "-o", "keel.csv", "--set", "bulge=0.6")
    assert curve["as"] == "fit" and curve["fit_error"] <= 1e-4
    assert curve["deviation_certified"] <= 0.01 * (1 + 1e-12)
    surface = reported(cli, f"{path}:deck", "--tol", "0.01", "-o", "deck.vts")
    assert surface["fit_error"] <= 1e-4
    rows = reported(cli, f"{path}:rough", "--tol", "0.01")
    assert rows["as"] == "control" and rows["points"] == 9
    assert "which object" in cli("fair", path, "--tol", 1, status=1).stderr
    assert "`kiel`" in cli("fair", f"{path}:kiel", "--tol", 1, status=1).stderr
    assert "point" in cli("fair", f"{path}:A", "--tol", 1, status=1).stderr


def test_files_go_and_come(cli, tmp_path, model_file):
    # An aerofoil in two halves keeps its form.
    halves = make_data.naca0012()
    upper, lower = halves[:41][::-1] * [1, -1], halves[40:] * [1, -1]
    rows = ["NACA 0012", "41. 41.", ""]
    rows += [f"{x:.4f} {y:.4f}" for x, y in upper] + [""] + [f"{x:.4f} {y:.4f}" for x, y in lower]
    path = model_file("\n".join(rows) + "\n", "naca.dat")
    data = reported(cli, path, "--tol", 1e-4, "--as", "control", "-o", "out.dat")
    assert data["points"] == 81
    out = (tmp_path / "out.dat").read_text().splitlines()
    assert out[0] == "NACA 0012" and out[1].split() == ["41.", "41."] and len(out) == 86
    again = reported(cli, "out.dat", "--tol", 0, "--as", "control")
    close(again["measure_after"], data["measure_after"], 1e-12)
    # Blanks, tabs and semicolons, comments and Fortran's exponents.
    for sign in (" ", "\t", "; "):
        text = "# a comment\n" + "\n".join(f"{k}{sign}{k * k}.0D-1" for k in range(8))
        assert reported(cli, model_file(text, "p.txt"), "--tol", 0.1)["points"] == 8
    # Closed files that repeat their first point.
    ring = make_data_points("circle.csv")
    text = "\n".join(f"{x!r},{y!r}" for x, y in [*ring.tolist(), ring[0].tolist()])
    path = model_file(text, "ring.csv")
    done = cli("fair", path, "--tol", "2e-3", "--closed", "-o", "ring2.csv")
    assert "the last point repeats the first" in done.stdout
    out = np.loadtxt(tmp_path / "ring2.csv", delimiter=",")
    assert len(out) == 65 and out[0].tobytes() == out[-1].tobytes()
    # Several curves are a network.
    lines = reported(cli, DATA / "lines.csv", "--tol", "0.006", "--along", "0,1,0", "-o", "l.csv")
    assert (lines["curves"], lines["shared"], lines["points"]) == (34, 273, 273)
    assert len((tmp_path / "l.csv").read_text().splitlines()) == 1 + 2 * 273 + 33


def plot3d(grid, layout):
    m, n = grid.shape[:2]
    numbers = np.moveaxis(grid, 2, 0).transpose(0, 2, 1).ravel()
    if layout == "text":
        return f"1\n{m} {n} 1\n" + "\n".join(repr(float(x)) for x in numbers)
    parts = [struct.pack("<i", 1), struct.pack("<3i", m, n, 1), numbers.astype("<f8").tobytes()]
    if layout == "records":
        parts = [struct.pack("<i", len(p)) + p + struct.pack("<i", len(p)) for p in parts]
    return b"".join(parts)


def test_plot3d_in_every_layout(cli, tmp_path, model_file):
    grid = make_data.wigley()
    for layout in ("text", "stream", "records"):
        path = model_file(plot3d(grid, layout), f"{layout}.p3d")
        data = reported(cli, path, "--tol", 2e-4, "-o", f"out-{layout}.p3d")
        close(data["value"], 6.221144e-5, 1e-6)
        again = reported(cli, f"out-{layout}.p3d", "--tol", 0)
        close(again["measure_before"], data["measure_after"], 1e-12)
    file = files.read_grids(tmp_path / "out-stream.p3d")
    assert file.grids[0].shape == (41, 17, 3) and file.layout == "stream"


def test_fields_for_viewers(cli, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    cli("fair", DATA / "wigley.p3d", "--tol", "2e-4", "-o", "hull.vts", "--measure", "jumps")
    grid = pyvista.read(tmp_path / "hull.vts")
    assert tuple(grid.dimensions) == (81, 41, 1)
    names = {"gaussian_curvature", "mean_curvature_before", "zebra", "displacement", "normal"}
    assert names <= set(grid.point_data)
    moved = np.linalg.norm(grid["displacement"], axis=1)
    assert 0 < moved.max() <= 2e-4

    def rough(name):
        field = grid[name].reshape(41, 81)
        return np.abs(np.diff(field, 2, axis=1)).mean()

    assert rough("gaussian_curvature") < 0.1 * rough("gaussian_curvature_before")


def test_plots(cli, tmp_path):
    pytest.importorskip("matplotlib")
    for name, more in (
        ("naca0012-3.csv", ["--tol", "1e-3"]),
        ("circle.csv", ["--tol", "2e-3", "--closed", "--as", "fit"]),
        ("section.csv", ["--tol", "0.006", "--breaks", "auto", "--as", "points"]),
        ("wigley.p3d", ["--tol", "2e-4"]),
        ("lines.csv", ["--tol", "0.006"]),
    ):
        done = cli("fair", DATA / name, *more, "--plot", f"{name}.png")
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert "warn" not in done.stderr.lower()
    for _ in range(2):
        cli("fair", DATA / "waisted-4.csv", "--tol", "1e-4", "--plot", "a.svg")
        text = (tmp_path / "a.svg").read_text()
        assert "<svg" in text
    assert (
        ".png or .svg"
        in cli("fair", DATA / "circle.csv", "--tol", 1, "--plot", "a.pdf", status=1).stderr
    )


def test_plots_without_matplotlib(tmp_path):
    import subprocess

    code = (
        "import sys; sys.modules['matplotlib'] = None\n"
        "from moldloft.cli import main\n"
        f"sys.exit(main(['fair', {str(DATA / 'circle.csv')!r}, '--tol', '0.01', '--closed',"
        " '--plot', 'a.png', '-o', 'a.csv']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1 and "pip install 'moldloft[plot]'" in done.stderr
    assert not list(tmp_path.iterdir())


GOOD = "\n".join(f"{k}, {k * k % 7}" for k in range(9))

FAULTS = {
    # name: (text, arguments, words that must be said)
    "too few points": (
        "0, 0\n1, 1\n2, 0\n3, 1\n",
        ["--tol", "1"],
        ["at least 5 points", "found 4"],
    ),
    "too few for closed": (
        "\n".join(GOOD.splitlines()[:6]),
        ["--tol", "1", "--closed"],
        ["at least 8 points"],
    ),
    "too few for the degree": (GOOD, ["--tol", "1", "--degree", "8"], ["at least 10 points"]),
    "repeated point": (
        GOOD.replace("4, 2", "3, 2"),
        ["--tol", "1", "--as", "control"],
        [":5:", "coincide"],
    ),
    "nan": (GOOD.replace("5, 4", "5, nan"), ["--tol", "1"], [":6:", "`nan`", "not finite"]),
    "infinity": (GOOD.replace("5, 4", "5, inf"), ["--tol", "1"], [":6:", "not finite"]),
    "no number": (GOOD.replace("5, 4", "5, four"), ["--tol", "1"], [":6:", "found `four`"]),
    "a column more": (GOOD.replace("5, 4", "5, 4, 1"), ["--tol", "1"], [":6:", "2 columns", "3"]),
    "a column less": (GOOD.replace("5, 4", "5"), ["--tol", "1"], [":6:", "2 columns", "found 1"]),
    "four columns": ("1, 2, 3, 4\n" * 9, ["--tol", "1"], [":1:", "2 or 3 columns", "found 4"]),
    "empty cell": (GOOD.replace("5, 4", "5,"), ["--tol", "1"], [":6:", "missing"]),
    "no points": ("# nothing\n\n", ["--tol", "1"], ["no points"]),
    "negative tolerance": (GOOD, ["--tol", "-1"], ["at least 0", "-1"]),
    "tolerance nan": (GOOD, ["--tol", "nan"], ["tolerance", "nan"]),
    "closed without a tolerance": (GOOD, ["--tol", "none", "--closed"], ["shrinks to a point"]),
    "break out of range": (GOOD, ["--tol", "1", "--breaks", "3,12"], ["1 to 9", "`12`"]),
    "break zero": (GOOD, ["--tol", "1", "--breaks", "0"], ["1 to 9", "`0`"]),
    "break no number": (GOOD, ["--tol", "1", "--breaks", "auto,3"], ["`auto`"]),
    "fixed out of range": (GOOD, ["--tol", "1", "--fixed", "77"], ["1 to 9", "`77`"]),
    "unknown ends": (GOOD, ["--tol", "1", "--ends", "loose"], ["`loose`", "tangent"]),
    "measure beyond the degree": (
        GOOD,
        ["--tol", "1", "--degree", "2", "--measure", "third"],
        ["degree 3"],
    ),
    "steps of lengths": (
        GOOD,
        ["--tol", "1", "--mode", "sweeps", "--measure", "jump-lengths"],
        ["optimum"],
    ),
    "contradiction": (
        GOOD,
        ["--tol", "0.1", "--through", "0.5=4,40", "--through", "0.2=2,2"],
        ["condition", "1", "cannot hold within the tolerance"],
    ),
    "conditions of steps": (
        GOOD,
        ["--tol", "1", "--mode", "faithful", "--through", "0.5=4,4"],
        ["optimum"],
    ),
    "no passes": (GOOD, ["--tol", "1", "--passes", "0"], ["1 pass"]),
    "binary": ("\x00\x01\x02", ["--tol", "1"], []),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults(cli, model_file, tmp_path, name):
    text, arguments, words = FAULTS[name]
    path = model_file(text, "points.csv")
    done = cli("fair", path, *arguments, "-o", "out.csv", status=1)
    assert done.stderr.startswith(("error: ", "warning: ")), done.stderr
    assert done.stdout == ""
    for word in words:
        assert word in done.stderr, done.stderr
    assert not (tmp_path / "out.csv").exists()


def test_wrong_use(cli):
    assert "--tol" in cli("fair", DATA / "circle.csv", status=2).stderr
    assert "`soft`" in cli("fair", DATA / "circle.csv", "--tol", "soft", status=2).stderr
    assert "no such file" in cli("fair", "nowhere.csv", "--tol", "1", status=1).stderr
    assert "1 to 1" in cli("fair", DATA / "wigley.p3d", "--tol", 1, "--block", 2, status=1).stderr
    assert (
        "a place of a surface is U,V"
        in cli("fair", DATA / "wigley.p3d", "--tol", 1, "--through", "0.5=1,1", status=1).stderr
    )


PLOT3D_FAULTS = {
    "ends early": ("1\n5 5 1\n1 2 3\n", ["expected 75 coordinates", "found 3"]),
    "too many": ("1\n2 2 1\n" + "0 " * 13, ["too many"]),
    "no size": ("1\n5 x 1\n", [":2:", "`x`"]),
    "volume": ("1\n2 2 2\n" + "0 " * 24, ["2 x 2 x 2", "surface"]),
    "no number": ("1\n2 2 1\n0 0 0 zero" + " 0" * 8, [":3:", "`zero`"]),
    "small": ("1\n3 3 1\n" + "0 1 2 3 4 5 6 7 8 " * 3, ["at least 5 points along u"]),
    "garbage": (b"\x00\x01\x02\x03" * 30, ["not a valid Plot3D grid"]),
}


@pytest.mark.parametrize("name", PLOT3D_FAULTS)
def test_plot3d_faults(cli, model_file, name):
    text, words = PLOT3D_FAULTS[name]
    done = cli("fair", model_file(text, "grid.p3d"), "--tol", "0.1", status=1)
    for word in words:
        assert word in done.stderr, done.stderr


def test_faults_in_python():
    points = make_data_points("circle.csv")
    cases = [
        (lambda: moldloft.fair(points[:4], 1), "at least 5"),
        (lambda: moldloft.fair(points, [1, 2]), "64 of them"),
        (lambda: moldloft.fair(points, -1), "at least 0"),
        (lambda: moldloft.fair(points, 1, as_="dots"), "`dots`"),
        (lambda: moldloft.fair(points, 1, mode="magic"), "magic"),
        (lambda: moldloft.fair(points, 1, measure="beauty"), "beauty"),
        (lambda: moldloft.fair(points, 1, motion="walk"), "walk"),
        (lambda: moldloft.fair(points, 1, motion=(0, 0)), "direction"),
        (lambda: moldloft.fair(points, 1, keep=["peace"]), "peace"),
        (lambda: moldloft.fair(points, 1, breaks=[64]), "63"),
        (lambda: moldloft.fair("points", 1), "array"),
        (lambda: moldloft.fair(np.zeros((5, 4)), 1), "(5, 4)"),
        (lambda: moldloft.fair(np.zeros((3, 9, 3)), 1), "along u"),
        (lambda: fairing.Spline(points, knots=np.arange(68)[::-1]), "knot"),
        (lambda: fairing.Spline(points, knots=np.arange(9)), "68"),
        (lambda: fairing.Spline(points, weights=np.zeros(64)), "weight 1 is 0"),
        (lambda: fairing.Spline(points, weights=np.ones(3)), "64 weights"),
        (lambda: fairing.network(points, [[0, 1, 2, 99, 4]], 1), "99"),
        (lambda: fairing.network(points, [[0, 1, 2, 3]], 1), "curve 1"),
        (lambda: fairing.network(points, [[0, 1, 2, 1, 4, 5]], 1), "twice"),
        (lambda: fairing.network(points, [], 1), "no curves"),
        (lambda: fairing.divided_differences(points[:3], [0, 0, 1]), "larger"),
    ]
    for call, words in cases:
        with pytest.raises(moldloft.FairingError) as caught:
            call()
        assert words in str(caught.value), caught.value
        assert not str(caught.value).startswith("error") and isinstance(caught.value, ValueError)
    bad = points.copy()
    bad[7, 1] = math.nan
    with pytest.raises(moldloft.FairingError) as caught:
        moldloft.fair(bad, 1)
    assert caught.value.index == 7


def test_same_bits_in_threads(cli):
    import concurrent.futures

    points = make_data_points("naca0012-3.csv")
    first = moldloft.fair(points, 1e-3, as_="control").points.tobytes()
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        again = pool.map(lambda _: moldloft.fair(points, 1e-3, as_="control"), range(16))
        bits = {made.points.tobytes() for made in again}
    assert bits == {first}


def test_long_work_hears_ctrl_c():
    import os
    import signal
    import threading

    if os.name == "nt":
        pytest.skip("signals")
    random = np.random.default_rng(1)
    n = 200_000
    points = np.column_stack([np.arange(n) * 0.01, np.sin(np.arange(n) * 1e-3)])
    points[:, 1] += 1e-3 * random.random(n)
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    # All of them take minutes.
    with pytest.raises(KeyboardInterrupt):
        for _ in range(100):
            moldloft.fair(points, 1e-3, as_="control", measure="jumps")


def test_ctrl_c_leaves_nothing_behind(tmp_path):
    import os
    import signal
    import subprocess
    import time

    if os.name == "nt":
        pytest.skip("signals")
    n = 150_000
    points = np.column_stack([np.arange(n) * 0.01, np.sin(np.arange(n) * 1e-3)])
    points[:, 1] += 1e-3 * np.random.default_rng(1).random(n)
    path = tmp_path / "long.csv"
    np.savetxt(path, points, delimiter=",")
    # It tells when it begins: a machine may need any time to start Python.
    begun = (
        "import sys; from moldloft.cli import main; print('begun', flush=True); sys.exit(main())"
    )
    command = [sys.executable, "-c", begun, "fair", str(path), "--tol", "1e-3"]
    process = subprocess.Popen(
        [*command, "--measure", "jumps", "-o", "out.csv", "--plot", "out.png"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    time.sleep(2)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 130, (process.returncode, err)
    assert "Traceback" not in err and out == ""
    assert [p.name for p in tmp_path.iterdir()] == ["long.csv"]


def test_data_stay_within_their_tolerance_at_any_spacing():
    """The classic stations: a straight line does not move, an arc keeps its curvature."""
    stations = np.array([0, 0.5, 1, 1.5, 2, 3, 4, 5, 6, 7, 8, 8.5, 9, 9.5, 10])
    line = np.column_stack([stations, 0.1 * stations])
    for options in ({}, {"motion": (0, 1)}, {"spacing": "x"}, {"as_": "points"}):
        for goal in ("near", "fairest"):
            faired = moldloft.fair(line, 0.02, goal=goal, **options)
            assert np.abs(faired.points - line).max() <= 1e-12, (options, goal)
    arc = 0.1 * stations * np.pi / 2
    faired = moldloft.fair(np.column_stack([np.cos(arc), np.sin(arc)]), 1e-3)
    assert np.abs(faired.spline.curvature(np.linspace(0, 1, 401)) - 1).max() < 5e-3
    rng = np.random.default_rng(3)
    x = np.sort(rng.uniform(0, 10, 60))
    noise = rng.uniform(-5e-3, 5e-3, 60)
    read = np.column_stack([x, np.sin(0.4 * x) + noise])
    for goal in ("near", "fairest", ("budget", 0.5), ("nearest", 0.2)):
        faired = moldloft.fair(read, 5e-3, goal=goal)
        assert faired.deviation_data <= 5e-3 * (1 + 1e-12)
        assert np.linalg.norm(faired.points - read, axis=1).max() <= 5e-3 * (1 + 1e-9)
        # Half of the noise's squares ask for its bends.
        most = faired.before.inflections if goal == ("budget", 0.5) else 2
        assert faired.after.inflections <= most
        again = moldloft.fair(faired.points, 5e-3, goal=goal, original=read)
        assert again.points.tobytes() == faired.points.tobytes()
    # Few control points: within the tolerance of the data, or refused.
    few = moldloft.fair(read, 2e-2, as_="fit", count=12)
    assert few.deviation_data <= 2e-2 and len(few.control_points) == 12
    with pytest.raises(FairingError, match="more control points"):
        moldloft.fair(read, 1e-3, as_="fit", count=6)


def test_repeated_points_and_empty_grids():
    points = make_data_points("waisted-noise.csv")
    twice = np.insert(points, 10, points[10], axis=0)
    faired = moldloft.fair(twice, 2e-4)
    assert faired.deviation_data <= 2e-4 and len(faired.points) == len(twice)
    with pytest.raises(FairingError):
        moldloft.fair(np.zeros((9, 2)), 0.1)
    grid = np.zeros((15, 10, 3))
    assert np.abs(moldloft.fair(grid, 0.005).points).max() == 0


def test_splines_are_written(tmp_path):
    from moldloft.fairing.spline_files import encoded

    points = make_data_points("waisted-noise.csv")
    spline = moldloft.fair(points, 2e-4).spline
    data = json.loads(encoded([spline], tmp_path / "o.json"))["splines"][0]
    again = fairing.Spline(data["control_points"], degree=data["degree"], knots=data["knots"])
    t = np.linspace(0, 1, 50)
    assert np.abs(again(t) - spline(t)).max() < 1e-14
    text = encoded([spline], tmp_path / "o.igs").decode()
    lines = text.splitlines()
    assert all(len(line) == 80 for line in lines) and lines[-1][72] == "T"
    body = "".join(line[:64].rstrip() for line in lines if line[72] == "P")
    words = body.rstrip(";").split(",")
    assert words[0] == "126" and int(words[1]) == len(spline.control_points) - 1
    pairs = encoded([spline], tmp_path / "o.dxf").decode().splitlines()
    codes = [int(c) for c in pairs[::2]]
    assert codes.count(10) == len(spline.control_points) and codes.count(40) == len(spline.knots)
    with pytest.raises(FairingError, match="ending"):
        encoded([spline], tmp_path / "o.foo")
