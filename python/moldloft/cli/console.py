"""Common parts of the commands: models from arguments, diagnostics, JSON, progress."""

from __future__ import annotations

import argparse
import json
import math
import shutil
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from moldloft.cli.shown import STEERING, OwnText, shown

if TYPE_CHECKING:
    from moldloft import Diagnostic
    from moldloft.models import Model

__all__ = [
    "Progress",
    "add_force",
    "add_model",
    "add_name",
    "add_quiet",
    "assignment",
    "block_problems",
    "each_model",
    "emit",
    "expanded",
    "format_argument",
    "open_model",
    "print_json",
    "put_text",
    "report",
    "say",
    "stem_of",
    "water",
]


def assignment(text: str) -> tuple[str, float]:
    """Name and number from a text ``name=number``."""
    name, equals, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not equals or not name.strip() or not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"`{text}` is not of the form name=number")
    return name.strip(), number


def add_model(
    parser: argparse.ArgumentParser,
    *,
    several: bool = False,
    piped: bool = True,
    values: bool = True,
    refined: bool = True,
    foreign: bool = True,
) -> None:
    """Add the arguments of a command that runs one model, or ``several``.

    Without ``piped`` only files are accepted; without ``values`` there is no ``--set``, without
    ``refined`` no ``--refine``, without ``foreign`` no ``--file-units``.
    """
    parser.add_argument(
        "models" if several else "model",
        metavar="MODEL",
        nargs="+" if several else None,
        help="an .sdl program, an .ms2 model file or a .skt sketch"
        + ("; - reads standard input" if piped else "")
        + ("; several, and quoted patterns such as 'hulls/*.sdl'" if several else ""),
    )
    if values:
        parser.add_argument(
            "--set",
            metavar="NAME=NUMBER",
            type=assignment,
            action="append",
            default=[],
            help="a parameter, or a literal of an object such as P21.y; repeatable",
        )
    parser.add_argument(
        "--library",
        metavar="DIR",
        action="append",
        default=[],
        help="additional folder for `load`; repeatable",
    )
    if foreign:
        parser.add_argument(
            "--file-units",
            choices=["m", "cm", "mm", "ft", "in"],
            help="of mesh files: the unit of their numbers; default: the one that the file states",
        )
    if refined:
        parser.add_argument(
            "--refine",
            metavar="LEVEL",
            type=int,
            default=0,
            help="refinement level: each level halves the spacing of refined() sizes; default 0",
        )


def add_quiet(parser: argparse.ArgumentParser) -> None:
    """The option that suppresses messages about success."""
    parser.add_argument(
        "-q", "--quiet", action="store_true", help="only errors, warnings and remarks"
    )


def add_force(parser: argparse._ActionsContainer) -> None:
    """The option that overwrites files of unknown origin."""
    parser.add_argument(
        "--force",
        action="store_true",
        help="overwrite files that an earlier run did not write, and sources",
    )


def say(options: argparse.Namespace, text: str) -> None:
    """Prints a message about success; to standard error if a file is on standard output."""
    if not getattr(options, "quiet", False):
        out = sys.stderr if getattr(options, "output", None) == "-" else sys.stdout
        print(text, file=out)


def expanded(words: list[str]) -> list[str]:
    """Expand words to file names: a pattern stands for the files that match it, in order.

    Raises
    ------
    Error
        If nothing matches a pattern.
    """
    from glob import glob

    from moldloft.errors import Error

    found: list[str] = []
    for word in words:
        if any(c in word for c in "*?[") and not Path(word).exists():
            matches = sorted(glob(word, recursive=True))  # noqa: PTH207 (patterns may be absolute)
            if not matches:
                raise Error(f"no file matches `{word}`")
            found += matches
        else:
            found.append(word)
    return list(dict.fromkeys(found))


def each_model(
    options: argparse.Namespace, one: Callable[[argparse.Namespace], tuple[int, Any]]
) -> int:
    """Runs a command for each of its models; the worst status, and with ``--json`` their data.

    The data are an object for one model, a list of objects for several.
    """
    from moldloft.cli.colour import painted
    from moldloft.errors import Error

    names = expanded(options.models)
    if len(names) > 1 and getattr(options, "name", None) is not None:
        raise Error("--name takes one model: several would have the same files")
    if len(names) > 1 and getattr(options, "output", None) == "-":
        raise Error("standard output takes one model: give a folder with -o")
    worst, collected = 0, []
    for name in names:
        options.model = name
        try:
            status, data = one(options)
        except Error as error:
            if len(names) == 1:
                raise
            print(painted(error.rendered, sys.stderr), file=sys.stderr)
            status, data = 1, {"ok": False, "error": str(error)}
        worst = max(worst, status)
        collected.append(data if len(names) == 1 else {"model": name, **(data or {})})
    if getattr(options, "json", False):
        print_json(collected[0] if len(names) == 1 else collected)
    return worst


