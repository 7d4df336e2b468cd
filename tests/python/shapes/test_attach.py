"""Patches round an appendage by `attach` against the same assembly by hand, and closed forms."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import moldloft
from mesh_edges import edge_uses
from test_assemblies import KINDS, bulb_on_chine_hull, cone

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
CASES = 204 if SOAK else 12
SETTINGS = 400 if SOAK else 3

PATCHES = [f"weld.{name}[{k}]" for name in ("ring", "strip", "corner") for k in range(1, 5)]

HEAD = """load "attach.sdl"
param float r = 1 in [0.7, 1.3];
param float d = 0 in [-1, 1]; param float k = 0 in [-1, 1];
"""


def both_ways(seed: int) -> tuple[str, str, int]:
    """A random assembly with its hole by hand, and by `attach` with the side of the seam open."""
    rng = np.random.default_rng(seed)
    parts, cut, _ = KINDS[seed % len(KINDS)](rng)
    shapes = HEAD + "\n".join(parts[k] for k in rng.permutation(2)) + "\n"
    by_hand = (
        shapes
        + "Intersection x(base, shaft); IntSnake hole(base, x); IntSnake rim(shaft, x);\n"
        + cut
    )
    return by_hand, shapes + "attach weld(base, shaft, side = {side});\n", int(rng.integers(3, 8))


def side_of_seam(text: str) -> int:
    """The side of the box on which the intersection begins at the stated values."""
    model = moldloft.loads(text.replace("{side}", "0"))
    t = [model.eval(f"weld.r[{k}].t") for k in (1, 2, 3, 4)]
    risen = [t[k] < t[(k + 1) % 4] for k in range(4)]
    return risen.index(sum(risen) < 2) + 1


def corners(mesh: moldloft.Mesh) -> np.ndarray:
    """The corners of each face by number: which side of an open skin is out may change."""
    return np.sort(mesh.faces, axis=1)


@pytest.mark.parametrize("seed", range(CASES))
def test_patches_by_attach_are_the_surface_with_its_hole(seed: int) -> None:
    by_hand, text, count = both_ways(seed)
    text = text.replace("{side}", str(side_of_seam(text)))
    text += f"SubSurf tube({{weld.rim, shaft.u0}}, divisions = {{{8 * count}, 3}});\n"
    text += "SubSurf rest({weld.rim, shaft.u1}, visible = 0);\n"
    hand, model = moldloft.loads(by_hand), moldloft.loads(text)
    rng = np.random.default_rng(1000 + seed)
    numbered = None
    for _ in range(SETTINGS):
        # Area of the surface with its hole, and of the whole shaft in its two parts.
        area = sum(model[name].area for name in PATCHES)
        assert area == pytest.approx(hand.eval("plate.area"), rel=1e-8), text
        shaft = model.eval("tube.area") + model.eval("rest.area")
        assert shaft == pytest.approx(model.eval("shaft.area"), rel=1e-8), text
        mesh = model.mesh()
        on_shaft = abs(cone(model, mesh.vertices)) < 1e-9
        edges, uses = edge_uses(mesh.faces)
        ring = uses[on_shaft[edges].all(axis=1)]
        assert uses.max() == 2 and np.count_nonzero(ring == 1) == 8 * count, text
        # The rim of the shaft's end alone is open there; elsewhere the edges of the whole surface.
        numbered = corners(mesh) if numbered is None else numbered
        if KINDS[seed % len(KINDS)] is bulb_on_chine_hull:
            # Rows move where the chine enters or leaves a patch.
            assert len(numbered) == len(mesh.faces), text
        else:
            assert np.array_equal(corners(mesh), numbered), text
        assert not model.junctions(), text
        values = {
            name: float(rng.uniform(*span))
            for name, span in {"r": (0.7, 1.3), "d": (-1, 1), "k": (-1, 1)}.items()
        }
        hand.set(values)
        model.set(values)


PIPE = """AbsPoint P(-1, 0, 0); AbsPoint Q(3, 0, 0); Line axis(P, Q);
AbsPoint P1(-1, 0, 1); AbsPoint Q1(3, 0, 1.2); Line rule(P1, Q1);
RevSurf pipe(rule, axis, 0, 2*PI, visible = 0);
AbsPoint A({x}, -{w}, -{w}); AbsPoint B({x}, {w}, -{w}); AbsPoint C({x}, -{w}, {w});
AbsPoint D({x}, {w}, {w});
Line ab(A, B); Line cd(C, D); RuledSurf wall(ab, cd, visible = 0);
"""


@pytest.mark.parametrize("turn", [0.0, 0.13, 0.4, 0.77])
@pytest.mark.parametrize("end", ["pipe.u1", "back"])
def test_a_band_that_begins_away_from_the_seam_is_the_band(turn: float, end: str) -> None:
    """Area and closedness against the frustum of a cone, whichever way the intersection runs."""
    text = PIPE.format(x=0, w=2) + (
        "AbsMagnet b0(pipe, 1, 1); AbsMagnet b1(pipe, 1, 0); LineSnake back(b0, b1);"
        f"AbsMagnet begin(pipe, 0.25, {turn}); Intersection x(begin, wall); IntSnake rim(pipe, x);"
        f"SubSurf tube({{rim, {end}}}, divisions = {{24, 4}});"
    )
    try:
        model = moldloft.loads(text)
    except moldloft.ModelError as error:
        assert {d.id for d in error.diagnostics} == {"folded-patch"}
        return
    exact = np.pi * (1.05 + 1.2) * np.hypot(3, 0.15)
    assert model.eval("tube.area") == pytest.approx(exact, rel=1e-9)
    mesh = model.mesh()
    assert abs(mesh.area - exact) < 0.02 * exact
    open_edges = {(e["patch"], e["edge"]) for e in mesh.closure()["edges"]}
    assert open_edges == {("tube", "v = 0"), ("tube", "v = 1")}


def test_one_direction_of_a_band_is_sound() -> None:
    sound = 0
    for end in ("pipe.u1", "back"):
        text = PIPE.format(x=0, w=2) + (
            "AbsMagnet b0(pipe, 1, 1); AbsMagnet b1(pipe, 1, 0); LineSnake back(b0, b1);"
            "AbsMagnet begin(pipe, 0.25, 0.4); IntSnake rim(begin, wall);"
            f"SubSurf tube({{rim, {end}}});"
        )
        try:
            moldloft.loads(text)
            sound += 1
        except moldloft.ModelError:
            pass
    assert sound == 1


@pytest.mark.parametrize(
    ("text", "words"),
    [
        # A wall that the seam of the pipe does not reach.
        ("attach weld(wall, pipe);", "does not meet"),
        # The wall as the appendage of the pipe: the intersection runs round it.
        ("attach weld(pipe, wall, wall.v0);", "does not meet"),
        ("IntSnake s(pipe, wall); BoxMagnet c(s, 1);", "runs round"),
        (
            "AbsMagnet m(pipe, 0.5, 0); AbsMagnet n(pipe, 0.6, 0); AbsMagnet q(pipe, 0.5, 0.1);"
            "ConicSnake s(m, n, q); BoxMagnet c(s, 1);",
            "reaches an edge",
        ),
        ("BoxMagnet c(pipe.v0, 1, edge = 2);", "begin and end on the edge"),
        ('UVSnake s(wall, "u", 0.5); BoxRing c(s, 1);', "not closed"),
    ],
)
def test_what_has_no_box_is_refused_with_a_remedy(text: str, words: str) -> None:
    width = 1.0 if "weld(wall" in text else 2.0
    with pytest.raises(moldloft.ModelError, match=words):
        moldloft.loads('load "attach.sdl"\n' + PIPE.format(x=0, w=width) + text)


BALL = """load "attach.sdl"
param float r = 0.5 in [0.3, 0.7]; param float at = 0.3 in [-0.5, 0.5];
AbsPoint N(-2, 0, -9); AbsPoint M(0, 0, -7); AbsPoint S(2, 0, -9); Arc meridian(N, M, S);
Line poles(N, S);
RevSurf ball(meridian, poles, 0, 2*PI, visible = 0);
AbsPoint P(at, 0, -9); AbsPoint Q(at, 0, -13); Line axis(P, Q); AbsPoint G(at, r, -9);
AbsPoint H(at, r, -13); Line rule(G, H);
RevSurf leg(rule, axis, 0, 2*PI, visible = 0); EdgeSnake hem(2, leg);
AbsBead g0(hem, 0); AbsBead g1(hem, 0.5); AbsBead g2(hem, 1); SubCurve left(g0, g1);
SubCurve right(g2, g1); RuledSurf lid(left, right);
"""


def test_volume_of_a_ball_on_a_leg() -> None:
    """Against the integral of the closed form; every panel edge belongs to two panels."""
    quad = pytest.importorskip("scipy.integrate").dblquad
    text = (
        BALL
        + "attach weld(ball, leg, side = {side});"
        + "SubSurf tube({weld.rim, leg.u1}, divisions = {32, 6});"
    )
    attached = moldloft.loads(text.replace("{side}", str(side_of_seam(text))))
    faces = None
    for r, at in ((0.5, 0.3), (0.3, -0.5), (0.7, 0.5), (0.45, 0.0)):
        attached.set({"r": r, "at": at})
        inside, _ = quad(
            lambda phi, rho, at=at: rho * np.sqrt(4 - at**2 - rho**2 - 2 * at * rho * np.cos(phi)),
            0,
            r,
            0,
            2 * np.pi,
            epsabs=1e-12,
        )
        exact = 32 * np.pi / 3 + 4 * np.pi * r**2 - inside
        assert attached.hydrostatics().volume == pytest.approx(exact, rel=1e-8)
        mesh = attached.mesh()
        assert mesh.closure()["closed"]
        faces = mesh.faces if faces is None else faces
        assert np.array_equal(mesh.faces, faces)


def test_step_of_an_attached_leg_is_one_solid(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    model = moldloft.loads(BALL + "attach weld(ball, leg); SubSurf tube({weld.rim, leg.u1});")
    (path,) = model.write(tmp_path / "ball.step")
    found = read(path)
    assert found.valid and found.solids == found.closed == 1 and found.faces == 14
    assert found.volume == pytest.approx(model.hydrostatics().volume, rel=1e-6)


STRUT = """load "attach.sdl"
param float chord = 1 in [0.7, 1.4]; param float ratio = 0.1 in [0.05, 0.15];
param float at = 4 in [3.5, 4.5];
AbsPoint A(0, 0, 0); AbsPoint B(8, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(8, 3, 0);
Line ab(A, B); Line cd(C, D);
RuledSurf hull(ab, cd, visible = 0);
AbsPoint N(at, 1.5, 1); AbsPoint U(at + 0.3*chord, 1.5 + ratio*chord/2, 1);
AbsPoint T(at + chord, 1.5, 1);
FoilCurve top({T, U, N, T}); CopyCurve tip(top, N, {4, 1.5, -2});
RuledSurf strut(top, tip, visible = 0);
"""


@pytest.mark.parametrize(
    "cut",
    [
        "Intersection x(hull, strut);",
        "Intersection x(strut, hull);",
        "IntRing tail(strut.u0, hull); Intersection x(hull, strut, start = tail);",
        "AbsMagnet nose(strut, 0.5, 0.3); Intersection x(hull, nose);",
    ],
)
def test_an_intersection_passes_a_sharp_trailing_edge(cut: str) -> None:
    """The section of a strut that stands on a plane is its foil."""
    model = moldloft.loads(STRUT + cut)
    for chord, ratio in ((1, 0.1), (0.7, 0.05), (1.4, 0.15)):
        model.set({"chord": chord, "ratio": ratio})
        assert model["x"].length == pytest.approx(model["top"].length, rel=1e-9)
        assert model.eval("x(0)") == pytest.approx(model.eval("x(1)"), abs=1e-9)
    if "tail" in cut:
        assert model.eval("x(0)") == pytest.approx([5.4, 1.5, 0], abs=1e-9)
        step = 1e-5
        lengths = []
        for s in (-step, step):
            model.set({"chord": 1.3 + s})
            lengths.append(model["x"].length)
        model.set({"chord": 1.3})
        slope = (lengths[1] - lengths[0]) / (2 * step)
        assert model.derivative("x.length", "chord") == pytest.approx(slope, rel=1e-6)


def test_a_strut_is_attached_at_its_trailing_edge() -> None:
    """Area of the plate against the foil's, at random values, with one numbering."""
    text = STRUT + (
        "attach weld(hull, strut, strut.u0, side = 2);"
        "SubSurf blade({weld.rim, strut.v1}, divisions = {32, 4});"
        "SubSurf stub({weld.rim, strut.v0}, visible = 0);"
    )
    model = moldloft.loads(text)
    rng = np.random.default_rng(5)
    faces = None
    for _ in range(SETTINGS):
        foil = np.array([model.eval(f"top({t})")[:2] for t in np.linspace(0, 1, 4001)])
        inside = abs(np.sum(foil[:-1, 0] * foil[1:, 1] - foil[1:, 0] * foil[:-1, 1])) / 2
        area = sum(model[name].area for name in PATCHES)
        assert area == pytest.approx(24 - inside, rel=1e-7)
        # The tip is at two thirds of the strut from the hull.
        assert model["blade"].area == pytest.approx(2 * model["stub"].area, rel=1e-8)
        assert model["blade"].area == pytest.approx(model["strut"].area * 2 / 3, rel=1e-8)
        mesh = model.mesh()
        faces = mesh.faces if faces is None else faces
        assert np.array_equal(mesh.faces, faces)
        assert not model.junctions()
        # The plate's border and the strut's tip alone are open.
        open_edges = {(e["patch"], e["edge"]) for e in mesh.closure()["edges"]}
        assert not any("ring" in patch for patch, _ in open_edges)
        assert {edge for patch, edge in open_edges if patch == "blade"} == {"v = 1"}
        model.set(
            {
                "chord": rng.uniform(0.7, 1.4),
                "ratio": rng.uniform(0.05, 0.15),
                "at": rng.uniform(3.5, 4.5),
            }
        )


def test_half_an_appendage_is_attached_at_an_edge() -> None:
    """A half pipe on each edge of a plate, in either direction of the plate and of the pipe."""
    for edge in (1, 2, 3, 4):
        for spans in ("0, PI", "PI, 0"):
            # The pipe's half is on the inner side of the edge.
            place, turn = {1: ("4, 0", 0), 2: ("8, 1.5", 1), 3: ("4, 3", 2), 4: ("0, 1.5", 3)}[edge]
            a, b = (f"{t} + {turn}*PI/2" for t in spans.split(", "))
            text = f"""load "attach.sdl"
param float r = 0.5 in [0.3, 0.7]; AbsPoint A(0, 0, 0); AbsPoint B(8, 0, 0);
AbsPoint C(0, 3, 0); AbsPoint D(8, 3, 0);
Line ab(A, B); Line cd(C, D); RuledSurf hull(ab, cd, visible = 0);
AbsPoint P({place}, -1); AbsPoint Q({place}, 2); Line axis(P, Q); RelPoint G(P, r, 0, 0);
RelPoint H(Q, r, 0, 0); Line rule(G, H);
RevSurf pipe(rule, axis, {a}, {b}, visible = 0);
attach_at_edge weld(hull, pipe, {edge});
SubSurf tube({{weld.rim, pipe.u1}}, divisions = {{24, 4}});"""
            model = moldloft.loads(text)
            names = [f"weld.{n}{k}" for n in ("ring", "strip") for k in (1, 2, 3)] + [
                "weld.corner1",
                "weld.corner2",
            ]
            faces = None
            for r in (0.5, 0.3, 0.7):
                model.set({"r": r})
                assert sum(model[n].area for n in names) == pytest.approx(
                    24 - np.pi * r**2 / 2, rel=1e-9
                )
                assert model["tube"].area == pytest.approx(2 * np.pi * r, rel=1e-9)
                mesh = model.mesh()
                faces = mesh.faces if faces is None else faces
                assert np.array_equal(mesh.faces, faces)
                open_edges = {(e["patch"], e["edge"]) for e in mesh.closure()["edges"]}
                assert ("tube", "v = 0") not in open_edges and not model.junctions()
                assert {p for p, _ in open_edges} <= {*names, "tube"} - {"weld.ring2"}


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_panels_of_patches_have_derivatives(seed: int) -> None:
    """The area of panels that go with the box and the rings, against differences."""
    _, text, count = both_ways(seed)
    text = text.replace("{side}", str(side_of_seam(text)))
    model = moldloft.loads(
        text + f"SubSurf tube({{weld.rim, shaft.u0}}, divisions = {{{8 * count}, 3}});"
    )
    for name in ("r", "d"):
        base, step = model[name], 1e-5
        found = model.derivative("mesh.area", name)
        areas = []
        for s in (-step, step):
            model.set({name: base + s})
            areas.append(model.mesh().area)
        model.set({name: base})
        assert found == pytest.approx((areas[1] - areas[0]) / (2 * step), rel=1e-5, abs=1e-6), text


def test_an_appendage_across_a_knuckle_between_two_surfaces() -> None:
    model = moldloft.loads(
        """load "attach.sdl"
        param float x = 4 in [3, 5];
        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0.4); AbsPoint C(0, 4, 0); AbsPoint D(4, 4, 0.4);
        AbsPoint E(8, 0, 0); AbsPoint F(8, 4, 0); Line a(A, C); Line b(B, D); Line e(E, F);
        RuledSurf left(a, b, visible = 0); RuledSurf right(b, e, visible = 0);
        PolySurf plate({left, right}, "v", visible = 0);
        AbsPoint P(x, 2, -1); AbsPoint Q(x, 2, 3); AbsPoint G(x + 0.5, 2, -1);
        AbsPoint H(x + 0.5, 2, 3); Line axis(P, Q); Line rule(G, H);
        RevSurf pipe(rule, axis, 0, 2*PI, visible = 0);
        attach weld(plate, pipe); SubSurf leg({weld.rim, pipe.u1});
        """
    )
    numbered = None
    for x in (4.0, 4.2, 3.3, 4.5, 4.9):
        model["x"] = x
        area = sum(model[name].area for name in PATCHES)
        exact = 8 * np.sqrt(16.16) - np.pi / 4 * np.sqrt(1.01)
        assert area == pytest.approx(exact, rel=1e-8)
        mesh = model.mesh()
        # The border of the plate and the end of the leg are open.
        assert len(mesh.summary["open_loops"]) == 2 and not model.junctions()
        numbered = mesh.faces if numbered is None else numbered
        assert np.array_equal(mesh.faces, numbered)


LENS = """
load "attach.sdl"
AbsPoint A(0, 0, 0); AbsPoint B(30, 0, 0); AbsPoint C(0, 0, -{r}); AbsPoint D(30, 0, -{r});
Line axis(A, B); Line rule(C, D); RevSurf hull(rule, axis, 0, 2*PI, visible = 0);
AbsPoint L({x}, 0, 0); AbsPoint T({x} + {c}, 0, 0); AbsPoint U({x} + {c}, 0, 6);
AbsPoint I({x} + {c}/2, -{t}, 0); AbsPoint O({x} + {c}/2, {t}, 0);
Arc port(T, I, L); Arc starboard(L, O, T); PolyCurve section({{port, starboard}});
CopyCurve top(section, T, U); RuledSurf strut(section, top, visible = 0);
attach weld(hull, strut, seam = strut.u0); SubSurf skin({{weld.rim, strut.v1}});
"""


@pytest.mark.parametrize("seed", range(200 if SOAK else 6))
def test_an_appendage_may_have_sharp_edges(seed: int) -> None:
    """A strut of two arcs: at the edge the rim has the tangent of one side or the other."""
    rng = np.random.default_rng(seed)
    r, c = rng.uniform(1, 3), rng.uniform(6, 16)
    m = moldloft.loads(LENS.format(r=r, x=rng.uniform(4, 10), c=c, t=rng.uniform(0.2, 0.8) * r / 2))
    for name in ("weld.rim", "weld.hole"):
        # The edge is half-way round.
        before, at, after = (m[name].derivative(0.5 + d) for d in (-1e-7, 0, 1e-7))
        nearest = min(np.abs(at - side).max() for side in (before, after))
        assert nearest < 1e-3 * np.abs(at).max(), (name, before, at, after)
    assert not m.junctions()
