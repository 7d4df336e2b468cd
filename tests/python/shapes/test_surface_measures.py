"""Area and centroid of surfaces within their bounds, beside quadrature and closed forms."""

from __future__ import annotations

import os

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

CONE = """
param float r = {r} in [0.1, 5]; param float h = {h} in [0.1, 5];
Line axis({{0, 0, 0}}, {{0, 0, 1}}); AbsPoint A(r, 0, 0); AbsPoint B(0.5*r, 0, h); Line rule(A, B);
RevSurf cone(rule, axis, 0, 2*PI);
AbsMagnet a(cone, 0.2, 0.1); AbsMagnet b(cone, 0.8, 0.1); AbsMagnet c(cone, 0.5, 0.4);
LineSnake s1(a, b); LineSnake s2(b, c); LineSnake s3(c, a);
TrimSurf part(cone, {{s1, s2, s3}});
"""


def loft(rng: np.random.Generator) -> str:
    """A sheet of random control points with knuckles, and a part of it askew."""
    rows = ["param float k = 0 in [-1, 1];"]
    for i in range(4):
        names = []
        for j in range(4):
            x, y = float(i + rng.uniform(-0.3, 0.3)), float(j + rng.uniform(-0.3, 0.3))
            z = float(rng.uniform(-0.5, 0.5))
            rows.append(f"AbsPoint P{i}{j}({x!r}, {y!r}, {z!r} + {float(rng.normal())!r}*k);")
            names.append(f"P{i}{j}")
        degree = rng.integers(1, 4)
        rows.append(f"BCurve c{i}({{{', '.join(names)}}}, degree = {degree});")
    rows.append(f"BLoftSurf whole({{c0, c1, c2, c3}}, degree = {rng.integers(1, 4)});")
    corners = [(0.1, 0.2), (0.9, 0.1), (0.8, 0.9), (0.2, 0.7)]
    for n, (u, v) in enumerate(corners):
        u, v = u + float(rng.uniform(-0.1, 0.1)), v + float(rng.uniform(-0.1, 0.1))
        rows.append(f"AbsMagnet m{n}(whole, {u!r}, {v!r});")
    rows += ["LineSnake a(m0, m1); LineSnake b(m3, m2); SubSurf part({a, b});"]
    return "\n".join(rows)


def by_points(surface: moldloft.Surface, count: int) -> np.ndarray:
    """Area and centroid by a rule of three points in each of many cells."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    cells = np.arange(count)[:, None] + (nodes + 1) / 2
    t, w = (cells / count).ravel(), np.tile(weights / 2 / count, count)
    u, v = np.meshgrid(t, t, indexing="ij")
    size = np.linalg.norm(
        np.cross(surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1)), axis=-1
    )
    area = size * np.outer(w, w)
    return np.array([area.sum(), *((surface(u, v) * area[..., None]).sum((0, 1)) / area.sum())])


@pytest.mark.parametrize("seed", range(200 if SOAK else 8))
def test_figures_and_derivatives_are_within_their_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    text = loft(rng)
    model = moldloft.loads(text)
    accuracy = float(10 ** rng.uniform(-8, -3))
    names = ("area", "x", "y", "z")
    for name in ("whole", "part"):
        found = model[name].measures(accuracy=accuracy, by=["k"])
        close = model[name].measures(accuracy=1e-10, by=["k"])
        for row in (found, close):
            assert set(row.bounds) == set(row.derivative_bounds) == set(names)
        values, exact = (np.array([row.area, *row.centroid]) for row in (found, close))
        for k, figure in enumerate(names):
            assert abs(values[k] - exact[k]) <= found.bounds[figure] + 1e-12, (text, figure)
            slopes = [row.derivatives[figure]["k"] for row in (found, close)]
            bound = found.derivative_bounds[figure]["k"]
            assert abs(slopes[0] - slopes[1]) <= bound + 1e-9, (text, figure)
            assert bound <= 30 * accuracy * (1 + abs(slopes[1])), (text, figure)
    # Beside another rule, and differences.
    mid = by_points(model["whole"], 42)
    close = model["whole"].measures(accuracy=1e-10, by=["k"])
    np.testing.assert_allclose([close.area, *close.centroid], mid, rtol=1e-5, atol=1e-5)
    step, rows = 1e-4, []
    for k in (-step, step):
        model.set({"k": k})
        row = model["part"].measures(accuracy=1e-10)
        rows.append([row.area, *row.centroid])
    model.set({"k": 0.0})
    slopes = model["part"].measures(accuracy=1e-10, by=["k"]).derivatives
    difference = (np.array(rows[1]) - rows[0]) / (2 * step)
    np.testing.assert_allclose([slopes[n]["k"] for n in names], difference, atol=1e-5)


@pytest.mark.parametrize("seed", range(6))
def test_a_cone_and_its_part_by_their_formulas(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r, h = (float(x) for x in rng.uniform(0.5, 2, 2))
    model = moldloft.loads(CONE.format(r=r, h=h))
    found = model["cone"].measures(by=["r", "h"])
    slant = np.hypot(0.5 * r, h)
    assert abs(found.area - 1.5 * np.pi * r * slant) <= found.bounds["area"]
    slope = 1.5 * np.pi * r * h / slant
    assert abs(found.derivatives["area"]["h"] - slope) <= found.derivative_bounds["area"]["h"]
    # A triangle in the developed cone: the integral of the radius over the triangle of parameters.
    part = model["part"].measures(by=["r"])
    u = (0.2 + 0.8 + 0.5) / 3
    exact = 0.09 * slant * 2 * np.pi * r * (1 - 0.5 * u)
    assert abs(part.area - exact) <= part.bounds["area"]
    assert model["part"].area == pytest.approx(exact, rel=1e-9)
    slope = exact / r + exact / slant**2 * 0.25 * r
    assert abs(part.derivatives["area"]["r"] - slope) <= part.derivative_bounds["area"]["r"]


def test_other_objects_are_refused() -> None:
    model = moldloft.loads("set ball = set(sphere({0, 0, 0}, 1)); SetBody f(ball, depth = 3);")
    with pytest.raises(moldloft.ModelError, match="no measures of a surface"):
        model["f"].measures()
    model = moldloft.loads(CONE.format(r=1, h=1))
    with pytest.raises(moldloft.UnknownNameError):
        model["cone"].measures(by=["q"])
    for accuracy in (0, 1, float("nan")):
        with pytest.raises(moldloft.Error, match="accuracy"):
            model["cone"].measures(accuracy=accuracy)
