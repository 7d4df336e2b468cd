"""The documentation: every program, Python block and command of every page, and the site itself."""

from __future__ import annotations

import argparse
import html
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import moldloft

ROOT = Path(__file__).resolve().parents[3]
DOCS = ROOT / "docs"
PAGES = sorted(p for p in DOCS.rglob("*.md") if p.parent.name != "inside")

#: Pages whose blocks go on from one another, and how many of the last stand alone.
CUMULATIVE = {"tutorial.md"}

#: Pages that are made, or run elsewhere: `test_docs.py`, `test_diagnostics_page.py`, Rust.
ELSEWHERE = {"implicit.md", "tutorial.md", "diagnostics.md"}


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a language; the end of one is not the beginning of another."""
    text = page.read_text(encoding="utf-8")
    fenced = re.findall(r"^```([^\n`]*)\n(.*?)^```$", text, re.M | re.S)
    return [body for name, body in fenced if re.fullmatch(language, name)]


def named(page: Path) -> str:
    return page.relative_to(ROOT).as_posix().removeprefix("docs/")


PROGRAMS = [
    pytest.param(page, text, id=f"{named(page)}-{k}")
    for page in [ROOT / "README.md", *PAGES]
    if page.name not in ELSEWHERE
    for k, text in enumerate(blocks(page, "sdl"))
]


@pytest.mark.parametrize(("page", "text"), PROGRAMS)
def test_a_program_of_a_page_runs(page: Path, text: str) -> None:
    folder = [str(ROOT / "examples" / "missile"), str(ROOT / "examples" / "sketch")]
    model = moldloft.loads(text, library=folder, strict=False)
    assert not model.diagnostics, "\n".join(map(str, model.diagnostics))


#: The stability of a decked hull at every heel takes minutes on a slow machine; the tutorial of the
#: propeller designer is walked in `test_tutorials.py`.
LONG = set() if os.environ.get("MOLDLOFT_SOAK") else {"hydrostatics.md", "propeller.md"}

PYTHON = [
    page
    for page in [ROOT / "README.md", *PAGES]
    if page.name not in ELSEWHERE | LONG and blocks(page, "python")
]


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the examples, as a reader has them."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    return tmp_path


_HULL = "import moldloft\nm = moldloft.load('examples/sailboat/hull.sdl')\n"

_DECKED = """
import moldloft
from pathlib import Path
text = Path("examples/sailboat/hull.sdl").read_text()
m = moldloft.loads(text + '''
AbsPoint Q1(30, 0, 2.76);
Line middle(P11, Q1); RuledSurf deck(hull.u0, middle, divisions = {20, 4});
Line post(Q1, P34); RuledSurf transom(hull.v1, post, divisions = {10, 4});
''')
"""

_GRIDS = """
from pathlib import Path
import numpy as np
from moldloft import grids
u, v = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 4), indexing="ij")
grids.write_plot3d("body.x", [np.stack([u, v, u * v], axis=-1)])
x = (1 - np.cos(np.linspace(0, np.pi, 21))) / 2
y = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
upper, lower = np.c_[x, y][::-1], np.c_[x, -y][1:]
rows = "".join(f"{a:.6f} {b:.6f}\\n" for a, b in [*upper, *lower])
Path("naca0012.dat").write_text("NACA 0012\\n" + rows)
"""

_README = f"""
from pathlib import Path
Path("hull.sdl").write_text({blocks(ROOT / "README.md", "sdl")[0]!r})
"""

_TEE = f"""
from pathlib import Path
Path("tee.sdl").write_text({blocks(ROOT / "docs" / "tutorials" / "product.md", "sdl")[0]!r})
"""

# A hull with the inputs of the page's study; its plan in eight cases, and an objective.
_STUDY = f"""
from pathlib import Path
Path("hull.sdl").write_text('''
Model info(symmetry = "y", units = "m");
param float beam = 4 in [3, 5];
param float length = 12 in [11.5, 13];
AbsPoint P11(0, 0, 1); AbsPoint P12(0.4, 0, 0.2); AbsPoint P13(1, 0, -0.4);
AbsPoint P21(length / 2, 2, 1); AbsPoint P22(length / 2, beam / 2, -0.3);
AbsPoint P23(length / 2, 0, -0.6);
AbsPoint P31(length, 1.5, 1); AbsPoint P32(length, 1.2, 0.6); AbsPoint P33(length, 0, 0.2);
BCurve stem({{P11, P12, P13}}, degree = 2); BCurve midship({{P21, P22, P23}}, degree = 2);
BCurve transom({{P31, P32, P33}}, degree = 2);
CLoftSurf hull({{stem, midship, transom}}, divisions = {{8, 16}});
''')
study = {blocks(DOCS / "studies.md", "toml")[0]!r}
goal = "[optimize]\\nminimize = 'area'\\nmethod = 'slsqp'\\n"
Path("yacht.toml").write_text(study.replace("count = 256", "count = 8") + goal)
"""

#: What a page's Python blocks take as given.
GIVEN = {
    "README.md": _README,
    "index.md": _README,
    "hydrostatics.md": _DECKED,
    "cad.md": _HULL,
    "panels.md": _HULL,
    "grids.md": _GRIDS,
    "product.md": _TEE,
    "studies.md": _STUDY,
}


@pytest.mark.parametrize("page", PYTHON, ids=named)
def test_the_python_of_a_page_runs(page: Path, workplace: Path) -> None:
    namespace: dict[str, object] = {"__name__": "page"}
    exec(GIVEN.get(page.name, ""), namespace)
    for k, block in enumerate(blocks(page, "python")):
        exec(compile(block, f"{named(page)}, block {k + 1}", "exec"), namespace)


def commands(page: Path) -> list[list[str]]:
    """The commands of a page's shell blocks: what follows `moldloft` up to a pipe or a comment."""
    found = []
    for block in blocks(page, "(?:sh|bash|console)?"):
        for line in block.splitlines():
            if not line.startswith("moldloft "):
                continue
            line = re.split(r"\s{3,}", line)[0]
            words = shlex.split(line, comments=True)[1:]
            for sign in ("|", ">", "<", "&&", ">>"):
                if sign in words:
                    words = words[: words.index(sign)]
            found.append([word for word in words if word != "…"])
    return found


