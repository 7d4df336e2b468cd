"""Reference geometry: what is read is what was written, and distances are right."""

from __future__ import annotations

import math
import os
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft import overlays

ROUNDS = 40 if os.environ.get("MOLDLOFT_SOAK") == "1" else 1


def off_curve(curve: Any, places: np.ndarray) -> float:
    """The largest distance of places from a curve, by dense samples and chords."""
    points = curve(np.linspace(0, 1, 4001))
    a, d = points[:-1], np.diff(points, axis=0)
    worst = 0.0
    for p in places:
        t = np.einsum("ij,ij->i", p - a, d) / np.maximum(np.einsum("ij,ij->i", d, d), 1e-300)
        foot = a + np.clip(t, 0, 1)[:, None] * d
        worst = max(worst, float(np.linalg.norm(foot - p, axis=1).min()))
    return worst


def drawing(rng: random.Random, path: Path) -> list[Any]:
    """A DXF drawing of random entities, also turned ones."""
    import ezdxf

    document = ezdxf.new("R2018")
    document.header["$INSUNITS"] = 4
    space = document.modelspace()

    def number() -> float:
        return rng.uniform(-50, 50)

    def place(n: int = 3) -> tuple[float, ...]:
        return tuple(number() for _ in range(n))

    for _ in range(3):
        turned = {"extrusion": (rng.uniform(-1, 1), rng.uniform(-1, 1), rng.choice([-1.0, 1.0]))}
        space.add_line(place(), place(), dxfattribs={"layer": "keel"})
        low = rng.uniform(0, 360)
        space.add_arc(place(), rng.uniform(1, 20), low, rng.uniform(0, 360), dxfattribs=turned)
        space.add_circle(place(), rng.uniform(1, 20), dxfattribs=turned)
        ratio = rng.uniform(0.1, 1)
        space.add_ellipse(place(), (number(), number(), 0), ratio, 0, rng.uniform(1, 6.2))
        bulges = [(*place(2), 0, 0, rng.choice([0.0, rng.uniform(-1, 1)])) for _ in range(5)]
        space.add_lwpolyline(bulges, close=rng.random() < 0.5, dxfattribs=turned)
        space.add_polyline3d([place() for _ in range(4)])
        weights = [rng.uniform(0.3, 3) for _ in range(7)]
        spline = space.add_open_spline([place() for _ in range(7)], degree=rng.randint(2, 4))
        if rng.random() < 0.5:
            spline.weights = weights
        # Unclamped: uniform knots over their whole range.
        loose = space.add_spline()
        loose.dxf.degree = 3
        loose.control_points = [place() for _ in range(8)]
        loose.knots = [float(k) for k in range(12)]
    document.saveas(path)
    return list(space)


