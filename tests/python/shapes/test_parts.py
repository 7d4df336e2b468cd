"""Parts of surfaces across the joints and knuckles of the whole: measures, derivatives, panels."""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

# Two planes that meet in a ridge, and a part of them whose sides run askew over it.
ROOF = """
param float low = 0.75 in [0.6, 0.95];
param float ridge = 1 in [0.8, 1.2];
AbsPoint A(0, 0, 0); AbsPoint B(1, 0, ridge); AbsPoint C(2, 0, 0);
Line l(A, B); Line r(B, C); PolyCurve p({l, r});
AbsPoint O(0, 0, 0); AbsPoint Y(0, 4, 0); Line path(O, Y); TranSurf roof(p, path, visible = 0);
AbsMagnet a(roof, 0, 0); AbsMagnet b(roof, low, 0);
AbsMagnet c(roof, 1, 1); AbsMagnet d(roof, 0.25, 1);
LineSnake s1(a, b); LineSnake s2(b, c); LineSnake s3(d, c); LineSnake s4(a, d);
SubSurf part({s1, s2, s3, s4}, divisions = {8, 8});
"""

# A round nose on a cylinder, tangent to each other, cut off behind the joint along a curve.
NOSE = """
param float far = 0.9 in [0.8, 0.98];
AbsPoint T(-1, 0, 0); AbsPoint C(0, 0, 1); AbsPoint E(4, 0, 1); AbsPoint X(4, 0, 0);
AbsPoint M(-sqrt(0.5), 0, sqrt(0.5)); Arc nose(T, M, C); Line wall(C, E);
PolyCurve profile({nose, wall}); Line axis(T, X); RevSurf bulb(profile, axis, 0, 2*PI, visible = 0);
EdgeSnake pole(4, bulb);
AbsMagnet a(bulb, far, 0); AbsMagnet b(bulb, 0.55, 0.5); AbsMagnet c(bulb, far, 1);
BSnake cut({a, b, c}, degree = 2);
SubSurf skin({pole, cut});
"""

# A hard-chine hull over poly-lines and its wetted part; the chine leaves the water forward.
CHINE = """
Model info(symmetry = "y", units = "m");
AbsPoint S1(0, 0, 1.5); AbsPoint S2(0.4, 0, 0.6); AbsPoint S3(1, 0, -0.4);
AbsPoint M1(5, 1.6, 1.2); AbsPoint M2(5, 1.4, 0.1); AbsPoint M3(5, 0, -0.6);
AbsPoint T1(10, 1.5, 1); AbsPoint T2(10, 1.3, -0.25); AbsPoint T3(10, 0, -0.5);
Line a1(S1, S2); Line a2(S2, S3); PolyCurve a({a1, a2});
Line b1(M1, M2); Line b2(M2, M3); PolyCurve b({b1, b2});
Line c1(T1, T2); Line c2(T2, T3); PolyCurve c({c1, c2});
CLoftSurf hull({a, b, c}, visible = 0);
EdgeSnake stem(1, hull); EdgeSnake centre(2, hull); EdgeSnake tran(3, hull);
XYZRing bow(stem, "z", 0); AbsRing toe(stem, 1); XYZRing stern(tran, "z", 0); AbsRing heel(tran, 1);
IntSnake waterline(hull, "z=0", bow, stern);
SubSnake cutwater(bow, toe); SubSnake aft(stern, heel);
SubSurf wetted({waterline, aft, centre, cutwater}, divisions = {40, 10});
"""

# The lower half of a cylinder of length 2 with flat ends.
DRUM = """
param float r = 1;
AbsPoint A(0, -r, 0); AbsPoint B(0, 0, -r); AbsPoint C(0, r, 0); Arc rim(A, B, C);
AbsPoint O(0, 0, 0); AbsPoint X(4, 0, 0); Line path(O, X); TranSurf shell(rim, path);
Line top(A, C); RuledSurf bow(rim, top); CopyCurve rim2(rim, O, X); CopyCurve top2(top, O, X);
RuledSurf stern(rim2, top2);
"""


