"""The draft beside a model: every accepted keystroke is on disk, and one server owns it."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path
from typing import IO

from moldloft.cli.journal import _lock, state_folder
from moldloft.errors import Error

__all__ = ["Draft"]


class Draft:
    """A side file ``.NAME.draft`` that its owner holds locked.

    Parameters
    ----------
    model
        The model's file.
    """

    def __init__(self, model: Path) -> None:
        target = model.resolve()
        beside = target.with_name(f".{target.name}.draft")
        try:
            self._file, self.path = self._open(beside), beside
        except OSError:
            # The folder cannot be written: the draft is among those of prompts.
            name = "%".join(target.parts[1:])[-180:] + ".draft"
            folder = state_folder().parent / "drafts"
            folder.mkdir(parents=True, exist_ok=True)
            self._file, self.path = self._open(folder / name), folder / name
        if not _lock(self._file):
            self._file.close()
            raise Error(f"`{model}` is open in another workbench: close that one first")

    @staticmethod
    def _open(path: Path) -> IO[str]:
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
        return os.fdopen(os.open(path, flags, 0o600), "r+", encoding="utf-8", newline="\n")

    def left(self) -> dict[str, str] | None:
        """What an earlier server left: ``text``, and the ``digest`` of the file it was made of."""
        self._file.seek(0)
        with contextlib.suppress(ValueError):
            found = json.loads(self._file.read())
            if isinstance(found, dict) and isinstance(found.get("text"), str):
                return {"text": found["text"], "digest": str(found.get("digest", ""))}
        return None

    def keep(self, text: str, digest: str) -> None:
        """Write the text to disk before this returns."""
        # The new content goes behind the old, then replaces it: a kill leaves one of them readable.
        data = json.dumps({"text": text, "digest": digest})
        draft = self.path.with_name(self.path.name + ".new")
        with os.fdopen(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        renewed = draft.open("r+", encoding="utf-8", newline="\n")
        _lock(renewed)
        draft.replace(self.path)
        self._file.close()
        self._file = renewed

    def drop(self) -> None:
        """Nothing is unsaved: the draft is empty."""
        self._file.seek(0)
        self._file.truncate()
        self._file.flush()

    def close(self, keep: bool) -> None:
        """End of the server; a draft of nothing goes."""
        if not keep:
            self.path.unlink(missing_ok=True)
        self._file.close()
