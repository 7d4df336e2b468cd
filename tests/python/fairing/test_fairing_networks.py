"""Networks with conditions: shapes, knuckles, releases, motions and tolerances of curves."""

import os

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from moldloft import FairingError
from moldloft.fairing import network

X = np.linspace(0, 12, 13)
Z = np.linspace(0, 3, 9)
NOISE = 0.02


def hull(x, z):
    """A hull with a parallel body from 4 to 8 and a flat side from 1.5 on."""
    out = np.maximum(np.maximum(4 - x, x - 8), 0) / 4
    section = 2 - 1.5 * np.maximum(1.5 - z, 0) ** 2 / 2.25
    return section * (1 - 0.8 * out**2.5)


def table(of=hull, seed=0, noise=NOISE):
    """The points of a table, its curves and their names, and the exact offsets."""
    x, z = np.meshgrid(X, Z, indexing="ij")
    exact = of(x, z)
    y = exact + np.random.default_rng(seed).uniform(-noise, noise, x.shape)
    at = np.arange(x.size).reshape(x.shape)
    names = [f"station {k}" for k in range(len(X))] + [f"WL {k}" for k in range(len(Z))]
    return np.stack([x, y, z], -1).reshape(-1, 3), [*at.tolist(), *at.T.tolist()], names, exact


def offsets(faired):
    return faired.points[:, 1].reshape(len(X), len(Z))


BODY = "WL 0..WL 8 at station 4..station 8: straight:1,0,0"
SIDE = "WL 5..WL 8 at station 4..station 8: flat:0,1,0"


def test_parallel_bodies_and_flats_are_exact():
    points, curves, names, exact = table()
    made = network(points, curves, NOISE, names=names, motion=(0, 1, 0), shape=[BODY, SIDE])
    y = offsets(made)
    assert np.ptp(y[4:9], axis=0).max() <= 1e-9
    assert np.ptp(y[4:9, 5:]) <= 1e-9
    assert np.abs(made.points - points).max() <= NOISE * (1 + 1e-12)
    # The curves, too, and what follows leaves them along their tangents.
    for k, name in enumerate(names[13:]):
        assert name == f"WL {k}"
        curve = made.curves[13 + k]
        samples = curve.at(np.linspace(0, 1, 1201))
        inside = (samples.points[:, 0] > 4) & (samples.points[:, 0] < 8)
        assert np.abs(samples.points[inside, 1] - y[4, k]).max() <= 1e-9
        slopes = samples.first[:, 1] / samples.first[:, 0]
        assert np.abs(np.diff(slopes)).max() < 0.05
    # With its body the network is nearer to the hull than without, and both than the data.
    near = np.zeros(3)
    for seed in range(4):
        points, curves, names, exact = table(seed=seed)
        options = {"names": names, "motion": (0, 1, 0)}
        shaped = network(points, curves, NOISE, shape=[BODY, SIDE], **options)
        plain = network(points, curves, NOISE, **options)
        all_of = [offsets(shaped), offsets(plain), points[:, 1].reshape(exact.shape)]
        near += [((y - exact) ** 2).mean() for y in all_of]
    assert near[0] < near[1] < near[2]


def _bilges(seed, noise):
    """Sections of an arc and a vertical side: the points, their curves, names, and the radius."""
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.8, 1.5)
    angle = np.radians(np.linspace(25, 90, int(rng.integers(6, 9))))
    z = np.r_[radius * (1 - np.cos(angle)), radius + np.array([0.4, 0.8, 1.2])]
    x = np.linspace(0, 12, 7)
    breadth = 3 - 0.02 * (x - rng.uniform(4, 8)) ** 2
    turn = radius - np.sqrt(np.maximum(radius**2 - np.maximum(radius - z, 0) ** 2, 0))
    y = breadth[:, None] - turn[None] + noise * rng.uniform(-1, 1, (len(x), len(z)))
    points = np.stack([np.repeat(x, len(z)), y.ravel(), np.tile(z, len(x))], axis=-1)
    at = np.arange(y.size).reshape(y.shape)
    names = [f"station {k}" for k in range(len(x))] + [f"WL {k}" for k in range(len(z))]
    return points, [*at.tolist(), *at.T.tolist()], names, radius, len(angle)


