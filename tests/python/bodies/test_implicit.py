"""Implicit fields and sets from Python, in models, in files, and with bad input."""

import itertools
import json
import math
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

import moldloft
from moldloft import implicit as im

EXAMPLES = Path(__file__).parents[3] / "examples" / "implicit"


def command(*words: object) -> subprocess.CompletedProcess[str]:
    """The command's outcome."""
    line = [sys.executable, "-m", "moldloft", *map(str, words)]
    return subprocess.run(line, capture_output=True, text=True, check=False)


def tee(lam: float = 0.6) -> im.Set:
    """The T-piece of the svLis manual."""
    x, y, z = im.axes()
    s, u = (x + z) / math.sqrt(2), (x - z) / math.sqrt(2)
    c1, c2 = y**2 + z**2 - 1, u**2 + y**2 - 0.36
    k = u**2 + y**2 - ((s - 4.5 * math.sqrt(2)) * math.tan(math.radians(8.5))) ** 2
    q = lam * c1 * c2 - (1 - lam) * k**2
    top = im.Set(-s) & im.Set(s - 4)
    run = im.Set(c1, name="run") & im.Set(x - 3.5) & im.Set(-x - 3.5)
    fillet = im.Set(q, name="fillet") & im.Set(k)
    return run | im.Set(c2, name="branch") & top | fillet & top


BOX = ((-4, -4, -4), (4, 4, 4))


def test_arithmetic_is_that_of_numpy():
    rng = np.random.default_rng(1)
    p = rng.uniform(-2, 2, (500, 3))
    x, y, z = im.axes()
    a, b, c = p.T
    cases = [
        (x**3 - 2 * y + z / 4, a**3 - 2 * b + c / 4),
        (1 - x, 1 - a),
        (im.sin(x) + im.cos(y) * im.exp(z), np.sin(a) + np.cos(b) * np.exp(c)),
        (abs(x - y), abs(a - b)),
        (im.s_sqrt(x), np.sign(a) * np.sqrt(abs(a))),
        (im.sqrt(x * x + 1), np.sqrt(a * a + 1)),
        (im.minimum(x, im.maximum(y, 0.5)), np.minimum(a, np.maximum(b, 0.5))),
        (im.atan2(x, y), np.arctan2(a, b)),
        (im.sign(x), np.where(a > 0, 1.0, -1.0)),
    ]
    for field, expected in cases:
        assert np.allclose(field(p), expected, rtol=1e-14, atol=1e-14), field
        h = 1e-6
        for k in range(3):
            step = h * np.eye(3)[k]
            slope = (field(p + step) - field(p - step)) / (2 * h)
            smooth = abs(slope) < 1e3
            assert np.allclose(field.gradient(p)[smooth, k], slope[smooth], atol=1e-4), field
        low, high = field.range((-2, -2, -2), (2, 2, 2))
        assert low <= expected.min() and expected.max() <= high
    assert x((1, 2, 3)) == 1.0 and x(np.zeros((2, 5, 3))).shape == (2, 5)
    # Many points are spread over threads: the same bits.
    many = rng.uniform(-2, 2, (50_000, 3))
    assert np.array_equal(cases[2][0](many)[:100], cases[2][0](many[:100]))


def test_second_derivatives_are_exact():
    x, y, z = im.axes()
    field = x**3 * y - im.sin(z) * x
    p = np.array([[0.3, -0.7, 1.1], [2.0, 0.5, -0.4]])
    h = 1e-5
    for k in range(3):
        step = h * np.eye(3)[k]
        slope = (field.gradient(p + step) - field.gradient(p - step)) / (2 * h)
        assert np.allclose(field.hessian(p)[:, k], slope, atol=1e-8)
    assert np.array_equal(im.sphere((0, 0, 0), 1).hessian((1, 2, 3)), 2 * np.eye(3))


def test_forms_are_remembered_and_moved():
    ball = im.sphere((1, 2, 3), 0.5).translated((1, 0, 0)).scaled(2)
    assert ball.form == {"kind": "sphere", "centre": [4.0, 4.0, 6.0], "radius": 1.0}
    ring = im.cyclide((0, 0, 0), (0, 0, 1), (1, 0, 0), 2, 0.5, 0.2)
    assert ring.degree == 4 and ring.form["change"] == 0.2
    roots = [h.t - 5 for h in im.Set(ring).hits((-5, 0, 0), (1, 0, 0), 10)]
    assert np.allclose(roots, [-2.7, -1.3, 1.7, 2.3], atol=1e-12)
    pipe = im.cylinder((0, 0, 0), (0, 0, 1), 1).turned((0, 0, 0), (1, 0, 0), math.pi / 2)
    assert np.allclose(pipe.form["direction"], [0, -1, 0], atol=1e-15)
    assert im.sphere((0, 0, 0), 2, distance=True)((5, 0, 0)) == 3.0
    assert im.sphere((0, 0, 0), 1).same(im.sphere((0, 0, 0), 1))


