"""``moldloft sketch``: run a sketch file, or open a prompt."""

from __future__ import annotations

import argparse
import contextlib
import json
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.cli.console import add_force, print_json
from moldloft.errors import Error, FileError

if TYPE_CHECKING:
    from moldloft.shapes.sketches import Reply, Sketch
    from moldloft.storage.journal import Journal, Left

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.description = (
        "Runs a sketch file, or opens a sketch prompt. Without FILE, commands are read from "
        "standard input: a prompt with history and "
        "completion on a terminal. HELP lists the commands, HELP VERB explains one."
    )
    parser.add_argument(
        "file", metavar="FILE", nargs="?", help="a file of commands (.skt), or a sketch as JSON"
    )
    parser.add_argument(
        "--set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="a dimension or variable of the last object, after FILE was run; repeatable",
    )
    parser.add_argument("--json", action="store_true", help="the objects as data, and the replies")
    parser.add_argument("--edit", action="store_true", help="open the prompt after running FILE")
    parser.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        default=".",
        help="folder for SAVE and EXPORT; default: the current one",
    )
    parser.add_argument(
        "-q", "--quiet", action="store_true", help="only warnings and errors of the commands"
    )
    add_force(parser)
    restore = parser.add_mutually_exclusive_group()
    restore.add_argument("--recover", action="store_true", help="resume an unsaved session")
    restore.add_argument(
        "--discard", action="store_true", help="delete unsaved sessions, then start"
    )


def run(options: argparse.Namespace) -> int:
    """Runs the file, the prompt, or both."""
    from moldloft.shapes.sketches import Sketch

    if options.recover and options.file and not options.edit:
        options.edit = True
    sketch = Sketch(Path(options.file).parent if options.file else None)
    host = Host(sketch, options)
    if options.file:
        host.run_file(Path(options.file))
    for assignment in options.set:
        name, _, value = assignment.partition("=")
        host.run_line(f'SET {name.strip()} "{value.strip()}"')
    if options.edit or not options.file:
        host.prompt()
    if options.json:
        data = json.loads(sketch.session.objects_json())
        data["ok"] = not host.refused
        data["replies"] = [reply.to_dict() for reply in host.replies]
        print_json(data)
    return 1 if host.refused else 0