def test_arcs_are_circles_tangent_to_runs():
    for seed in range(60 if os.environ.get("MOLDLOFT_SOAK") else 4):
        noise = (0.002, 0.01)[seed % 2]
        points, curves, names, radius, last = _bilges(seed, noise)
        count = len(curves[0])
        beside = seed // 2 % 2
        shape = [
            f"station 0..station 6: arc=1-{last}",
            f"station 0..station 6: straight={last + beside}-{count}:0,0,1",
        ]
        made = network(
            points, curves, noise, names=names, motion=(0, 1, 0), shape=shape, fixed="none"
        )
        assert np.abs(made.points - points).max() <= noise * (1 + 1e-9)
        for k in range(7):
            own = made.points[curves[k]][:, 1:]
            arc, side = own[:last], own[last - 1 + beside :]
            # The circle by linear least squares: y^2 + z^2 = 2 a y + 2 b z + c.
            rows = np.c_[2 * arc, np.ones(last)]
            (a, b, c), *_ = np.linalg.lstsq(rows, (arc**2).sum(axis=1), rcond=None)
            found = np.sqrt(c + a * a + b * b)
            off = np.abs(np.hypot(arc[:, 0] - a, arc[:, 1] - b) - found).max()
            assert off <= 1e-9, (seed, k, off)
            assert np.ptp(side[:, 0]) <= 1e-9
            assert abs(side[0, 0] - a - found) <= 1e-7, (seed, k)
            assert abs(found - radius) < 30 * noise
            text = f"station {k}: an arc from point {curves[k][0] + 1} "
            (note,) = (note for note in made.notes if note.startswith(text))
            assert float(note.split("radius ")[1]) == pytest.approx(found, rel=1e-4)


def test_conditions_that_cannot_hold_are_named():
    points, curves, names, _ = table()
    options = {"names": names, "motion": (0, 1, 0)}
    for shape, said in (
        ("WL 3: straight:1,0,0", "WL 3: straight:1,0,0"),
        ("WL 9: convex", "WL 9"),
        ("WL 3: round", "convex=4-10"),
        ("WL 3: straight=2-40", "WL 3"),
        ("WL 3: pieces=2", "single curves"),
        ("WL 3: arc=2-4", "4 points of an arc"),
        ("WL 3: arc=2-40", "WL 3"),
        ("WL 2: tangent=start:0,0,0", "direction"),
        ("station 2 at WL 0..WL 4: flat:1,0.1,0", "station 2"),
    ):
        with pytest.raises(FairingError) as caught:
            network(points, curves, NOISE, shape=[shape], **options)
        assert said in str(caught.value), (shape, str(caught.value))
    with pytest.raises(FairingError, match="names of curves"):
        network(points, curves, NOISE, names=names[1:])
    with pytest.raises(FairingError, match="WL 0"):
        network(points, [*curves[:13], curves[13][:4]], NOISE, names=names[:14])
    with pytest.raises(FairingError, match="direction"):
        network(points, curves, NOISE, names=names, keep="volume")


def test_signs_hold_all_along_curves():
    # Waterlines that fall to both ends turn to the right as x rises.
    points, curves, names, _ = table(lambda x, z: 1.5 - 0.004 * (x - 6) ** 2 + 0.1 * z)
    options = {"names": names, "motion": (0, 1, 0), "goal": ("budget", 0.2)}
    plain = network(points, curves, NOISE, **options)
    made = network(points, curves, NOISE, shape="WL 0..WL 8: concave", **options)
    one_way = network(points, curves, NOISE, shape="WL 0..WL 8: one-way", **options)

    def turns(faired):
        return [c.curvature(np.linspace(0, 1, 301)) for c in faired.curves[13:]]

    assert max(k.max() for k in turns(plain)) > 1e-4
    for held in (made, one_way):
        assert max(k.max() for k in turns(held)) <= 1e-9
    with pytest.raises(FairingError, match=r"WL 4: convex"):
        network(points, curves, NOISE, shape="WL 4: convex", **options)


