"""Gradients of models against the Jacobian of forward mode; studies and OpenMDAO with them."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import BSpline, CubicSpline
from scipy.optimize import brentq

import moldloft
import random_models
from moldloft import _core
from moldloft.deformation import Deformation
from moldloft.study import component, function, jax_function, torch_function
from test_deformation import ball, two_boxes

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
EXAMPLES = Path(__file__).parents[3] / "examples"

HULL = """
param float beam = 2 in [1, 4]; param float draft = 1 in [0.2, 3]; param int turns = 2 in [1, 5];
AbsPoint A(0, 0, -draft); AbsPoint B(3, 0.5 * beam, -0.7); AbsPoint C(6, 0, 0);
AbsPoint D(0, 0.3, 0.5); AbsPoint E(3, beam * draft, 0.4); AbsPoint F(6, 0.1, 0.6);
BCurve a({A, B, C}); CCurve b({D, E, F});
CLoftSurf hull({a, b}, divisions = {6, 9});
"""

#: Greatest difference from forward mode, as a share of the greatest derivative.
EXACT = 1e-12


def close(found, exact):
    """Equal but for rounding, gradient by gradient."""
    found, exact = np.atleast_2d(found), np.atleast_2d(exact)
    size = np.abs(exact).max(axis=1, keepdims=True)
    return (np.abs(found - exact) <= EXACT * size).all()


@pytest.fixture
def hull():
    return moldloft.loads(HULL)


def test_weights_on_the_mesh_are_products_with_the_jacobian(hull):
    by = ["beam", "draft", *hull.literals]
    assert {"A.x", "B.z", "F.y"} <= set(by) and "E.y" not in by and len(by) > 8
    n = len(hull.mesh().vertices)
    w = np.random.default_rng(1).normal(size=(3, n, 3))
    jacobian = hull.jacobian(by)
    assert close(hull.vjp({"mesh": w}, by), np.einsum("svc,vcn->sn", w, jacobian))
    one = hull.vjp({"mesh": w[0]}, by)
    assert one.shape == (len(by),)
    assert close(one, np.einsum("vc,vcn->n", w[0], jacobian))
    assert np.array_equal(one, hull.vjp({"mesh": w}, by)[0])
    # Without names: all of them.
    named = hull.vjp({"mesh": w[0]})
    assert list(named) == by and np.array_equal(list(named.values()), one)
    assert all(v.shape == (3,) for v in hull.vjp({"mesh": w}).values())
    # Few inputs, by forward mode.
    assert close(hull.vjp({"mesh": w[0]}, ["beam", "F.y"]), one[[0, by.index("F.y")]])


def test_sums_of_outputs_of_all_shapes(hull):
    by = ["beam", "draft", *hull.literals]
    outputs = {
        "mesh.area": 2.0,
        "mesh.volume": -1.0,
        "hull.area": 0.5,
        "B": [1.0, 2.0, 3.0],
        "a({0.1, 0.5, 0.7})": np.arange(9.0).reshape(3, 3),
        "hull({0.1, 0.4}, {0.2, 0.9})": np.ones((2, 3)),
    }
    exact = np.zeros(len(by))
    for (_, weight), row in zip(outputs.items(), hull.derivatives(list(outputs), by), strict=True):
        exact += [np.sum(np.asarray(weight) * np.asarray(d)) for d in row]
    assert close(hull.vjp(outputs, by), exact)
    for mode in ("forward", "reverse"):
        flat = [(k, np.asarray(w, dtype=float).reshape(1, -1)) for k, w in outputs.items()]
        rows, ahead = _core.vjp(hull._document, flat, by, mode)
        assert close(rows[0], exact)
        assert ahead == (list(outputs) if mode == "forward" else ["hull.area"])
    assert close(hull.gradient("mesh.volume", by), hull.derivatives(["mesh.volume"], by)[0])
    assert list(hull.gradient("B.y")) == by
    value, gradient = hull.value_and_gradient("mesh.volume", by)
    assert value == hull.eval("mesh.volume")
    assert np.array_equal(gradient, hull.gradient("mesh.volume", by))
    with pytest.raises(moldloft.Error, match="weights"):
        hull.value_and_gradient("B", by)


#: Greatest difference of hydrostatic figures from forward mode: both differentiate a quadrature of
#: this accuracy, each on cells of its own. The integrand of the wetted area is no polynomial.
OF_QUADRATURE, OF_AREA = 1e-8, 1e-5

FIGURES = (
    "volume", "wetted_area", "draft", "lcb", "vcb", "waterplane_area", "lcf", "waterplane_it",
    "waterplane_il", "kmt",
)  # fmt: skip


def of_figures(m, names, by, mode):
    """The derivatives of hydrostatic figures, (figures, inputs), and what took forward mode."""
    eye = np.eye(len(names))
    columns = [np.ascontiguousarray(eye[:, k : k + 1]) for k in range(len(names))]
    given = [(f"hydrostatics.{name}", w) for name, w in zip(names, columns, strict=True)]
    return _core.vjp(m._document, given, by, mode)


def assert_figures_agree(m, names, by):
    rows, ahead = of_figures(m, names, by, "reverse")
    exact, _ = of_figures(m, names, by, "forward")
    # Of a figure that depends on none of the inputs there is rounding.
    off = np.abs(rows - exact).max(axis=1) / np.maximum(np.abs(exact).max(axis=1), 1e-6)
    most = [OF_AREA if name == "wetted_area" else OF_QUADRATURE for name in names]
    assert (off <= most).all(), dict(zip(names, off.tolist(), strict=True))
    return ahead


def test_hydrostatics_by_a_reverse_sweep():
    m = moldloft.load(EXAMPLES / "sailboat" / "yacht.sdl")
    by = [p.name for p in m.params.values() if not p.whole]
    by = by + m.literals[:10] if SOAK else by[:2] + m.literals[:2]
    assert assert_figures_agree(m, FIGURES, by) == []
    # Together with the mesh, as one sum.
    weights = {"hydrostatics.volume": 3.0, "mesh.area": -1.0, "hydrostatics.kmt": 0.1}
    flat = [(name, np.array([[w]])) for name, w in weights.items()]
    rows, ahead = _core.vjp(m._document, flat, by, "reverse")
    both = np.array(list(weights.values())) @ np.array(m.derivatives(list(weights), by))
    assert ahead == [] and np.abs(rows[0] - both).max() < OF_QUADRATURE * np.abs(both).max()


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_a_wall_of_vertical_lines_by_a_reverse_sweep(degree):
    """A transom alone: as it is raised its wetted area falls by its breadth at the water."""
    y, z = np.array([0, 1.63, 2.206, 2.643]), np.array([-1.743, -0.893, -0.0792, 1.863])
    inner = np.linspace(0, 1, 5 - degree)[1:-1]
    knots = np.concatenate([[0] * (degree + 1), inner, [1] * (degree + 1)])
    outline = BSpline(knots, np.column_stack([y, z]), degree)
    points = [f"AbsPoint P{k}(34, {y[k]}, {z[k]} + up);" for k in range(4)]
    text = (
        f'Model info(symmetry = "y"); {"".join(points)}'
        f"BCurve c({{P0, P1, P2, P3}}, degree = {degree});"
        'ProjCurve q(c, "y=0"); RuledSurf wall(c, q, divisions = {8, 4});'
    )
    for up in np.linspace(-1.8, 1.7, 15 if SOAK else 5).tolist():
        m = moldloft.loads(f"param float up = {up!r}; {text}")
        # Without a hull it is open.
        m.partial = True
        breadth = 2 * outline(brentq(lambda t, up=up: outline(t)[1] + up, 0, 1))[0]
        rows, _ = of_figures(m, ["wetted_area"], ["up"], "reverse")
        assert rows[0, 0] == pytest.approx(-breadth, rel=1e-8), up


def loft_area(masters):
    """The area of a C-loft through quadratic Bezier curves (n, 3, 3), piece by piece."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    nodes, weights = 0.5 + 0.5 * nodes, 0.5 * weights
    basis = np.array([(1 - nodes) ** 2, 2 * nodes * (1 - nodes), nodes**2])

    def column(u_basis):
        """Points of a column and where they are, at the same shares of its pieces."""
        points = np.einsum("b,nbc->nc", u_basis, masters)
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        knots = np.concatenate([[0], np.cumsum(chords) / chords.sum()])
        return CubicSpline(knots, points, bc_type="not-a-knot"), knots

    total, h = 0.0, 1e-5
    for at, (u, weight) in enumerate(zip(nodes, weights, strict=True)):
        spline, knots = column(basis[:, at])
        places = (knots[:-1, None] + np.diff(knots)[:, None] * nodes).ravel()
        # By u at constant v: differences of fourth order, of columns beside it.
        beside = [
            column([(1 - t) ** 2, 2 * t * (1 - t), t**2])[0](places)
            for t in (u - 2 * h, u - h, u + h, u + 2 * h)
        ]
        by_u = (beside[0] - 8 * beside[1] + 8 * beside[2] - beside[3]) / (12 * h)
        areas = np.linalg.norm(np.cross(by_u, spline(places, 1)), axis=1)
        total += weight * (np.diff(knots)[:, None] * weights).ravel() @ areas
    return total


