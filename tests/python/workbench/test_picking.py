"""Picking in the page: rays against triangles, as brute force finds them, and in a moment."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from conftest import ROOT

NODE = shutil.which("node")
TSC = ROOT / "web" / "node_modules" / ".bin" / "tsc"

pytestmark = pytest.mark.skipif(
    NODE is None or not TSC.exists(), reason="`make web` needs Node.js and brings the compiler"
)


def test_the_nearest_triangle_is_found_in_a_million(tmp_path: Path) -> None:
    options = ["--target", "es2022", "--module", "es2022", "--outDir", str(tmp_path)]
    source = ROOT / "web" / "src" / "pick.ts"
    subprocess.run([str(TSC), str(source), "--ignoreConfig", *options], check=True)
    script = (tmp_path / "pick.js").rename(tmp_path / "pick.mjs")
    cases = "20000" if os.environ.get("MOLDLOFT_SOAK") == "1" else "300"
    tried = Path(__file__).with_name("pick_in_node.mjs")
    run = subprocess.run(
        [str(NODE), str(tried), str(script), cases], capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    report = json.loads(run.stdout)
    assert not report["wrong"]
    assert report["met"] > 100 and report["triangles"] > 1_000_000
    # The lowest of thirty: machines are shared.
    assert report["lowest"] < 50, report
