"""Intersections of bodies of several faces, beside plane geometry of their faces."""

from __future__ import annotations

import itertools
import os

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

# The corners of the faces of a box, around each face.
AROUND = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def frame(rng: np.random.Generator) -> np.ndarray:
    axes: np.ndarray = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return axes


def corners(rng: np.random.Generator, size: tuple[float, float]) -> np.ndarray:
    """The corners of a random box about a point near the origin."""
    half = rng.uniform(*size, 3)
    signs = np.array(list(itertools.product((-1, 1), repeat=3)))
    box: np.ndarray = rng.uniform(-0.3, 0.3, 3) + (signs * half) @ frame(rng)
    return box


def stated(name: str, box: np.ndarray, rng: np.random.Generator) -> str:
    """A box as six ruled surfaces in a random order, some of them reversed."""
    rows = [
        f"AbsPoint {name}{k}({', '.join(repr(float(x)) for x in corner)});"
        for k, corner in enumerate(box)
    ]
    for face in rng.permutation(6):
        a, b, c, d = np.roll(AROUND[face], rng.integers(4))[:: rng.choice((-1, 1))]
        sides = (
            f"Line {name}l{face}({name}{a}, {name}{b}); Line {name}m{face}({name}{d}, {name}{c});"
        )
        rows.append(f"{sides} RuledSurf {name}f{face}({name}l{face}, {name}m{face}, visible = 0);")
    return "\n".join(rows)


def listed(name: str, rng: np.random.Generator) -> str:
    return "{" + ", ".join(f"{name}f{k}" for k in rng.permutation(6)) + "}"


def segment(p: np.ndarray, q: np.ndarray) -> np.ndarray | None:
    """The segment in which two convex plane faces meet."""
    low, high = -np.inf, np.inf
    normals = [np.cross(f[1] - f[0], f[2] - f[0]) for f in (p, q)]
    along = np.cross(*normals)
    along /= np.linalg.norm(along)
    rows = np.array([*normals, along])
    start = np.linalg.solve(rows, [normals[0] @ p[0], normals[1] @ q[0], 0])
    for face, normal in zip((p, q), normals, strict=True):
        for a, b in zip(face, np.roll(face, -1, axis=0), strict=True):
            inward = np.cross(normal, b - a)
            rate, value = inward @ along, inward @ (start - a)
            if rate > 0:
                low = max(low, -value / rate)
            else:
                high = min(high, -value / rate)
    return np.array([start + low * along, start + high * along]) if high > low else None


def curves(first: np.ndarray, second: np.ndarray) -> list[list[np.ndarray]]:
    """The segments of the faces, connected ones together."""
    faces = [[box[list(around)] for around in AROUND] for box in (first, second)]
    found = [s for p in faces[0] for q in faces[1] if (s := segment(p, q)) is not None]
    groups: list[list[np.ndarray]] = []
    for piece in found:
        meets = [
            group
            for group in groups
            if min(np.linalg.norm(a - b) for s in group for a in s for b in piece) < 1e-9
        ]
        groups = [g for g in groups if not any(g is m for m in meets)]
        groups.append([piece, *(s for m in meets for s in m)])
    return groups


@pytest.mark.parametrize("seed", range(1000 if SOAK else 30))
def test_two_boxes_meet_in_closed_curves(seed: int) -> None:
    rng = np.random.default_rng(seed)
    boxes = corners(rng, (0.5, 1.2)), corners(rng, (0.3, 1.2))
    wanted = curves(*boxes)
    if not wanted:
        return
    chosen = wanted[rng.integers(len(wanted))]
    near = ", ".join(repr(float(x)) for x in chosen[0].mean(axis=0))
    text = "\n".join(
        [
            *(stated(name, box, rng) for name, box in zip("ab", boxes, strict=True)),
            f"BodyIntersection x({listed('a', rng)}, {listed('b', rng)}, near = {{{near}}});",
        ]
    )
    model = moldloft.loads(text)
    curve = model["x"]
    length = sum(np.linalg.norm(b - a) for a, b in chosen)
    assert curve.length == pytest.approx(length, rel=1e-12), text
    np.testing.assert_allclose(curve(0.0), curve(1.0), atol=1e-12)
    # The parameter is the fraction of the length, and each point is on both boxes.
    ts = np.sort(rng.random(40))
    points = curve(ts)
    assert np.linalg.norm(np.diff(points, axis=0), axis=1) @ np.ones(39) <= length * (1 + 1e-12)
    np.testing.assert_allclose(
        np.linalg.norm(curve.derivative(ts), axis=1), length, rtol=1e-9, err_msg=text
    )
    ends = np.array(chosen)
    for point in points:
        arms = point - ends[:, 0], ends[:, 1] - ends[:, 0]
        share = np.clip((arms[0] * arms[1]).sum(1) / (arms[1] ** 2).sum(1), 0, 1)
        away = np.linalg.norm(arms[0] - share[:, None] * arms[1], axis=1)
        assert away.min() < 1e-12, text
    # The parts on the faces of each box make up the whole.
    for name in "ab":
        covered = 0.0
        for k in range(6):
            try:
                part = moldloft.loads(f"{text}\nIntSnake s({name}f{k}, x);")["s"]
            except moldloft.ModelError as error:
                kinds = {fault.id for fault in error.diagnostics}
                assert kinds <= {"wrong-surface", "several-parts"}, text
                if "several-parts" in kinds:
                    covered = np.nan
                continue
            covered += part.length
        assert np.isnan(covered) or covered == pytest.approx(length, rel=1e-12), text


