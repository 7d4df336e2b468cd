"""Figures and files are those of the whole model, or say that they are not."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

# Two closed floats; where the second is short, a point of it is on nothing.
FLOATS = """
Model info(units = "m t");
param float h = 3 in [0.2, 4];
AbsPoint A(0, 0, -2); AbsPoint B(0, 0, 2); Line ax(A, B);
AbsPoint C(1, 0, -2); AbsPoint D(1, 0, 2); Line w(C, D);
RevSurf one(w, ax, 0, 2*PI, divisions = {8, 24}); Line p0(A, A); Line p1(B, B);
RuledSurf a0(one.u0, p0); RuledSurf a1(one.u1, p1);
AbsPoint E(8, 0, -h); AbsPoint F(8, 0, 2); Line ax2(E, F);
AbsPoint c2(9, 0, -h); AbsPoint c3(9, 0, 2); Line w2(c2, c3);
ZPlane z(-1.5); IntBead cut(w2, z); AbsBead top(w2, 1); SubCurve part(cut, top);
IntBead foot(ax2, z); AbsBead head(ax2, 1); Line q0(foot, foot); Line q1(head, head);
RevSurf two(part, ax2, 0, 2*PI, divisions = {8, 24});
RuledSurf b0(two.u0, q0); RuledSurf b1(two.u1, q1);
"""


def test_a_model_of_which_an_object_failed_has_no_figures(tmp_path: Path) -> None:
    m = moldloft.loads(FLOATS)
    whole = m.hydrostatics().volume
    m["h"] = 1
    assert m.has_errors
    uses = (
        m.mesh,
        m.hydrostatics,
        lambda: m.equilibrium(3.0, density="salt"),
        lambda: m.panel_figures(),
        lambda: m.eval("hydrostatics.volume"),
        lambda: m.eval("mesh.volume"),
        lambda: m.derivative("hydrostatics.volume", "h"),
        lambda: m.jacobian(["h"]),
        *(
            lambda name=name: m.write(tmp_path / f"f.{name}")
            for name in ("gdf", "stl", "step", "svg")
        ),
    )
    for use in uses:
        with pytest.raises(moldloft.errors.Error, match="cut"):
            use()
    assert not list(tmp_path.iterdir())
    # What was made is there for who asks for it.
    assert m["one"](0, 0).shape == (3,)
    m.partial = True
    found = m.hydrostatics()
    assert found.partial and found.volume < 0.7 * whole
    assert "incomplete" in found.remarks[0]
    assert m.copy().partial
    m["h"] = 3
    assert not m.hydrostatics().partial and m.hydrostatics().volume == pytest.approx(whole)


def test_inner_plates_and_overlaps_are_named(tmp_path: Path) -> None:
    ball = """
    AbsPoint A(0, 0, -1); AbsPoint B(0, 0, 1); AbsPoint C(1, 0, -1); Line axis(A, B);
    Arc half(A, {1, 0, 0}, B, type = 1); RevSurf ball(half, axis, 0, 2*PI);
    """
    m = moldloft.loads(ball)
    assert m.inner_skins() == [] and m.hydrostatics().doubts == []
    other = moldloft.loads(ball + "CopySurf other(ball, A, C, 1, 1, 1);")
    assert [d.id for d in other.inner_skins()] == ["bodies-overlap"]
    with pytest.raises(moldloft.errors.ModelError, match="overlap"):
        other.hydrostatics()
    with pytest.raises(moldloft.errors.ModelError, match="overlap"):
        other.write(tmp_path / "two.gdf")
    other.write(tmp_path / "two.stl")
    other.partial = True
    assert any("overlap" in remark for remark in other.hydrostatics().remarks)
    other.write(tmp_path / "two.gdf")
    apart = moldloft.loads(ball + "AbsPoint D(2.5, 0, -1); CopySurf other(ball, A, D, 1, 1, 1);")
    assert apart.inner_skins() == []
    plate = moldloft.loads(
        ball + "AbsPoint e(-0.2, -0.2, 0); AbsPoint f(0.2, -0.2, 0); AbsPoint g(-0.2, 0.2, 0);"
        "AbsPoint h(0.2, 0.2, 0); Line ef(e, f); Line gh(g, h); RuledSurf plate(ef, gh);"
    )
    assert [(d.id, d.object) for d in plate.inner_skins()] == [("inner-plate", "plate")]
    with pytest.raises(moldloft.errors.ModelError, match="inside the body"):
        plate.hydrostatics()


def test_a_submerged_body_is_stable_by_its_centre_of_buoyancy() -> None:
    m = moldloft.loads(
        "AbsPoint A(0, 0, -3); AbsPoint B(0, 0, -1); Line axis(A, B);"
        "Arc half(A, {1, 0, -2}, B, type = 1); RevSurf ball(half, axis, 0, 2*PI);"
    )
    low, high = (m.hydrostatics(cg=(0, 0, z), density=1.0) for z in (-2.5, -1.8))
    assert low.gmt == pytest.approx(0.5) and low.gml == pytest.approx(0.5) and low.stable
    assert high.gmt == pytest.approx(-0.2) and high.stable is False


def test_balls_overlap_where_they_are_nearer_than_their_radii() -> None:
    rng = np.random.default_rng(5)
    for _ in range(300 if SOAK else 20):
        apart, r = rng.uniform(0.2, 3.2), rng.uniform(0.3, 1.4)
        gap = apart - 1 - r
        # Shallower overlaps are within the distance of the panels from the balls.
        if -0.05 < gap < 0:
            continue
        m = moldloft.loads(f"""
