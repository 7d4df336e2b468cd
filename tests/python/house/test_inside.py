"""The pages for contributors name what there is, and their examples run."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
INSIDE = DOCS / "inside"
PAGES = sorted(INSIDE.glob("*.md"))
#: Pages of measured figures are no tours.
TOURS = [p for p in PAGES if p.stem not in ("index", "fairing-studies", "studies")]

ITEM = r"\b(?:fn|struct|enum|trait|type|const|static|mod)\s+{}\b"


@cache
def sources(crate: str) -> dict[str, str]:
    """The texts of a crate by path."""
    files = (ROOT / "crates" / crate / "src").rglob("*.rs")
    return {p.relative_to(ROOT).as_posix(): p.read_text(encoding="utf-8") for p in files}


def missing(path: str) -> str | None:
    """What of `crate::module::Type::function` is defined nowhere."""
    crate, *rest = path.split("::")
    texts = sources(crate)
    if not texts:
        return f"there is no crate {crate}"
    for name in rest:
        if not any(re.search(ITEM.format(name), text) for text in texts.values()):
            return f"{name} is not defined in crate {crate}"
    if len(rest) > 1 and rest[-2][0].isupper():
        owner = rf"\b(?:impl|trait)\b[^;{{]*\b{rest[-2]}\b"
        item = ITEM.format(rest[-1])
        if not any(re.search(owner, text) and re.search(item, text) for text in texts.values()):
            return f"{rest[-2]} has no {rest[-1]} in crate {crate}"
    return None


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_what_a_page_names_exists(page: Path) -> None:
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    crates = {p.name for p in (ROOT / "crates").iterdir()}
    names = [n for n in re.findall(r"`([a-z_-]+(?:::\w+)+)`", text) if n.split("::")[0] in crates]
    wrong = {name: why for name in names if (why := missing(name))}
    assert not wrong
    paths = re.findall(r"`((?:crates|tests|python|benches|docs|examples)/[\w./-]+)`", text)
    assert not [p for p in paths if not (ROOT / p).exists()]
    if page in TOURS:
        assert len(names) >= 10, "a tour names the functions on its way"


@pytest.mark.parametrize("page", TOURS, ids=lambda p: p.stem)
def test_a_tour_has_a_figure_and_an_example_that_runs(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    (figure,) = re.findall(r"!\[[^\]]+\]\(([\w.]+)\)", text)
    assert (INSIDE / figure).read_bytes().startswith(b"\x89PNG")
    assert f"def {Path(figure).stem}(" in (INSIDE / "figures.py").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    assert block.count("assert") >= 3
    exec(compile(block, page.name, "exec"), {})


def test_the_index_leads_from_words_of_the_field_to_their_files() -> None:
    text = (INSIDE / "index.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.*?) \| (.*?) \| (.*?) \|$", text, re.M)[2:]
    assert len(rows) > 60
    for term, names, files in rows:
        found = [ROOT / p for p in re.findall(r"\]\(\.\./\.\./([^)]+)\)", files)]
        assert found, term
        assert all(p.exists() for p in found), term
        whole = "\n".join(p.read_text(encoding="utf-8") for p in found)
        for name in re.findall(r"`([^`]+)`", names):
            last = name.split("::")[-1]
            stems = {part for p in found for part in (p.stem, p.parent.name, p.name)}
            assert last in stems or re.search(ITEM.format(last), whole), (term, name)
    words = " ".join(term for term, _, _ in rows)
    for asked in (
        "reparametrisation of a curve",
        "orientation of panels",
        "ray tracing of a set",
        "interior-point solver",
        "second-order cone",
        "T-junction search",
        "contour lines of a body",
    ):
        assert asked in words


def _tables() -> list[list[list[str]]]:
    """The tables of the page on architecture, row by row, without their heads."""
    text = (DOCS / "architecture.md").read_text(encoding="utf-8")
    tables = re.findall(r"(?:^\|.*\|\n)+", text, re.M)
    cells = [
        [[c.strip() for c in line.strip("|\n").split(" | ")] for line in t.splitlines()]
        for t in tables
    ]
    return [table[2:] for table in cells]


def _manifests() -> dict[str, str]:
    crates = (ROOT / "crates").glob("*/Cargo.toml")
    return {p.parent.name: p.read_text(encoding="utf-8") for p in crates}


def _named(cell: str) -> list[str]:
    return re.findall(r"`([^`]+)`", cell)


def test_every_crate_has_a_line_and_uses_the_crates_above_it_only() -> None:
    rooms = [name for row in _tables()[0] for name in _named(row[0])]
    manifests = _manifests()
    assert sorted(rooms) == sorted([*manifests, "python/moldloft"])
    for name, manifest in manifests.items():
        normal = manifest.split("[dependencies]")[-1].split("\n[")[0]
        used = re.findall(r"^moldloft-([\w-]+)", normal, re.M)
        below = [u for u in used if rooms.index(u) >= rooms.index(name)]
        assert not below, f"{name} uses {below}, which the table has below it"
    assert all(len(row) == 3 and all(row) for row in _tables()[0])


def test_every_dependency_has_a_why() -> None:
    why = {name for row in _tables()[1] for name in _named(row[0])}
    used = set()
    for manifest in [*_manifests().values(), (ROOT / "Cargo.toml").read_text(encoding="utf-8")]:
        for section in re.findall(
            r"^\[(?:workspace\.|target\..*\.)?(?:build-)?dependencies\]\n(.*?)(?=^\[|\Z)",
            manifest,
            re.M | re.S,
        ):
            used |= {
                n for n in re.findall(r"^([\w-]+)", section, re.M) if not n.startswith("moldloft")
            }
    assert used == why


def test_paths_that_pages_name_exist() -> None:
    lost = []
    for page in [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]:
        text = page.read_text(encoding="utf-8")
        named = r"`((?:crates|python|tests|benches|examples|docs|editors|fuzz)/[\w./*-]+)`"
        for path in re.findall(named, text):
            if not any(ROOT.glob(path.rstrip("/"))):
                lost.append((page.name, path))
    assert not lost


def test_the_page_on_architecture_is_one_page() -> None:
    assert len((DOCS / "architecture.md").read_text(encoding="utf-8").splitlines()) <= 90


def test_the_commands_of_the_figures_exist() -> None:
    text = (DOCS / "performance.md").read_text(encoding="utf-8")
    for script in set(re.findall(r"`(benches/[\w./]+)`", text)):
        assert (ROOT / script).exists(), script
    for crate, name in set(re.findall(r"`(\w+):(\w+)`", text)):
        if crate != "crate":
            assert (ROOT / "crates" / crate / "examples" / f"{name}.rs").exists(), (crate, name)
    soak = (DOCS / "soak.md").read_text(encoding="utf-8")
    for test in set(re.findall(r"`(\w+/tests/[\w.]+)`", soak)):
        assert (ROOT / "crates" / test).exists(), test
