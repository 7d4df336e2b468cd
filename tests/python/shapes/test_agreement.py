"""One number for each question: volume, area and centroid of generated models by all ways to them.

The ways are integrals over the shape with their bounds, the model's own STEP file in OCCT, panels
of the model's divisions and of a tolerance, and the set where there is one. Each pair agrees
within the sum of its bounds. `MOLDLOFT_SOAK=1` draws hundreds of models.
"""

from __future__ import annotations

import math
import os
import random
import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import moldloft
import random_models
import random_sets

pytest.importorskip("OCP")

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

#: Relative accuracy of OCCT's integrals over faces of its own splines.
OCCT = 1e-6


@dataclass
class Figures:
    """Volume, area and centroid by one way, with the bounds of their errors; NaN is no bound."""

    way: str
    volume: float
    area: float
    centroid: NDArray[np.float64]
    off: tuple[float, float, float]


@dataclass
class Case:
    """A model, the metres of its unit, and figures that are known otherwise."""

    model: moldloft.Model
    unit: float = 1.0
    known: tuple[Figures, ...] = ()


def hull(seed: int, folder: Path) -> Case:
    """Hulls, pontoons, columns and wings, closed; halves and quarters among them."""
    return Case(moldloft.loads(random_models.drawn(seed).text))


def body_of_set(seed: int, folder: Path) -> Case:
    """A body of a set, and the set."""
    model = moldloft.loads(random_sets.program(seed))
    mass = model["s"].value.mass()
    low, high = mass.volume_bracket
    known = Figures(
        "set", mass.volume, math.nan, np.array(mass.centroid), (high - low, math.nan, math.nan)
    )
    return Case(model, known=(known,))


def sketch(seed: int, folder: Path) -> Case | None:
    """A part of a sketch, with the sketch's own figures; every other one has round faces."""
    import sketch_parts

    part = sketch_parts.drawn(np.random.default_rng([seed, 7]), curved=bool(seed % 2))
    (folder / "part.skt").write_text(f"{part.text}\nUSING {part.name}\n")
    source = folder / "part.sdl"
    source.write_text('Model info(units = "m t"); Sketch s("part.skt");\n')
    try:
        model = moldloft.load(source)
        known = Figures(
            "sketch",
            model.eval("s.volume"),
            model.eval("s.area"),
            np.array(model.eval("s.centroid")),
            (0.0, 0.0, 0.0),
        )
    except moldloft.Error as error:
        assert re.search("leaves nothing|touch|nearly meet|unknown-name", str(error)), error
        return None
    return Case(model, known=(known,))


def imported(seed: int, folder: Path) -> Case:
    """A part of another program with trimmed faces, and OCCT's figures of it."""
    import occt_parts
    from moldloft.cad.importing import program

    name = list(occt_parts.PARTS)[seed % len(occt_parts.PARTS)]
    shape = occt_parts.PARTS[name](random.Random(seed))
    text, _ = program(occt_parts.write(folder / "part.step", "MM", shape), units="mm")
    return Case(moldloft.loads(text), 1e-3, (by_occt("the file's", shape, 1e-6),))


FAMILIES: tuple[Callable[[int, Path], Case | None], ...] = (hull, body_of_set, sketch, imported)


def by_occt(way: str, shape: object, gap: float) -> Figures:
    """Integrals of OCCT over a shape whose faces meet within a gap."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    solid, skin = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, solid, 1e-9, False, False)
    BRepGProp.SurfaceProperties_s(shape, skin, 1e-8)
    volume, area, c = solid.Mass(), skin.Mass(), solid.CentreOfMass()
    size = math.sqrt(area)
    off = (gap * area + OCCT * volume, 10 * gap * size + OCCT * area)
    return Figures(
        way,
        volume,
        area,
        np.array([c.X(), c.Y(), c.Z()]),
        (*off, off[0] / volume * size + gap),
    )


def by_step(case: Case, folder: Path) -> Figures | None:
    """The model's own STEP file; None where its faces are triangles, which the export reports."""
    from cad_reading import read

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        (path,) = case.model.write(folder / "own.step")
    if any(remark.id == "as-triangles" for remark in case.model.export_remarks):
        return None
    stated = re.search(
        r"UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\(([^)]*)\)", path.read_text()
    )
    assert stated
    found = read(path, unit=case.unit, accuracy=1e-6, gauss=True)
    assert found.valid and found.closed == found.shells > 0
    return by_occt("STEP", found.shape, float(stated[1]))