def test_sets_members_winners_and_attributes():
    a = im.Set(im.sphere((0, 0, 0), 1), name="a", colour=3)
    b = im.Set(im.sphere((1.5, 0, 0), 1), material="brass")
    both = (a | b).with_attributes(name="both", tolerance=1e-3)
    points = [[0, 0, 0], [1, 0, 0], [3, 0, 0]]
    assert both.member(points).tolist() == [-1, -1, 1]
    assert (a - b).member((0.75, 0, 0)) == 1 and (a ^ b).member((0.75, 0, 0)) == 1
    assert (-a).member((0, 0, 0)) == 1 and (~a).member((5, 0, 0)) == -1
    assert a.member((1, 0, 0)) == 0
    assert both.winner([[0, 0, 0], [1.5, 0, 0]]).tolist() == [0, 1]
    # Known to be on a surface, whatever rounding says.
    near = (1 + 1e-6, 0, 0)
    ball = im.sphere((0, 0, 0), 1)
    assert a.member(near) == 1 and a.member(near, known=[ball]) == 0
    assert (a & b).member((0.75, 0.6, 0), known=[ball]) == 0
    first, second = both.leaves
    assert (first.name, first.attributes.colour, first.attributes.tolerance) == ("a", 3, 1e-3)
    assert (second.name, second.attributes.material) == ("both", "brass")
    assert len(both.operands) == 2 and both.operands[0].same(a)
    assert (a & -a).regularized().is_nothing and (a | -a).regularized().is_everything
    assert len(both.pruned((-1, -1, -1), (0, 1, 1)).leaves) == 1


def test_the_golden_t_piece():
    part = tee()
    mass = part.mass(*BOX, depth=6)
    low, high = mass.volume_bracket
    assert low <= mass.volume <= high and abs(mass.volume - 25.097) < 1e-3
    assert (mass.centroid_bracket[:, 0] <= mass.centroid).all()
    assert (mass.centroid <= mass.centroid_bracket[:, 1]).all()
    assert (mass.inertia_bracket[..., 0] <= mass.inertia).all()
    facets = part.facets(*BOX, depth=6)
    assert facets.closed and facets.manifold and facets.components == 1 and facets.euler == 2
    assert facets.crossings() == 0 and facets.worst_vertex() < 1e-11
    assert {p.name for p in facets.patches} >= {"run", "branch", "fillet"}
    body = trimesh.Trimesh(facets.vertices, facets.triangles, process=False)
    assert body.is_watertight and abs(body.volume - facets.volume) < 1e-9


