"""Calls that work in parallel: each by its name, with a value that can be compared."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import moldloft

HULL = """
    BCurve keel({{0, 0, 0}, {3, 0, -0.5}, {6, 0, 0}});
    BCurve chine({{0, 0, 0.5}, {3, 1.5, 0}, {6, 0, 0.5}});
    BCurve sheer({{0, 0, 1}, {3, 2, 1}, {6, 0, 1}});
    CLoftSurf side({keel, chine, sheer}, divisions = {40, 20});
"""
BODY = "SetBody b(set(sphere({0, 0, 0}, 1)) | set(sphere({0.7, 0, 0}, 0.8)), depth = 4);"


def _digest(values: object) -> str:
    return hashlib.sha256(np.ascontiguousarray(values, dtype=float).tobytes()).hexdigest()


def body() -> str:
    """Facets of a set, and its measures."""
    model = moldloft.loads(BODY)
    return _digest([model.eval("b.volume"), model.eval("b.area")])


def panels() -> str:
    """Panels of a loft."""
    return _digest(moldloft.loads(HULL).mesh().vertices)


def hydrostatics() -> str:
    """Figures by integrals over surfaces."""
    model = moldloft.loads('Model m(symmetry = "y");' + HULL)
    return _digest([model.eval("side.area"), model.hydrostatics(level=0.4).volume])


def points() -> str:
    """Points of a surface in any order."""
    place = np.random.default_rng(1).random((2, 60_000))
    return _digest(moldloft.loads(HULL)["side"](*place))


def nearest() -> str:
    """Nearest points."""
    places = np.random.default_rng(2).random((400, 3)) * [6, 2, 1]
    return _digest(moldloft.loads(HULL)["side"].nearest(places).points)


def fair() -> str:
    """A fair curve within a tolerance."""
    t = np.linspace(0, 1, 40)
    return _digest(moldloft.fair(np.c_[10 * t, np.sin(3 * t), 0 * t], 0.02).control_points)


def values() -> str:
    """Values of an implicit set at many points."""
    from moldloft.implicit import sphere

    return _digest(sphere((0, 0, 0), 1)(np.random.default_rng(3).random((40_000, 3))))


def files() -> str:
    """Patches as a file of exact faces."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hull.igs"
        moldloft.loads(HULL).write(path)
        return hashlib.sha256(path.read_bytes()).hexdigest()


JOBS: dict[str, Callable[[], str]] = {
    job.__name__: job for job in (body, panels, hydrostatics, points, nearest, fair, values, files)
}
"""The calls by their names."""


def run(name: str) -> str:
    """The value of a call."""
    return JOBS[name]()
