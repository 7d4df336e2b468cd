"""What a newcomer tries in the first hour; figures against closed forms or other programs."""

from __future__ import annotations

import os
import re
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import moldloft
from conftest import ROOT, SAILBOAT, Run

HULL = SAILBOAT / "hull.sdl"
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]


def of_divisions(factor: int) -> moldloft.Model:
    text = HULL.read_text(encoding="utf-8")
    found = text.replace("{10, 20}", f"{{{10 * factor}, {20 * factor}}}")
    assert factor == 1 or found != text
    return moldloft.loads(found)


def test_figures_are_those_of_the_shape() -> None:
    """The same at any panelling; those of the panels converge to them as the square."""
    models = [of_divisions(factor) for factor in (1, 2, 4, 8)]
    exact = [(m.hydrostatics().volume, m["hull"].area) for m in models]
    assert np.ptp(np.array(exact), axis=0) == pytest.approx([0, 0], abs=1e-9)
    errors = [m.panel_figures()["volume"] / exact[0][0] - 1 for m in models]
    assert -0.02 < errors[0] < -0.01
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert ratios == pytest.approx([4, 4, 4], rel=0.1)


@pytest.mark.skipif(not os.environ.get("MOLDLOFT_SOAK"), reason="by the clock")
def test_long_calls_let_other_threads_run() -> None:
    text = HULL.read_text(encoding="utf-8").replace("{10, 20}", "{400, 800}")
    m = moldloft.loads(text)
    tee = moldloft.load(ROOT / "examples" / "implicit" / "tee.sdl")
    calls = {
        "mesh": m.mesh,
        "eval": lambda: tee.eval("volume(tee, {-4,-4,-4}, {4,4,4}, accuracy = 1e-5)"),
    }
    for name, call in calls.items():
        ticks, ended = [0], threading.Event()

        def count(ticks: list[int] = ticks, ended: threading.Event = ended) -> None:
            while not ended.is_set():
                ticks[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        time.sleep(0.02)
        before, start = ticks[0], time.perf_counter()
        call()
        took, made = time.perf_counter() - start, ticks[0] - before
        ended.set()
        thread.join()
        # Held throughout, there would be one or two.
        assert took < 0.02 or made > 20 * took, (name, took, made)


def test_a_mesh_with_a_pole_opens_everywhere(tmp_path: Path) -> None:
    """Quadrilaterals and triangles in one file."""
    trimesh = pytest.importorskip("trimesh")
    m = moldloft.loads(
        "AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2); AbsPoint E(2, 0, 0); Line axis(S, N);"
        "Arc half(S, N, E, type = 5); RevSurf ball(half, axis, divisions = {40, 40});"
    )
    for name in ("ball.ply", "ball.obj", "ball.stl", "ball.off", "ball.glb"):
        m.write(tmp_path / name)
        mesh = trimesh.load(tmp_path / name, force="mesh")
        mesh.merge_vertices()
        assert mesh.is_watertight, name
        assert mesh.volume == pytest.approx(4 / 3 * np.pi * 8, rel=1e-2), name


@pytest.mark.parametrize(
    ("words", "status", "expected"),
    [
        ("render hull.sdl -o x.jpg", 1, "name it with `.png`"),
        ("build hull.sdl --to xyzz", 2, "did you mean `xyz`"),
        ("check twice.sdl", 1, "mirrored-twice"),
        ("build twice.sdl --to stl", 1, "mirrored-twice"),
        ("check cube.sdl", 1, "mirrored-twice"),
        ("hydro cube.sdl", 1, "mirrored-twice"),
        ("check part.sdl", 1, "it is not a program"),
        ("build hull.sdl -o hull.stl", 1, "--to stl"),
        ("check hull.gdf", 1, "it contains no panels"),
        ("check hull.txt", 1, "is not a model: expected"),
        ("check furlong.sdl", 1, "furlong"),
        ("hydro hull.sdl --immm", 2, "unknown option"),
        ("build hull.sdl --to stl -o no/such/folder/x --whol", 2, "did you mean `--whole`"),
        ("doc looft", 1, "unknown kind or function"),
    ],
)
def test_a_first_mistake_is_explained(
    words: str, status: int, expected: str, tmp_path: Path, cli: Run
) -> None:
    text = HULL.read_text(encoding="utf-8")
    (tmp_path / "hull.sdl").write_text(text, encoding="utf-8")
    twice = text + '\nMirrSurf port(hull, "y=0");\n'
    if "symmetry" not in twice:
        twice = 'Model info(symmetry = "y");\n' + twice
    (tmp_path / "twice.sdl").write_text(twice, encoding="utf-8")
    cube = "set s = cuboid({-1, -1, -1}, {1, 1, 1}); SetBody b(s, {-2, -2, -2}, {2, 2, 2});"
    (tmp_path / "cube.sdl").write_text('Model info(symmetry = "y");\n' + cube, encoding="utf-8")
    (tmp_path / "part.sdl").write_text('load "part.step";', encoding="utf-8")
    (tmp_path / "part.step").write_text("ISO-10303-21;\nHEADER;\nENDSEC;\n", encoding="utf-8")
    (tmp_path / "furlong.sdl").write_text('Model info(units = "furlong");')
    (tmp_path / "hull.gdf").write_text("a gdf file\n1 9.8\n0 1\n0\n")
    (tmp_path / "hull.txt").write_text(text, encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    message = cli(*words.split(), status=status).stderr
    assert expected in message
    assert sorted(tmp_path.iterdir()) == before


def test_negative_values_need_no_equals_sign(tmp_path: Path, cli: Run) -> None:
    words = ["--displacement", "10", "--cg", "-1,0,-2", "--density", "1", "--gz", "-10,10,3"]
    words += ["--fixed", "trim"]
    assert "GZ" in cli("hydro", HULL, *words).stdout.replace("gz", "GZ")


def test_shapes_that_do_not_fit_are_named() -> None:
    hull = moldloft.load(HULL)["hull"]
    with pytest.raises(moldloft.Error, match=r"\(2,\).*\(3,\).*broadcast"):
        hull([0, 0.5], [0, 0.5, 0.7])
    with pytest.raises(moldloft.Error, match="nu = -1"):
        hull.grid(-1, 5)


#: Slips in Python, with what the answer must say.
SLIPS = {
    "m.hull": 'the object or parameter is `m["hull"]`',
    "m.beem": "a model has no attribute `beem`",
    "m['hul']": "did you mean `hull`",
    "m.hydrostatics(heel=10)": "a heel is in radians",
    "m.hydrostatics(trim=-9)": "a trim is in radians",
    "m.righting_curve([0, 10, 20], 40, cg=(15, 0, 0), density=1)": "np.radians(10)",
    "m.hydrostatics().unit('volum')": "unknown figure `volum`",
    "m.hydrostatic_table([0.1]).derivative('volume', 'beam')": "no derivatives by `beam`",
    "m.write('hull')": "no ending",
    "m.write('no/such/hull.stl')": "there is no folder",
    "m.hydrostatic_table([0.1]).write_csv('no/such/t.csv')": "there is no folder",
    "m.refine(-1)": "0 or more",
    "m.kind_picture('BCruve')": "did you mean `BCurve`",
    "moldloft.laod": "did you mean `load`",
    "moldloft.Model()": "moldloft.load",
    "moldloft.Sketch('plate.skt')": "Sketch.load",
    "moldloft.param(5, 1, 2)": "not in its range",
    "ball.range((1, 1, 1), (0, 0, 0))": "not below",
    "ball.pruned((0, 0, 0), (1, float('nan'), 1))": "not below",
    "ball.with_attributes(tolerance=-1)": "0 or more",
}


@pytest.mark.parametrize("code", SLIPS)
def test_a_slip_in_python_is_explained(
    code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from moldloft import implicit

    monkeypatch.chdir(tmp_path)
    names = {"m": moldloft.load(HULL), "ball": implicit.Set(implicit.sphere((0, 0, 0), 1))}
    kinds = (moldloft.Error, AttributeError, TypeError, ValueError)
    with pytest.raises(kinds, match=re.escape(SLIPS[code])):
        eval(code, {"moldloft": moldloft, **names})
    assert not list(tmp_path.iterdir())


def test_one_name_is_a_list_of_one() -> None:
    m = moldloft.load(HULL)
    assert m.jacobian("beam").shape[2] == 1
    assert m.derivatives("hull.area", "beam") == m.derivatives(["hull.area"], ["beam"])
    assert m.hydrostatics(by="beam").derivatives["volume"]["beam"] > 0


def test_links_between_the_pages_lead_somewhere() -> None:
    """The reference is made with the site."""
    pages = [*PAGES, *ROOT.glob("examples/*/README.md"), *ROOT.glob("editors/*/README.md")]
    pages += [ROOT / "CONTRIBUTING.md", ROOT / "SECURITY.md"]
    broken = []
    for page in pages:
        text = re.sub(
            r"^```.*?^```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.M | re.S
        )
        for link in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
            made = (page.parent / link).resolve() == ROOT / "docs" / "reference.md"
            if "://" not in link and not made and not (page.parent / link).exists():
                broken.append(f"{page.relative_to(ROOT)}: {link}")
    assert not broken


#: Wordings that reviewers quoted, besides those that are banned everywhere.
QUOTED = """
it would flood|status given|with their breadths|by itself as it comes|leaves negative|get middles
the way of the edges|points may be off|places are not compared|there is one foot
one idea in several rooms
again at every save|fit so many control|a nose away from the tail|coincide apart|make no round faces
ask for less at the walls|these are no divisions|under a name is one object|nothing to speak of
goes on without what does not stop|may be innocent|errors; 0 objects|1 parameters
"""


@pytest.mark.parametrize("wording", QUOTED.replace("\n", "|").strip("|").split("|"))
def test_no_quoted_wording_is_left(wording: str) -> None:
    files = [*PAGES, *(ROOT / "python").rglob("*.py"), *(ROOT / "crates").glob("*/src/**/*.rs")]
    found = [
        path.relative_to(ROOT).as_posix()
        for path in files
        if wording in re.sub(r"\s*\n\s*(?://[/!]? ?)?", " ", path.read_text(encoding="utf-8"))
    ]
    assert not found
