"""CGNS files of structured patches, with their interfaces and named boundaries.

The nodes are those of the CGNS Standard Interface Data Structures 3.3 in the HDF5 mapping
("SIDS-to-HDF5", cgns.github.io), written by h5py (``pip install 'moldloft[grids]'``).
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import FormatError, MissingPackageError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model

__all__ = ["Interface", "Zone", "interfaces", "weld", "write", "write_grids", "zones"]

_LONGEST = 32
"""Characters of a node's name."""

EDGES = ("v0", "u1", "v1", "u0")
"""The edges of a patch, as the model numbers them."""


@dataclass(frozen=True)
class Zone:
    """A structured patch."""

    name: str
    """Its node, unique in the file."""
    family: str
    """The surface's name."""
    tag: str
    """Its role."""
    vertices: NDArray[np.uint32]
    """Vertices, ``(nu, nv)``; adjacent patches use common numbers."""

    def edge(self, side: int) -> NDArray[np.uint32]:
        """The vertices of edge 0 (v = 0), 1 (u = 1), 2 (v = 1) or 3 (u = 0).

        Parameters
        ----------
        side
            Edge 0 (v = 0), 1 (u = 1), 2 (v = 1) or 3 (u = 0).
        """
        line: NDArray[np.uint32] = (
            self.vertices[:, 0],
            self.vertices[-1],
            self.vertices[:, -1],
            self.vertices[0],
        )[side]
        return line

    def place(self, side: int, at: int) -> tuple[int, int]:
        """The indices (i, j), from 1, of the vertex ``at`` of an edge.

        Parameters
        ----------
        side
            Edge 0 (v = 0), 1 (u = 1), 2 (v = 1) or 3 (u = 0).
        at
            The number of the vertex along the edge, from 0.
        """
        nu, nv = self.vertices.shape
        return ((at + 1, 1), (nu, at + 1), (at + 1, nv), (1, at + 1))[side]


@dataclass(frozen=True)
class Interface:
    """A range of vertices common to two edges."""

    zone: int
    side: int
    first: int
    last: int
    donor: int
    donor_side: int
    donor_first: int
    """The donor's vertex at ``first``."""
    donor_last: int

    @property
    def transform(self) -> tuple[int, int]:
        """For each index of the zone, the parallel index of the donor, negative if opposite."""
        along, across = self.side % 2, 1 - self.side % 2
        donor_along, donor_across = self.donor_side % 2, 1 - self.donor_side % 2
        steps = [0, 0]
        rising = (self.donor_last > self.donor_first) == (self.last > self.first)
        steps[along] = (donor_along + 1) * (1 if rising else -1)
        # Out of this zone at its high side means into the donor at its low side.
        high, donor_high = self.side in (1, 2), self.donor_side in (1, 2)
        steps[across] = (donor_across + 1) * (1 if high != donor_high else -1)
        return steps[0], steps[1]


def zones(model: Model) -> list[Zone]:
    """The structured patches of a model.

    Parameters
    ----------
    model
        The model.
    """
    mesh = model.mesh()
    blocks = mesh._core.blocks()
    have = {k for k, *_ in blocks}
    lost = [patch.name for k, patch in enumerate(mesh.patches) if k not in have]
    if lost or not blocks:
        names = "`, `".join(lost)
        what = f"no structured grid in patch `{names}`" if lost else "no structured grid"
        raise FormatError(f"cannot write cgns: {what}")
    out: list[Zone] = []
    taken: set[str] = set()
    for _, name, tag, _, vertices in blocks:
        out.append(Zone(unique(name, taken), name, tag, vertices))
    return out


def unique(name: str, taken: set[str]) -> str:
    """A unique node name of at most 32 characters, without a slash."""
    base = "".join("_" if c in "/\\" or not c.isprintable() else c for c in name) or "unnamed"
    base = base.encode("ascii", "replace").decode().replace("?", "_")
    short, k = base[:_LONGEST], 1
    while short in taken or short in (".", ".."):
        k += 1
        end = f"~{k}"
        short = base[: _LONGEST - len(end)] + end
    taken.add(short)
    return short


def interfaces(zones: Sequence[Zone]) -> list[Interface]:
    """All common edge segments of zones, each from both sides.

    Edges join by identity of their vertices, never by equal positions.

    Parameters
    ----------
    zones
        The structured patches.
    """
    places: dict[tuple[int, int], list[tuple[int, int, int]]] = {}
    for z, zone in enumerate(zones):
        for side in range(4):
            edge = zone.edge(side).tolist()
            for at, (a, b) in enumerate(pairwise(edge)):
                if a != b:
                    places.setdefault((min(a, b), max(a, b)), []).append((z, side, at))
    found: list[Interface] = []
    for z, zone in enumerate(zones):
        for side in range(4):
            found += _runs(zones, places, z, zone, side)
    return found


