"""An addition costs its module and few lines: the patches of `tests/changes` apply and are small.

`make changes` builds them and checks each by all its faces, and the same for changed arguments of
rows (`tools/renames.py`).
"""

from __future__ import annotations

import runpy
import subprocess
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]
TOOL = runpy.run_path(str(ROOT / "tools" / "changes.py"))
CHANGES: list[Any] = TOOL["changes"]()
RENAMES = runpy.run_path(str(ROOT / "tools" / "renames.py"))


def test_every_sort_of_addition_has_a_patch() -> None:
    assert {change.path.stem for change in CHANGES} == {
        "command",
        "fairing_goal",
        "function",
        "grid_format",
        "kind",
        "page_panel",
        "panel_format",
        "primitive",
    }


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.path.stem)
def test_a_patch_applies_and_is_small(change: Any) -> None:
    assert change.touched and not change.faults
    assert any("test" in name for name in change.modules), "a test of all its faces"
    # `--check` finds a file that is there already, and a line that is another one by now.
    done = subprocess.run(
        ["git", "apply", "--check", str(change.path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_excesses_are_found(tmp_path: Path) -> None:
    part = "diff --git a/{0} b/{0}\n--- a/{0}\n+++ b/{0}\n@@ -1 +1,2 @@\n x\n+y\n+z\n"
    path = tmp_path / "large.patch"
    path.write_text("Word: x\nGenerated: -\n" + "".join(map(part.format, "abc")))
    change = TOOL["Change"].read(path)
    assert change.touched == {"a": 2, "b": 2, "c": 2} and len(change.faults) == 2


def test_arguments_of_fifty_rows_can_be_changed() -> None:
    changes, files = RENAMES["draw_changes"](41, 50)
    assert len({change.row for change in changes}) == 50
    named = [change for change in changes if isinstance(change.to, str)]
    assert 10 < len(named) < 40
    text = "".join(files.values())
    for change in named:
        assert f"    {change.to}: " in text, change
