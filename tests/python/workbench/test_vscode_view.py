"""The extension for Visual Studio Code: the page beside the text, with an editor that is none."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from conftest import ROOT

NODE = shutil.which("node")


@pytest.mark.skipif(NODE is None, reason="no Node.js here")
def test_the_page_beside_the_text() -> None:
    script = ROOT / "editors" / "vscode" / "tests" / "view.test.mjs"
    run = subprocess.run([str(NODE), "--test", str(script)], capture_output=True, text=True)
    assert run.returncode == 0, run.stdout
    assert "# pass 4" in run.stdout or "pass 4" in run.stdout, run.stdout
