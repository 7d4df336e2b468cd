"""The files beside a study that decide the numbers of its analyses, and the programs it runs."""

from __future__ import annotations

import ast
import shutil
from collections.abc import Iterator
from pathlib import Path

from moldloft.study.definition import Analysis, Study, StudyError

__all__ = ["check_programs", "source_files"]

#: A word of a command that names a file of the study.
FOLDER = "{folder}/"


def source_files(study: Study) -> list[Path]:
    """The files of all analyses; a change in one of them requires new evaluations.

    Parameters
    ----------
    study
        The definition.

    Returns
    -------
    list of pathlib.Path
        Python files with the modules beside them that they import, templates, files of commands
        and those that an analysis states.

    Raises
    ------
    StudyError
        When one is not there.
    """
    found: dict[Path, None] = {}
    for analysis in study.analyses:
        for place in _named(analysis, study.folder):
            if place.is_dir():
                inner = sorted(p for p in place.rglob("*") if p.is_file())
                found |= dict.fromkeys(p for p in inner if "__pycache__" not in p.parts)
            else:
                found[place] = None
                if place.suffix == ".py":
                    found |= dict.fromkeys(_imported(place))
    return list(found)


def _named(analysis: Analysis, folder: Path) -> Iterator[Path]:
    where = f"analysis.{analysis.name}"
    for function in analysis.functions:
        place = folder / function.rpartition(":")[0]
        if not place.is_file():
            raise StudyError(f"`{where}`: `{place}` is no Python file")
        yield place
    if analysis.template:
        place = folder / analysis.template
        if not place.is_dir():
            raise StudyError(f"`{where}.template`: `{place}` is no folder")
        yield place
    for name in analysis.files:
        if not (folder / name).exists():
            raise StudyError(f"`{where}.files`: `{folder / name}` is not there")
        yield folder / name
    for command in analysis.command:
        for word in command:
            place = folder / word.removeprefix(FOLDER)
            if word.startswith(FOLDER) and place.is_file():
                yield place


def _imported(source: Path, seen: frozenset[Path] = frozenset()) -> Iterator[Path]:
    """Modules in the folder of a Python file that it imports, and those that they import."""
    try:
        tree = ast.parse(source.read_bytes())
    except (SyntaxError, ValueError):
        return
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {each.name for each in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
    for name in sorted(names):
        place = source.parent / (name.partition(".")[0] + ".py")
        if place.is_file() and place not in seen and place != source:
            yield place
            yield from _imported(place, seen | {source, place})


def check_programs(study: Study) -> None:
    """Refuse a study with programs that are not installed on this machine.

    Parameters
    ----------
    study
        The definition.

    Raises
    ------
    StudyError
        With the program that is not found.
    """
    for analysis in study.analyses:
        for command in analysis.command:
            # Others are in the case's folder or beside the study.
            plain = not any(c in command[0] for c in "/\\{")
            if plain and shutil.which(command[0]) is None:
                raise StudyError(
                    f"`analysis.{analysis.name}.command`: no program `{command[0]}` on PATH"
                )