def least_third(x, y, tol, sign):
    """The least measure of a line of offsets whose spline bends to one side, by SciPy alone."""
    at = (x - x[0]) / (x[-1] - x[0])
    rows = np.zeros((len(x) - 3, len(x)))
    for k, row in enumerate(rows):
        t = at[k : k + 4]
        for i in range(4):
            row[k + i] = 6 * np.sqrt((t[3] - t[0]) / 3) / np.prod(np.delete(t[i] - t, i))
    bend = -sign * np.array([CubicSpline(at, unit)(at, 2) for unit in np.eye(len(x))]).T
    size = np.abs(bend @ y).max()
    scale = ((rows @ y) ** 2).sum()
    found = minimize(
        lambda v: ((rows @ (y + tol * v)) ** 2).sum() / scale,
        np.zeros(len(x)),
        jac=lambda v: 2 * tol * rows.T @ (rows @ (y + tol * v)) / scale,
        bounds=[(-1, 1)] * len(x),
        constraints={
            "type": "ineq",
            "fun": lambda v: -bend @ (y + tol * v) / size,
            "jac": lambda v: -tol * bend / size,
        },
        method="SLSQP",
        options={"maxiter": 500, "ftol": 1e-13},
    )
    assert (bend @ (y + tol * found.x)).max() <= 1e-6 * size
    return found.fun * scale


def test_the_fairest_under_signs_is_that_of_another_solver():
    # Waterlines alone: the optimum of each is its own.
    for seed in range(40 if os.environ.get("MOLDLOFT_SOAK") else 4):
        rng = np.random.default_rng(seed)
        count, tol = int(rng.integers(9, 16)), float(rng.choice([0.005, 0.02]))
        x = np.cumsum(rng.uniform(0.6, 1.4, count))
        z = np.linspace(0, 3, int(rng.integers(4, 8)))
        middle, bulge = rng.uniform(3, 7), rng.uniform(0.003, 0.03)
        # Of more than the third order, so that the least is not nothing.
        off = x[:, None] - middle
        exact = 3 - bulge * off**2 - rng.uniform(0.3, 0.8) * (off / 6) ** 4 + 0.1 * z
        y = exact + rng.uniform(-tol, tol, exact.shape)
        grid = np.arange(y.size).reshape(y.shape)
        points = np.stack([np.repeat(x, len(z)), y.ravel(), np.tile(z, len(x))], axis=-1)
        word = ("concave", "one-way")[seed % 2]
        made = network(
            points, grid.T.tolist(), tol, motion=(0, 1, 0), goal="fairest", fixed="none",
            shape=f"1..{len(z)}: {word}",
        )  # fmt: skip
        least = sum(least_third(x, y[:, k], tol, -1) for k in range(len(z)))
        assert abs(made.measure_after / least - 1) <= 1e-6, (seed, made.measure_after, least)


def test_the_displacement_and_its_centroid_stay():
    points, curves, names, _ = table()

    def moments(y):
        area = np.array([CubicSpline(Z, row).integrate(0, 3) for row in y])
        high = np.array([CubicSpline(Z, row * Z).integrate(0, 3) for row in y])
        volume = CubicSpline(X, area).integrate(0, 12)
        return volume, CubicSpline(X, area * X).integrate(0, 12) / volume, high.sum()

    before = moments(points[:, 1].reshape(len(X), len(Z)))
    options = {"names": names, "motion": (0, 1, 0), "goal": "fairest", "fixed": "none"}
    free = moments(offsets(network(points, curves, NOISE, **options)))
    kept = moments(offsets(network(points, curves, NOISE, keep="volume", **options)))
    both = network(points, curves, NOISE, keep=["volume", "centroid"], **options)
    assert abs(free[0] - before[0]) > 1e-4
    assert abs(kept[0] - before[0]) < 1e-9
    assert np.abs(np.subtract(moments(offsets(both))[:2], before[:2])).max() < 1e-9


