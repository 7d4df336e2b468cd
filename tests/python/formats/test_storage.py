"""Writing: whole or not at all, whatever fails, whoever else writes, whenever it is killed."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import random
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from conftest import SAILBOAT
from moldloft.errors import FileError
from moldloft.storage import (
    BusyError,
    ChangedError,
    Lock,
    Output,
    Watch,
    commit,
    digest,
    journal,
    locks,
    put,
    read_bytes,
    read_set,
    reading,
    recover,
    replacing,
    sets,
    system,
)

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

posix = pytest.mark.skipif(os.name == "nt", reason="POSIX files")


def left_over(folder: Path) -> list[str]:
    """Drafts, second names, records and locks."""
    return [p.name for p in folder.rglob(".*") if p.name.startswith(".")]


# One file.


@posix
def test_mode_and_links_are_kept(tmp_path: Path) -> None:
    real = tmp_path / "there" / "real.sdl"
    real.parent.mkdir()
    real.write_bytes(b"old")
    real.chmod(0o600)
    link = tmp_path / "link.sdl"
    link.symlink_to("there/real.sdl")
    put(link, b"new")
    assert link.is_symlink() and real.read_bytes() == b"new"
    assert stat.S_IMODE(real.stat().st_mode) == 0o600
    # A link to a file that is not there yet makes it where it points.
    dangling = tmp_path / "dangling.sdl"
    dangling.symlink_to("there/new.sdl")
    put(dangling, b"made")
    assert dangling.is_symlink() and (real.parent / "new.sdl").read_bytes() == b"made"
    # A new file is as the umask says, a private one is not.
    plain = tmp_path / "plain"
    plain.touch()
    assert (real.parent / "new.sdl").stat().st_mode == plain.stat().st_mode
    put(tmp_path / "own", b"", private=True)
    assert stat.S_IMODE((tmp_path / "own").stat().st_mode) == 0o600
    assert left_over(tmp_path) == []


@posix
@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives away")
def test_the_owner_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "theirs"
    path.write_bytes(b"old")
    os.chown(path, 12, 34)
    path.chmod(0o4640)
    put(path, b"new")
    status = path.stat()
    assert (status.st_uid, status.st_gid) == (12, 34)
    assert stat.S_IMODE(status.st_mode) == 0o4640


@posix
@pytest.mark.skipif(not hasattr(os, "setxattr"), reason="no extended attributes")
def test_extended_attributes_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "with"
    path.write_bytes(b"old")
    try:
        os.setxattr(path, "user.colour", b"red")
    except OSError:
        pytest.skip("this file system has none")
    put(path, b"new")
    assert os.getxattr(path, "user.colour") == b"red"


@posix
def test_what_is_not_a_file_to_write_is_refused(tmp_path: Path) -> None:
    locked = tmp_path / "read-only"
    locked.write_bytes(b"old")
    locked.chmod(0o444)
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    for name, why in [
        ("read-only", "read-only"),
        ("pipe", "not a regular file"),
        ("folder", "it is a folder"),
        ("a", "circle|symbolic links"),
        ("read-only/x", "not a directory|no such"),
        ("x" * 300, "too long"),
        ("a\0b", "null"),
    ]:
        with pytest.raises(FileError, match=f"cannot write .*({why})"):
            put(tmp_path / name, b"new")
    assert locked.read_bytes() == b"old"
    with pytest.raises(FileError, match="not a regular file"):
        put(Path(os.devnull), b"new")
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)
    assert left_over(tmp_path) == []


@posix
def test_what_is_not_a_file_to_read_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "large").write_bytes(b"123456")
    with pytest.raises(FileError, match="not a regular file"):
        read_bytes(tmp_path / "pipe")
    with pytest.raises(FileError, match="larger than 5 bytes"):
        read_bytes(tmp_path / "large", 5)
    assert read_bytes(tmp_path / "large", 6) == b"123456"
    with pytest.raises(FileError, match="it is a folder"):
        read_bytes(tmp_path)
    for device in ("/dev/zero", "/dev/stdin", "/proc/self/mem"):
        if Path(device).exists():
            with pytest.raises(FileError):
                read_bytes(device, 1 << 20)


def test_a_file_that_changed_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"one")
    put(path, b"two", expected=digest(b"one"))
    with pytest.raises(ChangedError, match="changed meanwhile"):
        put(path, b"three", expected=digest(b"one"))
    path.unlink()
    with pytest.raises(ChangedError):
        put(path, b"three", expected=digest(b"two"))
    assert left_over(tmp_path) == []


def test_increments_by_many_are_all_counted(tmp_path: Path) -> None:
    path = tmp_path / "count"
    path.write_bytes(b"0")
    refused = []

    def work() -> None:
        for _ in range(20):
            while True:
                old = read_bytes(path)
                with contextlib.suppress(ChangedError):
                    put(path, str(int(old) + 1).encode(), expected=digest(old))
                    break
                refused.append(1)

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert read_bytes(path) == b"120", f"{len(refused)} refusals"
    assert left_over(tmp_path) == []


# Locks.


def test_a_lock_says_who_has_it(tmp_path: Path) -> None:
    with Lock(tmp_path / ".a.lock", "a"):
        # Also in one process, as `flock` does and `lockf` does not.
        with pytest.raises(BusyError, match=rf"`a` is in use by process {os.getpid()} ") as busy:
            Lock(tmp_path / ".a.lock", "a")
        assert busy.value.owner is not None and busy.value.owner.pid == os.getpid()
        begin = time.monotonic()
        with pytest.raises(BusyError):
            Lock(tmp_path / ".a.lock", "a", wait=0.1)
        assert time.monotonic() - begin >= 0.1
    with Lock(tmp_path / ".a.lock", "a"):
        pass
    assert left_over(tmp_path) == []


@posix
def test_the_lock_of_a_killed_process_is_free(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pathlib import Path; from moldloft.storage import Lock\n"
        "l = Lock(Path(sys.argv[1]), 'a'); print('held', flush=True); time.sleep(60)"
    )
    path = tmp_path / ".a.lock"
    command = [sys.executable, "-c", code, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout and child.stdout.readline() == "held\n"
        with pytest.raises(BusyError, match=f"process {child.pid} "):
            Lock(path, "a")
        child.kill()
        child.wait()
    Lock(path, "a", wait=1.0).release()
    assert not path.exists()


# Sets of files.


def written(folder: Path, generation: int, names: int = 4) -> None:
    commit(folder, [Output(f"f{k}", f"{generation} {k}".encode() * 50) for k in range(names)])


def generation(contents: dict[str, bytes | None]) -> set[int]:
    return {int(data.split()[0]) for data in contents.values() if data is not None}


def test_a_set_has_each_name_once(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="two files of the set"):
        commit(tmp_path, [Output("a", b"1"), Output("a", b"2")])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("writers", [100 if SOAK else 12])
def test_readers_see_one_generation_while_many_write(tmp_path: Path, writers: int) -> None:
    names = [f"f{k}" for k in range(4)]
    written(tmp_path, 0)
    seen, wrong, over = set(), [], threading.Event()

    def write(number: int) -> None:
        try:
            for turn in range(3):
                written(tmp_path, 1 + number * 3 + turn)
        except Exception as error:
            wrong.append(repr(error))

    def look() -> None:
        while not over.is_set():
            found = generation(read_set(tmp_path, names))
            seen.update(found)
            if len(found) != 1:
                wrong.append(f"mixed: {found}")

    reader = threading.Thread(target=look)
    threads = [threading.Thread(target=write, args=(k,)) for k in range(writers)]
    for thread in [reader, *threads]:
        thread.start()
    for thread in threads:
        thread.join()
    over.set()
    reader.join()
    assert wrong == []
    assert len(generation(read_set(tmp_path, names))) == 1 and len(seen) > 1
    assert left_over(tmp_path) == []


WRITER = """
import sys
from pathlib import Path
from moldloft.storage import Output, commit
folder, first = Path(sys.argv[1]), int(sys.argv[2])
print("begin", flush=True)
for g in range(first, 1 << 40):
    commit(folder, [Output(f"f{k}", f"{g} {k}".encode() * 50) for k in range(4)])
    print(g, flush=True)
