"""Expressions that read numbers of other objects."""

from __future__ import annotations

import numpy as np
import pytest

import moldloft
from moldloft import Sketch, SketchError

SLAB = """SKETCH {name} 2D XZ
POINT 1 0 0; POINT 2 90 1; POINT 3 91 30; POINT 4 1 29; POLYLINE 1 2 3 4 CLOSE
DIM W X 1 2 {w}; DIM H Z 1 4 {h}; EXTRUDE 5
"""


@pytest.fixture
def two() -> Sketch:
    """B is as wide as A is high, twice."""
    sketch = Sketch()
    sketch.run(SLAB.format(name="A", w=8, h=2))
    sketch.run(SLAB.format(name="B", w=1, h=3))
    sketch.run('SET W "2*A.H + max(A.W, 3)"')
    return sketch


def test_a_number_of_another_object_drives(two):
    assert two.objects["B"]["volume"] == pytest.approx(12 * 3 * 5)
    two.run("USING A")
    [change, *others] = two.edit("SET H 4")
    assert {change.name, *(o.name for o in others)} == {"A", "B"}
    assert all(c.body for c in (change, *others))
    assert two.objects["B"]["volume"] == pytest.approx(16 * 3 * 5)
    two.run("UNDO")
    assert two.objects["B"]["volume"] == pytest.approx(12 * 3 * 5)


def test_derivatives_by_numbers_of_other_objects(two):
    gradient = two.gradient(["A.H", "A.W", "H"], name="B")
    assert gradient.volume == pytest.approx([30, 15, 60])
    assert two.sweep("H", [1, 2], name="B")[:, 0] == pytest.approx([60, 120])


def test_text_has_the_expression(two, tmp_path):
    two.save(tmp_path / "two.skt")
    again = Sketch.load(tmp_path / "two.skt")
    assert again.text == two.text and "A.H" in again.text
    assert again.objects["B"]["volume"] == pytest.approx(180)
    # By itself B has no W.
    alone = Sketch()
    alone.run(two.text[two.text.index("SKETCH B") :])
    said = [str(r) for r in alone.run("CHECK", strict=False)]
    assert any("reads a.h, which has no value" in line for line in said), said
    assert alone.objects["B"]["volume"] is None


def test_names_follow(two):
    two.run("RENAME A TO BASE")
    assert "BASE.h" in two.text
    assert two.objects["B"]["volume"] == pytest.approx(180)
    said = two.run("DELETE BASE")
    assert "B reads base.h, base.w" in str(said[0])
    assert two.objects["B"]["volume"] is None
    two.run("UNDO")
    assert two.objects["B"]["volume"] == pytest.approx(180)


def test_circles_and_unknown_names_are_refused(two):
    two.run("USING A")
    with pytest.raises(SketchError, match=r"reads b\.w, which has no value"):
        two.run('SET H "B.W"')
    with pytest.raises(SketchError, match=r"reads b.nothing, which has no value"):
        two.run('SET H "B.NOTHING"')
    assert two.objects["B"]["volume"] == pytest.approx(180)


def test_combined_objects_keep_the_expression(two):
    two.run("MOVE B 20 0 0; UNION A B INTO U; USING U")
    assert two.volume == pytest.approx(80 + 180)
    two.run("SET A.H 3")
    assert two.volume == pytest.approx(120 + 14 * 15)
    assert two.gradient(["A.H"]).volume == pytest.approx([40 + 30])


def test_in_a_model(two, tmp_path):
    two.save(tmp_path / "two.skt")
    (tmp_path / "m.sdl").write_text('load "two.skt";\nfloat v = B.volume;\n')
    model = moldloft.load(tmp_path / "m.sdl")
    assert model.eval("v") == pytest.approx(180)
    assert model.derivative("B.volume", "A.H") == pytest.approx(30)
    model.set({"A.H": 4})
    assert model.eval("B.volume") == pytest.approx(240)


def test_a_chain_of_many_objects():
    # Each reads two numbers of the one before: none is computed more than once.
    sketch = Sketch()
    sketch.run(SLAB.format(name="K0", w=1, h=1))
    for k in range(1, 24):
        sketch.run(SLAB.format(name=f"K{k}", w=1, h=1))
        sketch.run(f'SET W "(K{k - 1}.W + K{k - 1}.H)/2"; SET H "(K{k - 1}.W + K{k - 1}.H)/2"')
    sketch.run("USING K0; SET W 3; SET H 5")
    assert sketch.objects["K23"]["volume"] == pytest.approx(80)
    assert np.isfinite(sketch.objects["K23"]["area"])


@pytest.mark.parametrize("text", ["div(100, 0.1)", "mod(3, 0.1)", "div(-7, 3)", "mod(-7, 3)"])
def test_division_is_that_of_the_model_language(two, text):
    # 0.1 is a little more than a tenth: 100 holds it 999 times, as Python's // says, too.
    two.run(f'USING B; SET W "1000 + {text}"')
    value = moldloft.loads("AbsPoint A(0, 0, 0);").eval(text)
    a, b = (float(x) for x in text[4:-1].split(","))
    assert value == (a // b if text.startswith("div") else a % b)
    assert two.objects["B"]["volume"] == pytest.approx((1000 + value) * 3 * 5, rel=1e-14)
