"""The table of output formats of models.

The rows are those of the Rust crate ``export``, and those of the formats that Python writes:
:data:`PYTHON_ROWS`, each with the function that makes its file.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FormatError
from moldloft.spelling import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from moldloft.models import Model
    from moldloft.shapes.blocks import Blocks

__all__ = ["PYTHON_ROWS", "Format", "format_named", "formats"]


@dataclass(frozen=True)
class Format:
    """A row of the table."""

    name: str
    """Its name in commands and calls."""
    about: str
    """A line about it."""
    suffix: str = ""
    """Extension of its files; if empty, the name."""
    other_suffix: str = ""
    """Another usual extension of its files, which does not determine the format."""
    aliases: tuple[str, ...] = ()
    """Aliases of its name."""
    holds: str = "panels"
    """``panels``, ``panels, lines, points``, ``grids``, ``surfaces``, ``volumes``, ``drawing``,
    ``model`` or ``table``."""
    symmetry: str = ""
    """The planes of symmetry that a file can name: ``y``; ``y, xy``; ``x, y``; or ``x, y, xy``."""
    lids: bool = False
    """Lids are written only on request."""
    immersed: bool = False
    """True if the immersed part can be written separately."""
    text: bool = False
    """The main file is text."""
    of_grids: bool = False
    """Grids of points, without a model, can be written."""
    writer: str = ""
    """For rows of Python: ``module:function``, which makes the bytes of the file from the model, or
    for ``volumes`` from its :class:`moldloft.shapes.blocks.Blocks`, and the stem of its name."""

    def file_name(self, stem: str) -> str:
        """The name of a model's main file.

        Parameters
        ----------
        stem
            Name of the file without its ending.
        """
        return f"{stem}.{self.suffix or self.name}"

    @property
    def plain_panels(self) -> bool:
        """True if the files contain panels and cannot state planes of symmetry.

        Files of a symmetric model contain one half, or the whole on request.
        """
        return self.holds.startswith("panels") and not self.symmetry and not self.writer

    @property
    def panel_code(self) -> bool:
        """True if a panel code reads the files."""
        return self.immersed

    @property
    def volume(self) -> bool:
        """True if the files contain the cells of solids."""
        return self.holds == "volumes"

    def encode(self, source: Model | Blocks, stem: str, *, tolerance: float | None = None) -> bytes:
        """The bytes of a format implemented in Python; surfaces are fitted within the tolerance.

        Parameters
        ----------
        source
            The model, or its hexahedra for formats of volumes.
        stem
            Name of the file without its ending.
        tolerance
            The largest error of fitted surfaces.
        """
        module, _, function = self.writer.partition(":")
        options = {"accuracy": tolerance} if self.holds == "surfaces" else {}
        data: bytes = getattr(import_module(module), function)(source, stem, **options)
        return data


PYTHON_ROWS = (
    Format(
        "blockmesh",
        "the blocks of solids as OpenFOAM's blockMeshDict",
        suffix="blockMeshDict",
        holds="volumes",
        symmetry="x, y, xy",
        text=True,
        writer="moldloft.blockmesh:encode",
    ),
    Format(
        "3dm",
        "Rhino: surfaces, trimmed faces and solids (needs rhino3dm)",
        aliases=("rhino",),
        holds="surfaces",
        writer="moldloft.cad.rhino:encode",
    ),
    Format(
        "dxf",
        "edges of surfaces and curves as splines (needs ezdxf)",
        holds="surfaces",
        text=True,
        writer="moldloft.cad.dxf:encode",
    ),
    Format(
        "lines-svg",
        "the lines plan on one sheet as SVG",
        suffix="lines.svg",
        holds="drawing",
        text=True,
        writer="moldloft.lines_plan:encode_svg",
    ),
    Format(
        "lines-pdf",
        "the lines plan on one sheet as PDF",
        suffix="lines.pdf",
        holds="drawing",
        writer="moldloft.lines_plan:encode_pdf",
    ),
    Format(
        "lines-dxf",
        "the lines plan at full size as DXF: splines on layers (needs ezdxf)",
        suffix="lines.dxf",
        holds="drawing",
        text=True,
        writer="moldloft.lines_plan:encode_dxf",
    ),
    Format(
        "offsets",
        "stations, waterlines and half-breadths (.csv)",
        suffix="csv",
        aliases=("csv",),
        holds="table",
        text=True,
        writer="moldloft.offsets:encode",
    ),
)
"""The formats that are written in Python."""


@cache
def formats() -> dict[str, Format]:
    """The rows by name, in the order in which help lists them.

    >>> formats()["nemoh"].file_name("hull")
    'hull.mar'
    """
    rows = [Format(**{**row, "aliases": tuple(row["aliases"])}) for row in _core.formats()]
    return {row.name: row for row in [*rows, *PYTHON_ROWS]}


def format_named(name: str, among: Iterable[Format] | None = None) -> Format:
    """The row of a format, by name, alias or unambiguous extension.

    Parameters
    ----------
    name
        In small letters or large.
    among
        Only one of these; by default any.

    Raises
    ------
    FormatError
        If there is no format of that name, or several.

    Examples
    --------
    >>> format_named("Plot3D").name
    'p3d'
    """
    rows: Sequence[Format] = list(formats().values() if among is None else among)
    wanted = name.lower()
    for row in rows:
        if wanted == row.name or wanted in row.aliases:
            return row
    of_suffix = [row for row in rows if wanted in (row.suffix, row.other_suffix) and wanted]
    if len(of_suffix) == 1:
        return of_suffix[0]
    ends = [f"`{row.name}`" for row in of_suffix]
    if ends:
        files = f"the extension `.{wanted}` belongs to several formats"
        raise FormatError(f"{files}; expected a longer extension: {' or '.join(ends)}")
    known = [word for row in rows for word in (row.name, *row.aliases)]
    near = nearest(wanted, known)
    if near:
        raise FormatError(f"unknown format `{name}`; did you mean `{near}`?")
    names = ", ".join(row.name for row in rows)
    if not name:
        raise FormatError(
            f"no format is stated, and the file's name has no ending; one of: {names}"
        )
    raise FormatError(f"unknown format `{name}`; expected one of: {names}")


def markdown() -> str:
    """The table of the docs.

    >>> print(markdown().splitlines()[0])
    | name | file | content | holds | symmetry | options |
    """
    lines = [
        "| name | file | content | holds | symmetry | options |",
        "| " + " | ".join(["---"] * 6) + " |",
    ]
    for row in formats().values():
        names = ", ".join(f"`{name}`" for name in (row.name, *row.aliases))
        options = [word for word in ("lids", "immersed") if getattr(row, word)]
        if row.plain_panels:
            options += ["whole", "triangles"]
        if row.holds.startswith("panels"):
            options += ["tolerance", "angle"]
        if row.holds == "surfaces":
            options.append("tolerance")
        planes = row.symmetry or "–"
        cells = [names, f"`.{row.suffix or row.name}`", row.about, row.holds, planes]
        lines.append("| " + " | ".join([*cells, ", ".join(options) or "–"]) + " |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(markdown(), end="")


explain(globals())
