"""External analysis programs: a folder for each case, commands in it, numbers from its files."""

from __future__ import annotations

import contextlib
import csv
import json
import math
import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error
from moldloft.formats import format_named
from moldloft.spelling import nearest
from moldloft.study.extras import needed

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = ["SolverError", "finite", "run_program"]

#: Text files of a program beyond this are not read: a number is expected, not a field.
MAX_RESULT_BYTES = 64 << 20

#: Interval, in seconds, at which the end of the process that asked for a case is noted.
POLL_SECONDS = 0.5

#: Bytes at the end of the output of a command that failed in which its last line is looked for.
TAIL_BYTES = 400

Functions = Callable[[str, str], Any]
"""The function of a Python file: path, name."""


class SolverError(Error):
    """An analysis failed: error, time limit, or missing number."""


def finite(value: float, name: str, source: str) -> float:
    """The value, if it is a finite number.

    Parameters
    ----------
    value
        A number.
    name, source
        Its name and the file or function that it is from, for the message.

    Raises
    ------
    SolverError
        For NaN and infinities.
    """
    if not math.isfinite(value):
        raise SolverError(f"`{name}` of `{source}` is {value}, expected a finite number")
    return value


def run_program(
    model: Model,
    analysis: Mapping[str, Any],
    request: Mapping[str, Any],
    found: Mapping[str, float],
    function: Functions,
) -> dict[str, float]:
    """Write the folder of a case, run its commands, and read the numbers.

    Parameters
    ----------
    model
        The model of the case.
    analysis
        The fields of a :class:`moldloft.study.Analysis`.
    request
        The request of the case.
    found
        The outputs so far.
    function
        Finds the functions of Python files.

    Returns
    -------
    dict
        The numbers by name.

    Raises
    ------
    SolverError
        With the command or file that is at fault.
    """
    place = Path(request["place"]) / analysis["name"]
    if place.exists():
        shutil.rmtree(place)
    place.mkdir(parents=True)
    folder = Path(request["folder"])
    keep = analysis["keep"] == "all"
    try:
        stem = Path(request["model"]).stem
        words: dict[str, float | str] = {n: float(p.value) for n, p in model.params.items()}
        words |= {**request["inputs"], **found}
        if analysis["prepare"]:
            words |= _prepared(model, analysis["prepare"], place, folder, function)
        if analysis["template"]:
            _copy(folder / analysis["template"], place, words)
        for name, file in analysis["formats"].items():
            row = format_named(name)
            target = place / (file or row.file_name(stem))
            target.parent.mkdir(parents=True, exist_ok=True)
            model.write(target, format=row.name, **analysis["options"])
        until = time.monotonic() + analysis["seconds"]
        words |= {"model": stem, "folder": request["folder"]}
        for command in analysis["command"]:
            _run([_filled(w, words, w) for w in command], place, analysis, until)
        return {
            key: _result(place, key, pattern, folder, function)
            for key, pattern in analysis["results"].items()
        }
    except BaseException:
        keep = analysis["keep"] != "none"
        raise
    finally:
        if not keep:
            shutil.rmtree(place, ignore_errors=True)
            with contextlib.suppress(OSError):
                place.parent.rmdir()


# -- the folder ----------------------------------------------------------------------------


def _called(source: str, folder: Path, function: Functions, *arguments: Any) -> Any:
    place, _, name = source.rpartition(":")
    used = function(str(folder / place), name)
    try:
        return used(*arguments)
    except Error:
        raise
    except Exception as error:
        raise SolverError(f"`{source}` raised {type(error).__name__}: {error}") from error


def _prepared(
    model: Model, source: str, place: Path, folder: Path, function: Functions
) -> dict[str, float | str]:
    made = _called(source, folder, function, model, place)
    if made is None:
        return {}
    if not isinstance(made, Mapping):
        raise SolverError(f"`{source}` returned {type(made).__name__}, expected a mapping or None")
    words: dict[str, float | str] = {}
    for name, value in made.items():
        if isinstance(value, str):
            words[name] = value
            continue
        try:
            words[name] = finite(float(value), name, source)
        except (TypeError, ValueError):
            raise SolverError(
                f"`{name}` of `{source}` is {type(value).__name__}, expected a number or a text"
            ) from None
    return words


