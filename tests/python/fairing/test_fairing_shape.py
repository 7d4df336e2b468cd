"""Shape as a condition of fairing, against SciPy's splines and solvers."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_interp_spline
from scipy.optimize import linprog, nnls

import moldloft

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def scipy_of(faired):
    s = faired.spline
    return BSpline(np.asarray(s.knots), s.control_points, s.degree)


def curvature(faired, per_span=40):
    """Signed curvature at many places of each span, by SciPy."""
    own = scipy_of(faired)
    knots = np.unique(own.t)
    share = np.linspace(0, 1, per_span + 1)
    inner = np.clip(share, 1e-9, 1 - 1e-9)
    t = (knots[:-1, None] + np.diff(knots)[:, None] * inner).ravel()
    d, dd = own.derivative(1)(t), own.derivative(2)(t)
    cross = d[:, 0] * dd[:, 1] - d[:, 1] * dd[:, 0]
    return t, cross / np.linalg.norm(d, axis=1) ** 3


def within(faired, data, tol):
    own = scipy_of(faired)
    at = np.asarray(faired.parameters)
    t = own.t[0] + (own.t[-1] - own.t[0]) * at
    off = np.linalg.norm(own(t)[:, : data.shape[1]] - data, axis=1)
    assert off.max() <= tol * (1 + 1e-9) + 1e-15


class Lcg:
    def __init__(self, seed):
        self.u = seed

    def __call__(self):
        self.u = (1103515245 * self.u + 12345) % 2**31
        return self.u / 2**31 - 0.5


HALF_BREADTH, BILGE, DEPTH = 4.6, 1.4, 6.2


def section(count, seed, noise):
    """Flat bottom, bilge arc, flat side; which points are on which."""
    flat, arc = HALF_BREADTH - BILGE, BILGE * np.pi / 2
    total = flat + arc + DEPTH - BILGE
    s = np.linspace(0, total, count)
    out = []
    for x in s:
        if x <= flat:
            out.append((x, 0.0))
        elif x <= flat + arc:
            angle = (x - flat) / BILGE
            out.append((flat + BILGE * np.sin(angle), BILGE * (1 - np.cos(angle))))
        else:
            out.append((HALF_BREADTH, BILGE + x - flat - arc))
    g = Lcg(seed)
    e = np.array([[2 * g(), 2 * g()] for _ in s]) * noise / np.sqrt(2)
    return np.array(out) + e, int((s <= flat).sum()), int((s <= flat + arc).sum())


@pytest.mark.parametrize("count", [30, 41, 60])
def test_a_midship_section(count):
    noise = 2e-3
    for seed in range(1, 40 if SOAK else 6):
        data, a, b = section(count, seed, noise)
        for known in (False, True):
            bottom, side = ((1, 0), (0, 1)) if known else (None, None)
            flat = [":1,0", ":0,1"] if known else ["", ""]
            shape = [
                f"straight=1-{a}{flat[0]}",
                f"arc={a + 1}-{b}",
                f"straight={b + 1}-{count}{flat[1]}",
            ]
            faired = moldloft.fair(data, noise, shape=shape)
            within(faired, data, noise)
            own = scipy_of(faired)
            at = np.asarray(faired.parameters)
            for first, last, way in ((0, a - 1, bottom), (b, count - 1, side)):
                p = own(np.linspace(at[first], at[last], 400))[:, :2]
                chord = p[-1] - p[0]
                n = np.array([-chord[1], chord[0]]) / np.linalg.norm(chord)
                assert np.abs((p - p[0]) @ n).max() < 1e-9
                if way:
                    assert abs(n @ np.array(way)) < 1e-9
            assert len(faired.arcs) == 1
            arc = faired.arcs[0]
            assert abs(arc.radius - BILGE) < 0.01 * BILGE + 3 * noise
            t, k = curvature(faired)
            inside = (t > at[a]) & (t < at[b - 1])
            assert np.abs(k[inside] * arc.radius - 1).max() < 0.01
            assert k.min() > -1e-7
            # Rounding of the straight runs is no sign of curvature.
            assert faired.after.inflections == 0
            assert arc.off < 0.05 * noise


def test_an_arc_by_itself_and_with_one_line():
    g = Lcg(3)
    angle = np.linspace(0.2, 2.4, 25)
    ring = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle)])
    noise = 1e-3
    data = ring + noise / np.sqrt(2) * np.array([[2 * g(), 2 * g()] for _ in angle])
    faired = moldloft.fair(data, noise, shape=["arc=1-25"])
    within(faired, data, noise)
    assert abs(faired.arcs[0].radius - 2) < 2e-3
    assert np.linalg.norm(faired.arcs[0].centre[:2]) < 3e-3
    # The same arc in the middle of a free curve, and turned out of the plane of x and y.
    faired = moldloft.fair(data, noise, shape=["arc=6-19"])
    within(faired, data, noise)
    t, k = curvature(faired)
    at = faired.parameters
    inside = (t > at[5]) & (t < at[18])
    assert np.abs(k[inside] * faired.arcs[0].radius - 1).max() < 1e-3
    turned = np.column_stack([data[:, 0], np.full(25, 0.7), data[:, 1]])
    again = moldloft.fair(turned, noise, shape=["arc=6-19"])
    assert abs(again.arcs[0].radius - faired.arcs[0].radius) < 1e-9
    # A line of known direction that runs into an arc.
    line = np.column_stack([np.linspace(-4, -0.5, 8), np.full(8, -1.5)])
    bow = np.linspace(0.15, 1.4, 10)
    rest = np.column_stack([1.5 * np.sin(bow), -1.5 * np.cos(bow)])
    data = np.vstack([line, rest])
    data = data + noise / np.sqrt(2) * np.array([[2 * g(), 2 * g()] for _ in data])
    faired = moldloft.fair(data, noise, shape=["straight=1-8:1,0", "arc=9-18"])
    within(faired, data, noise)
    assert abs(faired.arcs[0].radius - 1.5) < 0.02


def graph(n, seed, noise):
    g = Lcg(seed)
    x = np.sort(np.concatenate([[0, 1], [0.5 + 0.9 * g() for _ in range(n - 2)]]))
    x = x + 0.01 * np.arange(n)
    truth = (x - 0.4) ** 2 * 0.3 + 0.05 * np.maximum(x - 0.6, 0) ** 3
    return x, truth, np.column_stack([x, truth + noise * np.array([2 * g() for _ in x])])


def knots_at(x):
    return np.concatenate([[x[0]] * 4, x[2:-2], [x[-1]] * 4])


@pytest.mark.parametrize("goal", ["fairest", "closest"])
def test_convex_graphs_are_the_optimum_by_scipy(goal):
    """Forces of the limits that balance the slope bound how far a value is from the least."""
    noise = 2e-3
    active = 0
    missed = []
    for seed in range(1, 200 if SOAK else 12):
        x, _, data = graph(13, seed, noise)
        # Flat in the middle, where third derivatives would hollow it out.
        flat = np.maximum(np.abs(x - 0.5) - 0.2, 0) ** 2 - 0.25 * (x - 0.5) ** 2
        data[:, 1] += 0.8 * (seed % 3) * flat
        try:
            faired = moldloft.fair(
                data, noise, motion=(0, 1), spacing="x", goal=goal, shape=["convex"], bends=True
            )
        except moldloft.FairingError as error:
            assert "no curve with this shape" in str(error)
            faired = None
        # SciPy: the values at the knots of y'' and of y''' are linear in y.
        t = knots_at(x)
        unit = [make_interp_spline(x, e, k=3, t=t) for e in np.eye(len(x))]
        places = np.unique(t)
        second = np.column_stack([u.derivative(2)(places) for u in unit])
        middles = 0.5 * (places[1:] + places[:-1])
        third = np.column_stack([u.derivative(3)(middles) for u in unit])
        root = np.sqrt(np.diff(places))[:, None] * third
        root = np.eye(len(x)) if goal == "closest" else root
        y0 = data[:, 1]
        if faired is None:
            none = linprog(0 * y0, -second, second @ y0, bounds=[(-noise, noise)] * len(y0))
            assert none.status == 2
            continue
        within(faired, data, noise)
        if len(faired.spline.control_points) > len(x):
            # With knots at the points alone there is none.
            none = linprog(0 * y0, -second, second @ y0, bounds=[(-noise, noise)] * len(y0))
            assert none.status == 2 and curvature(faired)[1].min() >= -1e-9
            continue
        own = scipy_of(faired)
        ours = own(np.asarray(own.t[0] + (own.t[-1] - own.t[0]) * faired.parameters))[:, 1] - y0
        scale = np.abs(second).sum(axis=1)
        assert (second @ (y0 + ours) / scale).min() > -1e-15
        e = root @ ours if goal == "closest" else root @ (y0 + ours)
        slope = 2 * root.T @ e
        rows = np.vstack([np.eye(len(x)), -np.eye(len(x)), -second / scale[:, None]])
        room = np.concatenate([noise - ours, noise + ours, second @ (y0 + ours) / scale])
        # By convexity no value within the limits is lower by more than this.
        gap = e @ e
        for near in (room < share * noise for share in (1e-9, 1e-7, 1e-5, 1e-3)):
            force = nnls(rows[near].T, -slope)[0] if near.any() else np.zeros(0)
            left = slope + rows[near].T @ force
            # The square of distances is convex by itself; of others no point is farther.
            rest = left @ left / 4 if goal == "closest" else 2 * noise * np.abs(left).sum()
            gap = min(gap, force @ room[near] + rest)
        if gap > 1e-6 * (e @ e) + 1e-12 * (root @ y0) @ (root @ y0):
            missed.append((seed, gap, e @ e))
        active += int((room[-len(scale) :] < 1e-6 * noise).any())
    assert active >= 2
    # Of one fairest of 199 the forces do not show what SLSQP does: that it is the least to 2e-10.
    assert len(missed) <= int(SOAK and goal == "fairest"), missed


def wavy(n, seed, noise, bend):
    g = Lcg(seed)
    u = np.sort(np.concatenate([[0, 1], [0.5 + 0.96 * g() for _ in range(n - 2)]]))
    keep = np.concatenate([[True], np.diff(u) > 2e-3])
    u = u[keep]
    truth = np.column_stack([np.cos(bend * u), 0.7 * np.sin(bend * u)])
    return truth + noise / np.sqrt(2) * np.array([[2 * g(), 2 * g()] for _ in u])


def test_signs_hold_everywhere():
    for seed in range(1, 120 if SOAK else 12):
        noise = 3e-3
        data = wavy(40, seed, noise, 2.6)
        n = len(data)
        for shape in (["convex"], ["one-way"], "convex", [f"convex=4-{n - 4}"]):
            faired = moldloft.fair(data, noise, shape=shape)
            within(faired, data, noise)
            t, k = curvature(faired)
            at = np.asarray(faired.parameters)
            low, high = (at[3], at[n - 5]) if "=" in shape[0] else (0, 1)
            assert k[(t >= low) & (t <= high)].min() >= -1e-9
        # Run backwards it is concave.
        back = moldloft.fair(data[::-1], noise, shape=["concave"])
        assert curvature(back)[1].max() <= 1e-9
        # A convex tolerance tube has no concave curve in it.
        with pytest.raises(moldloft.FairingError, match="concave"):
            moldloft.fair(data, noise, shape=["concave"])


def test_pieces_of_monotone_curvature():
    for seed in range(1, 60 if SOAK else 8):
        noise = 2e-3
        g = Lcg(seed)
        u = np.linspace(0, 1, 36)
        s = 2.2 * u * u
        fine = np.linspace(0, 1, 4001)
        c = (
            np.cumsum(np.column_stack([np.cos(2.2 * fine**2), np.sin(2.2 * fine**2)]), axis=0)
            / 4001
        )
        truth = np.column_stack([np.interp(u, fine, c[:, k]) for k in (0, 1)])
        assert s.max() > 0
        data = truth + noise / np.sqrt(2) * np.array([[2 * g(), 2 * g()] for _ in u])
        try:
            faired = moldloft.fair(data, noise, shape=["pieces=1"])
        except moldloft.FairingError:
            # One of 59 draws, whose search ends at three pieces: see "Limits".
            assert seed == 58
            continue
        within(faired, data, noise)
        _, k = curvature(faired)
        down = np.minimum.accumulate(k[::-1])[::-1]
        assert (k - down).max() < 2e-3 * np.ptp(k)


def test_limits_and_sides():
    data, *_ = section(30, 2, 2e-3)
    plain = moldloft.fair(data, 2e-3)
    assert plain.spline(np.linspace(0, 1, 2000))[:, 0].max() > HALF_BREADTH
    shape = [f"within=1,0:{HALF_BREADTH}", "within=0,-1:0"]
    faired = moldloft.fair(data, 3e-3, shape=shape)
    within(faired, data, 3e-3)
    p = faired.spline(np.linspace(0, 1, 20001))
    assert p[:, 0].max() <= HALF_BREADTH and p[:, 1].min() >= 0
    faired = moldloft.fair(data, 2e-3, shape=["side=1,0"])
    assert (faired.points[:, 0] <= data[:, 0] + 1e-15).all()
    with pytest.raises(moldloft.FairingError, match=r"missed by.*within=1,0:4"):
        moldloft.fair(data, 2e-3, shape=["within=1,0:4"])


def test_straight_runs_in_the_plane_and_in_space():
    g = Lcg(9)
    x = np.linspace(0, 3, 31)
    y = np.where(x < 1.5, 0.2 * x, 0.3 + 0.2 * (x - 1.5) + 0.3 * (x - 1.5) ** 2)
    for z in (0 * x, 0.1 * np.where(x < 1.5, x, 1.5 + np.sin(x - 1.5))):
        data = np.column_stack([x, y, z]) + 1e-3 * np.array([[g(), g(), g()] for _ in x])
        if not z.any():
            data[:, 2] = 0
        faired = moldloft.fair(data, 1e-3, shape=["straight=1-15"])
        within(faired, data, 1e-3)
        p = faired.spline(np.linspace(0, float(faired.parameters[14]), 500))
        chord = (p[-1] - p[0]) / np.linalg.norm(p[-1] - p[0])
        off = p - p[0]
        off -= np.outer(off @ chord, chord)
        assert np.linalg.norm(off, axis=1).max() < 1e-9


def test_the_nearest_stays():
    noise = 3e-3
    data = wavy(40, 5, noise, 2.6)
    faired = moldloft.fair(data, noise, shape="convex", goal="closest")
    assert 0 < faired.deviation_data <= noise * (1 + 1e-12)
    # Fairing a result again is fairing its data again, to the bit.
    again = moldloft.fair(faired, noise, shape="convex", goal="closest")
    assert again.points.tobytes() == faired.points.tobytes()
    # What has the shape asked for does not move at the same parameters.
    still = moldloft.fair(
        faired.points, noise, at=faired.parameters, shape="convex", goal="closest"
    )
    assert np.abs(still.points - faired.points).max() <= 1e-15
    least = moldloft.fair(data, noise, goal="fairest")
    most = 2.0 * least.value
    near = moldloft.fair(data, noise, goal=("energy", most))
    assert near.value == pytest.approx(most, rel=1e-6)
    assert np.sum(near.residuals**2) < np.sum(least.residuals**2)
    kept = moldloft.fair(near.points, noise, at=near.parameters, goal=("energy", 1.001 * most))
    assert kept.points.tobytes() == near.points.tobytes()
    with pytest.raises(moldloft.FairingError, match="the minimum is"):
        moldloft.fair(data, noise, goal=("energy", 0.5 * least.value))


def test_the_command_and_its_page(cli, model_file, tmp_path):
    data, a, b = section(30, 1, 2e-3)
    path = model_file("\n".join(f"{x!r}, {y!r}" for x, y in data.tolist()), "section.csv")
    asked = [
        path, "--tol", "2e-3", "--shape", f"straight=1-{a}", "--shape", f"arc={a + 1}-{b}",
        "--shape", f"straight={b + 1}-30:0,1",
    ]  # fmt: skip
    reported = json.loads(cli("fair", *asked, "--report", "page.html", "--json").stdout)
    assert reported["arcs"][0]["points"] == [a + 1, b]
    assert reported["arcs"][0]["radius"] == pytest.approx(BILGE, rel=0.01)
    html = (tmp_path / "page.html").read_text()
    assert html.count("<svg") == 3
    assert "radius 1.4" in html or "radius 1.39" in html
    assert "http" not in html.replace("http://www.w3.org", "")
    for bad, words in (
        ("round=1-5", "one-way"),
        ("arc=5-2", "1 to 30"),
        ("arc=1-31", "1 to 30"),
        ("within=4.6", "expected one of"),
    ):
        done = cli("fair", path, "--tol", "1e-3", "--shape", bad, status=1)
        assert words in done.stderr
    done = cli("fair", path, "--tol", "1e-3", "--report", "page.pdf", status=1)
    assert ".html" in done.stderr


def test_what_has_no_shape_is_refused():
    t = np.linspace(0, 3, 20)
    helix = np.column_stack([np.cos(t), np.sin(t), t])
    flat = helix.copy()
    flat[:, 2] = 0
    ring = np.column_stack([np.cos(2 * t), np.sin(2 * t)])
    cases = [
        (helix, ["convex"], "projections", {}),
        (flat, ["arc=2-10"], "three points", {}),
        (flat, ["straight=1-6", "straight=6-10"], "break", {}),
        (flat, ["straight=1-6", "arc=4-10"], "two runs", {}),
        (flat, ["arc=3-10"], "degree 3", {"degree": 4}),
        (flat, ["arc=5-6"], "three points", {}),
        (flat, ["pieces=many"], "expected one of", {}),
        (flat, ["round"], "expected one of", {}),
        (flat, ["convex=10-4"], "first and a later", {}),
        (flat, ["straight=1-11"], "straight=1-11", {}),
        (ring[:-1], ["straight=4-7"], "open curves", {"closed": True}),
        (flat, ["convex"], "optima of data", {"as_": "control"}),
    ]
    for data, shape, words, options in cases:
        with pytest.raises(moldloft.FairingError, match=words):
            moldloft.fair(data, 1e-4, shape=shape, **options)


MODEL = """
AbsPoint A(0, 0, 0); AbsPoint B(1, 0.52, 0); AbsPoint C(2, 0.83, 0); AbsPoint D(3, 0.88, 0);
AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.49, 0); AbsPoint G(6, 0, 0);
FairCurve c({A, B, C, D, E, F, G}, 0.05, shape = {"concave", "within=0,1:0.86"}, measure = "third");
FairCurve d({A, B, C, D, E, F, G}, 0.05, through = {D}, through_at = {0.5}, bends = 0);
"""


def test_models_have_the_options_of_python():
    m = moldloft.loads(MODEL)
    p = m["c"](np.linspace(0, 1, 4001))
    assert p[:, 1].max() <= 0.86
    first, second = np.diff(p[:-1, :2], axis=0), np.diff(p[1:, :2], axis=0)
    turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    assert turn.max() <= 1e-12
    assert np.abs(m["d"](0.5) - [3, 0.88, 0]).max() < 1e-9
    for wrong, words in (
        ('shape = {"convex"}', "no curve with this shape"),
        ('shape = {"round"}', "one-way"),
        ("through = {D}", "parameter for each"),
        ('keep = {"length"}', "cannot be kept"),
        ('goal = "energy"', "largest measure"),
        ('shape = {"convex"}, mode = "faithful"', "near their points"),
        ("tolerances = {0.1, 0.2}", "tolerances"),
    ):
        with pytest.raises(moldloft.ModelError) as caught:
            moldloft.loads(MODEL.replace('shape = {"concave", "within=0,1:0.86"}', wrong))
        assert words in str(caught.value), (wrong, str(caught.value))