def _runs(
    zones: Sequence[Zone],
    places: dict[tuple[int, int], list[tuple[int, int, int]]],
    z: int,
    zone: Zone,
    side: int,
) -> list[Interface]:
    edge = zone.edge(side).tolist()
    runs: list[Interface] = []
    at = 0
    while at < len(edge) - 1:
        a, b = edge[at], edge[at + 1]
        here = (z, side, at)
        others = [p for p in places.get((min(a, b), max(a, b)), []) if p != here and a != b]
        # More than two edges at one line have no one-to-one interface.
        if len(others) != 1:
            at += 1
            continue
        donor, donor_side, start = others[0]
        far = zones[donor].edge(donor_side).tolist()
        step = 1 if far[start] == a else -1
        begin = start if step == 1 else start + 1
        end, there = at + 1, begin + step
        while (
            end + 1 < len(edge)
            and 0 <= there + step < len(far)
            and edge[end + 1] == far[there + step]
            and edge[end + 1] != edge[end]
        ):
            end, there = end + 1, there + step
        runs.append(Interface(z, side, at, end, donor, donor_side, begin, there))
        at = end
    return runs


def write(model: Model, title: str) -> bytes:
    """The file: surface zones with families, interfaces, and the free edges as boundaries.

    Each zone belongs to the family of its surface's name. Edges, or segments of them, without a
    neighbour are boundaries named ``u0``, ``u1``, ``v0``, ``v1`` (``u0_1``, ``u0_2`` for several):
    symmetry planes if they are in one of the model's, else without a type. Interfaces are written
    from both sides. The base has the model's unit of length.

    Parameters
    ----------
    model
        The model.
    title
        A title, for formats that have one.
    """
    try:
        import h5py  # type: ignore[import-untyped]
    except ImportError as error:
        raise MissingPackageError("CGNS needs h5py\nhelp: pip install 'moldloft[grids]'") from error
    patches = zones(model)
    positions = model.mesh().vertices
    used = np.concatenate([zone.vertices.ravel() for zone in patches])
    if not np.isfinite(positions[used]).all():
        raise FormatError("cannot write cgns: a position is not a finite number")
    joints = interfaces(patches)
    memory = io.BytesIO()
    with h5py.File(memory, "w", track_order=True) as file:
        base = begin(file, title, 2, model.units.length)
        _families(base, patches)
        for z, zone in enumerate(patches):
            _zone(base, patches, z, zone, positions, joints, model.symmetry)
    return memory.getvalue()


def weld(points: NDArray[np.float64], tolerance: float) -> NDArray[np.uint32]:
    """A number for each point, the same for points no further apart than the tolerance.

    Chains of close points become one point: welding is transitive.

    Parameters
    ----------
    points
        Points ``(n, 3)``.
    tolerance
        Distance below which two points coincide.

    Examples
    --------
    >>> weld(np.array([[0.0, 0, 0], [1, 0, 0], [1e-12, 0, 0]]), 1e-9)
    array([0, 1, 0], dtype=uint32)
    """
    parent = list(range(len(points)))

    def root(k: int) -> int:
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    cells: dict[tuple[int, ...], list[int]] = {}
    side = max(tolerance, 1e-300)
    keys = np.floor(points / side).astype(object) if len(points) else np.empty((0, 3))
    around = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    for number, (point, key) in enumerate(zip(points, keys, strict=True)):
        for step in around:
            near = tuple(int(a) + b for a, b in zip(key, step, strict=True))
            for other in cells.get(near, ()):
                if float(np.abs(points[other] - point).max()) <= tolerance:
                    low, high = sorted((root(other), root(number)))
                    parent[high] = low
        cells.setdefault(tuple(int(a) for a in key), []).append(number)
    return np.array([root(k) for k in range(len(points))], dtype=np.uint32)


