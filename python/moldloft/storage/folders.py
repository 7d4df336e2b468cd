"""Creation of parent folders of a file."""

from __future__ import annotations

import contextlib
from pathlib import Path

from moldloft.errors import FileError
from moldloft.storage import system

__all__ = ["make_folders"]


def make_folders(folder: Path) -> list[Path]:
    """Make a folder with its missing parents, synced.

    Returns
    -------
    list
        The new ones, innermost first.

    Raises
    ------
    FileError
        If one cannot be created; then no folder is created.
    """
    made: list[Path] = []
    missing: list[Path] = []
    at = folder
    while not at.exists() and at != at.parent:
        missing.append(at)
        at = at.parent
    try:
        for new in reversed(missing):
            with contextlib.suppress(FileExistsError):
                system.make_folder(new)
                made.insert(0, new)
            # Its content is lost with its name.
            system.folder_synced(new.parent)
        if not folder.is_dir():
            raise FileError(f"cannot make the folder `{folder}`: a file has that name")
    except OSError as error:
        for new in made:
            with contextlib.suppress(OSError):
                system.remove_folder(new)
        if isinstance(error, FileError):
            raise
        why = system.reason(error)
        raise FileError(f"cannot make the folder `{folder}`: {why}") from error
    return made
