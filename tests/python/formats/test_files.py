"""Every format is read back by a program that is not ours."""

from __future__ import annotations

import errno
import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import capytaine
import manifold3d
import meshio
import numpy as np
import pytest
import pyvista
import trimesh

import moldloft
from conftest import SAILBOAT
from moldloft.exchange.files import FORMATS, Output, commit

BOX = """
param float height = 1 in [0.5, 2];
AbsPoint a(0, 0, 0); AbsPoint b(2, 0, 0); AbsPoint c(2, 3, 0); AbsPoint d(0, 3, 0);
AbsPoint e(0, 0, height); AbsPoint f(2, 0, height);
AbsPoint g(2, 3, height); AbsPoint h(0, 3, height);
Line ab(a, b, divisions = 4, visible = 0); Line bc(b, c); Line dc(d, c); Line ad(a, d);
Line ef(e, f); Line fg(f, g); Line hg(h, g); Line eh(e, h);
RuledSurf bottom(ab, dc, divisions = {4, 3}, orientation = 1);
RuledSurf top(ef, hg, divisions = {4, 3});
RuledSurf front(ab, ef, divisions = {4, 2});
RuledSurf back(dc, hg, divisions = {4, 2}, orientation = 1);
RuledSurf left(ad, eh, divisions = {3, 2}, orientation = 1);
RuledSurf right(bc, fg, divisions = {3, 2});
"""


# A drum of 12 sides: its panels are flat and its volume has a closed form.
DRUM = """
param float height = 1 in [0.5, 2];
AbsPoint a(0, 0, 0); AbsPoint b(2, 0, 0); AbsPoint c(2, 0, height); AbsPoint d(0, 0, height);
Line axis(a, d);
BCurve profile({a, b, c, d}, degree = 1);
RevSurf drum(profile, axis, divisions = {6, 12});
"""
BASE = 12 * 2 * 2 * np.sin(2 * np.pi / 12) / 2


@pytest.fixture
def drum() -> moldloft.Model:
    return moldloft.loads(DRUM)


@pytest.fixture
def hull() -> moldloft.Model:
    return moldloft.load(SAILBOAT / "hull.sdl")


@pytest.fixture
def box() -> moldloft.Model:
    return moldloft.loads(BOX)


