"""``moldloft repl``: interactive prompt.

The lines are a program that is run again at each of them: only what changed is computed. A line
with errors is reported and skipped.
"""

from __future__ import annotations

import argparse
import contextlib
import sys
from collections.abc import Callable
from typing import Any

from moldloft.cli.eval import as_text
from moldloft.errors import Error, ModelError
from moldloft.loading import load, loads
from moldloft.models import Model

__all__ = ["Session", "add", "run"]

_MOST_ITEMS = 8
_HELP = """\
A statement (curve c[5];), a call (arc(c, 0, PI, 1);) or an expression (c[5].x).
Blocks go on over lines until their brackets close.
:vars      the variables and their shapes
:text      the program so far
:undo      takes back the last line
:save FILE writes the program
:quit      ends (so do exit, quit and Ctrl-D)"""
_ENDS = {":quit", ":q", "exit", "quit", "exit()", "quit()"}


class Session:
    """A program that grows line by line.

    Examples
    --------
    >>> session = Session()
    >>> session.run("curve c[3]; c[3] = {2, 4, 0};")
    []
    >>> session.run("c[3]/2")
    ['{1, 2, 0}']
    >>> session.run("print c.d1, 7")
    ['3 7']
    """

    def __init__(self, model: Model | None = None) -> None:
        self.model = model or loads("", name="session.sdl")
        self._before: list[str] = []

    def run(self, entry: str) -> list[str]:
        """The output lines of an entry.

        Raises
        ------
        Error
            If it has errors; it is then omitted.
        """
        if not entry.strip():
            return []
        model = self.model
        expression = entry.strip().rstrip(";")
        try:
            return [shown(model.eval(expression))]
        except Error as error:
            if _is_expression(expression, error):
                raise
        text = model.text
        printed = len(model.printed)
        start = text if not text or text.endswith("\n") else text + "\n"
        # A statement is closed for whoever forgot it.
        closed = entry.rstrip()
        closed = closed if closed.endswith((";", "}")) else closed + ";"
        known = {(d.id, d.message) for d in model.diagnostics}
        try:
            model.text = start + closed + "\n"
            # A brace ends a block, or a value of a statement that is open still.
            if closed.endswith("}") and "missing-semicolon" in {d.id for d in model.diagnostics}:
                model.text = start + closed + ";\n"
        except KeyboardInterrupt:
            model.text = text
            raise
        if model.has_errors:
            diagnostics = model.diagnostics
            new = [d for d in diagnostics if (d.id, d.message) not in known]
            reported = "\n".join(str(d) for d in new or diagnostics)
            model.text = text
            raise ModelError(reported, new or diagnostics)
        self._before.append(text)
        new = [d for d in model.diagnostics if (d.id, d.message) not in known]
        return model.printed[printed:] + [str(d).rstrip() for d in new]

    def undo(self) -> bool:
        """Removes the last entry; false if there is no entry."""
        if not self._before:
            return False
        self.model.text = self._before.pop()
        return True

    def names(self) -> set[str]:
        """The names of the variables."""
        return set(self.model.types)

    def variables(self) -> list[str]:
        """A line for each variable."""
        return [f"{name}: {shape}" for name, shape in self.model.types.items()]


def _is_expression(text: str, error: Error) -> bool:
    """True if the text is meant as an expression, so that its error is the one to show."""
    ids = {d.id for d in getattr(error, "diagnostics", [])}
    syntax = {"unexpected-token", "missing-semicolon", "unclosed-bracket", "not-a-value"}
    words = text.replace("(", " ").split()
    if not words or ids & syntax or "=" in text.replace("==", "").replace("<=", ""):
        return False
    return not ids & {"no-value", "misplaced-assignment"}