class Host:
    """The host of a session: shows replies, writes files, records changes."""

    def __init__(self, sketch: Sketch, options: argparse.Namespace) -> None:
        self.sketch = sketch
        self.session = sketch.session
        self.options = options
        self.refused = False
        self.replies: list[Reply] = []
        self.journal: Journal | None = None
        self.recorded = 0
        #: Whether the file that is edited was just written, with everything in it.
        self.rewritten = False
        #: Length of the session's journal when everything was last saved.
        self.saved = 0
        #: Digest of the file that is edited, as it was read or written last.
        self.present: str | None = None
        #: Why the file that is edited may not be written: another prompt has it.
        self.busy = ""
        #: Whether the lines that run were typed here, not read from a file.
        self.typed = True
        #: Files that this session wrote.
        self.own_files: set[Path] = set()

    # -- running -----------------------------------------------------------------------------

    def run_file(self, path: Path) -> None:
        """Runs all lines of a file."""
        from moldloft.storage import digest, read_bytes, utf8_path

        utf8_path(path)
        data = read_bytes(path)
        self.present = digest(data)
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise FileError(f"cannot read `{path}`: it is not UTF-8 text") from error
        if "\0" in text:
            raise FileError(f"cannot read `{path}`: it is not a text file")
        # Its lines are somebody else's: they read and write inside of their folders.
        self._trust(False)
        if text.lstrip().startswith(("[", "{")):
            self.run_line(f'INPUT "{path.name}"', where=str(path))
        else:
            for number, line in enumerate(text.splitlines(), 1):
                self.run_line(line, where=f"{path}:{number}")
                if self.session.over():
                    break
        self._trust(True)
        self.saved = self.recorded = self.session.journal_length()

    def _trust(self, typed: bool) -> None:
        self.typed = typed
        self.session.confine(not typed)

    def run_line(self, line: str, where: str = "") -> None:
        """Runs a line, shows its replies and writes its files."""
        from moldloft.shapes.sketches import Reply

        typed = self.typed
        # What a file that is read in asks for is not asked for here.
        self.typed = typed and not re.search(r"(?:^|;)\s*(?:INPUT|RUN)\b", line, re.I)

        answers = self.session.run_line(line)
        # On the disk before it is answered: what was answered is never lost.
        length = self.session.journal_length()
        if self.journal is not None and length != self.recorded:
            self.journal.append(self.session.journal(self.recorded))
        self.recorded = length
        for row in answers:
            reply = Reply.from_row(row)
            self.replies.append(reply)
            if reply.file is not None:
                reply = self._write(reply, reply.file)
            self._show(reply, where)
        if self.journal is not None and self.rewritten:
            # The file holds everything now: running it and then the old journal would do it twice.
            self.journal.saved(self.present or "")
        self.rewritten = False
        self.typed = typed

    def _write(self, reply: Reply, file: tuple[str, bytes]) -> Reply:
        from moldloft.shapes.sketches import Reply

        path = Path(self.options.output, file[0])
        try:
            self._write_file(file[0], path, file[1])
        except Error as error:
            text = str(error)
            return Reply("error", text, "choose another name or folder", 600)
        return Reply("note", f"wrote {path} ({len(file[1])} bytes)")

    def _write_file(self, name: str, path: Path, data: bytes) -> None:
        from moldloft.exchange.files import Output, commit
        from moldloft.permissions import write_outputs
        from moldloft.storage import digest, put

        if not self.typed:
            sources = [self.options.file] if self.options.file else []
            output, force = Path(self.options.output), self.options.force
            write_outputs(output, {name: data}, sources=sources, force=force)
            return
        own = self.options.file is not None and path.resolve() == Path(self.options.file).resolve()
        whole = path.suffix.lower() == ".json" or data == self.session.text(None).encode()
        if not own:
            self._ask_to_overwrite(path)
            commit(path.parent, [Output(path.name, data)])
            self.own_files.add(path.resolve())
        elif self.busy:
            raise FileError(f"cannot write `{path}`: {self.busy}")
        else:
            # One in the state folder is resumed without the file: it keeps everything.
            holds = whole and self.journal is not None and self.journal.beside_file
            if self.journal is not None and holds:
                self.journal.saving(digest(data))
            put(path, data, expected=self.present)
            self.present = digest(data)
            self.rewritten = holds
        if path.suffix.lower() in (".skt", ".json") and whole:
            self.saved = self.session.journal_length()

    def _ask_to_overwrite(self, path: Path) -> None:
        """Asks on a terminal before a file of another origin is overwritten."""
        known = self.options.force or path.resolve() in self.own_files
        if known or not path.exists() or not sys.stdin.isatty():
            return
        with contextlib.suppress(EOFError):
            if input(f"`{path}` is there; overwrite it? [y/N] ").strip().lower() in ("y", "yes"):
                return
        raise FileError(f"`{path}` is left as it is")

    def _show(self, reply: Reply, where: str) -> None:
        self.refused |= reply.is_error
        text = str(reply)
        if reply.severity != "note":
            print(f"{where}: {text}" if where else text, file=sys.stderr, flush=True)
        elif not self.options.json and not self.options.quiet:
            print(text, flush=True)

    # -- the prompt --------------------------------------------------------------------------

    def prompt(self) -> None:
        """Reads commands until QUIT or the end of the input."""
        terminal = sys.stdin.isatty()
        self._begin(terminal)
        assert self.journal is not None
        with _editor(self.sketch) if terminal else contextlib.nullcontext(input) as ask:
            if terminal:
                print("moldloft sketch: HELP lists the commands, QUIT ends", file=sys.stderr)
            while not self.session.over():
                try:
                    line = self._read(ask if terminal else None)
                except EOFError:
                    break
                except KeyboardInterrupt:
                    # The line is dropped, as in a shell.
                    print(file=sys.stderr)
                    continue
                self.run_line(line)
        unsaved = self.session.journal_length() > self.saved
        self.journal.close(keep=unsaved)
        if unsaved and not self.options.json:
            again = _again(self.options.file if self.journal.path.exists() else None)
            print(f"not saved: `{again}` resumes it; SAVE writes a file", file=sys.stderr)

    def _read(self, ask: Callable[[str], str] | None) -> str:
        if ask is not None:
            name = self.session.active() or "sketch"
            mark = "&" if self.session.begun() else "?" if self.session.asks() else ">"
            return ask(f"{name}{mark} ")
        line = sys.stdin.readline()
        if not line:
            raise EOFError
        return line.rstrip("\r\n")

    def _begin(self, terminal: bool) -> None:
        """Opens the journal, after recovery of an earlier session."""
        from moldloft.storage import BusyError, Lock, recover
        from moldloft.storage.journal import (
            ENDING,
            Journal,
            beside,
            ended,
            left_behind,
            lock,
            state_folder,
        )

        own = beside(Path(self.options.file)) if self.options.file else None
        held: Lock | None = None
        if own:
            recover(own.resolve().parent)
            try:
                # First of all: what another prompt keeps is neither read nor written.
                held = lock(own)
            except BusyError as busy:
                self.busy = f"it is edited by {busy.owner or 'another process'}"
                print(f"warning: {own.name[: -len(ENDING)]}: {self.busy}; SAVE under another name",
                      file=sys.stderr)  # fmt: skip
                own = None
            except OSError:
                # The folder cannot be written: the journal is among those without a file.
                own = None
        folder = state_folder()
        others = sorted(folder.glob(f"*{ENDING}")) if folder.is_dir() else []
        alone = not self.options.file
        if own and held:
            left = left_behind([own], self.present, held)
        else:
            left = left_behind([path for path in others if not ended(path)]) if alone else []
        if self.options.recover and not left and alone:
            left = left_behind([path for path in others if ended(path)])
        taken: Left | None = None
        if self.options.discard:
            for one in left:
                one.path.unlink(missing_ok=True)
        elif left and (self.options.recover or (terminal and self._wanted(left[0]))):
            taken = left[0]
        elif left:
            print(_offer(left[0], self.options.file), file=sys.stderr)
        elif self.options.recover:
            raise Error("no unsaved session to resume")
        if taken is not None:
            commands = taken.commands
            before = self.refused
            if taken.stale:
                print(f"warning: {self.options.file} was changed by another program since",
                      file=sys.stderr)  # fmt: skip
            if taken.damaged:
                print(f"warning: {taken.damaged} lines of {taken.path} are damaged",
                      file=sys.stderr)  # fmt: skip
            for command in commands:
                self.run_line(command)
            # Refused commands were not recorded; only a missing file can be refused now.
            self.refused = before
            text = f"restored: {len(commands)} commands of {taken.when}"
            print(text, file=sys.stderr)
        try:
            if own and held and (taken is not None or not left):
                present = self.session.journal(self.saved)
                self.journal = Journal(own, present, base=self.present, held=held)
            else:
                if held:
                    held.release()
                # By itself it must be enough.
                self.journal = Journal.in_state_folder(self.session.journal(0))
        except OSError as error:
            where = own or folder
            reason = (error.strerror or str(error)).lower()
            raise FileError(f"cannot keep a journal in `{where}`: {reason}") from error
        if taken is not None and taken.path != self.journal.path:
            taken.path.unlink(missing_ok=True)

    def _wanted(self, left: Left) -> bool:
        question = f"an unsaved session of {left.when} with {len(left.commands)} commands was found"
        with contextlib.suppress(EOFError):
            return input(f"{question}; go on with it? [Y/n] ").strip().lower() in ("", "y", "yes")
        return False


def _again(file: str | None) -> str:
    return f"moldloft sketch {file} --recover" if file else "moldloft sketch --recover"


def _offer(left: Left, file: str | None) -> str:
    again = _again(file)
    forget = again.replace("--recover", "--discard")
    return (
        f"an unsaved session of {left.when} with {len(left.commands)} commands was found: "
        f"`{again}` resumes it, `{forget}` deletes it"
    )


def _editor(sketch: Sketch) -> contextlib.AbstractContextManager[Callable[[str], str]]:
    from moldloft.cli.editor import line_editor
    from moldloft.storage.journal import state_folder

    return line_editor(
        state_folder() / "history", sketch.session.complete, delimiters=" ,=;", after=" "
    )