def write_grids(
    grids: Sequence[NDArray[np.float64]],
    names: Sequence[str],
    title: str,
    tolerance: float = 1e-9,
) -> bytes:
    """The file of surfaces of points ``(ni, nj, 3)``: zones, interfaces, free edges as boundaries.

    Edges join where their points coincide, within ``tolerance`` times the size of the whole.
    One-to-one matches become interfaces, from both sides, except edges of zero length (poles).

    Parameters
    ----------
    grids
        Grids of points, each ``(ni, nj, 3)`` or ``(ni, nj, nk, 3)``.
    names
        A name for each grid.
    title
        A title, for formats that have one.
    tolerance
        Distance below which two points coincide.
    """
    try:
        import h5py
    except ImportError as error:
        raise MissingPackageError("CGNS needs h5py\nhelp: pip install 'moldloft[grids]'") from error
    if not grids:
        raise FormatError("cannot write cgns: there is no grid")
    for number, grid in enumerate(grids, 1):
        if grid.ndim != 3 or grid.shape[-1] != 3 or min(grid.shape[:2]) < 2:
            raise FormatError(
                f"grid {number} has the shape {grid.shape}; CGNS takes (ni, nj, 3) with "
                "two lines and more each way"
            )
        if not np.isfinite(grid).all():
            raise FormatError("cannot write cgns: a position is not a finite number")
    positions = np.concatenate([np.asarray(grid, float).reshape(-1, 3) for grid in grids]) + 0.0
    numbers = np.arange(len(positions), dtype=np.uint32)
    patches: list[Zone] = []
    taken: set[str] = set()
    start = 0
    edges: list[NDArray[np.uint32]] = []
    for grid, name in zip(grids, names, strict=True):
        count = grid.shape[0] * grid.shape[1]
        own = numbers[start : start + count].reshape(grid.shape[:2])
        edges += [own[0], own[-1], own[:, 0], own[:, -1]]
        patches.append(Zone(unique(name, taken), name, "surface", own))
        start += count
    rim = np.unique(np.concatenate(edges))
    size = float(np.ptp(positions, axis=0).max())
    # Inner points keep their own numbers; those of the edges are shared.
    shared = numbers.copy()
    shared[rim] = rim[weld(positions[rim], tolerance * size)]
    welded = [Zone(zone.name, zone.family, zone.tag, shared[zone.vertices]) for zone in patches]
    joints = interfaces(welded)
    memory = io.BytesIO()
    with h5py.File(memory, "w", track_order=True) as file:
        base = begin(file, title, 2)
        _families(base, patches)
        for z, (zone, same) in enumerate(zip(patches, welded, strict=True)):
            _zone(base, patches, z, zone, positions, joints, "", same)
    return memory.getvalue()


_LENGTHS = {"m": "Meter", "cm": "Centimeter", "mm": "Millimeter", "ft": "Foot", "in": "Inch"}
"""Units of length that SIDS 4.3 has a name for."""


def begin(file: Any, title: str, dimensions: int, length: str = "") -> Any:
    """The base of a new file, with the dimensions of its cells and of space.

    Coordinates are dimensional with a unit of SIDS, otherwise with a user-defined unit, or an
    unknown one if the model states none.
    """
    _root(file)
    node(file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([3.3], dtype=np.float32))
    sizes = np.array([dimensions, 3], dtype=np.int32)
    base = node(file, unique(title, set()), "CGNSBase_t", sizes)
    if length:
        node(base, "DataClass", "DataClass_t", "Dimensional")
        words = ["Null", _LENGTHS.get(length, "UserDefined"), "Null", "Null", "Null"]
        rows = np.stack([np.frombuffer(w.ljust(32).encode("ascii"), dtype=np.int8) for w in words])
        node(base, "DimensionalUnits", "DimensionalUnits_t", rows)
        if length not in _LENGTHS:
            node(base, "UnitOfLength", "Descriptor_t", length)
    else:
        node(base, "DataClass", "DataClass_t", "NormalizedByUnknownDimensional")
    return base


def _root(file: Any) -> None:
    for key, value, width in [
        ("name", b"HDF5 MotherNode", 33),
        ("label", b"Root Node of HDF5 File", 33),
        ("type", b"MT", 3),
    ]:
        file.attrs.create(key, np.bytes_(value), dtype=f"S{width}")
    file.create_dataset(" format", data=_chars("IEEE_LITTLE_32", 15))
    file.create_dataset(" hdf5version", data=_chars("HDF5 Version 1.8.0", 33))


def _chars(text: str, width: int | None = None) -> NDArray[np.int8]:
    data = text.encode("ascii", "replace")
    return np.frombuffer(data.ljust(width or len(data), b"\0"), dtype=np.int8)


_TYPES = {"float32": "R4", "float64": "R8", "int32": "I4", "int8": "C1"}


def node(parent: Any, name: str, label: str, data: NDArray[Any] | str | None = None) -> Any:
    """A new node of a kind under another one."""
    group = parent.create_group(name, track_order=True)
    values = _chars(data) if isinstance(data, str) else data
    kind = "MT" if values is None else _TYPES[values.dtype.name]
    for key, value, width in [("name", name, 33), ("label", label, 33), ("type", kind, 3)]:
        group.attrs.create(key, np.bytes_(value.encode()), dtype=f"S{width}")
    group.attrs.create("flags", np.array([1], dtype=np.int32))
    if values is not None:
        group.create_dataset(" data", data=values)
    return group


