"""The language: its reference, canonical texts, and shapes of expressions."""

from __future__ import annotations

import inspect
import keyword
import textwrap
from collections.abc import Sequence
from functools import cache
from typing import Any

from moldloft import _core
from moldloft._core import Shape
from moldloft.arguments import explain
from moldloft.errors import ModelError, UnknownNameError
from moldloft.spelling import nearest
from moldloft.terms import targets

__all__ = [
    "Shape",
    "attributes",
    "check_language",
    "entry",
    "format_text",
    "guides",
    "meaning",
    "page",
    "python_name",
    "reference",
    "search",
    "signature",
]


def reference() -> list[dict[str, Any]]:
    """The rows of the registry: all kinds and functions with their fields, docs and examples.

    >>> row = next(row for row in reference() if row["name"] == "RuledSurf")
    >>> row["class"], row["is_kind"]
    ('surface', True)
    """
    return _core.reference()


def statements() -> list[dict[str, Any]]:
    """The statements with the form of a declaration that insert the contents of a file.

    >>> [row["name"] for row in statements()]
    ['Component', 'Sketch']
    """
    return _core.statements()


def keywords() -> list[str]:
    """The reserved words of the language: types and keywords.

    >>> "foreach" in keywords()
    True
    """
    return _core.keywords()


def attributes() -> list[dict[str, Any]]:
    """The named arguments that every kind takes in addition to its own.

    >>> [field["name"] for field in attributes()][:3]
    ['colour', 'visible', 'layer']
    """
    return _core.attributes()


@cache
def _rows() -> dict[str, dict[str, Any]]:
    return {row["name"]: row for row in reference()}


def entry(name: str) -> dict[str, Any]:
    """The row of a kind or function; ``UnknownNameError`` for other names.

    Parameters
    ----------
    name
        The name of a kind or function.
    """
    rows = _rows()
    if name not in rows:
        near = nearest(name, rows) if isinstance(name, str) else None
        hint = f"; did you mean `{near}`?" if near else ""
        raise UnknownNameError(f"the language has no kind or function `{name}`{hint}")
    return rows[name]


def meaning(field: dict[str, Any]) -> str:
    """Description of an argument, as in docstrings: its help, unit, range and default.

    Parameters
    ----------
    field
        A field of a row of :func:`reference`.

    Examples
    --------
    >>> meaning(entry("RelPoint")["fields"][1])
    'Offset along x. Default 0.'
    """
    words = [str(field["help"]).strip()]
    facts = []
    low, high = field["min"], field["max"]
    if low is not None and high is not None:
        facts.append(f"{low:g} to {high:g}")
    elif low is not None:
        facts.append(f"at least {low:g}")
    elif high is not None:
        facts.append(f"at most {high:g}")
    default = field["default"]
    if default not in (None, ""):
        facts.append(f"default {default:g}" if isinstance(default, float) else f"default {default}")
    if facts:
        text = ", ".join(facts)
        words.append(text[0].upper() + text[1:] + ".")
    return " ".join(words)


def page(row: dict[str, Any]) -> str:
    """The docstring of a kind or function: numpydoc, from its declaration.

    Parameters
    ----------
    row
        A row of :func:`reference`.
    """
    parameters = []
    if row["is_kind"]:
        parameters.append(("name : str", "The name of the object."))
    for field in row["fields"]:
        class_ = f"list of {field['class']}" if field["many"] else str(field["class"])
        optional = "" if field["required"] else ", optional"
        parameters.append((f"{field['name']} : {class_}{optional}", meaning(field)))
    if row["is_kind"]:
        names = ", ".join(field["name"] for field in attributes())
        parameters.append(("**attributes", f"By name, of every kind: {names}."))
    return docstring(row, parameters, str(row["class"]))