def test_tolerances_of_curves():
    points, curves, names, _ = table()
    options = {"names": names, "motion": (0, 1, 0), "goal": "fairest"}
    made = network(points, curves, {"WL 3": 0.001, "": NOISE}, **options)
    moved = np.abs(made.points - points)[:, 1].reshape(len(X), len(Z))
    assert moved[:, 3].max() <= 0.001 * (1 + 1e-12) < moved[:, 4].max()
    with pytest.raises(FairingError, match="all other curves"):
        network(points, curves, {"WL 3": 0.001}, **options)
    with pytest.raises(FairingError, match="WL 12"):
        network(points, curves, {"WL 12": 0.001, "": 1}, **options)


def test_released_points_count_in_no_distance():
    points, curves, names, exact = table()
    wrong = 6 * len(Z) + 4
    points[wrong, 1] += 1.0
    options = {"names": names, "motion": (0, 1, 0)}
    made = network(points, curves, NOISE, release=[wrong], **options)
    assert made.deviation_sampled <= NOISE * (1 + 1e-12)
    assert abs(made.points[wrong, 1] - exact[6, 4]) < NOISE
    assert made.released == (wrong,)
    assert any(f"point {wrong + 1} was released" in note for note in made.notes)
    found = network(points, curves, NOISE, release="auto", **options)
    assert found.released == (wrong,)
    assert (found.points == made.points).all()


def chined(x, z):
    """A hull with a chine at the fifth waterline."""
    fore, up = 1 - 0.5 * (x / 12) ** 2, z - Z[4]
    return fore * (1 + np.where(up < 0, 0.6, 0.1) * up - 0.02 * up**2)


def test_knuckles_are_shared_along_a_curve():
    points, curves, names, exact = table(chined, noise=0.004)
    options = {"names": names, "motion": (0, 1, 0)}
    made = network(points, curves, 0.004, breaks="auto", **options)
    named = network(points, curves, 0.004, breaks=["WL 4"], **options)
    assert (made.points == named.points).all()
    # The chine itself is faired, and the stations turn in it.
    chine = offsets(made)[:, 4] - exact[:, 4]
    assert np.abs(offsets(made)[1:-1, 4] - points[:, 1].reshape(exact.shape)[1:-1, 4]).max() > 0
    assert np.abs(chine).max() <= 0.008
    curve = made.curves[6]
    samples = curve.at(np.linspace(0, 1, 2001))
    slope = samples.first[:, 1] / samples.first[:, 2]
    assert np.abs(np.diff(slope)).max() > 0.2
    plain = network(points, curves, 0.004, **options)

    def rms(result):
        return np.sqrt(((offsets(result) - exact) ** 2).mean())

    assert rms(made) < rms(plain)


def test_cells_without_a_hull_end_curves():
    points, curves, names, _ = table()
    # A tunnel through the middle of the lowest waterlines.
    gap = [6 * len(Z), 6 * len(Z) + 1, 7 * len(Z)]
    points[gap] = np.nan
    made = network(points, curves, NOISE, names=names, motion=(0, 1, 0))
    assert np.isnan(made.points[gap]).all()
    assert np.isfinite(np.delete(made.points, gap, axis=0)).all()
    used = {i for own in made.lists for i in own}
    assert used.isdisjoint(gap)
    assert {"WL 0, part 1", "WL 0, part 2", "WL 2", "station 6"} <= set(made.names)
    assert made.deviation_sampled <= NOISE * (1 + 1e-12)


