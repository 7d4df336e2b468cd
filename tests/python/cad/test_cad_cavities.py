"""Cavities: shells inside another one of the same solid face inward, so that volumes are OCCT's."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft

pytest.importorskip("OCP")

import occt_solids
from moldloft.cad.importing import load_cad


def ball_in_box(rng: np.random.Generator) -> Any:
    return occt_solids.without(
        occt_solids.box((0, 0, 0), (6, 7, 8)), occt_solids.ball(rng, 2, (3, 3, 4))
    )


def ball_in_ball(rng: np.random.Generator) -> Any:
    return occt_solids.without(
        occt_solids.ball(rng, 3, (1, 2, 3)), occt_solids.ball(rng, 1, (1.5, 2, 3.2))
    )


def two_boxes_in_a_ball(rng: np.random.Generator) -> Any:
    tools = occt_solids.box((-1, -1, -3), (1, 1, 1)), occt_solids.box((0.5, 0, 1), (1, 1, 1))
    return occt_solids.without(occt_solids.ball(rng, 6, (0, 0, 0)), *tools)


def drilled_in_box(rng: np.random.Generator) -> Any:
    tool = occt_solids.without(
        occt_solids.ball(rng, 2, (4, 4, 4)), occt_solids.cylinder(rng, 0.5, 9, (4, 4, 4))
    )
    return occt_solids.without(occt_solids.box((0, 0, 0), (8, 8, 8)), tool)


CASES = [ball_in_box, ball_in_ball, two_boxes_in_a_ball, drilled_in_box]


def read(path: Path) -> moldloft.Model:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return load_cad(path, units="mm")


@pytest.mark.parametrize("made", CASES)
@pytest.mark.parametrize("ending", ["step", "igs"])
def test_volumes_of_solids_with_cavities(made: Any, ending: str, tmp_path: Path) -> None:
    shape = made(np.random.default_rng(3))
    volume, _ = occt_solids.measures(shape)
    model = read(occt_solids.written(shape, tmp_path / f"a.{ending}"))
    mesh = model.mesh()
    assert mesh.closed
    assert mesh.volume == pytest.approx(volume, rel=1e-3)
    top = float(mesh.vertices[:, 2].max() + 1)
    assert model.hydrostatics(level=top).volume == pytest.approx(volume, rel=1e-6)
    # What convert writes is the same.
    again = moldloft.loads(model.text)
    assert again.mesh().volume == mesh.volume


def test_bodies_inside_bodies_stay_bodies(tmp_path: Path) -> None:
    """Two solids of which one contains the other: neither is a cavity."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    rng = np.random.default_rng(3)
    both, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(both)
    builder.Add(both, occt_solids.ball(rng, 3, (0, 0, 0)))
    builder.Add(both, occt_solids.box((-1, -1, -1), (2, 2, 2)))
    mesh = read(occt_solids.written(both, tmp_path / "a.step")).mesh()
    assert mesh.volume == pytest.approx(36 * np.pi + 8, rel=1e-3)


def test_a_cavity_by_hand() -> None:
    shells = []
    for n, r, more in (("s", 2.0, ""), ("c", 1.0, ", orientation = 2")):
        shells.append(f"""
        AbsPoint O{n}(0, 0, {-r}); AbsPoint T{n}(0, 0, {r}); AbsPoint M{n}({r}, 0, 0);
        Line axis{n}(O{n}, T{n}); Arc half{n}(O{n}, M{n}, T{n}, type = 1);
        RevSurf shell{n}(half{n}, axis{n}, divisions = {{24, 48}}{more});
        """)
    outer, inner = (moldloft.loads(shell).mesh().volume for shell in shells)
    both = moldloft.loads("".join(shells))
    assert inner < 0 < outer
    assert both.mesh().volume == pytest.approx(outer + inner, rel=1e-12)
    top = both.hydrostatics(level=5).volume
    assert top == pytest.approx(28 / 3 * np.pi, rel=1e-6)
