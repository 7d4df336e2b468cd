"""Notebooks run headless, and every cell that shows something shows it."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[3] / "examples" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
@pytest.mark.filterwarnings("default")
def test_a_notebook_runs_and_shows(path: Path, tmp_path: Path) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    # Nothing is stored that a run would not give.
    assert not any(cell.get("outputs") for cell in notebook.cells)
    client = nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()
    shown = [
        output["data"].get("text/html", "")
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if "data" in output
    ]
    assert sum(bool(html) for html in shown) >= 6
    pictures = 0
    for html in shown:
        for data in re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", html):
            assert base64.b64decode(data).startswith(b"\x89PNG\r\n")
            pictures += 1
        for drawing in re.findall(r"<svg.*?</svg>", html, re.S):
            assert len(ElementTree.fromstring(drawing)) > 0
            pictures += 1
    assert pictures >= 3
    nbformat.write(notebook, tmp_path / "run.ipynb")