def test_facets_are_taken_over_after_an_edit():
    # A hundred balls; one moves.
    def model(shift: float) -> im.Set:
        out = im.nothing()
        for k in range(100):
            at = (k % 5 * 2.0, k // 5 % 5 * 2.0, k // 25 * 2.0 + (shift if k == 57 else 0))
            out = out | im.Set(im.sphere(at, 0.7))
        return out

    low, high = (-1, -1, -1), (9, 9, 7)
    first = model(0).facets(low, high, depth=6)
    again = model(0.1).facets(low, high, depth=6, before=first)
    fresh = model(0.1).facets(low, high, depth=6)
    assert np.array_equal(again.vertices, fresh.vertices)
    assert np.array_equal(again.triangles, fresh.triangles)
    # The moved ball is in 16 of the blocks at most, before and after.
    assert again.summary["computed"] <= 16 < fresh.summary["computed"] / 10
    same = model(0).facets(low, high, depth=6, before=first)
    assert same.summary["computed"] == 0


def test_accuracy_is_kept():
    ball = im.Set(im.sphere((0, 0, 0), 1))
    for accuracy in (1e-2, 1e-3):
        facets = ball.facets(accuracy=accuracy)
        assert facets.centre_distances().max() <= accuracy


def test_sheets_wires_and_points(tmp_path):
    a, b = im.sphere((0, 0, 0), 1), im.plane((0, 0, 1), (0, 0, 0.5))
    c = im.plane((1, 0, 0), (0, 0, 0))
    box = ((-2, -2, -2), (2, 2, 2))
    shell = im.Set(abs(a)).facets(*box, depth=5)
    assert len(shell.sheets) == 1 and abs(shell.area - 4 * math.pi) < 0.1
    ring = (im.Set(abs(a)) & im.Set(abs(b))).facets(*box, depth=5)
    (wire,) = ring.wires
    length = np.linalg.norm(np.diff(wire, axis=0), axis=1).sum()
    assert abs(length - 2 * math.pi * math.sqrt(0.75)) < 5e-3
    dots = (im.Set(abs(a)) & im.Set(abs(b)) & im.Set(abs(c))).facets(*box, depth=5)
    assert np.allclose(sorted(dots.points[:, 1]), [-math.sqrt(0.75), math.sqrt(0.75)])
    for format in ("stl", "ply", "glb", "3mf"):
        with pytest.raises(moldloft.Error, match=f"{format} cannot hold the wires"):
            ring.write(tmp_path / f"ring.{format}")
    with pytest.raises(moldloft.Error, match="stl cannot hold the points"):
        dots.write(tmp_path / "dots.stl")
    text = ring.write(tmp_path / "ring.obj").read_text()
    assert "\nl 1 2 3" in text
    assert b'NumberOfLines="1"' in ring.write(tmp_path / "ring.vtp").read_bytes()
    shell.write(tmp_path / "shell.stl")


def test_fewer_triangles_bodies_and_distances():
    fine = tee().facets(*BOX, depth=6)
    simple = fine.simplified(2e-3)
    assert simple.closed and simple.crossings() == 0 and simple.euler == 2
    assert len(simple.triangles) < 0.7 * len(fine.triangles)
    assert simple.worst_vertex() < 1e-11 and abs(simple.volume - 25.097) < 0.1
    a, b = im.cuboid((0, 0, 0), (1, 1, 1)), im.cuboid((1, 1, 0), (2, 2, 1))
    both = (a | b).facets((-1,) * 3, (3,) * 3, depth=5)
    assert both.manifold and both.bodies == 2 and len(both.touching) > 0
    hollow = im.Set(im.sphere((0, 0, 0), 1)) - im.Set(im.sphere((0, 0, 0), 0.5))
    volumes = sorted(hollow.facets(depth=5).shell_volumes)
    assert volumes[0] < 0 < volumes[1] and hollow.facets(depth=5).bodies == 1
    apart = a.distance(im.Set(im.sphere((4, 0.5, 0.5), 1)))
    assert abs(apart.distance - 2) < 1e-4 and apart.at_least <= 2 + 1e-12
    assert a.distance(im.Set(im.sphere((1, 1, 1), 0.5))).distance == 0
    assert a.distance(im.nothing(), (-1,) * 3, (2,) * 3) is None


def test_sections_nearest_points_and_rays():
    facets = tee().facets(*BOX, depth=6)
    (ring,) = facets.section((1, 0, 0), (-2, 0, 0))
    assert ring.closed and abs(ring.length - 2 * math.pi) < 5e-3
    assert np.allclose(np.hypot(ring.points[:, 1], ring.points[:, 2]), 1, atol=1e-12)
    svg = facets.section_svg([(0, 1, 0), (1, 0, 0)])
    assert svg.startswith("<svg") and svg.count("<path") == 2
    ball = im.Set(im.sphere((0, 0, 0), 1))
    near = ball.nearest((3, 4, 0))
    assert np.allclose(near.point, [0.6, 0.8, 0], atol=1e-9) and near.at_least <= 4 + 1e-12
    enter, leave = ball.hits((-3, 0.6, 0), (1, 0, 0))
    assert np.allclose([enter.t, leave.t], [2.2, 3.8]) and enter.enters and not leave.enters
    assert np.allclose(enter.normal, [-0.8, 0.6, 0])
    low, high = ball.bounds(1e-3)
    assert np.allclose(high, 1, atol=2e-3) and np.allclose(low, -1, atol=2e-3)


def test_pictures():
    ball = im.Set(im.sphere((0, 0, 0), 1), colour=4)
    for png in (ball.picture(size=(64, 48)), ball.facets(depth=4).picture(size=(64, 48))):
        assert png.startswith(b"\x89PNG")
    lamp = im.Lamp((3, -3, 5), (0.9, 0.9, 0.8))
    lit = ball.picture(size=(64, 48), lights=[lamp], shadows=True, samples=2)
    assert lit != ball.picture(size=(64, 48), lights=[], samples=2)


def test_three_mf_has_names_and_colours(tmp_path):
    path = tee().facets(*BOX, depth=5).write(tmp_path / "tee.3mf")
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        text = archive.read("3D/3dmodel.model").decode()
    assert '<base name="fillet"' in text and 'type="model"' in text
    loaded = trimesh.load(path, force="mesh") if _has("lxml") and _has("networkx") else None
    assert loaded is None or loaded.is_watertight


def _has(name: str) -> bool:
    from importlib.util import find_spec

    return find_spec(name) is not None


def test_python_functions_as_primitives():
    def value(p):
        return np.linalg.norm(p, axis=1) - 1

    exact = im.Set(im.sphere((0, 0, 0), 1, distance=True)).facets((-2,) * 3, (2,) * 3, depth=4)
    for extra in (
        {"lipschitz": 1.0},
        {"range": lambda low, high: (-2.0, math.dist(low, high) + 4)},
        {
            "lipschitz": 1.0,
            "gradient": lambda p: p / np.linalg.norm(p, axis=1)[:, None],
        },
    ):
        ball = im.function(value, **extra)
        facets = im.Set(ball).facets((-2,) * 3, (2,) * 3, depth=4)
        assert facets.closed and abs(facets.volume - exact.volume) < 1e-6
    # In arithmetic with others, moved, and in a model.
    ball = im.function(value, lipschitz=1.0)
    assert (2 * ball.translated((1, 0, 0)) + 1)((1, 0, 3)) == 5.0
    text = """param float h = 0.5 in [0, 1]; field b = ball();
        set cap = set(b) & set(plane({0, 0, -1}, {0, 0, h}));"""
    m = moldloft.loads(text, functions={"ball": ball})
    h = 0.5
    cap = math.pi * (1 - h) ** 2 * (2 + h) / 3
    assert abs(m.eval("volume(cap, {-2, -2, -2}, {2, 2, 2}, 1e-3)") - cap) < 2e-3
    slope = m.derivative("volume(cap, {-2, -2, -2}, {2, 2, 2}, 1e-3)", "h")
    assert abs(slope + math.pi * (1 - h * h)) < 2e-2


def test_python_functions_that_fail():
    def broken(_):
        raise ZeroDivisionError("no such luck")

    box = ((-1, -1, -1), (1, 1, 1))
    with pytest.raises(moldloft.Error, match="no such luck") as caught:
        im.Set(im.function(broken, lipschitz=1.0)).facets(*box, depth=3)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    with pytest.raises(moldloft.Error, match=r"shape \(2, 2\), expected \(.*,\)"):
        im.function(lambda p: np.zeros((2, 2)))([[0, 0, 0]])
    with pytest.raises(moldloft.Error, match="shape"):
        im.function(lambda p: 3.0)([[0, 0, 0]])
    with pytest.raises(moldloft.Error, match="could not convert"):
        im.function(lambda p: "seven")([[0, 0, 0]])
    with pytest.raises(moldloft.Error, match="pair of numbers"):
        im.Set(im.function(lambda p: p[:, 0], range=lambda a, b: 3)).facets(*box, depth=3)
    with pytest.raises(moldloft.Error, match="is empty"):
        im.function(lambda p: p[:, 0], range=lambda a, b: (1, 0)).range(*box)
    with pytest.raises(ValueError, match="Lipschitz"):
        im.function(lambda p: p[:, 0], lipschitz=math.nan)
    # Afterwards other work is unharmed.
    assert im.Set(im.sphere((0, 0, 0), 0.5)).facets(*box, depth=3).closed


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: im.sphere((0, 0, 0), 0), "radius must be above 0"),
        (lambda: im.sphere((0, 0, math.nan), 1), "expected a finite number, found NaN"),
        (lambda: im.sphere((0, 0), 1), "three coordinates"),
        (lambda: im.plane((0, 0, 0), (0, 0, 0)), "normal is degenerate"),
        (lambda: im.axes()[0] / 0, "divided by a number"),
        (lambda: im.axes()[0] ** 0.5, "whole number"),
        (lambda: im.axes()[0] ** -1, "whole number"),
        (lambda: im.cone((0, 0, 0), (0, 0, 1), math.pi), "angle"),
        (lambda: im.cyclide((0,) * 3, (0, 0, 1), (1, 0, 0), 1, 0.5, 2), "change"),
        (lambda: im.liming(*im.axes(), lambda_=1), "between 0 and 1"),
        (lambda: im.liming(*im.axes(), lambda_=-0.1), "between 0 and 1"),
        (lambda: im.fillet(*im.axes()[:2], 0), "setback must be above 0"),
        (lambda: im.cuboid((0, 0, 0), (1, 0, 1)), "no volume"),
        (lambda: im.tetrahedron(*[(0, 0, 0)] * 4), "degenerate"),
        (lambda: im.Set(im.cylinder((0,) * 3, (0, 0, 1), 1)).facets(), "unbounded towards"),
        (lambda: im.Set(im.cylinder((0,) * 3, (0, 0, 1), 1)).mass(), "unbounded towards"),
        (lambda: im.everything().facets(), "unbounded towards"),
        (lambda: tee().facets((0, 0, 0), (0, 1, 1)), "no volume"),
        (lambda: tee().facets((0, 0, 0)), "two corners"),
        (lambda: tee().facets(*BOX, accuracy=1e-12), "boxes, more than"),
        (lambda: tee().facets(*BOX, accuracy=0), "accuracy must be above 0"),
        (lambda: tee().facets(*BOX, depth=40), "boxes, more than"),
        (lambda: tee().facets(*BOX, depth=4, accuracy=0.1), "not both"),
        (lambda: tee().hits((0, 0, 0), (0, 0, 0)), "direction"),
        (lambda: tee()([[1, 2]]), r"shape \(…, 3\)"),
        (lambda: tee().with_attributes(colour=99), "0 to 15"),
        (lambda: tee().facets(*BOX, depth=4).write("x.dwg"), "not written as `dwg`"),
        (lambda: im.axes()[0].mapped(np.zeros((3, 3))), "degenerate"),
        (lambda: tee().picture(size=(0, 9)), "1 to 8192"),
        (lambda: tee().picture(size=(9, -1)), "1 to 8192"),
        (lambda: tee().picture(angle=math.nan), "between 0 and pi"),
        (lambda: tee().picture(samples=0), "at least one sample"),
    ],
)
def test_bad_input(call, match):
    with pytest.raises((moldloft.Error, ValueError), match=match):
        call()


