"""The Python interface: changing, measuring and differentiating a model."""

from __future__ import annotations

import pickle
import threading

import numpy as np
import pytest

import moldloft
from conftest import SAILBOAT


@pytest.fixture
def hull() -> moldloft.Model:
    return moldloft.load(SAILBOAT / "hull.sdl")


@pytest.fixture
def table2() -> moldloft.Model:
    return moldloft.load(SAILBOAT / "hull.ms2")


def test_arrays_in_arrays_out(hull):
    u, v = np.linspace(0, 1, 4)[:, None], np.linspace(0, 1, 5)[None, :]
    points = hull["hull"](u, v)
    assert points.shape == (4, 5, 3)
    np.testing.assert_array_equal(points[2, 3], hull["hull"](u[2, 0], v[0, 3]))
    assert hull["MC2"]([0.0, 1.0]).shape == (2, 3)
    assert hull["MC2"](0.5).shape == (3,)
    assert hull["hull"](np.zeros((0,)), 0.5).shape == (0, 3)


def test_the_grid_is_the_points(hull):
    points, normals = hull["hull"].grid(7, 9, normals=True)
    u, v = np.meshgrid(np.arange(7) / 6, np.arange(9) / 8, indexing="ij")
    np.testing.assert_allclose(points, hull["hull"](u, v), rtol=0, atol=1e-13)
    np.testing.assert_array_equal(points, hull["hull"].grid(7, 9))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1, atol=1e-14)
    along_u = np.diff(points, axis=0)[:, :-1]
    along_v = np.diff(points, axis=1)[:-1, :]
    flat = np.cross(along_u, along_v)
    assert np.all(np.sum(flat * normals[:-1, :-1], axis=-1) > 0)


def test_a_direct_edit_evaluates_what_it_reaches(table2):
    table2["P21"].y = 5.0
    assert table2["P21"].y == 5.0
    # The point, its curve and the hull.
    assert table2.evaluated == 3
    table2["P21"].y = 5.0
    assert table2.evaluated == 0
    assert " 5.000 " in table2.text or " 5 " in table2.text


def test_a_direct_edit_is_a_run_of_the_edited_text(table2):
    table2.set({"P21.y": 4.25, "P33.z": 0.25})
    again = moldloft.loads(table2.text, name="again.ms2")
    np.testing.assert_array_equal(table2.mesh().vertices, again.mesh().vertices)


def test_a_computed_number_names_its_parameters(hull):
    with pytest.raises(moldloft.ModelError, match="beam"):
        hull["P21"].y = 4.0


def test_a_parameter_out_of_range_changes_nothing(hull):
    before = hull["beam"]
    with pytest.raises(ValueError, match="range"):
        hull["beam"] = 1e6
    with pytest.raises(moldloft.Error):
        hull["beam"] = float("nan")
    with pytest.raises(moldloft.Error):
        hull.set({"beam": 9.0, "nothing.x": 1.0})
    assert hull["beam"] == before


def test_names_that_are_not_there(hull):
    with pytest.raises(KeyError, match="hull"):
        hull["hul"]
    with pytest.raises(moldloft.UnknownNameError):
        hull["nothing"] = 3.0
    with pytest.raises(AttributeError):
        _ = hull["P21"].colour_of_the_sky
    assert "P21" in hull and "beam" in hull and "sky" not in hull


def test_wrong_use_of_objects(hull):
    with pytest.raises(moldloft.Error, match="curve"):
        hull["hull"](0.5)
    with pytest.raises(moldloft.Error, match="surface"):
        hull["MC1"](0.5, 0.5)
    with pytest.raises(moldloft.Error):
        hull["hull"].grid(1, 5)
    with pytest.raises(moldloft.Error):
        hull["hull"].grid(2**40, 2**40)


def test_errors_carry_diagnostics():
    with pytest.raises(moldloft.ModelError) as caught:
        moldloft.loads("AbsPoint P(1, 2, 3);\nBCurve C({P, Q}, degree = 1);\n")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.is_error and diagnostic.primary.line == 2
    assert "Q" in diagnostic.message
    assert diagnostic.to_dict()["primary"]["line"] == 2


