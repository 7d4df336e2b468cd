"""Wordings that read oddly stay out of messages, help texts, docstrings and pages."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

#: What not to write, and what to write instead. Ids of diagnostics are no sentences and stay.
BANNED = {
    r"\btold\b": "reported",
    r"\btells\b": "reports, states, lists",
    r"\bmend(?:s|ed|ing)?\b": "fix, correct",
    r"\bafloat\b": "hydrostatics, floating",
    r"\bso often\b": "that many times; the number of",
    r"\bin one hand\b": "controlled by one parameter",
    r"\bstands? still\b": "has a zero tangent",
    r"\bcannot stand\b": "unexpected",
    r"\bleft to gain\b": "optimality gap",
    r"\bto be little of\b": "the measure to minimise",
    r"\bmoves on everywhere\b": "has a non-zero tangent everywhere",
    r"\basked at\b": "evaluated at",
    r"\bwrong use\b": "usage error",
    r"\btalks? to (?:it|the language)\b": "prompt",
    r"\bdo not fall\b": "non-decreasing",
    r"\bleads nowhere\b": "does not converge",
    r"\b(?:let|run|runs) (?:it |both )?the other way\b": "reverse",
    r"(?<!here )\bis no (?!longer|more|less|one\b|other|such|way|need|better)[a-z]": "is not a",
}


#: Finds every text that may have one of them, at once.
ANY = re.compile("|".join(p.replace("(?<!here )", "").replace(" ", r"\s+") for p in BANNED))


def wrong(text: str) -> list[str]:
    """The banned wordings of a text, with what to say instead."""
    if not ANY.search(text):
        return []
    flat = re.sub(r"\s+", " ", re.sub(r"`[^`\n]*`|\[[^\]]*\]\([^)]*\)", "`…`", text))
    return [
        f"{flat[max(0, m.start() - 40) : m.end() + 40]!r}: say {better}"
        for pattern, better in BANNED.items()
        for m in re.finditer(pattern, flat)
    ]


def _rust_strings(path: Path) -> Iterator[str]:
    """The string literals of a file that read like sentences, tests left out."""
    text = path.read_text(encoding="utf-8").split("#[cfg(test)]\nmod ")[0]
    text = re.sub(r"^\s*//.*$", "", text, flags=re.M).replace("'\"'", "''").replace("'\\\"'", "''")
    for literal in re.findall(r'"((?:[^"\\]|\\.)*)"', text, re.S):
        line = re.sub(r"\\\n\s*", "", literal)
        if " " in line.strip():
            yield line


def _rust_docs(path: Path) -> str:
    """The doc comments of a file, tests left out."""
    text = path.read_text(encoding="utf-8").split("#[cfg(test)]\nmod ")[0]
    return "\n".join(re.findall(r"^\s*//[/!] ?(.*)$", text, re.M))


def _python_strings(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


RUST = sorted((ROOT / "crates").glob("*/src/**/*.rs"))
PYTHON = sorted((ROOT / "python").rglob("*.py"))
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]


def _faults(path: Path, texts: Iterator[str] | list[str]) -> list[str]:
    name = path.relative_to(ROOT).as_posix()
    return [f"{name}: {fault}" for text in texts for fault in wrong(text)]


def test_messages_of_the_crates() -> None:
    faults = [fault for path in RUST for fault in _faults(path, _rust_strings(path))]
    assert not faults, "\n".join(faults)


def test_doc_comments_of_the_crates() -> None:
    faults = [fault for path in RUST for fault in _faults(path, [_rust_docs(path)])]
    assert not faults, "\n".join(faults)


def test_messages_and_docstrings_of_python() -> None:
    faults = [fault for path in PYTHON for fault in _faults(path, _python_strings(path))]
    assert not faults, "\n".join(faults)


def test_pages() -> None:
    faults = [
        fault for path in PAGES for fault in _faults(path, [path.read_text(encoding="utf-8")])
    ]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize("pattern", BANNED)
def test_a_banned_wording_would_be_found(pattern: str) -> None:
    samples = (
        "it was told, and it tells how to mend it: afloat, so often, in one hand; it stands still "
        "and cannot stand; left to gain, to be little of, moves on everywhere, asked at, "
        "wrong use, talk to it; numbers do not fall; leads nowhere; let it run the other way; "
        "this is no file"
    )
    assert re.search(pattern, samples)
