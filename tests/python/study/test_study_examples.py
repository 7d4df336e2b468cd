"""The examples of studies: a bulb, a propeller blade, a platform; small unless there is time."""

from __future__ import annotations

import importlib.util
import math
import os
import sys
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
    """The Python file of an example, which may import those beside it."""
    spec = importlib.util.spec_from_file_location(f"study_{name}", EXAMPLES / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(EXAMPLES))
    try:
        spec.loader.exec_module(found)
    finally:
        sys.path.pop(0)
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


#: Half of a ball, its centre in the water; mirrored in both planes.
HEMISPHERE = """
    Model info(symmetry = "xy", units = "m"); float r = 5; float h = r*sqrt(0.5);
    AbsPoint O(0, 0, 0); AbsPoint S(0, 0, -r); AbsPoint M(h, 0, -h); AbsPoint E(r, 0, 0);
    Line axis(S, O); Arc quarter(S, M, E);
    RevSurf ball(quarter, axis, 0, PI/2, divisions = {14, 14});
"""


def test_added_mass_of_a_hemisphere():
    """The limits of Hulme (1982), by the ball of its image: 1/2 of the displaced mass.

    The Wave Forces Acting on a Floating Hemisphere Undergoing Forced Periodic Oscillations, Journal
    of Fluid Mechanics 121: heave at infinite frequency and surge at none are those of a ball in
    unbounded water; heave at none is 0.8310.
    """
    capytaine = pytest.importorskip("capytaine")
    capytaine.set_logging("ERROR")
    body = moldloft.loads(HEMISPHERE).to_capytaine(centre=(0, 0, 0))
    mass = 1025 * 2 / 3 * math.pi * 5**3
    assert abs(body.volume * 1025 / mass - 1) < 0.01
    for dof, omega, share in (("Heave", math.inf, 0.5), ("Surge", 0, 0.5), ("Heave", 0, 0.8310)):
        problem = capytaine.RadiationProblem(
            body=body, radiating_dof=dof, omega=omega, water_depth=math.inf, rho=1025
        )
        added = float(capytaine.BEMSolver().solve(problem).added_masses[dof])
        assert abs(added / mass - share) < 0.02, (dof, omega, added / mass)


def test_motions_of_a_float_are_those_of_the_water_in_long_waves():
    """Surge and heave follow the water, pitch the slope, a quarter of a period apart."""
    pytest.importorskip("capytaine")
    waves = module("waves")
    model = moldloft.load(EXAMPLES / "float.sdl")
    periods = [40.0, 60.0]
    found = waves.operators(model, periods, heading=0.0, centre=(0, 0, -6), gyration=(4, 4, 4))
    assert np.abs(found["Heave"] - 1).max() < 1e-3
    assert np.abs(np.abs(found["Surge"]) - 1).max() < 0.012
    assert abs(abs(found["Surge"][1]) - 1) < abs(abs(found["Surge"][0]) - 1)
    slopes = np.array([waves.slope(period) for period in periods])
    assert np.abs(np.abs(found["Pitch"]) / slopes - 1).max() < 0.05
    for dof in ("Sway", "Roll", "Yaw"):
        assert np.abs(found[dof]).max() < 1e-9
    # The order of the periods is kept; waves along y move it in sway and roll alone.
    across = waves.operators(
        model, periods[::-1], heading=math.pi / 2, centre=(0, 0, -6), gyration=(4, 4, 4)
    )
    assert np.allclose(across["Sway"][::-1], found["Surge"], rtol=2e-3)
    assert np.allclose(across["Heave"][::-1], found["Heave"], rtol=1e-3)
    assert np.allclose(np.abs(across["Roll"][::-1]), np.abs(found["Pitch"]), rtol=2e-3)


def test_radiated_and_exciting_energy_agree():
    """Damping in heave of a body round about the vertical from its exciting force (Newman 1962)."""
    capytaine = pytest.importorskip("capytaine")
    capytaine.set_logging("ERROR")
    body = moldloft.load(EXAMPLES / "float.sdl").to_capytaine(centre=(0, 0, -6))
    density, gravity = 1025.0, 9.81
    for omega in (0.6, 1.0):
        common = {"body": body, "omega": omega, "water_depth": math.inf, "rho": density}
        radiated = capytaine.RadiationProblem(radiating_dof="Heave", **common)
        damping = float(capytaine.BEMSolver().solve(radiated).radiation_dampings["Heave"])
        waves = capytaine.DiffractionProblem(wave_direction=0.0, **common)
        solved = capytaine.BEMSolver().solve(waves)
        force = (
            solved.forces["Heave"] + capytaine.bem.airy_waves.froude_krylov_force(waves)["Heave"]
        )
        number, group = omega**2 / gravity, gravity / (2 * omega)
        expected = number * abs(force) ** 2 / (4 * density * gravity * group)
        assert abs(damping / expected - 1) < 0.01, omega


def test_waves(tmp_path):
    """Studies of platform and hull in waves; the first row of each, or all where there is time."""
    pytest.importorskip("capytaine")
    for name in ("platform_waves", "hull_waves"):
        definition = study.read(EXAMPLES / f"{name}.toml")
        (tmp_path / name).mkdir()
        store = tmp_path / name / "s.sqlite"
        table = study.sweep(definition, store, part=(1, 1 if SOAK else 100), processes=1)
        assert table.counts == {"done": len(table)}
        for output in ("heave_24", "surge_24") if "platform" in name else ("heave_8", "pitch_8"):
            assert (np.abs(table.outputs[output] - 1) < 0.25).all()
        # Short waves move neither.
        short = "heave_8" if "platform" in name else "heave_3"
        assert (table.outputs[short] < 0.9).all()


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
