"""Files beside the model: opened in tabs, edited with the model live, saved, in one history."""

from __future__ import annotations

import asyncio
import json
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT
from moldloft.workbench.text import change_set
from page_in_browser import Bench, children, in_browser
from test_workbench import Page, workbench

MAIN = 'load "part.sdl"\ncurve c = read_points("z.csv");\nAbsPoint E(c[2]);\nprint B.x, E.x;\n'
PART = "float width = 2;\nAbsPoint A(0, 0, 0);\nAbsPoint B(width, 0, 0);\nLine l(A, B);\n"
TABLE = "1 2 3\n4 5 6\n"
UNSAVED = f"# unsaved\n{PART}".replace("2;", "6;")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A model with a file of objects and a table."""
    for name, text in (("model.sdl", MAIN), ("part.sdl", PART), ("z.csv", TABLE)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def draft(path: Path) -> str:
    return str(json.loads(path.with_name(f".{path.name}.draft").read_text())["text"])


def test_a_file_counts_before_it_is_saved(folder: Path) -> None:
    part = folder / "part.sdl"
    name = str(part)

    async def play(hub: Any) -> None:
        one, two = Page(hub), Page(hub)
        assert (await one.ask("open_file", file=name))["kind"] == "refused"
        for page in (one, two):
            await page.ask("open")
        assert [Path(f).name for f in one.heads[-1]["reads"]] == ["part.sdl", "z.csv"]
        for wrong in (str(folder / "other.sdl"), "/etc/hostname", "", 3, None):
            assert (await one.ask("open_file", file=wrong))["kind"] == "refused", wrong
        # A file that a page has not opened is none that it can change or save.
        push = {"file": name, "version": 0, "updates": []}
        assert (await two.ask("push", **push))["kind"] == "refused"
        opened = await one.ask("open_file", file=name)
        assert (opened["text"], opened["dirty"], opened["version"]) == (PART, False, 0)
        update = {"changes": change_set(PART, PART.replace("2;", "5;")), "clientID": "page"}
        pushed = await one.ask("push", file=name, version=0, updates=[update])
        assert pushed["ok"] and draft(part) == PART.replace("2;", "5;")
        found = await one.ask("evaluate", expressions=["B.x"])
        assert found["values"][0]["value"] == 5
        # The other page has the new scene, and none of the text.
        await two.until(lambda: two.heads[-1].get("rev") == one.heads[-1]["rev"])
        assert not any(m.get("file") == name and m["kind"] == "updates" for m in two.said)
        # Rooms read files, so they wait for saving.
        refused = await one.ask("export", format="stl", stem="a")
        assert "save part.sdl first" in refused["error"]
        # Closed by its page it stays, for it has changes.
        await one.ask("close_file", file=name)
        again = await two.ask("open_file", file=name)
        assert again["text"] == PART.replace("2;", "5;") and again["dirty"]
        assert (await two.ask("save", file=name))["kind"] == "saved"
        assert part.read_text() == PART.replace("2;", "5;")
        # Another program changes it: the text follows, and the model with it.
        part.write_text(PART.replace("2;", "7;"))
        await two.until(lambda: any(m["kind"] == "updates" for m in two.said))
        found = await two.ask("evaluate", expressions=["B.x"])
        assert found["values"][0]["value"] == 7
        await two.ask("close_file", file=name)
        assert not hub.others
        # One that nobody has open is followed, too.
        (folder / "z.csv").write_text(TABLE.replace("4", "9"))
        for _ in range(100):
            found = await one.ask("evaluate", expressions=["E.x"])
            if found["values"][0]["value"] == 9:
                break
            await asyncio.sleep(0.05)
        assert found["values"][0]["value"] == 9

    workbench(folder / "model.sdl", play)


def test_rooms_take_open_files_alone(folder: Path) -> None:
    async def play(hub: Any) -> None:
        page = Page(hub)
        await page.ask("open")
        for wrong in (str(folder / "part.sdl"), "nobody.skt", ["part.sdl"], 3, {"a": 1}):
            refused = await page.ask("board_open", file=wrong)
            assert refused["kind"] == "refused" and "is not open here" in refused["error"]

    workbench(folder / "model.sdl", play)


def test_drafts_of_files_are_found_by_the_next_server(folder: Path) -> None:
    part = folder / "part.sdl"
    name = str(part)

    async def change(hub: Any) -> None:
        page = Page(hub)
        await page.ask("open")
        await page.ask("open_file", file=name)
        update = {"changes": change_set(PART, UNSAVED), "clientID": "page"}
        assert (await page.ask("push", file=name, version=0, updates=[update]))["ok"]
        await page.ask("close_file", file=name)
        # The engine is lost: the next one has the text that is not saved.
        os.kill(hub.engine.pid, signal.SIGKILL)
        while "values" not in (found := await page.ask("evaluate", expressions=["B.x"])):
            assert found["kind"] == "refused", found
        assert found["values"][0]["value"] == 6

    workbench(folder / "model.sdl", change)
    assert part.read_text() == PART

    async def find(hub: Any) -> None:
        page = Page(hub)
        await page.ask("open")
        await page.until(lambda: any(m["kind"] == "unsaved" for m in page.said))
        opened = await page.ask("open_file", file=name)
        assert opened["text"] == UNSAVED and opened["recovered"] and opened["dirty"]
        found = await page.ask("evaluate", expressions=["B.x"])
        assert found["values"][0]["value"] == 6
        assert (await page.ask("revert", file=name))["text"] == PART

    workbench(folder / "model.sdl", find)


@pytest.fixture
def beside(folder: Path, browser: Any) -> Iterator[Callable[[], Bench]]:
    made: list[Bench] = []

    def make() -> Bench:
        made.append(Bench(folder / "model.sdl", browser, sharpness=0.25))
        return made[-1]

    yield make
    for each in made:
        each.close()


def printed(b: Bench) -> list[str]:
    """What the model prints: the x of a point of the part, and of one of the table."""
    return list(b.hand("model.printed"))


@in_browser
def test_files_are_tabs_with_one_history(beside: Callable[[], Bench], folder: Path) -> None:
    b = beside()
    part, table = str(folder / "part.sdl"), str(folder / "z.csv")
    files = b.page.get_by_role("tablist", name="files of the model")
    assert files.get_by_role("tab").all_inner_texts() == ["model.sdl", "part.sdl", "z.csv"]

    def typed(tab: str, old: str, new: str) -> None:
        """Types in the place of some words of a file."""
        files.get_by_role("tab", name=tab).click()
        name = "program" if tab == "model.sdl" else f"text of {tab}"
        text = b.page.get_by_role("textbox", name=name)
        text.wait_for()
        text.focus()
        b.page.keyboard.press("Control+Home")
        before = b.page.evaluate("(f) => window.moldloft.text(f)", text_of[tab])
        for _ in range(before.index(old)):
            b.page.keyboard.press("ArrowRight")
        for _ in old:
            b.page.keyboard.press("Shift+ArrowRight")
        b.page.keyboard.type(new)
        b.hand("settled()")

    text_of = {"model.sdl": "", "part.sdl": part, "z.csv": table}

    def texts() -> list[str]:
        return [
            b.page.evaluate("(f) => window.moldloft.text(f)", f) or "" for f in ("", part, table)
        ]

    typed("part.sdl", "2;", "5;")
    b.until(lambda: printed(b) == ["5 4"])
    typed("z.csv", "4", "9")
    b.until(lambda: printed(b) == ["5 9"])
    typed("model.sdl", "E.x", "E.y")
    b.until(lambda: printed(b) == ["5 5"])
    b.page.keyboard.press("Backspace")
    b.page.keyboard.type("x")
    typed("part.sdl", "0, 0, 0", "0, 1, 0")
    assert files.get_by_role("tab").all_inner_texts() == ["model.sdl", "part.sdl •", "z.csv •"]
    end, steps = texts(), b.hand("steps().done")
    # One list of steps over all files, each back in its own, from any focus.
    seen = [end]
    b.page.get_by_role("application", name="model").focus()
    while b.hand("steps().done"):
        b.page.keyboard.press("Control+z")
        b.hand("settled()")
        seen.append(texts())
    assert seen[-1] == [MAIN, PART, TABLE]
    b.until(lambda: printed(b) == ["2 4"])
    for text in seen[-2::-1]:
        b.page.keyboard.press("Control+Shift+Z")
        b.hand("settled()")
        assert texts() == text
    assert b.hand("steps().done") == steps
    # An error in a file has its place there, and a click on it shows it.
    typed("part.sdl", "width, 0", "wide, 0")
    files.get_by_role("tab", name="model.sdl").click()
    b.page.locator(".message.error .text").first.click()
    b.page.get_by_role("textbox", name="text of part.sdl").wait_for()
    b.page.locator(".cm-lintRange-error:visible").first.wait_for()
    b.page.keyboard.press("Control+z")
    b.hand("settled()")
    # The engine ends, then the server: what was typed is kept and counts.
    for child in children(b.process.pid):
        os.kill(child, signal.SIGKILL)
    typed("z.csv", "9", "8")
    b.until(lambda: printed(b) == ["5 8"], 30)
    b.kill()
    b.page.get_by_text("The server does not answer").wait_for()
    b.page.keyboard.type("# alone")
    wanted = texts()
    b.serve()
    b.connected()
    b.until(
        lambda: draft(folder / "z.csv") == wanted[2] and draft(folder / "part.sdl") == wanted[1]
    )
    assert texts() == wanted
    b.page.keyboard.press("Control+z")
    b.hand("settled()")
    # All is saved by one press.
    b.page.keyboard.press("Control+s")
    b.until(lambda: (folder / "z.csv").read_text() == texts()[2])
    assert (folder / "part.sdl").read_text() == texts()[1]
    assert (folder / "model.sdl").read_text() == texts()[0]
    b.until(
        lambda: files.get_by_role("tab").all_inner_texts() == ["model.sdl", "part.sdl", "z.csv"]
    )
    # A page that is loaded again has them open.
    b.page.reload()
    b.page.locator("body[data-state=alive]").wait_for()
    b.until(lambda: b.page.evaluate("(f) => window.moldloft.text(f)", table))


MAST = """load "dam.skt";
param float lift = 8 in [0, 20];
AbsPoint mast(dam.CREST, 0, 100 + lift);
Line stay(dam.p4, mast);
"""


@in_browser
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_a_drag_writes_into_the_file_that_states_the_number(
    beside: Callable[[], Bench], folder: Path, ends: str
) -> None:
    sketch, model = folder / "dam.skt", folder / "model.sdl"
    before = (ROOT / "examples/sketch/dam.skt").read_text(encoding="utf-8")
    before = before.replace("! A gravity", "! \N{GREEK SMALL LETTER RHO} \U0001d70c A gravity")
    sketch.write_text(before, encoding="utf-8", newline=ends)
    model.write_text(MAST, encoding="utf-8")
    b = beside()

    def texts() -> list[str]:
        return [b.page.evaluate("(f) => window.moldloft.text(f)", f) for f in ("", str(sketch))]

    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("2")
    b.page.wait_for_timeout(200)
    x, y = b.hand("project('mast')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    for k in range(1, 5):
        b.page.mouse.move(x + 3 * k, y - 2 * k)
    b.hand("settled()")
    b.page.mouse.up()
    b.hand("settled()")
    crest, lift = b.param("dam.CREST"), b.param("lift")
    assert crest != 16 and lift != 8
    after = [MAST.replace("8 in", f"{lift:g} in"), before.replace("16 IN", f"{crest:g} IN")]
    assert texts() == after
    # Two texts, one step.
    assert b.hand("steps().done") == ["Drag mast"]
    b.page.keyboard.press("Control+z")
    b.hand("settled()")
    assert texts() == [MAST, before] and not b.hand("steps().done")
    b.until(lambda: (b.param("dam.CREST"), b.param("lift")) == (16, 8))
    b.page.keyboard.press("Control+Shift+Z")
    b.hand("settled()")
    assert texts() == after
    b.until(lambda: (b.param("dam.CREST"), b.param("lift")) == (crest, lift))
    b.page.keyboard.press("Control+s")
    saved = after[1].replace("\n", ends).encode()
    b.until(lambda: (model.read_text(), sketch.read_bytes()) == (after[0], saved))
