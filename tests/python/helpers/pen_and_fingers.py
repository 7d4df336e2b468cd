"""Contacts of a pen and of fingers with a page, as a tablet reports them."""

from __future__ import annotations

from typing import Any

Place = tuple[float, float]


class Tablet:
    """Pen and fingers on a page of a browser; all places are in pixels of the window."""

    def __init__(self, page: Any) -> None:
        self._session = page.context.new_cdp_session(page)
        self._fingers: dict[int, Place] = {}

    def pen(self, kind: str, at: Place) -> None:
        """A pen is ``pressed``, ``moved`` (in contact), ``hovers`` or ``released``."""
        event = {"pressed": "mousePressed", "released": "mouseReleased"}.get(kind, "mouseMoved")
        contact = kind != "hovers"
        self._session.send(
            "Input.dispatchMouseEvent",
            {
                "type": event, "x": at[0], "y": at[1], "pointerType": "pen",
                "button": "left" if contact else "none",
                "buttons": int(kind in ("pressed", "moved")), "clickCount": int(contact),
            },
        )  # fmt: skip

    def pen_stroke(self, a: Place, b: Place) -> None:
        self.pen("pressed", a)
        for k in (1, 2, 3):
            self.pen("moved", (a[0] + (b[0] - a[0]) * k / 3, a[1] + (b[1] - a[1]) * k / 3))
        self.pen("released", b)

    def finger(self, which: int, at: Place, wide: float = 10) -> None:
        """A finger comes down, or is now there."""
        kind = "touchMove" if which in self._fingers else "touchStart"
        self._fingers[which] = at
        self._touch(kind, wide)

    def lift(self, which: int) -> None:
        del self._fingers[which]
        self._touch("touchEnd", 10)

    def _touch(self, kind: str, wide: float) -> None:
        points = [
            {"x": x, "y": y, "id": k, "radiusX": wide, "radiusY": wide}
            for k, (x, y) in self._fingers.items()
        ]
        self._session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
