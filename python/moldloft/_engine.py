"""The engine process of the workbench: a model runs here, within limits, and can be ended."""

from __future__ import annotations

import sys

from moldloft import _core

__all__ = ["main"]


def main() -> None:
    """Answers the parent until it goes: ``_engine MEMORY NAME FOLDER [LIBRARY ...]``."""
    memory, name, folder, *library = sys.argv[1:]
    _core.engine(int(memory), name, folder or None, library)


if __name__ == "__main__":
    main()
