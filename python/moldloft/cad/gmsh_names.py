"""The names of faces in Gmsh, which reads those of solids and of single faces only."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moldloft.cad.part21 import StepText, _letters

__all__ = ["names_of_faces"]

_NEAR = 1e-5
"""Distance relative to the size below which corners coincide."""


def names_of_faces(gmsh: Any, text: str, unit: float = 1.0) -> dict[int, str]:
    """Names of the faces in a Gmsh model of an exported STEP file, by tag.

    Faces are matched by their corners, in the order of the file; an unmatched face of Gmsh has no
    name.

    Parameters
    ----------
    gmsh
        The module, with the file's shapes as its model.
    text
        The file.
    unit
        The unit of the file in that of Gmsh's model.
    """
    known = [(name, unit * corners) for name, corners in _corners_in_file(text)]
    tags = [tag for _, tag in gmsh.model.getEntities(2)]
    if not known or not tags:
        return {}
    places = np.concatenate([corners for _, corners in known])
    near = _NEAR * float(np.ptp(places, axis=0).max()) if len(places) else 0.0
    # At a pole two vertices of a face may be in one place.
    known = [(name, _distinct(corners, near)) for name, corners in known]
    by_count: dict[int, list[int]] = {}
    for k, (_, corners) in enumerate(known):
        by_count.setdefault(len(corners), []).append(k)
    named = {}
    for position, tag in enumerate(tags):
        corners = _distinct(_corners_in_gmsh(gmsh, tag), near)
        free = by_count.get(len(corners), [])
        # The order is that of the file but where bodies and sheets are mixed.
        order = [position, *free] if position in free else free
        for k in order:
            if _alike(known[k][1], corners, near):
                named[tag] = known[k][0]
                free.remove(k)
                break
    return named


def _distinct(corners: NDArray[np.float64], near: float) -> NDArray[np.float64]:
    kept: list[NDArray[np.float64]] = []
    for corner in corners:
        if all(np.linalg.norm(corner - other) > near for other in kept):
            kept.append(corner)
    return np.array(kept).reshape(-1, 3)


def _alike(a: NDArray[np.float64], b: NDArray[np.float64], near: float) -> bool:
    apart = np.linalg.norm(a[:, None] - b[None], axis=-1)
    return bool(not len(a) or (apart.min(axis=0).max() <= near and apart.min(axis=1).max() <= near))


def _corners_in_file(text: str) -> list[tuple[str, NDArray[np.float64]]]:
    step = StepText(text)
    words = dict(re.findall(r"#(\d+)\s*=\s*ADVANCED_FACE\s*\(\s*'((?:[^']|'')*)'", text))
    found = []
    for face in step.faces:
        name = _letters(words.get(str(face), ""))
        open_, seen = list(step.references[face][:-1]), set()
        while open_:
            number = open_.pop()
            if number in seen:
                continue
            seen.add(number)
            body = step.entities[number]
            if body.startswith(("FACE_", "EDGE_LOOP", "ORIENTED_EDGE", "VERTEX_LOOP")):
                open_.extend(step.references[number])
            elif body.startswith("EDGE_CURVE"):
                open_.extend(step.references[number][:2])
        corners = [
            _place(step, number) for number in seen if step.entities[number].startswith("VERTEX_P")
        ]
        found.append((name, np.array(corners).reshape(-1, 3)))
    return found


def _place(step: StepText, vertex: int) -> list[float]:
    (point,) = step.references[vertex]
    numbers = step.entities[point].rpartition("(")[2]
    return [float(x) for x in numbers.rstrip(") ").split(",")]


def _corners_in_gmsh(gmsh: Any, tag: int) -> NDArray[np.float64]:
    around = gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False, recursive=True)
    points = sorted({abs(n) for dim, n in around if dim == 0})
    return np.array([gmsh.model.getValue(0, n, []) for n in points]).reshape(-1, 3)