def shown(value: Any) -> str:
    """The value in at most a few lines.

    >>> import numpy as np
    >>> shown(np.arange(100.0))
    '{0, 1, 2, 3, 4, 5, 6, 7, ...} farray[100]'
    """
    shape: tuple[int, ...] = tuple(getattr(value, "shape", ()))
    if len(shape) == 1 and shape[0] > _MOST_ITEMS:
        return as_text(value[:_MOST_ITEMS])[:-1] + f", ...}} farray[{shape[0]}]"
    if len(shape) == 2 and shape[1] == 3 and shape[0] > _MOST_ITEMS:
        return as_text(value[:_MOST_ITEMS])[:-1] + f", ...}} curve[{shape[0]}]"
    if len(shape) == 3 and shape[0] * shape[1] > _MOST_ITEMS:
        flat = value.reshape(-1, 3)[:_MOST_ITEMS]
        return as_text(flat)[:-1] + f", ...}} surface[{shape[0]},{shape[1]}]"
    return as_text(value)


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument("program", metavar="PROGRAM", nargs="?", help="a program to load first")
    parser.add_argument(
        "--library", metavar="DIR", action="append", default=[], help="a folder to load from"
    )


def run(options: argparse.Namespace) -> int:
    """Reads, runs and shows until the end of the input."""
    if options.program:
        model = load(options.program, library=options.library, strict=False)
    else:
        model = loads("", name="session.sdl", library=options.library)
    session = Session(model)
    terminal = sys.stdin.isatty()
    failed = False
    for diagnostic in model.diagnostics:
        print(str(diagnostic), file=sys.stderr)
    with _editor(session) if terminal else contextlib.nullcontext(input) as ask:
        if terminal:
            print("moldloft repl: help lists the commands, exit ends", file=sys.stderr)
        while True:
            try:
                entry = _read(ask if terminal else None)
            except EOFError:
                break
            except KeyboardInterrupt:
                print(file=sys.stderr)
                continue
            # A program may have a variable of such a name.
            word = entry.strip().rstrip(";").strip()
            if word in _ENDS and word not in session.names():
                break
            if word in ("help", "?") and word not in session.names():
                entry = ":help"
            try:
                lines = _command(session, entry.strip())
                for line in session.run(entry) if lines is None else lines:
                    print(line)
            except Error as error:
                failed = True
                print(error.rendered, file=sys.stderr)
            except KeyboardInterrupt:
                if not terminal:
                    raise
                print("\ninterrupted: the entry is discarded", file=sys.stderr)
    return 1 if failed and not terminal else 0


def _command(session: Session, entry: str) -> list[str] | None:
    if not entry.startswith(":"):
        return None
    word, _, rest = entry.partition(" ")
    if word in (":help", ":h"):
        return _HELP.splitlines()
    if word == ":vars":
        return session.variables()
    if word == ":text":
        return session.model.text.splitlines()
    if word == ":undo":
        return [] if session.undo() else ["nothing to undo"]
    if word == ":save" and rest.strip():
        from pathlib import Path

        from moldloft.exchange.files import Output, commit

        path = Path(rest.strip())
        commit(path.parent, [Output(path.name, session.model.text.encode())])
        return [f"wrote {path}"]
    raise Error(f"unknown command `{word}`; help lists the commands")


def _editor(session: Session) -> contextlib.AbstractContextManager[Callable[[str], str]]:
    from moldloft.cli.editor import line_editor
    from moldloft.storage.journal import state_folder

    def keywords() -> set[str]:
        from moldloft.language import keywords as words
        from moldloft.language import reference, statements

        return {row["name"] for row in [*reference(), *statements()]} | set(words())

    return line_editor(
        state_folder().with_name("repl-history"),
        session.model.completions,
        keywords=keywords,
        delimiters=' \t\n()[]{},;=+-*/^|&<>!.:"',
    )


def _read(ask: Callable[[str], str] | None) -> str:
    """An entry: lines until all brackets are closed."""
    entry = ""
    while True:
        if ask is not None:
            line = ask("... " if entry else "> ")
        else:
            line = sys.stdin.readline()
            if not line:
                if entry:
                    return entry
                raise EOFError
            line = line.rstrip("\r\n")
        entry += line + "\n"
        if _open_brackets(entry) <= 0:
            return entry


def _open_brackets(text: str) -> int:
    """Number of open brackets at the end of a text.

    >>> _open_brackets("for (i = 1:3) {"), _open_brackets('print "{"; # (')
    (1, 0)
    """
    depth = 0
    for line in text.splitlines():
        quoted = False
        previous = ""
        for c in line:
            if c == '"' and previous != "\\":
                quoted = not quoted
            elif not quoted:
                if c == "#":
                    break
                depth += (c in "([{") - (c in ")]}")
            previous = c
    return depth