def docstring(row: dict[str, Any], parameters: Sequence[tuple[str, str]], result: str) -> str:
    """A numpydoc text: documentation and example of a row, parameters with their meanings, result.

    Parameters
    ----------
    row
        A row of :func:`reference`.
    parameters
        The head of each parameter, and its meaning.
    result
        Type of the result.
    """
    lines = [str(row["doc"]).strip()]
    if parameters:
        lines += ["", "Parameters", "----------"]
    for head, text in parameters:
        lines.append(head)
        lines += textwrap.wrap(text, 92, initial_indent="    ", subsequent_indent="    ")
    lines += ["", "Returns", "-------", result]
    if row["example"]:
        lines += ["", "Notes", "-----", "In the language::", ""]
        lines += [f"    {line}".rstrip() for line in str(row["example"]).strip().splitlines()]
    return "\n".join(lines) + "\n"


def python_name(name: str) -> str:
    """The name of an argument in Python: Python keywords get an underscore at the end.

    Parameters
    ----------
    name
        Its name in the language.

    Examples
    --------
    >>> python_name("lambda"), python_name("radius")
    ('lambda_', 'radius')
    """
    return f"{name}_" if keyword.iskeyword(name) else name


def signature(row: dict[str, Any]) -> inspect.Signature:
    """The arguments of a kind or function, for ``help`` and editors.

    Parameters
    ----------
    row
        A row of :func:`reference`.
    """
    parameter = inspect.Parameter
    found = []
    if row["is_kind"]:
        found.append(parameter("name", parameter.POSITIONAL_ONLY))
    fields = [f for f in row["fields"] if f["name"].isidentifier()]
    if not fields and not row["is_kind"]:
        return inspect.Signature([parameter("args", parameter.VAR_POSITIONAL)])
    optional = variadic = False
    by_name = []
    for field in fields:
        # After an argument that may be left out all others are named, or may be left out too; after
        # one of any number all are named.
        optional = optional or not field["required"]
        default = parameter.empty if field["required"] else field["default"]
        name = python_name(field["name"])
        if field["variadic"]:
            variadic = True
            found.append(parameter(name, parameter.VAR_POSITIONAL))
        elif variadic or (optional and field["required"]):
            by_name.append(parameter(name, parameter.KEYWORD_ONLY, default=default))
        else:
            found.append(parameter(name, parameter.POSITIONAL_OR_KEYWORD, default=default))
    if row["is_kind"]:
        own = {field["name"] for field in fields}
        by_name += [
            parameter(field["name"], parameter.KEYWORD_ONLY, default=field["default"])
            for field in attributes()
            if field["name"] not in own
        ]
    return inspect.Signature([*found, *by_name])


#: What users call things that the reference calls otherwise.
SYNONYMS = {
    "loft": ("LoftSurf", "skin"),
    "skin": ("LoftSurf", "loft"),
    "sweep": ("SweepSurf", "TranSurf"),
    "revolve": ("RevSurf",),
    "revolution": ("RevSurf",),
    "extrude": ("TranSurf",),
    "translate": ("TranSurf", "translated"),
    "nurbs": ("BCurve", "BSurf", "NUB"),
    "spline": ("BCurve", "CCurve"),
    "bspline": ("BCurve",),
    "interpolate": ("CCurve",),
    "bead": ("Bead",),
    "magnet": ("Magnet",),
    "snake": ("Snake",),
    "ring": ("Ring",),
    "intersection": ("Intersection", "IntSnake", "IntPoint", "IntBead", "IntMagnet", "intersect"),
    "project": ("ProjSnake", "ProjPoint", "ProjMagnet"),
    "geodesic": ("GeoSnake",),
    "fillet": ("Fillet", "Blend"),
    "rolling": ("RollFillet",),
    "blend": ("Blend",),
    "mirror": ("Mirr",),
    "trim": ("SubSurf", "TrimSurf", "SubCurve"),
    "patch": ("SubSurf", "TangBoundSurf", "BoundSurf"),
    "coons": ("BoundSurf", "tfi"),
    "weight": ("Weight",),
    "mass": ("Weight", "mass_centre"),
    "spacing": ("Relabel", "cosine", "geometric", "d_tanh"),
    "distribution": ("Relabel", "cosine", "geometric", "d_tanh"),
    "aerofoil": ("Foil", "naca", "read_aerofoil"),
    "airfoil": ("Foil", "naca", "read_aerofoil"),
    "section": ("Contours", "Foil"),
    "waterline": ("ZContours",),
    "station": ("XContours",),
    "buttock": ("YContours",),
    "box": ("cuboid", "SetBody"),
    "boolean": ("set", "SetBody"),
    "union": ("set",),
    "difference": ("set",),
    "solve": ("SolveSet",),
    "constraint": ("SolveSet",),
    "join": ("Join",),
    "fair": ("Fair", "fair"),
    "smooth": ("Fair", "fair", "elliptic"),
    "grid": ("tfi", "elliptic", "hyperbolic", "o_grid", "c_grid"),
}


