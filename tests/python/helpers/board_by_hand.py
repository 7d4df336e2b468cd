"""A hand at the drawing board: pointer and keys of a browser, by places of the page alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from page_in_browser import Bench


class BoardHand(Bench):
    """A workbench whose drawing board is drawn on."""

    def __init__(self, path: Path, browser: Any, sharpness: float = 1) -> None:
        self.events = 0
        super().__init__(path, browser, sharpness)
        if path.read_text(encoding="utf-8").strip():
            # With an empty file the page opens there.
            self.page.get_by_role("tab", name="Drawing board").click()
        self.page.locator(".board:not([hidden])").wait_for()

    def reload(self) -> None:
        """The page is loaded again, and its board shown."""
        self.page.reload()
        self.page.locator("body[data-state=alive]").wait_for(timeout=30_000)
        self.page.get_by_role("tab", name="Drawing board").click()
        self.page.locator(".board:not([hidden])").wait_for()
        self.settle()

    def ready(self) -> None:
        """An empty text has nothing to wait for."""

    def look(self) -> Any:
        return self.hand("board.look()")

    def settle(self) -> Any:
        """All gestures are in the text, and the board shows it."""
        self.settled()
        return self.look()

    def settled(self, then: str = "null") -> Any:
        """As `settle`, and a part of what the board knows."""
        # A step of the history that was taken elsewhere in the page comes last.
        waits = "await m.board.settled(); await m.settled(); await m.board.settled()"
        return self.page.evaluate(
            f"async () => {{ const m = window.moldloft; {waits}; return {then} }}"
        )

    def begin(self, words: str) -> None:
        """Choose what an empty text begins with."""
        self.page.get_by_role("button", name=words).click()
        self.until(lambda: self.look()["drawn"]["object"])
        self.events += 1

    def at(self, u: float, v: float) -> tuple[float, float]:
        """A place of the drawing on the screen."""
        x, y = self.page.evaluate(f"() => window.moldloft.board.onScreen([{u}, {v}])")
        return float(x), float(y)

    def move(self, u: float, v: float) -> None:
        x, y = self.at(u, v)
        self.page.mouse.move(x - 3, y + 2)
        self.page.mouse.move(x, y)

    def click(self, u: float, v: float) -> None:
        """One corner of a chain."""
        self.move(u, v)
        self.page.mouse.down()
        self.page.mouse.up()
        self.events += 1
        self.hand("board.settled()")

    def chain(self, *places: tuple[float, float]) -> None:
        for place in places:
            self.click(*place)

    def stroke(self, a: tuple[float, float], b: tuple[float, float]) -> None:
        """A line from where the button goes down to where it comes up."""
        self.move(*a)
        self.page.mouse.down()
        middle = self.at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        self.page.mouse.move(*middle)
        self.page.mouse.move(*self.at(*b))
        self.page.mouse.up()
        self.events += 1
        self.hand("board.settled()")

    def trace(self, places: list[tuple[float, float]]) -> None:
        """A stroke through places on the page."""
        self.move(*places[0])
        (x, y), (right, _), (_, up) = self.at(0, 0), self.at(1, 0), self.at(0, 1)
        self.page.mouse.down()
        for u, v in places[1:]:
            self.page.mouse.move(x + u * (right - x), y + v * (up - y))
        self.page.mouse.up()
        self.events += 2 + len(places)
        self.settle()

    def key(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)
            self.events += 1
        self.hand("board.settled()")

    def type_of(self, p: int, q: int) -> str:
        lines = self.look()["drawn"]["lines"]
        return str(next(ln[3] for ln in lines if {ln[1], ln[2]} == {p, q}))

    def dimension_all(self, exact: dict[int, tuple[float, float, float]]) -> int:
        """Tab to each missing dimension and type what it is; how many there were."""
        given = 0
        self.page.locator("svg.paper").focus()
        self.key("Tab")
        while (mark := self.look()["open"]) is not None:
            k = "XYZ".index(mark["axis"])
            value = exact[mark["q"]][k] - exact[mark["p"]][k]
            self.page.keyboard.type(f"{value:.12g}")
            self.key("Enter")
            given += 1
            assert given < 60
        return given