def test_a_part_across_a_ridge_has_the_area_of_both_sides() -> None:
    m = moldloft.loads(ROOF)
    # Without the stretch the part is a trapezoid: half the sum of its sides, over 4.
    for low in (0.75, 0.9, 0.6):
        m["low"] = low
        assert m.eval("part.area") == pytest.approx(math.sqrt(2) * 4 * (low + 0.75), rel=1e-12)
        assert m.derivative("part.area", "low") == pytest.approx(4 * math.sqrt(2), rel=1e-9)
        # By the height of the ridge: along both planes alike.
        slope = 4 * (low + 0.75) / math.sqrt(2)
        assert m.derivative("part.area", "ridge") == pytest.approx(slope, rel=1e-9)
    for copy in (
        'MirrSurf other(part, "x=0");',
        "RotatSurf other(part, path, 1);",
        "CopySurf other(part, O, Y, 1, 1, 1);",
        "OffsetSurf other(part, 0);",
        "SubSurf other({part.v0, part.u1, part.v1, part.u0});",
    ):
        other = moldloft.loads(ROOF + copy)
        assert other.eval("other.area") == pytest.approx(6 * math.sqrt(2), rel=1e-10), copy


def boundary(faces: np.ndarray) -> Counter[tuple[int, int]]:
    """The number of faces at each edge; a triangle repeats a corner."""
    count: Counter[tuple[int, int]] = Counter()
    for face in faces.tolist():
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            if a != b:
                count[min(a, b), max(a, b)] += 1
    return count


def test_a_ridge_across_a_part_is_a_row_of_its_panels() -> None:
    m = moldloft.loads(ROOF)
    faces = m.mesh().faces.copy()
    for low in (0.75, 0.9, 0.6):
        m["low"] = low
        # Panels within two planes have their area.
        assert m.eval("mesh.area") == pytest.approx(math.sqrt(2) * 4 * (low + 0.75), rel=1e-12)
        assert m.derivative("mesh.area", "low") == pytest.approx(4 * math.sqrt(2), rel=1e-8)
        slope = 4 * (low + 0.75) / math.sqrt(2)
        assert m.derivative("mesh.area", "ridge") == pytest.approx(slope, rel=1e-8)
        assert np.array_equal(m.mesh().faces, faces)
        assert not [d for d in m.diagnostics if d.id == "knuckle-across-panels"]
    for copy in (
        'MirrSurf other(part, "x=0"); ',
        "CopySurf other(part, O, Y, 1, 1, 1); ",
        "SubSurf other({part.v0, part.u1, part.v1, part.u0}, divisions = {8, 8}); ",
    ):
        other = moldloft.loads(ROOF.replace("part({", "part({") + copy)
        assert other.eval("mesh.area") == pytest.approx(12 * math.sqrt(2), rel=1e-10), copy


def test_a_neighbour_has_the_vertices_of_a_ridge() -> None:
    text = (
        ROOF.replace("divisions = {8, 8}", "divisions = {6, 5}")
        + """
    AbsMagnet e(roof, 1, 0); LineSnake s5(b, e); LineSnake s6(e, c);
    SubSurf rest({s5, s6, s2}, divisions = {0, 4});
    AbsMagnet f(roof, 0, 1); LineSnake s7(a, f); LineSnake s8(f, d); SubSurf west({s7, s8, s4});
    """
    )
    m = moldloft.loads(text)
    for low in (0.75, 0.95, 0.6):
        m["low"] = low
        mesh = m.mesh()
        assert m.eval("mesh.area") == pytest.approx(8 * math.sqrt(2), rel=1e-10)
        edges = boundary(mesh.faces)
        assert set(edges.values()) == {1, 2}
        # Open edges are on the border of the roof.
        x, y, _ = mesh.vertices.T
        outer = (np.abs(x * (2 - x)) < 1e-9, np.abs(y) < 1e-9, np.abs(y - 4) < 1e-9)
        for (p, q), count in edges.items():
            assert (count == 1) == any(side[p] and side[q] for side in outer)


