"""Meaning of each diagnostic and removal of its cause: ``moldloft doc ID``, docs/diagnostics.md.

`docs/diagnostics.py` joins them with programs that are run.
"""

from __future__ import annotations

import json
from pathlib import Path

__all__ = ["EXPLANATIONS"]

EXPLANATIONS: dict[str, str] = json.loads(
    Path(__file__).with_suffix(".json").read_text(encoding="utf-8")
)
"""The diagnostics by id, each with its meaning and remedy.

>>> EXPLANATIONS["stray-jump"]
'`break` and `continue` belong in loops, `return` in functions.'
"""
