"""Plane curves as bodies of sets, lists of sets, divisions and mirrors."""

from __future__ import annotations

import math
import os
import re
import warnings

import numpy as np
import pytest
from numpy.typing import NDArray

import moldloft
from moldloft import implicit as im

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
Floats = NDArray[np.float64]


def star(rng: np.random.Generator) -> Floats:
    """A simple polygon round the origin, convex or not."""
    n = int(rng.integers(3, 9))
    angles = np.sort((np.arange(n) + rng.uniform(0, 0.8, n)) * 2 * math.pi / n)
    radii = rng.uniform(0.5, 1.5, n)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def area_and_centre(p: Floats) -> tuple[float, Floats]:
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    area = 0.5 * cross.sum()
    return area, ((p + q) * cross[:, None]).sum(axis=0) / (6 * area)


def frame(rng: np.random.Generator) -> Floats:
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.linalg.det(turn)


def closed(points: Floats) -> str:
    names = [f"P{k}" for k in range(len(points))]
    lines = [
        f"AbsPoint {name}({', '.join(repr(float(x)) for x in p)});"
        for name, p in zip(names, points, strict=True)
    ]
    return "\n".join([*lines, f"BCurve c({{{', '.join([*names, names[0]])}}}, degree = 1);"])


def around(points: Floats) -> tuple[Floats, Floats]:
    low, high = points.min(axis=0), points.max(axis=0)
    return low - 0.021 * (high - low).max(), high + 0.023 * (high - low).max()


def triple(v: Floats) -> str:
    return "{" + ", ".join(repr(float(x)) for x in v) + "}"


@pytest.mark.parametrize("seed", range(60 if SOAK else 2))
def test_prisms_have_the_volume_of_the_shoelace_formula(seed: int) -> None:
    rng = np.random.default_rng([51, seed])
    flat, turn, place = star(rng), frame(rng), rng.uniform(-3, 3, 3)
    by = turn @ np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(0.3, 2)])
    points = np.column_stack([flat, np.zeros(len(flat))]) @ turn.T + place
    # Either way round.
    points = points[::-1] if seed % 2 else points
    box = ", ".join(triple(p) for p in around(np.vstack([points, points + by])))
    text = f"{closed(points)}\nset s = extruded(c, {triple(by)});\nSetBody b(s, {box}, depth = 4);"
    model = moldloft.loads(text)
    area, centre = area_and_centre(flat)
    exact = area * abs(float(by @ turn[:, 2]))
    # Some corners are too near to each other for cells of this depth, which is remarked.
    blunt = any(d.id == "blunt-edges" for d in model.diagnostics)
    assert model.eval("b.volume") == pytest.approx(exact, rel=1e-3 if blunt else 1e-9)
    assert model.eval("volume(s)") == pytest.approx(exact, rel=1e-9)
    middle = turn @ [*centre, 0] + place + 0.5 * by
    assert np.abs(np.array(model.eval("b.centroid")) - middle).max() < (1e-3 if blunt else 1e-8)


def turned_body(seed: int) -> tuple[moldloft.Model, float]:
    """A turned star `s` anywhere in space with its coarse body `b`, and its volume by Pappus."""
    rng = np.random.default_rng([52, seed])
    flat, turn, place = star(rng), frame(rng), rng.uniform(-3, 3, 3)
    flat[:, 0] += 1.6 if seed % 3 else -1.6
    points = np.column_stack([flat, np.zeros(len(flat))]) @ turn.T + place
    axis = f"AbsPoint O({triple(place)[1:-1]});\nAbsPoint U({triple(place + turn[:, 1])[1:-1]});"
    reach = np.array([4.0, 4.0, 4.0])
    box = f"{triple(place - reach)}, {triple(place + 1.02 * reach)}"
    text = f"{closed(points)}\n{axis}\nLine l(O, U);\nset s = revolved(c, l);"
    model = moldloft.loads(f"{text}\nSetBody b(s, {box}, depth = 5);")
    area, centre = area_and_centre(flat)
    return model, 2 * math.pi * abs(float(centre[0])) * area


@pytest.mark.parametrize("seed", range(60 if SOAK else 2))
def test_bodies_of_revolution_have_the_volume_of_pappus(seed: int) -> None:
    model, exact = turned_body(seed)
    # At this depth cells may not tell a corner from its neighbour, which is remarked.
    assert model.eval("b.volume") == pytest.approx(exact, rel=3e-2 if model.diagnostics else 1e-6)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        volume = model.eval("volume(s)")
    assert volume == pytest.approx(exact, rel=1e-3 if said else 1e-9)


def test_corners_of_curved_profiles_are_remarked() -> None:
    points = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0);"
    box = "{-3, -3, -0.1}, {3.3, 3.4, 1.2}, depth = 4"
    half = moldloft.loads(
        f"{points} Arc a(A, C, B); Line l(B, A); PolyCurve c({{a, l}});"
        f"set s = extruded(c, {{0, 0, 1}}); SetBody b(s, {box});"
    )
    assert [d.id for d in half.diagnostics] == ["blunt-edges"]
    assert half.eval("b.volume") == pytest.approx(math.pi / 2, rel=0.02)
    whole = moldloft.loads(
        f"{points} Arc c(A, B, C, type = 6); set s = extruded(c, {{0, 0, 1}}); SetBody b(s, {box});"
    )
    assert not whole.diagnostics


