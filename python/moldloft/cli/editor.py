"""The line editor of prompts: history, completion and highlighting.

With ``prompt_toolkit`` (``pip install 'moldloft[prompt]'``) the line is highlighted while it is
typed and completions show below it; without it the platform's ``readline`` serves, where it is.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

__all__ = ["line_editor"]

Read = Callable[[str], str]
"""Reads a line after a prompt; raises ``EOFError`` at the end and ``KeyboardInterrupt``."""

_HISTORY_LENGTH = 2000

#: Where the word begins that is being completed.
_WORD = re.compile(r"[A-Za-z_0-9.]*$")

#: Parts of a line with the style that each has.
_PARTS = re.compile(
    r"(?P<comment>#.*|^\s*!.*)|(?P<string>\"(?:[^\"\\]|\\.)*\"?)"
    r"|(?P<number>(?<![A-Za-z_])\d+\.?\d*(?:[eE][-+]?\d+)?)|(?P<command>^:\w+)"
    r"|(?P<word>[A-Za-z_]\w*)"
)
_STYLES = {
    "comment": "#808080 italic",
    "string": "#2e8b57",
    "number": "#b8860b",
    "command": "bold",
    "keyword": "#4169e1",
}


@contextlib.contextmanager
def line_editor(
    history: Path,
    complete: Callable[[str], list[str]],
    *,
    keywords: Callable[[], set[str]] = set,
    delimiters: str,
    after: str = "",
) -> Iterator[Read]:
    """A function that reads lines on a terminal.

    Parameters
    ----------
    history
        The file that remembers lines between sessions.
    complete
        The words that may replace the last one of a line.
    keywords
        Words to highlight.
    delimiters
        Word separators for ``readline``.
    after
        Character after a completed word.
    """
    with contextlib.suppress(OSError):
        history.parent.mkdir(parents=True, exist_ok=True)
    try:
        import prompt_toolkit
    except ImportError:
        with _readline(history, complete, delimiters, after):
            yield input
        return
    del prompt_toolkit
    yield _toolkit(history, complete, keywords, after)


def highlighted(line: str, keywords: set[str]) -> list[tuple[str, str]]:
    """The parts of a line with their styles.

    >>> highlighted("Line l(A)  # edge", {"Line"})
    [('#4169e1', 'Line'), ('', ' l(A)  '), ('#808080 italic', '# edge')]
    """
    parts: list[tuple[str, str]] = []

    def add(style: str, text: str) -> None:
        if text and parts and parts[-1][0] == style:
            parts[-1] = (style, parts[-1][1] + text)
        elif text:
            parts.append((style, text))

    end = 0
    for found in _PARTS.finditer(line):
        add("", line[end : found.start()])
        kind = found.lastgroup or ""
        if kind == "word":
            kind = "keyword" if found[0] in keywords else ""
        add(_STYLES.get(kind, ""), found[0])
        end = found.end()
    add("", line[end:])
    return parts


def _toolkit(
    history: Path,
    complete: Callable[[str], list[str]],
    keywords: Callable[[], set[str]],
    after: str,
) -> Read:
    from prompt_toolkit import PromptSession
    from prompt_toolkit.completion import Completer, Completion
    from prompt_toolkit.history import FileHistory, InMemoryHistory
    from prompt_toolkit.lexers import Lexer

    known = keywords()

    class Words(Completer):
        def get_completions(self, document: Any, event: Any) -> Iterator[Completion]:
            line = document.text_before_cursor
            found = _WORD.search(line)
            typed = found[0] if found else ""
            for word in complete(line):
                # A member is completed after its dot.
                start = typed if word.lower().startswith(typed.lower()) else typed.split(".")[-1]
                yield Completion(word + after, start_position=-len(start), display=word)

    class Parts(Lexer):
        def lex_document(self, document: Any) -> Callable[[int], Any]:
            return lambda number: highlighted(document.lines[number], known)

    remembered: Any = InMemoryHistory()
    with contextlib.suppress(OSError):
        history.touch()
        # Its own file: the form is not that of readline.
        remembered = FileHistory(str(history.with_name(history.name + ".lines")))
    session: PromptSession[str] = PromptSession(
        history=remembered,
        completer=Words(),
        lexer=Parts(),
        complete_while_typing=False,
    )
    return session.prompt


@contextlib.contextmanager
def _readline(
    history: Path, complete: Callable[[str], list[str]], delimiters: str, after: str
) -> Iterator[None]:
    """History and completion, where the platform has them."""
    try:
        import readline
    except ImportError:
        yield
        return
    with contextlib.suppress(OSError):
        readline.read_history_file(history)
    readline.set_history_length(_HISTORY_LENGTH)

    def word(_: str, number: int) -> str | None:
        found = complete(readline.get_line_buffer()[: readline.get_endidx()])
        return found[number] + after if number < len(found) else None

    readline.set_completer_delims(delimiters)
    readline.set_completer(word)
    readline.parse_and_bind("tab: complete")
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            readline.write_history_file(history)
