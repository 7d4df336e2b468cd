"""CAD files as programs, with faces as surfaces that other objects can use."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.budget import within_limits
from moldloft.cad.apart import read
from moldloft.cad.divisions import cone_volume, divisions
from moldloft.cad.faces import Imported, ImportedFace, align, together
from moldloft.cad.joining import joins
from moldloft.cad.placing import components, control, placing_of
from moldloft.colours import MODEL
from moldloft.errors import Error, FileError
from moldloft.shapes.nurbs import Nurbs, _braced, _plain, _wrapped

if TYPE_CHECKING:
    import os

    from moldloft.models import Model

__all__ = ["UNITS", "imported", "load_cad", "program", "programs"]

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
"""Units of length in metres."""

ENDINGS = (".step", ".stp", ".stpz", ".iges", ".igs", ".3dm", ".brep", ".brp")
"""The endings of the files that are read."""


def program(path: str | os.PathLike[str], *, units: str = "m") -> tuple[str, list[str]]:
    """A CAD file as a program, with remarks about doubtful and omitted parts.

    A face on the whole of its surface becomes a ``NURBSurf``; others become a hidden ``NURBSurf``,
    snakes along their loops and a ``TrimSurf``. An edge common to faces in the file becomes a
    ``Join``. Curves that bound no face become ``NURBCurve``.

    Parameters
    ----------
    path
        A STEP, IGES, 3DM or BREP file.
    units
        The unit of length of the model: m, cm, mm, ft or in. Lengths are converted into it.

    Raises
    ------
    FormatError
        If the file cannot be read.
    """
    text, _, remarks = imported(path, units=units)
    return text, remarks


def imported(path: str | os.PathLike[str], *, units: str = "m") -> tuple[str, Model, list[str]]:
    """A CAD file as a program, its model, and remarks; see :func:`program`.

    Parameters
    ----------
    path
        A STEP, IGES, 3DM or BREP file.
    units
        The unit of length of the model.
    """
    if units not in UNITS:
        raise Error(f"unknown unit `{units}`; expected one of: {', '.join(UNITS)}")
    path = Path(path)
    found = _read(path, units, parts=False)
    with within_limits(f"cannot read `{path}`"):
        # Joins may add remarks.
        text, model = _loadable(found, path.name, units)
    return text, model, found.remarks


def programs(
    path: str | os.PathLike[str], target: str, *, units: str = "m"
) -> tuple[dict[str, str], list[str]]:
    """A CAD file as programs by file name, the first with the others as components, and remarks.

    A product of a STEP file that is placed more than once is a program of its own, which a
    ``Component`` places by its ``origin``, ``x_axis`` and ``y_axis``. Everything else is as in
    :func:`program`.

    Parameters
    ----------
    path
        A STEP, IGES, 3DM or BREP file.
    target
        File name of the first program; the others are named after it and their product.
    units
        The unit of length of the model.
    """
    path = Path(path)
    found = _read(path, units, parts=True)
    stem = re.sub(r'["\\]', "_", Path(target).stem)
    names = {name: f"{stem}.{name}.sdl" for name in found.parts}
    texts = {}
    with within_limits(f"cannot read `{path}`"):
        for name, part in [(target, found), *found.parts.items()]:
            text, _ = _loadable(part, path.name, units)
            texts[names.get(name, target)] = text + components(part, names)
            if part is not found:
                found.remarks += [f"{name}: {remark}" for remark in part.remarks]
        if found.parts:
            found.remarks += _inward(_whole_model(texts, target))
    return texts, found.remarks


def _read(path: Path, units: str, *, parts: bool) -> Imported:
    """The content of a file, the sides of common edges aligned."""
    if units not in UNITS:
        raise Error(f"unknown unit `{units}`; expected one of: {', '.join(UNITS)}")
    if path.suffix.lower() not in ENDINGS:
        raise Error(f"`{path}` is no CAD file by its ending; expected one of: {', '.join(ENDINGS)}")
    found = read(path, UNITS[units], components=parts)
    with within_limits(f"cannot read `{path}`"):
        held = [found, *found.parts.values()]
        for part in held:
            align(part.faces)
        colours = [face.colour for part in held for face in part.faces]
        if any(colour is not None and not _is_own(colour) for colour in colours):
            found.remarks.append("colours become the nearest of the sixteen of a model")
    return found


def _whole_model(texts: Mapping[str, str], target: str) -> Model:
    """The model of a program with its components."""
    from moldloft.loading import load

    with TemporaryDirectory() as folder:
        for name, text in texts.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        return load(Path(folder) / target)


def _inward(model: Model) -> list[str]:
    """A remark on closed panels that face inward."""
    try:
        mesh = model.mesh()
    except Error:
        return []
    if mesh.closed and mesh.volume < 0:
        return ["the panels of the bodies face inward: their volume is negative"]
    return []


_MOST_TRIES = 8
"""Maximum number of removals of failed statements before a program is given up."""


def _loadable(found: Imported, name: str, units: str) -> tuple[str, Model]:
    """A program that loads, and its model: statements that fail are omitted, with remarks."""
    from moldloft.loading import loads

    apart: set[str] = set()
    finer: dict[str, float] = {}
    said = list(found.remarks)
    for _ in range(_MOST_TRIES):
        found.remarks[:] = said
        text = _text(found, name, units, frozenset(apart), finer)
        model = loads(text, name=f"{Path(name).stem}.sdl", strict=False)
        # Some of what does not join is noticed when panels are made.
        with contextlib.suppress(Error):
            model.mesh()
        faults = [d for d in model.diagnostics if d.is_error]
        if not faults:
            shares, missed = _missed(found, model)
            if not shares or any(finer.get(face, 1.0) >= _FINEST for face in shares):
                found.remarks += missed + _inward(model) + _open(found, model)
                return text, model
            for name_of, share in shares.items():
                # What a panel misses is as the square of its size.
                factor = max(1.2, (1.2 * share / _PROMISE) ** 0.5)
                # In steps: the same part has the same divisions wherever it is placed.
                finer[name_of] = min(finer.get(name_of, 1.0) * np.ceil(4 * factor) / 4, _FINEST)
            continue
        words = set().union(*(_blamed(d, text) for d in faults))
        joined = {word for word in words if re.fullmatch(r"join\d+_*", word)} - apart
        lost = [face for face in found.faces if _own_names(face) & words]
        if joined:
            apart |= joined
            said.append(
                f"{len(joined)} shared edges are not joined: their faces are not one along them "
                f"({faults[0].message})"
            )
        elif lost:
            gone = {face.name for face in lost}
            found.faces[:] = [face for face in found.faces if face.name not in gone]
            said += [f"face `{name}` is left out: {faults[0].message}" for name in sorted(gone)]
        else:
            break
    raise FileError(f"cannot read `{name}`: what was read of it makes no model: {faults[0]}")


_PROMISE = 1e-3
"""Largest relative difference of area between a face's panels and the face, and of volume."""

