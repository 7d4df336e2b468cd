"""Trimmed faces: panels and measures; sides of faces; meshes as bodies; calculus on arrays."""

from __future__ import annotations

import math
import os
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft

ROUNDS = 40 if os.environ.get("MOLDLOFT_SOAK") == "1" else 3


def strip(turns: float, more: str = "") -> str:
    """A strip between two helices of pitch 1, cut at 5 and 95 % and at 10 and 90 %."""
    return f"""
    Model info(units = "mm"); AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line ax(O, Z);
    AbsPoint P(3, 0, 0); AbsPoint Q(2.5, 0, 0.3); Helix a(P, ax, {turns} * 2 * PI, 1);
    Helix b(Q, ax, {turns} * 2 * PI, 1); RuledSurf S(a, b, visible = 0);
    AbsMagnet p(S, 0.05, 0.1); AbsMagnet q(S, 0.95, 0.1); AbsMagnet r(S, 0.95, 0.9);
    AbsMagnet s(S, 0.05, 0.9); LineSnake pq(p, q); LineSnake qr(q, r); LineSnake rs(r, s);
    LineSnake sp(s, p); TrimSurf T(S, {{pq, qr, rs, sp}}{more});
    """


def strip_area(turns: float) -> float:
    """The same by quadrature: the integrand does not depend on u."""
    x, w = np.polynomial.legendre.leggauss(40)
    r, k = 3 - 0.5 * (0.1 + 0.4 * (x + 1)), 2 * math.pi * turns
    size = np.sqrt((0.3 * r * k) ** 2 + (0.5 * turns) ** 2 + (0.5 * r * k) ** 2)
    return float(0.9 * 0.4 * (w * size).sum())


@pytest.mark.parametrize("turns", [2, 10, 50])
def test_strips_of_many_turns(turns: int) -> None:
    m = moldloft.loads(strip(turns))
    area = strip_area(turns)
    assert m["T"].area == pytest.approx(area, rel=1e-8)
    (patch,) = m.mesh().patches
    assert patch.area == pytest.approx(area, rel=1e-3)
    # Nearer when it is asked for.
    (fine,) = m.mesh(angle=0.02).patches
    assert fine.area == pytest.approx(area, rel=1e-4) and fine.panels > patch.panels


def test_panels_within_a_tolerance_and_an_angle() -> None:
    m = moldloft.loads("""
    AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2); AbsPoint E(2, 0, 0); Line axis(S, N);
    Arc half(S, N, E, type = 5); RevSurf ball(half, axis);
    """)
    for tolerance in (0.1, 0.01, 0.001):
        mesh = m.mesh(tolerance=tolerance)
        corners = mesh.vertices[mesh.faces]
        middles = corners.mean(axis=1)
        assert 2 - np.linalg.norm(middles, axis=1).min() <= tolerance
        assert np.abs(np.linalg.norm(mesh.vertices, axis=1) - 2).max() < 1e-12
    rough, fine = (len(m.mesh(angle=angle).faces) for angle in (0.4, 0.1))
    assert fine > 8 * rough
    for wrong in ({"tolerance": 0.0}, {"angle": -1.0}, {"tolerance": math.nan}):
        with pytest.raises(moldloft.ModelError):
            m.mesh(**wrong)