def test_joints_of_a_loft_that_move_with_its_curves():
    """The knots of a C-loft follow its masters: at constant v derivatives have kinks there."""
    rng = np.random.default_rng(5)
    n = 6
    masters = rng.normal(scale=0.06, size=(n, 3, 3))
    angle = np.linspace(-1.4, 1.4, n)
    masters[:, :, 0] += [0, 2, 5]
    masters[:, :, 1] += (0.6 + 0.5 * np.sin(angle))[:, None] * [0.7, 1.0, 0.4]
    masters[:, :, 2] += (-2 + np.cumsum(np.abs(np.cos(angle)) + 0.1) / 4)[:, None] * [1, 1.1, 0.9]
    lines = []
    for i, master in enumerate(masters):
        names = [f"P{i}{j}" for j in range(3)]
        for name, (x, y, z) in zip(names, master.tolist(), strict=True):
            lines.append(f"AbsPoint {name}({x!r}, {y!r}, {z!r});")
        lines.append(f"BCurve c{i}({{{', '.join(names)}}}, degree = 2, visible = 0);")
    curves = ", ".join(f"c{i}" for i in range(n))
    m = moldloft.loads("\n".join([*lines, f"CLoftSurf s({{{curves}}}, divisions = {{4, 4}});"]))
    m.partial = True
    assert m.mesh().vertices[:, 2].max() < 0
    by = [f"P{i}{j}.{axis}" for i in range(n) for j in range(3) for axis in "xyz"]
    assert m.eval("s.area") == pytest.approx(loft_area(masters), rel=1e-8)
    exact = np.empty(masters.size)
    for k in range(masters.size):

        def area(h, k=k):
            moved = masters.copy()
            moved.ravel()[k] += h
            return loft_area(moved)

        h = 5e-4
        exact[k] = (8 * (area(h) - area(-h)) - (area(2 * h) - area(-2 * h))) / (12 * h)
    ahead = np.array(m.derivatives(["s.area"], by)[0])
    back, refused = of_figures(m, ["wetted_area", "volume"], by, "reverse")
    assert refused == []
    # Figures have the accuracy 1e-6; both modes differentiate the same quadrature.
    for found in (ahead, back[0]):
        assert np.abs(found - exact).max() < 1e-6 * np.abs(exact).max()
    assert np.abs(ahead - back[0]).max() < 1e-11 * np.abs(exact).max()
    assert_figures_agree(m, ("volume", "wetted_area", "vcb"), by)


