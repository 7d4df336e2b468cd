"""Applies patches of `tests/changes` to a clean tree, builds it, checks all faces of the additions.

    python tools/changes.py                     all patches, in one build
    python tools/changes.py kind command        some
    python tools/changes.py --apart             a build for each

Each patch is a real addition: its module, a test of all faces (model, Python, command, help) and
the lines that name the module elsewhere, at most `FILES` files and `LINES` lines. Before the first
difference it states a word of the addition and the generated files that must contain it.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CHANGES = ROOT / "tests" / "changes"

#: Maximum number of files, and of added lines in them, besides new ones.
FILES, LINES = 2, 5


@dataclass(frozen=True)
class Change:
    """A patch, by its file."""

    path: Path
    word: str
    generated: list[str]
    #: New files.
    modules: list[str]
    #: Added lines by the other files.
    touched: dict[str, int]

    @classmethod
    def read(cls, path: Path) -> Change:
        """The patch of a file."""
        text = path.read_text(encoding="utf-8")
        head, *parts = re.split(r"^diff --git ", text, flags=re.M)
        word = re.search(r"^Word: (.+)$", head, re.M)
        generated = re.search(r"^Generated: (.+)$", head, re.M)
        if not word or not generated:
            raise ValueError(f"{path.name}: expected `Word:` and `Generated:` before the changes")
        modules, touched = [], {}
        for part in parts:
            name = part.split()[1].removeprefix("b/")
            if "\nnew file mode" in part:
                modules.append(name)
            else:
                touched[name] = len(re.findall(r"^\+(?!\+\+ )", part, re.M))
        files = [name for name in generated[1].split() if name != "-"]
        return cls(path, word[1], files, modules, touched)

    @property
    def faults(self) -> list[str]:
        """Excesses of the bounds."""
        lines = sum(self.touched.values())
        found = []
        if len(self.touched) > FILES:
            found.append(f"{len(self.touched)} files besides its own, at most {FILES}")
        if lines > LINES:
            found.append(f"{lines} lines besides its own, at most {LINES}")
        return found


def changes() -> list[Change]:
    """All patches, by name."""
    return [Change.read(path) for path in sorted(CHANGES.glob("*.patch"))]


def run(*words: str) -> None:
    """Runs a command in the root."""
    print("+", *words, flush=True)
    subprocess.run(words, cwd=ROOT, check=True)


def check(changes: list[Change]) -> None:
    """Applies, builds, tests, generates; leaves the tree as it was."""
    modules = [name for change in changes for name in change.modules]
    try:
        for change in changes:
            run("git", "apply", "--index", str(change.path))
        run("make", "setup")
        tests = [name for name in modules if name.startswith("tests/python/")]
        if tests:
            run(".venv/bin/python", "-m", "pytest", "--quiet", *tests)
        if any(name.startswith("web/") for name in modules):
            run("npm", "--prefix", "web", "run", "--silent", "check")
        if any(change.generated for change in changes):
            run("make", "stubs")
        for change in changes:
            for name in change.generated:
                content = (ROOT / name).read_bytes()
                if change.word.encode() not in content:
                    raise SystemExit(f"{change.path.name}: {name} does not contain {change.word}")
    finally:
        run("git", "reset", "--quiet", "--hard")
        run("git", "clean", "--quiet", "--force", "tests/python", "python", "web/src")


def main() -> int:
    """Checks the named patches."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", help="names of patches; all by default")
    parser.add_argument("--apart", action="store_true", help="a build for each patch")
    options = parser.parse_args()
    names = options.names
    status = subprocess.run(
        ["git", "status", "--porcelain"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    if status.stdout:
        print("expected a clean tree: these changes would be lost\n" + status.stdout)
        return 2
    known = {change.path.stem: change for change in changes()}
    if missing := set(names) - set(known):
        parser.error(f"expected one of {', '.join(known)}, found {', '.join(sorted(missing))}")
    chosen = [known[name] for name in names or known]
    for change in chosen:
        if faults := change.faults:
            print(f"{change.path.stem}: {'; '.join(faults)}")
            return 1
    for group in [[change] for change in chosen] if options.apart else [chosen]:
        check(group)
        print(f"{', '.join(change.path.stem for change in group)}: right by all faces")
    return 0


if __name__ == "__main__":
    sys.exit(main())
