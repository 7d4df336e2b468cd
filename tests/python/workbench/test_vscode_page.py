"""The page beside the text in Visual Studio Code: the text is the editor's, the engine its own."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT
from page_in_browser import ENGINE, PAGE, needs_page

NODE = shutil.which("node")

pytestmark = [
    *needs_page,
    pytest.mark.skipif(NODE is None, reason="no Node.js here"),
    pytest.mark.skipif(
        not ENGINE.exists(),
        reason="the engine for pages is not built: `make engine` needs the target "
        "wasm32-unknown-unknown",
    ),
]

#: The page as the extension makes it, for an editor that is none.
MAKE = """
const Module = require("node:module")
const load = Module._load
const vscode = { Uri: { file: (path) => ({ path }) } }
Module._load = (name, ...rest) => (name === "vscode" ? vscode : load(name, ...rest))
const { html } = require(process.argv[1])
const [, , page, engine, text] = process.argv
const cspSource = "https://webview.test"
const webview = { cspSource, asWebviewUri: ({ path }) => `${cspSource}${path}` }
const document = { fileName: "/models/model.sdl", version: 1, getText: () => text }
process.stdout.write(html(webview, { page, engine }, document))
"""

TYPES = {".js": "text/javascript", ".css": "text/css", ".xz": "application/x-xz"}

TEXT = (
    "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); Line l(A, B);\n"
    "AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 1); Line m(C, D); RuledSurf s(l, m);\n"
)


class Editor:
    """What Visual Studio Code does for a webview, in a few lines."""

    def __init__(self, browser: Any, text: str) -> None:
        self.text, self.version = text, 1
        made = subprocess.run(
            [str(NODE), "-e", MAKE, str(ROOT / "editors" / "vscode" / "src" / "view.js"),
             str(PAGE.parent), str(ENGINE), text],
            capture_output=True, text=True,
        )  # fmt: skip
        assert made.returncode == 0, made.stderr
        self.context = browser.new_context(viewport={"width": 700, "height": 900})
        self.page = self.context.new_page()
        self.faults: list[str] = []
        self.page.on("console", lambda m: self.faults.append(m.text) if m.type == "error" else None)
        self.page.on("pageerror", lambda e: self.faults.append(str(e)))
        self.asked: list[str] = []

        def answer(route: Any) -> None:
            path = route.request.url.removeprefix("https://webview.test")
            self.asked.append(route.request.url)
            if path == "/":
                route.fulfill(body=made.stdout, content_type="text/html")
            else:
                route.fulfill(body=Path(path).read_bytes(), content_type=TYPES[Path(path).suffix])

        self.page.route("**/*", answer)
        self.page.add_init_script(
            "window.heard = []; window.acquireVsCodeApi = () => "
            "({ postMessage: (m) => window.heard.push(JSON.stringify(m)) })"
        )
        self.page.goto("https://webview.test/")

    def heard(self, kind: str) -> list[dict[str, Any]]:
        """What the page has sent of a kind."""
        all_heard = [json.loads(m) for m in self.page.evaluate("() => window.heard")]
        return [m for m in all_heard if m["kind"] == kind]

    def tell(self, **message: Any) -> None:
        """A message to the page."""
        self.page.evaluate("(m) => window.postMessage(m, '*')", message)

    def type(self, text: str) -> None:
        """The text is changed in the editor."""
        self.text, self.version = text, self.version + 1
        self.tell(kind="text", text=text, version=self.version)

    def apply(self, edit: dict[str, Any]) -> None:
        """An edit of the page, as the extension applies it."""
        assert edit["version"] == self.version
        lines = self.text.split("\n")
        at = [0]
        for line in lines:
            at.append(at[-1] + len(line) + 1)
        for change in reversed(edit["changes"]):
            a, b = (at[change[k]["line"]] + change[k]["character"] for k in ("from", "to"))
            self.text = self.text[:a] + change["insert"] + self.text[b:]
        self.type(self.text)

    def hand(self, call: str) -> Any:
        return self.page.evaluate(f"() => window.moldloft.{call}")

    def until(self, true: Callable[[], Any], seconds: float = 60) -> Any:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if found := true():
                return found
            self.page.wait_for_timeout(30)
        raise AssertionError("it did not come to that")


@pytest.fixture
def editor(browser: Any) -> Iterator[Callable[..., Editor]]:
    made: list[Editor] = []

    def make(text: str = TEXT) -> Editor:
        made.append(Editor(browser, text))
        return made[-1]

    yield make
    for each in made:
        each.context.close()


def test_the_text_stays_the_editors(editor: Callable[..., Editor]) -> None:
    e = editor()
    e.until(lambda: e.heard("ready"))
    e.type(TEXT)
    e.page.locator("body[data-engine=ready]").wait_for(timeout=120_000)
    e.until(lambda: any(i["object"] == "s" for i in e.hand("items()")))
    before = e.hand("positions('s')")
    # The page has no text of its own to be typed into.
    assert not e.page.get_by_role("textbox", name="program").is_visible()
    slider = e.page.get_by_role("slider", name="w", exact=True)
    slider.focus()
    e.page.keyboard.press("PageUp")
    (edit,) = e.until(lambda: e.heard("edit"))
    e.apply(edit)
    assert "w = 2.2 in" in e.text
    e.until(lambda: e.hand("positions('s')") != before)
    e.until(lambda: e.hand("model.params")[0]["value"] == 2.2)
    # The editor's undo is a change like any other, and comes back as no edit.
    e.type(TEXT)
    e.until(lambda: e.hand("positions('s')") == before)
    assert len(e.heard("edit")) == 1
    # A broken text keeps the last shape.
    e.type(TEXT + "AbsPoint Q(1, 2")
    e.until(lambda: e.hand("model.faults"))
    assert any(i["object"] == "s" for i in e.hand("items()"))
    e.type(TEXT)
    e.until(lambda: not e.hand("model.faults"))
    # Double clicks go to the declaration, keys to the editor's commands.
    e.page.get_by_role("application", name="model").focus()
    e.page.keyboard.press("Control+s")
    e.page.keyboard.press("Control+z")
    e.until(lambda: e.heard("save") and e.heard("undo"))
    assert not e.faults
    assert all(u.startswith("https://webview.test/") for u in e.asked)


def test_files_beside_the_model_are_read_by_the_editor(editor: Callable[..., Editor]) -> None:
    e = editor('load "part.sdl"\nAbsPoint P(1, 0, 0);\n')
    e.until(lambda: e.heard("ready"))
    e.type(e.text)
    (wanted,) = e.until(lambda: e.heard("read"))
    ((path, asker),) = wanted["files"]
    assert path == "part.sdl"
    data = base64.b64encode(b"AbsPoint N(5, 5, 5);\n").decode()
    e.tell(kind="files", files=[{"path": path, "from": asker, "name": "part.sdl", "data": data}])
    e.until(lambda: any(i["object"] == "N" for i in e.hand("items()")))
    e.until(lambda: not e.hand("model.faults"))
    assert not e.faults