def add_name(parser: argparse._ActionsContainer) -> None:
    """The option that names the files of a model."""
    parser.add_argument(
        "--name", metavar="STEM", help="names of files without ending; default: the model's"
    )


def stem_of(options: argparse.Namespace) -> str:
    """File name of a model's output without extension: from ``--name``, or from its own file.

    Raises
    ------
    Error
        If the name is not valid on every system.
    """
    from moldloft.errors import Error, FileError
    from moldloft.permissions import checked_name

    given = getattr(options, "name", None)
    own = "stdin" if options.model == "-" else Path(options.model).stem
    stem = own if given is None else given
    if not hasattr(options, "name"):
        return stem
    try:
        # The longest ending.
        plain = checked_name(f"{stem}.stl-text")
    except FileError as error:
        help_ = "" if given is not None else "\nhelp: give another name: `--name STEM`"
        why = str(error).partition("`: ")[2]
        raise Error(f"cannot name files `{stem}`: {why}{help_}") from None
    if len(plain.parts) > 1:
        raise Error(f"`{stem}` is not a name of a file; `-o DIR` names the folder")
    return stem


def emit(path: str | Path, data: bytes, sources: Sequence[str] = ()) -> Path | None:
    """Writes a file atomically; ``-`` is standard output and returns no path.

    Sources are never overwritten.
    """
    from moldloft.exchange.files import Output, commit
    from moldloft.permissions import check_not_source

    if str(path) == "-":
        sys.stdout.flush()
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return None
    path = Path(path)
    check_not_source(path, sources)
    return commit(path.parent, [Output(path.name, data)])[0]


def put_text(text: str) -> None:
    """Writes untrusted text to standard output: unchanged, but escaped on a terminal."""
    if sys.stdout.isatty():
        sys.stdout.write(text)
    else:
        emit("-", text.encode())


def _from_standard_input(options: argparse.Namespace) -> Model:
    from moldloft.errors import FileError
    from moldloft.loading import loads

    try:
        text = sys.stdin.buffer.read().decode()
    except UnicodeDecodeError as error:
        raise FileError("cannot read standard input: it is not UTF-8 text") from error
    kind = "ms2" if text.lstrip().startswith("MultiSurf") else "sdl"
    folders = [*options.library, "."]
    return loads(text, name=f"stdin.{kind}", library=folders, strict=False)


def _foreign(options: argparse.Namespace) -> Model | None:
    """The model of a mesh or CAD file; None for other files.

    Raises
    ------
    Error
        If ``--file-units`` is given for another file than that of a mesh.
    """
    from moldloft.cad.importing import ENDINGS, imported
    from moldloft.errors import Error
    from moldloft.exchange.mesh_files import holds_mesh, mesh_program
    from moldloft.loading import loads

    place = Path(options.model)
    cad = place.suffix.lower() in ENDINGS
    mesh = holds_mesh(place)
    stated = getattr(options, "file_units", None)
    if stated and not mesh:
        raise Error(
            f"--file-units is the unit of a mesh file; {options.model} "
            + ("states its unit itself" if cad else "is none")
        )
    if not (cad or mesh) or not place.is_file():
        return None
    # Other commands have `--units` for their figures.
    units = getattr(options, "model_units", None)
    if cad:
        _, model, remarks = imported(place, units=units or "m")
    else:
        text, remarks = mesh_program(place, units=units or "", file_units=stated or "")
        model = loads(text, name=f"{place.stem}.sdl")
    for remark in remarks:
        print(f"warning: {options.model}: {remark}", file=sys.stderr)
    return model


