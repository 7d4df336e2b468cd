"""The lines plan: curves on the model, labels that do not overlap, files that others read."""

from __future__ import annotations

import io
import os
import re
import zlib
from pathlib import Path

import numpy as np
import pytest

import moldloft
import random_models
from conftest import SAILBOAT
from moldloft.lines_plan import _overlap, draw, dxf, lines_plan, pdf, svg


@pytest.fixture(scope="module")
def plan():
    return lines_plan(moldloft.load(Path(SAILBOAT, "hull.sdl")), title="hull")


def test_labels_are_there_and_do_not_overlap(plan):
    words = [text.text for text in plan.texts]
    for number in range(11):
        assert words.count(str(number)) >= 2
    assert {"DWL", "BL", "CL"} <= set(words) and plan.left_out == []
    for k, a in enumerate(plan.texts):
        assert not any(_overlap(a, b) for b in plan.texts[k + 1 :])
    assert any(word.startswith("volume  117.45 ft³") for word in words)


@pytest.mark.parametrize("seed", range(60 if os.environ.get("MOLDLOFT_SOAK") else 6))
def test_plans_of_drawn_ships_are_labelled(seed):
    family = (random_models.chine_hull, random_models.round_hull, random_models.faceted_ship)
    model = moldloft.loads(family[seed % 3](np.random.default_rng(seed)).text)
    drawn = lines_plan(model)
    words = [text.text for text in drawn.texts]
    assert drawn.left_out == [] and all(words.count(str(k)) >= 2 for k in range(11))
    for k, a in enumerate(drawn.texts):
        assert not any(_overlap(a, b) for b in drawn.texts[k + 1 :])


def test_a_model_of_one_end_is_drawn_whole():
    quarter = """Model info(symmetry = "xy", units = "m");
        AbsPoint a(0, 0, -2); AbsPoint b(8, 0, -2); AbsPoint c(0, 3, -2); AbsPoint d(8, 3, -2);
        AbsPoint e(0, 3, 1); AbsPoint f(8, 3, 1); AbsPoint g(8, 0, 1);
        Line ab(a, b); Line cd(c, d); Line ef(e, f); Line bd(b, d); Line gf(g, f);
        RuledSurf floor(ab, cd); RuledSurf side(cd, ef); RuledSurf end(bd, gf);"""
    drawn = lines_plan(moldloft.loads(quarter))
    words = [text.text for text in drawn.texts]
    for word in ("L OA  16 m", "B  6 m", "D  3 m", "L WL  16 m", "volume  192 m³", "CB  1"):
        assert word in words, words
    flat = np.concatenate([p.points for p in drawn.paths if p.layer == "outline"])
    profile = flat[(flat[:, 1] > 90)]
    assert np.ptp(profile[:, 0]) * drawn.scale / 1000 > 16 * (1 - 1e-9)


def test_labels_without_place_are_listed_on_the_sheet():
    model = moldloft.load(Path(SAILBOAT, "hull.sdl"))
    drawn = lines_plan(model, waterline_spacing=0.2)
    (note,) = [t.text for t in drawn.texts if t.text.startswith("without labels: ")]
    assert drawn.left_out and drawn.left_out[0] in note and " more" in note


def test_the_waterline_is_that_of_the_hydrostatics(plan):
    # The design waterline of the half-breadth plan, 27.386 ft at 1:50.
    curves = [p.points for p in plan.paths if p.layer == "dwl" and len(p.points) > 10]
    assert len(curves) == 1
    length = np.ptp(curves[0][::3, 0]) * plan.scale / 304.8
    assert length == pytest.approx(27.38620965, rel=1e-7)
    beam = 2 * np.ptp(curves[0][:, 1]) * plan.scale / 304.8
    assert beam == pytest.approx(9.17429864, rel=2e-3)


def test_files(plan, tmp_path):
    text = svg(plan).decode()
    assert text.startswith("<svg") and 'width="420mm"' in text and text.count("<path") > 40
    data = pdf(plan)
    assert data == pdf(plan) and data.startswith(b"%PDF-1.7")
    box = re.search(rb"MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", data)
    assert float(box[1]) == pytest.approx(420 / 25.4 * 72, abs=1e-3)
    stream = zlib.decompress(data.split(b"stream\n")[1].split(b"\nendstream")[0])
    assert stream.count(b" c") > 500 and b"(hull) Tj" in stream
    start = int(data.split(b"startxref\n")[1].split()[0])
    assert data[start : start + 4] == b"xref"
    hull = moldloft.load(Path(SAILBOAT, "hull.sdl"))
    assert draw(hull, tmp_path / "plan.svg").read_bytes().startswith(b"<svg")
    hull.write(tmp_path / "hull.lines.pdf", format="lines-pdf")
    assert (tmp_path / "hull.lines.pdf").stat().st_size > 4000


def test_dxf_is_at_full_size_with_true_curves():
    ezdxf = pytest.importorskip("ezdxf")
    hull = moldloft.load(Path(SAILBOAT, "hull.sdl"))
    plan = lines_plan(hull, title="hull", diagonals=[(1.0, 0.6)])
    data = dxf(plan)
    assert data == dxf(plan)
    drawing = ezdxf.read(io.StringIO(data.decode()))
    assert not drawing.audit().errors
    assert drawing.header["$INSUNITS"] == 2
    space = drawing.modelspace()
    splines = space.query("SPLINE")
    assert len(splines) == sum(not path.straight for path in plan.paths) > 30
    full = plan.scale / 304.8
    for spline, path in zip(splines, (p for p in plan.paths if not p.straight), strict=True):
        tool = spline.construction_tool()
        ends = np.array(list(tool.points([0, tool.max_t])))
        assert ends[:, :2] == pytest.approx(path.points[[0, -1]] * full, abs=1e-9)
        # A joint of the pieces is a point of the curve.
        joint = np.array(tool.point(1.0))
        assert joint[:2] == pytest.approx(path.points[3] * full, abs=1e-9)
    (waterline,) = [s for s in splines if s.dxf.layer == "dwl"]
    points = np.array(waterline.control_points)
    assert np.ptp(points[::3, 0]) == pytest.approx(27.38620965, rel=1e-7)
    assert drawing.layers.get("diagonals").dxf.linetype == "diagonals"
    assert {text.dxf.text for text in space.query("TEXT")} == {text.text for text in plan.texts}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"stations": "left"}, "bow"),
        ({"sheet": "B5"}, "unknown sheet"),
        ({"scale": 1.0, "sheet": "A4"}, "does not fit"),
        ({"scale": -2.0}, "positive"),
    ],
)
def test_bad_requests(options, words):
    hull = moldloft.load(Path(SAILBOAT, "hull.sdl"))
    with pytest.raises(moldloft.Error, match=words):
        lines_plan(hull, **options)


def test_a_model_without_surfaces(tmp_path):
    model = moldloft.loads("AbsPoint a(0, 0, 0);")
    with pytest.raises(moldloft.Error, match="shows no surface"):
        lines_plan(model)
    with pytest.raises(moldloft.Error, match=r"\.jpg"):
        draw(model, tmp_path / "plan.jpg")
