"""The models that were opened last, in ``$XDG_STATE_HOME/moldloft/recent.json``."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

from moldloft.errors import Error, FileError
from moldloft.storage import make_folders, put, read_bytes
from moldloft.storage.journal import state_folder

__all__ = ["note_opened", "recent_models"]

#: Models that are kept.
_MOST = 12


def _list() -> Path:
    return state_folder().parent / "recent.json"


def recent_models() -> list[Path]:
    """The recently opened models that still exist, the newest first."""
    with contextlib.suppress(ValueError, FileError, OSError):
        found = json.loads(read_bytes(_list()))
        if isinstance(found, list):
            paths = [Path(word) for word in found if isinstance(word, str)]
            return [path for path in paths if path.is_absolute() and path.is_file()]
    return []


def note_opened(path: Path) -> None:
    """Put a model first among the recently opened ones.

    Parameters
    ----------
    path
        The model's file. Where nothing can be kept, nothing is.
    """
    target = path.resolve()
    rest = [other for other in recent_models() if other != target]
    words = [str(other) for other in [target, *rest][:_MOST]]
    with contextlib.suppress(OSError, Error, UnicodeError):
        make_folders(_list().parent)
        put(_list(), json.dumps(words, indent=1).encode(), private=True)
