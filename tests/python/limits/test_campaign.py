"""A share of the campaigns: every reader, every public callable; and what the long ones found."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest

import moldloft
from campaign import SECONDS, campaign
from moldloft import fairing, grids, implicit, kinds, offsets, overlays
from moldloft.spelling import nearest

pytest.importorskip("resource", reason="limits of a process")
pytest.importorskip("meshio")
pytest.importorskip("ezdxf")

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

FLAT = """AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 1); AbsPoint C(0, 1, 0.3); AbsPoint D(2, 1, 0);
Line l(A, B); Line m(C, D); RuledSurf s(l, m);"""
HULL = (Path(__file__).parents[3] / "examples" / "sailboat" / "hull.sdl").read_text()


@pytest.mark.skipif(sys.platform != "linux", reason="limits of address space")
@pytest.mark.parametrize(
    ("kind", "quick", "long"),
    [
        ("readers", 700, 10**6),
        ("calls", 1000, 10**5),
        ("programs", 300, 10**5),
        ("sets", 12, 10**5),
        ("cad", 8, 10**4),
    ],
)
def test_nothing_ends_the_process_or_raises_another_error(kind: str, quick: int, long: int) -> None:
    if kind == "cad":
        pytest.importorskip("OCP")
    # A development build takes several times as long for bodies of sets.
    slow = 6 if kind == "sets" and not SOAK else 1
    found = campaign(kind, 0, long if SOAK else quick, seconds=slow * SECONDS.get(kind, 10))
    assert found.faults == [], "\n".join(found.faults)
    assert found.done + found.refused == (long if SOAK else quick)
    # Both happen, or the cases say nothing.
    assert found.done > 2 if quick < 100 else min(found.done, found.refused) > 50
    assert found.peak < 2048


# What was found, each once more.


def test_grids_that_cannot_be_held_are_refused() -> None:
    hull = moldloft.loads(HULL)["hull"]
    many = np.full(10**5, 0.5)
    for ask in (
        lambda: hull.look(many, many),
        lambda: hull.look(10**9, 2),
        lambda: hull.grid(10**5, 10**5),
        lambda: hull.grid(2**40, 2**40),
    ):
        with pytest.raises(moldloft.Error, match=r"points|parameters"):
            ask()
    before = moldloft.limits()
    moldloft.limits(memory="64M")
    try:
        with pytest.raises(moldloft.Error, match="GiB of memory"):
            hull.grid(5000, 5000)
    finally:
        moldloft.limits(**before._asdict())
    assert hull.grid(3, 3).shape == (3, 3, 3)


def test_files_without_a_name_and_what_is_no_field_are_refused() -> None:
    for read in (grids.read_aerofoil, offsets.read, implicit.load):
        with pytest.raises(moldloft.Error, match="cannot read"):
            read("")
    ball = implicit.Set(implicit.sphere((0, 0, 0), 1))
    with pytest.raises(moldloft.Error, match="known: expected fields, found ndarray"):
        ball.member((0, 0, 0), known=np.zeros((2, 3)))  # type: ignore[arg-type]
    assert "\ud800" not in moldloft.loads(FLAT)


def test_bodies_whose_cells_coordinates_do_not_distinguish_are_refused() -> None:
    for box in (
        "{-101, 9999999999999900, -101}, {101, 10000000000000100, 101}",
        "{-3, 1e17, -3}, {3, 100000000000000064, 3}",
    ):
        model = moldloft.loads(
            f"set s = set(sphere({{0, 1e16, 0}}, 100)); SetBody b(s, {box}, depth = 7);",
            strict=False,
        )
        assert [d.id for d in model.diagnostics if d.severity == "error"] == ["too-fine"]
        assert "do not distinguish cells" in str(model.diagnostics[0])


def test_stacks_of_deep_calls_count_as_memory() -> None:
    text = "subroutine deep(float x) { AbsPoint p(x, 0, 0); deep more(x + 1); } deep first(0);"
    before = moldloft.limits()
    moldloft.limits(memory="300M")
    try:
        with pytest.raises(moldloft.Error, match=r"memory|nest"):
            moldloft.loads(text)
    finally:
        moldloft.limits(**before._asdict())


def test_many_points_are_those_of_few() -> None:
    m = moldloft.loads(FLAT)
    hull, curve = m["s"], m["l"]
    # More than one thread takes at a time, and no multiple of that.
    n = 70_001
    t = np.random.default_rng(1).random((2, n))
    some = slice(0, n, 997)
    assert np.array_equal(hull(*t)[some], hull(*t[:, some]))
    assert np.array_equal(curve(t[0])[some], curve(t[0, some]))
    grid, rows = hull.grid(301, 401), np.linspace(0, 1, 301)
    columns = np.array([k / 400 for k in range(401)])
    for i in (0, 40, 41, 150, 300):
        # Along a row the surface is evaluated point by point here.
        assert np.abs(grid[i] - hull(np.full(401, rows[i]), columns)).max() < 1e-12
    points, normals = hull.grid(301, 401, normals=True)
    assert np.array_equal(points, grid)
    small = hull.grid(31, 41, normals=True)[1]
    assert np.abs(normals[::10, ::10] - small).max() < 1e-12


def test_a_word_of_a_million_letters_has_no_near_name() -> None:
    assert nearest("a" * 10**6, kinds.__dir__()) is None
    with pytest.raises(moldloft.Error):
        moldloft.loads(HULL).kind_picture("a" * 10**5)


def test_numbers_of_drawings_have_a_largest(tmp_path: Path) -> None:
    for path in ("M0 0 A9 -1e308 0 0 1 5 5", "M0 0 L1e400 2", "M0 0 L1e51 2"):
        file = tmp_path / "a.svg"
        file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg"><path d="{path}"/></svg>')
        with pytest.raises(moldloft.FileError, match=r"1e\+?50|finite"):
            overlays.read(file)


@pytest.mark.parametrize(
    "value",
    [{"x": 1}, {1, 2}, b"ab", 1j, float("nan"), 10**400, object()],
    ids=lambda value: type(value).__name__,
)
def test_what_the_language_cannot_write_is_no_argument(value: object) -> None:
    with moldloft.Builder(), pytest.raises((moldloft.Error, TypeError)):
        kinds.AbsPoint("p", value, 0, 0)


def test_arrays_are_lists_of_the_language() -> None:
    with moldloft.Builder() as b:
        p = [kinds.AbsPoint(f"p{k}", k, k * k, 0) for k in range(3)]
        kinds.NURBCurve("c", p, degree=2, weights=np.array([1.0, 2.0, 1.0]))
    assert "weights = {1, 2, 1}" in b.text
    assert not b.model().has_errors


def test_objects_outside_of_a_builder_are_refused() -> None:
    with pytest.raises(moldloft.Error, match="Builder"):
        kinds.AbsPoint("p", 0, 0, 0)
    with moldloft.Builder(), pytest.raises(moldloft.Error, match="not a valid name"):
        kinds.AbsPoint("é😀", 0, 0, 0)


def test_texts_that_are_none_are_named() -> None:
    m, t = moldloft.loads(HULL), np.linspace(0, 1, 7)
    for ask in (
        lambda: m.derivatives("1/0", "\ud800"),
        lambda: m.set({"\ud800": 1}),
        lambda: moldloft.Sketch().draw([1, 2, 3]),
        lambda: fairing.page("optimum"),
        lambda: offsets.encode([1, 2, 3]),
        lambda: implicit.Set(implicit.sphere((0, 0, 0), 1)).filleted([1, 2, 3], 0.1),
    ):
        with pytest.raises(moldloft.Error):
            ask()
    with pytest.raises(moldloft.Error, match="degrees"):
        moldloft.Nurbs((2,), (t, t), np.zeros((4, 3)))
    with pytest.raises(moldloft.Error, match="`points`"):
        moldloft.Nurbs((2,), (t,), "aaa")
    with pytest.raises(moldloft.FileError, match="not a folder"):
        moldloft.Sketch("a" * 10**5)
    assert m.section_areas([1.0, 2.0], []).shape == (2, 0)