def test_a_chine_that_is_dry_forward_is_a_row_of_the_panels() -> None:
    m = moldloft.loads(CHINE)
    exact = m.eval("wetted.area")
    off = []
    for count in ((40, 10), (80, 20), (160, 40)):
        fine = moldloft.loads(CHINE.replace("{40, 10}", f"{{{count[0]}, {count[1]}}}"))
        off.append(abs(fine.eval("mesh.area") / exact - 1))
        assert not [d for d in fine.diagnostics if d.id == "knuckle-across-panels"]
        # Vertices on the chine, where the water does not reach forward.
        u = np.linspace(0, 1, 4001)
        chine = np.array([fine["hull"](0.5, x) for x in u])
        places = fine.mesh().vertices
        near = np.array([np.min(np.linalg.norm(chine - p, axis=1)) for p in places])
        assert np.sum(near < 5e-3) > 3 * count[1] // 2
    # Panels of a smooth surface are of second order.
    assert off[0] < 2e-3 and off[2] < 1.5e-4 and off[2] < off[0] / 8
    # Slopes of the panels and of the surface, whose chine moves.
    for at in ("M2.y", "M2.z", "T2.z"):
        slopes = [m.derivative(f"{what}.area", at) for what in ("mesh", "wetted")]
        assert slopes[0] == pytest.approx(slopes[1], rel=2e-2, abs=1e-2), at


def test_a_knuckle_that_is_no_row_is_named_with_both_areas() -> None:
    corner = ROOF.replace("low = 0.75 in [0.6, 0.95]", "low = 0.5")
    # Into a side and out of it again.
    bay = (
        ROOF.replace("roof, low, 0", "roof, 0.4, 0")
        .replace("c(roof, 1, 1)", "c(roof, 0.4, 1)")
        .replace("d(roof, 0.25, 1)", "d(roof, 0, 1)")
        .replace(
            "LineSnake s2(b, c)", "AbsMagnet e(roof, 0.8, 0.5); BSnake s2({b, e, c}, degree = 2)"
        )
    )
    for text in (corner, bay):
        m = moldloft.loads(text)
        panels = m.eval("mesh.area")
        (warning,) = (d for d in m.diagnostics if d.id == "knuckle-across-panels")
        assert warning.object == "part" and not warning.is_error
        found = re.search(
            r"area of the panels is (\S+), that of the surface (\S+)$", warning.message
        )
        assert found is not None
        assert float(found[1]) == pytest.approx(panels, rel=1e-8)
        assert float(found[2]) == pytest.approx(m.eval("part.area"), rel=1e-8)
    # Two parts that meet at the ridge keep it.
    halves = (
        ROOF.replace("SubSurf part({s1, s2, s3, s4}, divisions = {8, 8});", "")
        + """
    UVSnake top(roof, "u", 0.5); IntRing e(s1, top); IntRing f(s3, top);
    AbsMagnet g(roof, 0.5, 0); AbsMagnet h(roof, 0.5, 1); LineSnake crest(g, h);
    LineSnake q1(a, g); LineSnake q3(d, h); SubSurf port({q1, crest, q3, s4}, divisions = {4, 8});
    """
    )
    m = moldloft.loads(halves)
    m.mesh()
    assert not [d for d in m.diagnostics if d.id == "knuckle-across-panels"]


def below(polygon: np.ndarray, at: float, sign: float = 1) -> np.ndarray:
    """The part of a polygon with sign * u <= at (Sutherland and Hodgman 1974)."""
    kept = []
    for p, q in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        a, b = sign * p[0] - at, sign * q[0] - at
        if a <= 0:
            kept.append(p)
        if a * b < 0:
            kept.append(p + (q - p) * a / (a - b))
    return np.array(kept).reshape(-1, 2)


def shoelace(polygon: np.ndarray) -> float:
    u, v = polygon.T
    return float(abs(np.dot(u, np.roll(v, -1)) - np.dot(v, np.roll(u, -1)))) / 2


def folded(rng: np.random.Generator) -> tuple[str, Callable[[np.ndarray], float]]:
    """A strip of planes over a random poly-line, and the area of a polygon of its parameters."""
    count = int(rng.integers(2, 5))
    z = rng.uniform(-0.6, 0.6, count + 1)
    places = np.column_stack([np.arange(count + 1.0), np.zeros(count + 1), z])
    text = [
        f"AbsPoint P{k}({float(x)!r}, {float(y)!r}, {float(w)!r});"
        for k, (x, y, w) in enumerate(places)
    ]
    text += [f"Line L{k}(P{k}, P{k + 1});" for k in range(count)]
    lines = ", ".join(f"L{k}" for k in range(count))
    text += [
        f"PolyCurve p({{{lines}}});",
        "AbsPoint O(0, 0, 0); AbsPoint Y(0.2, 3, 0.1);",
        "Line path(O, Y); TranSurf base(p, path, visible = 0);",
    ]

    def area(polygon: np.ndarray) -> float:
        total = 0.0
        for k in range(count):
            side = np.cross((places[k + 1] - places[k]) * count, [0.2, 3, 0.1])
            strip = below(below(polygon, (k + 1) / count), -k / count, -1)
            total += float(np.linalg.norm(side)) * shoelace(strip)
        return total

    return "\n".join(text), area


