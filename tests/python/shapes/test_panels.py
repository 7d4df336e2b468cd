"""Panels from outside: tags, quality, closure, joins, and what the command says of them."""

from __future__ import annotations

import json

import numpy as np
import pytest

import moldloft
from moldloft.cli import main

# Half a box of 4 x 1 x 1, symmetric in y = 0, open there and at the water, with a keel's tag below.
BOX = """
Model info(symmetry = "y");
AbsPoint A(0, 0, -1); AbsPoint B(4, 0, -1); AbsPoint C(4, 1, -1); AbsPoint D(0, 1, -1);
AbsPoint E(0, 0, 0); AbsPoint F(4, 0, 0); AbsPoint G(4, 1, 0); AbsPoint H(0, 1, 0);
Line ab(A, B); Line dc(D, C); Line hg(H, G); Line ad(A, D); Line eh(E, H); Line bc(B, C);
Line fg(F, G); Line ef(E, F);
RuledSurf bottom(ab, dc, divisions = {8, 3}, tags = {"wetted", "keel"}, orientation = 1);
RuledSurf side(dc, hg, divisions = {0, 2}, orientation = 1);
RuledSurf bow(ad, eh, orientation = 1);
RuledSurf stern(bc, fg);
"""
LID = 'RuledSurf lid(ef, hg, tags = "lid");\n'


@pytest.fixture
def box() -> moldloft.Model:
    return moldloft.loads(BOX)


def test_what_is_open_has_names(box: moldloft.Model) -> None:
    closure = box.mesh().closure()
    assert not closure["closed"]
    assert closure["closed_with_lids_and_mirror"]
    found = {(e["patch"], e["edge"], e["closed_by"]) for e in closure["edges"]}
    assert found == {
        ("bottom", "v = 0", "mirror y"),
        ("bow", "u = 0", "mirror y"),
        ("stern", "u = 0", "mirror y"),
        ("side", "v = 1", "lid"),
        ("bow", "v = 1", "lid"),
        ("stern", "v = 1", "lid"),
    }
    assert not box.mesh().closure(level=None)["closed_with_lids_and_mirror"]
    lidded = moldloft.loads(BOX + LID).mesh()
    assert {e["closed_by"] for e in lidded.closure(level=None)["edges"]} == {"mirror y"}
    assert lidded.patch("lid").divisions == (8, 3)


def test_tags_select(box: moldloft.Model) -> None:
    model = moldloft.loads(BOX + LID)
    assert [p.name for p in model.mesh(tags="lid").patches] == ["lid"]
    keel = model.mesh(tags=["keel", "lid"])
    assert [(p.name, p.tag, p.tags) for p in keel.patches] == [
        ("bottom", "wetted", ["wetted", "keel"]),
        ("lid", "lid", ["lid"]),
    ]
    assert keel.area == pytest.approx(8.0)
    with pytest.raises(moldloft.Error, match="no patch has the tag `keal`"):
        box.mesh(tags="keal")


def test_tags_reach_files(tmp_path, box: moldloft.Model) -> None:
    box.write(tmp_path / "box.obj")
    assert "\ng bottom wetted keel\n" in (tmp_path / "box.obj").read_text()
    box.write(tmp_path / "keel.stl", tags="keel")
    assert (tmp_path / "keel.stl").stat().st_size < 5000
    pyvista = pytest.importorskip("pyvista")
    box.write(tmp_path / "box.vtp")
    read = pyvista.read(tmp_path / "box.vtp")
    assert np.asarray(read.cell_data["tag keel"]).sum() == 24


def test_the_worst_panels_are_named(box: moldloft.Model) -> None:
    quality = box.mesh().quality()
    assert quality["bottom"]["aspect"]["max"] == pytest.approx(1.5)
    assert quality["bottom"]["angle"]["min"] == pytest.approx(np.pi / 2)
    # The side's panels are 0.5 x 0.5, the bottom's 0.5 x 1/3.
    assert quality["bottom"]["jump"]["max"] == pytest.approx(1.5)
    worst = quality["bottom"]["jump"]
    assert worst["place"][1] == 2
    assert worst["centre"][1] == pytest.approx(5 / 6)


def test_many_patches_are_measured_in_no_time() -> None:
    lines = ["AbsPoint A0(0, 0, 0); AbsPoint B0(1, 0, 0); Line l0(A0, B0);"]
    for k in range(1, 2001):
        lines.append(
            f"AbsPoint A{k}(0, {k}, 0); AbsPoint B{k}(1, {k}, 0); Line l{k}(A{k}, B{k}); "
            f"RuledSurf S{k}(l{k - 1}, l{k}, divisions = {{2, 2}});"
        )
    assert len(moldloft.loads("\n".join(lines)).mesh().patches) == 2000


