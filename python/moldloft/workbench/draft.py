"""The draft beside a model: every accepted keystroke is on disk, and one server owns it."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

from moldloft.errors import Error, FileError
from moldloft.storage import BusyError, Lock, make_folders, put, read_bytes, recover, remove
from moldloft.storage.journal import state_folder

__all__ = ["Draft"]

#: The form of drafts; those without a version are of the first.
VERSION = 1


def _places(model: Path) -> tuple[Path, Path]:
    """Where the draft of a file is: beside it, or in a folder of the user."""
    target = model.resolve()
    name = "%".join(target.parts[1:])[-180:] + ".draft"
    return target.with_name(f".{target.name}.draft"), state_folder().parent / "drafts" / name


class Draft:
    """A side file ``.NAME.draft``; its owner holds the lock beside it.

    Parameters
    ----------
    model
        The model's file.

    Raises
    ------
    Error
        If another workbench has the model.
    """

    def __init__(self, model: Path) -> None:
        beside, elsewhere = _places(model)
        try:
            try:
                self._own(beside)
            except BusyError:
                raise
            except OSError:
                # The folder cannot be written: the draft is among those of prompts.
                make_folders(elsewhere.parent)
                self._own(elsewhere)
        except BusyError as busy:
            by = f": {busy.owner}" if busy.owner else ""
            raise Error(
                f"`{model}` is open in another workbench{by}; close that one first"
            ) from None

    def _own(self, path: Path) -> None:
        self.path = path
        self._lock = Lock(path.with_name(path.name + ".lock"), path.name)
        recover(path.parent)

    @staticmethod
    def waits(model: Path) -> bool:
        """True if a server has left a draft of a file, or has it open with changes.

        Parameters
        ----------
        model
            The file.
        """
        return any(place.exists() for place in _places(model))

    def left(self) -> dict[str, str] | None:
        """The draft of an earlier server: ``text``, and the ``digest`` of the file it is based on.

        Raises
        ------
        Error
            If a later version of Moldloft wrote it.
        """
        with contextlib.suppress(ValueError, FileError):
            found = json.loads(read_bytes(self.path))
            if isinstance(found, dict) and isinstance(found.get("text"), str):
                version = found.get("version", 1)
                if version != VERSION:
                    raise Error(
                        f"`{self.path}` is a draft of version {version}, written by a later "
                        f"Moldloft; this one reads version {VERSION}"
                    )
                return {"text": found["text"], "digest": str(found.get("digest", ""))}
        return None

    def keep(self, text: str, digest: str) -> None:
        """Write the text to disk, synced."""
        data = {"version": VERSION, "text": text, "digest": digest}
        put(self.path, json.dumps(data).encode(), private=True)

    def drop(self) -> None:
        """Nothing is unsaved."""
        remove(self.path)

    def close(self, keep: bool) -> None:
        """Release the draft when the server ends; it is deleted if there are no changes."""
        if not keep:
            with contextlib.suppress(OSError):
                self.drop()
        self._lock.release()
