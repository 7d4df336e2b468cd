"""Each tutorial by its own words alone: its files, commands and Python in order, then its goal."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from conftest import ROOT, Run

TUTORIALS = ROOT / "docs" / "tutorials"

Walk = Callable[[str], tuple[dict[str, Any], str]]


@pytest.fixture
def walk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cli: Run) -> Walk:
    """Follows a page in an empty folder; the source is there only where the page asks for it."""
    monkeypatch.chdir(tmp_path)

    def follow(name: str) -> tuple[dict[str, Any], str]:
        text = (TUTORIALS / f"{name}.md").read_text(encoding="utf-8")
        if "git clone" in text:
            shutil.copytree(ROOT / "examples", tmp_path / "examples")
        else:
            # A link may lead there; a command or a program may not.
            fenced = "".join(body for _, body in blocks(text))
            assert "examples/" not in fenced
        names: dict[str, Any] = {"__name__": "tutorial"}
        printed = ""
        for language, body in blocks(text):
            if language == "sdl":
                file = re.match(r"# (\S+\.sdl)\n", body)
                assert file, "a program says which file it is"
                Path(file[1]).write_text(body, encoding="utf-8")
            elif language == "python":
                exec(compile(body, f"{name}.md", "exec"), names)
            elif language == "":
                for line in body.splitlines():
                    words = shlex.split(re.split(r"\s{3,}", line)[0])
                    if words[:1] != ["moldloft"] or words[1] == "view":
                        assert words[0] in ("moldloft", "cargo", "pip"), line
                        continue
                    printed += cli(*words[1:]).stdout
        return names, printed

    return follow


def blocks(text: str) -> list[tuple[str, str]]:
    return re.findall(r"^```([^\n`]*)\n(.*?)^```$", text, re.M | re.S)


def test_naval_architect(walk: Walk) -> None:
    names, printed = walk("naval-architect")
    # Wigley's parabolic form: L B T 4/9 below the water, waterplane 2/3 L B.
    state = names["hull"].hydrostatics(density=1.025)
    assert state.volume == pytest.approx(4 / 9 * 20 * 4 * 2, rel=2e-3)
    assert state.waterplane_area == pytest.approx(2 / 3 * 20 * 4, rel=2e-3)
    # Ordinates (1 - s²)³ over the length: BM of the waterplane.
    moment = 2 / 3 * 2**3 * 20 * 16 / 35
    assert state.bmt == pytest.approx(moment / (4 / 9 * 160), rel=4e-3)
    # At small angles GZ is GM sin(heel).
    arms = names["arms"]
    gm = arms.gm if hasattr(arms, "gm") else None
    assert arms.gz[0] == pytest.approx(0, abs=1e-9) and (gm is None or gm > 0)
    table = Path("table.csv").read_text(encoding="utf-8").splitlines()
    assert len(table) == 8
    assert Path("out/wigley.lines.pdf").read_bytes().startswith(b"%PDF")
    assert "no errors" in printed


def test_cfd_engineer(walk: Walk) -> None:
    names, _ = walk("cfd")
    from moldloft import grids

    read, _, _ = grids.read_plot3d("wingbody.p3d")
    assert len(read) == len(names["mesh"].patches)
    text = Path("wingbody.stl").read_text()
    solids = re.findall(r"^solid (\S+)", text, re.M)
    assert len(solids) == len(set(solids)) >= len(read)
    # The whole body is closed: opposite edges cancel.
    vertices = np.array(re.findall(r"vertex (\S+) (\S+) (\S+)", text), dtype=float).reshape(
        -1, 3, 3
    )
    areas = np.cross(vertices[:, 1] - vertices[:, 0], vertices[:, 2] - vertices[:, 0])
    assert np.abs(areas.sum(axis=0)).max() < 1e-6 * np.abs(areas).sum()
    assert Path("out/layers.blockMeshDict").exists() and Path("out/layers.volume.cgns").exists()
    h5py = pytest.importorskip("h5py")
    with h5py.File("out/layers.volume.cgns") as file:
        groups: list[Any] = []
        file.visititems(lambda _, thing: groups.append(thing))
        zones = [group for group in groups if "ZoneType" in getattr(group, "keys", list)()]
        cells = sum(int(np.prod(zone[" data"][1])) for zone in zones)
    assert len(zones) == 5 and cells == 14_400


def test_propeller_designer(walk: Walk) -> None:
    names, printed = walk("propeller")
    m = names["m"]
    # The derivative against differences of the area.
    step = 1e-4
    areas = []
    for value in (0.9 + step, 0.9 - step):
        m["chord"] = value
        areas.append(m.eval("one.skin.area"))
    assert names["slope"] == pytest.approx((areas[0] - areas[1]) / (2 * step), rel=1e-5)
    # Both sides of a thin blade: twice its fifth of the expanded area, and a little more.
    disc = np.pi / 4 * m.variables["diameter"] ** 2 if "diameter" in m.variables else None
    m["chord"] = 1.0
    if disc is not None:
        fifth = names["ratio"] * disc / 5
        assert 1.95 * fifth < m.eval("one.skin.area") < 2.3 * fifth
    for file in ("out/propeller.p3d", "out/propeller.stl", "out/propeller.step", "propeller.png"):
        assert Path(file).stat().st_size > 1000
    assert "propeller" in printed


def test_civil_engineer(walk: Walk) -> None:
    names, printed = walk("dam")
    dam = names["dam"]
    step = 1e-3
    volumes = []
    for value in (6 + step, 6 - step):
        dam["crest"] = value
        volumes.append(dam.eval("dam.volume"))
    assert names["by_crest"] == pytest.approx((volumes[0] - volumes[1]) / (2 * step), rel=1e-6)
    dam["crest"] = 8
    assert f"{dam.eval('dam.volume'):.6g}"[:6] in printed
    for file in (
        "dam.stl",
        "out/arch_dam.stl",
        "out/arch_dam.volume.cgns",
        "out/arch_dam.blockMeshDict",
    ):
        assert Path(file).stat().st_size > 1000


def test_product_designer(walk: Walk) -> None:
    _, printed = walk("product")
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.load("out/tee.stl")
    mesh.merge_vertices()
    assert mesh.is_watertight and mesh.volume > 0
    # Without the blend: the main, and the branch beyond it, by the integral over its section.
    x, y = np.meshgrid(*[np.linspace(-12, 12, 2001)] * 2)
    beyond = np.where(x**2 + y**2 < 144, 50 - np.sqrt(400 - np.minimum(y**2, 400)), 0)
    sharp = np.pi * 400 * 100 + beyond.sum() * 0.012**2
    volume = float(printed.split()[-1])
    # The ring of the blend: radius 8 along an edge of a little more than the branch's girth.
    ring = volume - sharp
    assert 0.5 * (1 - np.pi / 4) * 64 * 75 < ring < 2 * (1 - np.pi / 4) * 64 * 125, ring
    m = moldloft.load("tee.sdl")
    assert mesh.volume == pytest.approx(m.eval("volume(tee)"), rel=2e-3)
    assert Path("tee.png").read_bytes().startswith(b"\x89PNG")


def test_researcher(walk: Walk) -> None:
    names, _ = walk("optimisation")
    optimize = pytest.importorskip("scipy.optimize")
    # From another start, and with differences instead of the derivatives: the same optimum.
    at, wanted = names["at"], names["wanted"]
    again = optimize.minimize(
        lambda x: at(x)[0][0],
        [5.0, 1.0, 11.0],
        bounds=names["bounds"],
        constraints={"type": "eq", "fun": lambda x: at(x)[0][1] - wanted},
        method="SLSQP",
    )
    assert again.fun == pytest.approx(names["found"].fun, rel=1e-4)


def test_rust_programmer() -> None:
    """Its programs are built by the Rust tests; here that what it names is there."""
    text = (TUTORIALS / "rust.md").read_text(encoding="utf-8")
    for name in re.findall(r"--example (\w+)", text):
        assert (ROOT / "crates" / "moldloft" / "examples" / f"{name}.rs").is_file()
    assert (ROOT / "crates" / "moldloft" / "src" / "lib.rs").is_file()