def _copy(template: Path, place: Path, words: Mapping[str, float | str]) -> None:
    if not template.is_dir():
        raise SolverError(f"the template `{template}` is no folder")
    for source in sorted(template.rglob("*")):
        target = place / source.relative_to(template)
        if source.is_dir():
            target.mkdir(parents=True, exist_ok=True)
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        data = source.read_bytes()
        with contextlib.suppress(UnicodeDecodeError):
            where = f"{template.name}/{source.relative_to(template).as_posix()}"
            data = _filled(data.decode(), words, where).encode()
        target.write_bytes(data)
        shutil.copymode(source, target)


def _filled(text: str, words: Mapping[str, float | str], where: str) -> str:
    """The text with `{name}` and `{name:format}` replaced; other braces are left alone."""

    def value(match: re.Match[str]) -> str:
        name, form = match[1], match[2]
        if name not in words:
            near = nearest(name, list(words))
            if near or form:
                hint = f"; did you mean `{near}`?" if near else ""
                raise SolverError(f"`{where}`: `{{{name}}}` is unknown{hint}")
            return match[0]
        found = words[name]
        if not form:
            return found if isinstance(found, str) else repr(found)
        try:
            return format(found, form[1:])
        except ValueError as error:
            raise SolverError(f"`{where}`: `{match[0]}`: {error}") from None

    named = "|".join(re.escape(n) for n in sorted(words, key=len, reverse=True))
    # `${name}` is a variable of shells and of OpenFOAM.
    return re.sub(rf"(?<!\$)\{{({named}|[A-Za-z_]\w*)(:[^{{}}\s]*)?\}}", value, text)


# -- the commands --------------------------------------------------------------------------


