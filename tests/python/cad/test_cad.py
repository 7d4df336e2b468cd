"""CAD files judged by other programs: OCCT, gmsh, steputils, ezdxf and rhino3dm."""

from __future__ import annotations

import math
import os
import random
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import moldloft
from cad_models import GENERATORS, Case, box, cylinder, random_sphere, wigley

ROOT = Path(__file__).parents[3]
ROUNDS = 20 if os.environ.get("MOLDLOFT_SOAK") == "1" else 1
QUARTER = "AbsPoint A(2, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 2, 0); Arc a(A, O, B, type = 2);"


def cases() -> list[Case]:
    rng = random.Random(22)
    return [make(rng) for _ in range(ROUNDS) for make in GENERATORS]


@pytest.mark.parametrize("case", cases(), ids=lambda c: c.name)
def test_bodies_come_out_of_step_as_they_are(case: Case, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    model = moldloft.loads(case.text)
    (path,) = model.write(tmp_path / "model.step")
    found = read(path)
    assert found.valid and found.faces == case.faces
    assert found.area == pytest.approx(case.area, rel=3e-6)
    assert found.tolerance <= 1e-6 and found.colours
    if case.closed:
        assert found.solids == found.closed == 1
        # Outward: the volume is positive.
        assert found.volume == pytest.approx(case.volume, rel=1e-9)
    sense(path.read_text())
    # The same model gives the same bytes.
    (tmp_path / "again").mkdir()
    assert model.write(tmp_path / "again" / "model.step")[0].read_bytes() == path.read_bytes()


@pytest.mark.parametrize("case", cases(), ids=lambda c: c.name)
def test_faces_come_out_of_iges_as_they_are(case: Case, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    (path,) = moldloft.loads(case.text).write(tmp_path / "model.igs")
    assert all(len(line) == 80 for line in path.read_text().splitlines())
    found = read(path)
    assert found.valid and found.faces == case.faces and found.colours
    assert found.area == pytest.approx(case.area, rel=3e-6)


QUICK = ("gallery/spar.sdl", "gallery/planing.sdl", "gallery/tug.sdl", "sailboat/hull.sdl")
METRES = {"m": 1.0, "mm": 0.001, "cm": 0.01, "ft": 0.3048, "in": 0.0254}


def examples() -> list[str]:
    """Examples of surfaces; all of them, but the propeller (minutes), in the long run."""
    if ROUNDS == 1:
        return list(QUICK)
    files = sorted((ROOT / "examples").glob("*/*.sdl"))
    surfaces = [f for f in files if "SetBody" not in f.read_text(encoding="utf-8")]
    names = [f.relative_to(ROOT / "examples").as_posix() for f in surfaces]
    # Programs of arrays alone have no surfaces.
    arrays = ("missile/volume.sdl",)
    other = ("implicit", "propeller", "sketch")
    return [n for n in names if n.split("/")[0] not in other and n not in arrays]


@pytest.mark.parametrize("name", examples())
def test_examples_have_their_areas_in_step_and_iges(name: str, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    model = moldloft.load(ROOT / "examples" / name)
    surfaces = dict.fromkeys(p.name for p in model.mesh().patches)
    unit = METRES[moldloft._core.length_unit(model._document)[0]]
    area = sum(model[n].area for n in surfaces) * unit**2 * 2 ** len(model.symmetry)
    (step,) = model.write(tmp_path / "model.step")
    (iges,) = model.write(tmp_path / "model.igs")
    text = step.read_text()
    sense(text)
    for path in (step, iges):
        found = read(path)
        assert found.valid and found.faces == text.count("=ADVANCED_FACE(")
        assert found.area == pytest.approx(area, rel=1e-6)
        assert found.colours
    assert read(step).closed == text.count("=CLOSED_SHELL(")


PARTS = 60 if ROUNDS > 1 else 6


@pytest.mark.parametrize("seed", range(PARTS))
def test_parts_across_a_joint_are_trimmed_faces_of_their_surface(seed: int, tmp_path: Path) -> None:
    """A nose of revolution cut askew across its joint: the part, its image, and a turned copy."""
    pytest.importorskip("OCP")
    from cad_reading import read

    rng = random.Random(seed)
    nose, length, lean = rng.uniform(0.5, 1.5), rng.uniform(1, 2), rng.uniform(0.1, 0.3)
    turn = rng.choice(["PI", "1.5*PI", "-PI"])
    ends = [(0, 0), (1, 1)] if rng.random() < 0.5 else [(1, 0), (0, 1)]
    # From the tip, where the first side is a point, or from one ring to another.
    inner = "nose.u0" if rng.random() < 0.5 else "early"
    text = f"""
    AbsPoint T({-nose!r}, 0, 0); AbsPoint K({-nose!r}, 0, 1); AbsPoint N(0, 0, 1);
    AbsPoint E({length!r}, 0, 1); AbsPoint M({length!r}, 0, 0);
    NURBCurve bow({{T, K, N}}, degree = 2, knots = {{0, 0, 0, 1, 1, 1}},
        weights = {{1, sqrt(0.5), 1}});
    Line run(N, E); PolyCurve profile({{bow, run}}); Line axis(T, M);
    RevSurf nose(profile, axis, 0, {turn}, visible = 0);
    AbsMagnet a(nose, {0.5 - lean!r}, {ends[0][1]});
    AbsMagnet b(nose, {0.5 + lean!r}, {ends[1][1]});
    AbsMagnet c(nose, 0.05, 0); AbsMagnet d(nose, {rng.uniform(0.06, 0.15)!r}, 1);
    BSnake rim({{a, b}}); LineSnake early(c, d);
    SubSurf part({{rim, {inner}}});
    MirrSurf port(part, "z=-3"); RotatSurf other(part, axis, {rng.uniform(0.2, 2)!r}, visible = 0);
    """
    model = moldloft.loads(text)
    (step,) = model.write(tmp_path / "part.step")
    found = read(step)
    assert found.valid and found.faces == 2
    assert found.area == pytest.approx(2 * model.eval("part.area"), rel=3e-6)
    assert model.eval("part.area") == pytest.approx(model.eval("other.area"), rel=1e-10)


def sense(text: str) -> None:
    """What OCCT heals without a word: undefined entities, and edges of closed shells."""
    plain = re.sub(r"'(?:[^']|'')*'", "''", text)
    entities = dict(re.findall(r"^#(\d+)=(.*);$", plain, re.M))
    assert not {n for body in entities.values() for n in re.findall(r"#(\d+)", body)} - set(
        entities
    )
    refers = {k: re.findall(r"#(\d+)", body) for k, body in entities.items()}
    for shell, body in entities.items():
        if not body.startswith("CLOSED_SHELL"):
            continue
        uses: dict[str, list[bool]] = {}
        vertices, loops = set(), 0
        for face in refers[shell]:
            bounds = re.match(r"ADVANCED_FACE\('',\(([^)]*)\)", entities[face])
            assert bounds
            for bound in re.findall(r"#(\d+)", bounds[1]):
                loops += 1
                for oriented in refers[refers[bound][0]]:
                    edge = refers[oriented][0]
                    uses.setdefault(edge, []).append(entities[oriented].endswith(".T.)"))
                    vertices.update(refers[edge][:2])
        assert all(sorted(u) == [False, True] for u in uses.values())
        faces = len(refers[shell])
        assert (len(vertices) - len(uses) + faces - (loops - faces)) % 2 == 0


def test_a_symmetric_half_is_written_whole_and_sewn(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    length, beam, draft = 10.0, 2.0, 1.0
    text = wigley(length, beam, draft)
    (path,) = moldloft.loads(text).write(tmp_path / "wigley.step")
    found = read(path)
    assert (found.shells, found.faces, found.valid) == (1, 2, True)
    # facts of the Wigley hull of length 10, beam 2, draft 1.
    assert found.area == pytest.approx(25.704433906299, rel=1e-5)


def test_units_names_and_layers_arrive(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    text = box(1, 2, 3).replace(
        "RuledSurf x0(lx00, lx01", 'RuledSurf x0(lx00, lx01, tags = {"port"}'
    )
    for unit, metres in [("m", 1.0), ("mm", 0.001), ("cm", 0.01), ("ft", 0.3048), ("in", 0.0254)]:
        model = moldloft.loads(f'Model info(units = "{unit}"); {text}')
        found = read(model.write(tmp_path / f"{unit}.step")[0])
        assert found.volume == pytest.approx(6 * metres**3, rel=1e-9)
        assert {"x0", "y1", "z0"} <= found.names
        assert "port" in found.layers
        assert read(model.write(tmp_path / f"{unit}.igs")[0]).area == pytest.approx(
            22 * metres**2, rel=1e-9
        )


def test_fits_say_their_error_and_keep_it(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    text = """
        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 1); AbsPoint D(4, 3, 0.5);
        AbsPoint E(2, -1, 1); AbsPoint F(2, 3, -1); BCurve a({A, E, B}); BCurve b({C, F, D});
        RuledSurf base(a, b, visible = 0); OffsetSurf off(base, 0.25);
    """
    model = moldloft.loads(text)
    fine = model["off"].grid(60, 60).reshape(-1, 3)
    for accuracy in (1e-2, 1e-4, 1e-6):
        nurbs = model["off"].to_nurbs(accuracy=accuracy)
        assert not nurbs.exact and nurbs.error <= accuracy * 1.0001
        s = np.linspace(0, 1, 60)
        off = np.linalg.norm(nurbs(s[:, None], s[None, :]).reshape(-1, 3) - fine, axis=1).max()
        assert 1e-4 * nurbs.error < off <= nurbs.error
        (path,) = model.write(tmp_path / "off.step", tolerance=accuracy)
        assert "surfaces within" in path.read_text()
        found = read(path)
        # The area changes with the square of the size times the error at most.
        assert found.area == pytest.approx(model["off"].area, rel=max(3 * accuracy, 3e-3))


def test_nurbs_of_all_kinds_of_shapes_are_those_shapes() -> None:
    model = moldloft.loads(
        QUARTER
        + """
        AbsPoint C(0, 0, 3); AbsPoint D(2, 1, 3); Line up(O, C); BCurve b({A, D, C}, 2);
        RevSurf cone(b, up, 0, 2.5); AbsMagnet p(cone, 0.2, 0.1); AbsMagnet q(cone, 0.8, 0.9);
        LineSnake s(p, q); TranSurf t(a, b); RuledSurf r(a, b);
        """
    )
    u = np.linspace(0, 1, 37)
    for name, exact in [("a", True), ("b", True), ("cone", True), ("t", True), ("s", False)]:
        nurbs = model[name].to_nurbs()
        assert nurbs.exact is exact, name
        s = (u,) if nurbs.dimension == 1 else (u[:, None], u[None, :])
        at = np.broadcast_arrays(*nurbs.parameters(*s))
        assert np.abs(model[name](*at) - nurbs(*s)).max() <= max(nurbs.error, 1e-13), name
    for name in ("a", "cone", "t"):
        nurbs = model[name].to_nurbs()
        again = moldloft.loads(nurbs.to_sdl("again"))["again"].to_nurbs()
        assert np.abs(again.points - nurbs.points).max() < 1e-12


def test_a_mirrored_or_turned_image_is_exact_too() -> None:
    model = moldloft.loads(
        QUARTER + 'MirrCurve m(a, "y=0"); AbsPoint C(0, 1, 3); Line l(O, C); RotatCurve r(a, l, 1);'
    )
    assert model["m"].to_nurbs().exact and model["r"].to_nurbs().exact


def test_trimmed_faces_and_their_neighbours_share_edges(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    text = """
        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 4, 0); AbsPoint D(4, 4, 0);
        Line l(A, B); Line m(C, D); RuledSurf S(l, m, visible = 0);
        AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.75, 0.5); AbsMagnet r(S, 0.5, 0.75);
        ArcSnake round(q, p, r, type = 6);
        TrimSurf window(S, {round}, whole = 1); TrimSurf disc(S, {round});
    """
    model = moldloft.loads(text)
    found = read(model.write(tmp_path / "window.step")[0])
    # The circle is one edge of both: four sides, and one.
    assert (found.shells, found.faces, found.edges, found.valid) == (1, 2, 5, True)
    assert found.area == pytest.approx(16, rel=1e-6)
    model = moldloft.loads(text.replace("TrimSurf disc(S, {round});", ""))
    found = read(model.write(tmp_path / "hole.step")[0])
    assert found.area == pytest.approx(16 - math.pi, rel=1e-5)


def test_plane_bodies_become_plane_faces(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_reading import read

    corner = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 3); "
    model = moldloft.loads(corner + "SetBody body(cuboid(A, B), {-1, -1, -1}, {3, 2, 4});")
    found = read(model.write(tmp_path / "set.step")[0])
    assert (found.solids, found.faces, found.edges) == (1, 6, 12)
    assert found.volume == pytest.approx(6, rel=1e-6)


def test_gmsh_reads_the_same_solid(tmp_path: Path) -> None:
    code = f"""
import gmsh, moldloft, os
m = moldloft.loads({box(1, 2, 3)!r})
m.to_gmsh()
(volume,) = gmsh.model.getEntities(3)
assert abs(gmsh.model.occ.getMass(*volume) - 6) < 1e-9
assert len(gmsh.model.getEntities(2)) == 6 and len(gmsh.model.getEntities(1)) == 12
assert len(gmsh.model.getPhysicalGroups(2)) >= 1
gmsh.finalize()
# Gmsh by itself would let a broken pipe end the process without a word.
end, pipe = os.pipe()
os.close(end)
try:
    os.write(pipe, b"x")
except OSError:
    print("a broken pipe is an exception")
"""
    pytest.importorskip("gmsh")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "a broken pipe is an exception" in done.stdout


def test_dxf_and_3dm_hold_the_same_curves_and_surfaces(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    rhino = pytest.importorskip("rhino3dm")
    model = moldloft.loads(random_sphere(random.Random(1)).text)
    nurbs = model["ball"].to_nurbs()
    (path,) = model.write(tmp_path / "ball.dxf")
    splines = list(ezdxf.readfile(path).modelspace())
    assert {s.dxf.layer for s in splines} == {"ball"} and splines
    (path,) = model.write(tmp_path / "ball.3dm")
    file = rhino.File3dm.Read(str(path))
    (thing,) = list(file.Objects)
    assert thing.Attributes.Name == "ball"
    assert file.Settings.ModelUnitSystem == rhino.UnitSystem.Meters
    surface = thing.Geometry
    if not hasattr(surface, "PointAt"):
        surface = surface.Surfaces[0]
    # Faces of 3DM have no sense: the surface runs backwards along u, its normal points outwards.
    for u, v in [(0.3, 0.2), (0.7, 0.9)]:
        p, n = (
            np.array([at.X, at.Y, at.Z]) for at in (surface.PointAt(u, v), surface.NormalAt(u, v))
        )
        assert np.abs(p - nurbs(1 - u, v)).max() < 1e-12
        assert np.abs(n - p / np.linalg.norm(p)).max() < 1e-9


def test_adapters_hand_the_panels_over() -> None:
    model = moldloft.loads(box(1, 2, 3))
    mesh = model.mesh()
    assert model.to_trimesh().volume == pytest.approx(mesh.volume)
    assert model.to_trimesh().is_watertight
    assert model.to_pyvista().area == pytest.approx(22)
    meshio = model.to_meshio()
    assert sum(len(block.data) for block in meshio.cells) == len(mesh.faces)
    assert set(meshio.cell_sets) == {p.name for p in mesh.patches}


def test_to_ocp_is_in_the_unit_of_the_model() -> None:
    pytest.importorskip("OCP")
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    shape = moldloft.loads('Model info(units = "ft"); ' + box(1, 2, 3)).to_ocp()
    figures = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, figures)
    assert figures.Mass() == pytest.approx(6)


def test_capytaine_takes_the_wetted_panels() -> None:
    pytest.importorskip("capytaine")
    model = moldloft.loads(box(2, 2, 2, lift=-1.5))
    body = model.to_capytaine()
    assert body.mesh.volume == pytest.approx(model.hydrostatics().volume, rel=1e-6)


def test_the_component_for_openmdao_has_exact_partials(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # OpenMDAO writes reports into the current folder.
    monkeypatch.chdir(tmp_path)
    om = pytest.importorskip("openmdao.api")
    from moldloft.study import component, function

    model = moldloft.loads(
        "param float beam = 2 in [1, 3]; param float depth = 1 in [0.5, 2];"
        "BCurve a({{0, 0, 0}, {3, beam, 0}, {6, 0, 0}});"
        "BCurve b({{0, 0, depth}, {3, beam, depth}, {6, 0, depth}}); RuledSurf side(a, b);"
    )
    outputs = {"area": "side.area", "size": "{beam * depth, beam + depth, beam - depth}"}
    f = function(model, ["beam", "depth"], outputs)
    assert f.bounds == [(1, 3), (0.5, 2)]
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("hull", component(model, ["beam", "depth"], outputs))
    problem.setup(force_alloc_complex=False)
    problem.set_val("hull.beam", 2.5)
    problem.run_model()
    data = problem.check_partials(out_stream=None, method="fd", form="central", step=1e-4)
    for pair in data["hull"].values():
        worst = pair["abs error"]
        worst = worst[0] if not isinstance(worst, float) else worst
        assert float(np.max(np.asarray(worst))) < 1e-6
    problem.set_val("hull.beam", 99)
    with pytest.raises(om.AnalysisError, match="beam"):
        problem.run_model()
    for inputs, wanted in [([], ["side.area"]), (["beam"], []), (["beam", "beam"], ["side.area"])]:
        with pytest.raises(moldloft.Error):
            function(model, inputs, wanted)
    with pytest.raises(moldloft.Error, match="not a finite"):
        f([math.nan, 1])


def test_a_step_file_of_another_program_becomes_a_model(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    from cad_reading import read
    from moldloft.cad.importing import load_cad

    for name, shape, area in [
        ("box", BRepPrimAPI_MakeBox(10, 20, 30).Shape(), 2200e-6),
        ("can", BRepPrimAPI_MakeCylinder(5, 10).Shape(), 2 * math.pi * 5 * 15 * 1e-6),
    ]:
        path = tmp_path / f"{name}.step"
        writer = STEPControl_Writer()
        writer.Transfer(shape, STEPControl_AsIs)
        writer.Write(str(path))
        model = load_cad(path)
        (again,) = model.write(tmp_path / "again.step")
        assert read(again).area == pytest.approx(area, rel=1e-6)


BAD = {
    "empty.step": b"",
    "text.step": b"solid foo\nendsolid\n",
    "cut.step": b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=CARTESIAN_POINT('',(0.,0.,0.));\n",
    "nothing.step": b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n"
    b"ENDSEC;\nEND-ISO-10303-21;\n",
    "cut.igs": b"nothing" + b" " * 65 + b"S      1\n",
}


@pytest.mark.parametrize("name", BAD)
def test_files_that_cannot_be_read_are_named(name: str, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from moldloft.cad.importing import load_cad

    path = tmp_path / name
    path.write_bytes(BAD[name])
    with pytest.raises(moldloft.Error, match=re.escape(name)):
        load_cad(path)
    with pytest.raises(moldloft.Error):
        load_cad(tmp_path / "absent.step")
    with pytest.raises(moldloft.Error, match="furlong"):
        load_cad(path, units="furlong")


def test_what_cannot_be_written_is_refused(tmp_path: Path) -> None:
    with pytest.raises(moldloft.Error, match="surface"):
        moldloft.loads("AbsPoint A(0, 0, 0);").write(tmp_path / "none.step")
    model = moldloft.loads(box(1, 2, 3))
    with pytest.raises(moldloft.Error, match="positive"):
        model.write(tmp_path / "x.step", tolerance=-1)
    with pytest.raises(moldloft.Error, match="tags"):
        model.write(tmp_path / "x.step", tags="port")
    both = moldloft.loads('Model info(symmetry = "y"); ' + box(1, 2, 3, shift=-1))
    with pytest.raises(moldloft.Error, match="one side"):
        both.write(tmp_path / "both.step")
    with pytest.raises(moldloft.Error):
        moldloft.loads(QUARTER)["A"].to_nurbs()
    with pytest.raises(moldloft.Error, match="degree"):
        moldloft.loads(QUARTER)["a"].to_nurbs(degree=0)
    with pytest.raises(moldloft.Error, match="accuracy"):
        moldloft.loads(QUARTER)["a"].to_nurbs(accuracy=0)
    assert not list(tmp_path.iterdir())


def test_the_header_of_the_c_interface_is_that_of_its_source() -> None:
    folder = ROOT / "crates" / "capi" / "include"
    made = subprocess.run(
        [sys.executable, folder / "generate.py"], capture_output=True, text=True, check=True
    )
    assert made.stdout == (folder / "moldloft.h").read_text(encoding="utf-8")


def test_a_cylinder_is_three_exact_faces(tmp_path: Path) -> None:
    (path,) = moldloft.loads(cylinder(1, 2)).write(tmp_path / "c.step")
    assert "surfaces exact but for rounding" in path.read_text()


def test_turned_copies_are_fitted_once_and_right() -> None:
    from moldloft.cad.boundary import boundary

    model = moldloft.loads("""
    Arc a({1, 0, 0}, {2, 0.7, 0}, {3, 0, 0}); Arc b({1.2, 0.2, 1}, {2, 1.1, 1.3}, {3.1, 0, 1});
    Arc c({1, 0.3, 2}, {2.2, 0.8, 2.5}, {3, 0.4, 2}); Arc d({1, 0, 3}, {2, 0.2, 3.1}, {3, 0, 3});
    CLoftSurf one({a, b, c, d}); Line axis({-1, 0, 0}, {-1, 0.3, 1}); RotatSurf two(one, axis, 2.1);
    CopySurf three(two, {0, 0, 0}, {5, 6, 7}); CopySurf four(two, {0, 0, 0}, {-5, 6, 7}, sz = 1.1);
    """)
    faces = {face.name: face.surface for face in boundary(model, accuracy=1e-5).faces}
    points = {name: fit.points for name, fit in faces.items() if fit is not None}
    assert len(points) == 4
    for name, fit in faces.items():
        assert fit is not None and not fit.exact and fit.error <= 1e-5
        u, v = np.meshgrid(np.linspace(0, 1, 23), np.linspace(0, 1, 19), indexing="ij")
        truth = np.array([model[name](s, t) for s, t in zip(u.flat, v.flat, strict=True)])
        made = np.array([fit(s, t) for s, t in zip(u.flat, v.flat, strict=True)])
        assert np.abs(truth - made).max() <= fit.error
    # The copies have the first one's net, the stretched one its own.
    lengths = {n: np.linalg.norm(np.diff(p, axis=0), axis=-1) for n, p in points.items()}
    assert np.allclose(lengths["one"], lengths["two"], rtol=0, atol=1e-12)
    assert np.allclose(lengths["one"], lengths["three"], rtol=0, atol=1e-12)
