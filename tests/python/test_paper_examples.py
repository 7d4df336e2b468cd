"""The examples of the Relational Geometry paper: closed for every draw of their parameters, and known numbers."""

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
