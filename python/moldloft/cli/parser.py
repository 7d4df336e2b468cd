"""Command line parser: argparse with suggestions, examples and short usage errors.

No abbreviations of options, negative numbers as values, the nearest name where a word is unknown,
one line for a usage error instead of the whole usage, and colours on a terminal.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterable
from typing import Any, NoReturn

from moldloft.cli.colour import painted
from moldloft.spelling import nearest

__all__ = ["Parser", "meant", "usage_error"]

#: Numbers, and numbers with commas, after a minus: values and no options.
_NEGATIVE = re.compile(r"-(\d|\.\d)[\d.,eE+:-]*$")


def meant(word: str, known: Iterable[str]) -> str:
    """The hint for an unknown word.

    >>> meant("bulid", ["build", "check"])
    '; did you mean `build`?'
    """
    near = nearest(word, known)
    return f"; did you mean `{near}`?" if near else ""


def usage_error(message: str, prog: str) -> NoReturn:
    """Prints an error about the command line and ends with status 2."""
    text = f"error: {message}\nhelp: `{prog} --help` lists the arguments"
    print(painted(text, sys.stderr), file=sys.stderr)
    raise SystemExit(2)


class _Help(argparse.RawDescriptionHelpFormatter):
    """Help in the width of the terminal, at most 100 columns, with unchanged texts."""

    def __init__(self, prog: str, **options: Any) -> None:
        import shutil

        options.setdefault("max_help_position", 28)
        options["width"] = min(shutil.get_terminal_size().columns, 100) - 2
        super().__init__(prog, **options)


class Parser(argparse.ArgumentParser):
    """A parser of arguments; see the module."""

    def __init__(self, **options: Any) -> None:
        options.setdefault("formatter_class", _Help)
        options.setdefault("allow_abbrev", False)
        super().__init__(**options)
        self._negative_number_matcher = _NEGATIVE
        self._words: list[str] = []

    def minus_is_a_value(self) -> None:
        """Treat words with one minus as values: the only one-letter option is ``-h``."""
        self._negative_number_matcher = re.compile(r"-(?!h$|-)")

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As in argparse; the error about an unknown option suggests the nearest one."""
        found, left = self.parse_known_args(args, namespace)
        if left:
            own = getattr(found, "parser", self)
            word = left[0].partition("=")[0]
            if word.startswith("-"):
                own.error(f"unknown option `{word}`{meant(word, own._option_string_actions)}")
            own.error(f"unexpected argument `{left[0]}`")
        return found

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As in argparse; stores the words for error messages."""
        self._words = list(sys.argv[1:] if args is None else args)
        return super().parse_known_args(args, namespace)

    def error(self, message: str) -> NoReturn:
        """Prints a one-line error."""
        if message.startswith("the following arguments are required"):
            # The missing argument may be present under a misspelt name.
            for word in (word.partition("=")[0] for word in self._words):
                if word.startswith("--") and word not in {*self._option_string_actions, "--"}:
                    hint = meant(word, self._option_string_actions)
                    usage_error(f"unknown option `{word}`{hint}", self.prog)
        message = re.sub(r"^argument (\S+): ", r"\1: ", message)
        found = re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)", message)
        if found:
            known = [word.strip(" '") for word in found[2].split(",")]
            hint = meant(found[1], known)
            expected = hint or f"; expected one of: {', '.join(known)}"
            message = message[: found.start()] + f"`{found[1]}` is unknown{expected}"
        usage_error(message, self.prog)

    def print_help(self, file: Any = None) -> None:
        """Help, in colours on a terminal."""
        out = file or sys.stdout
        out.write(painted(self.format_help(), out))
