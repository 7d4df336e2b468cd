"""SVG drawings: paths and basic shapes as exact NURBS (W3C, SVG 1.1, chapters 7 to 9)."""

from __future__ import annotations

import math
import re
from collections import Counter
from itertools import pairwise
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from moldloft.cad import identifier
from moldloft.errors import FileError
from moldloft.overlays.overlay import Overlay
from moldloft.overlays.pieces import arc, bezier, joined, line
from moldloft.shapes.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["parse"]

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_TOKEN = re.compile(rf"([MmLlHhVvCcSsQqTtAaZz])|({_NUMBER})|([\s,]+)|(.)", re.S)
_METRES = {"mm": 0.001, "cm": 0.01, "in": 0.0254, "pt": 0.0254 / 72, "pc": 0.0254 / 6}
_METRES |= {"px": 0.0254 / 96, "": 0.0254 / 96, "Q": 0.00025}
_UNDRAWN = {
    "defs", "clipPath", "mask", "symbol", "pattern", "marker", "metadata", "style", "title", "desc",
    "linearGradient", "radialGradient", "filter", "script", "namedview",
}  # fmt: skip
"""Elements without a picture of their own."""


#: As of coordinates in models.
_LARGEST = 1e50


def _number(text: str) -> float:
    value = float(text)
    if not abs(value) <= _LARGEST:
        raise FileError(f"expected numbers of at most {_LARGEST:g}, found {text}")
    return value


def parse(name: str, data: bytes) -> tuple[Overlay, float | None]:
    """The shapes of an SVG file, and its unit in metres, if its size states one.

    Each part of a path is a curve. Strokes, fills, texts and images are omitted; y is reversed to
    point up.

    Parameters
    ----------
    name
        The name of the file, for the overlay.
    data
        Its bytes.
    """
    if b"<!ENTITY" in data:
        raise FileError("unsupported SVG file: it declares entities")
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        raise FileError(f"not an SVG file, or cut short: {error}") from error
    if _tag(root) != "svg":
        raise FileError(f"not an SVG file: its root is `{_tag(root)}`")
    curves: dict[str, Nurbs] = {}
    taken: set[str] = set()
    left: Counter[str] = Counter()
    up = np.diag([1.0, -1.0, 1.0])

    def walk(element: ElementTree.Element, place: Floats) -> None:
        tag = _tag(element)
        if tag in _UNDRAWN:
            return
        place = place @ _transform(element.get("transform", ""))
        parts = _shape(tag, element)
        if parts is None:
            if tag not in ("svg", "g", "a"):
                left[tag] += 1
                return
        else:
            label = element.get("id") or f"{tag}_{len(curves) + 1}"
            for pieces in parts:
                if pieces:
                    own = joined([_placed(piece, place) for piece in pieces])
                    curves[identifier(label, taken)] = own
        for child in element:
            walk(child, place)

    try:
        walk(root, up)
    except RecursionError:
        raise FileError("its elements are nested too deep") from None
    remarks = tuple(f"{count} elements {tag} are left out" for tag, count in left.items())
    return Overlay(name, curves=curves, remarks=remarks), _unit(root)


