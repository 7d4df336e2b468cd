"""How the files of the Rust crates know one another."""

from __future__ import annotations

import re
from pathlib import Path

CRATES = Path(__file__).resolve().parents[2] / "crates"

# The most files of a circle.
MOST = 3


def _paths(tree: str) -> list[str]:
    """The paths of a `use` tree."""
    tree = tree.strip()
    found = re.match(r"^(.*?)\{(.*)\}$", tree, re.S)
    if not found:
        return [re.sub(r"\s+as\s+\w+", "", tree).strip()]
    head, body = found.groups()
    items, depth, item = [], 0, ""
    for letter in body:
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            items.append(item)
            item = ""
        else:
            item += letter
    items.append(item)
    return [head + path for i in items if i.strip() for path in _paths(i)]


def _uses(source: Path) -> dict[tuple[str, ...], set[tuple[str, ...]]]:
    """Which modules of a crate each of its modules imports from; re-exports are followed."""
    modules: dict[tuple[str, ...], str] = {}
    for file in source.rglob("*.rs"):
        parts = file.relative_to(source).with_suffix("").parts
        if parts[-1] == "tests":
            continue
        if parts[-1] in ("mod", "lib"):
            parts = parts[:-1]
        text = re.split(r"#\[cfg\(test\)\]\s*mod \w+ \{", file.read_text())[0]
        modules[parts] = re.sub(r"//[^\n]*", "", text)

    def absolute(module: tuple[str, ...], path: str) -> tuple[str, ...] | None:
        parts = tuple(p.strip() for p in path.split("::"))
        if parts[0] == "crate":
            return parts[1:]
        if parts[0] == "self":
            return module + parts[1:]
        if parts[0] == "super":
            while parts and parts[0] == "super":
                module, parts = module[:-1], parts[1:]
            return module + parts
        return module + parts if module + parts[:1] in modules else None

    def module_of(path: tuple[str, ...]) -> tuple[str, ...]:
        return next(path[:k] for k in range(len(path), -1, -1) if path[:k] in modules or k == 0)

    exported: dict[tuple[str, ...], tuple[str, ...]] = {}
    for module, text in modules.items():
        for found in re.finditer(r"pub(?:\([^)]*\))? use ([^;]+);", text):
            for path in _paths(found.group(1)):
                full = absolute(module, path)
                if full is not None and module_of(full):
                    exported[(*module, full[-1])] = module_of(full)

    uses: dict[tuple[str, ...], set[tuple[str, ...]]] = {m: set() for m in modules}
    for module, text in modules.items():
        paths = [
            p for found in re.finditer(r"\buse ([^;]+);", text) for p in _paths(found.group(1))
        ]
        paths += re.findall(r"\b(?:crate|super)(?:::\w+)+", re.sub(r"\buse [^;]+;", "", text))
        for path in paths:
            full = absolute(module, path)
            if full is None:
                continue
            heads = (full[:k] for k in range(len(full), 0, -1))
            known = (h for h in heads if h in modules or h in exported)
            head = next(known, ())
            target = exported.get(head, head)
            if target and module and target != module:
                uses[module].add(target)
    return uses


def _circles(uses: dict[tuple[str, ...], set[tuple[str, ...]]]) -> list[set[tuple[str, ...]]]:
    """The sets of modules that all lead to one another."""

    def reached(start: tuple[str, ...]) -> set[tuple[str, ...]]:
        seen: set[tuple[str, ...]] = set()
        open_ = list(uses[start])
        while open_:
            module = open_.pop()
            if module not in seen:
                seen.add(module)
                open_ += uses.get(module, ())
        return seen

    reach = {module: reached(module) for module in uses}
    circles: list[set[tuple[str, ...]]] = []
    for module in uses:
        circle = {m for m in reach[module] if module in reach.get(m, ())}
        if module in reach[module] and circle not in circles:
            circles.append(circle)
    return circles


def test_no_circle_of_more_than_three_files() -> None:
    for crate in sorted(CRATES.iterdir()):
        if not (crate / "src").is_dir():
            continue
        for circle in _circles(_uses(crate / "src")):
            names = sorted("/".join(m) for m in circle)
            assert len(circle) <= MOST, f"{crate.name}: {', '.join(names)}"


def test_a_circle_is_found(tmp_path: Path) -> None:
    (tmp_path / "lib.rs").write_text("mod a;\nmod b;\nmod c;\n")
    (tmp_path / "a.rs").write_text("use crate::b::B;\npub struct A;\n")
    (tmp_path / "b.rs").write_text("use crate::c::{C, D as E};\npub struct B;\n")
    (tmp_path / "c.rs").write_text("pub struct C(crate::a::A);\n")
    assert _circles(_uses(tmp_path)) == [{("a",), ("b",), ("c",)}]
