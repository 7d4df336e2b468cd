"""How the files of the Rust crates, and the modules of the Python package, know one another."""

from __future__ import annotations

import ast
import re
from pathlib import Path

CRATES = Path(__file__).resolve().parents[3] / "crates"

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


def _python_uses(
    package: Path, *, inside: bool = False
) -> dict[tuple[str, ...], set[tuple[str, ...]]]:
    """Which modules each module imports when it is itself imported, or with those inside functions.

    The package's own `__init__` is left out of what functions import: it imports all.
    """
    files = {}
    for path in package.rglob("*.py"):
        parts = (package.name, *path.relative_to(package).with_suffix("").parts)
        files[parts[:-1] if parts[-1] == "__init__" else parts] = path
    uses: dict[tuple[str, ...], set[tuple[str, ...]]] = {module: set() for module in files}

    def visit(module: tuple[str, ...], node: ast.AST) -> None:
        for child in ast.iter_child_nodes(node):
            types = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)
            function = isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef))
            if types or (function and not inside):
                continue
            if isinstance(child, ast.ImportFrom) and child.module and not child.level:
                base = tuple(child.module.split("."))
                for name in child.names:
                    inner = (*base, name.name)
                    target = inner if inner in files else base
                    if target in files and target != module and len(target) > 1:
                        uses[module].add(target)
            visit(module, child)

    for module, path in files.items():
        visit(module, ast.parse(path.read_text(encoding="utf-8")))
    return uses


def test_no_circle_in_the_python_package() -> None:
    uses = _python_uses(CRATES.parent / "python" / "moldloft")
    assert sum(map(len, uses.values())) > 100
    assert [sorted(".".join(m) for m in circle) for circle in _circles(uses)] == []


def test_no_circle_of_more_than_three_by_imports_in_functions() -> None:
    uses = _python_uses(CRATES.parent / "python" / "moldloft", inside=True)
    assert sum(map(len, uses.values())) > 150
    for circle in _circles(uses):
        names = sorted(".".join(m) for m in circle)
        assert len(circle) <= MOST, ", ".join(names)


def test_a_circle_of_python_is_found(tmp_path: Path) -> None:
    package = tmp_path / "p"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "a.py").write_text("from p.b import x\n")
    (package / "b.py").write_text("from p import a\n")
    (package / "c.py").write_text("def f():\n    from p import c, a\n")
    assert _circles(_python_uses(package)) == [{("p", "a"), ("p", "b")}]
    (package / "b.py").write_text("def f():\n    from p.c import a\n")
    (package / "c.py").write_text("def f():\n    from p import a\n")
    assert _circles(_python_uses(package)) == []
    three = {("p", "a"), ("p", "b"), ("p", "c")}
    assert _circles(_python_uses(package, inside=True)) == [three]


def test_no_file_of_more_than_a_thousand_lines() -> None:
    root = CRATES.parent
    files = [
        *root.glob("crates/*/src/**/*.rs"),
        *root.glob("python/**/*.py"),
        *root.glob("tools/*"),
    ]
    long = {
        path.relative_to(root).as_posix(): count
        for path in files
        if (count := path.read_text(encoding="utf-8").count("\n")) > 1000
    }
    assert not long


def test_the_package_does_not_use_the_command() -> None:
    """Imports inside of functions count, too."""
    package = CRATES.parent / "python" / "moldloft"
    for path in package.rglob("*.py"):
        inside = path.relative_to(package).parts[0]
        if inside not in ("cli", "__main__.py"):
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"^\s*(?:from|import) moldloft\.cli", text, re.M), path
