"""Volume meshes of a model's solids, as arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.errors import Error

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from moldloft import _core

__all__ = ["FORMATS", "Block", "Blocks"]

FORMATS = {
    "p3d": "Plot3D volume grids, all blocks in one file",
    "vts": "VTK structured grids, one per block",
    "vtu": "VTK unstructured hexahedra",
}
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
    """How many cells it has."""
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
    """Where that is."""
    aspect: float
    """The largest ratio of a cell's edges."""
    indices: NDArray[np.uint32]
    """Numbers of its vertices, ``(nu + 1, nv + 1, nw + 1)``."""
    points: NDArray[np.float64]
    """Positions of its vertices, ``(nu + 1, nv + 1, nw + 1, 3)``."""


class Blocks:
    """Hexahedra of all shown solids of a model, at one state of it.

    Vertices that solids share are one vertex. Divisions that a solid leaves open (0) are those of
    its neighbours.

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
        """How many cells there are."""
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

    @property
    def interfaces(self) -> list[tuple[int, int, int, int]]:
        """Joined faces: block, face, block, face; faces count from 0 as in :attr:`Block.faces`."""
        return self._core.interfaces()

    @property
    def problems(self) -> list[_core.Diagnostic]:
        """Folded cells, and joins that do not hold."""
        return self._core.problems()

    def __getitem__(self, name: str) -> Block:
        for block in self.blocks:
            if block.name == name:
                return block
        raise KeyError(f"there is no block `{name}`; there are: {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        return iter([block.name for block in self.blocks])

    def __len__(self) -> int:
        return len(self.blocks)

    def write(self, path: str | os.PathLike[str], *, format: str | None = None) -> list[Path]:
        """Write the blocks to a file, whole or not at all.

        Parameters
        ----------
        path
            The file.
        format
            One of :data:`moldloft.blocks.FORMATS`; by default what the file's name ends in.

        Returns
        -------
        list of pathlib.Path
            The files written; ``vts`` takes several.
        """
        from moldloft.files import Output, commit

        path = Path(path)
        wanted = (format or path.suffix.lstrip(".")).lower()
        if wanted not in FORMATS:
            raise Error(
                f"error: there is no volume format `{wanted}`; there are: {', '.join(FORMATS)}"
            )
        files = self._core.write(wanted, path.stem)
        main = f"{path.stem}.{wanted}"
        outputs = [Output(path.name if name == main else name, data) for name, data in files]
        return commit(path.parent, outputs)

    def __repr__(self) -> str:
        return f"<Blocks: {len(self)} blocks, {self.cells} cells>"
