"""One file of colours: what cannot read it has the same."""

from __future__ import annotations

import json
import re

from conftest import ROOT
from moldloft.colours import COLOURS, MODEL


def test_pictures_and_the_site_have_the_colours_of_the_file() -> None:
    source = (ROOT / "crates" / "picture" / "src" / "palette.rs").read_text(encoding="utf-8")
    rows = re.findall(r"\[0x(\w\w), 0x(\w\w), 0x(\w\w)\]", source)
    assert ["#" + "".join(row) for row in rows] == list(MODEL)
    turn = re.search(r"TURN: \[usize; \d+\] = \[([\d, ]+)\]", source)
    held = json.loads((ROOT / "python" / "moldloft" / "colours.json").read_text(encoding="utf-8"))
    assert turn and json.loads(f"[{turn.group(1)}]") == held["turn"]
    site = (ROOT / "docs" / "site.css").read_text(encoding="utf-8")
    named = dict(re.findall(r"(--md-(?:primary|accent)-fg-color): (#\w+)", site.split("slate")[0]))
    assert set(named.values()) == {COLOURS["accent"]}
    assert COLOURS["accent-dark"] in site.split("slate")[1]
    assert COLOURS["accent"] in (ROOT / "docs" / "mark.svg").read_text(encoding="utf-8")


#: Where colours are names of the file; white light is none.
NAMED = [
    *(ROOT / "web" / "src").glob("*.css"),
    *(ROOT / "web" / "src").glob("*.ts"),
    *(ROOT / "python" / "moldloft" / "fairing").glob("*.py"),
    *(ROOT / "python" / "moldloft" / "study").glob("*.py"),
]


def test_no_colour_is_written_by_hand() -> None:
    for path in NAMED:
        text = path.read_text(encoding="utf-8")
        found = re.findall(r"[\"' :(]#[0-9a-fA-F]{3,8}\b|0x[0-9a-fA-F]{6}\b", text)
        assert set(found) <= {"0xffffff"}, path.name


def test_styles_of_the_page_name_their_colours() -> None:
    styles = "".join(p.read_text(encoding="utf-8") for p in (ROOT / "web" / "src").glob("*.css"))
    asked = set(re.findall(r"var\(--colour-([\w-]+)\)", styles))
    assert {"accent", "x", "before", "surface"} <= asked <= set(COLOURS)
