"""A hand at the fairing desk: pointer and keys of a browser, by what is on the screen alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from page_in_browser import Bench

#: Of what the desk knows, what many acts are compared by: all of it takes longer than an act.
BRIEF = """() => {
  const { log, facts } = window.moldloft.desk.look()
  return { log, facts: facts && { list: facts.list, detail: { moved: facts.detail.moved } } }
}"""


class DeskHand(Bench):
    """A workbench whose fairing desk is used."""

    #: True if only a part of what the desk knows is looked at.
    brief = False

    def __init__(self, path: Path, browser: Any, sharpness: float = 1) -> None:
        super().__init__(path, browser, sharpness)
        self.page.get_by_role("tab", name="Fairing desk").click()
        self.page.locator(".desk:not([hidden])").wait_for()

    def ready(self) -> None:
        """An empty model has nothing to wait for."""

    def look(self) -> Any:
        return self.page.evaluate(BRIEF) if self.brief else self.hand("desk.look()")

    def settle(self) -> Any:
        """All acts are done, and the desk shows them."""
        self.hand("desk.settled().then(() => window.moldloft.settled())")
        return self.look()

    def table(self, name: str, text: str) -> Any:
        """Choose a table in the page's own field for files."""
        field = self.page.get_by_label("a table of offsets")
        file = {"name": name, "mimeType": "text/csv", "buffer": text.encode()}
        field.set_input_files([file])
        self.until(lambda: self.look()["session"])
        return self.settle()

    def at(self, point: int) -> tuple[float, float]:
        """A point, from 1, on the screen."""
        x, y = self.hand(f"desk.look().places[{point - 1}]")
        return float(x), float(y)

    def click(self, point: int, *, shift: bool = False) -> Any:
        if shift:
            self.page.keyboard.down("Shift")
        self.page.mouse.click(*self.at(point))
        if shift:
            self.page.keyboard.up("Shift")
        return self.settle()

    def drag(self, point: int, dx: float, dy: float) -> Any:
        x, y = self.at(point)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        for share in (0.3, 0.6, 1.0):
            self.page.mouse.move(x + share * dx, y + share * dy)
        self.page.mouse.up()
        return self.settle()

    def tool(self, words: str) -> None:
        self.page.get_by_role("toolbar", name="fairing").get_by_role("button", name=words).click()

    def key(self, *keys: str) -> Any:
        self.page.locator("svg.desk-shape").focus()
        for key in keys:
            self.page.keyboard.press(key)
        return self.settle()

    def slide(self, share: float) -> Any:
        """Drag the tolerance to a share of the slider's way, with what comes while it moves."""
        box = self.page.get_by_label("tolerance", exact=True).bounding_box()
        assert box is not None
        y = box["y"] + box["height"] / 2
        self.page.mouse.move(box["x"] + box["width"] / 2, y)
        self.page.mouse.down()
        to = box["x"] + 8 + share * (box["width"] - 16)
        for k in range(1, 6):
            self.page.mouse.move(
                box["x"] + box["width"] / 2 + k / 5 * (to - box["x"] - box["width"] / 2), y
            )
            self.page.wait_for_timeout(40)
        self.page.mouse.up()
        return self.settle()
