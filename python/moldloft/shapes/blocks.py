"""Volume meshes of a model's solids, as arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.arguments import explain
from moldloft.errors import Error
from moldloft.formats import formats

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from moldloft import _core
    from moldloft.exchange.files import Output

__all__ = ["FORMATS", "Block", "Blocks", "Boundary", "Interface"]

_ROWS = {row.name.removeprefix("volume-"): row for row in formats().values() if row.volume}

FORMATS = {name: row.about for name, row in _ROWS.items()}
"""The formats of volume meshes by name, with a line about each."""


@dataclass(frozen=True)
class Block:
    """The cells of one solid."""

    name: str
    """The solid's name."""
    divisions: tuple[int, int, int]
    """Cells along u, v and w."""
    faces: tuple[str, ...]
    """Names of its faces u = 0, u = 1, v = 0, v = 1, w = 0, w = 1: of the surface that a face is,
    or the solid's with the face's."""
    cells: int
    """Number of cells."""
    volume: float
    """Its volume, the sum of its cells'."""
    folded: int
    """Cells whose Jacobian is not positive at all corners and Gauss points."""
    scaled_jacobian: float
    """The least scaled Jacobian of all cells: 1 for bricks, negative for folded cells."""
    mean_scaled_jacobian: float
    """Mean of the cells' least scaled Jacobians."""
    worst_cell: tuple[int, int, int]
    """The cell with the least one."""
    worst_at: tuple[float, float, float]
    """Position of the worst cell."""
    aspect: float
    """The largest ratio of a cell's edges."""
    indices: NDArray[np.uint32]
    """Numbers of its vertices, ``(nu + 1, nv + 1, nw + 1)``."""
    points: NDArray[np.float64]
    """Positions of its vertices, ``(nu + 1, nv + 1, nw + 1, 3)``."""


@dataclass(frozen=True)
class Interface:
    """A rectangle of a block face that coincides with another one, also of the same block."""

    block: int
    """The block, counted from 0."""
    face: int
    """Its face, counted from 0 as in :attr:`Block.faces`."""
    begin: tuple[int, int, int]
    end: tuple[int, int, int]
    """Its first and last vertex, (i, j, k) from 0."""
    donor: int
    donor_face: int
    donor_begin: tuple[int, int, int]
    """The donor's vertex at ``begin``."""
    donor_end: tuple[int, int, int]
    """The donor's vertex at ``end``."""
    transform: tuple[int, int, int]
    """For each axis of the block, the parallel axis of the donor (from 1), negative if opposite; as
    in CGNS.
    """

    def reversed(self) -> Interface:
        """Get the interface as seen from the donor."""
        back = [0, 0, 0]
        for axis, number in enumerate(self.transform):
            back[abs(number) - 1] = (axis + 1) * (1 if number > 0 else -1)
        return Interface(
            self.donor,
            self.donor_face,
            self.donor_begin,
            self.donor_end,
            self.block,
            self.face,
            self.begin,
            self.end,
            (back[0], back[1], back[2]),
        )


@dataclass(frozen=True)
class Boundary:
    """A rectangle of a block face without a neighbour."""

    block: int
    """The block, counted from 0."""
    face: int
    """Its face, counted from 0 as in :attr:`Block.faces`."""
    begin: tuple[int, int, int]
    end: tuple[int, int, int]
    """Its first and last vertex, (i, j, k) from 0."""
    name: str
    """Name of the surface, or of block and face."""
    kind: str
    """``"symmetry"`` in a symmetry plane of the model, ``"wall"`` where it is a surface object,
    else ``"open"``."""