_EXACT = 1e-5
"""Relative difference of area below which a face is not the cause of a missed volume."""


_FAR = 1e-5
"""Volume, relative to the cones from the origin to the faces, below which these do not give it."""

_FINEST = 16.0
"""Largest factor of the divisions of a whole face."""


def _missed(found: Imported, model: Model) -> tuple[dict[str, float], list[str]]:
    """Whole faces that need more divisions, with what is missed, and remarks on what is missed."""
    try:
        mesh = model.mesh()
    except Error:
        return {}, []
    patches = {patch.name: patch for patch in mesh.patches}
    beside: dict[int, set[str]] = {}
    for face in found.faces:
        for side in face.sides if face.natural else ():
            beside.setdefault(side.edge, set()).add(face.name)
    shares: dict[str, float] = {}
    by_face: dict[str, float] = {}
    said = []
    for face in found.faces:
        if face.name not in patches:
            continue
        area, panels = model[face.name].area, patches[face.name].area
        share = by_face[face.name] = abs(panels / area - 1) if area else 0.0
        if share <= _PROMISE:
            continue
        said.append(
            f"panels of `{face.name}` have an area of {panels:.6g}, {panels / area - 1:+.1e} "
            f"of that of the face, {area:.6g}: state finer `divisions`, or a tolerance"
        )
        # The rim of a trimmed face has the divisions of its whole neighbours.
        around = set().union(*(beside.get(side.edge, ()) for side in face.sides))
        for name in [face.name] if face.natural else around:
            shares[name] = max(shares.get(name, 0.0), share)
    if not mesh.closed or len(by_face) < len(found.faces):
        return shares, said
    for body in _bodies(found):
        cones = {
            face.name: cone_volume(face.surface) if face.natural else model[face.name].volume
            for face in body
        }
        panels = sum(patches[name].volume for name in cones)
        # The sides are those of the panels.
        volume = sum(
            min((cone, -cone), key=lambda x: abs(x - patches[name].volume))
            for name, cone in cones.items()
        )
        share = abs(panels / volume - 1) if volume else 0.0
        if share <= _PROMISE or abs(volume) < _FAR * max(map(abs, cones.values())):
            continue
        said.append(
            f"the panels of the body of `{body[0].name}` enclose {abs(panels):.6g}, "
            f"{panels / volume - 1:+.1e} of its volume {abs(volume):.6g}: state finer "
            "`divisions`, or a tolerance"
        )
        for face in body:
            if face.natural and by_face[face.name] > _EXACT:
                shares[face.name] = max(shares.get(face.name, 0.0), share)
    return shares, said