def test_prisms_follow_their_corners() -> None:
    corners = ["0, 0, 0", "2, 0, 0", "2, 1, 0", "1, 0.4, 0", "0, 1, 0"]
    points = " ".join(f"AbsPoint P{k}({at});" for k, at in enumerate(corners))
    model = moldloft.loads(
        f"{points} BCurve c({{P0, P1, P2, P3, P4, P0}}, degree = 1);"
        f"set s = extruded(c, {{0, 0, 3}});"
        "Line l(P0, P4); set t = revolved(c, l);"
    )
    assert model.eval("volume(s)") == pytest.approx(3 * 1.4, rel=1e-12)
    # The shoelace formula: a corner moves the area by half the way between its neighbours.
    for name, slope in (("P3.y", 1.0), ("P2.x", 0.2), ("P2.y", 0.5), ("P0.y", -1.0)):
        assert model.derivative("volume(s)", name) == pytest.approx(3 * slope, rel=1e-9)
    # Pappus: rings of the triangles between the axis and the sides.
    at = np.array([[float(x) for x in c.split(",")] for c in corners])[:, :2]
    area, centre = area_and_centre(at)
    assert model.eval("volume(t)") == pytest.approx(2 * math.pi * centre[0] * area, rel=1e-9)

    def swept(k: int, axis: int, by: float) -> float:
        moved = at.copy()
        moved[k, axis] += by
        area, centre = area_and_centre(moved)
        return float(2 * math.pi * centre[0] * area)

    for name, k, axis in (("P3.y", 3, 1), ("P2.x", 2, 0), ("P3.x", 3, 0)):
        exact = (swept(k, axis, 1e-5) - swept(k, axis, -1e-5)) / 2e-5
        assert model.derivative("volume(t)", name) == pytest.approx(exact, rel=1e-7)


def test_the_distance_of_a_profile_is_that_of_its_polygon() -> None:
    rng = np.random.default_rng(3)
    flat = star(rng)
    model = moldloft.loads(
        f"{closed(np.column_stack([flat, np.zeros(len(flat))]))}\nfield f = profile(c);"
    )
    points = rng.uniform(-2, 2, (2000, 3))
    p, q, at = flat, np.roll(flat, -1, axis=0), points[:, None, :2]
    t = (((at - p) * (q - p)).sum(-1) / ((q - p) ** 2).sum(-1)).clip(0, 1)
    far = np.linalg.norm(at - (p + t[..., None] * (q - p)), axis=-1).min(axis=1)
    (x, y), (b, d) = at[:, 0].T, (p[:, 1], q[:, 1])
    with np.errstate(divide="ignore"):
        cut = p[:, 0] + (y[:, None] - b) / (d - b) * (q[:, 0] - p[:, 0])
    inside = (((b > y[:, None]) != (d > y[:, None])) & (x[:, None] < cut)).sum(axis=1) % 2 == 1
    found = np.asarray(model["f"].value(points))
    assert np.abs(found - np.where(inside, -far, far)).max() < 1e-9


def test_profiles_follow_their_curves() -> None:
    model = moldloft.loads(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0);"
        "BCurve c({A, B, C, A}, degree = 1); field f = profile(c);"
    )
    # The tip is nearest to a point above it, and moves towards it.
    assert model.derivative("f({1, 3, 5})", "C.y") == pytest.approx(-1, abs=1e-9)
    # Half of the change of an end reaches the middle of its side.
    assert model.derivative("f({1, -1, 5})", "A.y") == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("BCurve c({A, B, C}, degree = 1); set s = extruded(c, {0, 0, 1});", "ends are"),
        ("BCurve c({A, B, C, D, A}, degree = 1); set s = extruded(c, {0, 0, 1});", "leaves its"),
        ("BCurve c({A, B, C, A}, degree = 1); set s = extruded(c, {1, 0, 0});", "a height of"),
        (
            "BCurve c({A, B, C, A}, degree = 1); AbsPoint E(1, -5, 0); AbsPoint F(1, 5, 0);"
            "Line l(E, F); set s = revolved(c, l);",
            "off by",
        ),
    ],
)
def test_what_is_no_profile_is_refused(text: str, found: str) -> None:
    points = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0); AbsPoint D(0, 1, 1);"
    with pytest.raises(moldloft.Error, match=found):
        moldloft.loads(points + text)