def test_gdf_by_capytaine(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.gdf")
    mesh = capytaine.load_mesh(str(path), file_format="gdf")
    half = getattr(mesh, "half", mesh)
    ours = hull.mesh()
    assert half.nb_faces == len(ours.faces)
    assert half.faces_areas.sum() == pytest.approx(ours.area, rel=1e-3)
    lines = path.read_text().splitlines()
    assert lines[2].split()[:2] == ["0", "1"], "the hull is mirrored in y = 0"
    corners = np.array([line.split() for line in lines[4:]], dtype=float).reshape(-1, 4, 3)
    np.testing.assert_array_equal(corners, ours.vertices[ours.faces])


def test_obj_by_meshio(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.obj")
    mesh, ours = meshio.read(path), hull.mesh()
    np.testing.assert_array_equal(mesh.points, ours.vertices)
    faces = np.vstack([block.data for block in mesh.cells if block.type == "quad"])
    np.testing.assert_array_equal(faces, ours.faces)


def test_vtp_by_pyvista(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.vtp")
    mesh, ours = pyvista.read(path), hull.mesh()
    np.testing.assert_array_equal(mesh.points, ours.vertices)
    assert mesh.n_cells == len(ours.faces)
    assert mesh.area == pytest.approx(ours.area, rel=1e-3)


def test_fields_for_viewers(tmp_path):
    """A tube of radius 2 with a plane disc as its end: curvatures outside of it are known."""
    model = moldloft.loads("""
    AbsPoint A(2, 0, 0); AbsPoint B(2, 0, 3); AbsPoint O(0, 0, 0); AbsPoint P(0, 0, 3);
    Line side(A, B); Line axis(O, P); Line spoke(O, A);
    RevSurf tube(side, axis, 0, 6.283185307179586, divisions = {6, 24});
    RevSurf end(spoke, axis, 0, 6.283185307179586, divisions = {4, 24});
    """)
    (path,) = model.write(tmp_path / "tube.vtp")
    whole = pyvista.read(path)
    names = {"gaussian_curvature", "mean_curvature", "largest_curvature", "smallest_curvature"}
    assert names | {"isophote", "zebra", "normal"} <= set(whole.point_data)
    for path in model.write(tmp_path / "tube.vts"):
        if path.suffix == ".vtm":
            continue
        grid = pyvista.read(path)
        on_end = path.name.endswith("end.vts")
        round_ = np.hypot(*grid.points.T[:2]) > 1e-9
        bend = np.stack([grid[n] for n in ("largest_curvature", "smallest_curvature")], axis=1)
        sizes = np.sort(np.abs(bend[round_]), axis=1)
        assert np.abs(sizes - ([0, 0] if on_end else [0, 0.5])).max() < 1e-12
        assert np.abs(grid["gaussian_curvature"][round_]).max() < 1e-12
        lengths = np.linalg.norm(grid["normal"][round_], axis=1)
        assert lengths == pytest.approx(1.0)
        if on_end:
            assert np.isnan(grid["gaussian_curvature"][~round_]).all() and (~round_).any()
            assert np.abs(grid["isophote"][round_]) == pytest.approx(1.0)
            assert "eta_y" in grid.point_data
        else:
            assert "eta_y" not in grid.point_data
            # u and v are in their places: normals point along the radius.
            across = grid.points[:, :2] / 2
            assert np.abs((grid["normal"][:, :2] * across).sum(axis=1)) == pytest.approx(1.0)


def test_vts_by_pyvista(box, tmp_path):
    paths = box.write(tmp_path / "box.vts")
    grids = [pyvista.read(path) for path in paths if path.suffix == ".vts"]
    assert len(grids) == 6
    for grid, patch in zip(grids, box.mesh().patches, strict=True):
        nu, nv = patch.divisions
        assert grid.dimensions == (nu + 1, nv + 1, 1)
        assert grid.area == pytest.approx(patch.area)


def test_plot3d_by_pyvista(box, tmp_path):
    (path,) = box.write(tmp_path / "box.p3d")
    reader = pyvista.MultiBlockPlot3DReader(path)
    reader.auto_detect_format = True
    blocks = reader.read()
    assert blocks.n_blocks == 6
    for block, patch in zip(blocks, box.mesh().patches, strict=True):
        nu, nv = patch.divisions
        assert block.dimensions == (nu + 1, nv + 1, 1)
    lows = np.min([block.points.min(axis=0) for block in blocks], axis=0)
    highs = np.max([block.points.max(axis=0) for block in blocks], axis=0)
    np.testing.assert_array_equal([lows, highs], [[0, 0, 0], [2, 3, 1]])


def test_stl_by_trimesh_and_manifold(drum, tmp_path):
    ours = drum.mesh()
    assert ours.closed and ours.summary["outward"]
    assert ours.volume == pytest.approx(BASE, rel=1e-14)
    (path,) = drum.write(tmp_path / "drum.stl")
    mesh = trimesh.load_mesh(path)
    assert mesh.is_watertight and mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(BASE, rel=1e-6)
    solid = manifold3d.Manifold(
        manifold3d.Mesh(
            np.asarray(mesh.vertices, dtype=np.float32), np.asarray(mesh.faces, dtype=np.uint32)
        )
    )
    assert solid.status() == manifold3d.Error.NoError
    assert solid.volume() == pytest.approx(BASE, rel=1e-6)


def test_ply_by_meshio(box, tmp_path):
    (path,) = box.write(tmp_path / "box.ply")
    ours = box.mesh()
    mesh = meshio.read(path)
    np.testing.assert_array_equal(mesh.points, ours.vertices)
    np.testing.assert_array_equal(mesh.cells_dict["quad"], ours.faces)
    assert b"comment patch front wetted faces 24 32" in path.read_bytes()
    assert trimesh.load_mesh(path).volume == pytest.approx(6)


def test_ply_by_pyvista(drum, tmp_path):
    (path,) = drum.write(tmp_path / "drum.ply")
    mesh = pyvista.read(path)
    # A mesh of triangles beside quads is written as triangles.
    faces = drum.mesh().faces
    assert mesh.n_cells == sum(1 if face[2] == face[3] else 2 for face in faces)
    assert mesh.n_open_edges == 0
    assert mesh.volume == pytest.approx(BASE, rel=1e-6)


def test_glb_by_trimesh(tmp_path):
    text = BOX
    for colour, name in enumerate(["bottom", "top", "front", "back", "left", "right"]):
        line = next(line for line in BOX.splitlines() if line.startswith(f"RuledSurf {name}("))
        text = text.replace(line, line.replace(");", f", colour = {colour + 8});"))
    box = moldloft.loads(text)
    (path,) = box.write(tmp_path / "box.glb")
    scene = trimesh.load_scene(path)
    assert set(scene.geometry) == {"bottom", "top", "front", "back", "left", "right"}
    whole = trimesh.util.concatenate(scene.dump())
    whole.merge_vertices(merge_tex=True, merge_norm=True)
    assert whole.is_watertight and whole.volume == pytest.approx(6, rel=1e-6)
    # Up is y: our z runs along it, our y against z.
    np.testing.assert_allclose(whole.bounds, [[0, 0, -3], [2, 1, 0]], atol=1e-6)
    colours = {tuple(g.visual.material.baseColorFactor) for g in scene.geometry.values()}
    assert len(colours) == 6, "each patch has a colour of its own"


def test_glb_is_in_metres(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.glb")
    scene = trimesh.load_scene(path)
    length = np.ptp(hull.mesh().vertices[:, 0]) * 0.3048
    assert np.ptp(scene.bounds[:, 0]) == pytest.approx(length, rel=1e-6)


def test_a_closed_body_stays_closed(drum):
    for height in (0.5, 0.7, 1.9):
        drum["height"] = height
        assert drum.mesh().closed
        assert drum.mesh().volume == pytest.approx(BASE * height)
        assert drum.mesh().patch("drum").volume == pytest.approx(BASE * height)
    assert drum.derivative("mesh.volume", "height") == pytest.approx(BASE)


def test_svg_sheets_have_their_scale(hull, tmp_path):
    paths = hull.write(tmp_path / "hull.svg")
    assert len(paths) == 3
    for path in paths:
        root = ElementTree.parse(path).getroot()
        text = " ".join(root.itertext())
        assert "1 : " in text and " ft" in text, path
        lines = [e for e in root.iter() if e.tag.endswith(("path", "polyline"))]
        assert lines, path


def test_png_shows_something(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.png")
    pixels = pyvista.read_texture(path).to_array()
    assert pixels.shape[0] >= 500 and pixels.shape[1] >= 800
    assert len(np.unique(pixels.reshape(-1, pixels.shape[-1]), axis=0)) > 100


def test_formats_by_other_names(hull, tmp_path):
    (path,) = hull.write(tmp_path / "hull.xyz")
    assert path.read_bytes() == hull.write(tmp_path / "hull.p3d")[0].read_bytes()
    with pytest.raises(moldloft.Error, match="gdf"):
        hull.write(tmp_path / "hull.dwg")


def test_every_format_can_be_written(hull, tmp_path):
    for name in FORMATS:
        if name == "blockmesh" or name.startswith("volume-"):  # for solids: test_volume_files.py
            continue
        for path in hull.write(tmp_path / f"hull.{name}"):
            assert path.stat().st_size > 100


def folder_of(path: Path) -> dict[str, bytes]:
    return {entry.name: entry.read_bytes() for entry in path.iterdir()}


@pytest.mark.parametrize("at", [1, 2])
def test_a_full_disk_leaves_nothing(tmp_path, monkeypatch, at):
    (tmp_path / "a.txt").write_bytes(b"old")
    before = folder_of(tmp_path)
    calls = 0

    def full(_: int) -> None:
        nonlocal calls
        calls += 1
        if calls == at:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    outputs = [Output("a.txt", b"new"), Output("b.txt", b"new")]
    with pytest.raises(moldloft.FileError, match="no space left"):
        commit(tmp_path, outputs)
    assert folder_of(tmp_path) == before
    with pytest.raises(moldloft.FileError) as caught:
        calls = 0
        commit(tmp_path / "new" / "folder", outputs)
    assert isinstance(caught.value, OSError)
    assert folder_of(tmp_path) == before


def test_a_folder_in_the_way(tmp_path):
    (tmp_path / "b.txt").mkdir()
    with pytest.raises(moldloft.FileError, match="folder"):
        commit(tmp_path, [Output("a.txt", b"new"), Output("b.txt", b"new")])
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["b.txt"]


def test_files_are_replaced_whole(tmp_path):
    commit(tmp_path, [Output("a.txt", b"one")])
    assert commit(tmp_path, [Output("a.txt", b"two")]) == [tmp_path / "a.txt"]
    assert folder_of(tmp_path) == {"a.txt": b"two"}
