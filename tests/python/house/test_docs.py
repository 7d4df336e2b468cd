"""The blocks of the tutorial run, one after another, as a reader would type them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import moldloft

DOCS = Path(__file__).parents[3] / "docs"


def blocks(page: str, language: str) -> list[str]:
    text = (DOCS / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("text", blocks("implicit.md", "sdl"))
def test_the_programs_of_the_page_on_implicit_solids_run(text: str) -> None:
    assert not moldloft.loads(text).diagnostics


def test_the_python_of_the_page_on_implicit_solids_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (block,) = blocks("implicit.md", "python")
    block = block.replace('picture("cup.png", samples=2)', 'picture("cup.png", size=(80, 60))')
    exec(compile(block, "implicit.md", "exec"), {})
    assert {p.name for p in tmp_path.iterdir()} == {
        "cup.3mf",
        "cup.svg",
        "cup.png",
        "boxes.svg",
        "mirror.png",
    }


@pytest.fixture
def yacht(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    *parts, _mirror = blocks("tutorial.md", "sdl")
    path = tmp_path / "yacht.sdl"
    path.write_text("\n".join(parts), encoding="utf-8")
    return path


def test_the_program_of_the_tutorial_builds(yacht: Path) -> None:
    model = moldloft.load(yacht)
    assert not model.diagnostics
    assert model.hydrostatics().volume == pytest.approx(116, abs=5)


def test_the_python_of_the_tutorial_runs(yacht: Path) -> None:
    namespace: dict[str, object] = {}
    for block in blocks("tutorial.md", "python"):
        exec(compile(block, "tutorial.md", "exec"), namespace)


def test_the_mirrored_hull_joins_on_the_centre_plane(yacht: Path) -> None:
    mirror = blocks("tutorial.md", "sdl")[-1]
    text = yacht.read_text(encoding="utf-8").replace('symmetry = "y", ', "") + mirror
    mesh = moldloft.loads(text).mesh()
    one = moldloft.load(yacht).mesh()
    # 21 vertices of the keel line are shared.
    assert len(mesh.vertices) == 2 * len(one.vertices) - 21 - 10
