# ruff: noqa: E501 -- programs of one line
"""Hanging interfaces of blocks whose counts divide each other, against the cuts that made them."""

from __future__ import annotations

import os
import random
import re

import pytest

import moldloft
from test_grid_blocks import MAP

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def pair(rng: random.Random, curved: bool) -> tuple[str, list[int], list[int]]:
    """Two blocks that meet at u = 1/2, of coarse and fine cells; the cells of each along v and w."""
    coarse = [rng.randint(1, 4), rng.randint(1, 4)]
    ratio = rng.choice([(2, 1), (1, 2), (2, 2), (3, 1), (2, 3)])
    fine = [n * r for n, r in zip(coarse, ratio, strict=True)]
    if rng.random() < 0.3:
        # Finer along one axis, coarser along the other.
        coarse[1], fine[1] = fine[1], coarse[1]
    text = MAP if curved else re.sub(r"return \{.*?\};", "return {u, v, w};", MAP, count=1)
    for number, (cells, low) in enumerate(((coarse, 0.0), (fine, 0.5))):
        order = [1, 2, 3]
        rng.shuffle(order)
        signs = [rng.choice((1, -1)) for _ in range(3)]
        size = [0, 0, 0]
        for axis, n in enumerate((rng.randint(1, 3), *cells)):
            size[order[axis] - 1] = n + 1
        along = ", ".join(str(s * o) for s, o in zip(signs, order, strict=True))
        text += f"block b{number}[{size[0]},{size[1]},{size[2]}]; fill(b{number}, {low}, {low + 0.5}, 0, 1, 0, 1, {along});\n"
    return text, coarse, fine


@pytest.mark.parametrize("seed", range(200 if SOAK else 10))
def test_faces_of_unequal_cells_are_listed(seed: int) -> None:
    rng = random.Random(seed)
    curved = rng.random() < 0.5
    text, coarse, fine = pair(rng, curved)
    model = moldloft.loads(text + "string report = interfaces(b0, b1);")
    report = str(model["report"]).splitlines()
    found = [line for line in report if " ~ " in line]
    if sorted(coarse) == sorted(fine) and coarse == fine:
        assert not found and any(" = " in line for line in report)
        return
    assert len(found) == 1, report
    match = re.fullmatch(
        r"b0 .* ~ b1 .*: hanging, (\d+) x (\d+) and (\d+) x (\d+) cells, up to (\S+) apart",
        found[0],
    )
    assert match, found
    a, b, c, d = (int(match[k]) for k in range(1, 5))
    assert (a, c, b, d) in {
        (coarse[0], fine[0], coarse[1], fine[1]),
        (coarse[1], fine[1], coarse[0], fine[0]),
    }
    gap = float(match[5])
    # Facets of a curved face differ; on a plane one there is no gap.
    assert gap < 0.1 and (curved or gap < 1e-12)
    # The other five faces of each are boundaries, and the two that meet are not listed again.
    assert len(report) == 11
    for call in (
        'write_su2("m", b0, b1)',
        'write_gmsh("m", b0, b1)',
        'write_polymesh("m", b0, b1)',
        'write_nmf("m", b0, b1)',
    ):
        with pytest.raises(moldloft.ModelError, match=r"are one face, of .* cells"):
            moldloft.loads(text + call + ";")
    # CGNS has boundaries there, which is said.
    said = {d.id for d in moldloft.loads(text + 'write_cgns("m", b0, b1);').diagnostics}
    assert "not-joined" in said or curved


def test_two_fine_blocks_on_a_coarse_one() -> None:
    """In the plane: the coarse edge is shared by two, and by one beside a free rest."""
    text = """surface a[3, 5], b[2, 5], c[2, 5];
for (j = 1:5) { a[, j] = {uniform(0, 2, 3), 2*(j - 1), 0}; b[, j] = {uniform(2, 3, 2), j - 1, 0}; c[, j] = b[, j] + {0, 4, 0}; }
string all = interfaces(a, b, c), half = interfaces(a, b);
"""
    model = moldloft.loads(text)
    lines = str(model["all"]).splitlines()
    assert "a im [3,1:3] ~ b i1 [1,1:5]: hanging, 2 and 4 cells, up to 0.000e0 apart" in lines
    assert "a im [3,3:5] ~ c i1 [1,1:5]: hanging, 2 and 4 cells, up to 0.000e0 apart" in lines
    assert not any(line.startswith("a im [3,1:5]") for line in lines)
    half = str(model["half"]).splitlines()
    assert "a im [3,1:5]: without a name" in half and sum(" ~ " in line for line in half) == 1


def test_other_counts_and_gaps_are_no_hanging_interfaces() -> None:
    text = """surface a[3, 4], b[2, 3]; for (j = 1:4) a[, j] = {uniform(0, 2, 3), 2*(j - 1), 0}; for (j = 1:3) b[, j] = {uniform(2, 3, 2), 3*(j - 1), 0};
string one = interfaces(a, b), two = interfaces(a[, 1:3], b*{1, 2/3, 1} + {1e-6, 0, 0});
"""
    model = moldloft.loads(text)
    assert "~" not in str(model["one"]) and "~" not in str(model["two"])
    assert "not-joined" in {d.id for d in model.diagnostics}
    # They are listed with their distance.
    apart = (
        r"b i1 \[1,1:3\]: not joined, 4 x 2 and 3 x 2 points, up to (0\.0+e0|\d\.\d+e-1\d) apart"
    )
    assert re.search(r"a im \[3,1:4\] \| " + apart, str(model["one"])), model["one"]
    assert re.search(r" \| .* points, up to 1\.0+e-6 apart", str(model["two"])), model["two"]
