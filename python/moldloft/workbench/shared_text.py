"""A text that pages share: its changes, its draft and its file."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any, Protocol

from moldloft.errors import Error, FileError
from moldloft.storage import ChangedError, digest, put
from moldloft.workbench.draft import Draft
from moldloft.workbench.outbox import Outbox
from moldloft.workbench.text import Stored, applied, change_set, decoded, encoded, read

__all__ = ["Reader", "SharedText", "TextOwner"]

MOST_UPDATES = 20_000


class Reader(Protocol):
    """A page that follows texts."""

    @property
    def number(self) -> int:
        """Its number."""

    @property
    def outbox(self) -> Outbox:
        """Its queue of messages."""

    @property
    def known(self) -> dict[str, int]:
        """The versions of texts, by name, that the page has once its queue is sent."""


class TextOwner(Protocol):
    """Interface of the hub for a text."""

    def readers(self) -> list[Reader]:
        """All pages."""

    def text_changed(self, text: SharedText) -> None:
        """Notify the engine of a change."""

    def later(self, work: Coroutine[Any, Any, None]) -> None:
        """Work that nobody waits for."""


class SharedText:
    """A text of the hub: a change is applied on arrival, and confirmed to pages when it is on disk.

    Parameters
    ----------
    path
        Its file.
    owner
        The hub.
    name
        Empty for the model's own text; of a file beside it the name by which the engine reads it.

    Raises
    ------
    FileError
        If there is no readable file.
    Error
        If another workbench has it.
    """

    def __init__(self, path: Path, owner: TextOwner, name: str = "") -> None:
        self.path, self.name, self._owner = path, name, owner
        self.stored: Stored = read(path)
        self.draft = Draft(path)
        self.text = self.stored.text
        self.recovered = False
        left = self.draft.left()
        if left is not None and left["text"] != self.text:
            self.text, self.recovered = left["text"], True
        self.version = 0
        self._first = 0
        self._updates: list[dict[str, Any]] = []
        self._noted = self.stored.digest
        self._stamp: tuple[int, ...] | None = None
        self._disk = asyncio.Lock()
        self._published = 0
        self._unkept = ""

    @property
    def dirty(self) -> bool:
        """True when the text differs from the file's."""
        return self.text != self.stored.text

    def close(self) -> None:
        """Release the draft; it is kept if there are unsaved changes."""
        self.draft.close(keep=self.dirty)

    def state(self, reader: Reader) -> dict[str, Any]:
        """Send a page the text, and changes from then on."""
        reader.known[self.name] = self.version
        return {
            "text": self.text,
            "version": self.version,
            "dirty": self.dirty,
            "recovered": self.recovered,
        }

    # Messages to pages.

    def _tell(
        self, kind: str, state: Callable[[Reader], dict[str, Any]], but: int | None = None
    ) -> None:
        """Has the pages that have this text sent a state, as it is when their turn comes."""
        for reader in self._owner.readers():
            if reader.number == but or self.name not in reader.known:
                continue

            def make(reader: Reader = reader) -> str:
                return json.dumps({"kind": kind, "file": self.name, **state(reader)})

            reader.outbox.put_newest(f"{kind} {self.name}", make)

    def _tell_saved(self, *, but: int | None = None) -> None:
        self._tell("saved", lambda _: {"version": self.version, "dirty": self.dirty}, but)

    def _tell_conflict(self, theirs: str) -> None:
        self._tell("conflict", lambda _: {"theirs": theirs})

    def _news(self, reader: Reader) -> dict[str, Any]:
        """The changes that are on disk and that a page has not been sent."""
        known = reader.known.get(self.name, self._published)
        first = max(min(known, self._published), self._first)
        updates = self._updates[first - self._first : self._published - self._first]
        reader.known[self.name] = max(known, self._published)
        return {"from": first, "updates": updates, "dirty": self.dirty}

    def _to(self, reader: Reader, message: dict[str, Any]) -> None:
        reader.outbox.put(json.dumps({"file": self.name, **message}))

    def _refuse(self, reader: Reader, number: Any, error: object) -> None:
        self._to(reader, {"kind": "refused", "id": number, "error": str(error)})

    # What pages say.

    async def hear(self, reader: Reader, message: dict[str, Any]) -> None:
        """Handle a message of a page: ``push``, ``pull``, ``save`` or ``revert``."""
        kind = message["kind"]
        if kind == "push":
            self._push(reader, message)
        elif kind == "pull":
            self._pull(reader, message)
        elif kind == "save":
            async with self._disk:
                await self._write(reader, message)
        else:
            await self._revert(reader, message.get("id", 0))

    def _push(self, reader: Reader, message: dict[str, Any]) -> None:
        """Changes of the text. They count when the page knew the newest version."""
        number, updates = message.get("id", 0), message.get("updates")
        reply = {"kind": "pushed", "id": number, "ok": False, "version": self.version}
        try:
            if message.get("version") == self.version and isinstance(updates, list):
                text = self.text
                for update in updates:
                    text = applied(text, update["changes"])
                self._accept(text, [
                    {"changes": u["changes"], "clientID": str(u["clientID"])[:40]} for u in updates
                ])  # fmt: skip
                answer = {**reply, "ok": True, "version": self.version}
                self._owner.later(self._pushed(reader, answer))
                return
            if isinstance(message.get("version"), int) and message["version"] < self._first:
                # Too long away for the changes since: it takes the whole text.
                reply["text"] = self.text
        except (ValueError, KeyError, TypeError, IndexError) as error:
            reply = {**reply, "error": str(error), "text": self.text}
        self._to(reader, reply)

    async def _pushed(self, reader: Reader, reply: dict[str, Any]) -> None:
        """Says that changes count, once the draft is on disk: moves of sliders do not wait."""
        await self.publish()
        if self._unkept:
            reply["error"] = self._unkept
        self._to(reader, reply)

    def _accept(self, text: str, updates: list[dict[str, Any]]) -> None:
        """A new text, which counts at once; :meth:`publish` has to follow."""
        self.text = text
        self.version += len(updates)
        self._updates += updates
        if len(self._updates) > MOST_UPDATES:
            gone = len(self._updates) - MOST_UPDATES
            self._first += gone
            del self._updates[:gone]
        self._owner.text_changed(self)

    async def publish(self) -> None:
        """Write the newest text to disk, then send it to the pages, while the engine continues.

        Changes that arrive meanwhile are part of the next draft. If writing fails, the text is
        still valid, and the answers to pushes report the failure.
        """
        async with self._disk:
            version = self.version
            if self._published == version:
                return
            try:
                if self.dirty:
                    await asyncio.to_thread(self.draft.keep, self.text, self.stored.digest)
                else:
                    await asyncio.to_thread(self.draft.drop)
                self._unkept = ""
            except (OSError, Error) as error:
                self._unkept = f"the draft cannot be written: {error}"
            self._published = version
            self._tell("updates", self._news)

    def _pull(self, reader: Reader, message: dict[str, Any]) -> None:
        """The updates after the version of a page, or the whole text when they are not kept."""
        version = message.get("version")
        reply = {"kind": "pulled", "id": message.get("id", 0), "version": self.version}
        if isinstance(version, int) and self._first <= version <= self.version:
            reply.update({"from": version, "updates": self._updates[version - self._first :]})
        else:
            reply["text"] = self.text
        self._to(reader, reply)

    # The file.

    async def _write(self, reader: Reader, message: dict[str, Any]) -> None:
        """Writes the text to its file, unless that has changed meanwhile."""
        number = message.get("id", 0)
        try:
            now = read(self.path) if self.path.exists() else None
            if now and now.digest != self.stored.digest and not message.get("force"):
                self._noted = now.digest
                self._to(reader, {"kind": "conflict", "id": number, "theirs": now.text})
                return
            expected = now.digest if now else None
            data = encoded(self.text, self.stored)
            self._noted = digest(data)
            await asyncio.to_thread(put, self.path, data, expected=expected)
            self.stored = decoded(data)
            self.draft.drop()
        except ChangedError:
            # Between looking and writing; what is there now is shown.
            await self._write(reader, message)
            return
        except (Error, OSError) as error:
            self._refuse(reader, number, error)
            return
        self.recovered = False
        self._to(reader, {"kind": "saved", "id": number, "version": self.version})
        self._tell_saved(but=reader.number)

    async def look(self) -> None:
        """Read the file on disk, if it has changed."""
        try:
            status = self.path.stat()
            new = (status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
            if new == self._stamp:
                return
            self._stamp = new
            now = read(self.path)
        except (OSError, FileError):
            # It is being written, or has gone: the text is here.
            return
        if now.digest == self._noted:
            return
        if self.dirty and now.text != self.text:
            self._noted = now.digest
            self._tell_conflict(now.text)
            return
        try:
            await self._outside(now)
        except (OSError, Error):
            # The draft cannot be written just now: the next look tries again.
            self._stamp = None

    async def _revert(self, reader: Reader, number: Any) -> None:
        """The file's text for a page, which applies it as a step of its own history."""
        try:
            now = read(self.path)
            self.stored, self._noted = now, now.digest
            if now.text == self.text:
                await self._outside(now)
            self._to(reader, {"kind": "reverted", "id": number, "text": now.text})
        except (OSError, Error) as error:
            self._refuse(reader, number, error)
        self.recovered = False

    async def _outside(self, now: Stored) -> None:
        """Replaces our text with that of the file."""
        self.stored = now
        if now.text != self.text:
            update = {"changes": change_set(self.text, now.text), "clientID": "disk"}
            self._accept(now.text, [update])
            await self.publish()
        else:
            async with self._disk:
                self.draft.drop()
            self._tell_saved()
        self._noted = now.digest
