"""The reference: an index of kinds and functions in groups, a page for each, an index of terms."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from moldloft.language import SYNONYMS, attributes
from moldloft.terms import FIELDS

__all__ = ["anchor", "entry_pages", "example_lines", "index_page", "signature", "terms_page"]

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
        "Objects without a shape.",
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
        "tfi elliptic elliptic_block hyperbolic o_grid c_grid h_grid check_edges folds quality "
        "interfaces",
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
        "open close read write more next rewind read_p3d read_points read_aerofoil text_outlines "
        "write_p3d write_vts write_stl write_cgns write_su2 write_gmsh write_blockmesh "
        "write_polymesh write_ugrid write_nmf count_p3d "
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
    """An example broken into lines of a width, between statements.

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
    """A group of rows, with a title and a summary; each row is in one group."""
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
    """Synonyms of an entry for searches.

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
    """Entries of the same family, and entries named in its text."""
    names = {r["name"] for r in rows}
    found = [n for n in re.findall(r"`([A-Za-z_]\w*)`", str(row["doc"])) if n in names]
    if row["is_kind"] and _SUFFIX.search(row["name"]):
        stem = _SUFFIX.sub("", row["name"])
        found += [n for n in names if _SUFFIX.search(n) and _SUFFIX.sub("", n) == stem]
    seen = dict.fromkeys(n for n in found if n != row["name"])
    return sorted(seen)[:8]


def anchor(row: Row, rows: list[Row]) -> str:
    """Name of an entry's page.

    Names that differ only by case are numbered, kinds first, libraries last.
    """
    name = str(row["name"]).lower()
    alike = [r for r in rows if r["name"].lower() == name]
    before = sorted(alike, key=lambda r: not r["is_kind"]).index(row)
    return f"{name}_{before}" if before else name


def _link(row: Row, rows: list[Row]) -> str:
    return f"[{row['name']}]({anchor(row, rows)}.md)"


def _arguments(row: Row) -> list[str]:
    lines = ["", "## Arguments", "", "| argument | class | default | meaning |"]
    lines += ["| --- | --- | --- | --- |"]
    for field in row["fields"]:
        many = " list" if field["many"] else ""
        default = _default(field)
        if field["default"] is None:
            default = "required" if field["required"] else "–"
        cells = [f"`{field['name']}`", f"{field['class']}{many}", default, field["help"]]
        lines.append("| " + " | ".join(cells) + " |")
    if row["is_kind"]:
        lines += ["", "Every kind also takes the [common arguments](../reference.md"]
        lines[-1] += "#arguments-of-every-kind): colour, visibility, divisions, spacing, tags."
    return lines


def entry_page(row: Row, rows: list[Row], pictured: bool, group: str, beside: list[Row]) -> str:
    """The page of an entry: signature, picture, meaning, arguments, example, related entries.

    Parameters
    ----------
    row
        The entry.
    rows
        All entries.
    pictured
        True if there is a picture of its example.
    group
        Title of its group in the reference.
    beside
        The entries of its group.
    """
    lines = [f"# {row['name']}", "", f"`{signature(row)}` → {row['class']}", ""]
    if pictured:
        lines += [f"![Example of {row['name']}](../kinds/{row['name']}.png)", ""]
    lines += [str(row["doc"]).partition("\n\nCalled as ")[0].strip()]
    if row.get("library"):
        lines += ["", f'A routine of a library: `load "{row["library"]}";`']
    if row["fields"]:
        lines += _arguments(row)
    if row["columns"]:
        lines += ["", f"Model file columns: `{row['columns']}`"]
    if row["example"]:
        lines += ["", "## Example", "", "```sdl", *example_lines(row["example"]), "```"]
    near = related(row, rows)
    by_name = {r["name"]: r for r in rows}
    lines += ["", "## Related", ""]
    if near:
        lines += ["See also: " + ", ".join(_link(by_name[name], rows) for name in near) + ".", ""]
    others = [_link(other, rows) for other in beside if other is not row]
    lines += [f"[{group}](../reference.md): {', '.join(others)}." if others else group]
    words = synonyms(row) + [word for word in found_as(row) if word not in synonyms(row)]
    if words:
        lines += ["", f"Also found as: {', '.join(words)}."]
    return "\n".join(lines) + "\n"


def found_as(row: Row) -> list[str]:
    """Terms of the field explained by the entry.

    >>> found_as({"name": "GeoSnake"})
    ['geodesic', 'shortest path on a surface']
    """
    name = row["name"]
    terms = [known[name] for known in FIELDS.values() if name in known]
    return [word for line in terms for word in line.split(", ")]


def entry_pages(
    rows: list[Row], pictured: Callable[[Row], bool], libraries: list[Row]
) -> dict[str, str]:
    """The pages of all entries by name of their file, without extension."""
    every = [*rows, *libraries]
    parts = [(title, chosen) for title, _, chosen in groups(rows)]
    files = dict.fromkeys(row["library"] for row in libraries)
    parts += [
        (f"Library {file}", [row for row in libraries if row["library"] == file]) for file in files
    ]
    return {
        anchor(row, every): entry_page(row, every, pictured(row), title, chosen)
        for title, chosen in parts
        for row in chosen
    }


def terms_page(rows: list[Row]) -> str:
    """The index of terms: each field with its terms and the pages that explain them."""
    lines = [
        "# Index of terms",
        "",
        "Find the page, kind or function for a term of your field. `moldloft doc TERM` does the",
        "same in the terminal.",
    ]
    names = {row["name"]: anchor(row, rows) for row in rows}
    for field, known in FIELDS.items():
        lines += ["", f"## {field}", "", "| term | see |", "| --- | --- |"]
        found = [(term, target) for target, terms in known.items() for term in terms.split(", ")]
        for term, target in sorted(found, key=lambda pair: pair[0].lower()):
            page = f"reference/{names[target]}.md" if target in names else f"{target}.md"
            lines.append(f"| {term} | [{target}]({page}) |")
    return "\n".join(lines) + "\n"


def _first_sentence(doc: str) -> str:
    text = " ".join(doc.partition("\n\n")[0].split())
    found = re.match(r".*?\w\)?[.](?=\s+[A-Z`]|$)", text)
    return found[0] if found else text


def _rows_of(chosen: list[Row], every: list[Row]) -> list[str]:
    lines = ["", "| name | result | meaning |", "| --- | --- | --- |"]
    for row in chosen:
        first = _first_sentence(str(row["doc"])).replace("|", "\\|")
        link = f"reference/{anchor(row, every)}.md"
        lines.append(f"| [`{row['name']}`]({link}) | {row['class']} | {first} |")
    return lines


def index_page(rows: list[Row], libraries: list[Row]) -> str:
    """The index of all entries, with links to their pages."""
    every = [*rows, *libraries]
    lines = [
        "# Reference of kinds and functions",
        "",
        "All kinds of objects and all functions, in groups, each with a page with picture,",
        "arguments and example. `moldloft doc NAME` prints it in the terminal; other words are",
        "searched for. Angles are in radians, lengths in the unit of the model.",
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
    for title, about, chosen in groups(rows):
        lines += ["", f"## {title}"]
        lines += ["", about] if about else []
        lines += _rows_of(chosen, every)
    for file in dict.fromkeys(row["library"] for row in libraries):
        lines += ["", f"## Library {file}", ""]
        lines += [f'Routines of the language, after `load "{file}";`.']
        lines += _rows_of([row for row in libraries if row["library"] == file], every)
    return "\n".join(lines) + "\n"