"""


@posix
def test_killed_writers_leave_one_generation_and_nothing_else(tmp_path: Path) -> None:
    names = [f"f{k}" for k in range(4)]
    chance = random.Random(3)
    written(tmp_path, 0)
    last = mixed = 0
    for turn in range(500 if SOAK else 8):
        command = [sys.executable, "-c", WRITER, str(tmp_path), str(last + 1)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
            assert child.stdout
            assert child.stdout.readline() == "begin\n"
            time.sleep(chance.uniform(0, 0.03))
            # Every other kill while names are replaced, however quick the disk is.
            end = time.monotonic() + 5
            while turn % 2 and not (tmp_path / sets.RECORD).exists() and time.monotonic() < end:
                pass
            child.kill()
            said = [int(line) for line in child.stdout.read().split("\n")[:-1]]
        done = max([last, *said])
        mixed += (tmp_path / sets.RECORD).exists()
        sets._swept.clear()
        found = read_set(tmp_path, names)
        (last,) = generation(found)
        # What was reported as written is there; one more may have ended without being reported.
        assert done <= last <= done + 1
        assert all(data == f"{last} {n[1:]}".encode() * 50 for n, data in found.items())
        assert left_over(tmp_path) == []
        written(tmp_path, last)
        assert left_over(tmp_path) == []
    assert mixed > (20 if SOAK else 0), "the kills did not hit the moment that matters"


def test_records_from_elsewhere_reach_nothing_outside(tmp_path: Path) -> None:
    folder, outside = tmp_path / "in", tmp_path / "out"
    folder.mkdir()
    outside.write_bytes(b"precious")
    token = "0" * 16
    for name in ("../out", str(outside), "..", "", "a/../../out"):
        record = {"version": 1, "token": token, "files": [
            {"name": name, "existed": False, "digest": digest(b"precious")}]}  # fmt: skip
        (folder / sets.RECORD).write_text(json.dumps(record))
        recover(folder)
        assert outside.read_bytes() == b"precious"
    for nonsense in (b"", b"{", b"[1]", b'{"token": 1, "files": [{}]}', b"\xff", b"\0" * 99):
        (folder / sets.RECORD).write_bytes(nonsense)
        written(folder, 1)
        assert left_over(folder) == []


# Every operation fails once, and from then on.

FALLIBLE = [
    "open", "write", "fsync", "replace", "link", "unlink", "mkdir", "rmdir", "fchmod", "fchown",
    "fstat", "ftruncate", "read", "close", "stat", "access", "scandir", "lseek",
]  # fmt: skip


class Failing:
    """The module ``os``, whose n-th call fails."""

    def __init__(self, number: int, code: int, lasting: bool) -> None:
        self.number, self.code, self.lasting = number, code, lasting
        self.count = 0

    def __getattr__(self, name: str) -> Any:
        real = getattr(os, name)
        if name not in FALLIBLE:
            return real

        def call(*arguments: Any, **options: Any) -> Any:
            self.count += 1
            hit = self.count == self.number or (self.lasting and self.count > self.number)
            if hit and name == "write" and self.code == 0:
                # A short write.
                return real(arguments[0], bytes(arguments[1])[: len(arguments[1]) // 2 or 1])
            if hit and self.code:
                if name == "close":
                    # The descriptor is gone all the same.
                    real(*arguments)
                raise OSError(self.code, os.strerror(self.code))
            return real(*arguments, **options)

        return call

    @property
    def reached(self) -> bool:
        return self.count >= self.number


@contextlib.contextmanager
def failing(failure: Failing) -> Iterator[None]:
    modules = (system, reading, replacing, sets, locks, journal)
    for module in modules:
        module.os = failure  # type: ignore[attr-defined]
    try:
        yield
    finally:
        for module in modules:
            module.os = os  # type: ignore[attr-defined]


def contents(folder: Path) -> dict[str, tuple[bytes, int] | None]:
    return {
        p.relative_to(folder).as_posix(): (p.read_bytes(), p.stat().st_mode)
        if p.is_file()
        else None
        for p in sorted(folder.rglob("*"))
        if not p.name.startswith(".")
    }


def old_set(folder: Path) -> None:
    folder.mkdir()
    (folder / "a").write_bytes(b"old a")
    (folder / "a").chmod(0o640)
    (folder / "b").write_bytes(b"old b")


NEW = [Output("a", b"new a" * 9), Output("b", b"new b"), Output("c", b"new c")]

WRITES: dict[str, Callable[[Path], object]] = {
    "set": lambda folder: commit(folder, NEW),
    "single": lambda folder: commit(folder, NEW[:1]),
    "compared": lambda folder: put(folder / "a", b"new", expected=digest(b"old a")),
    "folder": lambda folder: commit(folder / "x" / "y", NEW[:2]),
    "private": lambda folder: put(folder / "d", b"new", private=True),
}
CODES = [errno.EIO, errno.ENOSPC, errno.EACCES, errno.EROFS, errno.EDQUOT, 0]


@posix
@pytest.mark.parametrize("kind", WRITES)
def test_a_failure_anywhere_leaves_the_old_or_the_new(tmp_path: Path, kind: str) -> None:
    old_set(tmp_path / "wanted")
    WRITES[kind](tmp_path / "wanted")
    old_set(tmp_path / "old")
    before, after = contents(tmp_path / "old"), contents(tmp_path / "wanted")
    assert before != after
    points = 0
    for code in CODES if SOAK else [errno.EIO, 0]:
        for lasting in (False, True):
            number = 0
            while True:
                number += 1
                folder = tmp_path / f"f{code}-{lasting}-{number}"
                old_set(folder)
                sets._swept.clear()
                failure = Failing(number, code, lasting)
                where = f"{kind}: operation {number}, {errno.errorcode.get(code)}, {lasting=}"
                with failing(failure):
                    try:
                        WRITES[kind](folder)
                        refused = False
                    except FileError:
                        refused = True
                points += 1
                if not lasting:
                    assert contents(folder) == (before if refused else after), where
                # The next start: what failed works again.
                sets._swept.clear()
                commit(folder, [Output("next", b"")])
                (folder / "next").unlink()
                recover(folder / "x" / "y")
                found = contents(folder)
                if lasting and refused:
                    # A folder that was made and cannot be removed again stays.
                    found = {name: data for name, data in found.items() if data or name in before}
                assert found == (before if refused else after), where
                assert left_over(folder) == [], where
                if not failure.reached:
                    break
    assert points > (100 if SOAK else 20), points
    print(f"{kind}: {points} points")


@posix
def test_failures_in_sets_of_all_sizes(tmp_path: Path) -> None:
    """Random sets: files that are there, that are not, that are links; each operation fails."""
    chance = random.Random(11)
    points = 0
    while points < (10_000 if SOAK else 150):
        size = chance.randrange(2, 9)
        kinds = [chance.choice(["old", "new", "link"]) for _ in range(size)]
        new = [Output(f"f{k}", b"new %d" % k * chance.randrange(1, 2000)) for k in range(size)]

        def begin(folder: Path, kinds: list[str] = kinds) -> None:
            (folder / "there").mkdir(parents=True)
            for k, kind in enumerate(kinds):
                if kind == "old":
                    (folder / f"f{k}").write_bytes(b"old %d" % k)
                    (folder / f"f{k}").chmod(0o600 + k)
                elif kind == "link":
                    (folder / "there" / f"t{k}").write_bytes(b"old %d" % k)
                    (folder / f"f{k}").symlink_to(f"there/t{k}")

        base = tmp_path / f"at {points}"
        begin(base / "old")
        begin(base / "new")
        commit(base / "new", new)
        before, after = contents(base / "old"), contents(base / "new")
        code, lasting = chance.choice(CODES), chance.random() < 0.5
        number = 0
        while True:
            number += 1 if SOAK else chance.randrange(1, 6)
            folder = base / str(number)
            begin(folder)
            sets._swept.clear()
            failure = Failing(number, code, lasting)
            with failing(failure):
                try:
                    commit(folder, new)
                    refused = False
                except FileError:
                    refused = True
            points += 1
            sets._swept.clear()
            recover(folder)
            sets._swept.clear()
            recover(folder / "there")
            where = f"{kinds}, operation {number}, {errno.errorcode.get(code)}, {lasting=}"
            assert contents(folder) == (before if refused else after), where
            assert left_over(folder) == [], where
            if not failure.reached:
                break
    print(f"{points} points")


JOURNAL = """
import sys
from pathlib import Path
from moldloft.storage import journal
kept = journal.Journal(Path(sys.argv[1]), ["begin"], base="0")
print("begin", flush=True)
for k in range(1 << 40):
    kept.append([f"POINT {k} {k * k}"])
    print(k, flush=True)