def test_curves_in_space_move_in_directions_of_their_own():
    points, curves, names, _ = table()
    rng = np.random.default_rng(3)
    sheer = np.c_[X, 2.2 - 0.03 * (X - 5) ** 2, 3.4 + 0.01 * (X - 7) ** 2]
    sheer[:, 1:] += rng.uniform(-NOISE, NOISE, (len(X), 2)) / 2
    base = len(points)
    points = np.vstack([points, sheer])
    curves = [[*own, base + k] if k < len(X) else own for k, own in enumerate(curves)]
    curves.append(list(range(base, base + len(X))))
    names = [*names, "sheer"]
    made = network(
        points, curves, NOISE, names=names, fixed="none",
        motion={"": (0, 1, 0), "sheer": ("across", (1, 0, 0))},
    )  # fmt: skip
    moved = made.points - points
    assert np.abs(moved[:, 0]).max() <= 1e-12
    assert np.abs(moved[:base, 2]).max() <= 1e-12 < np.abs(moved[base:, 2]).max()
    assert np.linalg.norm(moved, axis=1).max() <= NOISE * (1 + 1e-12)
    diagonal = network(
        points, curves, NOISE, names=names, motion={"": (0, 1, 0), "sheer": (0, 0.6, 0.8)}
    )
    moved = diagonal.points - points
    assert np.abs(np.cross(moved[base:], [0, 0.6, 0.8])).max() <= 1e-12
    assert np.abs(moved[:base, [0, 2]]).max() <= 1e-12


def test_the_tolerance_file_of_a_network(cli, tmp_path):
    points, curves, _, _ = table()
    blocks = ["\n".join(",".join(map(repr, points[i].tolist())) for i in own) for own in curves]
    (tmp_path / "hull.csv").write_text("\n\n".join(blocks) + "\n")
    (tmp_path / "tol.txt").write_text("0.02\n" * len(points))
    (tmp_path / "short.txt").write_text("0.02\n" * 7)
    cli("fair", tmp_path / "hull.csv", "--tol", tmp_path / "tol.txt", "--along", "0,1,0")
    error = cli(
        "fair", tmp_path / "hull.csv", "--tol", tmp_path / "short.txt", "--along", "0,1,0", status=1
    ).stderr
    assert "117 tolerances" in error
    assert "234" in error


def _wigley(x, z):
    return 5 * (1 - (x / 30 - 1) ** 2) * (1 - 0.8 * (1 - z / 6) ** 2)


def _round(x, z):
    return 5 * (1 - 0.9 * np.abs(x / 30 - 1) ** 3) * np.sqrt(1 - 0.999 * (1 - z / 6) ** 2)


def _fine(x, z):
    return 5 * np.sin(np.pi * (0.02 + 0.96 * x / 60)) ** 1.3 * (1 - 0.55 * (1 - z / 6) ** 2)


@pytest.mark.parametrize("of", [_wigley, _round, _fine])
def test_wrong_readings_of_a_table_are_the_first_suspects(of):
    # 11 stations by 7 waterlines, off by 2 or 4 mm, and one reading by 5 to 30 cm.
    x, z = np.meshgrid(np.linspace(0, 60, 11), np.linspace(0, 6, 7), indexing="ij")
    at = np.arange(x.size).reshape(x.shape)
    curves = [*at.tolist(), *at.T.tolist()]
    draws = 200 if os.environ.get("MOLDLOFT_SOAK") else 12
    first, five, near = 0, 0, 0
    for seed in range(draws):
        rng = np.random.default_rng(seed)
        noise = (0.002, 0.004)[seed % 2]
        exact = of(x, z)
        y = np.round(exact + rng.uniform(-noise, noise, x.shape), 3)
        i, j = rng.integers(2, 9), rng.integers(2, 5)
        y[i, j] += (0.05, 0.1, 0.3)[seed % 3] * rng.choice([-1, 1])
        points = np.stack([x, y, z], -1).reshape(-1, 3)
        made = network(points, curves, noise, motion=(0, 1, 0), goal="fairest")
        assert set(made.axes) == {"y"}
        found = made.suspects(5)
        order = [s.index for s in found]
        first += order[:1] == [at[i, j]]
        if at[i, j] in order:
            five += 1
            own = found[order.index(at[i, j])]
            reading = own.expected if own.meant is None else own.meant
            near += abs(reading - exact[i, j]) < abs(y[i, j] - exact[i, j]) / 2
    assert five >= 0.9 * draws, (first, five)
    assert first >= 0.75 * draws, (first, five)
    assert near >= 0.9 * five, (near, five)


