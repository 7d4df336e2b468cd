"""Free-form deformation against SciPy's B-splines, affine maps, differences and the chain rule."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import BSpline

import moldloft
from moldloft import study
from moldloft.deformation import Box, Deformation, Variable, _basis
from moldloft.exchange.mesh_files import mesh_of_file

ROOT = Path(__file__).parents[3]
SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def knots_of(degree: int, count: int) -> np.ndarray:
    inner = np.linspace(0, 1, count - degree + 1)
    return np.concatenate([np.zeros(degree), inner, np.ones(degree)])


def test_the_basis_is_that_of_scipy():
    rng = np.random.default_rng(1)
    for degree in range(1, 6):
        for count in (degree + 1, degree + 2, degree + 7):
            knots = knots_of(degree, count)
            u = np.concatenate([rng.random(200), knots, np.nextafter(knots, 0.5)])
            u = np.clip(u, 0, 1)
            first, values = _basis(degree, count, u)
            found = np.zeros((u.size, count))
            np.put_along_axis(found, first[:, None] + np.arange(degree + 1), values, axis=1)
            exact = BSpline.design_matrix(u, knots, degree).toarray()
            assert abs(found - exact).max() < 1e-14


def random_box(rng: np.random.Generator, fixed: int = 0) -> Box:
    degrees = tuple(int(d) for d in rng.integers(1, 5, 3))
    counts = tuple(
        d + 1 + 2 * fixed + int(k) for d, k in zip(degrees, rng.integers(0, 4, 3), strict=True)
    )
    edges = np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.5, 3, (3, 1))
    edges += 0.2 * rng.normal(size=(3, 3))
    return Box(rng.normal(size=3), edges, counts, degrees, fixed)


def of_definition(box: Box, net: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The tensor product at parameters, one direction after the other."""
    rows = [
        BSpline.design_matrix(c, knots_of(p, n), p).toarray()
        for c, p, n in zip(u.T, box.degrees, box.counts, strict=True)
    ]
    return np.einsum("ni,nj,nk,ijkc->nc", *rows, net)


def test_boxes_move_points_by_the_tensor_product():
    rng = np.random.default_rng(2)
    for _ in range(300 if SOAK else 30):
        box = random_box(rng)
        u = rng.random((40, 3))
        points = box.origin + u @ box.edges
        assert abs(box.parameters(points) - u).max() < 1e-12
        # The undeformed control points give the points themselves: the embedding is exact.
        assert abs(of_definition(box, box.control_points, u) - points).max() < 1e-13 * 10
        moves = rng.normal(size=(*box.counts, 3))
        expected = of_definition(box, box.control_points + moves, u)
        assert abs(points + box.displaced(moves, points) - expected).max() < 1e-12
        # An affine map of the control points is that of the points.
        affine, shift = rng.normal(size=(3, 3)), rng.normal(size=3)
        moves = box.control_points @ affine + shift - box.control_points
        assert abs(points + box.displaced(moves, points) - points @ affine - shift).max() < 1e-12
        outside = box.origin + (u + np.array([0, 1.001, 0])) @ box.edges
        assert not box.displaced(moves, outside).any()