"""


@posix
def test_killed_journals_keep_every_answered_line(tmp_path: Path) -> None:
    chance = random.Random(4)
    for turn in range(300 if SOAK else 5):
        path = tmp_path / f"{turn}.skj"
        command = [sys.executable, "-c", JOURNAL, str(path)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
            assert child.stdout and child.stdout.readline() == "begin\n"
            time.sleep(chance.uniform(0, 0.02))
            child.kill()
            answered = len(child.stdout.read().split("\n")) - 1
        (left,) = journal.left_behind([path])
        commands = left.commands
        assert commands == ["begin", *(f"POINT {k} {k * k}" for k in range(len(commands) - 1))]
        assert answered <= len(commands) - 1 <= answered + 1
        assert left.damaged == 0


@posix
def test_a_journal_that_cannot_be_written_keeps_what_it_had(tmp_path: Path) -> None:
    for number in range(1, 40):
        path = tmp_path / f"{number}.skj"
        kept = journal.Journal(path, ["one"])
        failure = Failing(number, errno.EIO, False)
        answered = ["one"]
        with failing(failure):
            for command in ("two", "three"):
                with contextlib.suppress(OSError):
                    kept.append([command])
                    answered.append(command)
        kept.append(["four"])
        answered.append("four")
        left = journal.read(path)
        assert left is not None
        assert [c for c in answered if c not in left.commands] == [], number
        kept.close(keep=False)


# Journals.


def test_every_cut_of_a_journal_gives_its_beginning(tmp_path: Path) -> None:
    commands = [f"POINT {k} {k * k}" for k in range(40)] + ["! a note", "é 𝄞", ""]
    path = tmp_path / "a.skj"
    kept = journal.Journal(path, commands[:3])
    for command in commands[3:]:
        kept.append([command])
    data = path.read_bytes()
    kept.close(keep=False)
    copy = tmp_path / "b.skj"
    for length in range(len(data)):
        copy.write_bytes(data[:length])
        left = journal.read(copy)
        assert (left.commands if left else []) == commands[: max(0, data[:length].count(b"\n") - 1)]
    chance = random.Random(1)
    for _ in range(400):
        # One byte differs: what comes before is read, and nothing that was never written.
        at = chance.randrange(len(data))
        copy.write_bytes(data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :])
        with contextlib.suppress(FileError):
            left = journal.read(copy)
            found = left.commands if left else []
            assert found == commands[: len(found)]
            assert left is None or len(found) + left.damaged >= len(commands) - 2
    for zeros in (1, 8, 100, 4096):
        for tail in (b"", b"\n", data[100:], b"\n" + data):
            copy.write_bytes(data + b"\0" * zeros + tail)
            left = journal.read(copy)
            assert left is not None and left.commands == commands


def test_a_journal_leaves_out_what_its_file_holds(tmp_path: Path) -> None:
    path = tmp_path / "a.skj"
    kept = journal.Journal(path, [], base="old")
    kept.append(["one"])
    kept.saving("new")
    kept.append(["two"])
    kept.close(keep=False)
    # Killed before the file was replaced, after it, and changed by somebody else.
    kept = journal.Journal(path, [], base="old")
    kept.append(["one"])
    kept.saving("new")
    kept.append(["two"])
    assert journal.read(path, "old") == journal.Left(path, ["one", "two"], False, 0, now(path))
    assert journal.read(path, "new") == journal.Left(path, ["two"], False, 0, now(path))
    assert journal.read(path, "other") == journal.Left(path, ["one", "two"], True, 0, now(path))
    kept.close(keep=False)


def now(path: Path) -> str:
    return time.strftime("%Y-%m-%d %H:%M", time.localtime(path.stat().st_mtime))


def test_a_journal_of_a_later_version_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "a.skj"
    path.write_text("! moldloft sketch journal 3 abc\n")
    with pytest.raises(FileError, match="later version of moldloft: 3"):
        journal.read(path)


def prompt(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state")}
    return subprocess.Popen(
        [sys.executable, "-m", "moldloft", "sketch", *arguments],
        cwd=folder, env=environment, text=True, bufsize=1,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip


def lines_of(path: Path, count: int) -> None:
    """Waits until a file has that many lines."""
    end = time.monotonic() + 20
    while not path.exists() or path.read_text().count("\n") < count:
        assert time.monotonic() < end, path.read_text() if path.exists() else "no file"
        time.sleep(0.02)


@posix
def test_a_second_prompt_leaves_the_journal_of_the_first(tmp_path: Path) -> None:
    (tmp_path / "a.skt").write_text("SKETCH A\n")
    with prompt(tmp_path, "a.skt", "--edit") as first:
        assert first.stdin and first.stdout
        for k in range(1, 21):
            first.stdin.write(f"POINT {k} AT {k} {k * k}\n")
        first.stdin.flush()
        lines_of(tmp_path / "a.skt.skj", 22)
        second = prompt(tmp_path, "a.skt", "--edit")
        said, _ = second.communicate("POINT 99 AT 5 5\nSAVE a.skt\nQUIT\n", timeout=60)
        assert f"it is edited by process {first.pid} " in said
        assert "cannot write `a.skt`: it is edited by" in said
        first.stdin.write("POINT 50 AT 7 7\n")
        first.stdin.flush()
        lines_of(tmp_path / "a.skt.skj", 23)
        first.kill()
    again = prompt(tmp_path, "a.skt", "--recover", "--json")
    found, _ = again.communicate("", timeout=60)
    assert "restored: 21 commands" in found
    assert (tmp_path / "a.skt").read_text() == "SKETCH A\n"


@posix
def test_a_file_that_changed_under_a_prompt_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "a.skt").write_text("SKETCH A\n")
    with prompt(tmp_path, "a.skt", "--edit") as first:
        assert first.stdin and first.stdout
        lines_of(tmp_path / "a.skt.skj", 2)
        (tmp_path / "a.skt").write_text("SKETCH B\n")
        said, _ = first.communicate("POINT 1 AT 1 1\nSAVE a.skt\nSAVE b.skt\n", timeout=60)
        assert "changed meanwhile" in said and "wrote b.skt" in said
    assert (tmp_path / "a.skt").read_text() == "SKETCH B\n"


# Watching.


def test_no_change_is_missed(tmp_path: Path) -> None:
    model, part = tmp_path / "m", tmp_path / "p"
    model.write_text("one")
    part.write_text("one")
    os.utime(part, ns=(0, 0))
    time.sleep(0.05)
    watch = Watch([str(model)])
    watch.begin()
    read = model.read_text()
    model.write_text("two")
    watch.end([str(model), str(part)])
    assert read == "one" and watch.changed()
    watch.begin()
    watch.end([str(model), str(part)])
    assert not watch.changed()
    # The same content at another time is no change; another content at the same time is one.
    status = part.stat()
    part.write_text("one")
    assert not watch.changed()
    part.write_text("two")
    os.utime(part, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert watch.changed()
    # A file that has just been found out about, and was written since the work began.
    watch = Watch([str(model)])
    watch.begin()
    part.write_text("three")
    watch.end([str(model), str(part)])
    assert watch.changed()
    # Editors remove a file for a moment.
    watch.begin()
    watch.end([str(model), str(part)])
    part.unlink()
    assert not watch.changed()
    part.write_text("three")
    assert not watch.changed()


@posix
def test_a_save_during_a_watched_build_is_built(tmp_path: Path) -> None:
    path = tmp_path / "m.sdl"
    body = "set s = set(sphere({0,0,0}, 1)); SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 7);\n"
    path.write_text(body)
    command = [sys.executable, "-m", "moldloft", "build", "m.sdl", "--watch", "--to", "sdl",
               "-o", "out"]  # fmt: skip
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as child:
        assert child.stdout
        time.sleep(0.6)
        path.write_text(body.replace("depth = 7", "depth = 4") + "AbsPoint extra(1, 2, 3);\n")
        end = time.monotonic() + 60
        while time.monotonic() < end and child.poll() is None:
            if (
                "extra" in (tmp_path / "out" / "m.sdl").read_text()
                if (tmp_path / "out" / "m.sdl").exists()
                else False
            ):
                break
            time.sleep(0.1)
        child.send_signal(signal.SIGKILL)
    assert "extra" in (tmp_path / "out" / "m.sdl").read_text()


# Kills of commands.


@posix
def test_a_killed_command_leaves_whole_files(tmp_path: Path) -> None:
    chance = random.Random(5)
    text = (SAILBOAT / "hull.sdl").read_text()
    long = text + "\n" + "".join(f"AbsPoint zz{k}(  {k},0,   0);\n" for k in range(800))
    path = tmp_path / "hull.sdl"

    def run(*arguments: str, after: float | None = None) -> float:
        begin = time.monotonic()
        command = [sys.executable, "-m", "moldloft", *arguments]
        with subprocess.Popen(
            command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as child:
            if after is not None:
                time.sleep(after)
                child.kill()
        return time.monotonic() - begin

    path.write_text(long)
    took = run("fmt", "-w", "hull.sdl")
    formatted = path.read_text()
    assert formatted != long
    for _ in range(200 if SOAK else 4):
        path.write_text(long)
        run("fmt", "-w", "hull.sdl", after=chance.uniform(0.3 * took, 1.1 * took))
        assert path.read_text() in (long, formatted)
    path.write_text(text)
    formats = ["gdf", "stl", "obj", "p3d", "svg", "sdl"]

    def build(beam: int, out: str, after: float | None = None) -> float:
        arguments = ["build", "hull.sdl", "--set", f"beam={beam}", "--to", *formats, "-o", out]
        return run(*arguments, after=after)

    took = build(10, "a")
    build(12, "b")
    wanted = [contents(tmp_path / "a"), contents(tmp_path / "b")]
    assert len(wanted[0]) >= len(formats) and wanted[0] != wanted[1]
    build(10, "out")
    for turn in range(300 if SOAK else 4):
        build(10 if turn % 2 else 12, "out", after=chance.uniform(0.5 * took, 1.1 * took))
        sets._swept.clear()
        recover(tmp_path / "out")
        assert contents(tmp_path / "out") in wanted
        assert [n for n in left_over(tmp_path / "out") if n.endswith((".part", ".old"))] == []


@posix
def test_killed_watchers_leave_whole_files(tmp_path: Path) -> None:
    """`build --watch` is killed while it builds what was saved."""
    chance = random.Random(7)
    text = (SAILBOAT / "hull.sdl").read_text()
    texts = [text.replace("beam = 10", f"beam = {beam}") for beam in (10, 12)]
    assert texts[0] != texts[1]
    path, out = tmp_path / "m.sdl", tmp_path / "out"
    # With `--watch` there is a picture, too.
    formats = ["gdf", "obj", "sdl", "png"]
    command = [sys.executable, "-m", "moldloft", "build", "m.sdl", "--to", *formats, "-o"]
    wanted = []
    for k, one in enumerate(texts):
        path.write_text(one)
        subprocess.run([*command, f"w{k}"], cwd=tmp_path, check=True, capture_output=True)
        wanted.append(contents(tmp_path / f"w{k}"))
    assert wanted[0] != wanted[1]
    for turn in range(100 if SOAK else 3):
        path.write_text(texts[turn % 2])
        with subprocess.Popen(
            [*command, "out", "--watch"], cwd=tmp_path,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        ) as child:  # fmt: skip
            # The first build of all is waited for; later ones may be killed, too.
            end = time.monotonic() + 60
            while not (out / "m.sdl").exists() and time.monotonic() < end:
                time.sleep(0.05)
            time.sleep(chance.uniform(0, 0.3))
            path.write_text(texts[1 - turn % 2])
            time.sleep(chance.uniform(0.1, 0.6))
            child.kill()
        # The next start.
        sets._swept.clear()
        recover(out)
        assert contents(out) in wanted, turn
        assert [n for n in left_over(out) if n.endswith((".part", ".old"))] == []
        assert path.read_text() == texts[1 - turn % 2]