def search(words: str) -> list[dict[str, Any]]:
    """Rows that match a phrase, the best first: by name, summary, documentation and synonym.

    Parameters
    ----------
    words
        One word or several.

    Examples
    --------
    >>> "CLoftSurf" in [row["name"] for row in search("loft")]
    True
    """
    wanted = _wanted(words)
    explained = targets(words)
    scored: list[tuple[int, int, dict[str, Any]]] = []
    for row in reference():
        if row["name"] in explained:
            scored.append((-100, len(scored), row))
            continue
        name = row["name"].lower()
        text = f"{row['doc']} {row['class']}".lower()
        summary = str(row["summary"]).lower()
        score = 0
        for word in wanted:
            stem = _stem(word)
            near = SYNONYMS.get(word) or SYNONYMS.get(stem) or ()
            if stem in name:
                score += 8 - (len(name) > len(stem))
            elif any(part.lower() in name for part in near):
                score += 6
            elif stem in summary:
                score += 3
            elif stem in text:
                score += 1
            else:
                score = 0
                break
        if score:
            scored.append((-score, len(scored), row))
    return [row for _, _, row in sorted(scored, key=lambda item: item[:2])]


SITE = "https://moldloft.github.io/moldloft"

#: Pages of the documentation: file, subject, and further words that it is found by.
_GUIDES = (
    (
        "hydrostatics",
        "hydrostatics, equilibrium, righting arms and stability criteria",
        "hydrostatic displacement draft draught trim heel gz kg waterline lcb vcb tpc bonjean "
        "centre of buoyancy flotation gravity metacentre metacentric height freeboard",
    ),
    (
        "relational",
        "how objects depend on each other: beads, magnets, snakes, rings, joins",
        "parent dependency constraint model point curve surface",
    ),
    (
        "panels",
        "divisions, spacing and joins of panels; tags and lids",
        "divisions subdivisions mesh panel join junction open edge quality tag lid",
    ),
    ("sdl", "the array language", "language program array loop function variable"),
    ("grids", "structured grids", "grid mesh elliptic hyperbolic transfinite smoothing"),
    ("implicit", "implicit solids: sets, blends, offsets", "set boolean blend solid field csg sdf"),
    ("fairing", "fairing of points, curves and surfaces", "fair smooth tolerance noise"),
    ("sketch", "sketches with dimensions", "sketch dimension constraint profile"),
    ("formats", "file formats", "file format export import write stl gdf step iges units"),
    ("cad", "exchange with CAD: STEP, IGES, 3DM, DXF", "step iges dxf 3dm rhino cad brep"),
    ("python", "the Python package", "python notebook pickle jupyter derivative gradient"),
    ("command-line", "the commands", "command shell completion pipe option"),
    (
        "conventions",
        "axes, units, signs and normals",
        "unit axis normal sign degree density",
    ),
    ("workbench", "the workbench in the browser", "view viewer browser workbench drag"),
    ("diagnostics", "each diagnostic with an example and its remedy", "error warning remark"),
    (
        "migration",
        "coming from another program",
        "multisurf openvsp rhino cadquery geomdl gmsh openscad",
    ),
    ("studies", "parameter studies and optimisation", "study sweep optimise variant plan"),
    ("deformation", "free-form deformation of meshes and NURBS", "deform ffd morph box"),
    ("sketch-routines", "equivalents of the SKETCH routines of 1983", "sketch routine"),
    ("policy", "compatibility of versions", "version stable deprecated"),
    ("performance", "measured times beside peers", "speed benchmark time"),
    ("soak", "results of long random tests", "random test fuzz"),
    ("architecture", "crates and invariants", "crate design"),
    ("development", "building, testing and extending Moldloft", "build test contribute"),
    ("tutorials/naval-architect", "tutorial: offsets to GZ curve", "offsets tutorial"),
    ("tutorials/cfd", "tutorial: wing and body to a solver", "cfd tutorial wing"),
    ("tutorials/propeller", "tutorial: a propeller from its data sheet", "propeller tutorial"),
    ("tutorials/dam", "tutorial: a gravity dam and an arch dam", "dam tutorial"),
    ("tutorials/product", "tutorial: a solid with blends", "product tutorial"),
    ("tutorials/optimisation", "tutorial: gradients in an optimiser", "optimiser tutorial"),
    ("inside/certificate", "how the optimum of fairing is certified", "certificate proof"),
    ("inside/fairing-studies", "studies of fairing", "fairing study"),
)