def test_hydrostatics_of_panels_by_a_reverse_sweep():
    """A deformed mesh has no surface: its figures are those of its panels."""
    m = Deformation.of_mesh(*ball(), two_boxes()).model()
    names = ("volume", "wetted_area", "lcb", "waterplane_area", "kmt")
    assert_figures_agree(m, names, ["nose", "twist", "crown"])


def test_a_figure_that_does_not_exist_is_an_error():
    m = moldloft.load(EXAMPLES / "sailboat" / "yacht.sdl")
    by = m.literals[:12]
    with pytest.raises(moldloft.Error, match="has no `volumen`"):
        m.vjp({"hydrostatics.volumen": 1.0}, by)


# Model 4 alone takes a minute.
@pytest.mark.parametrize("seed", range(500) if SOAK else [0, 1, 2, 3, 5, 6, 7, 8])
def test_random_models_agree(seed):
    drawn = random_models.drawn(seed)
    m = moldloft.loads(drawn.text)
    rng = np.random.default_rng(seed)
    literals = m.literals
    by = ["w", *(literals[k] for k in rng.permutation(len(literals))[:11])]
    w = rng.normal(size=(2, *m.mesh().vertices.shape))
    outputs = [("mesh", w.reshape(2, -1)), ("mesh.volume", rng.normal(size=(2, 1)))]
    rows, ahead = _core.vjp(m._document, outputs, by, "reverse")
    exact, _ = _core.vjp(m._document, outputs, by, "forward")
    assert ahead == [] and close(rows, exact)
    if drawn.low < 0 < drawn.high:
        assert_figures_agree(m, ("volume", "wetted_area", "lcb", "waterplane_area", "kmt"), by)


