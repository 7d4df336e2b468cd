"""The workbench's page in JupyterLab itself, with its kernel: by what a person there presses."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from page_in_browser import ENGINE, needs_page

pytest.importorskip("jupyterlab")
pytest.importorskip("anywidget")

pytestmark = [
    *needs_page,
    pytest.mark.skipif(not ENGINE.exists(), reason="the engine for pages is not built"),
]

MODEL = (
    "param float w = 2 in [1, 3];\\nAbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); AbsPoint C(0, 1, 0);"
    "\\nAbsPoint D(2, 1, 1); Line l(A, B); Line m(C, D); RuledSurf s(l, m);\\n"
)
CELLS = [
    f'import moldloft\nm = moldloft.loads("{MODEL}")\nv = m.view()\nv',
    'print("width", m["w"])',
    'm["w"] = 1.25\nv.refresh()',
]


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[str]:
    cells = [
        {"cell_type": "code", "id": f"c{k}", "metadata": {}, "outputs": [], "source": source,
         "execution_count": None}
        for k, source in enumerate(CELLS)
    ]  # fmt: skip
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    book = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    (tmp_path / "hull.ipynb").write_text(json.dumps(book), encoding="utf-8")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    own = {**os.environ, "HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    options = ["--no-browser", "--allow-root", f"--port={port}", "--ServerApp.port_retries=0"]
    options += ["--IdentityProvider.token=", f"--ServerApp.root_dir={tmp_path}"]
    command = [sys.executable, "-m", "jupyterlab", *options]
    with subprocess.Popen(
        command, env=own, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as server:
        try:
            address = f"http://127.0.0.1:{port}"
            for _ in range(600):
                try:
                    urllib.request.urlopen(f"{address}/api", timeout=1).close()
                    break
                except OSError:
                    time.sleep(0.1)
            yield f"{address}/lab/tree/hull.ipynb"
        finally:
            server.terminate()


def test_a_model_in_jupyterlab_is_alive(lab: str, browser: Any) -> None:
    page = browser.new_page(viewport={"width": 1300, "height": 1000})
    page.goto(lab)
    cells = page.locator(".jp-NotebookPanel .jp-Cell.jp-CodeCell")
    cells.nth(0).wait_for(timeout=60_000)
    page.locator(".jp-NotebookPanel [data-status=idle]").first.wait_for(
        state="attached", timeout=60_000
    )

    def run(k: int) -> None:
        cells.nth(k).locator(".cm-content").click()
        page.keyboard.press("Control+Enter")

    shown = cells.nth(0).locator("iframe")
    # A cell that is run before the kernel is there is forgotten.
    for _ in range(10):
        run(0)
        page.wait_for_timeout(3000)
        if shown.count():
            break
    handle = shown.element_handle(timeout=20_000)
    frame = handle.content_frame()
    frame.wait_for_selector("body[data-engine=ready]", timeout=60_000)
    frame.get_by_role("slider", name="w", exact=True).focus()
    page.keyboard.press("PageUp")
    frame.wait_for_function("() => window.moldloft.text().includes('w = 2.2 in')")
    # The kernel's model has the page's value, and the page takes the kernel's.
    for _ in range(100):
        run(1)
        page.wait_for_timeout(200)
        said = cells.nth(1).locator(".jp-OutputArea-output").all_inner_texts()
        if any("width 2.2" in text for text in said):
            break
    else:
        raise AssertionError(said)
    run(2)
    frame.wait_for_function("() => window.moldloft.text().includes('w = 1.25 in')", timeout=20_000)
    frame.wait_for_function("() => window.moldloft.model.params[0].value === 1.25")
    page.close()