@pytest.mark.parametrize("seed", range(ROUNDS))
def test_curves_of_dxf_files_are_exact(seed: int, tmp_path: Path) -> None:
    pytest.importorskip("ezdxf")
    from ezdxf.path import make_path
    from scipy.interpolate import BSpline

    path = tmp_path / "drawing.dxf"
    entities = drawing(random.Random(seed), path)
    found = overlays.read(path)
    assert len(found.curves) == len(entities) and not found.remarks
    for entity, (name, curve) in zip(entities, found.curves.items(), strict=True):
        assert name.startswith("keel" if entity.dxf.layer == "keel" else "f_0")
        loose = entity.dxftype() == "SPLINE" and entity.knots[1] > entity.knots[0]
        if loose:
            known = BSpline(entity.knots, np.array([tuple(p) for p in entity.control_points]), 3)
            places = known(np.linspace(3, 8, 17))
        elif entity.dxftype() == "SPLINE":
            places = np.array([tuple(p) for p in entity.construction_tool().approximate(30)])
        else:
            # Vertices of a flattened path are on the arcs of it to 1e-6 or so (Bezier arcs).
            places = np.array([tuple(p) for p in make_path(entity).flattening(10, segments=4)])
            places = places[[0, len(places) // 2, -1]]
        size = float(np.ptp(curve.points, axis=0).max())
        assert off_curve(curve, places) < 1e-3 * size, (entity.dxftype(), name)
        for end, mine in ((places[0], 0.0), (places[-1], 1.0)):
            assert np.abs(curve(mine) - end).max() < 1e-9 * size or entity.dxftype() == "CIRCLE"
    # They are objects to build upon.
    model = moldloft.loads(found.to_sdl())
    name, curve = next(iter(found.curves.items()))
    assert np.abs(model[name](0.3) - curve(0.3)).max() < 1e-12 * 100
    # The file states millimetres.
    metres = overlays.read(path, units="m")
    assert np.allclose(metres.curves[name].points, curve.points / 1000, rtol=1e-15)


def test_arcs_of_drawings_are_circles(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    document.modelspace().add_arc((3, 4, 5), 2, 30, 290)
    document.saveas(tmp_path / "arc.dxf")
    (curve,) = overlays.read(tmp_path / "arc.dxf").curves.values()
    at = curve(np.linspace(0, 1, 300)) - (3, 4, 5)
    assert np.abs(np.hypot(at[:, 0], at[:, 1]) - 2).max() < 1e-14
    assert np.abs(at[:, 2]).max() < 1e-14
    angle = np.degrees(np.unwrap(np.arctan2(at[:, 1], at[:, 0])))
    assert angle[0] == pytest.approx(30) and angle[-1] == pytest.approx(290)


@pytest.mark.parametrize("angle", ["inf", "-1e308", "9007199254740993", "nan", "-1e9"])
def test_arcs_without_an_angle_are_left_out(tmp_path: Path, angle: str) -> None:
    pytest.importorskip("ezdxf")
    arcs = [f"0\nARC\n8\n0\n10\n0\n20\n0\n40\n1\n50\n{a}\n51\n90" for a in ("-630", angle)]
    path = tmp_path / "arc.dxf"
    path.write_text("\n".join(["0\nSECTION\n2\nENTITIES", *arcs, "0\nENDSEC\n0\nEOF\n"]))
    found = overlays.read(path)
    (curve,) = found.curves.values()
    # From 90 to 90 degrees is a full turn.
    assert np.abs(curve([0.0, 0.25, 0.5]) - [(0, 1, 0), (-1, 0, 0), (0, -1, 0)]).max() < 1e-12
    assert any("ARC" in remark for remark in found.remarks)


SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="210mm" viewBox="0 0 420 100">{}</svg>'


@pytest.mark.parametrize(
    ("shape", "places"),
    [
        ('<path d="M1 2 L5 2 5 6z"/>', [(1, 2), (3, 2), (5, 4), (3, 4)]),
        ('<path d="m1 2l4 0v4h-4z"/>', [(1, 2), (5, 3), (2, 6), (1, 4)]),
        # (1 - t)^3 a + ... at t = 1/2.
        ('<path d="M0 0C0 8 8 8 8 0"/>', [(0, 0), (4, 6), (8, 0)]),
        ('<path d="M0 0C0 8 8 8 8 0S16 -8 16 0"/>', [(4, 6), (12, -6), (16, 0)]),
        ('<path d="M0 0Q4 8 8 0T16 0"/>', [(4, 4), (12, -4), (16, 0)]),
        # After a curve of the other kind there is no handle to mirror.
        ('<path d="M0 0Q4 8 8 0S16 8 16 0"/>', [(4, 4), (12, 3), (16, 0)]),
        ('<path d="M0 0C0 8 8 8 8 0T16 0"/>', [(4, 6), (12, 0), (16, 0)]),
        ('<path d="M0 0a5 5 0 0110 0"/>', [(0, 0), (5, -5), (10, 0)]),
        ('<path d="M0 0A5 5 0 0 0 10 0"/>', [(0, 0), (5, 5), (10, 0)]),
        # Radii that are too small grow.
        ('<path d="M0 0A1 1 0 0 1 10 0"/>', [(5, -5)]),
        ('<circle cx="3" cy="4" r="2"/>', [(5, 4), (3, 6), (1, 4)]),
        ('<ellipse cx="3" cy="4" rx="2" ry="1"/>', [(5, 4), (3, 5), (1, 4)]),
        ('<rect x="1" y="2" width="4" height="3"/>', [(1, 2), (5, 2), (5, 5), (1, 3)]),
        ('<rect x="1" y="2" width="6" height="5" rx="1"/>',
         [(4, 2), (7, 4), (1, 4), (6 + math.sqrt(0.5), 3 - math.sqrt(0.5))]),
        ('<polygon points="0,0 4,0 4,4"/>', [(2, 2), (4, 1)]),
        ('<polyline points="0 0 4 0 4 4"/>', [(4, 3)]),
        ('<line x1="1" y1="2" x2="5" y2="6"/>', [(3, 4)]),
        ('<g transform="translate(10 0) rotate(90)"><line x2="4"/></g>', [(10, 2), (10, 4)]),
        ('<g transform="rotate(90 1 1)"><line x1="1" y1="1" x2="3" y2="1"/></g>', [(1, 3)]),
        ('<g transform="scale(2) skewX(45)"><line y2="1"/></g>', [(2, 2)]),
        ('<g transform="matrix(1 2 3 4 5 6)"><line x2="1" y2="1"/></g>', [(5, 6), (9, 12)]),
    ],
)  # fmt: skip
def test_shapes_of_svg_files_are_where_they_are_drawn(
    shape: str, places: list[tuple[float, float]], tmp_path: Path
) -> None:
    path = tmp_path / "drawing.svg"
    path.write_text(SVG.format(shape))
    (curve,) = overlays.read(path).curves.values()
    at = np.array([(x, -y, 0.0) for x, y in places])
    assert off_curve(curve, at) < 1e-6
    # 420 units are 210 mm.
    (small,) = overlays.read(path, units="mm").curves.values()
    assert np.allclose(small.points, curve.points / 2, rtol=1e-15)


def test_a_drawing_is_converted_to_a_program(tmp_path: Path) -> None:
    from moldloft.cli import main

    (tmp_path / "plan.svg").write_text(SVG.format('<path id="keel" d="M0 0 L200 0"/>'))
    assert main(["convert", str(tmp_path / "plan.svg"), "-o", str(tmp_path / "plan.sdl")]) == 0
    model = moldloft.load(tmp_path / "plan.sdl")
    assert model["keel"](1).tolist() == pytest.approx([0.1, 0, 0])
    (tmp_path / "text.svg").write_text(SVG.format("<text>no curve</text>"))
    assert main(["convert", str(tmp_path / "text.svg")]) == 1


BAD_SVG = {
    "cut": '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0',
    "number first": SVG.format('<path d="3 4 L5 6"/>'),
    "no move": SVG.format('<path d="L5 6"/>'),
    "half a pair": SVG.format('<path d="M0 0 L5"/>'),
    "letters": SVG.format('<path d="M0 0 X5"/>'),
    "empty": SVG.format(""),
    "html": "<html/>",
    "transform": SVG.format('<g transform="turn(3)"><line x2="1"/></g>'),
    "entities": '<!DOCTYPE svg [<!ENTITY a "b">]>' + SVG.format('<line x2="1"/>'),
}


@pytest.mark.parametrize("name", BAD_SVG)
def test_bad_drawings_are_named(name: str, tmp_path: Path) -> None:
    path = tmp_path / "drawing.svg"
    path.write_text(BAD_SVG[name])
    with pytest.raises(moldloft.FileError, match=r"drawing\.svg"):
        overlays.read(path)


def test_bad_files_are_named(tmp_path: Path) -> None:
    pytest.importorskip("ezdxf")
    pytest.importorskip("meshio")
    for name, data in {
        "a.dxf": b"",
        "b.dxf": b"nonsense\n",
        "c.xyz": b"",
        "d.xyz": b"1 2 3\n4 five 6\n",
        "e.stl": b"solid x\nfacet\n",
        "f.obj": b"v 0 0 0\nf 1 2 3\n",
        "h.ply": b"ply\n",
        "i.gdf": b"title\n1 9.8\n0 0\n3\n0 0 0\n",
        "j.msh": b"$MeshFormat\n",
    }.items():
        (tmp_path / name).write_bytes(data)
        with pytest.raises(moldloft.Error, match=name):
            overlays.read(tmp_path / name)
    with pytest.raises(moldloft.Error, match="expected one of"):
        overlays.read(tmp_path / "x.foo")
    (tmp_path / "g.xyz").write_text("0 0 0\n")
    with pytest.raises(moldloft.Error, match="file_units"):
        overlays.read(tmp_path / "g.xyz", units="m")
    with pytest.raises(moldloft.Error, match="furlong"):
        overlays.read(tmp_path / "g.xyz", units="furlong")
    feet = overlays.read(tmp_path / "g.xyz", units="m", file_units="ft")
    assert feet.points.tolist() == [[0, 0, 0]]


HALF = """
    Model info(symmetry = "y"); Line a({0, 0, -1}, {4, 0, -1}); Line b({0, 2, -1}, {4, 2, -1});
    Line c({0, 2, 0}, {4, 2, 0}); RuledSurf bottom(a, b, divisions = {5, 2});
    RuledSurf side(b, c, divisions = {5, 3});
"""


@pytest.mark.parametrize("ending", ["stl", "obj", "ply", "off", "msh"])
def test_meshes_come_back_as_they_were_written(ending: str, tmp_path: Path) -> None:
    if ending == "msh":
        pytest.importorskip("meshio")
    model = moldloft.loads(HALF.replace('Model info(symmetry = "y");', ""))
    mesh = model.mesh()
    found = overlays.read(model.write(tmp_path / f"half.{ending}")[0])
    triangles = len(mesh.faces) * (2 if ending == "stl" else 1)
    assert len(found.faces) == triangles and not found.remarks
    corners = found.points[found.faces.astype(int)]
    area = np.linalg.norm(
        np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1
    )
    if ending == "stl":
        area = np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
    assert area.sum() / 2 == pytest.approx(12)
    assert found.deviation(model).largest < 1e-12
    if ending == "msh":
        assert [name for name, _, _ in found.groups] == ["bottom", "side"]


@pytest.mark.parametrize("ending", ["gdf", "dat", "pnl", "hst"])
def test_panel_files_come_back_whole(ending: str, tmp_path: Path) -> None:
    model = moldloft.loads(HALF)
    model.partial = True
    form = {"dat": "nemoh", "pnl": "hams", "hst": "hydrostar"}.get(ending, ending)
    with pytest.warns(UserWarning, match="open below the water"):
        (path, *_) = model.write(tmp_path / f"half.{ending}", format=form)
    found = overlays.read(path)
    assert len(found.faces) == 2 * len(model.mesh().faces)
    assert found.points[:, 1].min() == pytest.approx(-2)
    assert found.deviation(model).largest < 1e-6


@pytest.mark.parametrize("ending", ["gdf", "mar", "pnl", "hst"])
@pytest.mark.parametrize("mirrors", [(), (1,), (0,), (0, 1)])
def test_panel_files_are_what_capytaine_reads(
    ending: str, mirrors: tuple[int, ...], tmp_path: Path
) -> None:
    capytaine = pytest.importorskip("capytaine")
    x, y = int(0 in mirrors), int(1 in mirrors)
    if (ending == "mar" and x) or (ending == "hst" and (x, y) == (1, 0)):
        pytest.skip("the format has no such symmetry")
    rng = np.random.default_rng(1 + x + 2 * y)
    i, j = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    points = np.stack([i + 1, j + 1, -1 - 0.1 * rng.random(i.shape)], axis=-1).reshape(-1, 3)
    k = np.arange(20).reshape(5, 4)
    faces = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    faces[::5, 3] = faces[::5, 2]
    rows = [" ".join(f"{c:.17g}" for c in p) for p in points]
    corners = [" ".join(str(c + 1) for c in face) for face in faces]
    if ending == "gdf":
        lines = [
            "title",
            "1 9.81",
            f"{x} {y}",
            str(len(faces)),
            *(rows[c] for f in faces for c in f),
        ]
    elif ending == "mar":
        lines = [f"2 {y}", *(f"{n + 1} {row}" for n, row in enumerate(rows)), "0 0 0 0", *corners,
                 "0 0 0 0"]  # fmt: skip
    elif ending == "pnl":
        own = [" ".join(str(c + 1) for c in dict.fromkeys(face.tolist())) for face in faces]
        lines = ["a", "b", "c", f"{len(faces)} {len(points)} {x} {y}", "", "nodes",
                 *(f"{n + 1} {row}" for n, row in enumerate(rows)), "", "", "panels",
                 *(f"{n + 1} {len(o.split())} {o}" for n, o in enumerate(own))]  # fmt: skip
    else:
        lines = ["PROJECT : a", f"SYMMETRY : {x + y}", "COORDINATES", *rows, "ENDCOORDINATES",
                 "PANEL TYPE 0", *corners, "ENDPANEL", "ENDFILE"]  # fmt: skip
    path = tmp_path / f"a.{ending}"
    path.write_text("\n".join(lines) + "\n")
    theirs = capytaine.load_mesh(str(path)).merged()
    ours = overlays.read(path)
    flat = ours.points[ours.faces.astype(int)]

    def known(corners: np.ndarray) -> list[tuple[float, ...]]:
        # Twice the vector area does not depend on where a panel begins.
        area = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        return sorted(tuple(row) for row in np.round(area, 9))

    assert len(flat) == theirs.nb_faces == len(faces) * 2 ** len(mirrors)
    assert known(flat) == known(np.asarray(theirs.vertices)[np.asarray(theirs.faces)])


@pytest.mark.parametrize(
    ("ending", "text", "line"),
    [
        ("mar", "2 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n0 0 0 0\n1 2", "line 7"),
        ("mar", "2 0\n1 2 3 4\n2 1 0 0\n3 1 1 0\n4 0 1 0\n0 0 0 0\n 0 0 0\n1 2 3 4\n", "no panels"),
        ("mar", "2 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n", "zeros"),
        ("mar", "2 0\n1 0 0 0\n3 1 1 0\n0 0 0 0\n1 2 2 2\n", "vertex 2"),
        ("mar", "2 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n0 0 0 0\n1 2 9\n", "beyond the 3 vertices"),
        ("gdf", "a\n1 9.8\n0 0\n1\n0 0 0 1 0 0 1 1\n", "expected 12 numbers, found 8"),
        ("gdf", "a\n1 9.8\n0 2\n1\n", "line 3"),
        ("pnl", "a\nb\nc\n1 3 0 0\n\n\n1 0 0 0\n2 1 0 0\n3 1 1 0\n\n\n\n1 5 1 2 3\n", "line 13"),
        ("hst", "COORDINATES\n0 0 0\n1 0 0\n", "end of the vertices"),
        ("hst", "COORDINATES\n0 0 x\n", "line 2"),
    ],
)
def test_wrong_panel_files_are_refused_at_the_line(
    ending: str, text: str, line: str, tmp_path: Path
) -> None:
    path = tmp_path / f"a.{ending}"
    path.write_text(text)
    with pytest.raises(moldloft.FileError, match=line):
        overlays.read(path)


BALL = """
    AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2); AbsPoint E(2, 0, 0); Line axis(S, N);
    Arc half(S, N, E, type = 5); RevSurf ball(half, axis);
"""


def test_distances_from_a_ball_are_those_of_its_formula() -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(500, 3)) * 2
    found = overlays.deviation(moldloft.loads(BALL), points)
    exact = np.linalg.norm(points, axis=1) - 2
    assert np.abs(np.abs(found.distances) - np.abs(exact)).max() < 1e-9
    # One sign outside, the other inside.
    assert len({*(np.sign(found.distances) * np.sign(exact)).tolist()}) == 1
    assert not found.beside.any()
    assert found.rms == pytest.approx(math.sqrt(np.mean(exact**2)), rel=1e-9)
    assert "ball" in found.summary()


def test_the_sign_is_that_of_the_side_to_which_panels_face() -> None:
    lines = "Line a({0, 0, 0}, {4, 0, 0}); Line b({0, 3, 0}, {4, 3, 0});"
    for turned, sign in [("", 1), (", orientation = 1", -1)]:
        model = moldloft.loads(f"{lines} RuledSurf s(a, b{turned});")
        found = overlays.deviation(model, [[1, 1, 0.5], [1, 1, -0.25]])
        assert found.distances == pytest.approx([0.5 * sign, -0.25 * sign])


def test_distances_from_an_imported_solid_are_positive_outside(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from cad_models import box
    from moldloft.cad.importing import load_cad

    # One half of the faces of another program run against their surfaces.
    rng = np.random.default_rng(7)
    (path,) = moldloft.loads(box(1, 2, 3)).write(tmp_path / "box.step")
    points = rng.uniform(-1, 4, (200, 3))
    found = overlays.deviation(load_cad(path), points)
    inside = ((points > 0) & (points < [1, 2, 3])).all(axis=1)
    sure = ~found.beside
    assert sure.sum() > 50 and inside.sum() > 3
    assert ((found.distances < 0) == inside)[sure].all()


def test_images_count_and_edges_are_told_from_faces() -> None:
    model = moldloft.loads(
        'Model info(symmetry = "y"); Line a({0, 1, 0}, {4, 1, 0}); Line b({0, 1, 3}, {4, 1, 3});'
        "RuledSurf wall(a, b);"
    )
    points = np.array([[1, 1.5, 1], [1, -1.5, 1], [1, 0.2, 1], [6, 1, 1], [5, -2, 2.0]])
    found = overlays.deviation(model, points)
    assert np.abs(found.distances) == pytest.approx([0.5, 0.5, 0.8, 2, math.sqrt(2)])
    assert found.beside.tolist() == [False, False, False, True, True]
    assert found.feet[1].tolist() == pytest.approx([1, -1, 1])
    for names, word in [("a", "not a surface"), ("none", "none")]:
        with pytest.raises(moldloft.Error, match=word):
            overlays.deviation(model, points, objects=names)
    body = moldloft.loads(
        "AbsPoint A(0, 0, 0); SetBody body(set(sphere(A, 2)), {-3, -3, -3}, {3, 3, 3});"
    )
    with pytest.raises(moldloft.Error, match="triangles"):
        overlays.deviation(body, points)


HULL = """
    Model info(symmetry = "y"); param float beam = 2 in [1, 3]; param float depth = 1 in [0.2, 3];
    BCurve a({{0, 0, 0}, {3, 0, -depth}, {6, 0, 0}});
    BCurve b({{0, 0, 1}, {3, beam, 1}, {6, 0, 1}}); RuledSurf side(a, b);
"""


@pytest.mark.parametrize("seed", range(3 * ROUNDS))
def test_parameters_are_found_again_from_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    model, truth = moldloft.loads(HULL), moldloft.loads(HULL)
    wanted = {"beam": rng.uniform(1.2, 2.9), "depth": rng.uniform(0.4, 2)}
    truth.set(wanted)
    points = truth["side"](*rng.random((2, 300)))
    points[::2, 1] *= -1
    found = overlays.fit(model, points, ["beam", "depth"])
    assert found.converged and found.deviation.rms < 1e-9
    assert found.values == pytest.approx(wanted, abs=1e-8)
    assert model["beam"] == found.values["beam"]
    # With noise the answer is that of least squares: no neighbour is nearer.
    noisy = points + rng.normal(size=points.shape) * 0.01
    found = overlays.fit(model, noisy, ["beam", "depth"])
    for name, value in found.values.items():
        for step in (-1e-4, 1e-4):
            model.set({**found.values, name: value + step})
            assert overlays.deviation(model, noisy).rms >= found.deviation.rms
    assert found.values == pytest.approx(wanted, abs=0.02)


def test_a_fit_keeps_ranges_and_says_what_is_missing() -> None:
    model = moldloft.loads(HULL)
    points = np.array([[3, 9.0, 1], [2, 8, 1]])
    assert overlays.fit(model, points, ["beam"]).values == {"beam": 3.0}
    with pytest.raises(moldloft.Error, match="parameter"):
        overlays.fit(model, points, [])
    with pytest.raises(moldloft.Error, match="determine"):
        overlays.fit(model, points[:1], ["beam", "depth"])
    with pytest.raises(moldloft.Error, match="nope"):
        overlays.fit(model, points, ["nope"])
