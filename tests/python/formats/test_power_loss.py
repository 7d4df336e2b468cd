"""Power loss: every moment of a write, with what was not synced lost, torn, zeroed or reordered.

The operations of the storage layer are recorded. For every prefix of them, disks are made that a
power cut may leave: a file whose data was not synced holds what it held at its last sync, a later
state, the beginning of one, or zeros; of the names of a folder that were made, exchanged or
removed since it was synced, any subset is there. On each such disk the next start must find the old
or the new whole, the new if the write was reported as done, and leave nothing behind. (The model is
that of Pillai et al., "All file systems are not created equal", OSDI 2014, without its order.)
"""

# Stands in for the module `os`, call by call.
# ruff: noqa: PTH100, PTH102, PTH105, PTH108

from __future__ import annotations

import contextlib
import itertools
import os
import random
import shutil
import stat
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from moldloft.storage import (
    Output,
    commit,
    digest,
    journal,
    locks,
    put,
    reading,
    recover,
    replacing,
    sets,
    system,
)
from moldloft.workbench.draft import Draft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX files")


@dataclass
class Disk:
    """What a folder's tree was and what was done to it; a file is a number."""

    root: Path
    files: dict[int, bytes] = field(default_factory=dict)
    names: dict[str, dict[str, int]] = field(default_factory=dict)
    log: list[tuple[Any, ...]] = field(default_factory=list)
    live: dict[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, root: Path) -> Disk:
        """All that is there now, on the disk for good."""
        disk = cls(root)
        disk.names["."] = {}
        for path in sorted(root.rglob("*")):
            name = path.relative_to(root).as_posix()
            number = len(disk.live) + 1
            disk.live[name] = number
            disk.names.setdefault(_parent(name), {})[Path(name).name] = number
            if path.is_dir():
                disk.names[name] = {}
                disk.files[number] = b"/" + name.encode()
            else:
                disk.files[number] = path.read_bytes()
        return disk

    def new(self) -> int:
        """The number of a new file."""
        return len(self.files) + sum(entry[0] == "new" for entry in self.log) + 1


def _parent(name: str) -> str:
    return Path(name).parent.as_posix()


class Recording:
    """The module ``os``, whose operations below a folder are recorded and carried out."""

    def __init__(self, disk: Disk) -> None:
        self.disk = disk
        self.open_files: dict[int, int] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(os, name)

    def _name(self, path: Any) -> str:
        return Path(os.path.abspath(path)).relative_to(self.disk.root).as_posix()

    def open(self, path: Any, flags: int, mode: int = 0o777) -> int:
        file = os.open(path, flags, mode)
        name = self._name(path)
        if name not in self.disk.live and stat.S_ISREG(os.fstat(file).st_mode):
            number = self.disk.live[name] = self.disk.new()
            self.disk.log.append(("new", number))
            self.disk.log.append(("set", name, number))
        self.open_files[file] = self.disk.live.get(name, 0)
        if stat.S_ISDIR(os.fstat(file).st_mode):
            self.open_files[file] = -1
            self.folder = name
        return file

    def _changed(self, file: int) -> None:
        where = f"/proc/self/fd/{file}"
        self.disk.log.append(("data", self.open_files[file], Path(where).read_bytes()))

    def write(self, file: int, data: Any) -> int:
        done = os.write(file, data)
        self._changed(file)
        return done

    def ftruncate(self, file: int, length: int) -> None:
        os.ftruncate(file, length)
        self._changed(file)

    def fsync(self, file: int) -> None:
        number = self.open_files[file]
        entry = ("synced", self.folder) if number < 0 else ("sync", number)
        self.disk.log.append(entry)

    def replace(self, old: Any, new: Any) -> None:
        os.replace(old, new)
        here, there = self._name(old), self._name(new)
        number = self.disk.live[there] = self.disk.live.pop(here)
        self.disk.log.append(("set", there, number, here))

    def link(self, old: Any, new: Any, **options: Any) -> None:
        os.link(old, new, **options)
        number = self.disk.live[self._name(new)] = self.disk.live[self._name(old)]
        self.disk.log.append(("set", self._name(new), number))

    def unlink(self, path: Any) -> None:
        os.unlink(path)
        self.disk.live.pop(self._name(path), None)
        self.disk.log.append(("gone", self._name(path)))

    def mkdir(self, path: Any, mode: int = 0o777) -> None:
        os.mkdir(path, mode)
        number = self.disk.live[self._name(path)] = self.disk.new()
        self.disk.log.append(("new", number))
        self.disk.log.append(("folder", number, self._name(path)))
        self.disk.log.append(("set", self._name(path), number))


@contextlib.contextmanager
def recorded(root: Path) -> Iterator[Disk]:
    disk = Disk.of(root)
    modules = (system, reading, replacing, sets, locks, journal)
    recording = Recording(disk)
    for module in modules:
        module.os = recording  # type: ignore[attr-defined]
    try:
        yield disk
    finally:
        for module in modules:
            module.os = os  # type: ignore[attr-defined]