@pytest.mark.parametrize("seed", range(200 if SOAK else 12))
def test_random_parts_across_random_breaks(seed: int) -> None:
    """Area of a quadrangle, its panels and their slopes, by the areas of polygons in the planes."""
    rng = np.random.default_rng([42, seed])
    base, area = folded(rng)
    corners = np.array([[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]])
    corners += rng.uniform(-0.3, 0.3, (4, 2)) * [1, 0.3]
    corners = corners.clip(0.02, 0.98)
    u, v = (float(x) for x in corners[0])
    text = f"{base}\nparam float s = 0; AbsMagnet a(base, {u!r} + s, {v!r});"
    for name, (u, v) in zip("bcd", corners[1:], strict=True):
        text += f"AbsMagnet {name}(base, {float(u)!r}, {float(v)!r});"
    nu, nv = (int(x) for x in rng.integers(8, 20, 2))
    text += (
        "LineSnake s1(a, b); LineSnake s2(b, c); LineSnake s3(d, c); LineSnake s4(a, d);"
        f"SubSurf part({{s1, s2, s3, s4}}, divisions = {{{nu}, {nv}}});"
    )
    m = moldloft.loads(text)
    exact = area(corners)
    step = np.array([[1e-5, 0], [0, 0], [0, 0], [0, 0]])
    slope = (area(corners + step) - area(corners - step)) / 2e-5
    assert m.eval("part.area") == pytest.approx(exact, rel=1e-9)
    assert m.derivative("part.area", "s") == pytest.approx(slope, rel=1e-8)
    panels = m.eval("mesh.area")
    warnings = [d for d in m.diagnostics if d.id == "knuckle-across-panels"]
    if warnings:
        assert f"that of the surface {exact:.6f}"[:-1] in warnings[0].message
    else:
        assert panels == pytest.approx(exact, rel=1e-9)
        assert m.derivative("mesh.area", "s") == pytest.approx(slope, rel=1e-6)


def test_derivatives_of_hydrostatics_have_bounds_that_hold() -> None:
    """Of a half cylinder in closed form, and of a chine hull between accuracies."""
    drum = moldloft.loads(DRUM)
    for accuracy in (1e-3, 1e-5, 1e-8):
        state = drum.hydrostatics(level=0.0, by=["r"], accuracy=accuracy)
        off = abs(state.derivatives["volume"]["r"] - math.pi * 4)
        assert off <= state.derivative_bounds["volume"]["r"] < 3 * accuracy * 100 * math.pi * 4
    hull = moldloft.loads(
        CHINE + "Line middle({10, 0, 0}, {10, 0, -0.5}); RuledSurf transom(aft, middle);"
    )
    by = ["M2.y", "T2.z", "S2.z"]
    best = hull.hydrostatics(level=0.0, by=by, accuracy=1e-9)
    for accuracy in (1e-3, 1e-5, 1e-7):
        state = hull.hydrostatics(level=0.0, by=by, accuracy=accuracy)
        for figure in ("volume", "wetted_area", "waterplane_area"):
            for name in by:
                off = abs(state.derivatives[figure][name] - best.derivatives[figure][name])
                bound = state.derivative_bounds[figure][name]
                assert off <= bound + best.derivative_bounds[figure][name], (figure, name, accuracy)


def test_a_nose_on_a_cylinder_has_its_area() -> None:
    m = moldloft.loads(NOSE)

    def area(far: float) -> float:
        # The sphere as far as the joint, and the cylinder up to the cut, of length 8 (u - 1/2).
        v = (np.polynomial.legendre.leggauss(40)[0] + 1) / 2
        w = np.polynomial.legendre.leggauss(40)[1] / 2
        t = v
        u = (1 - t) ** 2 * far + 2 * t * (1 - t) * 0.55 + t**2 * far
        around = 2 * (1 - t) * t * 0.5 + t**2
        slope = 2 * (1 - t) * 0.5 + 2 * t * 0.5
        assert np.allclose(around, t)
        return 2 * math.pi + float(np.sum(w * 8 * (u - 0.5) * slope)) * 2 * math.pi

    for far in (0.9, 0.83, 0.96):
        m["far"] = far
        assert m.eval("skin.area") == pytest.approx(area(far), rel=1e-9)
        slope = (area(far + 1e-5) - area(far - 1e-5)) / 2e-5
        assert m.derivative("skin.area", "far") == pytest.approx(slope, rel=1e-8)


