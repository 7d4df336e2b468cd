"""Panel files of flow solvers, read whole: counts, numbers of corners and lines are checked.

WAMIT's low-order GDF, Nemoh's mesh, HAMS's hull mesh and HydroStar's mesh, by the manuals of these
programs. Planes of symmetry become faces, the sense of rotation is kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import FileError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Panels = tuple[NDArray[np.float64], NDArray[np.int64], list[str]]
    # With the axes along which the body is mirrored.
    _Read = tuple[NDArray[np.float64], NDArray[np.int64], list[int]]

__all__ = ["read_panels"]


class _Lines:
    """The lines of a file, with their numbers."""

    def __init__(self, data: bytes) -> None:
        self.rows = data.decode("utf-8", "replace").splitlines()
        self.number = 0
        self.remarks: list[str] = []

    def next(self, expected: str) -> str:
        if self.number == len(self.rows):
            raise FileError(f"expected {expected}, found the end of the file")
        self.number += 1
        return self.rows[self.number - 1]

    def left(self) -> Iterator[str]:
        while self.number < len(self.rows):
            yield self.next("a line")

    def fault(self, expected: str, found: str) -> FileError:
        shown = repr(found.strip()[:60])
        return FileError(f"line {self.number}: expected {expected}, found {shown}")

    def floats(self, line: str, count: int, expected: str) -> list[float]:
        """The first numbers of a line; the text after them is a remark."""
        words = line.replace(",", " ").split()
        try:
            numbers = [float(word.lower().replace("d", "e")) for word in words[:count]]
        except ValueError:
            raise self.fault(expected, line) from None
        if len(numbers) < count:
            raise self.fault(expected, line)
        return numbers

    def integers(self, line: str, count: int, expected: str) -> list[int]:
        numbers = self.floats(line, count, expected)
        if not all(abs(x) < 1e9 and x == int(x) for x in numbers):
            raise self.fault(expected, line)
        return [int(x) for x in numbers]

    def flags(self, line: str, expected: str) -> list[int]:
        flags = self.integers(line, 2, expected)
        if not set(flags) <= {0, 1}:
            raise self.fault(f"{expected}, each 0 or 1", line)
        return flags

    def face(self, words: list[str], line: str) -> list[int]:
        """Three or four numbers of vertices, from 1, as four from 0."""
        if len(words) not in (3, 4):
            raise self.fault("three or four corners of a panel", line)
        corners = self.integers(" ".join(words), len(words), "whole numbers of vertices")
        return [corner - 1 for corner in (*corners, corners[-1])[:4]]


def read_panels(data: bytes, ending: str) -> Panels:
    r"""Points, four corners of each panel (a triangle repeats its last), and remarks.

    Parameters
    ----------
    data
        The file.
    ending
        ``gdf``, ``mar`` or ``dat`` (Nemoh), ``pnl`` (HAMS), ``hst`` (HydroStar).

    Returns
    -------
    tuple
        ``(n, 3)`` points, ``(m, 4)`` numbers of points from 0, and remarks on doubtful content.

    Raises
    ------
    FileError
        If the file is another, or cut short; the message has the line.

    Examples
    --------
    >>> text = b"2 1\n1 0 0 0\n2 1 0 0\n3 1 1 0\n0 0 0 0\n1 2 3 3\n"
    >>> points, faces, _ = read_panels(text, "mar")
    >>> len(points), faces.tolist()
    (6, [[0, 1, 2, 2], [5, 4, 3, 3]])
    """
    lines = _Lines(data)
    reader = {"gdf": _gdf, "mar": _nemoh, "dat": _nemoh, "pnl": _hams, "hst": _hydrostar}[ending]
    points, faces, mirrors = reader(lines)
    if not len(faces):
        raise FileError("it contains no panels")
    if faces.min() < 0 or faces.max() >= len(points):
        raise FileError(f"a panel has a vertex number beyond the {len(points)} vertices")
    for axis in mirrors:
        image = points.copy()
        # 0 stays 0, not -0.
        image[:, axis] = 0.0 - image[:, axis]
        # A triangle repeats its last corner, also when it runs the other way round.
        three = faces[:, 2:3] == faces[:, 3:4]
        turned = np.where(three, faces[:, [2, 1, 0, 0]], faces[:, ::-1])
        faces = np.concatenate([faces, turned + len(points)])
        points = np.concatenate([points, image])
    return points, faces, lines.remarks


def _made(points: list[list[float]], faces: list[list[int]], mirrors: list[int]) -> _Read:
    return (
        np.array(points, dtype=np.float64).reshape(-1, 3),
        np.array(faces, dtype=np.int64).reshape(-1, 4),
        mirrors,
    )


def _gdf(lines: _Lines) -> _Read:
    lines.next("a title")
    lines.floats(lines.next("ULEN and GRAV"), 2, "ULEN and GRAV")
    isx, isy = lines.flags(lines.next("ISX and ISY"), "ISX and ISY")
    (count,) = lines.integers(lines.next("NPAN"), 1, "NPAN")
    numbers: list[float] = []
    for line in lines.left():
        if line.strip():
            numbers += lines.floats(line, len(line.replace(",", " ").split()), "coordinates")
    if len(numbers) < 12 * count:
        raise FileError(f"NPAN is {count}: expected {12 * count} numbers, found {len(numbers)}")
    if left := len(numbers) - 12 * count:
        # WAMIT reads NPAN panels and no further.
        lines.remarks.append(f"NPAN is {count}: {left} numbers after the last panel are omitted")
    corners = np.array(numbers[: 12 * count], dtype=np.float64).reshape(-1, 3)
    points, places = np.unique(corners, axis=0, return_inverse=True)
    faces = places.reshape(-1, 4)
    for face in faces:
        distinct = list(dict.fromkeys(face.tolist()))
        if len(distinct) == 3:
            face[:] = [*distinct, distinct[-1]]
    # ISX: the plane x = 0.
    return points, faces.astype(np.int64), [axis for axis, flag in ((0, isx), (1, isy)) if flag]


def _nemoh(lines: _Lines) -> _Read:
    first = lines.next("2 and the symmetry")
    two, symmetric = lines.integers(first, 2, "2 and the symmetry, 0 or 1")
    if two != 2 or symmetric not in (0, 1):
        raise lines.fault("2 and the symmetry, 0 or 1", first)
    points: list[list[float]] = []
    faces: list[list[int]] = []
    for line in lines.left():
        if line.split()[:1] == ["0"]:
            break
        number, *place = lines.floats(line, 4, "a number and three coordinates")
        if number != len(points) + 1:
            raise lines.fault(f"vertex {len(points) + 1}", line)
        points.append(place)
    else:
        raise FileError("the line of zeros after the vertices is missing")
    for line in lines.left():
        words = line.split()
        if words[:1] == ["0"] or not words:
            break
        faces.append(lines.face(words, line))
    return _made(points, faces, [1] if symmetric else [])


def _hams(lines: _Lines) -> _Read:
    for _ in range(3):
        lines.next("a line of the title")
    line = lines.next("counts and symmetries")
    expected = "counts of panels and vertices, two symmetries"
    panels, vertices, *_ = lines.integers(line, 4, expected)
    x, y = lines.flags(" ".join(line.split()[2:]), expected)
    for _ in range(2):
        lines.next("a line before the vertices")
    points: list[list[float]] = []
    faces: list[list[int]] = []
    for k in range(vertices):
        line = lines.next(f"vertex {k + 1} of {vertices}")
        number, *place = lines.floats(line, 4, "a number and three coordinates")
        if number != k + 1:
            raise lines.fault(f"vertex {k + 1}", line)
        points.append(place)
    for _ in range(3):
        lines.next("a line before the panels")
    for k in range(panels):
        line = lines.next(f"panel {k + 1} of {panels}")
        words = line.split()
        number, corners = lines.integers(line, 2, "a number, a count, the corners")
        if number != k + 1 or corners not in (3, 4) or len(words) < 2 + corners:
            raise lines.fault(f"panel {k + 1}, 3 or 4, its corners", line)
        faces.append(lines.face(words[2 : 2 + corners], line))
    return _made(points, faces, [axis for axis, flag in ((0, x), (1, y)) if flag])


#: Planes of HydroStar's symmetry by its number.
_SYMMETRY = {"0": [], "1": [1], "2": [0, 1]}


def _hydrostar(lines: _Lines) -> _Read:
    points: list[list[float]] = []
    faces: list[list[int]] = []
    mirrors: list[int] = []
    bodies: set[str] = set()
    part, numbered = "", False
    for line in lines.left():
        word = line.strip().upper()
        if not word:
            continue
        if word.startswith("ENDFILE"):
            break
        if word.startswith("END"):
            part = ""
        elif word.startswith("COORDINATES"):
            part = "vertices"
        elif word.startswith("PANEL"):
            part, kind = "panels", word.split()[-1]
            if kind not in ("0", "1"):
                raise lines.fault("`PANEL TYPE 0` or `PANEL TYPE 1`", line)
            numbered = kind == "1"
        elif part == "vertices":
            words = word.split()
            if len(words) == 4 and lines.floats(line, 1, "a number")[0] != len(points) + 1:
                raise lines.fault(f"vertex {len(points) + 1}", line)
            points.append(lines.floats(" ".join(words[-3:]), 3, "three coordinates"))
        elif part == "panels":
            words = word.split()
            if numbered and lines.integers(line, 1, "a number")[0] != len(faces) + 1:
                raise lines.fault(f"panel {len(faces) + 1}", line)
            faces.append(lines.face(words[1:] if numbered else words, line))
        elif word.startswith("SYMMETRY"):
            name, *kinds = word.replace(":", " ").split()
            # The number of the body comes before its symmetry.
            if name == "SYMMETRY_BODY" and len(kinds) == 2:
                bodies.add(kinds.pop(0))
            if len(kinds) != 1 or kinds[0] not in _SYMMETRY:
                raise lines.fault("a symmetry of 0, 1 or 2", line)
            if len(bodies) > 1 and mirrors != _SYMMETRY[kinds[0]]:
                raise lines.fault("one symmetry for all bodies", line)
            mirrors = _SYMMETRY[kinds[0]]
    if part:
        raise FileError(f"the end of the {part} is missing")
    return _made(points, faces, mirrors)
