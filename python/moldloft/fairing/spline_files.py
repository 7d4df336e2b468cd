"""Spline curves as IGES (entity 126), STEP, DXF (SPLINE), 3DM and JSON files."""

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

__all__ = ["MILLIMETRES", "POINTS", "SPLINES", "encoded"]

POINTS = (".csv", ".tsv", ".txt", ".dat", ".xyz", ".pts")
"""Endings of files of points."""

SPLINES = (".igs", ".iges", ".stp", ".step", ".dxf", ".3dm", ".json")
"""Extensions of formats with exact splines."""

MILLIMETRES = (".igs", ".iges", ".stp", ".step", ".3dm")
"""Extensions of formats that state millimetres by default."""


_IGES_UNITS = {"in": (1, "INCH"), "mm": (2, "MM"), "ft": (4, "FT"), "m": (6, "M"), "cm": (10, "CM")}
"""Flags and names of units in IGES."""


def encoded(
    curves: Sequence[Spline], path: Path, unit: str | None = None, names: Sequence[str] = ()
) -> bytes:
    """The curves in the format of the extension of ``path``.

    ``unit`` is that of the coordinates: m, cm, mm, ft or in. Without a unit, IGES, STEP and 3DM
    files state millimetres, since they require one; DXF and JSON state none. ``names`` are those of
    the curves, which STEP and 3DM have. 3DM needs rhino3dm.

    Raises
    ------
    FairingError
        If the ending is none of :data:`SPLINES`.
    """
    ending = path.suffix.lower()
    if ending in (".igs", ".iges"):
        return _iges(curves, path.name, unit)
    if ending in (".stp", ".step"):
        return _step(curves, path.name, unit, names)
    if ending == ".3dm":
        return _rhino(curves, unit, names)
    if ending == ".dxf":
        return _dxf(curves, unit)
    if ending == ".json":
        return _json(curves, unit)
    known = ", ".join((*POINTS, *SPLINES))
    raise FairingError(f"`{path}`: expected an ending of {known}")


def _number(x: float) -> str:
    """A number with a decimal point that is read back exactly."""
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
    """Parameters with their delimiters, wrapped between parameters."""
    lines, line = [], ""
    for k, word in enumerate(words):
        item = word + (";" if k == len(words) - 1 else ",")
        if len(line) + len(item) > width:
            lines.append(line)
            line = ""
        line += item
    return [*lines, line]


def _is_flat(points: np.ndarray) -> tuple[float, float, float] | None:
    """The unit normal of the plane of points, if they are coplanar."""
    away = points - points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(away, full_matrices=False)
    if len(sizes) < 3 or sizes[2] > 1e-12 * max(float(sizes[0]), 1e-300):
        return None
    n = axes[2] if axes[2][int(np.argmax(np.abs(axes[2])))] > 0 else -axes[2]
    return float(n[0]), float(n[1]), float(n[2])


_STEP_UNITS = {
    "m": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))",
    "cm": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.))",
    "mm": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))",
}
_IN_METRES = {"in": ("INCH", 0.0254), "ft": ("FOOT", 0.3048)}


def _step(curves: Sequence[Spline], name: str, unit: str | None, names: Sequence[str]) -> bytes:
    """STEP AP214, the curves as a set of a wireframe."""
    lines: list[str] = []

    def add(text: str) -> str:
        lines.append(f"#{len(lines) + 1}={text};")
        return f"#{len(lines)}"

    def text_of(text: str) -> str:
        return text.encode("ascii", "replace").decode().replace("'", "''")

    title = text_of(name)
    metre = add(_STEP_UNITS["m"])
    length = metre
    if unit in _IN_METRES:
        word, metres = _IN_METRES[unit]
        size = add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")
        ratio = add(f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({metres}),{metre})")
        length = add(f"(CONVERSION_BASED_UNIT('{word}',{ratio})LENGTH_UNIT()NAMED_UNIT({size}))")
    elif unit != "m":
        length = add(_STEP_UNITS[unit or "mm"])
    angle = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid = add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    accuracy = add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-9),{length},'accuracy','')")
    context = add(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
        f"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid}))REPRESENTATION_CONTEXT('',''))"
    )
    made = []
    for k, curve in enumerate(curves):
        knots, points, weights = curve.open_form()
        called = text_of(names[k]) if names else f"curve {k + 1}"
        places = [
            add(f"CARTESIAN_POINT('',({','.join(map(_number, p))}))") for p in points.tolist()
        ]
        each, counts = np.unique(knots, return_counts=True)
        poles = f"({','.join(places)})"
        whole = f"({','.join(map(str, counts))}),({','.join(map(_number, each))}),.UNSPECIFIED."
        closed = ".T." if curve.closed else ".F."
        form = f"{curve.degree},{poles},.UNSPECIFIED.,{closed},.F."
        if weights is None:
            made.append(add(f"B_SPLINE_CURVE_WITH_KNOTS('{called}',{form},{whole})"))
            continue
        made.append(
            add(
                f"(BOUNDED_CURVE()B_SPLINE_CURVE({form})B_SPLINE_CURVE_WITH_KNOTS({whole})"
                "CURVE()GEOMETRIC_REPRESENTATION_ITEM()"
                f"RATIONAL_B_SPLINE_CURVE(({','.join(map(_number, weights))}))"
                f"REPRESENTATION_ITEM('{called}'))"
            )
        )
    every = add(f"GEOMETRIC_CURVE_SET('',({','.join(made)}))")
    shape = add(f"GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('',({every}),{context})")
    application = add("APPLICATION_CONTEXT('automotive design')")
    add(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,"
        f"{application})"
    )
    product_context = add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    product = add(f"PRODUCT('{title}','{title}','',({product_context}))")
    formation = add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    design = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = add(f"PRODUCT_DEFINITION('','',{formation},{design})")
    of_shape = add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    add(f"SHAPE_DEFINITION_REPRESENTATION({of_shape},{shape})")
    head = [
        "ISO-10303-21;",
        "HEADER;",
        "FILE_DESCRIPTION(('Spline curves'),'2;1');",
        f"FILE_NAME('{title}','2000-01-01T00:00:00',(''),(''),'moldloft','moldloft','');",
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));",
        "ENDSEC;",
        "DATA;",
    ]
    return "\n".join([*head, *lines, "ENDSEC;", "END-ISO-10303-21;", ""]).encode("ascii")


def _rhino(curves: Sequence[Spline], unit: str | None, names: Sequence[str]) -> bytes:
    """3DM, a NURBS curve each."""
    from moldloft.cad import needed
    from moldloft.cad.rhino import UNIT_SYSTEMS, file_bytes

    rhino = needed("rhino3dm", "rhino3dm", "writing 3DM")
    file = rhino.File3dm()
    file.Settings.ModelUnitSystem = getattr(rhino.UnitSystem, UNIT_SYSTEMS[unit or "mm"])
    for k, curve in enumerate(curves):
        knots, points, weights = curve.open_form()
        count, order = len(points), curve.degree + 1
        made = rhino.NurbsCurve(3, weights is not None, order, count)
        for i, (x, y, z) in enumerate(points.tolist()):
            w = 1.0 if weights is None else float(weights[i])
            made.Points[i] = rhino.Point4d(x * w, y * w, z * w, w)
        # rhino3dm keeps knots without the first and the last.
        for i, knot in enumerate(knots[1:-1]):
            made.Knots[i] = float(knot)
        attributes = rhino.ObjectAttributes()
        attributes.Name = names[k] if names else f"curve {k + 1}"
        file.Objects.AddCurve(made, attributes)
    return file_bytes(file)


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
