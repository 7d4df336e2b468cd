"""The examples of studies: a bulb, a propeller blade, a platform; small unless there is time."""

from __future__ import annotations

import importlib.util
import math
import os
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

import moldloft
from conftest import ROOT
from moldloft import study

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
EXAMPLES = ROOT / "examples" / "studies"


def module(name: str) -> ModuleType:
    """The Python file of an example."""
    spec = importlib.util.spec_from_file_location(f"study_{name}", EXAMPLES / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def best_of(name: str, tmp_path, evaluations: int, **goal) -> study.Optimum:
    """The optimum, of all evaluations when there is time."""
    definition = study.read(EXAMPLES / f"{name}.toml")
    limit = definition.goal.evaluations if SOAK else evaluations
    definition = replace(
        definition, goal=replace(definition.goal, evaluations=limit, **goal), folder=EXAMPLES
    )
    return study.optimize(definition, tmp_path / "s.sqlite")


def test_bulb(tmp_path):
    """A bulb of radius 1.3 m saves a third of the wave resistance."""
    bulb = module("bulb")
    model = moldloft.load(EXAMPLES / "bulb.sdl")
    # The parabolic hull of the model, whose volume is 4/9 of its box; panels are flat.
    model.set({"radius": 0.3, "bulb_length": 4})
    mesh = model.mesh()
    (hull,) = (patch for patch in mesh.patches if patch.name == "hull")
    corners = mesh.vertices[mesh.faces[hull.start : hull.stop]]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
    volume = 2 * abs((corners.mean(axis=1) * normals)[:, 1].sum())
    assert abs(volume / (4 / 9 * 60 * 6 * 3.75) - 1) < 5e-3
    bare = bulb.resistance(model)
    optimum = {"radius": 1.3, "bulb_length": 9.68, "bulb_x": -0.85, "depth": 2.9}
    model.set(optimum)
    found = bulb.resistance(model)
    assert abs(found["resistance"] - 41.62) < 0.05
    assert found["wave"] < 0.67 * bare["wave"] and found["resistance"] < bare["resistance"]
    if SOAK:
        best = best_of("bulb", tmp_path, 0)
        assert best.converged and best.feasible
        assert best.outputs["resistance"] < found["resistance"] + 0.02


def test_blade_elements_keep_momentum():
    """Thrust of lightly loaded rings is that of their momentum; more is lost than an ideal disc."""
    blade = module("blade")
    r = (blade.EDGES[1:] + blade.EDGES[:-1]) / 2
    chord = np.interp(r, blade.R_R, blade.C_D)
    for pitch in (0.9, 1.1, 1.4):
        for camber in (0.0, 0.02, 0.04):
            for advance in (0.5, 0.7, 0.8):
                found = blade.of_rings(r, pitch + 0 * r, camber + 0 * r, chord, advance)
                load = 8 * found["kt"] / (math.pi * advance**2)
                ideal = 2 / (1 + math.sqrt(1 + load))
                assert 0 < found["efficiency"] < ideal, (pitch, camber, advance)
    # No camber, and each section along its way: no lift, and the drag alone.
    still = blade.of_rings(r, 0.8 + 0 * r, 0 * r, chord, 0.8)
    assert still["lift"] < 0.02 and abs(still["kt"]) < 0.01
    # Fine rings change little.
    edges = np.linspace(0.2, 1, 401)
    fine = (edges[1:] + edges[:-1]) / 2
    coarse = blade.of_rings(r, 1.1 + 0 * r, 0.02 + 0 * r, chord, 0.8)
    many = blade.of_rings(
        fine, 1.1 + 0 * fine, 0.02 + 0 * fine, np.interp(fine, blade.R_R, blade.C_D), 0.8
    )
    assert abs(many["kt"] / coarse["kt"] - 1) < 5e-3


def test_blade(tmp_path):
    """At the thrust of a blade of constant pitch and camber it needs less torque."""
    best = best_of("blade", tmp_path, 60)
    assert abs(best.outputs["kt"] - 0.2) < (1e-6 if SOAK else 5e-3)
    assert best.outputs["lift"] < 0.4 * (1 + 1e-3)
    blade = module("blade")
    r = (blade.EDGES[1:] + blade.EDGES[:-1]) / 2
    chord = np.interp(r, blade.R_R, blade.C_D)
    low, high = 0.8, 1.6
    for _ in range(40):
        pitch = (low + high) / 2
        plain = blade.of_rings(r, pitch + 0 * r, 0.01 + 0 * r, chord, 0.8)
        low, high = (pitch, high) if plain["kt"] < best.outputs["kt"] else (low, pitch)
    if SOAK:
        assert best.outputs["efficiency"] > plain["efficiency"]


def test_platform(tmp_path):
    """The heave period by Capytaine, and the least volume that has 20 s."""
    pytest.importorskip("capytaine")
    heave = module("heave")
    model = moldloft.load(ROOT / "examples" / "platform" / "platform.sdl")
    model.set({"leg_radius": 7, "pontoon_radius": 4.5, "spacing": 90, "draft": 32.5})
    assert abs(heave.heave_period(model) - 20.577) < 5e-3
    if not SOAK:
        return
    # From the model's values, and from a slender platform of deep draught.
    deep = {"leg_radius": 9.5, "pontoon_radius": 3, "spacing": 50, "draft": 40}
    for start in ({}, deep):
        best = best_of("platform", tmp_path, 0, start=start)
        assert best.converged and best.feasible and best.evaluations < 20
        assert abs(best.outputs["volume"] - 35_726.6) < 2
        assert abs(best.outputs["heave_period"] - 20) < 2e-5
        # Slender legs, large pontoons and a wide spacing are at the ends of their ranges.
        ends = [best.inputs[n] for n in ("leg_radius", "pontoon_radius", "spacing")]
        assert np.allclose(ends, [7, 4.5, 90], rtol=1e-6)


def test_fine_hull(tmp_path):
    """Weights on vertices against differences; the area of 400 offsets falls at once."""
    fine = module("fine_hull")
    stated = fine.definition(tmp_path, evaluations=300 if SOAK else 8)
    model = moldloft.load(stated.model)
    found = fine.volume_and_centre(model)
    assert abs(found["volume"][0] - 2 * model.eval("mesh.volume")) < 1e-12
    assert abs(found["lcb"][0] - model.eval("hydrostatics.lcb")) < 1e-3
    for name in ("P7_11.x", "P7_11.y", "P7_11.z", "P2_20.y", "P20_1.z", "P15_20.x"):
        x, h = model.eval(name), 1e-5
        ends = []
        for value in (x + h, x - h):
            model.set({name: value})
            ends.append(fine.volume_and_centre(model))
        model.set({name: x})
        for output, (_, weights) in found.items():
            slope = (ends[0][output][0] - ends[1][output][0]) / (2 * h)
            assert abs(model.vjp(weights, [name])[0] - slope) < 1e-8, (name, output)
    best = study.optimize(stated, tmp_path / "s.sqlite")
    assert best.feasible and best.outputs["area"] < 25.67
    if SOAK:
        assert best.converged and best.evaluations < 250
        assert abs(best.outputs["area"] - 25.0989) < 2e-4
        # Of the shape itself, not of its panels.
        drawn = model.hydrostatics()
        model.set(best.inputs)
        exact = model.hydrostatics()
        assert abs(exact.volume / drawn.volume - 1) < 2e-3
        assert exact.wetted_area < 0.98 * drawn.wetted_area
