"""The page of diagnostics: it has each id of the sources, and each program raises its own."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

from moldloft.explanations import EXPLANATIONS

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "diagnostics.md"
WRITER = runpy.run_path(str(ROOT / "docs" / "diagnostics.py"))
EXAMPLES: dict[str, tuple[str, str]] = WRITER["examples"]()


def ids_of_the_sources() -> set[str]:
    found: set[str] = set()
    begins = (
        r"\b(?:CallError::new|Diagnostic::(?:error|warning|remark))\(\s*\"([a-z]+(?:-[a-z]+)*)\""
    )
    tables = r"=> \"([a-z]+(?:-[a-z]+)+)\",?$"
    for path in (ROOT / "crates").glob("*/src/**/*.rs"):
        text = path.read_text(encoding="utf-8").split("#[cfg(test)]\nmod ")[0]
        found |= set(re.findall(begins, text))
        if "fn id(&self)" in text or (path.name == "read.rs" and "field" in path.parts):
            found |= set(re.findall(tables, text, re.M))
    return found


def test_each_id_of_the_sources_is_explained() -> None:
    ids = ids_of_the_sources()
    assert len(ids) > 200
    assert not ids - set(EXPLANATIONS), "moldloft.explanations lacks these"


def test_an_explanation_has_meaning_and_remedy() -> None:
    for name, text in EXPLANATIONS.items():
        assert text[0].isupper() or text[0] == "`", name
        assert text.endswith(".") and len(text) > 25, name


def test_ids_without_a_program_are_known() -> None:
    assert set(EXPLANATIONS) - set(EXAMPLES) == WRITER["WITHOUT"]


#: Long programs, in the long run alone.
SLOW = {
    "as-triangles",
    "curved-body",
    "file-too-large",
    "too-many-steps",
    "too-much-output",
    "volume-uncertain",
}


def test_the_page_is_what_the_script_writes() -> None:
    sections = dict(re.findall(r"^## (\S+)\n\n(.*?)(?=^## |\Z)", PAGE.read_text(), re.M | re.S))
    assert sections.keys() == EXPLANATIONS.keys()
    for name, text in sections.items():
        assert text.startswith(EXPLANATIONS[name] + "\n"), name


@pytest.mark.parametrize("name", [n for n in EXAMPLES if n not in SLOW])
def test_a_program_raises_its_diagnostic(name: str) -> None:
    language, text = EXAMPLES[name]
    shown = [message for id_, message in WRITER["raised"](language, text) if id_ == name]
    assert shown, name
    printed = f"```text\n{shown[0]}\n```"
    assert printed in PAGE.read_text(encoding="utf-8"), "run docs/diagnostics.py: " + shown[0]
