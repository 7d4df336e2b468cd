"""The page of diagnostics: each program raises its id, with the message that the page shows."""

from __future__ import annotations

import re
from pathlib import Path

import moldloft

PAGE = Path(__file__).parents[2] / "docs" / "diagnostics.md"
SECTION = re.compile(r"^## (\S+)\n\n```sdl\n(.*?)\n```\n\n```text\n(.*?)\n```\n", re.M | re.S)


def test_each_program_raises_its_diagnostic() -> None:
    sections = SECTION.findall(PAGE.read_text(encoding="utf-8"))
    assert len(sections) > 80
    wrong = []
    for name, text, printed in sections:
        model = moldloft.loads(text, name="model.sdl", strict=False)
        told = [str(d).rstrip() for d in model.diagnostics if d.id == name]
        if printed not in told:
            wrong.append(f"{name}: {told[:1] or [d.id for d in model.diagnostics]}")
    assert not wrong, "run docs/diagnostics.py: " + "\n".join(wrong)


def test_the_page_has_what_people_meet_first() -> None:
    names = {name for name, _, _ in SECTION.findall(PAGE.read_text(encoding="utf-8"))}
    for name in (
        "missing-argument",
        "wrong-class",
        "unknown-name",
        "shapes-differ",
    ):
        assert name in names, name
