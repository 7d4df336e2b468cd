"""Changes names and defaults of arguments in their rows alone, builds, checks all faces.

    python tools/renames.py                     50 rows
    python tools/renames.py --seed 7 --rows 20

Rows are drawn by the seed from all structs with `#[derive(Kind)]`. In one half an argument gets
another name, within the struct, its columns, its example and the code of its own that reads it; in
the other half another default. Nothing else is touched. The faces are those of
`tests/python/house/test_faces.py`. The tree must be clean; it is left as it was.
"""

from __future__ import annotations

import argparse
import random
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

STRUCT = re.compile(
    r"#\[derive\(Kind\)\]\n#\[kind\((?P<options>.*?)\)\]\npub struct (?P<name>\w+)<T: \w+> \{\n"
    r"(?P<body>.*?)\n\}",
    re.S,
)
FIELD = re.compile(r"(?P<attributes>(?:    #\[field\(.*?\)\]\n)?)    (?P<name>[a-z]\w*): ", re.S)
NUMBER = re.compile(r"default = (-?\d+(?:\.\d+)?)(?=[,)])")


@dataclass(frozen=True)
class Change:
    """A change of an argument of a row."""

    row: str
    field: str
    #: Another name, or a number.
    to: str | float

    def __str__(self) -> str:
        what = "called" if isinstance(self.to, str) else "default"
        return f"{self.row}: {self.field} {what} {self.to}"


def own_code(text: str, struct: str) -> list[tuple[int, int]]:
    """The ranges of the blocks `impl ... Struct<T> { ... }`."""
    heads = rf"^impl<[^\n]*\b{struct}<T>[^\n]*\{{\n.*?^\}}"
    return [match.span() for match in re.finditer(heads, text, re.M | re.S)]


def named(call: str, text: str, old: str, new: str) -> str:
    """A program in which the argument `old` of the calls of a row is called `new`."""
    out, at = [], 0
    for match in re.finditer(rf"\b{call}\b(?: \w+)?\(", text):
        depth, end = 1, match.end()
        while depth:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        out += [text[at : match.end()]]
        out += [re.sub(rf"\b{old} = ", f"{new} = ", text[match.end() : end])]
        at = end
    return "".join([*out, text[at:]])


def renamed(text: str, match: re.Match[str], row: str, old: str, new: str) -> str | None:
    """The file with an argument renamed, or `None` where other code reads the field."""
    struct = match["name"]
    blocks = own_code(text, struct)
    inside = "".join(text[a:b] for a, b in blocks)
    # Names of locals stay: the field is read once, into the old name.
    other = re.sub(rf"\bself\.{old}\b|\bSelf::{old.upper()}\b|Self \{{[^}}]*\}}", "", inside)
    if re.search(rf"\.{old}\b", other) or re.search(rf"\b{struct}\b[^\n]*\.{old}\b", text):
        return None
    if re.search(rf"(?<!struct )(?<!for )\b{struct}(?:::<\w+>)? \{{", text):
        return None
    edits = []
    for a, b in blocks:
        code = re.sub(rf"\bself\.{old}\b", f"self.{new}", text[a:b])
        code = re.sub(rf"\bSelf::{old.upper()}\b", f"Self::{new.upper()}", code)
        code = re.sub(
            r"\bSelf \{[^}]*\}",
            lambda taken: re.sub(
                rf"(?<=[{{,])(\s+){old}\b(:?)",
                lambda name: f"{name[1]}{new}:" + ("" if name[2] else f" {old}"),
                taken[0],
            ),
            code,
        )
        edits.append((a, b, code))
    head = match[0]
    columns = re.search(r'columns = "([^"]*)"', head)
    if columns:
        changed = re.sub(rf"\b{old}\b", new, columns[0])
        head = head.replace(columns[0], changed)
    head = re.sub(r"sweep = \[[^\]]*\]", lambda s: re.sub(rf"\b{old}\b", new, s[0]), head)
    example = re.search(r'example = "((?:[^"\\]|\\.)*)"', head, re.S)
    if example:
        head = head.replace(example[1], named(row, example[1], old, new))
    head = re.sub(rf"^    {old}: ", f"    {new}: ", head, flags=re.M)
    edits.append((*match.span(), head))
    for a, b, code in sorted(edits, reverse=True):
        text = text[:a] + code + text[b:]
    return re.sub(rf"\b{struct}(::<\w+>)?::{old.upper()}\b", rf"{struct}\1::{new.upper()}", text)