AbsPoint A(0, 0, -1); AbsPoint B(0, 0, 1); Line ax(A, B);
Arc half(A, {{1, 0, 0}}, B, type = 1); RevSurf ball(half, ax, 0, 2*PI);
AbsPoint C({apart}, 0, -{r}); AbsPoint D({apart}, 0, {r}); Line ay(C, D);
Arc rim(C, {{{apart + r}, 0, 0}}, D, type = 1); RevSurf other(rim, ay, 0, 2*PI);
""")
        assert bool(m.inner_skins()) == (gap < 0), (apart, r)


GALLERY = Path(__file__).resolve().parents[3] / "examples" / "gallery"
VESSELS = ("catamaran", "merchant", "planing", "rowing_shell", "semisubmersible", "tug", "workboat")


def broken(rng: np.random.Generator) -> moldloft.Model | None:
    """A vessel with one or two numbers of its text changed; None if it has no error."""
    text = (GALLERY / f"{rng.choice(VESSELS)}.sdl").read_text(encoding="utf-8")
    for _ in range(rng.integers(1, 3)):
        body = text.index("Model info")
        found = list(re.finditer(r"(?<![\w.\"])\d+(\.\d+)?(?![\w.])", text[body:]))
        at = found[rng.integers(len(found))]
        value = float(at[0]) * rng.choice([-1, 0, 0.1, 0.5, 2, 10])
        text = f"{text[: body + at.start()]}{value:g}{text[body + at.end() :]}"
    m = moldloft.loads(text, strict=False)
    return m if m.has_errors else None


@pytest.mark.parametrize("seed", range(1000 if SOAK else 8))
def test_a_vessel_with_a_broken_object_has_no_figures(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    m = None
    while m is None:
        m = broken(rng)
    name = next(iter(m.params))
    uses = {
        "mesh": m.mesh,
        "hydrostatics": m.hydrostatics,
        "equilibrium": lambda: m.equilibrium(10.0, density="salt"),
        "righting_curve": lambda: m.righting_curve([0.1], 10.0, cg=(0, 0, 0), density=1),
        "panel_figures": m.panel_figures,
        "wetted_areas": m.wetted_areas,
        "eval": lambda: m.eval("hydrostatics.volume"),
        "derivative": lambda: m.derivative("mesh.volume", name),
        "jacobian": lambda: m.jacobian([name]),
        "vjp": lambda: m.vjp({"mesh.volume": 1.0}),
        "united": m.united,
        "to_capytaine": m.to_capytaine,
        "to_trimesh": m.to_trimesh,
    }
    formats = ("gdf", "stl", "step", "iges", "3dm", "obj", "svg", "dxf", "pnl", "hst", "msh")
    for to in formats:
        uses[to] = lambda to=to: m.write(tmp_path / f"f.{to}")
    for use, call in uses.items():
        with pytest.raises(moldloft.errors.Error) as raised:
            call()
        assert str(raised.value), use
    assert not list(tmp_path.iterdir())
