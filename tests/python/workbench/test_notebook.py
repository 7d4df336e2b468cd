"""Objects by class, copies, pickles, and what a notebook shows."""

from __future__ import annotations

import copy
import pickle
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ProcessPoolExecutor
from html.parser import HTMLParser

import numpy as np
import pytest

import moldloft
from conftest import SAILBOAT
from moldloft.starter import BOX


@pytest.fixture
def hull() -> moldloft.Model:
    return moldloft.load(SAILBOAT / "hull.sdl")


class Balanced(HTMLParser):
    """Refuses HTML whose tags do not close."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in ("br", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def shown(thing: object) -> str:
    parser = Balanced()
    parser.feed(thing._repr_html_())
    parser.close()
    assert not parser.open
    return " ".join(parser.words)


def test_objects_have_the_type_of_their_class(hull) -> None:
    classes = {
        "P21": moldloft.Point,
        "MC2": moldloft.Curve,
        "hull": moldloft.Surface,
        "stations": moldloft.Contours,
    }
    for name, class_ in classes.items():
        assert type(hull[name]) is class_
    with pytest.raises(AttributeError, match="surfaces"):
        hull["P21"].grid(3, 3)
    with pytest.raises(moldloft.ModelError):
        hull["P21"].nearest([0, 0, 0])
    assert not hasattr(hull["MC2"], "grid")
    with pytest.raises(moldloft.Error):
        hull["hull"].grid(-1, 5)


def test_completion_finds_what_is_there(hull) -> None:
    assert hull._ipython_key_completions_() == hull.keys()
    assert hull.keys()[0] == "beam" and "P11" in hull.keys()  # noqa: SIM118
    assert len(hull) == len(hull.objects) == len(list(hull))
    assert moldloft.loads("")
    assert {"x", "y", "z"} <= set(dir(hull["P21"]))
    assert {"area", "centroid", "v0", "grid", "nearest"} <= set(dir(hull["hull"]))
    assert "length" in dir(hull["MC2"]) and "area" not in dir(hull["MC2"])


def test_points_are_arrays(hull) -> None:
    point = np.asarray(hull["P21"])
    assert point.dtype == np.float64 and point.tolist() == [15, 4.815, 2.56]
    assert np.array([hull["P21"], hull["P22"]]).shape[0] == 2


def test_a_copy_is_a_model_of_its_own(hull) -> None:
    hull["beam"] = 9
    for again in (hull.copy(), copy.copy(hull), copy.deepcopy(hull)):
        assert again["beam"] == 9
        np.testing.assert_array_equal(again.mesh().vertices, hull.mesh().vertices)
        again["beam"] = 12
        assert hull["beam"] == 9


def rise(x):
    return np.sqrt(x) + 1


def volume(model: moldloft.Model) -> float:
    return model.hydrostatics().volume


def test_everything_can_be_pickled(hull) -> None:
    def again(thing):
        return pickle.loads(pickle.dumps(thing))

    hull["beam"] = 9.5
    model = again(hull)
    assert model["beam"] == 9.5 and model.text == hull.text
    np.testing.assert_array_equal(model.mesh().vertices, hull.mesh().vertices)
    assert again(hull["hull"]).area == hull["hull"].area
    mesh = again(again(hull.mesh()))
    np.testing.assert_array_equal(mesh.faces, hull.mesh().faces)
    assert (mesh.area, mesh.closed, len(mesh.patches)) == (hull.mesh().area, False, 1)
    assert mesh.closure() == hull.mesh().closure()
    with pytest.raises(moldloft.Error, match="pickle the model"):
        mesh.closure(level=0.3)
    assert again(hull.hydrostatics()) == hull.hydrostatics()
    near = hull["hull"].nearest([[10, 3, -1]])
    np.testing.assert_array_equal(again(near).points, near.points)
    table = hull.hydrostatic_table([1.0, 1.2])
    assert again(table).as_list() == table.as_list()
    assert again(hull.mesh().quality()) == hull.mesh().quality()
    assert again(hull["MC2"].to_nurbs()).degrees == (2,)
    with_function = moldloft.loads(
        "param float a = 4 in [1, 9]; AbsPoint P(0, 0, rise(a));", functions={"rise": rise}
    )
    with_function["a"] = 9
    assert again(with_function)["P"].z == 4
    with pytest.raises(moldloft.ModelError) as error:
        moldloft.loads("AbsPoint P(1, 2);")
    assert str(again(error.value)) == str(error.value)


def test_a_model_of_python_is_pickled_as_its_program() -> None:
    from moldloft import kinds as k

    @moldloft.model
    def pole(height: float = 4):
        k.Line("l", k.AbsPoint("A", 0, 0, 0), k.AbsPoint("B", 0, 0, height))

    m = pole(height=6)
    assert pickle.loads(pickle.dumps(m)).eval("l.length") == 6
    other = m.copy()
    other["height"] = 2
    assert (m.eval("l.length"), other.eval("l.length")) == (6, 2)


def test_a_pool_of_processes_takes_models(hull) -> None:
    models = []
    for beam in (8.0, 9.0):
        models.append(hull.copy())
        models[-1]["beam"] = beam
    import multiprocessing

    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        assert list(pool.map(volume, models)) == [volume(model) for model in models]


def test_what_a_notebook_shows(hull) -> None:
    text = shown(hull)
    assert "beam" in text and "CLoftSurf" in text and 'src="data:image/png' in hull._repr_html_()
    assert "area" in shown(hull["hull"]) and "MC1" in shown(hull["hull"])
    assert "<svg" in hull["hull"]._repr_html_()
    assert "x" in shown(hull["P21"])
    assert "aspect" in shown(hull.mesh()) and "hull" in shown(hull.mesh().quality())
    state = hull.hydrostatics(trim=0.01, level=-0.3)
    assert "volume" in shown(state) and "ft³" in shown(state) and "±" in shown(state)
    # Angles are in degrees, as in every table.
    assert "0.572958" in shown(state)
    assert "draft" in shown(hull.hydrostatic_table([1.0, 1.2]))
    box = moldloft.loads(BOX)
    arms = box.righting_curve(np.radians([0, 10, 20]), 40, cg=(0, 0, 0.4), density=1)
    assert "gz" in shown(arms) and "20" in shown(arms)
    weights = moldloft.loads("Weight a({2, 0, 0.5}, mass = 3); Weight b({4, 0, 0}, mass = 1);")
    assert "a" in shown(weights.weights())
    broken = moldloft.loads("AbsPoint P(1, 2); Line l(P, <)", strict=False)
    assert "error" in shown(broken) and "<)" in shown(broken)


def test_sets_and_sketches_are_pictures_where_they_have_a_body() -> None:
    from moldloft import implicit as im

    half = im.plane((0, 0, 1), (0, 0, 0))
    assert (im.Set(half) & im.sphere((0, 0, 0), 1))._repr_png_().startswith(b"\x89PNG")
    assert im.Set(half)._repr_png_() is None
    sketch = moldloft.Sketch()
    assert sketch._repr_png_() is None


def test_drawings_of_objects_are_svg(hull) -> None:
    from moldloft.display import object_svg

    for name in ("MC2", "hull"):
        root = ElementTree.fromstring(object_svg(hull[name]))
        lines = [element for element in root if element.tag.endswith("polyline")]
        assert len(lines) == (1 if name == "MC2" else 18)
        for line in lines:
            pairs = [tuple(map(float, pair.split(","))) for pair in line.get("points").split()]
            assert all(0 <= x <= 360 and 0 <= y <= 220 for x, y in pairs)
    assert object_svg(hull["P21"]) == ""


def test_an_object_that_is_gone_says_so(hull) -> None:
    stations = hull["stations"]
    stations.delete()
    assert "not in the model" in repr(stations)
    assert "<pre>" in stations._repr_html_()
