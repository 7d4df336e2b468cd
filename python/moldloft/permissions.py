"""Files that a program or sketch of unknown origin may write; the table is in SECURITY.md.

The names that a person gives on the command line or in Python are the person's own affair. Names
that come out of a model are not: they stay inside of the folder for output, hide nothing, start
nothing, and overwrite only what the last run wrote.
"""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath

from moldloft.errors import FileError
from moldloft.storage import Lock, Output, commit, digest, digest_of, make_folders, read_bytes

__all__ = ["RECORD", "check_not_source", "checked_name", "write_outputs"]

RECORD = ".moldloft-written"
"""The file that lists the output of the last runs in a folder, with hashes."""

_DEEPEST = 8
_LONGEST = 200

#: Names of devices on Windows, with any ending.
_DEVICES = re.compile(
    r"(?:con|prn|aux|nul|com[0-9¹²³]|lpt[0-9¹²³]|conin\$|conout\$)(?:\..*)?", re.I
)

#: What some program starts without being asked, by ending and by name.
_ENDINGS = (
    "app bash bat cmd com command csh desktop dll dylib exe fish hta inf jar js jse lnk mk msc msi"
    " pif ps1 psm1 pth py pyc pyd pyw reg scf scpt scr service sh so url vbe vbs wsf zsh"
)
_FILES = (
    "makefile gnumakefile dockerfile jenkinsfile justfile rakefile vagrantfile procfile"
    " cmakelists.txt package.json pyproject.toml setup.cfg tox.ini cargo.toml authorized_keys"
    " autorun.inf desktop.ini"
)
_STARTED = frozenset(_ENDINGS.split())
_STARTED_NAMES = frozenset(_FILES.split())


def checked_name(name: str) -> PurePosixPath:
    r"""The relative path of an output that a model names.

    Raises
    ------
    FileError
        If the name is not permitted.

    >>> checked_name("grids/wing.p3d")
    PurePosixPath('grids/wing.p3d')
    >>> checked_name("../up.stl")
    Traceback (most recent call last):
      ...
    moldloft.errors.FileError: cannot write `../up.stl`: it leads out of the folder for output
    """
    why = _fault(name)
    if why:
        raise FileError(f"cannot write `{name}`: {why}")
    return PurePosixPath(name)


def _fault(name: str) -> str:
    parts = name.split("/")
    plain = [part for part in parts if part not in (".", "")]
    if name.startswith("/") or ".." in parts:
        return "it leads out of the folder for output"
    if not plain or parts[-1] in (".", ""):
        return "it is not a file name"
    if len(parts) > _DEEPEST:
        return f"it is more than {_DEEPEST} folders deep"
    for part in plain:
        if part.startswith("."):
            return "names that begin with a dot are hidden"
        if re.search(r'[\x00-\x1f\x7f\\:*?"<>|]', part) or not part.isprintable():
            return 'a name must not contain \\ : * ? " < > | or control characters'
        if part.endswith((".", " ")) or part.startswith(" "):
            return "a name neither begins nor ends with a blank, nor ends with a dot"
        if _DEVICES.fullmatch(part):
            return f"`{part}` is the name of a device on some systems"
        if len(part.encode("utf-8", "replace")) > _LONGEST:
            return f"a name has at most {_LONGEST} bytes"
    last = plain[-1].lower()
    if last in _STARTED_NAMES or ("." in last and last.rpartition(".")[2] in _STARTED):
        return "files of this kind are run by other programs"
    return ""


def check_not_source(path: Path, sources: Iterable[str], *, force: bool = False) -> None:
    """Refuse to overwrite input files.

    Raises
    ------
    FileError
        If ``path`` is one of the sources.
    """
    if force or not path.exists():
        return
    for source in sources:
        same = False
        # A source that has gone is not overwritten.
        with contextlib.suppress(OSError, ValueError):
            same = source != "-" and path.samefile(source)
        if same:
            raise FileError(f"cannot write `{path}`: it was read for this; give another name")


def write_outputs(
    folder: Path,
    files: Mapping[str, bytes],
    *,
    sources: Iterable[str] = (),
    force: bool = False,
) -> list[Path]:
    """Write files with names chosen by a model or derived from its name.

    Parameters
    ----------
    folder
        The folder for output.
    files
        Contents by name.
    sources
        Input file, which is not overwritten.
    force
        True to overwrite files that an earlier run did not write.

    Raises
    ------
    FileError
        If one of the files may not be written; then no file is written.
    """
    if not files:
        return []
    names = {name: checked_name(name).as_posix() for name in files}
    root = folder.resolve()
    for name, plain in names.items():
        if not (folder / plain).resolve().is_relative_to(root):
            raise FileError(f"cannot write `{name}`: a link leads out of `{folder}`")
        check_not_source(folder / plain, sources, force=force)
    made = []
    try:
        made = make_folders(folder)
        with Lock(folder / f"{RECORD}.lock", str(folder), wait=60.0):
            return _write(folder, {names[name]: data for name, data in files.items()}, force)
    except OSError as error:
        for path in made:
            with contextlib.suppress(OSError):
                path.rmdir()
        if isinstance(error, FileError):
            raise
        why = (error.strerror or str(error)).lower()
        raise FileError(f"cannot write in `{folder}`: {why}") from error


def _write(folder: Path, files: dict[str, bytes], force: bool) -> list[Path]:
    known = _written_before(folder)
    for name, data in files.items():
        present = None if force else digest_of(folder / name)
        if present is not None and present not in (known.get(name), digest(data)):
            how = "was changed since" if name in known else "was not written by an earlier run"
            raise FileError(
                f"cannot write `{folder / name}`: it is there, and {how}; "
                "`--force` overwrites it, `-o DIR` writes elsewhere"
            )
    new = known | {name: digest(data) for name, data in files.items()}
    kept = {n: d for n, d in sorted(new.items()) if n in files or (folder / n).exists()}
    record = json.dumps({"version": 1, "files": kept}, indent=1)
    by_folder: dict[Path, list[Output]] = {}
    for name, data in files.items():
        path = folder / name
        by_folder.setdefault(path.parent, []).append(Output(path.name, data))
    beside = by_folder.pop(folder, [])
    for parent, outputs in by_folder.items():
        commit(parent, outputs)
    commit(folder, [*beside, Output(RECORD, record.encode())])
    return [folder / name for name in files]


def _written_before(folder: Path) -> dict[str, str]:
    """The hashes of the output of earlier runs in a folder, by name."""
    try:
        data = json.loads(read_bytes(folder / RECORD, 16 << 20))
        return {str(name): str(hash_) for name, hash_ in data["files"].items()}
    except (FileError, ValueError, KeyError, TypeError, AttributeError):
        return {}
