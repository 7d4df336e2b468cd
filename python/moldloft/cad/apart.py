"""CAD files read in a process of their own, bounded in time and memory.

OCCT and rhino3dm can end the process over a damaged file. The faces of a STEP file that OCCT ends
over are then found by halves, named, and left out; other files are refused.
"""

from __future__ import annotations

import atexit
import math
import os
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np

from moldloft.budget import limits
from moldloft.cad import check_occt, needed
from moldloft.cad.faces import Imported, ImportedFace, ImportedSide, Placement
from moldloft.cad.occt import cad_bytes, of_part
from moldloft.cad.part21 import StepText
from moldloft.cad.rhino_reading import meshes
from moldloft.child_process import ChildProcess, ProcessEnd, bounded, serve
from moldloft.errors import Error, FileError
from moldloft.shapes.nurbs import Nurbs
from moldloft.storage import read_bytes

__all__ = ["read", "read_meshes"]

SECONDS, SECONDS_A_MEGABYTE = 10.0, 30.0
"""Processor time for one file, and for each megabyte of it, unless the limits of this process state
a time. Sound files take a tenth of that."""

PATIENCE = 20
"""Ratio of waiting time to allowed processor time of an answer, for a busy machine."""

_MORE = "help: allow more: `--limit seconds=600`, `moldloft.limits(seconds=...)`"

_IDLE = 30.0
"""Seconds without a request after which the other process ends."""

_TRIES = 24
"""Maximum number of partial reads of a file in the search for the entity that crashes OCCT."""


def read(path: Path, metres: float, *, components: bool = False) -> Imported:
    """The faces and curves of a CAD file; ``metres`` is the length of its unit.

    Parameters
    ----------
    path
        The file.
    metres
        Unit of length of the result, in metres.
    components
        True for products of a STEP file that are placed more than once as parts of their own.

    Raises
    ------
    FileError
        If the file is not of its format, contains no shape, or crashes OCCT.
    """
    check_occt("reading STEP and IGES")
    if not sys.executable:
        # A program that embeds Python: there is no interpreter to start.
        return of_part(path, metres, None, components=components)
    spending = _Spending(path)
    answer = _asked(path, metres, None, spending, components)
    if isinstance(answer, Imported):
        return answer
    numbers: list[int] = []
    if path.suffix.lower() in (".step", ".stp", ".stpz"):
        numbers = StepText.of(path, cad_bytes(path).decode("latin-1")).whole_faces
    parts, lost, _ = _by_halves(path, metres, numbers, _TRIES, spending)
    if not parts:
        more = "" if spending.left > 0 else f"\n{_MORE}"
        raise FileError(f"cannot read `{path}`: {answer}{more}")
    found = _together(parts, metres)
    few = ", ".join(f"#{n}" for n in lost[:20]) + (", ..." if len(lost) > 20 else "")
    found.remarks.insert(
        0,
        f"{answer}; {len(numbers) - len(lost)} of {len(numbers)} faces were read in "
        f"{len(parts)} parts, which are not joined; left out: {few or 'none'}",
    )
    return found


def read_meshes(path: Path) -> tuple[Any, Any, list[tuple[str, int, int]], float | None]:
    """The visible meshes of a 3DM file, as :func:`moldloft.cad.rhino_reading.meshes` gives them.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    FileError
        If it is not a 3DM file, or ends the process that reads it.
    """
    needed("rhino3dm", "rhino3dm", "reading 3DM")
    if not sys.executable:
        return meshes(read_bytes(path))
    with tempfile.TemporaryDirectory() as folder:
        answer = _worker.ask(_request(path, _Spending(path)) | {"arrays_in": folder})
        if isinstance(answer, str):
            raise FileError(answer)
        _check(answer, path)
        if "fault" in answer:
            raise FileError(f"rhino3dm cannot read the file ({answer['fault']})")
        points, corners = (np.load(Path(folder) / f"{name}.npy") for name in _ARRAYS)
    groups = [(name, first, end) for name, first, end in answer["groups"]]
    return points, corners, groups, answer["metres"]