def ball(count: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh of a unit sphere: quadrilaterals, with triangles at the poles."""
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    rows = np.linspace(0, np.pi, count // 2 + 1)[1:-1]
    rings = [
        [(np.sin(r) * np.cos(a), np.sin(r) * np.sin(a), -np.cos(r)) for a in angles] for r in rows
    ]
    points = np.array([(0, 0, -1.0), *(p for ring in rings for p in ring), (0, 0, 1.0)])
    number = 1 + np.arange(len(rows) * count).reshape(len(rows), count)
    after = np.roll(number, -1, axis=1)
    quads = [number[:-1], after[:-1], after[1:], number[1:]]
    faces = [np.stack([q.ravel() for q in quads], axis=1)]
    low, high = np.zeros(count, int), np.full(count, len(points) - 1)
    faces.append(np.stack([low, after[0], number[0], number[0]], axis=1))
    faces.append(np.stack([high, number[-1], after[-1], after[-1]], axis=1))
    return points, np.concatenate(faces)


def volume_slopes(points: np.ndarray, faces: np.ndarray) -> tuple[float, np.ndarray]:
    """Volume of bilinear quadrilaterals, and its derivatives by the corners."""
    a, b, c, d = (points[faces[:, k]] for k in range(4))
    value = ((np.cross(a, b) * (c + d)).sum() + (np.cross(c, d) * (a + b)).sum()) / 12
    parts = [
        np.cross(b, c + d) + np.cross(c, d),
        np.cross(c + d, a) + np.cross(c, d),
        np.cross(d, a + b) + np.cross(a, b),
        np.cross(a + b, c) + np.cross(a, b),
    ]
    slopes = np.zeros_like(points)
    for k, part in enumerate(parts):
        np.add.at(slopes, faces[:, k], part / 12)
    return value, slopes


def two_boxes() -> list[Variable]:
    fore = Box((0.1, -1.2, -1.2), np.diag([1.3, 2.4, 2.4]), (6, 5, 4), 3, ((2, 0), (0, 0), (0, 0)))
    turned = [[2.5, 0, 0], [0, 1.6, 0.4], [0.2, -0.3, 1.4]]
    top = Box((-1.3, -0.8, 0.2), turned, (4, 7, 5), (2, 3, 2), ((0, 0), (2, 2), (2, 0)))
    return [
        fore.move("nose", np.s_[4:], "x", low=-0.3, high=0.4),
        fore.move("twist", np.s_[3, :, 1:3], [0.1, 0.2, -0.3]),
        top.move("crown", None, "z", start=0.1),
    ]


def test_a_deformed_mesh_is_a_model_with_exact_derivatives():
    points, faces = ball()
    found = Deformation.of_mesh(points, faces, two_boxes())
    m = found.model()
    names = ["nose", "twist", "crown"]
    assert abs(m.mesh().vertices - found.deformed([0, 0, 0.1])).max() < 1e-15
    at = [0.2, -0.4, 0.3]
    m.set(dict(zip(names, at, strict=True)))
    moved = found.deformed(dict(zip(names, at, strict=True)))
    assert abs(m.mesh().vertices - moved).max() < 1e-15
    assert abs(m.jacobian(names) - np.moveaxis(found.modes, 0, 2)).max() < 1e-15
    volume, slopes = volume_slopes(moved, faces)
    assert abs(m.eval("mesh.volume") - volume) < 1e-13
    chain = found.gradient(slopes)
    assert np.allclose(m.derivatives(["mesh.volume"], names)[0], chain, rtol=1e-11, atol=1e-13)
    assert found.gradient([slopes, 2 * slopes]).shape == (2, 3)
    # The area by differences.
    exact = m.derivatives(["mesh.area"], names)[0]
    for k, name in enumerate(names):
        ends = []
        for step in (-1e-5, 1e-5):
            m.set({name: at[k] + step})
            ends.append(m.eval("mesh.area"))
        m.set({name: at[k]})
        assert abs((ends[1] - ends[0]) / 2e-5 - exact[k]) < 1e-8


@pytest.mark.parametrize("layers", [1, 2, 3])
def test_fixed_layers_keep_continuity(layers):
    """At a distance h within the side the displacement falls as h to the number of layers."""
    box = Box((0, 0, 0), np.eye(3), (9, 4, 4), 3, ((layers, 0), (0, 0), (0, 0)))
    moves = box.move("m", None, [1, 0.3, -0.4]).displacements
    sizes = [np.linalg.norm(box.displaced(moves, [[h, 0.3, 0.6]])) for h in (1e-3, 2e-3)]
    assert abs(np.log2(sizes[1] / sizes[0]) - layers) < 0.02


def test_a_shape_that_would_tear_is_refused():
    points, faces = ball()
    box = Box((0.1, -1.2, -1.2), np.diag([1.3, 2.4, 2.4]), (6, 4, 4), 3)
    with pytest.raises(moldloft.Error, match="side u = 0 of the box, where points move by"):
        Deformation.of_mesh(points, faces, [box.move("nose", None, "x")])
    held = box.move("nose", np.s_[2:], "x")
    assert Deformation.of_mesh(points, faces, [held]).modes.any()


def test_a_symmetric_deformation_moves_images():
    points, faces = ball(16)
    box = Box((-1.2, -1.2, -1.2), np.diag([2.4] * 3), (4, 5, 4), 2)
    variables = [box.move("beam", np.s_[:, 3:, :], "y"), box.move("keel", np.s_[:, :, 0], "z")]
    found = Deformation.of_mesh(points, faces, variables, symmetry="y")
    moved = found.deformed([0.3, -0.2])
    image = [int(np.argmin(np.linalg.norm(points - p * [1, -1, 1], axis=1))) for p in points]
    assert abs(moved[image] - moved * [1, -1, 1]).max() < 1e-14
    assert moved[:, 1].max() > 1.2 and "symmetry" not in found.text
    # The half alone gives the same half, and the model has the plane.
    keep = (points[faces][:, :, 1] >= -1e-12).all(axis=1)
    half_box = Box((-1.2, 0, -1.2), np.diag([2.4, 1.2, 2.4]), (4, 4, 4), 2)
    used, corners = np.unique(faces[keep], return_inverse=True)
    corners = corners.reshape(-1, 4)
    sides = [half_box.move("beam", np.s_[:, 2:, :], "y")]
    half = Deformation.of_mesh(points[used], corners, sides, symmetry="y")
    assert 'symmetry = "y"' in half.text
    on = abs(points[used][:, 1]) < 1e-12
    assert not half.modes[0][on, 1].any()
    with pytest.raises(moldloft.Error, match="plane y = 0 out of it"):
        Deformation.of_mesh(points, faces, [box.move("m", np.s_[:, 2, :], "y")], symmetry="y")
    with pytest.raises(moldloft.Error, match="not symmetric"):
        other = Box((-1.2, -1.3, -1.2), np.diag([2.4] * 3), (4, 5, 4), 2)
        Deformation.of_mesh(points, faces, [other.move("m", None, "z")], symmetry="y")
    with pytest.raises(moldloft.Error, match="differently"):
        Deformation.of_mesh(
            points,
            faces,
            [box.move("m", None, "x"), box.move("n", np.s_[:, ::4], "y")],
            symmetry="y",
        )


@pytest.mark.parametrize("ending", ["stl", "obj", "gdf"])
def test_meshes_are_read_deformed_and_written(tmp_path, ending):
    points, faces = ball()
    plain = Deformation.of_mesh(
        points - [0, 0, 2],
        faces,
        [Box.around(points, (4, 4, 4), 2).move("n", None, "x")],
        units="m",
    )
    source = tmp_path / f"ball.{ending}"
    plain.model().write(source)
    read = mesh_of_file(source, file_units="m")[1]
    box = Box.around(read, (5, 5, 5))
    found = Deformation.of_file(source, [box.move("long", np.s_[3:], "x")], file_units="m")
    m = found.model()
    m["long"] = 0.7
    m.write(tmp_path / f"long.{ending}")
    again = mesh_of_file(tmp_path / f"long.{ending}", file_units="m")[1]
    # STL has single precision, GDF eight digits.
    off = np.linalg.norm(again[:, None] - found.deformed([0.7])[None], axis=2).min(axis=1)
    assert len(again) == len(read) and off.max() < 1e-6
    assert again[:, 0].max() > 1.3


PATCH = """
AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0.3); AbsPoint C(0, 1, 0.2); AbsPoint D(2, 1, 0);
AbsPoint E(1, 0.2, 0.8); AbsPoint F(1, 0.8, 0.5);
BCurve p({A, E, B}, degree = 2); BCurve q({C, F, D}, degree = 2);
RuledSurf s(p, q, divisions = {6, 4});
"""


def test_surfaces_move_with_their_control_points():
    net = moldloft.loads(PATCH)["s"].to_nurbs()
    box = Box((-0.1, -0.1, -0.5), np.diag([2.2, 1.2, 1.5]), (3, 3, 3), 2)
    sheared = box.control_points @ [[0, 0, 0.4], [0, 0, 0], [0, 0, 0]]
    found = Deformation.of_surfaces(
        {"s": net}, [Variable("shear", box, sheared), box.move("up", np.s_[1, 1, 1], "z")]
    )
    m = found.model()
    m["shear"] = 1.0
    u, v = np.random.default_rng(3).random((2, 50))
    expected = net(u, v)
    expected = expected + expected @ [[0, 0, 0.4], [0, 0, 0], [0, 0, 0]]
    # An affine map is exact for the surface itself.
    assert abs(m["s"].to_nurbs()(u, v) - expected).max() < 1e-14
    m["up"] = 0.3
    moved = found.deformed([1.0, 0.3]).reshape(net.points.shape)
    assert abs(m["s"].to_nurbs().points - moved).max() < 1e-15
    steps = []
    for value in (0.3 - 1e-6, 0.3 + 1e-6):
        m["up"] = value
        steps.append(m.eval("s.area"))
    m["up"] = 0.3
    slope = m.derivatives(["s.area"], ["up"])[0][0]
    assert abs((steps[1] - steps[0]) / 2e-6 - slope) < 1e-7 and slope != 0


def test_variables_are_inputs_of_studies(tmp_path: Path):
    """Of all stretched balls of one volume the round one has the least area."""
    points, faces = ball(16)
    box = Box.around(points, (4, 4, 4))
    stretches = []
    for axis, name in enumerate(("a", "b", "c")):
        moves = np.zeros((4, 4, 4, 3))
        moves[..., axis] = box.control_points[..., axis]
        stretches.append(Variable(name, box, moves, -0.5, 1.0, (0.3, -0.2, 0.1)[axis]))
    found = Deformation.of_mesh(points, faces, stretches)
    (tmp_path / "ball.sdl").write_text(found.text)
    volume, _ = volume_slopes(points, faces)
    best = study.optimize(
        study.Study(
            model=tmp_path / "ball.sdl",
            inputs=tuple(study.Input(n) for n in "abc"),
            outputs={"area": "mesh.area", "volume": "mesh.volume"},
            constraints=(study.Bound("kept", "volume", volume, volume),),
            goal=study.Goal((study.Objective("area"),), evaluations=40),
            folder=tmp_path,
        ),
        tmp_path / "s.sqlite",
    )
    assert best.converged and best.feasible
    assert abs(best.inputs["a"] - best.inputs["b"]) < 2e-3 and abs(best.inputs["a"]) < 0.03


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Box((0, 0, 0), np.ones((3, 3)), (4, 4, 4)), "three directions"),
        (lambda: Box((0, 0, 0), np.eye(3), (4, 3, 4)), "3 control points along v"),
        (lambda: Box((0, 0, 0), np.eye(3), (4, 4, 4), 0), "degree 0"),
        (lambda: Box((0, 0, 0), np.eye(3), (4, 4, 4), 3, 2), "leave no free layer of 4"),
        (lambda: Box((0, 0), np.eye(3), (4, 4, 4)), "origin"),
        (lambda: Box((0, 0, 0), np.eye(3), (6, 6, 6), 3, 1).move("n", np.s_[0]), "fixed layer"),
        (lambda: Box((0, 0, 0), np.eye(3), (4, 4, 4)).move("n", np.s_[9]), "no such control"),
        (lambda: Box((0, 0, 0), np.eye(3), (4, 4, 4)).move("n", None, "w"), "expected direction"),
        (lambda: far(), "moves no point"),
        (lambda: Deformation.of_mesh(*ball(), []), "needs a variable"),
        (lambda: Deformation.of_mesh(*ball(), two_boxes()).deformed([1]), "3 values are needed"),
        (
            lambda: Deformation.of_mesh(*ball(), two_boxes()).deformed({"x": 1}),
            "unknown variable `x`",
        ),
        (lambda: Deformation.of_mesh(ball()[0][:9], ball()[1], two_boxes()), "of 9 points"),
    ],
)
def test_wrong_boxes_are_said(make, said):
    with pytest.raises(moldloft.Error, match=said):
        make()


def far() -> Deformation:
    box = Box((5, 5, 5), np.eye(3), (4, 4, 4))
    return Deformation.of_mesh(*ball(), [box.move("n", None, "x")])


def test_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "deformation.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    found: dict = {}
    exec(compile(block, "deformation.md", "exec"), found)
    assert found["m"].derivatives(["mesh.area"], ["fuller"])[0][0] != 0
    written = mesh_of_file(tmp_path / "fuller.stl", file_units="m")[1]
    assert abs(written - mesh_of_file(tmp_path / "side.stl", file_units="m")[1]).max() > 0.05
    assert list(moldloft.load(tmp_path / "side.sdl").params) == ["fuller", "sheer"]


def test_the_example_reads_a_hull_and_betters_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(ROOT / "examples" / "studies"))
    from deformed_hull import best

    found, drawn = best(tmp_path)
    assert found.converged and found.feasible and found.evaluations <= 20
    # As docs/deformation.md states.
    assert abs(drawn["area"] - 20.800) < 1e-3 and abs(found.outputs["area"] - 20.133) < 2e-3
    assert abs(found.outputs["volume"] - drawn["volume"]) < 1e-5