def _open(found: Imported, model: Model) -> list[str]:
    """Remarks on bodies whose panels are open along edges that are short for their area."""
    try:
        mesh = model.mesh()
        edges = [] if mesh.closed else mesh.closure()["edges"]
    except Error:
        return []
    areas = {patch.name: patch.area for patch in mesh.patches}
    said = []
    for body in _bodies(found):
        names = {face.name for face in body} & areas.keys()
        loose = [edge for edge in edges if edge["patch"] in names]
        length = sum(edge["length"] for edge in loose)
        if 0 < length < sum(areas[name] for name in names) ** 0.5:
            along = ", ".join(f"`{name}`" for name in sorted({edge["patch"] for edge in loose}))
            said.append(
                f"the panels of the body of `{body[0].name}` are open along {along}, "
                f"over a length of {length:.3g}"
            )
    return said


def _bodies(found: Imported) -> list[list[ImportedFace]]:
    """The faces that hang together along edges."""
    of_edge: dict[int, int] = {}
    sides = ((k, side.edge) for k, face in enumerate(found.faces) for side in face.sides)
    group = together(len(found.faces), ((of_edge.setdefault(edge, k), k) for k, edge in sides))
    bodies: dict[int, list[ImportedFace]] = {}
    for k, face in enumerate(found.faces):
        bodies.setdefault(group[k], []).append(face)
    return list(bodies.values())


def _blamed(fault: Any, text: str) -> set[str]:
    """Objects that may cause a fault: those named in its message, and that of its statement."""
    words = set(re.findall(r"`(\w+)`", str(fault.message)))
    if fault.object:
        words.add(fault.object)
    if fault.primary is not None:
        for line in reversed(text.splitlines()[: fault.primary.line]):
            # Statements begin at the margin.
            if begun := re.match(r"\w+ (\w+)\(", line):
                words.add(begun[1])
                break
    return words


def _own_names(face: ImportedFace) -> set[str]:
    """Names of the objects made from a face."""
    sides = {
        f"{face.name}_s{c}_{k}" for c, cycle in enumerate(face.loops) for k in range(len(cycle))
    }
    return {face.name, f"{face.name}_surface", *sides}


def load_cad(path: str | os.PathLike[str], *, units: str = "m") -> Model:
    """A model of a CAD file; see :func:`program`. Remarks are warnings of Python."""
    import warnings

    _, model, remarks = imported(path, units=units)
    for remark in remarks:
        warnings.warn(f"{path}: {remark}", stacklevel=2)
    return model


def _text(
    found: Imported,
    name: str,
    units: str,
    apart: frozenset[str],
    finer: Mapping[str, float],
) -> str:
    lines = []
    taken = {face.name for face in found.faces} | {*found.curves, *found.reserved}
    moved = bool(found.reserved)
    counts = divisions(found.faces, finer)
    for face in found.faces:
        if face.natural:
            lines += _whole(face, taken, counts[face.name], moved)
        else:
            lines += _trimmed(face, taken, moved)
    lines += joins(found, taken, apart)
    for label, curve in found.curves.items():
        lines.append(curve._statement(label, {}, control(curve, {}, moved)))
    body = "\n".join(lines) + "\n"
    head = f'# {name}\nModel info(units = "{units}");\n'
    if moved:
        head += placing_of(body, found)
    return head + body


def _attributes(face: ImportedFace) -> str:
    """Name, colour and other attributes of a face, as the end of its statement."""
    orientation = face.reversed + 2 * face.cavity
    text = f", orientation = {orientation}" if orientation else ""
    if face.colour is not None:
        text += f", colour = {nearest_colour(face.colour)}"
    if face.tags:
        named = ", ".join(f'"{tag}"' for tag in face.tags)
        text += f", tags = {{{named}}}" if len(face.tags) > 1 else f", tags = {named}"
    return text + ");"


