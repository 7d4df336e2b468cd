"""What the tests of the workbench's page share: a server with its page, a page in a file."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT, SAILBOAT

CHROMIUM = next(
    filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None
)
PAGE = ROOT / "python" / "moldloft" / "workbench" / "page" / "index.html"
ENGINE = PAGE.parents[1] / "wasm" / "engine.wasm.xz"

needs_page = [
    pytest.mark.skipif(
        find_spec("playwright") is None, reason="the package playwright is not installed"
    ),
    pytest.mark.skipif(
        CHROMIUM is None, reason="no chromium here: `make setup` installs it as root on Debian"
    ),
    pytest.mark.skipif(not PAGE.exists(), reason="the page is not built: `make web` needs Node.js"),
]


def in_browser(test: Callable[..., None]) -> Callable[..., None]:
    """Marks one test of a file whose others need no page."""
    for mark in needs_page:
        test = mark(test)
    return test


FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]

HULL = (SAILBOAT / "hull.sdl").read_text(encoding="utf-8")
PLATE = (
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0);\n"
    "Line l(A, B); Line m(C, D); RuledSurf s(l, m);\nAbsPoint P(0.5, 0.5, 1);\n"
)


def own_state(path: Path) -> dict[str, str]:
    """The environment of a server that keeps what it keeps beside the model."""
    return {**os.environ, "XDG_STATE_HOME": str(path.parent / "state")}


class Bench:
    """A server and its page.

    Where nobody looks at the picture, a `sharpness` below 1 saves most of the work of drawing it.
    """

    def __init__(self, path: Path, browser: Any, sharpness: float = 1) -> None:
        self.path = path
        self.serve()
        size = {"width": 1400, "height": 860}
        self.context = browser.new_context(viewport=size, device_scale_factor=sharpness)
        self.page = self.context.new_page()
        self.faults: list[str] = []
        self.page.on("console", lambda m: self.faults.append(m.text) if m.type == "error" else None)
        self.page.on("pageerror", lambda e: self.faults.append(str(e)))
        self.requests: list[str] = []
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.page.goto(self.url)
        self.page.locator("body[data-state=alive]").wait_for(timeout=30_000)
        if path.read_text(encoding="utf-8").strip():
            self.ready()

    def serve(self) -> None:
        """Starts the server."""
        command = [sys.executable, "-m", "moldloft", "view", str(self.path), "--no-browser"]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(
            command, stdout=pipe, stderr=pipe, text=True, env=own_state(self.path)
        )
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()
        assert self.url, self.process.stderr and self.process.stderr.read()

    def kill(self) -> None:
        """Ends the server at once."""
        self.process.kill()
        self.process.wait(60)
        self._release()

    def connected(self) -> None:
        """Until the page is connected and all that it has is accepted."""
        saved = self.page.locator(".saved")
        self.until(lambda: saved.get_attribute("data-state") != "off", 60)
        self.page.evaluate("() => window.moldloft.settled()")

    def ready(self) -> None:
        """Until there is something to see."""
        self.until(lambda: self.hand("items()"))

    def hand(self, call: str) -> Any:
        return self.page.evaluate(f"() => window.moldloft.{call}")

    def until(self, true: Callable[[], Any], seconds: float = 60) -> Any:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if found := true():
                return found
            self.page.wait_for_timeout(30)
        raise AssertionError("it did not come to that")

    def text(self) -> str:
        found: str = self.hand("text()")
        return found

    def param(self, name: str) -> float:
        all_params = self.page.evaluate("() => window.moldloft.model.params")
        return float(next(p["value"] for p in all_params if p["name"] == name))

    def close(self) -> None:
        self.context.close()
        self.process.terminate()
        self.process.wait(60)
        self._release()

    def _release(self) -> None:
        for pipe in (self.process.stdout, self.process.stderr):
            if pipe is not None:
                pipe.close()


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    listed = subprocess.run(
        ["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True
    ).stdout
    return [int(word) for word in listed.split()]


class File:
    """A page of `export --html`, opened from the disk."""

    def __init__(self, path: Path, browser: Any) -> None:
        self.context = browser.new_context(viewport={"width": 1400, "height": 860})
        self.page = self.context.new_page()
        self.faults: list[str] = []
        self.page.on("console", lambda m: self.faults.append(m.text) if m.type == "error" else None)
        self.page.on("pageerror", lambda e: self.faults.append(str(e)))
        self.requests: list[str] = []
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.path = path
        self.open()

    def open(self) -> None:
        self.page.goto(f"{self.path.as_uri()}?norender")
        self.page.locator("body[data-state=alive]").wait_for(timeout=60_000)

    def hand(self, call: str) -> Any:
        return self.page.evaluate(f"() => window.moldloft.{call}")

    until = Bench.until

    def running(self) -> None:
        self.page.locator("body[data-engine=ready]").wait_for(timeout=120_000)

    def close(self) -> None:
        assert not self.faults
        assert all(u.startswith(("file:", "blob:", "data:")) for u in self.requests)
        self.context.close()