class Blocks:
    """Hexahedra of all shown solids of a model, at one state of it.

    Common vertices of solids are shared. Open divisions (0) of a solid follow those of its
    neighbours.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 0);
    ... AbsPoint E(0, 0, 3); Line a(A, B); Line b(C, D); RuledSurf floor(a, b); Line up(A, E);
    ... TranSolid box(floor, up, divisions = {4, 2, 3});
    ... ''')
    >>> blocks = m.blocks()
    >>> blocks.vertices.shape, blocks["box"].points.shape
    ((60, 3), (5, 3, 4, 3))
    >>> round(blocks.volume, 12), blocks.positive
    (6.0, True)
    """

    def __init__(self, core: _core.Blocks) -> None:
        self._core = core
        summary = core.summary()
        self.cells: int = summary["cells"]
        """Number of cells."""
        self.volume: float = summary["volume"]
        """The volume of all cells."""
        self.positive: bool = summary["positive"]
        """True when all cells have a positive Jacobian at their corners and Gauss points."""

    @cached_property
    def vertices(self) -> NDArray[np.float64]:
        """Positions, ``(n, 3)``."""
        return self._core.vertices()

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """The blocks, in the order of declaration."""
        made = []
        for k, row in enumerate(self._core.blocks()):
            indices = self._core.indices(k)
            for key in ("faces", "worst_cell", "worst_at"):
                row[key] = tuple(row[key])
            made.append(Block(**row, indices=indices, points=self.vertices[indices]))
        return tuple(made)

    @cached_property
    def interfaces(self) -> tuple[Interface, ...]:
        """Interfaces of blocks, by the identity of their vertices; each once."""
        return tuple(
            Interface(*_side(own), *_side(donor), (transform[0], transform[1], transform[2]))
            for own, donor, transform in self._core.interfaces()
        )

    @cached_property
    def boundaries(self) -> tuple[Boundary, ...]:
        """The parts of faces without a neighbour. Degenerate faces are omitted."""
        return tuple(
            Boundary(*_side(part), name, kind) for part, name, kind in self._core.boundaries()
        )

    @property
    def problems(self) -> list[_core.Diagnostic]:
        """Folded cells, and blocks that do not match at joins."""
        return self._core.problems()

    def __getitem__(self, name: str) -> Block:
        for block in self.blocks:
            if block.name == name:
                return block
        raise KeyError(f"unknown block `{name}`; expected one of: {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        return iter([block.name for block in self.blocks])

    def __len__(self) -> int:
        return len(self.blocks)

    def write(self, path: str | os.PathLike[str], *, format: str | None = None) -> list[Path]:
        """Write the blocks to a file atomically.

        Parameters
        ----------
        path
            The file.
        format
            One of :data:`moldloft.shapes.blocks.FORMATS`; by default what the file's name ends in,
            and ``blockmesh`` for a file ``blockMeshDict``.

        Returns
        -------
        list of pathlib.Path
            The files written; ``vts`` takes several.

        Raises
        ------
        FileError
            If there is no such folder, or it cannot be written to.
        FormatError
            If the format is unknown or cannot represent the blocks.
        """
        from moldloft.exchange.files import commit

        path = Path(path)
        ending = "blockmesh" if path.name.endswith("blockMeshDict") else path.suffix.lstrip(".")
        return commit(path.parent, self.outputs((format or ending).lower(), path), make=False)

    def outputs(self, format: str, path: Path) -> list[Output]:
        """The files of a format, with names after ``path``.

        Parameters
        ----------
        format
            The name of a format, see :data:`moldloft.exchange.files.FORMATS`.
        path
            Gives the names of the files; nothing is written.

        Returns
        -------
        list of Output
            Names with bytes.

        Raises
        ------
        FormatError
            If the format is unknown or cannot represent the blocks.
        """
        from moldloft.exchange.files import Output

        row = _ROWS.get(format)
        if row is None:
            raise Error(f"unknown volume format `{format}`; expected one of: {', '.join(FORMATS)}")
        if row.writer:
            return [Output(path.name, row.encode(self, path.stem))]
        return [Output(name, data) for name, data in self._core.write(row.name, path.name)]

    def __repr__(self) -> str:
        blocks = "1 block" if len(self) == 1 else f"{len(self)} blocks"
        return f"<Blocks: {blocks}, {self.cells} cells>"


def _side(
    part: _core.Side,
) -> tuple[int, int, tuple[int, int, int], tuple[int, int, int]]:
    block, face, begin, end = part
    return block, face, (begin[0], begin[1], begin[2]), (end[0], end[1], end[2])


explain(globals())