def by_integrals(model: moldloft.Model) -> Figures:
    """The hydrostatics of the model far under water, of both sides."""
    top = float(model.mesh().vertices[:, 2].max())
    found = model.hydrostatics(level=top + 1, accuracy=1e-8)
    centroid = [found.lcb or 0.0, found.tcb or 0.0, found.vcb or 0.0]
    bounds = (found.bounds.get(name, math.nan) for name in ("volume", "wetted_area", "vcb"))
    return Figures("integrals", found.volume, found.wetted_area, np.array(centroid), tuple(bounds))


def triangles(model: moldloft.Model, tolerance: float | None) -> NDArray[np.float64]:
    mesh = model.mesh(whole=True, tolerance=tolerance)
    assert mesh.closed
    halves = np.vstack([mesh.faces[:, [0, 1, 2]], mesh.faces[:, [0, 2, 3]]])
    return mesh.vertices[halves]


def by_panels(model: moldloft.Model, tolerance: float | None, off: float) -> Figures:
    """Panels within a distance of the shape, summed here."""
    corners = triangles(model, tolerance)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = float(np.linalg.norm(cross, axis=1).sum()) / 2
    cones = np.einsum("ij,ij->i", cross, corners.sum(axis=1)) / 18
    volume = float(cones.sum())
    centroid = (cones[:, None] * corners.sum(axis=1)).sum(axis=0) / 4 / volume
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    slack = off * area + 1e-9 * abs(volume)
    return Figures(
        f"panels to {tolerance}",
        volume,
        area,
        centroid,
        # A turn of 0.5 along a panel shortens an arc by a hundredth, in either direction.
        (slack, 0.02 * area, slack / abs(volume) * size),
    )


def agree(one: Figures, other: Figures, size: float, what: str) -> list[str]:
    """Pairs of figures that differ by more than their bounds."""
    pairs = (
        ("volume", one.volume, other.volume),
        ("area", one.area, other.area),
        ("centroid", one.centroid, other.centroid),
    )
    scales = (size**3, size**2, size)
    faults = []
    for k, (name, a, b) in enumerate(pairs):
        bound = one.off[k] + other.off[k]
        if math.isnan(bound) or np.isnan(a).any() or np.isnan(b).any():
            continue
        apart = float(np.abs(np.subtract(a, b)).max())
        if apart > bound + 1e-11 * scales[k]:
            faults.append(f"{what}: {name} {one.way} {a}, {other.way} {b}: {apart} > {bound}")
    return faults


def folds(model: moldloft.Model) -> bool:
    """True if a plane patch turns back over itself, as rulings between crooked sides do.

    Its area as a surface counts the fold three times; the face of a file is what it covers.
    """
    mesh = model.mesh()
    for patch in mesh.patches:
        if patch.name not in model.objects or model[patch.name].kind != "RuledSurf":
            continue
        a, b, c, d = (mesh.vertices[k] for k in mesh.faces[patch.start : patch.stop].T)
        normals = np.cross(c - a, d - b)
        covered = np.linalg.norm(normals.sum(axis=0))
        out = normals.sum(axis=0) / covered
        plane = (
            np.abs(np.linalg.norm(normals, axis=1) - np.abs(normals @ out)).max() < 1e-9 * covered
        )
        if plane and model[patch.name].area > (1 + 1e-9) * covered / 2:
            return True
    return False


def faults_of(case: Case, folder: Path, what: str) -> list[str]:
    """Disagreements of a model's ways."""
    model = case.model
    size = float(np.ptp(model.mesh(whole=True).vertices, axis=0).max())
    tolerance = 1e-3 * size
    ways = [by_integrals(model), *case.known, by_panels(model, tolerance, tolerance)]
    step = by_step(case, folder)
    if step and folds(model):
        step.area = math.nan
    ways += [step] if step else []
    return [line for a, b in combinations(ways, 2) for line in agree(a, b, size, what)]


@pytest.mark.parametrize("seed", range(100) if SOAK else [0, 1, 3, 4])
@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.__name__)
def test_all_ways_agree(
    family: Callable[[int, Path], Case | None], seed: int, tmp_path: Path
) -> None:
    case = family(seed, tmp_path)
    if case is not None:
        assert not faults_of(case, tmp_path, f"{family.__name__} {seed}")