def test_lists_of_sets() -> None:
    rng = np.random.default_rng(0)
    centres = rng.uniform(0, 4, (40, 3))
    balls = [im.sphere(tuple(p), 0.4) for p in centres]
    points = rng.uniform(-1, 5, (5000, 3))
    far = np.linalg.norm(points[:, None] - centres, axis=-1)
    assert ((im.union(*balls)(points) < 0) == (far < 0.4).any(axis=1)).all()
    large = [im.sphere(tuple(p), 3.0) for p in centres]
    assert ((im.intersection(*large)(points) < 0) == (far < 3.0).all(axis=1)).all()
    assert im.union().is_nothing and im.intersection().is_everything
    model = moldloft.loads(
        "set a = set_union({sphere({0, 0, 0}, 1), cuboid({2, 0, 0}, {3, 1, 1})});"
        "set b = set_intersection({sphere({0, 0, 0}, 1), sphere({1, 0, 0}, 1)});"
    )
    assert model.eval("volume(a)") == pytest.approx(4 / 3 * math.pi + 1, rel=1e-6)
    assert model.eval("volume(b)") == pytest.approx(5 * math.pi / 12, rel=1e-6)


def test_a_division_says_what_is_where() -> None:
    rng = np.random.default_rng(1)
    body = im.union(*(im.sphere(tuple(p), 0.7) for p in rng.uniform(-2, 2, (12, 3))))
    division = im.Division(body - im.cuboid((0, 0, 0), (1, 1, 1)), (-3,) * 3, (3,) * 3, depth=4)
    for point in rng.uniform(-3, 3, (200, 3)):
        box = division.leaf(tuple(point))
        assert (box.low <= point).all() and (point <= box.high).all()
        value = (body - im.cuboid((0, 0, 0), (1, 1, 1)))(point)
        assert box.kind == "surface" or (value < 0) == (box.kind == "solid")
        # The set of the box is the same in the box.
        assert (box.set(point) < 0) == (value < 0)
    volume = sum(float(np.prod(box.high - box.low)) for box in division.boxes)
    assert volume == pytest.approx(216)
    solid = sum(float(np.prod(b.high - b.low)) for b in division.boxes if b.kind == "solid")
    open_ = sum(float(np.prod(b.high - b.low)) for b in division.boxes if b.kind == "surface")
    exact = (body - im.cuboid((0, 0, 0), (1, 1, 1))).mass().volume
    assert solid <= exact <= solid + open_
    drawing = division.section_svg("z", 0.1)
    sizes = re.findall(r'width="([\d.e-]+)" height="([\d.e-]+)" fill', drawing)
    assert sum(float(w) * float(h) for w, h in sizes) == pytest.approx(36)
    with pytest.raises(ValueError, match="outside"):
        division.leaf((9, 0, 0))
    with pytest.raises(ValueError, match="does not intersect"):
        division.section_svg("x", 4.0)


def pixels(png: bytes) -> NDArray[np.uint8]:
    image = pytest.importorskip("PIL.Image")
    import io

    return np.asarray(image.open(io.BytesIO(png)).convert("RGB"))


def test_mirrors_show_what_is_before_them() -> None:
    # A mirror below a red ball, seen from the side: the ball again, upside down.
    ball = im.Set(im.sphere((0, 0, 1), 0.6), name="ball", colour=1)
    floor = im.Set(im.plane((0, 0, 1), (0, 0, 0)), name="floor", colour=7)
    view = {
        "low": (-2, -2, -0.2), "high": (2, 2, 2), "size": (120, 90), "eye": (0, -6, 1.5),
        "centre": (0, 0, 0.5), "background": ((0, 0, 255), (0, 0, 255)),
    }  # fmt: skip
    plain = pixels((ball | floor).picture(**view))
    mirror = pixels((ball | floor).picture(mirrors={"floor": 1.0}, **view))
    changed = (plain != mirror).any(axis=2)
    assert changed.any()
    # Nothing of its own grey is left there: the background by height, and the ball again.
    seen = mirror[changed].astype(int)
    blue = (seen[:, 2] > 200) & (seen[:, 0] < 60)
    assert blue.any() and (~blue).sum() > 20
    own = plain[changed].astype(int)
    grey = np.ptp(own, axis=1) < 40
    assert grey.mean() > 0.5 and (np.ptp(seen[grey], axis=1) >= 40).mean() > 0.5
    # The background is that which was asked.
    assert tuple(plain[0, 0]) == (0, 0, 255)
    with pytest.raises(ValueError, match="unknown primitive"):
        (ball | floor).picture(mirrors={"wall": 0.5}, size=(8, 8), low=(-1,) * 3, high=(1,) * 3)
    with pytest.raises(ValueError, match="expected 0 to 1"):
        ball.picture(mirrors=1.5, size=(8, 8))
    with pytest.raises(ValueError, match="0 to 255"):
        ball.picture(background=((0, 0, 300), (0, 0, 0)), size=(8, 8))


def test_what_is_not_finite_or_empty() -> None:
    ball = im.sphere((0, 0, 0), 1)
    with pytest.raises(moldloft.Error, match="finite"):
        ball * math.inf
    empty = im.Set(ball) & im.sphere((5, 0, 0), 1)
    assert len(empty.facets().triangles) == 0 and empty.mass().volume == 0
