"""Random parts, changed at random, against OCCT's solids of the same construction.

A few here; with MOLDLOFT_SOAK=1 a thousand parts of twenty changes each. A part has up to five
pieces; changes move holes out of their bodies, faces past each other, and divide bodies. Each
result must be OCCT's, or refused by name.
"""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

pytest.importorskip("OCP")

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape

from moldloft import Sketch, SketchError
from sketch_parts import Drawn, Numbers, bar, block, changed, drawn, measures
from sketch_quadrature import block_of, joined, measured, moved, ring_about_z, turned_about_z

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
PLANE = range(600 if SOAK else 6)
ROUND = range(400 if SOAK else 4)
CHANGES = 20 if SOAK else 5

#: The relative bound.
BOUND = 1e-9

#: Edges of two round surfaces are splines within 1e-7 in OCCT, whatever the size of the body: the
#: larger it is, the more exact is what it makes.
SCALES = (100.0, 1.0, 1000.0, 10000.0)


def start(seed: int, *, curved: bool) -> tuple[Drawn, Sketch, dict, np.random.Generator] | None:
    """A part as drawn; None where a step of its construction is refused by name."""
    rng = np.random.default_rng([seed, int(curved)])
    part = drawn(rng, curved=curved)
    sketch = Sketch()
    try:
        sketch.run(part.text)
    except SketchError as error:
        said = ("leaves nothing", "touch", "nearly meet")
        assert any(words in str(error) for words in said), (seed, str(error))
        return None
    sketch.run(f"USING {part.name}")
    return part, sketch, part.named(sketch.dimensions), rng


def put(sketch: Sketch, called: dict, old: Numbers, new: Numbers) -> None:
    """Changes the numbers that differ."""
    for name, value in new.items():
        if value != old[name]:
            sketch[called[name]] = value


def some(rng: np.random.Generator, part: Drawn) -> Numbers:
    """The part's numbers, one to three of them changed."""
    values = dict(part.values)
    names = list(values)
    count = min(len(names), int(rng.integers(1, 4)))
    for k in rng.choice(len(names), size=count, replace=False):
        values[names[k]] = changed(rng, *part.ranges[names[k]])
    return values


def compare(part: Drawn, sketch: Sketch, values: Numbers, what: object) -> str:
    """Whether the sketch is OCCT's part: "right", "refused" or "nothing"."""

    def made(scale: float) -> np.ndarray | None:
        shape = part.solid(values, scale)
        found = None if shape is None else measures(shape, curved=part.curved)
        return None if found is None else found / scale ** np.array([3, 2, 1, 1, 1])

    found = sketch.objects[part.name]
    if found["volume"] is None:
        said = [str(r) for r in sketch.run("CHECK", strict=False) if r.severity == "warning"]
        assert any("701" in s or "310" in s for s in said), (what, said)
        return "nothing" if made(1.0) is None else "refused"
    got = np.array([found["volume"], found["area"], *found["centroid"]])
    tried = []
    for scale in SCALES if part.curved else (1.0,):
        wanted = made(scale)
        if wanted is None:
            continue
        off = apart(got, wanted)
        if off.max() < BOUND:
            return "right"
        tried.append((scale, off))
    # OCCT's integrals of faces between splines miss by up to 1e-8 at any scale: a cone cut by the
    # planes of a prism, a ring less a bar. A quadrature by rulings decides.
    if part.curved and tried:
        off = apart(got, part.quadrature(values))
        if off.max() < BOUND:
            return "right"
        tried.append((0.0, off))
    raise AssertionError((what, got, tried))