# A strut of four faces through a plate of two, which meet in a knuckle.
STRUT = """
param float a = 0 in [-0.25, 0.25]; param float k = 0.3 in [-0.5, 0.5];
AbsPoint A(-2, -2, k); AbsPoint B(-2, 0, 0); AbsPoint C(-2, 2, k);
AbsPoint D(2, -2, k); AbsPoint E(2, 0, 0); AbsPoint F(2, 2, k);
Line ad(A, D); Line be(B, E); Line cf(C, F);
RuledSurf left(ad, be, visible = 0); RuledSurf right(be, cf, visible = 0);
{rows}
BodyIntersection x({{f0, f1, f2, f3}}, {{left, right}});
IntSnake hole1(left, x); IntSnake hole2(right, x);
{patches}
"""


@pytest.mark.parametrize("seed", range(200 if SOAK else 8))
def test_patches_on_both_sides_share_the_vertices(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0.1, np.pi / 2 - 0.1)
    rows, patches = [], []
    for k in range(4):
        wide, angle = rng.uniform(0.5, 1), turn + k * np.pi / 2
        x, y = float(wide * np.cos(angle)), float(wide * np.sin(angle))
        rows += [
            f"AbsPoint L{k}({x!r} + a, {y!r} + 0.3*a, -2);",
            f"AbsPoint H{k}({x!r}, {y!r}, 2); Line e{k}(L{k}, H{k});",
        ]
        patches += [f"IntSnake x{k}(f{k}, x); EdgeSnake top{k}(2, f{k});"]
        patches += [f"SubSurf tube{k}({{x{k}, top{k}}}, divisions = {{6, 4}});"]
    rows += [f"RuledSurf f{k}(e{k}, e{(k + 1) % 4}, visible = 0);" for k in range(4)]
    text = STRUT.format(rows="\n".join(rows), patches="\n".join(patches))
    model = moldloft.loads(text)
    counts = set()
    for _ in range(20 if SOAK else 4):
        assert not model.junctions(), text
        mesh = model.mesh()
        counts.add(len(mesh.vertices))
        ring, plates = model["x"](np.linspace(0, 1, 200)), model.params["k"].value
        np.testing.assert_allclose(ring[:, 2], abs(ring[:, 1]) / 2 * plates, atol=1e-12)
        ends = [model[f"x{k}"](np.array([0.0, 1.0])) for k in range(4)]
        for k in range(4):
            gap = np.linalg.norm(ends[k][:, None] - ends[(k + 1) % 4][None], axis=2).min()
            assert gap < 1e-13, text
        model.set({"a": float(rng.uniform(-0.25, 0.25)), "k": float(rng.uniform(-0.5, 0.5))})
    assert len(counts) == 1, text


def test_the_length_has_derivatives() -> None:
    text = STRUT.format(
        rows="\n".join(
            f"AbsPoint L{k}({x} + a, {y}, -2); AbsPoint H{k}({x}, {y}, 2); Line e{k}(L{k}, H{k});"
            for k, (x, y) in enumerate([(-0.5, -0.6), (0.7, -0.5), (0.5, 0.6), (-0.6, 0.4)])
        )
        + "".join(f"RuledSurf f{k}(e{k}, e{(k + 1) % 4}, visible = 0);" for k in range(4)),
        patches="",
    )
    model = moldloft.loads(text)
    for name in ("a", "k"):
        at, step = model.params[name].value, 1e-5
        lengths = []
        for value in (at - step, at + step):
            model.set({name: value})
            lengths.append(model["x"].length)
        model.set({name: at})
        slope = model.derivative("x.length", name)
        assert slope == pytest.approx((lengths[1] - lengths[0]) / (2 * step), abs=1e-8)


def test_bodies_that_do_not_meet_are_named() -> None:
    rng = np.random.default_rng(1)
    first = corners(rng, (0.3, 0.4))
    text = "\n".join((stated("a", first, rng), stated("b", first + 5, rng)))
    with pytest.raises(moldloft.ModelError, match="no-intersection"):
        moldloft.loads(f"{text}\nBodyIntersection x({listed('a', rng)}, {listed('b', rng)});")
    # A body with itself.
    with pytest.raises(moldloft.ModelError) as refused:
        moldloft.loads(f"{text}\nBodyIntersection x({listed('a', rng)}, {listed('a', rng)});")
    assert {fault.id for fault in refused.value.diagnostics} <= {
        "search-unfinished",
        "tangent-contact",
    }