def test_a_text_can_be_replaced(hull):
    count = len(hull.objects)
    hull.text = hull.text + "\nAbsPoint extra(1, 2, 3);\n"
    assert len(hull.objects) == count + 1
    assert hull.evaluated == 1
    hull.text = "AbsPoint broken(1, 2"
    assert [d for d in hull.diagnostics if d.is_error]
    with pytest.raises(moldloft.ModelError):
        hull.check()


def test_convert_and_back(hull):
    again = moldloft.loads(hull.convert("ms2"), name="again.ms2")
    np.testing.assert_array_equal(again.mesh().vertices, hull.mesh().vertices)
    back = moldloft.loads(again.convert("sdl"))
    np.testing.assert_array_equal(back.mesh().vertices, hull.mesh().vertices)
    assert again.symmetry == back.symmetry == hull.symmetry == "y"


def central(function, x: float, step: float) -> np.ndarray:
    """Ridders' extrapolation of central differences."""
    table: list[list[np.ndarray]] = []
    for i in range(6):
        row = [(function(x + step) - function(x - step)) / (2 * step)]
        for j in range(i):
            factor = 4.0 ** (j + 1)
            row.append((factor * row[j] - table[-1][j]) / (factor - 1))
        table.append(row)
        step /= 2
    return table[4][4]


@pytest.mark.parametrize("name", ["beam", "P13.x", "P32.z"])
def test_derivatives_of_all_vertices(hull, name):
    exact = hull.jacobian([name])[:, :, 0]
    value = hull.eval(name)

    def vertices(x: float) -> np.ndarray:
        hull.set({name: x})
        return hull.mesh().vertices

    numeric = central(vertices, value, 0.2)
    hull.set({name: value})
    np.testing.assert_allclose(exact, numeric, rtol=0, atol=1e-7 * np.abs(exact).max())


def test_many_directions_at_once(table2):
    names = [f"P{i}{j}.{axis}" for i in "123" for j in "1234" for axis in "xyz"]
    jacobian = table2.jacobian(names)
    assert jacobian.shape == (len(table2.mesh().vertices), 3, 36)
    np.testing.assert_array_equal(jacobian[:, :, 17], table2.jacobian([names[17]])[:, :, 0])
    # Moving all points along x moves all vertices along x.
    total = jacobian[:, :, 0::3].sum(axis=2)
    np.testing.assert_allclose(total, np.tile([1.0, 0, 0], (len(total), 1)), atol=1e-12)


def test_derivatives_of_measures(hull):
    volume = "hydrostatics.volume"
    exact = hull.derivative(volume, "beam")

    def measured(x: float) -> float:
        hull["beam"] = x
        return hull.eval(volume)

    value = hull["beam"]
    assert exact == pytest.approx(central(measured, value, 0.2), rel=1e-8)
    hull["beam"] = value
    assert hull.eval(volume) == pytest.approx(hull.hydrostatics().volume, rel=1e-14)


def test_from_scratch_and_incremental_are_the_same_bits(table2):
    random = np.random.default_rng(7)
    names = [f"P{i}{j}.{axis}" for i in "123" for j in "1234" for axis in "xyz"]
    for _ in range(100):
        name = str(random.choice(names))
        table2.set({name: float(np.round(table2.eval(name) + random.normal(0, 0.05), 6))})
    fresh = moldloft.loads(table2.text, name="fresh.ms2")
    np.testing.assert_array_equal(fresh["hull"].grid(31, 41), table2["hull"].grid(31, 41))


def test_threads_share_a_model(hull):
    expected = hull["hull"].grid(101, 101)
    results: list[np.ndarray] = []

    def work() -> None:
        results.extend(hull["hull"].grid(101, 101) for _ in range(20))
        hull.mesh()

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 80
    assert all(np.array_equal(result, expected) for result in results)


def test_objects_compare_by_name(hull):
    assert hull["P21"] == hull["P21"] and hull["P21"] != hull["P22"]
    assert len({hull["P21"], hull["P21"]}) == 1
    assert repr(hull["MC1"]) == "<BCurve MC1>"


def test_errors_can_be_pickled():
    error = moldloft.ModelError("error: something")
    assert str(pickle.loads(pickle.dumps(error))) == "error: something"
