"""The reference as a page: kinds and functions in groups, with contents and synonyms."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from moldloft.language import SYNONYMS, attributes

__all__ = ["example_lines", "markdown", "signature"]

Row = dict[str, Any]

#: Groups of kinds: a title, what they have in common, and their classes.
KINDS = (
    ("Points", "Points in space.", ("point",)),
    ("Beads", "Points on a curve.", ("bead",)),
    ("Magnets", "Points on a surface.", ("magnet",)),
    ("Rings", "Points on a snake.", ("ring",)),
    ("Curves", "C(t), t from 0 to 1.", ("curve",)),
    ("Snakes", "Curves on a surface: C(t) = S(u(t), v(t)).", ("snake",)),
    ("Surfaces", "S(u, v), both from 0 to 1.", ("surface",)),
    ("Solids", "X(u, v, w), for cells of volume grids.", ("solid",)),
    ("Trimmed surfaces and bodies", "Triangles.", ("mesh",)),
    (
        "Planes and frames",
        "References for mirror images, sections, projections and positions.",
        ("plane", "frame"),
    ),
    ("Relabels", "Laws of a parameter: t' = r(t).", ("relabel",)),
    ("Contours", "Families of sections.", ("contours",)),
    (
        "Lists, weights, conditions and the model",
        "What has no shape of its own.",
        ("farray", "list"),
    ),
    ("Named fields and sets", "Implicit solids as objects.", ("field", "set")),
)

#: Groups of functions by name. Those of the classes field and set that none names are in theirs.
FUNCTIONS = (
    (
        "Elementary functions",
        "sqrt sin cos tan asin acos atan atan2 exp log log10 sinh cosh tanh abs sign floor ceil "
        "round hypot mod div min max sum prod average mean len any all argmin argmax radians "
        "degrees clamp where interp format count isset dot norm ieee",
    ),
    (
        "Rows and grids of numbers and points",
        "list append points range stack join reverse swap spread_i spread_j find sort cumsum diff "
        "d1 d2 dists",
    ),
    ("Texts", "cut replace split trim lower upper number"),
    (
        "Distributions of points",
        "uniform cosine geometric geometric2 d_sinh d_tanh d_tanhx redist count_for first_for "
        "first_cell last_cell growth refined refined_step refinement",
    ),
    ("Moving", "translate scale mirror rotate revolve"),
    (
        "Splines, lengths and curvature",
        "makecc makelc makecs makels evalc evals derivc derivs curvc lengthc length cumlen distc "
        "tangents normals frame curvatures torsion gauss curvature fair jumps",
    ),
    ("Searches", "closest project intersect intersections"),
    (
        "Structured grids",
        "tfi elliptic elliptic_block hyperbolic o_grid c_grid h_grid check_edges folds quality",
    ),
    (
        "Fields",
        "gradient degree s_sqrt translated turned mirrored scaled stretched remapped twisted",
    ),
    ("Sets", "member winner report components bounds bbox_min bbox_max"),
    (
        "Measures of sets",
        "volume volume_bracket area wire_length mass_centre centroid inertia distance nearest hit",
    ),
    (
        "Files",
        "open close read write more next rewind read_p3d read_points read_aerofoil write_p3d "
        "write_vts write_stl write_cgns write_su2 write_gmsh write_blockmesh count_p3d "
        "iblank_p3d read_cgns count_cgns names_cgns "
        "write_csv plot",
    ),
)

_SUFFIX = re.compile(
    r"(Point|Bead|Magnet|Ring|Curve|Snake|Surf|Solid|Plane|Frame|Relabel|Contours)$"
)


def _default(field: Row) -> str:
    value = field["default"]
    return f"{value:g}" if isinstance(value, float) else str(value)


def _argument(field: Row) -> str:
    text = f"{{{field['name']} …}}" if field["many"] else str(field["name"])
    if field["required"]:
        return text
    return f"{text} = {_default(field)}" if field["default"] is not None else f"[{text}]"


def signature(row: Row) -> str:
    """Signature of a kind or function."""
    if row.get("signature"):
        return str(row["signature"])
    name = f"{row['name']} name" if row["is_kind"] else row["name"]
    return f"{name}({', '.join(_argument(field) for field in row['fields'])})"


def example_lines(text: str, width: int = 96) -> list[str]:
    """An example in lines of a width, broken between statements.

    >>> example_lines("AbsPoint A(0, 0, 0); Line l(A, B);", 20)
    ['AbsPoint A(0, 0, 0);', 'Line l(A, B);']
    """
    lines: list[str] = []
    for given in text.strip().splitlines():
        line = ""
        for part in re.split(r"(?<=;) (?=[A-Za-z])", given):
            if line and len(line) + 1 + len(part) > width:
                lines.append(line)
                line = part
            else:
                line = f"{line} {part}".strip() if line else part
        lines.append(line)
    # Braces of a loop or routine keep their statements together.
    if any(line.count("{") != line.count("}") for line in lines):
        return text.strip().splitlines()
    return lines


def groups(rows: list[Row]) -> list[tuple[str, str, list[Row]]]:
    """Title, a line about it, and rows; each row is in one group."""
    found: list[tuple[str, str, list[Row]]] = []
    for title, about, classes in KINDS:
        chosen = [row for row in rows if row["is_kind"] and row["class"] in classes]
        found.append((title, about, chosen))
    functions = [row for row in rows if not row["is_kind"]]
    by_name = {row["name"]: row for row in functions}
    named = {name for _, names in FUNCTIONS for name in names.split()}
    for title, names in FUNCTIONS:
        chosen = [by_name[name] for name in names.split() if name in by_name]
        if title in ("Fields", "Sets"):
            class_ = title.lower().rstrip("s")
            rest = [r for r in functions if r["class"] == class_ and r["name"] not in named]
            chosen = rest + chosen
        found.append((title, "", chosen))
    known = {row["name"] for _, _, chosen in found for row in chosen}
    rest = [row for row in rows if row["name"] not in known]
    return [*found, ("Other functions", "", rest)] if rest else found


def synonyms(row: Row) -> list[str]:
    """Words that users may look for it by.

    >>> synonyms({"name": "CLoftSurf"})
    ['loft', 'skin']
    """
    name = str(row["name"]).lower()
    return [
        word
        for word, parts in SYNONYMS.items()
        if any(part.lower() == name for part in parts)
        or (
            word not in ("bead", "magnet", "snake", "ring")
            and any(part.lower() in name for part in parts if part[0].isupper())
        )
    ]


def related(row: Row, rows: list[Row]) -> list[str]:
    """Entries of the same family, and those that its text names."""
    names = {r["name"] for r in rows}
    found = [n for n in re.findall(r"`([A-Za-z_]\w*)`", str(row["doc"])) if n in names]
    if row["is_kind"] and _SUFFIX.search(row["name"]):
        stem = _SUFFIX.sub("", row["name"])
        found += [n for n in names if _SUFFIX.search(n) and _SUFFIX.sub("", n) == stem]
    seen = dict.fromkeys(n for n in found if n != row["name"])
    return sorted(seen)[:8]


def _anchor(row: Row, rows: list[Row]) -> str:
    """Anchor of an entry: of names that differ by case alone, kinds first, libraries last."""
    name = str(row["name"]).lower()
    alike = [r for r in rows if r["name"].lower() == name]
    before = sorted(alike, key=lambda r: not r["is_kind"]).index(row)
    return f"{name}_{before}" if before else name


def _entry(row: Row, rows: list[Row], pictured: Callable[[Row], bool]) -> list[str]:
    lines = ["", f"### {row['name']}", "", f"`{signature(row)}` → {row['class']}", ""]
    if pictured(row):
        lines += [f"![{row['name']}](kinds/{row['name']}.png)", ""]
    lines += [str(row["doc"]).partition("\n\nCalled as ")[0].strip()]
    if row["fields"]:
        lines += ["", "| argument | class | default | meaning |", "| --- | --- | --- | --- |"]
    for field in row["fields"]:
        many = " list" if field["many"] else ""
        default = _default(field)
        if field["default"] is None:
            default = "required" if field["required"] else "none"
        cells = [f"`{field['name']}`", f"{field['class']}{many}", default, field["help"]]
        lines.append("| " + " | ".join(cells) + " |")
    if row["columns"]:
        lines += ["", f"Model file columns: `{row['columns']}`"]
    if row["example"]:
        lines += ["", "```", *example_lines(row["example"]), "```"]
    words = synonyms(row)
    if words:
        lines += ["", f"Also looked for as: {', '.join(words)}."]
    near = related(row, rows)
    if near:
        by_name = {r["name"]: r for r in rows}
        links = ", ".join(f"[{name}](#{_anchor(by_name[name], rows)})" for name in near)
        lines += ["", f"See also: {links}."]
    return lines


def markdown(rows: list[Row], pictured: Callable[[Row], bool], libraries: list[Row]) -> str:
    """The page, made from the declarations and from the libraries' routines."""
    lines = [
        "# Reference of kinds and functions",
        "",
        "Made by `make reference` from the declarations in `crates/`; not edited by hand. Angles",
        "are in radians, lengths in the unit of the model. `moldloft doc NAME` shows an entry in",
        "the terminal, and searches when there is none of that name.",
        "",
        "## Contents",
    ]
    parts = groups(rows)
    for kinds, title in ((True, "Kinds"), (False, "Functions")):
        lines += ["", f"**{title}**", ""]
        for name, _, chosen in parts:
            if chosen and chosen[0]["is_kind"] is kinds:
                links = " ".join(f"[{r['name']}](#{_anchor(r, rows)})" for r in chosen)
                lines += [f"- **{name}**: {links}"]
    files = list(dict.fromkeys(row["library"] for row in libraries))
    by_file = {file: [row for row in libraries if row["library"] == file] for file in files}
    every = [*rows, *libraries]
    lines += ["", "**Libraries**", ""]
    for file, chosen in by_file.items():
        links = " ".join(f"[{r['name']}](#{_anchor(r, every)})" for r in chosen)
        lines += [f"- **{file}**: {links}"]
    lines += [
        "",
        "## Arguments of every kind",
        "",
        "By name, after the kind's own:",
        "",
        "| argument | class | meaning |",
        "| --- | --- | --- |",
    ]
    for field in attributes():
        many = " list" if field["many"] else ""
        lines.append(f"| `{field['name']}` | {field['class']}{many} | {field['help']} |")
    lines += [
        "",
        "[Panels and joins](panels.md) explains divisions, spacing, tags and orientation.",
    ]
    for title, about, chosen in parts:
        lines += ["", f"## {title}"]
        lines += ["", about] if about else []
        for row in chosen:
            lines += _entry(row, rows, pictured)
    for file, chosen in by_file.items():
        lines += [
            "",
            f"## Library {file}",
            "",
            f'Routines of the language, after `load "{file}";`.',
        ]
        for row in chosen:
            lines += _entry(row, every, pictured)
    return "\n".join(lines) + "\n"