def test_rails_are_checked():
    a, b = im.sphere((0, 0, 0), 1), im.sphere((1, 0, 0), 1)
    box = {"low": (-3, -3, -3), "high": (3, 3, 3)}
    with pytest.raises(moldloft.Error, match=r"inside body .* near \("):
        im.liming(a, b, im.sphere((0.5, 0, 0), 0.7), **box)
    with pytest.raises(moldloft.Error, match="rails meet near"):
        im.zhang(a, b, im.axes()[0], im.axes()[1], **box)
    with pytest.raises(moldloft.Error, match=r"two corners, .* low and high"):
        im.liming(a, b, im.sphere((0.5, 0, 0), 0.7), low=(-3, -3, -3))
    x, _, z = im.axes()
    im.liming(x, z, im.setback(x, z, 0.5), **box)
    corner = im.fillet(x, z, 0.5, **box)
    assert corner.degree == 2
    t = 0.5 * (1 - math.sqrt(0.5))
    # The blend and its rail have the name of the function.
    blends = [leaf.field((t, 0, t)) for leaf in corner.leaves if leaf.name == "fillet"]
    assert min(map(abs, blends)) < 1e-15


def test_work_that_goes_on_unseen_does_not_end_the_interpreter_badly(tmp_path):
    """The thread is still in the user's function, and wants to return to it, when Python ends."""
    script = tmp_path / "leaves.py"
    script.write_text(
        "import threading, time\n"
        "from moldloft import implicit as im\n"
        "slow = im.function(lambda p: (time.sleep(0.05), p[:, 0])[1])\n"
        "def work():\n"
        "    im.Set(slow).facets((-1, -1, -1), (1, 1, 1), depth=5)\n"
        "threading.Thread(target=work, daemon=True).start()\n"
        "time.sleep(0.5)\n"
        "print('left')\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "left\n", "")


def test_everything_and_nothing_in_a_box():
    facets = im.everything().facets((0, 0, 0), (1, 1, 1), depth=4)
    assert facets.closed and abs(facets.volume - 1) < 1e-12
    assert {p.name for p in facets.patches} == {f"cap {s}{a}" for s in "+-" for a in "xyz"}
    assert len(im.nothing().facets((0, 0, 0), (1, 1, 1)).triangles) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_stops_facets():
    calls = itertools.count()

    def slow(points):
        # The whole would take hours.
        time.sleep(0.01)
        if next(calls) == 20:
            signal.raise_signal(signal.SIGINT)
        return points[:, 0]

    # Programs that are begun in the background have it ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            im.Set(im.function(slow)).facets((-1, -1, -1), (1, 1, 1), depth=7)
    finally:
        signal.signal(signal.SIGINT, before)


def test_models_give_fields_and_sets(tmp_path):
    m = moldloft.load(EXAMPLES / "tee.sdl")
    part = m["tee"].value
    assert isinstance(part, moldloft.Set) and m["tee"].class_ == "set"
    assert np.allclose(m["tee"]([[0, 0, 0], [0, 2, 0]]), part([[0, 0, 0], [0, 2, 0]]))
    assert "apex" in m["back"].parents and set(m["tee"].parents) >= {"run", "branch"}
    assert abs(m.eval("volume(tee, {-4,-4,-4}, {4,4,4})") - 25.097) < 1e-3
    names = {p.name for p in m.mesh().patches}
    assert names >= {"part.run", "part.branch", "part.fillet_surface", "part.bore1"}
    assert m.mesh().closed
    before = m.mesh().volume
    m["r2"] = 0.65
    assert m.mesh().volume != before
    files = m.write(tmp_path / "tee.stl")
    assert trimesh.load(files[0]).is_watertight
    m.write(tmp_path / "tee.3mf")
    assert m["part"].volume > 0 and m.eval("part.volume") > 0


def test_attributes_reach_every_triangle_and_the_files(tmp_path):
    text = """AbsPoint C(0, 0, 0);
    set ball = attributes(set(sphere(C, 1)), name = "hull", colour = 4,
        material = "brass", tolerance = 1e-3);
    set cut = attributes(set(plane({0, 0, 1}, {0, 0, 0.2})), colour = 9);
    set sheet = attributes(set(abs(plane({1, 0, 0}, {2, 0, 0}))), material = "cloth");
    SetBody b(ball & cut | sheet & cuboid({1.5, -1, -1}, {2.5, 1, 1}), depth = 5, tags = "part");
    """
    m = moldloft.loads(text)
    patches = {p.name: p for p in m.mesh().patches}
    # The name that was given stays; the other is that of its declaration.
    assert set(patches) == {"b.hull", "b.cut", "b.sheet"}
    hull, cut, sheet = patches["b.hull"], patches["b.cut"], patches["b.sheet"]
    assert (hull.colour, hull.tags, cut.colour, cut.tags) == (4, ["part", "brass"], 9, ["part"])
    assert sheet.tags == ["part", "cloth"]
    groups = {g["name"]: g for g in m.eval("b")["groups"]}
    assert groups["hull"]["tolerance"] == 1e-3 and groups["cut"]["tolerance"] is None
    assert groups["hull"]["stop"] - groups["hull"]["start"] == hull.panels
    assert len(m.mesh(tags="brass").faces) == hull.panels
    assert "\ng b.hull" in m.write(tmp_path / "b.obj")[0].read_text()
    assert "brass" in (tmp_path / "b.obj").read_text()
    m.write(tmp_path / "b.3mf")
    with zipfile.ZipFile(tmp_path / "b.3mf") as archive:
        text = archive.read("3D/3dmodel.model").decode()
    assert text.count("<base ") == 3 and 'name="b.hull" displaycolor="#B84A40"' in text
    document = m.write(tmp_path / "b.glb")[0].read_bytes()
    size = int.from_bytes(document[12:16], "little")
    materials = json.loads(document[20 : 20 + size])["materials"]
    colours = {k["name"]: tuple(k["pbrMetallicRoughness"]["baseColorFactor"]) for k in materials}
    assert len(set(colours.values())) == 3 and set(colours) == set(patches)
    # From Python, triangle by triangle.
    ball = im.Set(im.sphere((0, 0, 0), 1), colour=4, material="brass", tolerance=1e-3)
    half = (ball & im.Set(im.axes()[2], colour=9)).facets(depth=4)
    said = [half.attributes[k] for k in half.primitive]
    assert {(s["colour"], s["material"], s["tolerance"]) for s in said} == {
        (4, "brass", 1e-3),
        (9, None, None),
    }
    assert "brass" in half.write(tmp_path / "half.obj").read_text()


def test_the_command(tmp_path):
    model = EXAMPLES / "tee.sdl"
    done = command("eval", model, "volume(tee, {-4,-4,-4}, {4,4,4})", "tee", "part")
    volume, text, body = done.stdout.splitlines()
    assert done.returncode == 0 and abs(float(volume) - 25.097) < 1e-3
    assert text == "set of 10 primitives" and body.startswith("a mesh of ")
    done = command("eval", "--json", model, "tee", "part")
    shape, mesh = json.loads(done.stdout)
    assert shape["class"] == "set" and mesh["triangles"] > 1000
    done = command("build", model, "--to", "stl", "--to", "3mf", "-o", tmp_path)
    assert done.returncode == 0, done.stderr
    assert {p.name for p in tmp_path.iterdir()} == {".moldloft-written", "tee.stl", "tee.3mf"}
    wires = command("build", EXAMPLES / "wires.sdl", "--to", "stl", "-o", tmp_path)
    assert wires.returncode == 1 and "stl cannot hold the wires of `crossing`" in wires.stderr
    done = command("build", EXAMPLES / "wires.sdl", "--to", "obj", "-o", tmp_path)
    assert done.returncode == 0 and (tmp_path / "wires.obj").read_text().count("\nl ") >= 2
    broken = tmp_path / "broken.sdl"
    broken.write_text("field f = sphere({0,0,0}, 1)^0.5;\n")
    done = command("check", broken)
    assert done.returncode == 1 and "whole number from 0 to 1000" in done.stdout + done.stderr
    text = "set  a=set(sphere({0,0,0},1))|set( sphere({1,0,0},1) )&-set(plane({1,0,0},{0,0,0}));"
    broken.write_text(text)
    done = command("fmt", broken)
    assert done.returncode == 0 and "|" in broken.read_text()


# The examples, each with numbers that were found another way.


def example(name: str) -> moldloft.Model:
    return moldloft.load(EXAMPLES / f"{name}.sdl")


def test_the_neck_is_tangent_on_its_rails():
    m = example("neck")
    body, spout, shoulder = (m[n].value for n in ("body", "spout", "shoulder"))
    mesh = m.mesh()
    assert mesh.closed and mesh.summary["components"] == 1
    # Along the rail on the body both gradients are parallel, and of the same direction.
    for angle in np.linspace(0, 2 * math.pi, 13):
        y, z = math.cos(angle), math.sin(angle)
        p = (-1 + 0.3 * y + 0.2 * z, y, z)
        g, h = body.gradient(p), shoulder.gradient(p)
        assert abs(body(p)) < 1e-12 and abs(shoulder(p)) < 1e-12
        assert np.linalg.norm(np.cross(g, h)) < 1e-9 and g @ h > 0
    assert shoulder.degree == 4 and spout.degree == 2
    box = ((-3.2, -2.6, -1.6), (2.6, 1.6, 1.6))
    low, high = m["bottle"].value.mass(*box, depth=6).volume_bracket
    assert low <= m.eval("volume(bottle, {-3.2,-2.6,-1.6}, {2.6,1.6,1.6})") <= high


def test_the_wave_has_the_area_of_its_integral():
    from scipy.integrate import dblquad, quad

    m = example("wave")
    arc = quad(lambda x: math.sqrt(1 + math.cos(x) ** 2), -4, 4)[0]
    box = "{-4, -2, -2}, {4, 2, 2}"
    area = m.eval(f"area(sheet, {box})")
    assert abs(area - 4 * arc) < 1e-3 * area

    # The ball cuts out the part that lies in it.
    def inside(y: float, x: float) -> float:
        z = -math.sin(x)
        within = x * x + y * y + z * z < 2.25
        return math.sqrt(1 + math.cos(x) ** 2) if within else 0.0

    n = 1200
    xs = (np.arange(n) + 0.5) / n * 3 - 1.5
    grid_x, grid_y = np.meshgrid(xs, xs, indexing="ij")
    within = grid_x**2 + grid_y**2 + np.sin(grid_x) ** 2 < 2.25
    hole = (np.sqrt(1 + np.cos(grid_x) ** 2) * within).sum() * (3 / n) ** 2
    assert abs(m.eval(f"area(with_hole, {box})") - (4 * arc - hole)) < 2e-3 * area
    assert abs(m.eval(f"area(with_ball, {box})") - (4 * arc - hole + 9 * math.pi)) < 3e-3 * area
    body = m.eval("ball_body")
    assert abs(body["volume"] - 4.5 * math.pi) < 2e-2
    assert callable(dblquad) and inside(0, 0) > 0


def test_the_wires_have_the_length_of_their_integral():
    from scipy.integrate import quad

    m = example("wires")
    facets = m["object"].value.facets((-2.2,) * 3, (2.2,) * 3, depth=6)
    r = 0.8

    def speed(t: float) -> float:
        x, z = -r * math.sin(t), r * math.cos(t)
        y = -(r * math.sin(t)) * (r * math.cos(t)) / math.sqrt(1 - (r * math.sin(t)) ** 2)
        return math.sqrt(x * x + y * y + z * z)

    one = quad(speed, 0, 2 * math.pi)[0]
    lengths = [np.linalg.norm(np.diff(w, axis=0), axis=1).sum() for w in facets.wires]
    assert len(lengths) == 2 and np.allclose(lengths, one, rtol=1e-3)
    # Outside the block: four pieces of pipe.
    area = 2 * math.pi * 2 * 1.1 + 2 * math.pi * r * 2 * 1.1
    assert abs(facets.area - area) < 3e-3 * area and len(facets.sheets) == 2


def test_fillets_side_by_side_grow_with_lambda():
    m = example("lambdas")
    volumes = [m.eval(f"piece[{k}].volume") for k in range(1, 10)]
    # The smaller lambda, the fuller the fillet.
    assert all(a > b for a, b in itertools.pairwise(volumes))
    assert abs(volumes[5] - 25.097) < 5e-3 and m.mesh().closed
    assert m.mesh().summary["components"] == 9


def test_the_quadric_passes_through_all_four_lines():
    m = example("quadric")
    q = m["q"].value
    assert q.degree == 2
    planes = [m[f"p{k}"].value for k in (1, 2, 3, 4)]
    for a in planes[:2]:
        for b in planes[2:]:
            g, h = a.gradient((0, 0, 0)), b.gradient((0, 0, 0))
            along = np.cross(g, h)
            base = np.linalg.lstsq(np.array([g, h]), -np.array([a((0, 0, 0)), b((0, 0, 0))]))[0]
            for t in (-2, 0, 3):
                assert abs(q(base + t * along)) < 1e-12
    assert m.mesh().patches[0].kind == "field"


def test_the_manifold_and_its_openings():
    m = example("manifold")
    names = [p.name for p in m.mesh().patches]
    assert "plating" in names and "manifold_body.fillet" in names
    body = m.eval("manifold_body")
    assert body["volume"] > math.pi * 0.3**2 * 3.2
    for k in (1, 2, 3):
        opening = m[f"opening[{k}]"]
        p = opening(np.linspace(0, 1, 9))
        # On the plating and on the pipe.
        assert np.allclose(np.hypot(p[:, 0] - k, p[:, 2] - 0.9), 0.15, atol=1e-9)
    slope = m.derivative("length(opening[2])", "pipe")
    h = 1e-5
    m["pipe"] = 0.15 + h
    high = m.eval("length(opening[2])")
    m["pipe"] = 0.15 - h
    assert abs((high - m.eval("length(opening[2])")) / (2 * h) - slope) < 1e-5


def test_vertices_move_with_parameters():
    m = example("tee")
    mesh = m.mesh()
    motion = m.jacobian(["r1"])[:, :, 0]
    run = mesh.patch("part.run")
    own = set(np.unique(mesh.faces[run.start : run.stop]).tolist())
    others = np.ones(len(mesh.faces), dtype=bool)
    others[run.start : run.stop] = False
    own -= set(np.unique(mesh.faces[others]).tolist())
    at = np.array(sorted(own))
    p = mesh.vertices[at]
    normal = np.column_stack([np.zeros(len(p)), p[:, 1], p[:, 2]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    # Faces of a cylinder move outward as its radius grows, and along no other way.
    assert len(at) > 500
    assert np.allclose((motion[at] * normal).sum(axis=1), 1, atol=1e-9)
    assert np.allclose(motion[at], normal, atol=1e-9)
    # The ends of the pipe do not move.
    ends = mesh.patch("part.right")
    flat = np.unique(mesh.faces[ends.start : ends.stop])
    assert np.allclose(motion[flat, 0], 0, atol=1e-9)
    # The volume grows by the flux of the motion through the panels.
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    area = np.cross(b - a, c - a) / 2
    mean = motion[mesh.faces[:, :3]].mean(axis=1)
    slope = m.derivative("mesh.volume", "r1")
    assert abs((area * mean).sum() - slope) < 2e-3 * abs(slope)
    best = m.derivative("volume(bored, {-4,-4,-4}, {4,4,4})", "r1")
    assert abs(best - slope) < 2e-2 * abs(best)