def _by_halves(
    path: Path, metres: float, numbers: list[int], tries: int, spending: _Spending
) -> tuple[list[Imported], list[int], int]:
    """Readable part of some faces, the unreadable faces, and the remaining number of tries."""
    if not numbers or tries <= 0 or spending.left < _LEAST:
        return [], numbers, tries
    answer = _asked(path, metres, numbers, spending)
    if isinstance(answer, Imported):
        return [answer], [], tries - 1
    if len(numbers) == 1:
        return [], numbers, tries - 1
    middle = len(numbers) // 2
    low, lost, tries = _by_halves(path, metres, numbers[:middle], tries - 1, spending)
    high, more, tries = _by_halves(path, metres, numbers[middle:], tries, spending)
    return low + high, lost + more, tries


def _together(parts: list[Imported], metres: float) -> Imported:
    found = Imported(metres=metres)
    taken: set[str] = set()
    first = 0
    for part in parts:
        last = first
        for face in part.faces:
            name = face.name
            while name in taken:
                name += "_"
            taken.add(name)
            face.name = name
            face.renumber(first)
            last = max([last, *(side.edge for side in face.sides)])
        found.faces += part.faces
        found.remarks += [r for r in part.remarks if r not in found.remarks]
        first = last + 1
    return found


_LEAST = 2.0
"""Seconds of processor time without which no part is tried: a new process takes as many."""


class _Spending:
    """The processor time that is left for a file."""

    def __init__(self, path: Path) -> None:
        stated = limits().seconds
        usual = SECONDS + SECONDS_A_MEGABYTE * path.stat().st_size / 1e6 if path.exists() else 0.0
        self.allowed = stated if math.isfinite(stated) else usual
        self.left = self.allowed

    @property
    def clock(self) -> float:
        """Maximum waiting time of an answer."""
        return self.left if math.isfinite(limits().seconds) else PATIENCE * self.left