def test_the_command_tells_all_of_it(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "box.sdl"
    path.write_text(BOX)
    assert main(["build", str(path), "--quality"]) == 0
    out = capsys.readouterr().out
    assert "open edge: 3 panel edges of bow, v = 1, length 1, closed by lid" in out
    assert "closed with lids and mirror" in out
    assert "worst panels, by (i, j) along u and v" in out
    assert main(["build", str(path), "--tag", "keel", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [mesh["name"] for mesh in data["meshes"]] == ["bottom"]
    assert main(["check", str(path), "--quality", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["closure"]["closed_with_lids_and_mirror"]
    assert data["quality"]["side"]["quads"] == 16
    path.write_text(BOX.replace("{0, 2}", "{9, 2}"))
    assert main(["check", str(path), "--quality"]) == 1
    reported = capsys.readouterr()
    assert "divisions-contradict" in reported.out + reported.err


def test_a_check_tells_what_contradicts_itself_in_panels_and_cells(
    tmp_path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "m.sdl"
    path.write_text(BOX.replace("{0, 2}", "{9, 2}"))
    for command in (["check"], ["build", "--to", "gdf", "-o", str(tmp_path)], ["hydro"]):
        assert main([command[0], str(path), *command[1:]]) == 1
        assert "divisions-contradict" in capsys.readouterr().err
    assert not (tmp_path / "m.gdf").exists()
    # Two floors that cross make a solid that is inside out at one end.
    path.write_text(
        "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0);"
        "Line a(A, B); Line b(C, D); RuledSurf S(a, b); AbsPoint E(0, 0, 2); AbsPoint F(4, 0, -2);"
        "AbsPoint G(0, 3, 2); AbsPoint H(4, 3, -2); Line e(E, F); Line g(G, H); RuledSurf T(e, g);"
        "RuledSolid V(S, T, divisions = {4, 2, 2});"
    )
    for command in (["check"], ["build"]):
        assert main([*command, str(path)]) == 0
        reported = capsys.readouterr().err
        assert "negative-jacobian" in reported and "8 of the 16 cells of `V`" in reported, reported
        assert "in cell (" in reported and "move its faces apart" in reported
    assert main(["check", str(path), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [d["id"] for d in data["diagnostics"]] == ["negative-jacobian"]


def test_model_files_keep_what_is_said_of_panels():
    text = (
        "AbsPoint a(0, 0, 0); AbsPoint b(1, 0, 0); AbsPoint c(0, 2, 0); AbsPoint d(1, 2, 0);"
        "Line ab(a, b); Line cd(c, d);"
        'RuledSurf plate(ab, cd, size = {0.1, 0}, spacing = {"cosine", 1.2},'
        ' tags = {"wetted", "bottom"}, attributes = "A:Note(left)");'
    )
    model = moldloft.loads(text)
    file = model.convert("ms2")
    assert "A:Size(0.1 auto) A:Spacing(cosine 1.2) A:Tags(wetted bottom) A:Note(left)" in file
    again = moldloft.loads(file, name="plate.ms2")
    assert np.array_equal(again.mesh().vertices, model.mesh().vertices)
    assert again.mesh().patches[0].tags == model.mesh().patches[0].tags
    back = again.convert("sdl")
    assert "divisions = {0, 8}" in back
    assert 'size = {0.1, 0}, spacing = {"cosine", 1.2}, tags = {"wetted", "bottom"}' in back
    assert 'attributes = "A:Note(left)"' in back


def test_full_ellipses_close_by_construction() -> None:
    """A cylinder on an ellipse with two lids has no open edge, and pi a b L for its volume."""
    rng = np.random.default_rng(14)
    for k in range(12):
        a, b, height = (float(x) for x in rng.uniform(0.5, 4, 3))
        lean = float(rng.uniform(-0.5, 0.5))
        # Half diameters not square to one another; a full turn by default or as stated.
        turn = ("", ", 0, 2*PI", ", 0, -2*PI")[k % 3]
        model = moldloft.loads(
            f"AbsPoint O(0, 0, -20); AbsPoint A({a}, 0, -20); AbsPoint B({lean}, {b}, -20);"
            f"AbsPoint P(0, 0, {height - 20}); AbsPoint Q({a}, 0, {height - 20});"
            f"AbsPoint R({lean}, {b}, {height - 20});"
            f"Conic low(O, A, B{turn}); Conic high(P, Q, R{turn}); RuledSurf side(low, high);"
            "Line o(O, O); Line p(P, P); RuledSurf floor(low, o); RuledSurf roof(high, p);"
        )
        assert not model.junctions()
        found = model.hydrostatics()
        assert found.open_edges == 0
        assert found.volume == pytest.approx(np.pi * a * b * height, rel=1e-9)
