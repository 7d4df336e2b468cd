"""Spline curves as files of others: IGES (entity 126), DXF (SPLINE) and JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from moldloft.arguments import explain
from moldloft.cad.dxf import UNITS
from moldloft.errors import FairingError

if TYPE_CHECKING:
    from moldloft.fairing.spline import Spline

__all__ = ["POINTS", "SPLINES", "encoded"]

POINTS = (".csv", ".tsv", ".txt", ".dat", ".xyz", ".pts")
"""Endings of files of points."""

SPLINES = (".igs", ".iges", ".dxf", ".json")
"""Endings of files that hold the splines themselves."""


_IGES_UNITS = {"in": (1, "INCH"), "mm": (2, "MM"), "ft": (4, "FT"), "m": (6, "M"), "cm": (10, "CM")}
"""Flags and names of units in IGES."""


def encoded(curves: Sequence[Spline], path: Path, unit: str | None = None) -> bytes:
    """The curves in the format that the ending of ``path`` names.

    ``unit`` is that of the coordinates: m, cm, mm, ft or in. Of none IGES says millimetres, as it
    has no word for that; DXF and JSON say nothing.

    Raises
    ------
    FairingError
        When the ending is none of :data:`SPLINES`.
    """
    ending = path.suffix.lower()
    if ending in (".igs", ".iges"):
        return _iges(curves, path.name, unit)
    if ending == ".dxf":
        return _dxf(curves, unit)
    if ending == ".json":
        return _json(curves, unit)
    known = ", ".join((*POINTS, *SPLINES))
    raise FairingError(f"`{path}`: expected an ending of {known}")


def _number(x: float) -> str:
    """A number that reads back to the bit, with a decimal point."""
    text = repr(float(x) + 0.0)
    return text if any(c in text for c in ".en") else text + "."


def _json(curves: Sequence[Spline], unit: str | None) -> bytes:
    def one(curve: Spline) -> dict[str, object]:
        knots, points, weights = curve.open_form()
        return {
            "degree": curve.degree,
            "closed": curve.closed,
            "knots": [float(k) for k in knots],
            "control_points": points.tolist(),
            "weights": weights,
        }

    data = {"unit": unit, "splines": [one(c) for c in curves]}
    return (json.dumps(data, indent=1) + "\n").encode()


def _iges(curves: Sequence[Spline], name: str, unit: str | None) -> bytes:
    """IGES 5.3, one rational B-spline curve (type 126, form 0) each."""
    directory: list[str] = []
    parameters: list[str] = []
    for curve in curves:
        knots, points, weights = curve.open_form()
        plain = weights is None
        flat = _is_flat(points)
        # The last index of control points, degree, planar, closed, polynomial, periodic.
        words = ["126", str(len(points) - 1), str(curve.degree), str(int(flat is not None))]
        ends = np.linalg.norm(curve(0.0) - curve(1.0)) <= 1e-12 * np.ptp(points, axis=0).max()
        words += [str(int(curve.closed or bool(ends))), str(int(plain)), "0"]
        words += [_number(k) for k in knots]
        words += [_number(w) for w in (weights if weights is not None else [1.0] * len(points))]
        words += [_number(x) for p in points for x in p]
        low, high = float(knots[curve.degree]), float(knots[len(points)])
        words += [_number(low), _number(high), *map(_number, flat or (0.0, 0.0, 0.0))]
        lines = _wrapped(words, 64)
        at, first = len(directory) + 1, len(parameters) + 1
        fields = [126, first, 0, 0, 0, 0, 0, 0]
        directory.append("".join(f"{f:8d}" for f in fields) + "00000000")
        directory.append(f"{126:8d}{0:8d}{0:8d}{len(lines):8d}{0:8d}{'':16}{'':8}{0:8d}")
        parameters += [f"{line:<64}{at:8d}" for line in lines]
    title = name.encode("ascii", "replace").decode()
    extent = max(float(np.abs(c.control_points).max()) for c in curves)
    words = ["1H,", "1H;", _hollerith("moldloft"), _hollerith(title), _hollerith("moldloft")]
    words += [_hollerith("1"), "32", "38", "6", "308", "15", _hollerith("moldloft"), "1.0"]
    flag, unit_name = _IGES_UNITS[unit or "mm"]
    words += [
        str(flag),
        _hollerith(unit_name),
        "1",
        "1.0",
        _hollerith("20000101.000000"),
        "1.0E-9",
        _number(extent),
    ]
    words += ["", "", "11", "0", _hollerith("20000101.000000")]
    start = ["Spline curves"]
    sections = [("S", start), ("G", _wrapped(words, 72)), ("D", directory), ("P", parameters)]
    out = []
    for letter, lines in sections:
        out += [f"{line:<72}{letter}{k:7d}" for k, line in enumerate(lines, 1)]
    counts = "".join(f"{letter}{len(lines):7d}" for letter, lines in sections)
    out.append(f"{counts:<72}T{1:7d}")
    return ("\n".join(out) + "\n").encode("ascii")


def _hollerith(text: str) -> str:
    return f"{len(text)}H{text}"


def _wrapped(words: list[str], width: int) -> list[str]:
    """Parameters with their delimiters in lines of a width; none is broken."""
    lines, line = [], ""
    for k, word in enumerate(words):
        item = word + (";" if k == len(words) - 1 else ",")
        if len(line) + len(item) > width:
            lines.append(line)
            line = ""
        line += item
    return [*lines, line]


def _is_flat(points: np.ndarray) -> tuple[float, float, float] | None:
    """The unit normal of the plane that points lie in."""
    away = points - points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(away, full_matrices=False)
    if len(sizes) < 3 or sizes[2] > 1e-12 * max(float(sizes[0]), 1e-300):
        return None
    n = axes[2] if axes[2][int(np.argmax(np.abs(axes[2])))] > 0 else -axes[2]
    return float(n[0]), float(n[1]), float(n[2])


def _dxf(curves: Sequence[Spline], unit: str | None) -> bytes:
    """DXF R2000, one SPLINE each."""
    pairs: list[tuple[int, object]] = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER")]
    pairs += [(1, "AC1015")]
    if unit is not None:
        pairs += [(9, "$INSUNITS"), (70, UNITS[unit])]
    pairs += [(0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]
    for k, curve in enumerate(curves):
        knots, points, weights = curve.open_form()
        flat = _is_flat(points)
        flags = (8 if flat else 0) + (4 if weights is not None else 0)
        pairs += [(0, "SPLINE"), (5, f"{0x30 + k:X}"), (100, "AcDbEntity"), (8, "0")]
        pairs += [(100, "AcDbSpline")]
        if flat:
            pairs += list(zip((210, 220, 230), map(_number, flat), strict=True))
        pairs += [(70, flags), (71, curve.degree), (72, len(knots)), (73, len(points)), (74, 0)]
        pairs += [(40, _number(x)) for x in knots]
        if weights is not None:
            pairs += [(41, _number(w)) for w in weights]
        for p in points:
            pairs += list(zip((10, 20, 30), map(_number, p), strict=True))
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    return ("".join(f"{code:3d}\n{value}\n" for code, value in pairs)).encode("ascii")


explain(globals())