def _run(command: Sequence[str], place: Path, analysis: Mapping[str, Any], until: float) -> None:
    log, source = place / "command.log", analysis["stdin"]
    began = log.stat().st_size if log.exists() else 0
    with contextlib.ExitStack() as opened:
        out = opened.enter_context(log.open("ab"))
        taken: Any = subprocess.DEVNULL
        if source:
            try:
                taken = opened.enter_context((place / source).open("rb"))
            except OSError as error:
                raise SolverError(f"`stdin`: no file `{source}` ({error.strerror})") from None
        try:
            process = subprocess.Popen(
                command,
                cwd=place,
                env={**os.environ, **analysis["environment"]},
                stdin=taken,
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except OSError as error:
            raise SolverError(
                f"cannot run `{command[0]}`: {(error.strerror or str(error)).lower()}"
            ) from None
        try:
            status = _ended(process, until, os.getppid())
        except subprocess.TimeoutExpired:
            _end(process)
            raise SolverError(
                f"`{command[0]}` took longer than {analysis['seconds']:g} s"
            ) from None
        except BaseException:
            _end(process)
            raise
    if status:
        last = log.read_bytes()[began:][-TAIL_BYTES:].decode("utf-8", "replace").strip()
        said = f": {last.splitlines()[-1]}" if last else ""
        raise SolverError(f"`{command[0]}` ended with status {status}{said}")


def _ended(process: subprocess.Popen[bytes], until: float, asker: int) -> int:
    """The status of a command, which outlives neither its limit nor the process that asked."""
    while True:
        left = until - time.monotonic()
        try:
            return process.wait(max(min(left, POLL_SECONDS), 0.0))
        except subprocess.TimeoutExpired:
            if left <= POLL_SECONDS:
                raise
        if os.getppid() != asker:
            raise SystemExit(1)


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends a command and what it started."""
    if hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()


# -- the numbers ---------------------------------------------------------------------------


def _result(
    place: Path, name: str, pattern: Mapping[str, Any], folder: Path, function: Functions
) -> float:
    file = place / pattern["file"]
    if not file.is_file():
        raise SolverError(f"`{name}`: the command wrote no `{pattern['file']}`")
    word: Any
    if pattern["python"]:
        word = _called(pattern["python"], folder, function, file)
    elif pattern["dataset"]:
        word = _of_hdf5(file, name, pattern)
    else:
        text = _text(file, name, pattern)
        if pattern["pattern"]:
            word = _of_text(text, name, pattern)
        elif pattern["column"]:
            word = _of_table(text, name, pattern)
        else:
            word = _of_json(text, name, pattern)
    try:
        value = float(word)
    except (TypeError, ValueError):
        raise SolverError(
            f"`{name}` in `{pattern['file']}`: expected a number, found `{str(word)[:80]}`"
        ) from None
    return finite(value, name, pattern["file"])


def _text(file: Path, name: str, pattern: Mapping[str, Any]) -> str:
    try:
        if file.stat().st_size > MAX_RESULT_BYTES:
            raise SolverError(f"`{pattern['file']}` is larger than {MAX_RESULT_BYTES >> 20} MiB")
        return file.read_bytes().decode("utf-8", "replace")
    except OSError as error:
        raise SolverError(f"`{name}`: `{pattern['file']}`: {error.strerror}") from None


def _of_text(text: str, name: str, pattern: Mapping[str, Any]) -> str:
    matches = list(re.finditer(pattern["pattern"], text, re.MULTILINE))
    if not matches:
        raise SolverError(f"`{name}`: `{pattern['file']}` has no match of `{pattern['pattern']}`")
    last = matches[-1]
    return str(last[1] if last.re.groups else last[0])


def _of_table(text: str, name: str, pattern: Mapping[str, Any]) -> str:
    """A number of a table whose words are between commas, semicolons or blanks.

    Lines above the header, comments and rules are passed over.
    """
    header: list[str] | None = None
    separator = ""
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if header is None:
            title = line.strip().lstrip("#%")
            for separator in (",", ";", ""):
                if pattern["column"] in (words := _words(title, separator)):
                    header = words
                    break
        elif line.strip() and line.lstrip()[0] not in "#%" and set(line) - set(" \t-=+|"):
            rows.append((number, _words(line, separator)))
    if header is None:
        raise SolverError(f"`{name}`: `{pattern['file']}` has no column `{pattern['column']}`")
    try:
        number, row = rows[pattern["row"]]
    except IndexError:
        raise SolverError(f"`{name}`: `{pattern['file']}` has no row {pattern['row']}") from None
    if len(row) != len(header):
        raise SolverError(
            f"`{name}`: line {number} of `{pattern['file']}` has {len(row)} words, its header "
            f"{len(header)}"
        )
    word: str = row[header.index(pattern["column"])]
    return word


def _words(line: str, separator: str) -> list[str]:
    if not separator:
        return line.split()
    rows = csv.reader([line], delimiter=separator, skipinitialspace=True)
    return [word.strip() for row in rows for word in row]


def _of_json(text: str, name: str, pattern: Mapping[str, Any]) -> Any:
    try:
        value: Any = json.loads(text)
        for word in pattern["key"].split("."):
            value = value[int(word)] if isinstance(value, list) else value[word]
    except (ValueError, KeyError, IndexError, TypeError):
        raise SolverError(
            f"`{name}`: `{pattern['file']}` has no value `{pattern['key']}`"
        ) from None
    return value


def _of_hdf5(file: Path, name: str, pattern: Mapping[str, Any]) -> float:
    h5py = needed("h5py", "tables", f"the result `{name}`")
    dataset, index = pattern["dataset"], tuple(pattern["index"])
    try:
        with h5py.File(file, "r") as opened:
            values = np.asarray(opened[dataset][index])
    except (OSError, KeyError, IndexError, ValueError, TypeError, AttributeError):
        at = f"{dataset}{list(index)}" if index else dataset
        raise SolverError(f"`{name}`: `{pattern['file']}` has no value `{at}`") from None
    if values.size != 1:
        raise SolverError(
            f"`{name}`: `{dataset}` of `{pattern['file']}` has {values.size} numbers there; "
            "`index` chooses one"
        )
    return float(values.reshape(-1)[0])