@cache
def whole_parser() -> argparse.ArgumentParser:
    from moldloft.cli import COMMANDS, whole_parser

    return whole_parser(list(COMMANDS))


@pytest.mark.parametrize("page", [ROOT / "README.md", *PAGES], ids=lambda p: p.stem)
def test_the_commands_of_a_page_are_commands(page: Path) -> None:
    for words in commands(page):
        if "..." in words or words[:1] == ["--help"] or "--help" in words:
            continue
        try:
            whole_parser().parse_args(words)
        except SystemExit:
            pytest.fail(f"{page.name}: moldloft {' '.join(words)}")


def test_the_reference_has_each_entry_once_in_a_group() -> None:
    from moldloft.cli.reference_page import FUNCTIONS, entry_pages, groups, index_page
    from moldloft.language import reference
    from moldloft.library import routines

    found = groups(reference())
    names = [row["name"] for _, _, rows in found for row in rows]
    assert sorted(names) == sorted(row["name"] for row in reference())
    assert "Other functions" not in [title for title, _, _ in found], found[-1][2]
    assert {n for _, text in FUNCTIONS for n in text.split()} <= set(names)
    index = index_page(reference(), routines())
    listed = re.findall(r"^\| \[`(\w+)`\]\(reference/\w+\.md\) \|", index, re.M)
    rows = [*reference(), *routines()]
    assert sorted(listed) == sorted(row["name"] for row in rows)
    pages = entry_pages(reference(), lambda row: False, routines())
    assert len(pages) == len(rows)
    for page in pages.values():
        assert len(page) < 30_000
        assert set(re.findall(r"\]\(([a-z0-9_]+)\.md\)", page)) <= set(pages)


def test_terms_of_each_field_are_found() -> None:
    from moldloft.language import guides, reference, search
    from moldloft.library import routines
    from moldloft.terms import FIELDS

    names = {row["name"] for row in reference()}
    others = {row["name"] for row in routines()}
    for field, rows in FIELDS.items():
        terms = [(term, target) for target, line in rows.items() for term in line.split(", ")]
        assert len({term.lower() for term, _ in terms}) >= 50, field
        for term, target in terms:
            if target in names:
                assert target in [row["name"] for row in search(term)[:15]], term
            elif target not in others:
                assert (DOCS / f"{target}.md").is_file(), target
                addresses = [address for _, address in guides(term)[:4]]
                assert any(address.endswith(f"/{target}.html") for address in addresses), term


def test_every_argument_in_the_reference_has_a_meaning() -> None:
    from moldloft.language import reference
    from moldloft.library import routines

    bare = [
        (row["name"], field["name"])
        for row in [*reference(), *routines()]
        for field in row["fields"]
        if len(field["help"].removeprefix("Filled by the routine.").strip()) < 3
    ]
    assert not bare


def test_an_example_calls_what_it_is_the_example_of() -> None:
    from moldloft.language import reference
    from moldloft.library import routines

    other = [
        row["name"]
        for row in [*reference(), *routines()]
        if row["example"] and not re.search(rf"\b{row['name']}\b", row["example"])
    ]
    assert not other


def test_examples_in_help_are_commands() -> None:
    from moldloft.cli import COMMANDS, EXAMPLES

    assert set(EXAMPLES) <= set(COMMANDS)
    for name, text in EXAMPLES.items():
        for line in text.splitlines():
            line = re.split(r"\s{3,}", line.strip())[0]
            if "|" in line:
                line = line.split("|")[1].strip()
            words = shlex.split(re.split(r" [<>]", line)[0])
            assert words[0] == "moldloft" and words[1] == name
            whole_parser().parse_args(words[1:])


