"""Measures of ordinary models against panels that are cut and summed by NumPy."""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

import moldloft
import random_models

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
FIGURES = ("volume", "wetted_area", "waterplane_area")


def triangles(model):
    """The panels and their images in the planes of symmetry as triangles, (n, 3, 3)."""
    mesh = model.mesh()
    faces = mesh.faces
    corners = mesh.vertices[np.vstack([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])]
    for axis in model.symmetry:
        image = corners.copy()
        image[:, :, "xyz".index(axis)] *= -1
        corners = np.vstack([corners, image[:, ::-1]])
    return corners


def wet_parts(corners, level):
    """The parts of triangles below a level, as triangles."""
    depth = corners[:, :, 2] - level
    wet = depth < 0
    count = wet.sum(1)
    parts = [corners[count == 3]]
    for first in range(3):
        for lone in (True, False):
            # One corner that is wet, or one that is dry: it is cut off at the level.
            chosen = (count == (1 if lone else 2)) & (wet[:, first] == lone)
            p = np.roll(corners[chosen], -first, axis=1)
            d = np.roll(depth[chosen], -first, axis=1)
            s, t = d[:, 0] / (d[:, 0] - d[:, 1]), d[:, 0] / (d[:, 0] - d[:, 2])
            a = p[:, 0] + s[:, None] * (p[:, 1] - p[:, 0])
            b = p[:, 0] + t[:, None] * (p[:, 2] - p[:, 0])
            if lone:
                parts.append(np.stack([p[:, 0], a, b], 1))
            else:
                parts += [np.stack([a, p[:, 1], p[:, 2]], 1), np.stack([a, p[:, 2], b], 1)]
    return np.concatenate(parts)


def under(corners, level):
    """Volume, skin and water plane below a level: exact for triangles that close."""
    p = wet_parts(corners, level)
    a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    up = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    skin = 0.5 * np.linalg.norm(np.cross(a, b), axis=1).sum()
    return np.array([(up * (p[:, :, 2].mean(1) - level)).sum(), skin, -up.sum()])


def attitudes(rng, drawn):
    """Level, heel and trim: upright, a seaway, anywhere."""
    for heel, trim in ((0, 0), (0.3, 0.03), (3, 0.2)):
        yield rng.uniform(drawn.low, drawn.high), rng.uniform(-heel, heel), rng.uniform(-trim, trim)


def into_water(heel, trim):
    """The rows: along, across and out of the water, in the body's axes."""
    s, c, st, ct = math.sin(heel), math.cos(heel), math.sin(trim), math.cos(trim)
    return np.array([[ct, -st * s, st * c], [0, c, s], [-st, -ct * s, ct * c]])


@pytest.mark.parametrize("seed", range(1000 if SOAK else 10))
def test_measures_against_finer_and_finer_panels(seed):
    drawn = random_models.drawn(seed)
    model = moldloft.loads(drawn.text)
    model.check()
    assert not model.diagnostics and not model.junctions()
    meshes = [triangles(moldloft.loads(random_models.drawn(seed, f).text)) for f in (4, 8, 16)]
    rng = np.random.default_rng(seed + 10**6)
    for level, heel, trim in attitudes(rng, drawn):
        row = model.hydrostatics(level=level, heel=heel, trim=trim)
        assert row.open_edges == 0 and abs(row.closure_error) < 1e-6
        axes = into_water(heel, trim)
        panels = np.array([under(p @ axes.T, level) for p in meshes])
        panels[:, [0, 2]] *= np.sign(panels[-1, 0]) or 1.0
        # Errors of panels fall with the square of their size, but where corners lie between them.
        limit = panels[2] + (panels[2] - panels[1]) / 3
        doubt = abs(panels[2] - panels[1]) + 0.2 * abs(panels[1] - panels[0])
        for figure, near, off in zip(FIGURES, limit, doubt, strict=True):
            found = getattr(row, figure) or 0.0
            allowed = off + 1e-6 * abs(near) + row.bounds.get(figure, 0.0) + 1e-9
            assert abs(found - near) <= allowed, (figure, found, near, level, heel, trim)


@pytest.mark.parametrize("seed", range(200 if SOAK else 5))
def test_derivatives_equal_differences(seed):
    drawn = random_models.drawn(seed)
    model = moldloft.loads(drawn.text)
    level = np.random.default_rng(seed + 10**7).uniform(drawn.low, drawn.high)
    row = model.hydrostatics(level=level, by=["w"], accuracy=1e-9)
    step = 1e-5
    sides = []
    for w in (1 - step, 1 + step):
        model.set({"w": w})
        sides.append(model.hydrostatics(level=level, accuracy=1e-10))
    for figure in FIGURES:
        low, high = (getattr(side, figure) for side in sides)
        scale = max(abs(getattr(row, figure)), 1e-3)
        difference = (high - low) / (2 * step)
        assert row.derivatives[figure]["w"] == pytest.approx(difference, abs=1e-7 * scale), figure


@pytest.mark.parametrize("seed", range(100 if SOAK else 5))
def test_sections_add_up_to_the_volume(seed):
    drawn = random_models.drawn(seed)
    model = moldloft.loads(drawn.text)
    level = np.random.default_rng(seed + 10**6).uniform(drawn.low, drawn.high)
    row = model.hydrostatics(level=level)
    along = triangles(model)[:, :, 0]
    low, length = along.min(), np.ptp(along)
    sums = []
    for count in (500, 2000):
        stations = low + (np.arange(count) + 0.5) / count * length
        areas = model.section_areas(stations, [level])[:, 0] * length / count
        sums.append((areas.sum(), (areas * stations).sum()))
    (coarse, _), (volume, moment) = sums
    # Columns begin with an upright tangent: the error falls with the power 1.5 there.
    assert volume == pytest.approx(row.volume, abs=abs(volume - coarse) + 1e-5 * row.volume)
    assert moment / volume == pytest.approx(row.lcb, abs=1e-3 * length)