def test_directions(hull):
    by = ["beam", "draft", *hull.literals]
    rates = dict(zip(by, np.random.default_rng(2).normal(size=len(by)).tolist(), strict=True))
    changes = hull.jvp(rates, ["mesh", "hull.area", "B"])
    exact = hull.jacobian(by) @ np.array(list(rates.values()))
    assert changes["mesh"].shape == exact.shape and np.abs(changes["mesh"] - exact).max() < 1e-12
    assert isinstance(changes["hull.area"], float) and changes["B"].shape == (3,)


def test_a_linearization_ends_with_its_state(hull):
    values, pull = hull.linearize(["mesh", "hull.area"])
    assert values["mesh"].shape == hull.mesh().vertices.shape
    gradient = pull({"hull.area": 1.0}, ["beam"])
    assert close(gradient, [hull.derivative("hull.area", "beam")])
    assert list(pull({"mesh": np.ones_like(values["mesh"])})) == ["beam", "draft", *hull.literals]
    with pytest.raises(moldloft.Error, match="not one of the outputs"):
        pull({"B": [1, 1, 1]})
    for change in ({"beam": 3.0}, {"F.y": 0.2}):
        hull.set(change)
        with pytest.raises(moldloft.Error, match="has changed since"):
            pull({"hull.area": 1.0}, ["beam"])
        values, pull = hull.linearize(["hull.area"])
        pull({"hull.area": 1.0}, ["beam"])


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({}, "one output at least"),
        ({"mesh": np.ones(7)}, r"the shape \(7,\)"),
        ({"mesh": np.ones((3, 70))}, r"expected: \(n, 3\)"),
        ({"mesh": np.ones((69, 3))}, "do not fit"),
        ({"B": np.ones(4)}, r"expected: \(3\)"),
        ({"hull.area": 1.0, "B": np.ones((2, 3))}, "as many sums"),
        ({"hull.area": np.nan}, "not a finite"),
        ({"hull": 1.0}, "has no derivative"),
        ({"nobody.x": 1.0}, "nobody"),
    ],
)
def test_weights_that_do_not_fit_are_refused(hull, weights, message):
    for by in (["beam"], ["beam", *hull.literals]):
        with pytest.raises(moldloft.Error, match=message):
            hull.vjp(weights, by)