def _vessel(x, z):
    """A supply vessel: hard bilges that rise to the ends, a keel of no breadth, a full deck."""
    fore, aft = np.clip((x - 36) / 24, 0, 1), np.clip((24 - x) / 24, 0, 1)
    bilge = 0.18 + 0.7 * fore**2 + 0.35 * aft**2
    rise = np.clip(z / 6, 0, 1) ** bilge * (1 - 0.85 * fore**2.2 * (1.1 - z / 6))
    return 5 * np.where(z > 0, rise, 0) * (1 - 0.12 * aft**2)


@pytest.mark.parametrize("of", [_vessel, _round, _fine, _wigley])
def test_networks_are_no_farther_from_the_hull_than_their_data(of):
    x, z = np.meshgrid(np.linspace(0, 60, 11), np.linspace(0, 6, 8), indexing="ij")
    at = np.arange(x.size).reshape(x.shape)
    curves = [*at.tolist(), *at.T.tolist()]
    exact = of(x, z)
    draws = 40 if os.environ.get("MOLDLOFT_SOAK") else 3
    for tol in (0.01, 0.03, 0.1):
        near, noisy = 0.0, 0.0
        for seed in range(draws):
            y = exact + np.random.default_rng(seed).uniform(-tol, tol, x.shape)
            points = np.stack([x, y, z], -1).reshape(-1, 3)
            made = network(points, curves, tol, motion=(0, 1, 0))
            off = made.points[:, 1].reshape(x.shape) - exact
            near += (off**2).mean()
            noisy += ((y - exact) ** 2).mean()
        assert near <= noisy, (tol, np.sqrt(near / noisy))


def crossed(seed):
    """Stations with two more points at some tolerances from a waterline, and their buttocks."""
    rng = np.random.default_rng(seed)
    stations, lists, points = np.linspace(0, 12, 8), [], []
    for x in stations:
        z = np.linspace(0, 2, 7)
        near = z[[2, 5]] + NOISE * np.array([1, -1]) * rng.uniform(0.5, 6, 2)
        z = np.r_[z, near]
        y = (1 - 0.6 * (x / 6 - 1) ** 2) * np.sqrt(0.2 + z) + rng.uniform(-NOISE, NOISE, 9)
        lists.append((len(points) + np.argsort(z)).tolist())
        points += [(x, b, c) for b, c in zip(y, z, strict=True)]
    lines = np.arange(len(points)).reshape(8, 9).T.tolist()
    names = [f"station {k}" for k in range(8)] + [f"line {k}" for k in range(9)]
    return np.array(points), [*lists, *lines], names


@pytest.mark.parametrize("seed", range(40 if os.environ.get("MOLDLOFT_SOAK") else 2))
def test_curves_beyond_are_named(seed):
    points, curves, names = crossed(seed)
    for bound, most in (("points", 1.5), ("curve", 1.0)):
        made = network(
            points, curves, NOISE, names=names, motion=(0, 1, 0), goal="fairest", bound=bound
        )
        t = np.linspace(0, 1, 2001)
        named = {n for n in names for note in made.notes if note.startswith(f"{n}: between")}
        for name, before, after in zip(names, made.originals, made.curves, strict=True):
            far = np.linalg.norm(after(t) - before(t), axis=1).max()
            assert far <= most * NOISE * (1 + 1e-6) or name in named
        assert bound == "points" or not named


def test_curves_that_swing_are_named():
    points, curves, names = crossed(1)
    made = network(
        points,
        curves,
        NOISE,
        names=names,
        motion=(0, 1, 0),
        mode="sweeps",
        measure="jumps",
    )
    far = {
        name: np.linalg.norm(after.control_points - before.control_points, axis=1).max()
        for name, before, after in zip(names, made.originals, made.curves, strict=True)
    }
    named = {name for name in names for note in made.notes if note.startswith(f"{name}: between")}
    assert all(far[name] > 1.5 * NOISE for name in named)
    assert bool(named) == (made.deviation_curves_certified > 1.5 * NOISE)