@pytest.mark.parametrize("page", [ROOT / "README.md", DOCS / "index.md"], ids=lambda p: p.name)
def test_the_first_minute_prints_what_it_shows(page: Path, cli, workplace: Path) -> None:
    Path("hull.sdl").write_text(blocks(page, "sdl")[0])
    printed = ""
    for words in commands(page):
        if words[0] in ("build", "eval"):
            done = cli(*words)
            printed += done.stdout + done.stderr
    for line in blocks(page, "text")[0].splitlines():
        assert line == "..." or line in printed.splitlines(), line
    m = moldloft.load("hull.sdl")
    m["beam"] = 4.4
    shown = (m.hydrostatics().volume, m.derivative("hydrostatics.volume", "beam"))
    assert "{:.4f}, {:.4f}".format(*shown) in page.read_text(encoding="utf-8")


def test_the_naval_architects_commands_run(cli, workplace: Path) -> None:
    page = DOCS / "tutorials" / "naval-architect.md"
    exec(compile(blocks(page, "python")[0], page.name, "exec"), {})
    for words in commands(page):
        cli(*words)


def searched(page: Path, word: str) -> str | None:
    """What the search of a page opened from its folder says; None where there is no browser."""
    names = ("chromium", "chromium-browser", "google-chrome")
    browser = next(filter(None, map(shutil.which, names)), None)
    if browser is None:
        return None
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as p:
        running = p.chromium.launch(executable_path=browser, args=["--no-sandbox"])
        view = running.new_page()
        remote: list[str] = []
        view.on("request", lambda r: remote.append(r.url) if r.url.startswith("http") else None)
        view.goto(page.as_uri())
        view.wait_for_function("typeof __index == 'object' && document.querySelector('iframe')")
        said = view.locator(".md-search-result__meta")
        view.click("input.md-search__input")
        view.keyboard.type(word)
        for _ in range(300):
            if "matching" in said.inner_text():
                break
            view.wait_for_timeout(100)
        text = str(said.inner_text())
        running.close()
    assert not remote
    return text


def test_the_site_is_whole(tmp_path: Path) -> None:
    """Built strictly: every page in the menu, every link and anchor valid."""
    from moldloft.terms import FIELDS

    pytest.importorskip("mkdocs")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", tmp_path],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
    )
    assert done.returncode == 0, done.stderr
    entries = json.loads((tmp_path / "search" / "search_index.json").read_bytes())["docs"]
    index = html.unescape(" ".join(entry["text"] for entry in entries))
    terms = [t for rows in FIELDS.values() for line in rows.values() for t in line.split(", ")]
    for word in ("CLoftSurf", "righting", *terms):
        assert word in index, word
    pages = list(tmp_path.rglob("*.html"))
    assert len(pages) > 700
    for page in pages:
        most = 60_000 if page.parent.name in ("reference", "diagnostics") else 150_000
        assert page.stat().st_size < most, page
    # Programs are highlighted: kinds, names, numbers, comments.
    relational = (tmp_path / "relational.html").read_text(encoding="utf-8")
    for name, word in (("nc", "AbsPoint"), ("nv", "arch"), ("c1", "# halfway"), ("k", "assert")):
        assert f'<span class="{name}">{word}</span>' in relational, word
    # It opens from a folder: nothing is fetched from elsewhere.
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert not re.findall(r'(?:src|<link[^>]*href)="https?://[^"]*', text), page.name
    found = searched(tmp_path / "tutorials" / "dam.html", "geodesic")
    assert found is None or "matching document" in found
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    for page in PAGES:
        assert named(page) in nav, f"{named(page)} is on no menu"


def test_every_picture_is_drawn_by_a_script_and_used() -> None:
    import runpy

    images = DOCS / "images"
    drawn = runpy.run_path(str(DOCS / "pictures.py"))
    names = {
        f"{name}.png" for kind in ("MODELS", "PROGRAMS", "PLOTS", "STUDIES") for name in drawn[kind]
    }
    names |= {"deformation.png", "study-waves.png"}
    for script in ("desk_pictures.py", "making_pictures.py"):
        text = (DOCS / script).read_text(encoding="utf-8")
        names |= {f"{name}.png" for name in re.findall(r'(?:shown|held)\(page, "([\w-]+)"\)', text)}
    for folder in ("implicit", "sketch"):
        script = (ROOT / "examples" / folder / "pictures.py").read_text(encoding="utf-8")
        stems = {path.stem for path in (ROOT / "examples" / folder).glob("*.s*")}
        names |= {
            path.name
            for path in images.glob(f"{folder}-*")
            if path.stem.removeprefix(f"{folder}-") in stems and f"{folder}-" in script
        }
    names.add("drag.webp")
    names |= {f"gallery/{path.stem}.png" for path in (ROOT / "examples" / "gallery").glob("*.sdl")}
    there = {path.relative_to(images).as_posix() for path in images.rglob("*.*")}
    assert there == names
    used = [ROOT / "README.md", *PAGES, *(ROOT / "examples").glob("*/README.md")]
    text = "".join(page.read_text(encoding="utf-8") for page in used)
    assert not [name for name in there if f"images/{name}" not in text]
    large = {n: (images / n).stat().st_size for n in there}
    assert large.pop("drag.webp") < 1_500_000
    assert max(large.values()) < 250_000, max(large, key=large.__getitem__)
