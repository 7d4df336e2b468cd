"""Models in the hands of other packages: areas, volumes, names and tables by their own means."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import moldloft

#: A half of a boat: quadrilaterals, and triangles at the ends.
HULL = """
    Model info(units = "m t", symmetry = "y"); param float beam = 2 in [1, 3];
    BCurve keel({{0, 0, -1}, {3, 0, -1.5}, {6, 0, -1}}, divisions = 12);
    BCurve rail({{0, 0, 1}, {3, beam, 1}, {6, 0, 1}});
    RuledSurf side(keel, rail, divisions = {12, 6});
"""


@pytest.fixture
def hull() -> moldloft.Model:
    return moldloft.loads(HULL)


def test_panels_are_the_same_in_three_packages(hull: moldloft.Model) -> None:
    for package in ("trimesh", "pyvista", "meshio"):
        pytest.importorskip(package)
    mesh = hull.mesh()
    # Quadrilaterals that are not plane are halved, here and in PyVista.
    assert hull.to_trimesh().area == pytest.approx(mesh.area, rel=1e-3)
    assert hull.to_trimesh().bounds == pytest.approx(
        np.array([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
    )
    assert hull.to_pyvista().area == pytest.approx(mesh.area, rel=1e-3)
    assert len(hull.to_pyvista()["patch"]) == len(mesh.faces)
    held = hull.to_meshio()
    assert np.array_equal(held.points, mesh.vertices) and list(held.cell_sets) == ["side"]
    assert sum(len(block.data) for block in held.cells) == len(mesh.faces)


def test_surfaces_are_the_same_in_ocp_and_gmsh(hull: moldloft.Model) -> None:
    pytest.importorskip("OCP")
    gmsh = pytest.importorskip("gmsh")
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    figures = GProp_GProps()
    BRepGProp.SurfaceProperties_s(hull.to_ocp(), figures, 1e-10)
    # A half is written whole.
    assert figures.Mass() == pytest.approx(2 * hull["side"].area, rel=1e-8)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        hull.to_gmsh()
        faces = [tag for dim, tag in gmsh.model.getEntities(2)]
        area = sum(gmsh.model.occ.getMass(2, tag) for tag in faces)
        assert len(faces) == 2 and area == pytest.approx(2 * hull["side"].area, rel=2e-3)
        groups = [gmsh.model.getPhysicalName(*g) for g in gmsh.model.getPhysicalGroups(2)]
        assert groups == ["side"]
        gmsh.model.mesh.generate(2)
        assert len(gmsh.model.mesh.getElements(2)[1][0]) > 10
    finally:
        gmsh.finalize()


def test_groups_of_gmsh_are_the_faces_of_those_names() -> None:
    pytest.importorskip("OCP")
    gmsh = pytest.importorskip("gmsh")
    text = """
        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b);
        set low = set(plane({0, 0, -1}, {0, 0, 0})); set high = set(plane({0, 0, 1}, {0, 0, 2}));
        set rod = set(cylinder(axis, 0.7)); set bore = set(cylinder(axis, 0.3));
        SetBody ring((rod & low & high) - bore, {-1, -1, -1}, {1, 1, 3});
    """
    model = moldloft.loads(text)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        model.to_gmsh()
        areas: dict[str, float] = {}
        for group in gmsh.model.getPhysicalGroups(2):
            tags = gmsh.model.getEntitiesForPhysicalGroup(*group)
            areas[gmsh.model.getPhysicalName(*group)] = sum(
                gmsh.model.occ.getMass(2, tag) for tag in tags
            )
        end = np.pi * (0.7**2 - 0.3**2)
        wanted = {
            "ring.rod": 2 * np.pi * 0.7 * 2, "ring.bore": 2 * np.pi * 0.3 * 2,
            "ring.low": end, "ring.high": end,
        }  # fmt: skip
        assert areas == pytest.approx(wanted, rel=1e-6)
    finally:
        gmsh.finalize()


def test_the_wetted_body_is_the_same_in_capytaine(hull: moldloft.Model) -> None:
    pytest.importorskip("capytaine")
    body = hull.to_capytaine()
    assert body.mesh.volume == pytest.approx(hull.hydrostatics().volume, rel=2e-2)
    assert body.mesh.vertices[:, 2].max() <= 1e-9


def test_tables_are_the_same_in_pandas_and_xarray(hull: moldloft.Model) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    from moldloft import adapters

    row = hull.to_pandas().loc["beam"]
    assert (row["value"], row["low"], row["high"]) == (2, 1, 3)
    drafts = [0.5, 1.0, 1.25]
    table = hull.hydrostatic_table(drafts)
    frame, grid = adapters.to_pandas(table), adapters.to_xarray(table)
    volumes = [r.volume for r in table.rows]
    assert list(frame["volume"]) == volumes
    assert list(grid["volume"].values) == volumes
    assert sorted(grid.coords) and len(grid["volume"].dims) == 1


def test_packages_are_asked_for_when_they_are_used() -> None:
    program = (
        "import sys, moldloft; moldloft.loads('AbsPoint a(0, 0, 0);');"
        "packages = 'trimesh pyvista meshio OCP gmsh capytaine pandas xarray openmdao'.split();"
        "print([p for p in packages if p in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