class _Worker:
    """A process that reads files one after the other, and ends after some time without requests."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: ChildProcess | None = None

    def ask(self, request: dict[str, Any]) -> dict[str, Any] | str:
        """The answer, or the reason why the process ended."""
        with self._lock:
            while True:
                process = self._process
                if process is None or not process.alive:
                    process = self._process = self._begun()
                old = process.answered
                answer = process.ask(request, request["clock"])
                # One that nobody had asked for a while may have ended by itself just then.
                if not isinstance(answer, ProcessEnd):
                    return answer
                self._process = None
                if not old or (answer.asked and answer.status != 0):
                    return self._said(answer, request)

    def _begun(self) -> ChildProcess:
        process = ChildProcess("moldloft.cad.apart", quiet=True)
        atexit.register(process.end)
        return process

    def _said(self, end: ProcessEnd, request: dict[str, Any]) -> str:
        reader = "rhino3dm" if request["path"].lower().endswith(".3dm") else "OCCT"
        if end.late:
            return f"{reader} was ended: it took longer than {request['clock']:g} s"
        if end.by == "SIGXCPU":
            allowed = request["seconds"]
            return f"{reader} was ended: it took longer than {allowed:g} s of processor time"
        return f"{reader} ended over the file ({end.by})"


_worker = _Worker()


def _asked(
    path: Path,
    metres: float,
    numbers: list[int] | None,
    spending: _Spending,
    components: bool = False,
) -> Imported | str:
    """Data of some or all faces read by another process, or the cause of its end."""
    before = _children()
    wanted = {"metres": metres, "faces": numbers, "components": components}
    answer = _worker.ask(_request(path, spending) | wanted)
    if isinstance(answer, str):
        # What ended over the file is known by its time; a part that took all leaves none.
        ended = " ended over the file" in answer
        spending.left -= max(_LEAST, _children() - before) if ended else spending.left
        return answer
    spending.left -= answer["seconds"]
    _check(answer, path)
    if "fault" in answer:
        return f"OCCT cannot read the file ({answer['fault']})"
    return _imported(answer, metres)


def _request(path: Path, spending: _Spending) -> dict[str, Any]:
    return {
        "path": str(path.absolute()),
        "memory": limits().memory,
        "seconds": spending.left,
        "clock": spending.clock,
    }


def _check(answer: dict[str, Any], path: Path) -> None:
    if "refused" in answer:
        raise FileError(answer["refused"].replace(str(path.absolute()), str(path)))


def _children() -> float:
    """Processor time of ended child processes."""
    spent = os.times()
    return spent.children_user + spent.children_system


def _sent(shape: Nurbs) -> dict[str, Any]:
    return {
        "degrees": shape.degrees,
        "knots": [k.tolist() for k in shape.knots],
        "points": shape.points.tolist(),
        "weights": None if shape.weights is None else shape.weights.tolist(),
    }


def _nurbs(sent: dict[str, Any]) -> Nurbs:
    weights = sent["weights"]
    return Nurbs(
        tuple(sent["degrees"]),
        tuple(np.array(k) for k in sent["knots"]),
        np.array(sent["points"]),
        None if weights is None else np.array(weights),
    )


def _imported(answer: dict[str, Any], metres: float) -> Imported:
    faces = [
        ImportedFace(
            face["name"],
            _nurbs(face["surface"]),
            [[ImportedSide(n, b, _nurbs(t), near) for n, b, t, near in c] for c in face["loops"]],
            face["natural"],
            face["reversed"],
            tuple(face["tags"]),
            None if face["colour"] is None else tuple(face["colour"]),
            face["cavity"],
        )
        for face in answer["faces"]
    ]
    curves = {name: _nurbs(curve) for name, curve in answer["curves"].items()}
    parts = {name: _imported(part, metres) for name, part in answer["parts"].items()}
    placed = [
        Placement(part, name, tuple(origin), tuple(x_axis), tuple(y_axis))
        for part, name, origin, x_axis, y_axis in answer["placed"]
    ]
    reserved = tuple(answer["reserved"])
    return Imported(faces, curves, metres, answer["remarks"], parts, placed, reserved)


def _answer(request: dict[str, Any]) -> dict[str, Any]:
    """Data of the answer, mostly numbers."""
    try:
        if "arrays_in" in request:
            return _meshes(request)
        path, metres = Path(request["path"]), request["metres"]
        found = of_part(path, metres, request["faces"], components=request["components"])
    except Error as error:
        return {"refused": str(error)}
    except MemoryError:
        return {"fault": f"more than {request['memory'] / 2**30:.3g} GiB are needed"}
    except Exception as error:
        # OCCT's own exceptions have no common class here.
        return {"fault": f"{type(error).__name__}: {error}".splitlines()[0][:200]}
    return _sent_content(found)


def _sent_content(found: Imported) -> dict[str, Any]:
    faces = [
        {
            "name": face.name,
            "surface": _sent(face.surface),
            "loops": [[(n, bool(b), _sent(t), near) for n, b, t, near in c] for c in face.loops],
            "natural": bool(face.natural),
            "reversed": bool(face.reversed),
            "tags": list(face.tags),
            "colour": face.colour,
            "cavity": face.cavity,
        }
        for face in found.faces
    ]
    curves = {name: _sent(curve) for name, curve in found.curves.items()}
    parts = {name: _sent_content(part) for name, part in found.parts.items()}
    sent = {"faces": faces, "curves": curves, "remarks": found.remarks, "parts": parts}
    placed = [list(place) for place in found.placed]
    return sent | {"placed": placed, "reserved": list(found.reserved)}


_ARRAYS = ("points", "corners")
"""Files of the arrays that a process leaves for the one that asked."""


def _meshes(request: dict[str, Any]) -> dict[str, Any]:
    points, corners, groups, metres = meshes(read_bytes(Path(request["path"])))
    for name, array in zip(_ARRAYS, (points, corners), strict=True):
        np.save(Path(request["arrays_in"]) / f"{name}.npy", array)
    return {"groups": groups, "metres": metres}


def _timed(request: dict[str, Any]) -> dict[str, Any]:
    """The result of reading, with its processor time."""
    began = time.process_time()
    bounded(request["memory"], request["seconds"])
    found = _answer(request)
    return {**found, "seconds": time.process_time() - began}


if __name__ == "__main__":
    serve(_timed, _IDLE)
