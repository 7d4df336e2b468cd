"""What the tests share."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
SAILBOAT = ROOT / "examples" / "sailboat"

Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A panic fails every test, also where it was caught and reported as a fault of an object."""
    report = yield
    if report.passed and "panicked at" in report.capstderr:
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid} panicked:\n{report.capstderr[-4000:]}"
    return report


@pytest.fixture
def cli(tmp_path: Path) -> Run:
    """Runs the command in an empty folder; a traceback or a crash is always a failure."""

    def run(*arguments: object, status: int = 0, **options: object):
        done = subprocess.run(
            [sys.executable, "-m", "moldloft", *map(str, arguments)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            encoding="utf-8",
            timeout=120,
            **options,
        )
        assert "Traceback" not in done.stderr, done.stderr
        assert "panicked" not in done.stderr, done.stderr
        assert "internal-error" not in done.stdout + done.stderr, done.stdout + done.stderr
        assert done.returncode == status, (done.returncode, done.stdout, done.stderr)
        return done

    return run


@pytest.fixture
def model_file(tmp_path: Path) -> Callable[..., Path]:
    """Makes a file of that text in the empty folder."""

    def make(text: str | bytes, name: str = "model.sdl") -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return make


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A browser without a display."""
    from playwright.sync_api import sync_playwright

    from page_in_browser import CHROMIUM, FLAGS

    with sync_playwright() as p:
        made = p.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield made
        made.close()


@pytest.fixture
def bench(tmp_path: Path, browser: Any) -> Iterator[Callable[..., Any]]:
    """Makes workbenches: a server with a model, and its page."""
    from page_in_browser import HULL, Bench

    made: list[Bench] = []

    def make(text: str = HULL, name: str = "hull.sdl", sharpness: float = 1) -> Bench:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        made.append(Bench(path, browser, sharpness))
        return made[-1]

    yield make
    for each in made:
        each.close()