def after_power_loss(disk: Disk, moment: int, chance: random.Random) -> dict[str, bytes | None]:
    """One of the trees that a power cut at that moment may leave; folders are ``None``."""
    synced = dict(disk.files)
    later: dict[int, list[bytes]] = {}
    names = {folder: dict(found) for folder, found in disk.names.items()}
    folders = {number: data[1:].decode() for number, data in disk.files.items() if data[:1] == b"/"}
    pending: dict[str, list[tuple[Any, ...]]] = {}
    for entry in disk.log[:moment]:
        kind = entry[0]
        if kind == "new":
            synced[entry[1]] = b""
        elif kind == "folder":
            folders[entry[1]] = entry[2]
            names[entry[2]] = {}
        elif kind == "data":
            later.setdefault(entry[1], []).append(entry[2])
        elif kind == "sync":
            if later.get(entry[1]):
                synced[entry[1]] = later.pop(entry[1])[-1]
        elif kind in ("set", "gone"):
            pending.setdefault(_parent(entry[1]), []).append(entry)
        elif kind == "synced":
            for change in pending.pop(entry[1], []):
                _applied(names, change)
    # The names: any subset of what was not synced, in its order.
    how = chance.random()
    for changes in pending.values():
        kept = [c for c in changes if how < 0.1 or (how > 0.2 and chance.random() < 0.5)]
        for change in kept:
            _applied(names, change)
    # The data: what was synced, or something of what came after.
    for number, states in later.items():
        data = chance.choice([synced[number], *states])
        last = states[-1]
        # What is the same as on the disk is not at stake.
        pairs = zip(synced[number], last, strict=False)
        same = len(list(itertools.takewhile(lambda pair: pair[0] == pair[1], pairs)))
        what = chance.randrange(4)
        if what == 0:
            data = last[: chance.randrange(same, len(last) + 1)]
        elif what == 1:
            data = last[:same] + b"\0" * (len(last) - same)
        synced[number] = data
    found: dict[str, bytes | None] = {}

    def walk(folder: str) -> None:
        for name, number in names.get(folder, {}).items():
            place = name if folder == "." else f"{folder}/{name}"
            if number in folders:
                found[place] = None
                walk(folders[number])
            else:
                found[place] = synced[number]

    walk(".")
    return found


def _applied(names: dict[str, dict[str, int]], change: tuple[Any, ...]) -> None:
    here = names.setdefault(_parent(change[1]), {})
    if change[0] == "gone":
        here.pop(Path(change[1]).name, None)
        return
    here[Path(change[1]).name] = change[2]
    if len(change) > 3:
        names.setdefault(_parent(change[3]), {}).pop(Path(change[3]).name, None)


def made(root: Path, tree: dict[str, bytes | None]) -> None:
    """That tree as files."""
    shutil.rmtree(root, ignore_errors=True)
    root.mkdir()
    for name, data in sorted(tree.items()):
        if data is None:
            (root / name).mkdir(exist_ok=True)
        else:
            (root / name).write_bytes(data)


def shown(root: Path) -> dict[str, bytes]:
    return {
        p.relative_to(root).as_posix(): p.read_bytes()
        for p in sorted(root.rglob("*"))
        if p.is_file() and not p.name.startswith(".")
    }


def hidden(root: Path) -> list[str]:
    return [p.name for p in root.rglob(".*")]


@pytest.fixture(autouse=True)
def quick_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """The disks of the model are not synced for real."""
    monkeypatch.setattr(os, "fsync", lambda file: None)


def begun(root: Path) -> None:
    root.mkdir()
    for name in ("a", "b"):
        (root / name).write_bytes(b"old " + name.encode() * 60)


NEW = [Output(name, b"new " + name.encode() * 90) for name in ("a", "b", "c")]
WRITES: dict[str, tuple[Callable[[Path], object], str]] = {
    "set": (lambda root: commit(root, NEW), "."),
    "single": (lambda root: commit(root, NEW[:1]), "."),
    "compared": (lambda root: put(root / "a", b"new", expected=digest(b"old " + b"a" * 60)), "."),
    "new folder": (lambda root: commit(root / "x" / "y", NEW[:2]), "x/y"),
    "file in a new folder": (lambda root: commit(root / "x", NEW[:1]), "x"),
}


def started(root: Path, folder: str) -> None:
    """What the next start does in the folders that it uses."""
    sets._swept.clear()
    for place in (root, root / folder):
        if place.is_dir():
            recover(place)


