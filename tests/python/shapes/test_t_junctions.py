"""Plates beside a taller one: edges on parts of its edge, by a `Join` or between its beads.

The models are random. The mesh is judged by its faces alone: each edge that two plates share
belongs to two faces, which traverse it in opposite directions.
"""

from __future__ import annotations

import os

import numpy as np
import pytest

import moldloft
from mesh_edges import edge_uses

CASES = 400 if os.environ.get("MOLDLOFT_SOAK") else 12


def numbers(point: np.ndarray) -> str:
    return "{" + ", ".join(repr(float(x)) for x in point) + "}"


def plates(rng: np.random.Generator) -> tuple[str, int]:
    """A plate beside two to five lower ones, in any direction and order of declaration."""
    count = int(rng.integers(2, 6))
    foot, head, aside = rng.uniform(-2, 2, 3), rng.uniform(-2, 2, 3), rng.uniform(-3, 3, 3)
    cut = ["0", *(f"t{k}" for k in range(1, count)), "1"]
    lines = [f"param float t{k} = {k / count} in [0, 1];" for k in range(1, count)]
    lines.append(f"AbsPoint F({numbers(foot)[1:-1]}); AbsPoint H({numbers(head)[1:-1]});")
    lines.append("Line edge(F, H);")
    lines += [f"AbsBead m{k}(edge, {cut[k]});" for k in range(count + 1)]
    between_beads = rng.random() < 0.5
    lines.append(f"Line far({numbers(foot + aside)}, {numbers(head + aside)});")
    divisions = count * int(rng.integers(2, 5))
    surfaces = [f"RuledSurf tall(edge, far, divisions = {{{divisions}, 2}});"]
    for k in range(count):
        ends = [k, k + 1] if rng.random() < 0.5 else [k + 1, k]
        places = [f"{numbers(foot)} + {numbers(head - foot)} * {cut[end]}" for end in ends]
        near = [f"m{end}" for end in ends] if between_beads else places
        away = [f"{point} - {numbers(aside)}" for point in places]
        surfaces.append(
            f"Line a{k}({near[0]}, {near[1]}); Line b{k}({away[0]}, {away[1]}); "
            f"RuledSurf low{k}(a{k}, b{k}, divisions = {{{0 if k else 3}, 2}});"
        )
    lines += [surfaces[k] for k in rng.permutation(count + 1)]
    for k in [] if between_beads else rng.permutation(count):
        ends = [k, k + 1] if rng.random() < 0.5 else [k + 1, k]
        lines.append(f"SubCurve part{k}(m{ends[0]}, m{ends[1]});")
        sides = [f"low{k}.v0", f"part{k}"]
        lines.append(f"Join j{k}({', '.join(sides[:: 1 if rng.random() < 0.5 else -1])});")
    return "\n".join(lines), count


@pytest.mark.parametrize("seed", range(CASES))
def test_plates_meet_along_the_edge(seed: int) -> None:
    rng = np.random.default_rng(seed)
    text, count = plates(rng)
    model = moldloft.loads(text)
    faces = model.mesh().faces
    for _ in range(4):
        mesh = model.mesh()
        # An open sheet may turn its other side out.
        assert np.array_equal(np.sort(mesh.faces), np.sort(faces)), "the numbering stays"
        edges, uses = edge_uses(mesh.faces)
        assert uses.max() == 2
        shared = set(edges[uses == 2].ravel())
        foot, head = (np.array([model[n].x, model[n].y, model[n].z]) for n in "FH")
        along = (mesh.vertices - foot) @ (head - foot) / ((head - foot) @ (head - foot))
        off = np.linalg.norm(mesh.vertices - foot - along[:, None] * (head - foot), axis=1)
        on_edge = np.flatnonzero(off < 1e-9)
        # All vertices on the edge are shared, none is there twice, and the beads are among them.
        assert set(on_edge) <= shared
        assert len(np.unique(np.round(along[on_edge], 9))) == len(on_edge)
        for k in range(count + 1):
            assert np.abs(along[on_edge] - model.eval(f"m{k}.t")).min() < 1e-12
        cuts = np.sort(rng.uniform(0.02, 0.98, count - 1))
        model.set({f"t{k}": float(cuts[k - 1]) for k in range(1, count)})
