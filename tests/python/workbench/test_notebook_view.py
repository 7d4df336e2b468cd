"""The workbench's page in a notebook's cell, with and without a model that follows it."""

from __future__ import annotations

import base64
import re
from typing import Any

import pytest

import moldloft
from moldloft import notebook
from moldloft.errors import Error
from page_in_browser import ENGINE, needs_page

pytestmark = [
    *needs_page,
    pytest.mark.skipif(
        not ENGINE.exists(),
        reason="the engine for pages is not built: `make engine` needs the target "
        "wasm32-unknown-unknown",
    ),
]

TEXT = (
    "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); AbsPoint C(0, 1, 0);\n"
    "AbsPoint D(2, 1, 1); Line l(A, B); Line m(C, D); RuledSurf s(l, m);\n"
)

#: What a notebook does for a widget, in a few lines.
HOST = """async ([script, state]) => {
  const handlers = {}
  const model = {
    get: (name) => state[name],
    set: (name, value) => { state[name] = value },
    save_changes: () => window.saved(state.text),
    on: (name, run) => { (handlers[name] ??= []).push(run) },
    off: (name, run) => { handlers[name] = handlers[name].filter((r) => r !== run) },
    send: async (message) => {
      const page = await window.asked(message)
      const bytes = Uint8Array.from(atob(page), (c) => c.charCodeAt(0))
      for (const run of handlers['msg:custom']) run({ kind: 'page' }, [new DataView(bytes.buffer)])
    },
  }
  window.given = (text) => { state.text = text; for (const run of handlers['change:text']) run() }
  const source = URL.createObjectURL(new Blob([script], { type: 'text/javascript' }))
  const widget = (await import(source)).default
  window.gone = widget.render({ model, el: document.body })
}"""


def opened(browser: Any) -> tuple[Any, list[str]]:
    page = browser.new_page()
    faults: list[str] = []
    page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda e: faults.append(str(e)))
    return page, faults


def cell(page: Any) -> Any:
    """The page within the frame, when its engine is there."""
    frame = page.wait_for_selector("iframe").content_frame()
    frame.wait_for_selector("body[data-engine=ready]", timeout=60_000)
    return frame


def until(page: Any, true: Any, seconds: float = 20) -> None:
    for _ in range(int(seconds / 0.05)):
        if true():
            return
        page.wait_for_timeout(50)
    raise AssertionError("it did not come to that")


def test_a_page_in_a_cell_is_alive(browser: Any) -> None:
    m = moldloft.loads(TEXT)
    m["w"] = 2.5
    shown = m.view(follow=False, height=500)
    assert isinstance(shown, notebook.ModelPage)
    page, faults = opened(browser)
    page.set_content(shown._repr_html_())
    frame = cell(page)
    # The value that the parameter has is in the text.
    assert "w = 2.5 in" in frame.evaluate("() => window.moldloft.text()")
    frame.get_by_role("slider", name="w", exact=True).focus()
    page.keyboard.press("PageUp")
    until(page, lambda: "w = 2.7 in" in frame.evaluate("() => window.moldloft.text()"))
    assert m["w"] == 2.5 and not faults
    page.close()


def test_a_model_follows_its_page(browser: Any) -> None:
    pytest.importorskip("anywidget")
    m = moldloft.loads(TEXT)
    m["w"] = 2.5
    view = m.view()
    assert view.height == 600 and "w = 2.5 in" in view.text
    page, faults = opened(browser)
    page.expose_function("asked", lambda message: base64.b64encode(view._page).decode())
    page.expose_function("saved", lambda text: setattr(view, "text", text))
    state = {"title": view.title, "height": view.height, "text": view.text}
    page.evaluate(HOST, [view._esm if isinstance(view._esm, str) else str(view._esm), state])
    frame = cell(page)
    frame.get_by_role("slider", name="w", exact=True).focus()
    page.keyboard.press("PageDown")
    until(page, lambda: m["w"] == 2.3)
    assert "w = 2.3 in" in m.text and m["B"].x == 2.3
    # What is typed counts, too, broken or whole.
    frame.get_by_role("textbox", name="program").focus()
    page.keyboard.press("Control+End")
    page.keyboard.insert_text("AbsPoint E(1, 2, 3);\n")
    until(page, lambda: "E" in m.objects)
    page.keyboard.insert_text("AbsPoint F(1")
    until(page, lambda: m.has_errors)
    for _ in range(12):
        page.keyboard.press("Backspace")
    until(page, lambda: not m.has_errors)
    # The other way: what Python does is shown, and can be taken back there.
    m["w"] = 1.25
    view.refresh()
    page.evaluate("(text) => window.given(text)", view.text)
    until(page, lambda: "w = 1.25 in" in frame.evaluate("() => window.moldloft.text()"))
    until(page, lambda: frame.evaluate("() => window.moldloft.model.params[0].value") == 1.25)
    assert re.search(r"w = 1\.25 in", m.text) or m["w"] == 1.25
    page.evaluate("() => window.gone()")
    assert not faults
    page.close()


def test_what_a_cell_cannot_show_is_named() -> None:
    m = moldloft.loads(
        "param float a = 4 in [1, 9]; AbsPoint P(0, 0, rise(a));", functions={"rise": lambda x: x}
    )
    with pytest.raises(Error, match="the model calls rise"):
        m.view()
