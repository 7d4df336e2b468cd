"""Weights in mirrored models: each side counts once, and what is not said is an error."""

import itertools
import random

import numpy as np
import pytest

import moldloft

# A plate of length a and breadth b on one side of the planes of symmetry.
BOX = """
Model info(symmetry = "{planes}");
AbsPoint A({x}, {y}, {z}); AbsPoint B({x} + {a}, {y}, {z}); AbsPoint C({x} + {a}, {y} + {b}, {z});
AbsPoint D({x}, {y} + {b}, {z});
Line l(A, B); Line m(D, C);
RuledSurf plate(l, m);
Weight shell(plate, per = {per}, margin = {margin}{images});
"""


def text(planes: str, images: str | None, **numbers: float) -> str:
    stated = "" if images is None else f', images = "{images}"'
    return BOX.format(planes=planes, images=stated, **numbers)


def numbers(seed: int) -> dict[str, float]:
    r = random.Random(seed)
    return {
        "x": r.choice([0.0, r.uniform(0.1, 5)]),
        "y": r.choice([0.0, r.uniform(0.1, 5)]),
        "z": r.uniform(-3, 3),
        "a": r.uniform(0.5, 9),
        "b": r.uniform(0.5, 9),
        "per": r.uniform(0.01, 2),
        "margin": r.choice([0.0, r.uniform(0, 20)]),
    }


@pytest.mark.parametrize("planes", ["x", "y", "xy"])
def test_images_double_the_mass_and_centre_it(planes: str) -> None:
    for seed in range(20):
        n = numbers(seed)
        m = moldloft.loads(text(planes, planes, **n))
        corners = itertools.product((n["x"], n["x"] + n["a"]), (n["y"], n["y"] + n["b"]))
        centre = np.array([*np.mean(list(corners), axis=0), n["z"]])
        for axis, letter in enumerate("xyz"):
            if letter in planes:
                centre[axis] = 0
        mass = n["a"] * n["b"] * n["per"] * (1 + n["margin"] / 100) * 2 ** len(planes)
        assert m.eval("shell.mass") == pytest.approx(mass, rel=1e-12)
        assert np.allclose(m.eval("shell.centre"), centre, atol=1e-12)
        assert m.weights().mass == pytest.approx(mass, rel=1e-12)


@pytest.mark.parametrize("planes", ["x", "y", "xy"])
def test_one_side_alone_must_be_said(planes: str) -> None:
    n = numbers(3)
    with pytest.raises(moldloft.ModelError, match=rf'images = "{planes}"') as error:
        moldloft.loads(text(planes, None, **n))
    assert error.value.diagnostics[0].id == "half-weight"
    once = moldloft.loads(text(planes, "", **n))
    mass = n["a"] * n["b"] * n["per"] * (1 + n["margin"] / 100)
    assert once.eval("shell.mass") == pytest.approx(mass, rel=1e-12)


def test_what_lies_in_the_plane_or_across_it_counts_once() -> None:
    n = numbers(5) | {"y": -1.0, "b": 2.0, "x": 1.0}
    assert moldloft.loads(text("y", None, **n)).eval("shell.y") == pytest.approx(0, abs=1e-15)


def test_planes_are_letters() -> None:
    for wrong in ("w", "yy", "left"):
        with pytest.raises(moldloft.ModelError, match="each once"):
            moldloft.loads(text("y", wrong, **numbers(1)))


def test_derivatives_follow() -> None:
    m = moldloft.loads(
        'Model info(symmetry = "y"); param float b = 2; AbsPoint A(0, 0, 0); AbsPoint B(3, 0, 0);'
        "AbsPoint C(3, b, 0); AbsPoint D(0, b, 0); Line l(A, B); Line m(D, C); RuledSurf s(l, m);"
        'Weight w(s, per = 0.5, images = "y");'
    )
    assert m.derivative("w.mass", "b") == pytest.approx(3.0, rel=1e-9)
    assert m.derivative("w.y", "b") == 0