def _tag(element: ElementTree.Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _unit(root: ElementTree.Element) -> float | None:
    """Size of a user unit in metres, from the width and the view box."""
    size = re.fullmatch(rf"\s*({_NUMBER})\s*(mm|cm|in|pt|pc|px|Q)\s*", root.get("width", ""))
    if size is None:
        return None
    metres = _number(size[1]) * _METRES[size[2]]
    box = [_number(x) for x in re.findall(_NUMBER, root.get("viewBox", ""))]
    if len(box) == 4 and box[2] > 0:
        return metres / box[2]
    return _METRES["px"]


def _transform(text: str) -> Floats:
    """The matrix of a list of transforms."""
    place: Floats = np.eye(3)
    for word, inner in re.findall(r"(\w+)\s*\(([^)]*)\)", text):
        n = [_number(x) for x in re.findall(_NUMBER, inner)]
        own = np.eye(3)
        if word == "matrix" and len(n) == 6:
            own[:2] = np.array([[n[0], n[2], n[4]], [n[1], n[3], n[5]]])
        elif word == "translate" and len(n) in (1, 2):
            own[:2, 2] = n[0], n[1] if len(n) > 1 else 0.0
        elif word == "scale" and len(n) in (1, 2):
            own[0, 0], own[1, 1] = n[0], n[-1]
        elif word == "rotate" and len(n) in (1, 3):
            c, s = math.cos(math.radians(n[0])), math.sin(math.radians(n[0]))
            own[:2, :2] = np.array([[c, -s], [s, c]])
            if len(n) == 3:
                centre = np.array(n[1:])
                own[:2, 2] = centre - own[:2, :2] @ centre
        elif word == "skewX" and len(n) == 1:
            own[0, 1] = math.tan(math.radians(n[0]))
        elif word == "skewY" and len(n) == 1:
            own[1, 0] = math.tan(math.radians(n[0]))
        else:
            raise FileError(f"not a transform of SVG: `{word}({inner})`")
        place = place @ own
    return place


def _placed(piece: Floats, place: Floats) -> Floats:
    """A transformed piece; points are homogeneous, so the weight is transformed as well."""
    moved: Floats = piece.copy()
    flat = piece[:, [0, 1, 3]]
    moved[:, :2] = flat @ place[:2].T
    return moved


def _length(element: ElementTree.Element, key: str, default: float = 0.0) -> float:
    text = element.get(key)
    if text is None:
        return default
    match = re.fullmatch(rf"\s*({_NUMBER})\s*(mm|cm|in|pt|pc|px|Q|)\s*", text)
    if match is None:
        raise FileError(f'{_tag(element)}: {key} = "{text}" is not a length')
    return _number(match[1]) * _METRES[match[2]] / _METRES["px"]


def _shape(tag: str, element: ElementTree.Element) -> list[list[Floats]] | None:
    """The pieces of each part of an element; None if the element is not a shape."""
    if tag == "path":
        return _path(element.get("d", ""), element.get("id") or "path")
    if tag == "line":
        a, b = (_xyz(_length(element, f"x{k}"), _length(element, f"y{k}")) for k in (1, 2))
        return [_lines([a, b])]
    if tag in ("polyline", "polygon"):
        n = [_number(x) for x in re.findall(_NUMBER, element.get("points", ""))]
        at = [_xyz(x, y) for x, y in zip(n[::2], n[1::2], strict=False)]
        return [_lines(at + at[:1] if tag == "polygon" else at)]
    if tag in ("circle", "ellipse"):
        rx, ry = (_length(element, r, _length(element, "r")) for r in ("rx", "ry"))
        if not (rx > 0 and ry > 0):
            return [[]]
        centre = _xyz(_length(element, "cx"), _length(element, "cy"))
        return [arc(centre, _xyz(rx, 0), _xyz(0, ry), 0, 2 * math.pi)]
    if tag == "rect":
        return [_rectangle(element)]
    return None


def _rectangle(element: ElementTree.Element) -> list[Floats]:
    x, y, w, h = (_length(element, key) for key in ("x", "y", "width", "height"))
    if not (w > 0 and h > 0):
        return []
    rx = _length(element, "rx", _length(element, "ry"))
    ry = _length(element, "ry", rx)
    rx, ry = min(rx, w / 2), min(ry, h / 2)
    if not (rx > 0 and ry > 0):
        corners = [_xyz(x, y), _xyz(x + w, y), _xyz(x + w, y + h), _xyz(x, y + h)]
        return _lines(corners + corners[:1])
    pieces: list[Floats] = []
    quarter = math.pi / 2
    left, right, top, bottom = x + rx, x + w - rx, y + ry, y + h - ry
    centres = [(right, top), (right, bottom), (left, bottom), (left, top)]
    at = _xyz(x + rx, y)
    for k, centre in enumerate(centres):
        turn = arc(_xyz(*centre), _xyz(rx, 0), _xyz(0, ry), (k - 1) * quarter, k * quarter)
        pieces += [*_lines([at, turn[0][0, :3]]), *turn]
        at = turn[-1][-1, :3]
    return pieces


def _xyz(x: float, y: float) -> Floats:
    return np.array([x, y, 0.0])


def _lines(at: list[Floats]) -> list[Floats]:
    return [line(a, b) for a, b in pairwise(at) if (a != b).any()]


def _path(text: str, label: str) -> list[list[Floats]]:
    """The parts of a path (SVG 1.1, section 8.3)."""
    tokens = _tokens(text, label)
    parts: list[list[Floats]] = []
    at = start = _xyz(0, 0)
    last = ""
    handle = at
    k = 0
    counts = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
    while k < len(tokens):
        if isinstance(tokens[k], str):
            command = str(tokens[k])
            k += 1
        elif last.upper() in ("", "Z"):
            raise FileError(f"path `{label}`: a number where a command must be")
        else:
            # Further coordinates repeat the command; those of a move are lines.
            command = {"M": "L", "m": "l"}.get(last, last)
        kind = command.upper()
        n = tokens[k : k + counts[kind]]
        if len(n) < counts[kind] or any(isinstance(x, str) for x in n):
            needed = f"`{command}` needs {counts[kind]} numbers, found {len(n)}"
            raise FileError(f"path `{label}`: {needed}")
        k += counts[kind]
        numbers = [float(x) for x in n]
        base = at if command.islower() else _xyz(0, 0)
        own = parts[-1] if parts else []
        if not parts and kind != "M":
            raise FileError(f"path `{label}`: it begins with `{command}`, not with a move")
        if kind == "M":
            at = start = base + _xyz(*numbers)
            parts.append([])
            handle = at
        elif kind == "Z":
            own += _lines([at, start])
            at = handle = start
            parts.append([])
        elif kind in "LHV":
            if kind == "L":
                to = base + _xyz(*numbers)
            elif kind == "H":
                to = _xyz(base[0] + numbers[0], at[1])
            else:
                to = _xyz(at[0], base[1] + numbers[0])
            own += _lines([at, to])
            at = handle = to
        elif kind == "A":
            to = base + _xyz(*numbers[5:])
            own += _svg_arc(at, to, *numbers[:5])
            at = handle = to
        else:
            places = [base + _xyz(*numbers[i : i + 2]) for i in range(0, len(numbers), 2)]
            smooth = {"S": "CS", "T": "QT"}.get(kind)
            if smooth:
                # The first handle mirrors the last one of the curve before.
                before = handle if last and last.upper() in smooth else at
                places.insert(0, 2 * at - before)
            own.append(bezier(at, *places))
            handle, at = places[-2], places[-1]
        last = command
    return [part for part in parts if part]


def _tokens(text: str, label: str) -> list[str | float]:
    """Commands and numbers; flags of arcs may follow each other without separators."""
    found: list[str | float] = []
    command, count, k = "", 0, 0
    while k < len(text):
        flag = command in ("A", "a") and count % 7 in (3, 4) and text[k] in "01"
        match = _TOKEN.match(text, k)
        assert match is not None
        if flag:
            found.append(_number(text[k]))
            count += 1
            k += 1
            continue
        k = match.end()
        if match[1]:
            command, count = match[1], 0
            found.append(command)
        elif match[2]:
            found.append(_number(match[2]))
            count += 1
        elif match[4]:
            raise FileError(f"path `{label}`: `{match[4]}` is not of a path")
    return found


def _svg_arc(
    at: Floats, to: Floats, rx: float, ry: float, turn: float, large: float, sweep: float
) -> list[Floats]:
    """An arc by its ends (SVG 1.1, appendix F.6)."""
    rx, ry = abs(rx), abs(ry)
    if not (at != to).any():
        return []
    if rx == 0 or ry == 0:
        return _lines([at, to])
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    dx, dy = (at - to)[:2] / 2
    x, y = c * dx + s * dy, -s * dx + c * dy
    grow = (x / rx) ** 2 + (y / ry) ** 2
    if grow > 1:
        rx, ry = rx * math.sqrt(grow), ry * math.sqrt(grow)
    rest = (rx * ry) ** 2 - (rx * y) ** 2 - (ry * x) ** 2
    share = math.sqrt(max(rest, 0.0) / ((rx * y) ** 2 + (ry * x) ** 2))
    if bool(large) == bool(sweep):
        share = -share
    cx, cy = share * rx * y / ry, -share * ry * x / rx
    centre = (at + to) / 2 + _xyz(c * cx - s * cy, s * cx + c * cy)
    first = math.atan2((y - cy) / ry, (x - cx) / rx)
    last = math.atan2((-y - cy) / ry, (-x - cx) / rx)
    if sweep and last < first:
        last += 2 * math.pi
    elif not sweep and last > first:
        last -= 2 * math.pi
    pieces = arc(centre, rx * _xyz(c, s), ry * _xyz(-s, c), first, last)
    # The ends are as they are written.
    pieces[0][0, :3], pieces[-1][-1, :3] = at, to
    return pieces