def test_of_several_parts_on_a_face_a_magnet_selects_one() -> None:
    """Two corners of a wedge reach through one plate: the curve returns to the plate's faces."""
    rows = ["AbsPoint O(0, 0, 0);"]
    # A gutter of three faces across a plate of two that meet at y = 0.
    places = [(-1.5, 1.0), (-0.5, -1.0), (0.5, -1.0), (1.5, 1.0)]
    rows += [f"Line e{k}({{-2, {y}, {z}}}, {{2, {y}, {z}}});" for k, (y, z) in enumerate(places)]
    rows += [f"RuledSurf g{k}(e{k}, e{k + 1}, visible = 0);" for k in range(3)]
    rows += [
        "Line l({-1, -3, 0.5}, {-1, 3, 0.5}); Line m({1, -3, 0.5}, {1, 3, 0.5});",
        "Line n({-1, -3, -3}, {-1, 3, -3}); Line o({1, -3, -3}, {1, 3, -3});",
        "RuledSurf lid(l, m, visible = 0); RuledSurf s1(l, n, visible = 0);",
        "RuledSurf s2(m, o, visible = 0);",
        "BodyIntersection x({g0, g1, g2}, {lid, s1, s2}, near = {0, 1.25, 0.5});",
    ]
    text = "\n".join(rows)
    with pytest.raises(moldloft.ModelError, match="several-parts"):
        moldloft.loads(f"{text}\nIntSnake s(lid, x);")
    model = moldloft.loads(
        f"{text}\nAbsMagnet p(lid, 0.7, 0.5); AbsMagnet q(lid, 0.3, 0.5); IntSnake s(p, x);"
        "IntSnake t(q, x);"
    )
    assert abs(model["s"](0.5)[1]) == pytest.approx(1.25)
    assert model["s"](0.5)[1] == pytest.approx(-model["t"](0.5)[1])


@pytest.mark.parametrize("seed", range(400 if SOAK else 12))
def test_round_bodies_in_parts_meet_in_the_whole_curve(seed: int) -> None:
    """A cylinder in strips through a ball in gores, pieces of any length, beside quadrature."""
    rng = np.random.default_rng(seed)
    axes = frame(rng)
    r, off = rng.uniform(0.2, 0.6), rng.uniform(0, 0.35)

    def at(*place: float) -> str:
        return "{" + ", ".join(repr(float(x)) for x in np.array(place) @ axes) + "}"

    def turned(name: str, of: str, count: int) -> str:
        cuts = np.cumsum(rng.uniform(0.05, 1, count + 1))
        cuts = cuts[0] + (cuts - cuts[0]) / (cuts[-1] - cuts[0]) * 2 * np.pi
        return "".join(
            f"RevSurf {name}{k}({of}, {float(cuts[k])!r}, {float(cuts[k + 1])!r}, visible = 0);\n"
            for k in range(count)
        )

    strips, gores = int(rng.integers(2, 5)), int(rng.integers(2, 4))
    top = np.sqrt(1 - (off + r * np.cos(1)) ** 2 - (r * np.sin(1)) ** 2)
    near = at(off + r * np.cos(1), r * np.sin(1), top)
    lists = [
        ", ".join(f"{name}{k}" for k in rng.permutation(count))
        for name, count in (("c", strips), ("s", gores))
    ]
    text = (
        f"Line ax({at(off, 0, -2)}, {at(off, 0, 2)});\n"
        f"Line rule({at(off + r, 0, -2)}, {at(off + r, 0, 2)});\n"
        f"Line poles({at(0, -1, 0)}, {at(0, 1, 0)});\n"
        f"Arc meridian({at(0, -1, 0)}, {at(0, 0, 1)}, {at(0, 1, 0)});\n"
        + turned("c", "rule, ax", strips)
        + turned("s", "meridian, poles", gores)
        + f"BodyIntersection x({{{lists[0]}}}, {{{lists[1]}}}, near = {near});\n"
    )
    turns, weights = np.polynomial.legendre.leggauss(400)
    t = np.pi * (turns + 1)
    x, y = off + r * np.cos(t), r * np.sin(t)
    rise = off * r * np.sin(t) / np.sqrt(1 - x**2 - y**2)
    curve = moldloft.loads(text)["x"]
    assert curve.length == pytest.approx(np.pi * weights @ np.hypot(r, rise), rel=1e-9), text
    np.testing.assert_allclose(curve(0.0), curve(1.0), atol=1e-11)
