"""The command ``moldloft``. Each subcommand is a module; this one finds and guards them."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, TextIO, cast

if TYPE_CHECKING:
    from argparse import Namespace

    from moldloft.cli.parser import Parser

__all__ = ["COMMANDS", "GROUPS", "main", "whole_parser"]

GROUPS = {
    "Begin": {
        "new": "write a starter model",
        "view": "open the workbench: see, edit and drag a model in the browser",
        "doc": "show the reference of entity kinds and functions",
    },
    "Models": {
        "build": "run, mesh and measure a model, and write files",
        "check": "report errors and warnings of a model",
        "eval": "print values of expressions in a model's names",
        "hydro": "hydrostatics, equilibrium, tables over drafts, righting arms",
        "render": "render a picture without a display",
        "graph": "draw the dependency graph as SVG",
        "export": "write a model as one page that opens offline",
        "study": "evaluate many variants, or find the best one",
    },
    "Texts and formats": {
        "fmt": "format as canonical text",
        "convert": "convert between programs, model files, tables of offsets and sketches",
        "formats": "print the table of file formats",
    },
    "Programs, curves and sketches": {
        "run": "run a program that prints and writes its own files",
        "repl": "interactive prompt",
        "fair": "fair points, a curve or a surface within a certified tolerance",
        "sketch": "run a sketch file, or open a sketch prompt",
    },
    "Shells and editors": {
        "completion": "print the completion script of a shell",
        "lsp": "start the language server for editors",
    },
}
"""Commands in groups, with a line about each; their modules have ``add`` and ``run``."""

COMMANDS = {name: line for group in GROUPS.values() for name, line in group.items()}
"""The commands with a line about each."""

EXAMPLES = {
    "build": """\
  moldloft build hull.sdl                               table of patches and figures
  moldloft build hull.sdl --set beam=4.2 --to gdf stl -o out
  moldloft build a.sdl b.sdl --to stl --keep-going -q   several models
  moldloft build - --to stl -o - < hull.sdl > hull.stl  from a pipe into a pipe""",
    "check": """\
  moldloft check hull.sdl
  moldloft check 'models/*.sdl' -q                      status 1 if one has an error
  cat hull.sdl | moldloft check - --json""",
    "eval": """\
  moldloft eval hull.sdl 'hull(0.5, 0.25)' 'hull.area' 'hydrostatics.volume'
  moldloft eval hull.sdl '-P21.y' --set beam=4 --json""",
    "hydro": """\
  moldloft hydro hull.sdl --draft 1.2 --density salt
  moldloft hydro hull.sdl --table 0.5,2,16 --csv table.csv --plot table.png
  moldloft hydro hull.sdl --displacement 40 --cg 0,0,1.2 --density 1 --gz -10,90,21
  moldloft hydro hull.sdl --weights --density salt --criteria""",
    "render": """\
  moldloft render hull.sdl -o hull.png --size 1600x900
  moldloft render tee.sdl --traced tee -o - > tee.png""",
    "graph": """\
  moldloft graph hull.sdl -o hull.svg
  moldloft graph hull.sdl --json""",
    "export": """\
  moldloft export --html hull.sdl -o hull.html""",
    "study": """\
  moldloft study sweep hull.toml --processes 2 --html hull.html
  moldloft study resume hull.toml --retry failed
  moldloft study optimize hull.toml
  moldloft study show hull.toml --csv cases.csv""",
    "fmt": """\
  moldloft fmt hull.sdl                                 to standard output
  moldloft fmt --check '*.sdl'                          names the files that would change
  moldloft fmt -w *.sdl""",
    "convert": """\
  moldloft convert boat.ms2 -o boat.sdl                 a MultiSurf model file
  moldloft convert offsets.csv -o hull.sdl              a table of offsets
  moldloft convert part.step -o part.sdl --units mm     CAD surfaces
  moldloft convert hull.sdl --to iges -o hull.igs""",
    "run": """\
  moldloft run missile.sdl -o out                       what the program itself writes
  moldloft run missile.sdl --to p3d vts --refine 1""",
    "repl": """\
  moldloft repl
  moldloft repl hull.sdl""",
    "doc": """\
  moldloft doc BCurve
  moldloft doc loft                                     searches names, texts and synonyms
  moldloft doc --list""",
    "new": """\
  moldloft new boat.sdl""",
    "view": """\
  moldloft view hull.sdl
  moldloft view hull.sdl --no-browser --port 8765       over SSH, with a forwarded port""",
    "sketch": """\
  moldloft sketch bracket.skt --set width=30
  moldloft sketch""",
    "completion": """\
  moldloft completion bash > ~/.local/share/bash-completion/completions/moldloft
  moldloft completion zsh > "${fpath[1]}/_moldloft"
  moldloft completion fish > ~/.config/fish/completions/moldloft.fish""",
}
"""Examples at the end of each command's help."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; exit status 0: success, 1: errors in the model, 2: usage error."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    traced = "--traceback" in arguments
    arguments = [word for word in arguments if word != "--traceback"]
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal that has no letter for something shows its number.
            stream.reconfigure(errors="backslashreplace")
    before, streams = warnings.showwarning, (sys.stdout, sys.stderr)
    try:
        warnings.showwarning = _show_warning
        sys.stdout, sys.stderr = _shown_streams()
        status = _run(arguments)
        sys.stdout.flush()
    except KeyboardInterrupt:
        # Work that was abandoned must not hold up the end.
        _leave(130)
    except BrokenPipeError:
        # The reader has gone (`moldloft doc --list | head`).
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        where = f"`{error.filename}`: " if error.filename else ""
        print(f"error: {where}{(error.strerror or str(error)).lower()}", file=sys.stderr)
        return 1
    except MemoryError:
        print("error: there is not enough memory for this model", file=sys.stderr)
        return 1
    except Exception as error:
        if traced:
            raise
        print(_unexpected(error, arguments), file=sys.stderr)
        return 1
    finally:
        warnings.showwarning = before
        sys.stdout, sys.stderr = streams
    return status