def open_model(options: argparse.Namespace) -> Model:
    """The model of the arguments, with the values of ``--set``."""
    from moldloft.errors import Error
    from moldloft.exchange.files import ending
    from moldloft.formats import formats
    from moldloft.loading import load

    foreign = _foreign(options)
    if foreign is not None:
        return foreign
    named = ending(Path(options.model))
    written = [row for row in formats().values() if named in (row.name, row.suffix) and named]
    if written and named not in ("sdl", "ms2"):
        raise Error(
            f"{options.model} is an output format, not a model ({written[0].about});"
            " expected a program (.sdl), a model file (.ms2) or a sketch (.skt)"
        )
    place = Path(options.model)
    if place.suffix.lower() not in ("", ".sdl", ".ms2", ".skt") and place.is_file():
        raise Error(
            f"{options.model} is not a model: expected a program (.sdl), a model file "
            "(.ms2) or a sketch (.skt)\nhelp: a program of another name can be given on standard "
            "input, as `-`"
        )
    if options.model == "-":
        model = _from_standard_input(options)
    else:
        model = load(options.model, library=options.library, strict=False)
    refine = getattr(options, "refine", 0)
    if refine:
        if refine < 0:
            raise Error("--refine takes a whole number of at least 0")
        model.refine(refine)
    if options.set:
        try:
            model.set(dict(options.set))
        except Error:
            # Errors of the text may be the reason why a name is unknown.
            report([d for d in model.diagnostics if d.severity == "error"])
            raise
    return model


def report(diagnostics: list[Diagnostic]) -> None:
    """Prints diagnostics on standard error."""
    from moldloft.cli.colour import painted

    for diagnostic in diagnostics:
        print(painted(str(diagnostic), sys.stderr), file=sys.stderr)


def block_problems(model: Model) -> list[Diagnostic]:
    """Faults of the cells of the model's solids, if any: folded cells and mismatched joins."""
    from moldloft.errors import ModelError

    facts = (model.facts(name) for name in model.objects)
    if not any(fact["ok"] and fact["class"] == "solid" for fact in facts):
        return []
    try:
        return model.blocks().problems
    except ModelError as error:
        return list(error.diagnostics)


def print_json(data: Any) -> None:
    """Prints data as JSON on standard output; non-finite numbers become null."""
    text = json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False)
    print(STEERING.sub(lambda found: f"\\u{ord(found[0]):04x}", text))


def _finite(data: Any) -> Any:
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_finite(value) for value in data]
    return data


class Progress:
    """Progress line for work that takes longer than a second, on terminals only.

    It shows the seconds of the stage or, if the fraction done is known, percent and time left.
    Nothing is printed into pipes and files.
    """

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._over = threading.Event()
        self._shown = False
        self._now: tuple[str, str, float | None] = ("", "", None)
        self._began = time.monotonic()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def stage(self, words: str, detail: str = "", done: float | None = None) -> None:
        """Set the current stage.

        Parameters
        ----------
        words
            Name of the stage; a new name restarts its clock.
        detail
            Text after the name.
        done
            Fraction of the stage that is done, 0 to 1, if known.
        """
        if words != self._now[0]:
            self._began = time.monotonic()
        self._now = (words, detail, done)

    def __enter__(self) -> Progress:
        if self._terminal:
            self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._over.set()
        if self._terminal:
            self._thread.join()
        if self._shown:
            print(OwnText("\r\x1b[K"), end="", file=sys.stderr, flush=True)

    def _watch(self) -> None:
        wait = 1.0
        while not self._over.wait(wait):
            wait = 0.25
            line = progress_line(*self._now, time.monotonic() - self._began)
            end = shutil.get_terminal_size().columns - 1
            print(OwnText(f"\r\x1b[K{shown(line)[:end]}"), end="", file=sys.stderr, flush=True)
            self._shown = True


def progress_line(words: str, detail: str, done: float | None, seconds: float) -> str:
    """The progress line of a stage after a number of seconds.

    >>> progress_line("dividing", "", None, 12.3)
    'dividing … 12 s; Ctrl-C ends it'
    >>> progress_line("evaluating cases", "64 of 256", 0.25, 30)
    'evaluating cases: 64 of 256, 25 %, 1:30 left; Ctrl-C ends it'
    """
    line = f"{words}: {detail}" if detail else words
    if not done:
        return f"{line} … {seconds:.0f} s; Ctrl-C ends it"
    left = round(seconds * (1 - done) / done)
    clock = f"{left // 60}:{left % 60:02d}" if left >= 60 else f"{left} s"
    return f"{line}, {100 * done:.0f} %, {clock} left; Ctrl-C ends it"


def format_argument(name: str) -> str:
    """The name of a format, for options."""
    from moldloft.errors import Error
    from moldloft.exchange.files import format_named

    try:
        return format_named(name)
    except Error as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def water(text: str) -> float | str:
    """A density, as a number or as the name of a water."""
    from moldloft.units import WATERS

    if text in WATERS:
        return text
    try:
        return float(text)
    except ValueError:
        names = ", ".join(WATERS)
        raise argparse.ArgumentTypeError(f"`{text}` is neither {names} nor a number") from None
