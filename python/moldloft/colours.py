"""The colours of pictures, plots and pages, from one file that the workbench reads, too.

``model`` has the sixteen colours of model files, ``turn`` the indices of those that patches without
a colour have in turn; ``x``, ``y`` and ``z`` are axes; names of classes are boxes of the digraph;
``before``, ``after``, ``moved``, ``wrong`` and ``quiet`` are of fairing, and stay apart for
colour-blind eyes and in grey. ``line-`` are kinds of lines in the picture. Names with ``-dark`` are
for dark grounds.
"""

from __future__ import annotations

import json
from importlib import resources

__all__ = ["COLOURS", "MODEL"]

_TEXT = (resources.files("moldloft") / "colours.json").read_text(encoding="utf-8")

COLOURS: dict[str, str] = {k: v for k, v in json.loads(_TEXT).items() if isinstance(v, str)}
"""Colours by name, as ``#rrggbb``."""

MODEL: tuple[str, ...] = tuple(json.loads(_TEXT)["model"])
"""The sixteen colours of model files, sRGB, as ``#rrggbb``."""