def _shown_streams() -> tuple[TextIO, TextIO]:
    """Standard output and error that are safe for untrusted text."""
    from moldloft.cli.shown import ShownStream

    return cast("TextIO", ShownStream(sys.stdout)), cast("TextIO", ShownStream(sys.stderr))


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Shows a warning without its position in Python code, which is irrelevant in a command."""
    from moldloft.cli.colour import painted

    stream = file or sys.stderr
    if category is UserWarning:
        print(painted(str(message), stream), file=stream)
    else:
        stream.write(warnings.formatwarning(message, category, filename, lineno, line))


def _unexpected(error: Exception, arguments: Sequence[str]) -> str:
    """One line about an internal error, or about an argument that is not valid text."""
    wrong = [word for word in arguments if not word.isascii() and _has_surrogates(word)]
    if isinstance(error, UnicodeEncodeError) and wrong:
        return f"error: the argument {wrong[0]!a} is not UTF-8 text"
    text = " ".join(str(error).split()) or "no message"
    return (
        f"error: internal fault: {type(error).__name__}: {text[:300]}; please report it at "
        "https://github.com/moldloft/moldloft/issues (`--traceback` shows where it is)"
    )


def _has_surrogates(word: str) -> bool:
    return any("\ud800" <= letter <= "\udfff" for letter in word)


def _run(arguments: list[str]) -> int:
    if arguments[:1] in (["--version"], ["-V"]):
        from moldloft import __version__

        print(f"moldloft {__version__}")
        return 0
    from moldloft.cli.colour import choose, painted
    from moldloft.errors import Error

    try:
        options = _parsed(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    choose(options.color)
    for given in options.limit:
        from moldloft.budget import limits

        limits(**given)
    try:
        status: int = options.run(options)
    except Error as error:
        print(painted(error.rendered, sys.stderr), file=sys.stderr)
        return 1
    return status


#: Options of all commands, with their numbers of values; they are accepted before the command.
_COMMON = {"--color": 1, "--limit": 1, "--traceback": 0}


def _command_first(arguments: list[str]) -> list[str]:
    """The words with common options moved behind the command.

    >>> _command_first(["--color", "never", "--traceback", "check", "a.sdl"])
    ['check', '--color', 'never', '--traceback', 'a.sdl']
    """
    rest = list(arguments)
    moved: list[str] = []
    while rest and (name := rest[0].partition("=")[0]) in _COMMON:
        words = 1 if "=" in rest[0] else 1 + _COMMON[name]
        if len(rest) < words:
            return arguments
        moved += rest[:words]
        rest = rest[words:]
    if not rest:
        return []
    if rest[0].startswith("-"):
        return arguments
    return [rest[0], *moved, *rest[1:]]


def _parsed(arguments: list[str]) -> Namespace:
    from moldloft.cli.parser import meant, usage_error

    arguments = _command_first(arguments) or ["--help"]
    word = next((a for a in arguments if not a.startswith("-")), None)
    if word is not None and word not in COMMANDS:
        usage_error(f"unknown command `{word}`{meant(word, COMMANDS)}", "moldloft")
    if word is None and not {"-h", "--help"} & set(arguments):
        usage_error("no command was given", "moldloft")
    found: Namespace = whole_parser([] if word is None else [word]).parse_args(arguments)
    return found


def whole_parser(loaded: Sequence[str]) -> Parser:
    """The parser of all commands, with the arguments of those that are ``loaded``."""
    import shutil
    from textwrap import wrap

    from moldloft.cli.parser import Parser

    width = max(min(shutil.get_terminal_size().columns, 100) - 14, 20)
    lines = []
    for title, group in GROUPS.items():
        lines.append(f"{title}:")
        for name, line in group.items():
            first, *more = wrap(line, width)
            lines += [f"  {name:<12}{first}", *(" " * 14 + text for text in more)]
        lines.append("")
    parser = Parser(
        prog="moldloft",
        usage="moldloft COMMAND [arguments]",
        description="Describe a shape, relate its parts, panel it, measure it.\n\nTo start: "
        "`moldloft new hull.sdl`, then `moldloft view hull.sdl`.",
        epilog="\n".join(lines) + "\n`moldloft COMMAND --help` describes each, with examples.\n"
        "--color, --limit and --traceback can precede the command.",
    )
    parser.add_argument("-V", "--version", action="store_true", help="print the version")
    commands = parser.add_subparsers(
        prog="moldloft", metavar="COMMAND", required=True, parser_class=Parser
    )
    # The epilog lists the commands in groups.
    commands.help = "see below"
    for name, line in COMMANDS.items():
        command = commands.add_parser(name, description=line[0].upper() + line[1:] + ".")
        if name not in loaded:
            continue
        if name in EXAMPLES:
            command.epilog = f"Examples:\n{EXAMPLES[name]}"
        module = import_module(f"moldloft.cli.{name}")
        module.add(command)
        command.add_argument(
            "--color",
            choices=["auto", "always", "never"],
            default="auto",
            help="colours of messages; default: on a terminal, unless NO_COLOR is set",
        )
        command.add_argument(
            "--limit",
            metavar="NAME=VALUE",
            type=_limit,
            action="append",
            default=[],
            help="limit of a run: memory=2G, steps=N, objects=N or seconds=S; repeatable",
        )
        command.add_argument(
            "--traceback", action="store_true", help="show the traceback of an internal fault"
        )
        command.set_defaults(run=module.run, parser=command)
    return parser


def _limit(text: str) -> dict[str, str | int | float]:
    from argparse import ArgumentTypeError

    from moldloft.budget import parsed
    from moldloft.errors import Error

    try:
        return parsed(text)
    except Error as error:
        raise ArgumentTypeError(str(error)) from None


def _leave(status: int) -> None:
    with contextlib.suppress(OSError, ValueError):
        sys.stdout.flush()
    os._exit(status)
