"""Structured grids of points in files: Plot3D of every variant, VTK, STL, CSV, aerofoils."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error, FileError, FormatError
from moldloft.exchange.files import Output, commit
from moldloft.storage import read_bytes

__all__ = [
    "Aerofoil",
    "Plot3DVariant",
    "decode_plot3d",
    "encode_plot3d",
    "encoded",
    "read_aerofoil",
    "read_cgns",
    "read_plot3d",
    "read_points",
    "write",
    "write_cgns",
    "write_csv",
    "write_plot3d",
    "write_stl",
]


@dataclass(frozen=True)
class Plot3DVariant:
    """Variant of a Plot3D file; detected by the reader, chosen for the writer."""

    layout: str = "stream"
    """``text``, ``stream`` (plain binary, as C writes it) or ``records`` (Fortran)."""
    double: bool = True
    """Double precision; single otherwise."""
    multi: bool = True
    """The number of blocks comes first."""
    three: bool = True
    """Three coordinates; two otherwise."""
    big_endian: bool = False
    """The most significant byte comes first."""
    mark: int = 4
    """Bytes of the length of a Fortran record, 4 or 8."""
    planes: bool = False
    """Plane by plane, k = 1 first, rather than whole blocks."""


@dataclass(frozen=True)
class Aerofoil:
    """An aerofoil section."""

    name: str
    """The heading of the file."""
    points: NDArray[np.float64]
    """(n, 2): from the trailing edge along the upper side to the nose and back along the lower."""
    nose: int
    """Index of the nose."""
    listing: str
    """Order of the points in the file: ``selig`` or ``lednicer``."""

    @property
    def upper(self) -> NDArray[np.float64]:
        """The upper side from the leading to the trailing edge."""
        return self.points[self.nose :: -1]

    @property
    def lower(self) -> NDArray[np.float64]:
        """The lower side from the leading to the trailing edge."""
        return self.points[self.nose :]


def _read(path: str | Path) -> bytes:
    return read_bytes(path)


def _named(path: str | Path, error: FormatError) -> FileError:
    return FileError(f"cannot read `{path}`: {error}")


def _grid(grid: ArrayLike, number: int) -> NDArray[np.float64]:
    """The grid as (ni, nj, nk, 3)."""
    array = np.asarray(grid, dtype=np.float64)
    if array.ndim == 3 and array.shape[-1] == 3:
        array = array[:, :, None, :]
    if array.ndim != 4 or array.shape[-1] != 3 or 0 in array.shape:
        raise Error(
            f"grid {number} has the shape {np.shape(grid)}; "
            "a grid is (ni, nj, 3) or (ni, nj, nk, 3)"
        )
    return np.ascontiguousarray(array)


def _grids(grids: Sequence[ArrayLike]) -> list[NDArray[np.float64]]:
    return [_grid(grid, k + 1) for k, grid in enumerate(grids)]


def read_plot3d(
    path: str | Path,
) -> tuple[list[NDArray[np.float64]], Plot3DVariant, list[NDArray[np.int32]] | None]:
    """The blocks of a Plot3D grid file of any variant.

    Text, plain binary and Fortran records, single and double precision, one block and several, two
    and three coordinates, blanking and both byte orders are detected from the length of
    the file to the byte.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    blocks
        An array (ni, nj, 3) for each surface, (ni, nj, nk, 3) for each volume.
    variant
        Variant of the file.
    iblank
        An array (ni, nj) or (ni, nj, nk) for each block, if the file has them.

    Raises
    ------
    FileError
        If the file cannot be read, or no variant explains it: cut off, or no Plot3D.
    """
    try:
        return decode_plot3d(_read(path))
    except FormatError as error:
        raise _named(path, error) from error


def decode_plot3d(
    data: bytes,
) -> tuple[list[NDArray[np.float64]], Plot3DVariant, list[NDArray[np.int32]] | None]:
    """The blocks in the bytes of a Plot3D grid file; as :func:`read_plot3d`.

    Parameters
    ----------
    data
        The content of the file.

    Returns
    -------
    tuple
        Blocks ``(i, j, k, 3)`` or ``(i, j, 3)``, the variant, and the blanking or None.

    Raises
    ------
    FormatError
        If no variant explains the bytes.
    """
    blocks, found = _core.read_plot3d(data)
    surfaces = [block[:, :, 0, :] if block.shape[2] == 1 else block for block in blocks]
    blanks = None
    if found["iblank"] is not None:
        blanks = [
            np.array(blank, dtype=np.int32).reshape(block.shape[:-1], order="F")
            for blank, block in zip(found["iblank"], surfaces, strict=True)
        ]
    names = ("layout", "double", "multi", "three", "big_endian", "mark", "planes")
    return surfaces, Plot3DVariant(**{name: found[name] for name in names}), blanks


def read_cgns(path: str | Path) -> dict[str, NDArray[np.float64]]:
    """The points of the structured zones of a CGNS file, by name.

    Files are HDF5, the default of the CGNS library; older ADF files are not read. Boundaries,
    solutions and interfaces are ignored.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    dict
        Arrays (ni, nj, 3), or (ni, nj, nk, 3) of blocks, in the order in which the zones were made
        where the file kept it, else by names. A second zone of one name, in another base, is
        ``name~2``.

    Raises
    ------
    FileError
        For other files, unstructured zones, compressed coordinates and those in other files.

    Examples
    --------
    >>> from moldloft import grids
    >>> import numpy as np, tempfile
    >>> flat = np.zeros((4, 3, 3))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = grids.write_cgns(folder + "/flat.cgns", [flat], ["flat"])
    ...     zones = grids.read_cgns(file)
    >>> {name: grid.shape for name, grid in zones.items()}
    {'Z_flat': (4, 3, 3)}
    """
    try:
        zones = _core.read_cgns(_read(path))
    except FormatError as error:
        raise _named(path, error) from error
    found: dict[str, NDArray[np.float64]] = {}
    for name, grid in zones:
        spelled, k = name, 1
        while spelled in found:
            k += 1
            spelled = f"{name}~{k}"
        found[spelled] = grid[:, :, 0, :] if grid.shape[2] == 1 else grid
    return found


def write_plot3d(
    path: str | Path,
    grids: Sequence[ArrayLike],
    variant: Plot3DVariant | None = None,
    *,
    iblank: Sequence[ArrayLike] | None = None,
) -> Path:
    """Write grids as a Plot3D file, atomically.

    Parameters
    ----------
    path
        The file.
    grids
        Arrays (ni, nj, 3) or (ni, nj, nk, 3).
    variant
        File variant; by default plain binary, double precision, several blocks, three coordinates.
    iblank
        A whole number for each point of each grid: 0 for those that do not count.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    Error
        If the variant cannot represent the grids: several blocks in a single-block file, a z in a
        2-D file, numbers beyond single precision.
    """
    return _commit(path, encode_plot3d(grids, variant, iblank=iblank))


def encode_plot3d(
    grids: Sequence[ArrayLike],
    variant: Plot3DVariant | None = None,
    *,
    iblank: Sequence[ArrayLike] | None = None,
) -> bytes:
    """The bytes of a Plot3D grid file; arguments and errors as for :func:`write_plot3d`.

    Parameters
    ----------
    grids
        Grids of points, each ``(ni, nj, 3)`` or ``(ni, nj, nk, 3)``.
    variant
        File variant; by default plain binary, double precision, several blocks, three coordinates.
    iblank
        A whole number for each point of each grid: 0 for those that do not count.

    Returns
    -------
    bytes
        The content of the file.
    """
    variant = variant or Plot3DVariant()
    arrays = _grids(grids)
    blanks: list[list[int] | None] | None = None
    if iblank is not None:
        if len(iblank) != len(arrays):
            raise Error(f"{len(arrays)} grids, but blanking for {len(iblank)}")
        blanks = []
        for number, (blank, array) in enumerate(zip(iblank, arrays, strict=True)):
            values = np.asarray(blank)
            if values.size != array.size // 3:
                raise Error(f"blanking of grid {number + 1} has not one number a point")
            shaped = values.reshape(array.shape[:-1])
            blanks.append([int(x) for x in shaped.ravel(order="F")])
    return _core.write_plot3d(
        arrays,
        variant.layout,
        variant.double,
        variant.multi,
        variant.three,
        blanks,
        variant.big_endian,
        variant.mark,
        variant.planes,
    )


def _commit(path: str | Path, data: bytes) -> Path:
    target = Path(path)
    return commit(target.parent, [Output(target.name, data)], make=False)[0]


def write(
    path: str | Path, grids: Sequence[ArrayLike], *, names: Sequence[str] | None = None
) -> list[Path]:
    """Write grids in the format of the file extension.

    Parameters
    ----------
    path
        The file: ``.p3d``, ``.vts``, ``.stl`` or ``.cgns``, the formats of
        :func:`moldloft.formats.formats` whose ``of_grids`` is true.
    grids
        Arrays (ni, nj, 3), or (ni, nj, nk, 3) for Plot3D and VTK.
    names
        Names of the grids, for CGNS and VTK; ``grid1``, ``grid2``, ... by default.

    Returns
    -------
    list of pathlib.Path
        The files written; ``vts`` takes several for several grids.
    """
    target = Path(path)
    files = encoded(target.name, grids, names)
    return commit(target.parent, [Output(name, data) for name, data in files.items()], make=False)


def encoded(
    name: str, grids: Sequence[ArrayLike], names: Sequence[str] | None = None
) -> dict[str, bytes]:
    """The files that :func:`write` writes, by name.

    Parameters
    ----------
    name
        The file's name; its ending is the format.
    grids
        Arrays (ni, nj, 3), or (ni, nj, nk, 3) for Plot3D and VTK.
    names
        Names of the grids, for CGNS and VTK; ``grid1``, ``grid2``, ... by default.

    Returns
    -------
    dict
        Bytes by name; the main file first.
    """
    from moldloft.formats import format_named, formats

    rows = [row for row in formats().values() if row.of_grids]
    row = format_named(Path(name).suffix.lstrip("."), rows)
    arrays = _grids(grids)
    return dict(_core.write_grids(arrays, _names(arrays, names), row.name, name))


def _names(grids: Sequence[Any], names: Sequence[str] | None) -> list[str]:
    """A name for each grid."""
    words = list(names) if names else [f"grid{k + 1}" for k in range(len(grids))]
    if len(words) != len(grids):
        raise Error(f"{len(grids)} grids, but {len(words)} names")
    return words


def write_cgns(
    path: str | Path,
    grids: Sequence[ArrayLike],
    names: Sequence[str] | None = None,
    *,
    tolerance: float = 1e-9,
) -> Path:
    """Write surface grids as structured CGNS, with the interfaces found between them.

    Parameters
    ----------
    path
        The file.
    grids
        Arrays (ni, nj, 3).
    names
        The zones' names; ``grid1``, ``grid2``, ... by default.
    tolerance
        Distance relative to the size of the whole below which points of edges coincide.

    Returns
    -------
    pathlib.Path
        The file.
    """
    target = Path(path)
    arrays = _grids(grids)
    return _commit(path, _core.write_cgns(arrays, _names(arrays, names), target.stem, tolerance))


def write_stl(path: str | Path, grids: Sequence[ArrayLike], *, flip: bool = False) -> Path:
    """Write surface grids as one binary STL.

    Quads are split along their shorter diagonal; triangles without area, at poles, are omitted.
    Facets of closed bodies point outward regardless of the orientation of their surfaces, facets of
    open bodies if the rims determine the outside, those of nearly flat surfaces along r_i x r_j.

    Parameters
    ----------
    path
        The file.
    grids
        Arrays (ni, nj, 3).
    flip
        Reverses the facets.

    Returns
    -------
    pathlib.Path
        The file.
    """
    target = Path(path)
    return _commit(path, _core.grids_as_stl(_grids(grids), target.stem, flip))


def write_csv(path: str | Path, points: ArrayLike) -> Path:
    """Write points (n, 2) or (n, 3) as comma-separated values with a header.

    Numbers are written with all digits needed to read back the same values.

    Parameters
    ----------
    path
        The file.
    points
        Points ``(n, 2)`` or ``(n, 3)``.

    Returns
    -------
    pathlib.Path
        The file.
    """
    array = np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise Error(f"points have the shape (n, 2) or (n, 3), found {array.shape}")
    if not np.isfinite(array).all():
        raise Error("a point is not finite")
    return _commit(path, _core.points_csv(array).encode())


def read_points(path: str | Path) -> NDArray[np.float64]:
    """Points (n, 3) of a text with two or three numbers per line.

    Separators are blanks, commas, semicolons and tabs; titles, names of columns and what follows a
    ``#`` are skipped; a missing z is 0. The two halves of an aerofoil become one run from the upper
    trailing edge round the leading edge.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    numpy.ndarray
        z is 0 where there are two numbers.

    Raises
    ------
    FileError
        With the line that is not a point.
    """
    try:
        return _core.read_points(_read(path))[0]
    except FormatError as error:
        raise _named(path, error) from error


def read_aerofoil(path: str | Path) -> Aerofoil:
    """An aerofoil section from a coordinate file in Selig's or Lednicer's listing.

    Lednicer's begins with two numbers of points.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Aerofoil
        Upper and lower side from nose to tail.

    Raises
    ------
    FileError
        With the line that does not fit.
    """
    try:
        found: tuple[str, Any, int, str] = _core.read_aerofoil(_read(path))
    except FormatError as error:
        raise _named(path, error) from error
    name, points, nose, listing = found
    return Aerofoil(name, np.array(points, dtype=np.float64)[:, :2], nose, listing)


explain(globals())