PLATE = """
param float at = 4.9 in [4.6, 5.6];
subroutine section(float x, float y) {
    AbsPoint p(x, y, 0); AbsPoint q(x, 0.5*y, 0); AbsPoint r(x, 0, 0);
    BCurve c({p, q, r}, degree = 2);
}
section m1(0, 0.4); section m2(3.2, 1.3); section m3(6.5, 1.9); section m4(10, 1.7);
section m5(12, 1.2);
CLoftSurf hull({m1.c, m2.c, m3.c, m4.c, m5.c}, visible = 0);
EdgeSnake centre(2, hull);
AbsRing c0(centre, 0); AbsRing c1(centre, 1);
float chord = 1.15;
AbsPoint n(at, 0, -1); AbsPoint cr(at + 0.3*chord, 0.06*chord, -1); AbsPoint ta(at + chord, 0, -1);
FoilCurve plan({n, cr, ta}, "64", visible = 0);
AbsRing gf(centre, 0.4);
XYZRing lead(gf, "x", at); XYZRing trail(gf, "x", at + chord);
ProjSnake root(plan, lead, "z=0", ends = {lead, trail});
SubSnake v1(c0, lead); SubSnake v2(trail, c1);
PolySnake ventral({v1, root, v2}, breaks = {0.4, 0.55});
SubSurf skin({hull.u0, hull.v1, ventral, hull.v0}, divisions = {60, 14});
"""


def test_a_part_round_a_projected_foil_misses_the_area_of_the_foil() -> None:
    m = moldloft.loads(PLATE)
    for at in (4.65, 4.9, 5.2, 5.55):
        m["at"] = at
        p = m["root"](np.linspace(0, 1, 40_001))
        foil = float(np.trapezoid(p[:, 1], p[:, 0]))
        assert m.eval("skin.area") + foil == pytest.approx(m.eval("hull.area"), abs=1e-8)


@pytest.mark.parametrize(("low", "high"), [(5, 4), (3, 8), (1, 1), (6, 6)])
def test_sectors_of_a_pole_have_divisions_of_their_own(low: int, high: int) -> None:
    """Two parts that meet along a line from the pole, which is one vertex."""
    text = f"""
    AbsPoint A(0, 0, 0); AbsPoint B(4, 2, 0.5); AbsPoint C(4, -2, 0.3); AbsPoint D(4, 0, -1);
    Line z(A, A); BCurve l({{B, D, C}}, 2); RuledSurf bottom(z, l, visible = 0);
    AbsMagnet p0(bottom, 0, 0); AbsMagnet pm(bottom, 0.5, 0); AbsMagnet p1(bottom, 1, 0);
    AbsMagnet e0(bottom, 0, 1); AbsMagnet em(bottom, 0.5, 1); AbsMagnet e1(bottom, 1, 1);
    LineSnake tip0(p0, pm); LineSnake tip1(pm, p1); LineSnake side0(p0, e0);
    LineSnake middle(pm, em); LineSnake side1(p1, e1); LineSnake end0(e0, em);
    LineSnake end1(em, e1);
    SubSurf port({{tip0, middle, end0, side0}}, divisions = {{{low}, 6}});
    SubSurf star({{tip1, side1, end1, middle}}, divisions = {{{high}, 6}});
    """
    model = moldloft.loads(text)
    assert not model.diagnostics
    mesh = model.mesh()
    assert len(mesh.vertices) == 6 * (low + high + 1) + 1
    (rim,) = mesh.summary["open_loops"]
    assert rim["edges"] == low + high + 12 and not model.junctions()
    # Triangles at the pole.
    (pole,) = np.flatnonzero(np.linalg.norm(mesh.vertices, axis=1) == 0)
    at_pole = mesh.faces[(mesh.faces == pole).any(axis=1)]
    assert len(at_pole) == low + high
    assert all(len(set(face)) == 3 for face in at_pole.tolist())