_PALETTE = np.array([[int(colour[k : k + 2], 16) for k in (1, 3, 5)] for colour in MODEL])
"""The sixteen colours of model files, sRGB."""


def nearest_colour(rgb: tuple[float, float, float]) -> int:
    """Index of the model colour nearest to a colour of a file.

    Parameters
    ----------
    rgb
        sRGB, 0 to 1.

    Examples
    --------
    >>> nearest_colour((1.0, 0.1, 0.0)), nearest_colour((0.0, 0.0, 0.6))
    (4, 1)
    """
    return int(np.argmin(((_PALETTE - np.array(rgb) * 255) ** 2).sum(axis=1)))


def _is_own(rgb: tuple[float, float, float]) -> bool:
    """True for a colour of the model's palette, to the nearest of 256 levels."""
    return np.array_equal(_PALETTE[nearest_colour(rgb)], np.rint(np.array(rgb) * 255))


_POLE = 1e-9
"""Size of an edge's control points, relative to the model, below which they are one point."""


def _poles(surface: Nurbs) -> list[tuple[Any, Any]]:
    """The edges that are points: numbers of their control points, and the point."""
    net = surface.points
    flat = net.reshape(-1, 3)
    near = _POLE * float(np.ptp(flat, axis=0).max())
    numbers = np.arange(len(flat)).reshape(net.shape[:2])
    edges = numbers[:, 0], numbers[-1], numbers[:, -1], numbers[0]
    return [(e, flat[e].mean(axis=0)) for e in edges if np.ptp(flat[e], axis=0).max() <= near]


def _whole(face: ImportedFace, taken: set[str], counts: tuple[int, int], moved: bool) -> list[str]:
    """A surface; a degenerate edge uses a single point object, which marks the pole for panels."""
    lines: list[str] = []
    named: dict[int, str] = {}
    for edge, place in _poles(face.surface):
        pole = f"{face.name}_pole{len(lines) + 1}"
        while pole in taken:
            pole += "_"
        taken.add(pole)
        at = ", ".join(map(_plain, place))
        if moved:
            at = ", ".join(f"at({{{at}}}).{axis}" for axis in "xyz")
        lines.append(f"AbsPoint {pole}({at}, visible = 0);")
        named |= dict.fromkeys(edge.tolist(), pole)
    points = control(face.surface, named, moved)
    text = face.surface._statement(face.name, named, points).removesuffix(");")
    text += f", divisions = {{{counts[0]}, {counts[1]}}}{_attributes(face)}"
    return [*lines, text]


def _trimmed(face: ImportedFace, taken: set[str], moved: bool) -> list[str]:
    base = f"{face.name}_surface"
    while base in taken:
        base += "_"
    taken.add(base)
    text = face.surface._statement(base, {}, control(face.surface, {}, moved))
    lines = [text.removesuffix(");") + ", visible = 0);"]
    names = []
    for c, cycle in enumerate(face.loops):
        ends = [f"{face.name}_p{c}_{k}" for k in range(len(cycle))]
        # The magnet at which a side begins is that at which the one before ends.
        for k, (_, backwards, trace, _) in enumerate(cycle):
            start = trace.points[-1 if backwards else 0]
            lines.append(
                f"AbsMagnet {ends[k]}({base}, {_plain(start[0])}, {_plain(start[1])}, visible = 0);"
            )
        for k, (_, backwards, trace, _) in enumerate(cycle):
            own = trace if not backwards else _turned(trace)
            label = f"{face.name}_s{c}_{k}"
            both = [ends[k], ends[(k + 1) % len(cycle)]]
            text = f"NURBSnake {label}({_braced(both)}, {own.degrees[0]}, "
            text += _braced(map(_plain, own.knots[0]))
            if own.weights is not None:
                text += f", weights = {_braced(map(_plain, own.weights))}"
            if len(own.points) > 2:
                text += f", places = {_braced(map(_plain, own.points[1:-1, :2].ravel()))}"
            lines.append(_wrapped(text + ", visible = 0);"))
            names.append(label)
    lines.append(_wrapped(f"TrimSurf {face.name}({base}, {_braced(names)}{_attributes(face)}"))
    return lines


def _turned(trace: Nurbs) -> Nurbs:
    weights = None if trace.weights is None else trace.weights[::-1]
    return Nurbs(trace.degrees, (1 - trace.knots[0][::-1],), trace.points[::-1], weights)


explain(globals())