def change(text: str, match: re.Match[str], draw: random.Random) -> tuple[str, Change] | None:
    """The file with one argument of a row changed."""
    options = re.search(r'\bname = "(\w+)"', match["options"])
    row = options[1] if options else match["name"]
    fields = [f for f in FIELD.finditer(match["body"]) if f["name"] not in ("scalar", "relabel")]
    draw.shuffle(fields)
    by_default = draw.random() < 0.5
    for field in fields:
        old = field["name"]
        number = NUMBER.search(field["attributes"])
        if by_default and number:
            value = float(number[1])
            top = re.search(r"max = (-?[\d.]+)", field["attributes"])
            low = re.search(r"min = (-?[\d.]+)", field["attributes"])
            new = value + 1 if not top or value + 1 <= float(top[1]) else value - 1
            if low and new < float(low[1]):
                continue
            written = field["attributes"].replace(number[0], f"default = {new:g}")
            body = match["body"][: field.start()] + written + match["body"][field.end(1) :]
            start = match.start("body")
            return text[:start] + body + text[match.end("body") :], Change(row, old, new)
        if not by_default and len(old) > 1:
            made = renamed(text, match, row, old, f"{old}_anew")
            if made is not None:
                return made, Change(row, old, f"{old}_anew")
    return None


def draw_changes(seed: int, rows: int) -> tuple[list[Change], dict[Path, str]]:
    """Changes of rows, and the changed files."""
    draw = random.Random(seed)
    files = sorted((ROOT / "crates").glob("*/src/**/*.rs"))
    texts = {path: path.read_text(encoding="utf-8") for path in files}
    changed: dict[Path, str] = {}
    places = [(path, m["name"]) for path, text in texts.items() for m in STRUCT.finditer(text)]
    draw.shuffle(places)
    made = []
    for path, name in places:
        if len(made) == rows:
            break
        text = changed.get(path, texts[path])
        match = next(m for m in STRUCT.finditer(text) if m["name"] == name)
        if found := change(text, match, draw):
            changed[path] = found[0]
            made.append(found[1])
    return made, changed


#: In another process: this one may have loaded the library before the change.
CHECK = """
import sys
from moldloft import _core
rows = {row["name"]: row for row in _core.reference()}
for row, old, new in CHANGES:
    fields = {field["name"]: field for field in rows[row]["fields"]}
    if isinstance(new, str):
        assert new in fields and old not in fields, (row, old, new)
    else:
        assert fields[old]["default"] == new, (row, old, new)
"""


def run(*words: str) -> None:
    """Runs a command in the root."""
    print("+", *(word[:80] for word in words), flush=True)
    subprocess.run(words, cwd=ROOT, check=True)


def check(changes: list[Change]) -> None:
    """Builds, generates, and compares the faces."""
    run("make", "setup")
    plain = [(each.row, each.field, each.to) for each in changes]
    run(".venv/bin/python", "-c", f"CHANGES = {plain!r}\n{CHECK}")
    run("make", "stubs")
    run(".venv/bin/python", "-m", "pytest", "--quiet", "tests/python/house/test_faces.py")
    stubs = "".join(path.read_text() for path in ROOT.glob("python/moldloft/**/*.pyi"))
    for each in changes:
        if isinstance(each.to, str) and each.to not in stubs:
            raise SystemExit(f"the stubs do not follow: {each}")


def main() -> int:
    """Changes, checks, and restores."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--seed", type=int, default=41)
    parser.add_argument("--rows", type=int, default=50)
    parser.add_argument("--list", action="store_true", help="change the tree and stop")
    options = parser.parse_args()
    status = subprocess.run(
        ["git", "status", "--porcelain"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    if status.stdout:
        print("expected a clean tree: these changes would be lost\n" + status.stdout)
        return 2
    changes, texts = draw_changes(options.seed, options.rows)
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
    print("\n".join(map(str, changes)))
    if options.list:
        return 0
    try:
        check(changes)
    finally:
        run("git", "reset", "--quiet", "--hard")
    print(f"{len(changes)} rows: all faces follow")
    return 0


if __name__ == "__main__":
    sys.exit(main())