def apart(got: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Relative differences of volume and area, those of the centroid by its greatest coordinate."""
    size = max(1.0, float(np.abs(wanted[2:]).max()))
    return np.abs(got - wanted) / np.array([wanted[0], wanted[1], size, size, size])


@pytest.mark.parametrize(
    ("curved", "seeds", "most"), [(False, PLANE, 0.01), (True, ROUND, 0.08)], ids=["plane", "round"]
)
def test_changed_parts_are_those_of_occt(curved, seeds, most):
    counts = {"right": 0, "refused": 0, "nothing": 0}
    for seed in seeds:
        made = start(seed, curved=curved)
        if made is None:
            continue
        part, sketch, called, rng = made
        old = part.values
        for change in range(CHANGES + 1):
            new = some(rng, part) if change else dict(part.values)
            put(sketch, called, old, new)
            old = new
            moved = {n: x for n, x in new.items() if x != part.values[n]}
            counts[compare(part, sketch, new, (seed, change, moved, part.words))] += 1
    print(counts)
    assert counts["right"] > 0.8 * sum(counts.values()), counts
    # What is refused is said, but ordinary parts must not be.
    assert counts["refused"] <= max(2, most * counts["right"]), counts


@pytest.mark.parametrize("curved", [False, True], ids=["plane", "round"])
def test_derivatives_of_parts_are_their_differences(curved):
    compared = refused = 0
    step = 1e-4
    for seed in range(200) if SOAK else range(5):
        made = start(1000 + seed, curved=curved)
        if made is None:
            continue
        part, sketch, called, rng = made
        new = some(rng, part)
        put(sketch, called, part.values, new)
        if sketch.volume is None:
            continue
        names = list(called.values())
        keys = list(called)
        chosen = [int(k) for k in rng.choice(len(names), size=min(3, len(names)), replace=False)]
        gradient = sketch.gradient([names[k] for k in chosen])
        for place, k in enumerate(chosen):
            x = new[keys[k]]
            steps = step * np.array([-2.0, -1.0, 1.0, 2.0])
            rows = sketch.sweep(names[k], x + steps)
            if np.isnan(rows).any():
                continue
            wide, narrow = (rows[3] - rows[0]) / (4 * step), (rows[2] - rows[1]) / (2 * step)
            middle = np.array([sketch.volume, sketch.area, *sketch.centroid])
            # Where a face begins to touch another one there are two derivatives: the second
            # difference is then that of a kink, the same at both steps.
            near, far = (
                (r[0] + r[1] - 2 * middle) / h
                for r, h in ((rows[1:3], step), (rows[[0, 3]], 2 * step))
            )
            size = max(1.0, float(np.abs(narrow).max()))
            if (
                np.abs(far - 2 * near).max() > 1e-4 * size
                or np.abs(wide - narrow).max() > 1e-3 * size
            ):
                continue
            exact = np.array(
                [gradient.volume[place], gradient.area[place], *gradient.centroid[place]]
            )
            # None where faces lie in each other, or an edge in a face, and do not move alike.
            known = ~np.isnan(exact)
            if not known.all():
                assert gradient.kinks[place], (seed, names[k])
                refused += 1
            off = np.abs(exact - (4 * narrow - wide) / 3)[known].max(initial=0)
            assert off < 1e-5 * size, (seed, names[k], exact, narrow, part.words)
            compared += int(known.all())
    print(compared, refused)
    assert compared >= (300 if SOAK else 3)
    assert refused <= max(1, 0.02 * compared)


@pytest.mark.parametrize("tolerance", [3e-3, 1e-4])
def test_meshes_are_within_their_tolerance(tolerance):
    # Middles of facets and of their sides, from OCCT's faces.
    measured = 0
    rounds = 60 if SOAK else 6 if tolerance > 1e-3 else 2
    for seed in range(rounds):
        made = start(seed, curved=True)
        if made is None or made[1].volume is None:
            continue
        part, sketch, _, rng = made
        shape = part.solid(dict(part.values), 1.0)
        assert shape is not None
        places, corners = sketch.mesh(name=part.name, tolerance=tolerance)
        sides: dict[tuple[int, int], int] = {}
        for ring in corners:
            ring = [a for k, a in enumerate(ring) if a != ring[k - 1]]
            for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
                sides[a, b] = sides.get((a, b), 0) + 1
        assert all(sides[b, a] == n for (a, b), n in sides.items()), (seed, part.words)
        facets = places[corners].mean(axis=1)
        middles = np.array([places[a] + places[b] for a, b in sides]) / 2
        some = np.concatenate([rng.permutation(facets)[:60], rng.permutation(middles)[:60]])
        for p in some:
            vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*p)).Vertex()
            boundary = BRepExtrema_DistShapeShape(vertex, faces_of(shape)).Value()
            assert boundary <= tolerance + 3e-7, (seed, p, boundary, part.words)
        measured += 1
    assert measured >= 0.6 * rounds


def faces_of(shape: TopoDS_Shape) -> TopoDS_Shape:
    """Its faces alone, so that places inside of it have a distance."""
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        builder.Add(compound, explorer.Current())
        explorer.Next()
    return compound


def test_a_corner_within_a_chord_of_another_face():
    # A ring less a bar whose edge leaves the ring 0.004 before it would leave the bar: facets of
    # the ring, 0.001 off it, tell otherwise. The area is by quadrature of the nine faces.
    made = start(0, curved=True)
    assert made is not None
    part, sketch, called, _ = made
    assert part.words == ["SKETCH P0 2D XZ", "SKETCH P1 2D XZ", "CUT"]
    sketch[called[1, "B"]] = 4.1007214076613945
    assert sketch.area == pytest.approx(150.49635625249036, rel=1e-12)


def test_a_block_on_its_edge_upon_a_bar_and_a_cut_of_both():
    # The edge touches the bar's end face and crosses its circle within that plane: places on the
    # chords there were vertices of what is made of the union, 2e-4 beside both.
    sketch, rng = Sketch(), np.random.default_rng(3)
    sketch.run(bar(rng, "A").text)
    sketch["R"], sketch["H"] = 2.0, 5.0
    sketch.run(block(rng, "B", "plain").text)
    sketch["W"], sketch["D"], sketch["H"] = 7.0, 3.0, 2.0
    sketch.run("ROTATE B X 30 FEATURE; MOVE B -0.5 2.37 5; UNION A B INTO U")
    assert sketch.objects["U"]["volume"] == pytest.approx(20 * math.pi + 42, rel=1e-13)
    sketch.run(block(rng, "E", "plain").text)
    sketch["W"], sketch["D"], sketch["H"] = 1.0, 0.9, 20.0
    sketch.run("MOVE E 5 3 0; CUT U E INTO V")
    cut = 0.9 * 2 / math.cos(math.radians(30))
    assert sketch.objects["V"]["volume"] == pytest.approx(20 * math.pi + 42 - cut, rel=1e-13)
    places = np.array([p["at"] for p in sketch.objects["V"]["points"]])
    across = math.sqrt(4 - 0.37**2)
    for x in (2 - across, 2 + across):
        assert np.abs(places - [x, 2.37, 5]).max(axis=1).min() < 1e-14


def test_quadrature_has_the_closed_forms():
    # Two pipes that cross at a right angle, a ring cut by a plane, and a part that OCCT agrees on.
    upright, lying = np.eye(3), np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    wide = turned_about_z((0, 0, 0), 2, 0, -5, 5)
    narrow = moved(turned_about_z((0, 0, 0), 1, 0, -5, 5), lying, np.zeros(3))
    found = measured(joined("CUT", wide, narrow), (0, 0, 0), 7)
    assert found[:2] == pytest.approx([113.503386238209, 167.775060538382], rel=1e-12)
    ring = moved(ring_about_z((0, 0, 0), 2, 0.5), upright, np.zeros(3))
    cut = joined("COMMON", ring, block_of((1.8, -10, -10), (9, 20, 20)))
    assert measured(cut, (1, 1, 1), 9)[0] == pytest.approx(1.29963352327967, rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "change", "volume", "area"),
    [
        # A hole beside the block at once, with no side that crosses another: it is gone.
        ("hole", {"HX": 20.0}, 480.0, 376.0),
        ("pocket", {"HX": 20.0}, 480.0, 376.0),
        # Half out of the block it is a notch.
        ("hole", {"HX": 9.0}, 468.0, 384.0),
        # A boss over the edge has a face below, one beside the block is a body of its own.
        ("boss", {"HX": 9.0}, 504.0, 428.0),
        ("boss", {"HX": 20.0}, 504.0, 432.0),
    ],
)
def test_a_hole_or_boss_that_leaves(kind, change, volume, area):
    sketch = Sketch()
    sketch.run(block(np.random.default_rng(1), "A", kind).text)
    numbers = {"W": 10.0, "D": 8.0, "H": 6.0, "HX": 2.0, "HY": 3.0, "HW": 2.0, "HD": 2.0}
    if kind != "hole":
        numbers["P"] = 6.0 if kind == "boss" else 3.0
    for name, value in {**numbers, **change}.items():
        sketch[name] = value
    assert sketch.volume == pytest.approx(volume, rel=1e-12)
    assert sketch.area == pytest.approx(area, rel=1e-12)
