"""B-spline patches evaluated by SciPy, CGNS read by VTK, and tables of offsets."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
import pyvista
from scipy.interpolate import BSpline

import moldloft
from conftest import SAILBOAT
from moldloft import high_order, offsets

# A loft of quadratics, a surface of points, a translation: all splines; and an arc, which is none.
SPLINES = """
Model info(symmetry = "y", units = "m");
AbsPoint a(0, 0, -2); AbsPoint b(1, 2, -2); AbsPoint c(6, 1, -1); AbsPoint d(8, 0, 0);
AbsPoint e(0, 1, 0); AbsPoint f(3, 3, 0); AbsPoint g(8, 2, 1); AbsPoint h(1, 2, 2);
AbsPoint i(4, 4, 2.5); AbsPoint j(9, 3, 3);
BCurve low({a, b, c, d}, degree = 2); BCurve mid({e, f, g}, degree = 2);
BCurve top({h, i, j}, degree = 2);
BLoftSurf loft({low, mid, top}, degree = 2, divisions = {8, 8}, orientation = 1);
TranSurf moved(low, mid, divisions = {8, 8});
BSurf net({a, b, c, e, f, g, h, i, j}, nu = 3, nv = 3, divisions = {8, 8});
"""
ROUND = """
AbsPoint o(0, 0, 0); AbsPoint p(1, 0, 0); AbsPoint q(0, 0, -1);
Arc quarter(p, o, q, type = 2); Line axis(o, q);
RevSurf bowl(quarter, axis, 0, 1.5, divisions = {6, 6});
"""


def read_high_order(
    data: bytes,
) -> tuple[list[str], list[tuple[list[np.ndarray], np.ndarray, list]]]:
    """Header and patches, by the manual: spans, orders, knots, points with u fastest."""
    lines = data.decode().splitlines()
    words = iter(" ".join(lines[4:]).split())
    patches = []
    for _ in range(int(lines[3].split()[0])):
        nu, nv, ku, kv = (int(next(words)) for _ in range(4))
        knots = [
            np.array([float(next(words)) for _ in range(n + 2 * k - 1)])
            for n, k in ((nu, ku), (nv, kv))
        ]
        shape = (nv + kv - 1, nu + ku - 1, 3)
        points = np.array([float(next(words)) for _ in range(int(np.prod(shape)))]).reshape(shape)
        patches.append((knots, points, [ku - 1, kv - 1]))
    assert next(words, None) is None
    return lines[:4], patches


def evaluate(patch, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    knots, points, degree = patch
    rows = BSpline(knots[1], points, degree[1])(v)
    return BSpline(knots[0], rows.transpose(1, 0, 2), degree[0])(u)


def test_splines_are_exact(tmp_path):
    model = moldloft.loads(SPLINES)
    model.partial = True
    with pytest.warns(UserWarning, match="open below the water"):
        (path,) = model.write(tmp_path / "hull.gdf", format="gdf-high")
    header, patches = read_high_order(path.read_bytes())
    assert header == ["hull", "1 9.80665", "0 1", "3 1"]
    u = np.linspace(0, 1, 23)
    # The net faces as the loft does, with which it shares an edge and the divisions.
    turned = {"loft": True, "moved": False, "net": True}
    for (name, reverse), patch in zip(turned.items(), patches, strict=True):
        theirs = evaluate(patch, 2 * u - 1, 2 * u - 1)
        ours = model[name](u[:, None], u[None, :])
        # S_u x S_v points into the body: where panels face along ours, u is turned round.
        ours = ours if reverse else ours[::-1]
        np.testing.assert_allclose(theirs, ours, atol=1e-11)
    assert [p[2] for p in patches] == [[2, 2], [2, 2], [2, 2]]
    assert patches[0][1].shape == (3, 4, 3), "no more control points than the loft has"


def test_what_is_no_spline_is_fitted():
    model = moldloft.loads(ROUND)
    for tolerance in (1e-3, 1e-5):
        (patch,) = high_order.patches(model, tolerance=tolerance)
        assert 0 <= patch.deviation <= tolerance
        t = np.linspace(-1, 1, 41)
        radius = np.linalg.norm(patch(t, t), axis=-1)
        assert abs(radius - 1).max() < 3 * tolerance
    with pytest.raises(moldloft.Error, match="the error of the best fit is"):
        high_order.patches(model, tolerance=1e-17)


def test_a_knuckle_becomes_an_edge():
    model = moldloft.loads(
        "AbsPoint a(0,0,0); AbsPoint b(1,1,0); AbsPoint c(2,0,0); AbsPoint d(3,1,0);"
        "AbsPoint e(0,0,1); AbsPoint f(2,0.5,1); AbsPoint g(3,0,1);"
        "BCurve zig({a, b, c, d}, degree = 1); BCurve arc({e, f, g}, degree = 2);"
        "RuledSurf plate(zig, arc, divisions = {6, 2});"
    )
    forms = high_order.patches(model)
    assert len(forms) == 3 and all(patch.deviation < 1e-12 for patch in forms)


def test_a_half_keeps_to_its_side(tmp_path):
    model = moldloft.loads(SPLINES)
    model["d"].y = -1
    with pytest.raises(moldloft.Error, match="one half of the symmetric model"):
        model.write(tmp_path / "hull.gdf", format="gdf-high")


def grids(blocks):
    """The structured grids of nested blocks."""
    for block in blocks:
        if isinstance(block, pyvista.MultiBlock):
            yield from grids(block)
        elif isinstance(block, pyvista.StructuredGrid):
            yield block


def test_cgns_by_vtk(tmp_path):
    model = moldloft.load(SAILBOAT / "hull.sdl")
    (path,) = model.write(tmp_path / "hull.cgns")
    read = pyvista.CGNSReader(path).read()
    zones = list(grids(read))
    assert len(zones) == len(model.mesh().patches)
    for zone, patch in zip(zones, model.mesh().patches, strict=True):
        nu, nv = patch.divisions
        assert zone.dimensions == (nu + 1, nv + 1, 1)
        assert zone.area == pytest.approx(patch.area, rel=1e-3)


def points(base, name):
    """The points of a zone, (i, j, 3)."""
    grid = base[f"Z_{name}/GridCoordinates"]
    return np.stack([grid[f"Coordinate{c}/ data"][:].T for c in "XYZ"], axis=-1)


def test_cgns_interfaces_and_boundaries(tmp_path):
    # Two plates that share the line bc by identity, one twice as wide.
    model = moldloft.loads(
        'Model info(symmetry = "y");'
        "AbsPoint a(0,0,0); AbsPoint b(2,0,0); AbsPoint c(2,1,0); AbsPoint d(0,1,0);"
        "AbsPoint e(5,0,1); AbsPoint f(5,1,1); Line ad(a, d); Line bc(b, c); Line ef(e, f);"
        "RuledSurf left(ad, bc, divisions = {3, 2}); RuledSurf right(ef, bc, divisions = {3, 4});"
    )
    (path,) = model.write(tmp_path / "plates.cgns")
    with h5py.File(path) as file:
        base = file["plates"]
        assert base.attrs["label"] == b"CGNSBase_t"
        # Going along one side is going along the other, by the transform.
        for own, other in (("left", "right"), ("right", "left")):
            zone, donor = points(base, own), points(base, other)
            joins = base[f"Z_{own}/ZoneGridConnectivity"]
            assert list(joins) == ["join1"]
            one = joins["join1"]
            assert bytes(one[" data"][:]) == f"Z_{other}".encode()
            begin, end = one["PointRange/ data"][:]
            there, last = one["PointRangeDonor/ data"][:]
            matrix = np.zeros((2, 2), dtype=int)
            for axis, step in enumerate(one["Transform/ data"]):
                matrix[abs(step) - 1, axis] = np.sign(step)
            assert abs(np.linalg.det(matrix)) == 1
            assert ((end - begin) @ matrix.T == last - there).all()
            for k in range(max(end - begin) + 1):
                place = begin + k * np.sign(end - begin)
                i, j = there + matrix @ (place - begin)
                assert (zone[tuple(place - 1)] == donor[i - 1, j - 1]).all()
        boundaries = base["Z_left/ZoneBC"]
        kinds = {name: bytes(boundaries[name][" data"][:]) for name in boundaries}
        assert kinds == {
            "v0": b"UserDefined",
            "u1": b"UserDefined",
            "u0": b"BCSymmetryPlane",
        }
        assert base["Z_left/GridCoordinates/CoordinateX/ data"].shape == (3, 4)


def test_offsets_come_back():
    rows = "station,waterline,half_breadth\n"
    # y = (1 - x^2 / 16) z on stations -2 .. 2: parabolas along, straight up.
    given = {}
    for x in (-2.0, -1.0, 0.0, 1.0, 2.0):
        for z in (0.0, 1.0, 2.0):
            given[x, z] = (1 - x * x / 16) * z
            rows += f"{x},{z},{given[x, z]}\n"
    table = offsets.parse(rows)
    model = moldloft.loads(table.program(units="m"))
    back = offsets.measure(model, [-2, -1, 0, 1, 2], [0, 1, 2])
    for x, points in back.stations.items():
        for z, y in points:
            # Panels lie between the masters, at second order.
            assert y == pytest.approx(given[x, z], abs=2e-3), (x, z)
    ends = back.stations[-2.0]
    assert [y for _, y in ends] == pytest.approx([0, 0.75, 1.5], abs=1e-12)
    assert sum(map(len, back.stations.values())) == 15
    between = offsets.measure(model, [0.5], [1.5]).stations[0.5][0][1]
    assert between == pytest.approx((1 - 0.25 / 16) * 1.5, rel=1e-2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no table"),
        ("a,b\n1,2\n", "a column station and waterline and half_breadth"),
        ("x,y,z\n1,2,nan\n", "a number for waterline"),
        ("x,y,z\n1,2\n", "a number for waterline, found ``"),
        ("x,y,z\n1,-2,0\n", "0 or more"),
        ("x,y,z\n1,2,0\n1,2,0\n", "half-breadth 2.0 once at station 1.0, waterline 0.0"),
        ("x,y,z\n1,2,0\n", "has one point"),
    ],
)
def test_bad_offsets_are_explained(text, message):
    with pytest.raises(moldloft.Error, match=message):
        offsets.parse(text)


def test_offsets_on_the_command_line(cli, model_file, tmp_path):
    path = model_file("x,z,y\n0,0,0\n0,1,1\n4,0,0\n4,1,2\n", "hull.csv")
    done = cli("convert", path, "--to", "sdl")
    assert "CLoftSurf hull" in done.stdout
    cli("convert", path, "-o", "hull.sdl")
    cli("convert", "hull.sdl", "--to", "offsets", "-o", "back.csv")
    rows = (tmp_path / "back.csv").read_text().splitlines()
    assert rows[0] == "station,waterline,half_breadth" and len(rows) > 10
    cli("convert", "hull.sdl", "-o", "hull.glb")
    assert (tmp_path / "hull.glb").read_bytes().startswith(b"glTF")
    cli("convert", "hull.sdl", "--to", "stl", status=1)