def guides(words: str) -> list[tuple[str, str]]:
    """Pages of the documentation for a search: topic and address of each.

    Parameters
    ----------
    words
        One word or several.

    Examples
    --------
    >>> guides("hydrostatics")[0][1]
    'https://moldloft.github.io/moldloft/hydrostatics.html'
    """
    abouts = {page: about for page, about, _ in _GUIDES}
    pages = [page for page in targets(words) if page in abouts]
    for page, about, more in _GUIDES:
        known = f"{page} {about} {more}".lower()
        if page not in pages and all(_stem(word) in known for word in _wanted(words)):
            pages.append(page)
    return [(abouts[page], f"{SITE}/{page}.html") for page in pages]


def _wanted(words: str) -> list[str]:
    """The significant words of a phrase; all of them if no word is significant."""
    every = words.lower().split()
    return [word for word in every if word not in _PARTICLES] or every


_PARTICLES = {
    "a",
    "an",
    "and",
    "at",
    "by",
    "for",
    "from",
    "in",
    "of",
    "on",
    "or",
    "the",
    "to",
    "with",
}


def _stem(word: str) -> str:
    return word.rstrip("s") if len(word) > 4 else word


def format_text(name: str, text: bytes) -> str:
    r"""The canonical text of a program.

    Parameters
    ----------
    name
        Name in messages.
    text
        In UTF-8 or an older code.

    Raises
    ------
    ModelError
        If it is not a program, or states a newer version of the language.

    Examples
    --------
    >>> format_text("a.sdl", b"AbsPoint   P ( 1,2,3 );")
    'AbsPoint P(1, 2, 3);\n'
    """
    check_language(text.decode("utf-8", "replace"), name)
    return _core.format_text(name, text)


def check_language(text: str, name: str) -> None:
    r"""Reject a text that states a newer version of the language, before it is rewritten.

    Parameters
    ----------
    text
        The program.
    name
        Name in messages.

    Raises
    ------
    ModelError
        If its first line states a version that is not read here.

    Examples
    --------
    >>> check_language("# moldloft 1\nAbsPoint P(1, 2, 3);", "a.sdl")
    >>> check_language("# moldloft 2\nAbsPoint P(1, 2, 3);", "a.sdl")
    Traceback (most recent call last):
      ...
    moldloft.errors.ModelError: error[newer-language]: the text is written in version 2 of ...
    """
    first, _, _ = text.partition("\n")
    if not first.lstrip("\ufeff \t").startswith("#"):
        return
    # The parser decides. It gets the first line alone: nothing of the program is run.
    found = _core.Document.from_text(name, first + "\n", None, []).diagnostics()
    newer = [d for d in found if d.id == "newer-language"]
    if newer:
        raise ModelError(str(newer[0]).rstrip(), newer)


explain(globals())