def coordinate(grid: Any, letter: str, values: NDArray[np.float64]) -> None:
    """An array of coordinates, which are lengths."""
    array = node(grid, f"Coordinate{letter}", "DataArray_t", values)
    lengths = np.array([0, 1, 0, 0, 0], dtype=np.float32)
    node(array, "DimensionalExponents", "DimensionalExponents_t", lengths)


def _families(base: Any, patches: Sequence[Zone]) -> None:
    names: set[str] = set()
    for zone in patches:
        if zone.family in names:
            continue
        names.add(zone.family)
        family = node(base, zone.name, "Family_t")
        kind = "BCSymmetryPlane" if zone.tag == "symmetry" else "BCWall"
        node(family, "FamilyBC", "FamilyBC_t", kind)
        node(family, "Tag", "Descriptor_t", zone.tag)


def _zone(
    base: Any,
    patches: Sequence[Zone],
    z: int,
    zone: Zone,
    positions: NDArray[np.float64],
    joints: Sequence[Interface],
    symmetry: str,
    shared: Zone | None = None,
) -> None:
    nu, nv = zone.vertices.shape
    sizes = np.array([[nu, nv], [nu - 1, nv - 1], [0, 0]], dtype=np.int32)
    # A zone and its family are children of one base and must differ in name.
    place = node(base, zone_node(zone), "Zone_t", sizes)
    node(place, "ZoneType", "ZoneType_t", "Structured")
    node(place, "FamilyName", "FamilyName_t", family_node(patches, zone))
    grid = node(place, "GridCoordinates", "GridCoordinates_t")
    for axis, letter in enumerate("XYZ"):
        # Fortran's order: i fastest, so the transpose of ours.
        values = np.ascontiguousarray(positions[zone.vertices][..., axis].T) + 0.0
        coordinate(grid, letter, values)
    own = [joint for joint in joints if joint.zone == z]
    if own:
        _connectivity(place, patches, zone, own)
    _boundaries(place, shared or zone, positions, own, symmetry)


def zone_node(zone: Zone) -> str:
    """The name of a zone's node."""
    return ("Z_" + zone.name)[:_LONGEST]


def family_node(patches: Sequence[Zone], zone: Zone) -> str:
    """The name of the family of a zone: that of the first zone of its surface."""
    return next(other.name for other in patches if other.family == zone.family)


def _connectivity(
    place: Any, patches: Sequence[Zone], zone: Zone, own: Sequence[Interface]
) -> None:
    group = node(place, "ZoneGridConnectivity", "ZoneGridConnectivity_t")
    for k, joint in enumerate(own, 1):
        donor = patches[joint.donor]
        one = node(group, f"join{k}", "GridConnectivity1to1_t", zone_node(donor))
        _range(one, "PointRange", zone, joint.side, joint.first, joint.last)
        ends = joint.donor_side, joint.donor_first, joint.donor_last
        _range(one, "PointRangeDonor", donor, *ends)
        steps = np.array(joint.transform, dtype=np.int32)
        node(one, "Transform", '"int[IndexDimension]"', steps)


def _range(parent: Any, name: str, zone: Zone, side: int, first: int, last: int) -> None:
    ends = [zone.place(side, first), zone.place(side, last)]
    node(parent, name, "IndexRange_t", np.array(ends, dtype=np.int32))


def _boundaries(
    place: Any,
    zone: Zone,
    positions: NDArray[np.float64],
    own: Sequence[Interface],
    symmetry: str,
) -> None:
    free = []
    for side in range(4):
        edge = zone.edge(side)
        if len(set(edge.tolist())) < 2:
            continue
        # Parts between the interfaces of an edge, before the first and after the last.
        at = 0
        ends = sorted((joint.first, joint.last) for joint in own if joint.side == side)
        for first, last in [*ends, (len(edge) - 1, len(edge) - 1)]:
            if first > at:
                free.append((side, at, first, positions[edge[at : first + 1]]))
            at = max(at, last)
    if not free:
        return
    group = node(place, "ZoneBC", "ZoneBC_t")
    size = float(np.abs(positions).max(initial=1.0))
    runs = [side for side, *_ in free]
    for k, (side, first, last, points) in enumerate(free):
        flat = [
            letter
            for axis, letter in enumerate("xy")
            if letter in symmetry and np.abs(points[:, axis]).max() <= 1e-9 * size
        ]
        kind = "BCSymmetryPlane" if flat else "UserDefined"
        name = EDGES[side] if runs.count(side) == 1 else f"{EDGES[side]}_{runs[:k].count(side) + 1}"
        one = node(group, name, "BC_t", kind)
        _range(one, "PointRange", zone, side, first, last)


explain(globals())
