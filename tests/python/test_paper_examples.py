"""The examples of the Relational Geometry paper: closed for every draw, and known numbers."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest

import moldloft

EXAMPLES = Path(__file__).parents[2] / "examples"
SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

#: Name, file, draws of a whole run, planes through which an open edge may go.
CASES = [
    ("wing", "wing/wing.sdl", 1000, "y"),
    ("wingbody", "wingbody/wingbody.sdl", 1000, "y"),
    ("platform", "platform/platform.sdl", 10_000, "xyz"),
    ("yacht", "sailboat/yacht.sdl", 1000, "yz"),
    ("submarine", "submarine/submarine.sdl", 1000, "y"),
    ("propeller", "propeller/propeller.sdl", 1000, ""),
]


def _open_edges(mesh: moldloft.Mesh) -> np.ndarray:
    """The panel edges with a panel on one side only, (n, 2)."""
    faces = np.asarray(mesh.faces)
    ends = np.concatenate([faces[:, [k, (k + 1) % 4]] for k in range(4)])
    ends = np.sort(ends[ends[:, 0] != ends[:, 1]], axis=1)
    edges, count = np.unique(ends, axis=0, return_counts=True)
    assert count.max() <= 2, "an edge with more than two panels"
    return edges[count == 1]


@pytest.mark.parametrize(("name", "path", "draws", "planes"), CASES, ids=[c[0] for c in CASES])
def test_every_draw_builds_closed(name: str, path: str, draws: int, planes: str) -> None:
    model = moldloft.load(EXAMPLES / path)
    model.check()
    start = model.mesh()
    rng = np.random.default_rng(1995)
    for _ in range(draws if SOAK else max(draws // 100, 12)):
        values = {p.name: rng.uniform(p.low, p.high) for p in model.params.values()}
        model.set(values)
        errors = [d for d in model.diagnostics if d.is_error]
        assert not errors, f"{values}: {errors[0]}"
        mesh = model.mesh()
        # The connectivity is that of the first: every shared vertex is one vertex.
        assert np.array_equal(mesh.faces, start.faces), values
        rim = mesh.vertices[_open_edges(mesh)].reshape(-1, 3)
        on_planes = np.zeros(len(rim), bool)
        for plane in planes:
            on_planes |= rim[:, "xyz".index(plane)] == 0.0
        assert on_planes.all(), f"{values}: open at {rim[~on_planes][:3]}"


def _platform_volume(radius: float, pontoon: float, spacing: float, draft: float) -> float:
    """Four legs and four pontoons between them, without the pieces inside the legs."""
    from scipy.integrate import quad

    def inside(angle: float) -> float:
        # The pontoon's section is cut in strips at y = pontoon sin(angle); each ends on the leg.
        y = pontoon * math.sin(angle)
        length = spacing - 2 * math.sqrt(radius**2 - y**2)
        return 2 * (pontoon * math.cos(angle)) ** 2 * length

    strip, _ = quad(inside, -math.pi / 2, math.pi / 2, epsabs=1e-12, epsrel=1e-12)
    return 4 * math.pi * radius**2 * draft + 4 * strip


def test_platform_volume_is_its_integral() -> None:
    model = moldloft.load(EXAMPLES / "platform/platform.sdl")
    names = ("leg_radius", "pontoon_radius", "spacing", "draft")
    variants = [{}] + [{name: model.params[name].high} for name in names]
    start = {name: model.params[name].value for name in names}
    for variant in variants:
        values = {**start, **variant}
        model.set(values)
        exact = _platform_volume(*(values[name] for name in names))
        ours = model.hydrostatics().volume
        assert abs(ours - exact) < 1e-2 * exact, (variant, ours, exact)


def _unrolled(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, the length along the circle from the top to starboard, and the radius."""
    radius = np.hypot(points[..., 1], points[..., 2])
    return points[..., 0], radius * np.arctan2(points[..., 1], points[..., 2]), radius


def test_propeller_sections_are_those_of_the_data_sheet() -> None:
    model = moldloft.load(EXAMPLES / "propeller/propeller.sdl")
    diameter = model["diameter"]
    columns = [
        np.asarray(model.eval(name)) for name in ("r_R", "P_D", "c_D", "t_D", "f_D", "s_deg")
    ]
    limit = 1e-6 * diameter
    for k in range(13):
        at, pitch, chord, thickness, camber, skew = (float(column[k]) for column in columns)
        foil = model["one.root.foil" if k == 0 else f"one.s[{k + 1}].foil"]
        tail, nose = foil(0.0), foil(0.5)
        x, y, radius = _unrolled(np.array([tail, nose]))
        assert np.abs(radius - at * diameter / 2).max() < limit
        along = np.array([x[0] - x[1], y[0] - y[1]])
        length = float(np.hypot(*along))
        assert abs(length - chord * diameter) < limit
        slope = along[0] / -along[1]
        assert abs(math.pi * at * slope - pitch) < 1e-6
        middle = -(y[0] + y[1]) / 2 / radius[0]
        assert abs(middle - math.radians(skew)) * radius[0] < limit
        # Both sides at the same place along the chord: their middle is the mean line.
        s = np.sqrt(np.array([0.45, 0.51533]))
        back, face = foil((1 - s) / 2), foil((1 + s) / 2)
        across = np.array([along[1], -along[0]]) / length
        (bx, by, _), (fx, fy, _) = _unrolled(back), _unrolled(face)
        thick = np.hypot(bx - fx, by - fy)
        assert abs(thick[0] - thickness * diameter) < limit
        mean = np.array([(bx + fx) / 2 - x[1], (by + fy) / 2 - y[1]])
        assert abs(abs(across @ mean)[1] - camber * diameter) < limit


def test_wing_corners_lie_where_the_laws_say() -> None:
    model = moldloft.load(EXAMPLES / "wing/wing.sdl")
    for spanwise in (0.0, 1.0):
        for chordwise in (0.0, 1.0):
            model.set({"spanwise": spanwise, "chordwise": chordwise})
            grid = np.asarray(model["upper"].grid(21, 25))
            v = np.linspace(0, 1, 25)
            law = v + spanwise * ((1 - np.cos(np.pi * v)) / 2 - v)
            half_span = model["half_span"]
            assert np.abs(grid[:, :, 1] - half_span * law).max() < 1e-14 * half_span
            t = np.linspace(0, 1, 21)
            t = t + chordwise * (np.sin(np.pi * t / 2) - t)
            assert np.abs(grid[:, 0, 0] - model["root_chord"] * t**2).max() < 1e-2
