"""The files of panel codes, read back by Capytaine where it reads them, and solved by it."""

from __future__ import annotations

from pathlib import Path

import capytaine
import numpy as np
import pytest

import moldloft
from conftest import SAILBOAT

# Half of a sphere of radius 1 below the water, y >= 0; a lid closes it at z = 0.
QUARTER_BALL = """
Model info(symmetry = "y");
param int n = 8 in [2, 64];
AbsPoint O(0, 0, 0); AbsPoint bottom(0, 0, -1); AbsPoint bow(1, 0, 0); AbsPoint stern(-1, 0, 0);
AbsPoint side(0, 1, 0);
Arc meridian(bow, O, bottom, type = 2);
Line axis(O, bottom);
RevSurf ball(meridian, axis, 0, -3.141592653589793, divisions = {n, 2 * n});
"""


@pytest.fixture
def hull() -> moldloft.Model:
    return moldloft.load(SAILBOAT / "hull.sdl")


def area_below(model: moldloft.Model) -> float:
    """Of the panels, which is what a solver sees."""
    return model.panel_figures(0.0)["wetted_area"]


@pytest.mark.parametrize("format", ["gdf", "nemoh", "hydrostar", "hams"])
def test_by_capytaine(hull, tmp_path, format):
    (path,) = hull.write(tmp_path / f"hull.{format}", format=format)
    mesh = capytaine.load_mesh(str(path), file_format=format)
    ours = hull.mesh()
    assert mesh.nb_faces == 2 * len(ours.faces), "both sides, by the flag of the symmetry plane"
    half = mesh.half
    assert half.nb_faces == len(ours.faces)
    # The same panels in the same order, corners in the same direction: the same vector areas.
    theirs = half.vertices[half.faces]
    np.testing.assert_array_equal(theirs, ours.vertices[ours.faces])


@pytest.mark.parametrize("format", ["gdf", "nemoh", "hydrostar", "hams"])
def test_cut_at_the_water(hull, tmp_path, format):
    (path,) = hull.write(tmp_path / f"hull.{format}", format=format, immersed=True)
    mesh = capytaine.load_mesh(str(path), file_format=format).merged()
    assert mesh.vertices[:, 2].max() == 0
    assert mesh.faces_areas.sum() == pytest.approx(area_below(hull), rel=2e-3)
    # Normals point into the water: so the volume is positive. Panels lie inside the convex shape.
    assert mesh.volumes[2] == pytest.approx(hull.panel_figures(0.0)["volume"], rel=2e-3)
    assert mesh.volumes[2] < hull.hydrostatics().volume


def aqwa(text: str) -> tuple[np.ndarray, list[list[int]], set[str]]:
    """Vertices, panels and flags of a file, by the columns of the reference manual."""
    assert text.startswith("*********1*********2*********3")
    deck, flags = -1, set()
    nodes: dict[int, list[float]] = {}
    panels = []
    for line in text.splitlines():
        assert len(line) <= 80
        if line.startswith("*"):
            deck = int(line.split("DECK")[1][:4]) if "DECK" in line else deck
        elif deck == 1 and line[4:6].strip().isdigit():
            nodes[int(line[6:11])] = [float(line[k : k + 10]) for k in (20, 30, 40)]
        elif deck == 2 and line[6:10] in ("QPPL", "TPPL"):
            assert line[11:15] == "DIFF"
            corners = 4 if line[6] == "Q" else 3
            panels.append([int(line[24 + 7 * k : 29 + 7 * k]) for k in range(corners)])
        elif deck == 2 and line.strip().startswith("SYM"):
            flags.add(line.strip())
    assert list(nodes) == list(range(1, len(nodes) + 1))
    return np.array(list(nodes.values())), panels, flags