def test_files_of_panels_take_a_tolerance(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    m = moldloft.loads("""
    AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2); AbsPoint E(2, 0, 0); Line axis(S, N);
    Arc half(S, N, E, type = 5); RevSurf ball(half, axis);
    """)
    (path,) = m.write(tmp_path / "ball.stl", tolerance=0.0005)
    found = trimesh.load(path)
    assert found.is_watertight and found.volume == pytest.approx(32 * math.pi / 3, rel=1e-3)
    assert m.to_trimesh(tolerance=0.0005).volume == pytest.approx(32 * math.pi / 3, rel=1e-3)
    with pytest.raises(moldloft.FormatError):
        m.write(tmp_path / "ball.step", angle=0.1)


WINDOW = """
AbsPoint A(0, 0, 0); AbsPoint B(4, 0, {h}); AbsPoint C(0, 3, {k}); AbsPoint D(4, 3, 0);
AbsPoint M(2, 0, {m}); BCurve l({{A, M, B}}); Line n(C, D); RuledSurf S(l, n, visible = 0{turned});
AbsMagnet a(S, 0.5, 0.5); AbsMagnet b(S, 0.75, 0.5); AbsMagnet c(S, 0.5, 0.7);
ArcSnake round(b, a, c, type = 6); TrimSurf rest(S, {{round}}, whole = 1, orientation = {side});
"""


def test_faces_keep_their_side_in_every_format(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    rhino = pytest.importorskip("rhino3dm")
    from OCP.BRep import BRep_Tool
    from OCP.BRepGProp import BRepGProp
    from OCP.gp import gp_Pnt, gp_Vec
    from OCP.GProp import GProp_GProps
    from OCP.IGESControl import IGESControl_Reader
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    def normals(path: Path) -> list[np.ndarray]:
        reader = STEPControl_Reader() if path.suffix == ".step" else IGESControl_Reader()
        reader.ReadFile(str(path))
        reader.TransferRoots()
        faces = TopExp_Explorer(reader.OneShape(), TopAbs_FACE)
        found = []
        while faces.More():
            face = TopoDS.Face(faces.Current())
            surface = BRep_Tool.Surface_s(face)
            u0, u1, v0, v1 = surface.Bounds()
            p, su, sv = gp_Pnt(), gp_Vec(), gp_Vec()
            surface.D1(0.3 * u0 + 0.7 * u1, 0.3 * v0 + 0.7 * v1, p, su, sv)
            n = su.Crossed(sv)
            sign = -1 if face.Orientation() == TopAbs_REVERSED else 1
            props = GProp_GProps()
            BRepGProp.SurfaceProperties_s(face, props)
            found.append(sign * np.array([n.X(), n.Y(), n.Z()]))
            faces.Next()
        return found

    def upward(shape: Any) -> bool:
        if isinstance(shape, rhino.NurbsSurface):
            return bool(shape.NormalAt(0.5, 0.5).Z > 0)
        (face,) = shape.Faces
        return bool(
            (face.UnderlyingSurface().NormalAt(0.5, 0.5).Z > 0) != face.OrientationIsReversed
        )

    rng = random.Random(5)
    for _ in range(ROUNDS):
        for side in (0, 1):
            h, k, m = (round(rng.uniform(-1, 1), 3) for _ in range(3))
            text = WINDOW.format(h=h, k=k, m=m, turned="", side=side)
            model = moldloft.loads(text + f"RuledSurf T(n, l, orientation = {side});")
            ways = {}
            for ending in ("step", "igs"):
                (path,) = model.write(tmp_path / f"model.{ending}")
                ways[ending] = normals(path)
            up = [bool(n[2] > 0) for n in ways["step"]]
            assert up == [bool(n[2] > 0) for n in ways["igs"]], (h, k, m, side)
            (path,) = model.write(tmp_path / "model.3dm")
            shapes = [o.Geometry for o in rhino.File3dm.Read(str(path)).Objects]
            said = [upward(g) for g in shapes if isinstance(g, (rhino.NurbsSurface, rhino.Brep))]
            assert said == up, (h, k, m, side)


def test_calculus_on_arrays() -> None:
    m = moldloft.loads("""
    AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2); AbsPoint E(2, 0, 0); Line axis(S, N);
    Arc half(S, N, E, type = 5); RevSurf ball(half, axis);
    BCurve c({{0, 0, 0}, {1, 2, 0}, {3, 1, 1}, {4, 0, 0}});
    """)
    rng = np.random.default_rng(3)
    u, v = rng.uniform(0.05, 0.95, (2, 4, 5))
    ball, step = m["ball"], 1e-5
    for du, dv in ((1, 0), (0, 1)):
        exact = ball.derivative(u, v, du, dv)
        near = (ball(u + du * step, v + dv * step) - ball(u - du * step, v - dv * step)) / 2 / step
        assert exact.shape == (4, 5, 3) and np.abs(exact - near).max() < 1e-7
    for du, dv in ((2, 0), (1, 1), (0, 2)):
        a = (1, 0) if du else (0, 1)
        b = (du - a[0], dv - a[1])
        near = ball.derivative(u + b[0] * step, v + b[1] * step, *a)
        near = (near - ball.derivative(u - b[0] * step, v - b[1] * step, *a)) / 2 / step
        assert np.abs(ball.derivative(u, v, du, dv) - near).max() < 1e-6
    radial = ball(u, v) / 2
    assert np.abs(np.abs((ball.normal(u, v) * radial).sum(axis=-1)) - 1).max() < 1e-12
    # Where both are equal they are a double root, known to the root of rounding; the sum is exact.
    both = np.array(ball.curvature(u, v))
    assert np.abs(np.abs(both) - 0.5).max() < 1e-7
    assert np.abs(np.abs(both.sum(axis=0)) - 1).max() < 1e-12
    t = rng.uniform(0, 1, 7)
    curve = m["c"]
    assert np.abs(np.linalg.norm(curve.tangent(t), axis=-1) - 1).max() < 1e-14
    near = (curve(t + step, beyond=True) - curve(t - step, beyond=True)) / 2 / step
    assert np.abs(curve.derivative(t) - near).max() < 1e-8
    for call in (
        lambda: curve(1.2),
        lambda: ball(0.2, -0.1),
        lambda: curve.tangent([0.5, 2]),
        lambda: ball.normal(math.nan, 0),
        lambda: ball.derivative(0.1, 0.2, 2, 1),
    ):
        with pytest.raises(moldloft.ModelError):
            call()
    assert curve(1.2, beyond=True).shape == (3,)


def test_meshes_are_bodies(tmp_path: Path) -> None:
    pytest.importorskip("meshio")
    m = moldloft.loads("""
    Model info(units = "m"); Line a({0, 0, -1}, {2, 0, -1}); Line b({0, 1, -1}, {2, 1, -1});
    set s = cuboid({0, 0, -1}, {2, 1, 1});
    SetBody box(s, depth = 3);
    """)
    for ending in ("stl", "obj", "ply", "gdf"):
        (path,) = m.write(tmp_path / f"box.{ending}")
        body = moldloft.read_mesh(path, file_units="" if ending == "gdf" else "m")
        assert body["body"].volume == pytest.approx(4, rel=1e-6)
        assert body.hydrostatics().volume == pytest.approx(2, rel=1e-6)
        (again,) = body.write(tmp_path / "again.off")
        assert again.stat().st_size > 100
    # Quadrilaterals stay such.
    plate = moldloft.loads(
        "Line a({0, 0, -1}, {2, 0, -1}); Line b({0, 1, -1}, {2, 1, -1}); "
        "RuledSurf plate(a, b, divisions = {4, 3});"
    )
    plate.partial = True
    with pytest.warns(UserWarning, match="open below the water"):
        (path,) = plate.write(tmp_path / "plate.gdf")
    assert len(moldloft.read_mesh(path).mesh().faces) == 12
    (path,) = plate.write(tmp_path / "plate.obj")
    assert moldloft.read_mesh(path, file_units="mm", units="m")["body"].area == pytest.approx(2e-6)


@pytest.mark.parametrize(
    "ending", ["stl", "gdf", "glb", "msh", "obj", "ply", "off", "su2", "mar", "pnl", "3mf", "step"]
)
def test_empty_models_are_refused(ending: str, tmp_path: Path) -> None:
    m = moldloft.loads("param float x = 1 in [0, 2];")
    names = {"mar": "nemoh", "pnl": "hams"}
    with pytest.raises(moldloft.Error) as caught:
        m.write(tmp_path / f"model.{ending}", format=names.get(ending))
    assert isinstance(caught.value, ValueError)
    assert not list(tmp_path.iterdir())


def test_one_exception_for_each_cause(tmp_path: Path) -> None:
    m = moldloft.loads(
        "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 0}); RuledSurf s(a, b);"
    )
    for name, options in (
        ("x.unheard", {}),
        ("x.stl", {"lids": True}),
        ("x.cgns", {"triangles": True}),
    ):
        with pytest.raises(moldloft.FormatError):
            m.write(tmp_path / name, **options)
    with pytest.raises(moldloft.ModelError):
        m.write(tmp_path / "x.stl", tags="nowhere")
    with pytest.raises(moldloft.FileError):
        m.write(tmp_path / "nowhere" / "x.stl")


def test_a_mesh_in_a_drawing_keeps_the_rest(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    from moldloft import overlays

    drawing = ezdxf.new()
    space = drawing.modelspace()
    with space.add_mesh().edit_data() as data:
        data.vertices = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        data.faces = [[0, 1, 2, 3]]
    space.add_line((0, 0), (1, 1))
    drawing.saveas(tmp_path / "mesh.dxf")
    found = overlays.read(tmp_path / "mesh.dxf")
    assert len(found.curves) == 1 and len(found.faces) == 2


def test_both_sides_and_si_for_other_packages() -> None:
    pytest.importorskip("trimesh")
    hull = """
    Model info(units = "ft", symmetry = "y"); AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2);
    AbsPoint E(2, 0, 0); Line axis(S, N); Arc half(S, E, N, type = 1);
    RevSurf ball(half, axis, 0, PI, divisions = {24, 24});
    """
    m = moldloft.loads(hull)
    half, whole = m.to_trimesh(), m.to_trimesh(whole=True)
    assert len(whole.faces) == 2 * len(half.faces) and whole.is_watertight
    capytaine = pytest.importorskip("capytaine")
    assert capytaine
    body = m.to_capytaine(centre=[0, 0, -0.5], mass=300.0)
    radius = 2 * 0.3048
    assert body.mesh.volume == pytest.approx(2 / 3 * math.pi * radius**3, rel=0.02)
    assert len(body.dofs) == 6 and body.mass == 300
    assert body.center_of_mass[2] == pytest.approx(-0.5 * 0.3048)


def test_an_older_occt_in_the_same_place_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("OCP")
    from moldloft import cad

    monkeypatch.setattr(cad, "_has_collections", lambda _: False)
    with pytest.raises(moldloft.MissingPackageError, match="force-reinstall") as caught:
        moldloft.loads("Line a({0, 0, 0}, {1, 0, 0});").to_ocp()
    assert isinstance(caught.value, ImportError)


def test_packed_and_marked_files_and_breps(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    import zipfile

    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.BRepTools import BRepTools

    from moldloft.cad.importing import program

    m = moldloft.loads('Model info(units = "mm"); ' + strip(2).split(";", 1)[1])
    (step,) = m.write(tmp_path / "strip.step")
    with zipfile.ZipFile(tmp_path / "strip.stpz", "w") as packed:
        packed.write(step, "strip.step")
    (tmp_path / "marked.step").write_bytes(b"\xef\xbb\xbf" + step.read_bytes())
    for name in ("strip.step", "strip.stpz", "marked.step"):
        text, _ = program(tmp_path / name, units="mm")
        again = moldloft.loads(text)
        (patch,) = again.mesh().patches
        assert patch.area == pytest.approx(strip_area(2), rel=1e-3)
        assert again.eval(f"{patch.name}.area") == pytest.approx(strip_area(2), rel=1e-5)
    BRepTools.Write_s(BRepPrimAPI_MakeBox(10, 20, 30).Shape(), str(tmp_path / "box.brep"))
    text, remarks = program(tmp_path / "box.brep", units="mm")
    assert moldloft.loads(text).mesh().closed and "millimetres" in remarks[0]


def test_a_side_without_length_is_not_divided() -> None:
    """A loop with a side of 1e-14, whose turn is noise."""
    noise = 5e-15 * np.random.default_rng(3).uniform(-1, 1, (12, 2)) + (0.5, 0.9)
    points = "".join(f"AbsMagnet k{i}(s, {u!r}, {v!r});" for i, (u, v) in enumerate(noise.tolist()))
    names = ", ".join(f"k{i}" for i in range(12))
    model = moldloft.loads(
        f"""AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 1); BCurve a({{A, {{2, 0, 2}}, B}});
        BCurve b({{{{0, 3, 0}}, {{2, 3, 3}}, {{4, 3, 0}}}}); RuledSurf s(a, b, visible = 0);
        AbsMagnet m1(s, 0.2, 0.2); AbsMagnet m2(s, 0.8, 0.3); {points}
        LineSnake l1(m1, m2); LineSnake l2(m2, k0); BSnake l3({{{names}}}, 3);
        LineSnake l4(k11, m1); TrimSurf face(s, {{l1, l2, l3, l4}});""",
        strict=False,
    )
    mesh = model.mesh()
    assert len(mesh.faces) < 250
    assert mesh.area == pytest.approx(model["face"].area, rel=1e-3)