def test_unknown_inputs_are_refused(hull):
    for name in ("nobody", "A.q", "E.y"):
        with pytest.raises(moldloft.Error, match=name.split(".")[-1]):
            hull.vjp({"mesh.area": 1.0}, [name, *hull.literals])


def test_python_functions_are_differentiated_by_calls_of_theirs():
    m = moldloft.loads(
        "param float a = 0.7 in [0, 2]; AbsPoint P(a, 1, 2); AbsPoint Q(bend(P.x, P.y), 3, 4);"
        "AbsPoint R(5, 6, 7); Line l(P, Q); Line k(R, Q); RuledSurf s(l, k, divisions = {3, 3});",
        functions={"bend": lambda x, y: x * np.sin(y) + x},
    )
    by = ["a", *m.literals]
    assert len(by) > 4
    w = np.random.default_rng(3).normal(size=m.mesh().vertices.shape)
    exact = np.einsum("vc,vcn->n", w, m.jacobian(by))
    rows, ahead = _core.vjp(m._document, [("mesh", w.reshape(1, -1))], by, "reverse")
    assert close(rows[0], exact) and ahead == []


#: Examples whose meshes reverse mode refuses, so that forward mode takes them.
AHEAD = {
    "gallery": {
        *("bracket", "caisson", "helmet", "lattice", "lock", "manifold", "rowing_shell"),
        *("spar", "swath"),
    },
    "implicit": {"lambdas", "lattices", "manifold", "neck", "quadric", "tee", "wave", "wires"},
    "missile": {"finned", "half"},
    "sketch": {"site"},
}


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*/*.sdl")), ids=lambda p: p.stem)
def test_examples_have_the_gradients_of_their_jacobians(path):
    m = moldloft.load(path)
    try:
        mesh = m.mesh()
        by = [p.name for p in m.params.values() if not p.whole][:12]
        by += m.literals[: 12 - len(by)] if len(by) < 12 else []
        jacobian = m.jacobian(by)
    except moldloft.Error as error:
        pytest.skip(str(error).splitlines()[0])
    w = np.random.default_rng(4).normal(size=mesh.vertices.shape)
    rows, ahead = _core.vjp(m._document, [("mesh", w.reshape(1, -1))], by, "reverse")
    # Forward mode beside itself would say nothing.
    expected = ["mesh"] if path.stem in AHEAD.get(path.parent.name, ()) else []
    assert ahead == expected
    assert close(rows[0], np.einsum("vc,vcn->n", w, jacobian))


def test_functions_of_studies(hull):
    inputs = ["beam", "draft", *hull.literals]
    of = function(hull, inputs, {"area": "mesh.area", "B": "B", "chord": "a({0.2, 0.6})"})
    x = of.start + 0.01
    jacobian = of.jacobian(x)
    w = np.random.default_rng(5).normal(size=(2, len(jacobian)))
    assert close(of.vjp(x, w), w @ jacobian) and close(of.vjp(x, w[0]), w[0] @ jacobian)
    rates = np.random.default_rng(6).normal(size=len(inputs))
    assert np.abs(of.jvp(x, rates) - jacobian @ rates).max() < 1e-12 * np.abs(jacobian).max()
    # A Hessian, by its products: symmetric, and that of differences of the Jacobian.
    along = np.random.default_rng(7).normal(size=(2, len(inputs)))
    second = [of.hvp(x, w[0], d) for d in along]
    size = max(np.abs(row).max() for row in second)
    assert abs(second[0] @ along[1] - second[1] @ along[0]) < 1e-6 * size * len(inputs)
    step = 1e-4 / np.abs(along[0]).max()
    pair = [of.jacobian(x + s * step * along[0]) for s in (1, -1)]
    assert np.abs(w[0] @ (pair[0] - pair[1]) / (2 * step) - second[0]).max() < 1e-5 * size
    assert (of.hvp(x, w[0], 0 * along[0]) == 0).all()
    with pytest.raises(moldloft.Error, match="a direction"):
        of.hvp(x, w[0], [1.0])
    # Many inputs for each output: rows by reverse mode.
    few = function(hull, inputs, ["mesh.area", "mesh.volume"])
    rows = hull.derivatives(["mesh.area", "mesh.volume"], inputs)
    assert close(few.jacobian(few.start), np.array(rows))
    with pytest.raises(moldloft.Error, match="weights"):
        of.vjp(x, [1.0])
    with pytest.raises(moldloft.Error, match="rates"):
        of.jvp(x, [1.0])
    near = few.start + 0.02
    values, rows = few.value_and_jacobian(near)
    assert np.array_equal(values, few(near)) and np.array_equal(rows, few.jacobian(near))


@pytest.mark.parametrize("matrix_free", [False, True])
def test_components_of_openmdao(hull, matrix_free):
    om = pytest.importorskip("openmdao.api")
    inputs = ["beam", "draft", *hull.literals]
    outputs = {"area": "mesh.area", "b": "B"}
    problem = om.Problem(reports=False)
    problem.model.add_subsystem(
        "hull", component(hull, inputs, outputs, matrix_free=matrix_free), promotes=["*"]
    )
    for mode in ("fwd", "rev"):
        problem.setup(mode=mode)
        problem.run_model()
        names = [name.replace(".", "_") for name in inputs]
        found = problem.compute_totals(of=["area", "b"], wrt=names)
        exact = function(hull, inputs, outputs).jacobian(function(hull, inputs, outputs).start)
        for k, name in enumerate(names):
            assert np.allclose(found["area", name][0, 0], exact[0, k], rtol=1e-11, atol=1e-12)
            assert np.allclose(found["b", name][:, 0], exact[1:, k], rtol=1e-11, atol=1e-12)


def test_a_function_of_jax(hull):
    jax = pytest.importorskip("jax")
    f = function(hull, ["beam", "draft", *hull.literals], ["mesh.area", "B"])
    x, w = f.start, np.array([1.0, 2.0, 3.0, 4.0])
    jax.config.update("jax_enable_x64", False)
    with pytest.raises(moldloft.Error, match="single precision"):
        jax_function(f)
    jax.config.update("jax_enable_x64", True)
    outputs = jax_function(f)
    found = jax.grad(lambda x: outputs(x) @ w)(x)
    assert close(np.asarray(found), w @ f.jacobian(x))
    assert close(np.asarray(jax.jacrev(outputs)(x)), f.jacobian(x))
    two = np.stack([x, x + 0.01])
    assert (np.asarray(jax.jit(jax.vmap(outputs))(two)) == [f(x), f(x + 0.01)]).all()


def test_a_function_of_torch(hull):
    torch = pytest.importorskip("torch")
    f = function(hull, ["beam", "draft", *hull.literals], ["mesh.area", "B"])
    outputs, w = torch_function(f), np.array([1.0, 2.0, 3.0, 4.0])
    x = torch.tensor(f.start, dtype=torch.float64, requires_grad=True)
    (outputs(x) @ torch.from_numpy(w)).backward()
    assert close(x.grad.numpy(), w @ f.jacobian(f.start))


@pytest.mark.parametrize(("made", "package"), [(jax_function, "jax"), (torch_function, "torch")])
def test_a_package_that_is_missing_is_named(hull, monkeypatch, made, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(moldloft.Error, match=rf"moldloft\[{package}\]"):
        made(function(hull, ["beam"], ["mesh.area"]))