def test_aqwa_by_its_columns(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.dat", format="aqwa")
    nodes, panels, flags = aqwa(path.read_text())
    assert flags == {"SYMX"}, "the hull is mirrored in y = 0"
    assert nodes[:, 2].max() == 0
    faces = [[k - 1 for k in (p if len(p) == 4 else [*p, p[-1]])] for p in panels]
    half = capytaine.Mesh(nodes, np.array(faces))
    volume = hull.hydrostatics(sides="one").volume
    assert 0.98 < half.volumes[2] / volume < 1, "panels lie inside the shape"
    with pytest.raises(moldloft.Error, match="belongs to several formats"):
        hull.write(tmp_path / "hull.dat")


#: A quarter of the sphere's lower half, mirrored in both planes.
EIGHTH_BALL = QUARTER_BALL.replace('"y"', '"xy"').replace(
    "-3.141592653589793,", "-1.5707963267948966,"
)


def test_a_symmetry_without_a_flag_is_written_out(tmp_path):
    model = moldloft.loads(EIGHTH_BALL)
    panels = len(model.mesh().faces)
    for format, sides in [("gdf", 1), ("nemoh", 2), ("hydrostar", 1), ("hams", 2)]:
        (path,) = model.write(tmp_path / f"ball.{format}", format=format)
        mesh = capytaine.load_mesh(str(path), file_format=format)
        assert mesh.nb_faces == 4 * panels
        listed = mesh.half if sides == 2 else mesh.half.half
        assert listed.nb_faces == sides * panels
        assert mesh.merged().volumes[2] == pytest.approx(2 * np.pi / 3, rel=0.02)


@pytest.mark.parametrize(("symmetry", "flags"), [("y", "0 1"), ("x", "1 0"), ("xy", "0 1")])
def test_hams_has_one_plane_of_symmetry(symmetry, flags, tmp_path):
    """HAMS stops at both flags; hull and lid have the same one, and Capytaine the whole of both."""
    text = EIGHTH_BALL if symmetry == "xy" else QUARTER_BALL.replace('"y"', f'"{symmetry}"')
    if symmetry == "x":
        text = text.replace("bow(1, 0, 0)", "bow(0, 1, 0)")
    lid = """
        Line spoke(O, bow);
        RevSurf cover(spoke, axis, 0, TURN, divisions = {2, 2 * n}, tags = {"lid"});
    """
    turn = "-1.5707963267948966" if symmetry == "xy" else "-3.141592653589793"
    model = moldloft.loads(text + lid.replace("TURN", turn))
    hull, water = model.write(tmp_path / "ball.pnl", lids=True)
    for path, area in ((hull, 2 * np.pi), (water, np.pi)):
        counts = path.read_text().splitlines()[3].split()
        assert counts[2:] == flags.split(), path.name
        mesh = capytaine.load_mesh(str(path), file_format="hams").merged()
        assert mesh.nb_faces == 2 * int(counts[0])
        assert mesh.faces_areas.sum() == pytest.approx(area, rel=0.03), path.name


@pytest.mark.parametrize(
    ("dof", "limit", "published"),
    [
        # Added mass over the displaced mass in deep water (Hulme 1982, Journal of Fluid Mechanics
        # 121, sections 4 and 5; Storti and D'Elia 2004, Journal of Fluids Engineering 126). The
        # halves are exact: there the problem is that of a sphere in a boundless fluid.
        ("Heave", "omega", 0.5),
        ("Heave", "wavenumber", 0.8310),
        ("Surge", "wavenumber", 0.5),
        ("Surge", "omega", 0.2732),
    ],
)
def test_a_hemisphere_is_solved(tmp_path, dof, limit, published):
    model = moldloft.loads(QUARTER_BALL)
    model["n"] = 12
    (path,) = model.write(tmp_path / "ball.gdf")
    mesh = capytaine.load_mesh(str(path))
    body = capytaine.FloatingBody(mesh, dofs=capytaine.rigid_body_dofs(only=[dof]))
    frequency = {"omega": np.inf} if limit == "omega" else {"wavenumber": 0.0}
    problem = capytaine.RadiationProblem(body=body, radiating_dof=dof, rho=1.0, **frequency)
    result = capytaine.BEMSolver().solve(problem)
    # 24 x 24 panels of a first-order method: 3 % in heave, 5 % in surge at high frequency.
    assert result.added_masses[dof] / (2 * np.pi / 3) == pytest.approx(published, rel=0.055)


def test_lids_need_a_panel_code(tmp_path):
    model = moldloft.loads(QUARTER_BALL)
    paths = model.write(tmp_path / "ball.pnl", lids=True)
    assert [p.name for p in paths] == ["ball.pnl"], "there are no lids"
    with pytest.raises(moldloft.Error, match="panel codes"):
        model.write(tmp_path / "ball.stl", lids=True)


def test_gravity_is_in_the_unit_of_the_model(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.gdf")
    gravity = float(Path(path).read_text().splitlines()[1].split()[1])
    assert gravity == pytest.approx(9.80665 / 0.3048)