@pytest.mark.parametrize("kind", WRITES)
def test_a_power_cut_leaves_the_old_or_the_new(tmp_path: Path, kind: str) -> None:
    write, folder = WRITES[kind]
    chance = random.Random(5)
    root = tmp_path / "disk"
    begun(root)
    before = shown(root)
    with recorded(root) as disk:
        write(root)
    after = shown(root)
    assert before != after and len(disk.log) > 4
    states, again, kept = 0, tmp_path / "again", {"old": 0, "new": 0}
    for moment in range(len(disk.log) + 1):
        for _ in range(60 if SOAK else 2):
            made(again, after_power_loss(disk, moment, chance))
            # The next start, which may end by a power cut as well.
            with recorded(again) as second:
                started(again, folder)
            if second.log:
                made(again, after_power_loss(second, chance.randrange(len(second.log)), chance))
                started(again, folder)
            found = shown(again)
            states += 1
            where = f"{kind}, after {moment} of {len(disk.log)} operations"
            assert found in (before, after), where
            # It was reported as done with the last operation.
            assert found == after or moment < len(disk.log), where
            assert hidden(again) == [], where
            kept["new" if found == after else "old"] += 1
    assert min(kept.values()) > 0, kept
    print(f"{kind}: {states} states, {kept}")


def test_random_sets_outlast_power_cuts(tmp_path: Path) -> None:
    chance = random.Random(8)
    states = 0
    for turn in itertools.count():
        if states >= (10_000 if SOAK else 80):
            break
        root, again = tmp_path / f"disk {turn}", tmp_path / "again"
        root.mkdir()
        names = [f"f{k}" for k in range(chance.randrange(1, 7))]
        for name in names:
            if chance.random() < 0.6:
                (root / name).write_bytes(b"old" * chance.randrange(1, 400))
        seen = [shown(root)]
        acknowledged: list[int] = []
        with recorded(root) as disk:
            for generation in range(chance.randrange(1, 3)):
                data = b"%d " % generation
                commit(root, [Output(n, data * chance.randrange(1, 400)) for n in names])
                acknowledged.append(len(disk.log))
                seen.append(shown(root))
        for _ in range(40):
            moment = chance.randrange(len(disk.log) + 1)
            made(again, after_power_loss(disk, moment, chance))
            started(again, ".")
            least = sum(moment >= done for done in acknowledged)
            assert shown(again) in seen[least:], (turn, moment)
            assert hidden(again) == [], (turn, moment)
            states += 1
        shutil.rmtree(root)
    print(f"{states} states")


def test_journals_keep_every_answered_line_through_power_cuts(tmp_path: Path) -> None:
    """A prompt edits a file: commands, a save, more commands; each answered line is somewhere."""
    chance = random.Random(2)
    root, again = tmp_path / "disk", tmp_path / "again"
    root.mkdir()
    (root / "a.skt").write_bytes(b"")
    answered: list[tuple[int, list[str]]] = [(0, [])]
    with recorded(root) as disk:
        kept = journal.Journal(root / "a.skt.skj", [], base=digest(b""))
        commands: list[str] = []
        for turn in range(12):
            if turn in (4, 9):
                data = "".join(line + "\n" for line in commands).encode()
                kept.saving(digest(data))
                put(root / "a.skt", data)
                kept.saved(digest(data))
            commands.append(f"POINT {turn} AT {turn} {turn * turn}")
            kept.append(commands[-1:])
            answered.append((len(disk.log), list(commands)))
    kept.close(keep=False)
    states = 0
    for moment in range(len(disk.log) + 1):
        for _ in range(40 if SOAK else 2):
            made(again, after_power_loss(disk, moment, chance))
            sets._swept.clear()
            recover(again)
            saved = (again / "a.skt").read_bytes()
            path = again / "a.skt.skj"
            left = journal.read(path, digest(saved)) if path.exists() else None
            found = saved.decode().splitlines() + (left.commands if left else [])
            least = next(lines for done, lines in reversed(answered) if done <= moment)
            assert found[: len(least)] == least, moment
            assert found == commands[: len(found)], moment
            assert left is None or not left.stale, moment
            states += 1
    print(f"{states} states")


def test_drafts_of_the_workbench_outlast_power_cuts(tmp_path: Path) -> None:
    chance = random.Random(3)
    root, again = tmp_path / "disk", tmp_path / "again"
    root.mkdir()
    (root / "m.sdl").write_bytes(b"AbsPoint A(0, 0, 0);\n")
    kept_at: list[tuple[int, str]] = []
    with recorded(root) as disk:
        draft = Draft(root / "m.sdl")
        for turn in range(6):
            text = f"AbsPoint A({turn}, 0, 0);\n" * (turn + 1)
            draft.keep(text, "0")
            kept_at.append((len(disk.log), text))
    draft.close(keep=True)
    texts = [text for _, text in kept_at]
    for moment in range(len(disk.log) + 1):
        for _ in range(20 if SOAK else 2):
            made(again, after_power_loss(disk, moment, chance))
            sets._swept.clear()
            recover(again)
            other = Draft(again / "m.sdl")
            left = other.left()
            other.close(keep=True)
            least = sum(done <= moment for done, _ in kept_at)
            found = texts.index(left["text"]) + 1 if left else 0
            assert found >= least, moment
