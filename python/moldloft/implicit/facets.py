"""Facets: the surface of a set as triangles, sheets, wires and points."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.implicit.answers import warn_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft import _core

    Floats = NDArray[np.float64]

__all__ = ["Contour", "FacetPatch", "Facets", "Sheet", "Unresolved"]

FORMATS = ("stl", "obj", "ply", "glb", "vtp", "3mf")
"""Formats of facets; wires and points are written to obj and vtp only."""


@dataclass(frozen=True)
class FacetPatch:
    """The triangles of one primitive."""

    name: str
    """Name of the primitive, or its kind."""
    kind: str
    """Type of the primitive."""
    colour: int | None
    """Palette colour."""
    start: int
    """Its first triangle."""
    stop: int
    """One past its last triangle."""
    sheet: bool
    """True for a piece of surface without an inside."""


@dataclass(frozen=True)
class Unresolved:
    """A position at which the corners of its cell are inconclusive."""

    low: Floats
    """Low corner of a cell, or of a part of one."""
    high: Floats
    """High corner of the box."""
    volume: float
    """Bound of the solid volume where the facets are empty, or of the empty volume where they are
    solid.
    """
    missed: bool
    """True if the feature certainly exists: a wall or a gap thinner than the cell."""


@dataclass(frozen=True)
class Sheet:
    """A piece of surface without an inside."""

    name: str
    """Name of its primitive."""
    triangles: NDArray[np.uint32]
    """Corners as indices of the facets' vertices, ``(n, 3)``."""


@dataclass(frozen=True)
class Contour:
    """A line in which a plane cuts the surface."""

    points: Floats
    """Its points ``(n, 3)``; the first is not repeated when it is closed."""
    closed: bool
    """True when it ends where it began."""

    @property
    def length(self) -> float:
        """Its length."""
        points = np.vstack([self.points, self.points[:1]]) if self.closed else self.points
        return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


class Facets:
    """The surface of a set; made by :meth:`Set.facets`.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> ball = im.Set(im.sphere((0, 0, 0), 1), name="ball").facets(depth=4)
    >>> ball.closed, ball.manifold, ball.euler
    (True, True, 2)
    >>> len(ball.triangles) == len(ball.primitive), set(ball.primitive.tolist())
    (True, {0})
    """

    def __init__(self, core: _core.Facets) -> None:
        self._core = core

    @cached_property
    def vertices(self) -> Floats:
        """Positions, ``(n, 3)``."""
        return self._core.vertices()

    @cached_property
    def triangles(self) -> NDArray[np.uint32]:
        """Corners as indices of vertices ``(m, 3)``, counter-clockwise from air; sheets last."""
        return self._core.triangles()

    @cached_property
    def patches(self) -> tuple[FacetPatch, ...]:
        """The triangles by primitive, in order."""
        return tuple(FacetPatch(*facts) for facts in self._core.patches())

    @cached_property
    def primitive(self) -> NDArray[np.int64]:
        """The number of each triangle's patch, ``(m,)``."""
        counts = [p.stop - p.start for p in self.patches]
        return np.repeat(np.arange(len(counts)), counts)

    @property
    def attributes(self) -> list[dict[str, Any]]:
        """Name, colour, material and tolerance of each of :attr:`patches`, in order."""
        return self._core.attributes()

    @property
    def sheets(self) -> list[Sheet]:
        """Pieces of surface without an inside."""
        return [Sheet(p.name, self.triangles[p.start : p.stop]) for p in self.patches if p.sheet]

    @cached_property
    def wires(self) -> list[Floats]:
        """Polylines ``(n, 3)`` in which sheets meet; a closed one repeats its first point."""
        return self._core.wires()

    @cached_property
    def points(self) -> Floats:
        """Points in which three sheets meet, ``(n, 3)``."""
        return self._core.points()

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Closure, measures and counts, as data."""
        return self._core.summary()

    @property
    def closed(self) -> bool:
        """True when every edge of the solids belongs to two triangles."""
        return bool(self.summary["closed"])

    @property
    def manifold(self) -> bool:
        """True when the triangles at every edge and vertex of the solids form one fan."""
        return bool(self.summary["manifold"])

    @property
    def euler(self) -> int:
        """Euler number of the solids' surface: 2 per ball, 0 per ring."""
        return int(self.summary["euler"])

    @property
    def components(self) -> int:
        """Connected parts of the solids' surface."""
        return int(self.summary["components"])

    @property
    def area(self) -> float:
        """Area of all triangles."""
        return float(self.summary["area"])

    @property
    def volume(self) -> float:
        """Volume enclosed by the triangles."""
        return float(self.summary["volume"])

    @property
    def best_volume(self) -> float:
        """The enclosed volume, corrected for the distance of the triangles from the surface.

        It is the volume of the set except for ``blunt`` and ``unresolved`` parts, which raise a
        warning.
        """
        missed = len(self.blunt) + len(self.unresolved)
        if missed:
            cells = "cell" if missed == 1 else "cells"
            warn_of(
                f"note[volume-uncertain]: the facets may deviate from the set in {missed} {cells}\n"
                "help: look at `blunt` and `unresolved`; `Set.mass` says how well it is known"
            )
        return float(self.summary["best_volume"])

    def simplified(self, accuracy: float) -> Facets:
        """The same surface with fewer triangles, which are within ``accuracy`` of it.

        Remaining vertices do not move. The reduction is largest on flat and singly curved faces.

        Parameters
        ----------
        accuracy
            The largest distance from the surface, in model units.

        Returns
        -------
        Facets
            A new mesh; this stays as it is.
        """
        return Facets(self._core.simplified(float(accuracy)))

    @property
    def shell_volumes(self) -> list[float]:
        """The volume of each connected part of the solids' surface; cavities are negative."""
        return self._core.shells()[0]

    @property
    def bodies(self) -> int:
        """Number of solids; solids in point or edge contact are separate."""
        return self._core.shells()[1]

    @property
    def touching(self) -> Floats:
        """Contacts between bodies: positions ``(n, 3)`` at which each has its own vertex."""
        return self._core.shells()[2]

    @cached_property
    def undecided(self) -> list[tuple[list[float], list[float]]]:
        """Boxes with intersecting triangles: low and high corners.

        Elsewhere triangles meet only at common edges and vertices.
        """
        return self._core.undecided()

    @cached_property
    def unresolved(self) -> list[Unresolved]:
        """Positions at which cells are inconclusive or may miss a part; no other part is missed.

        Neighbours are one entry: at most 100 entries, the largest first.
        """
        return [
            Unresolved(np.array(low), np.array(high), volume, missed)
            for (low, high), volume, missed in self._core.unresolved()
        ]

    @cached_property
    def blunt(self) -> list[tuple[list[float], list[float]]]:
        """Boxes with a cut-off edge or corner or with folded triangles: low and high corners.

        The feature is thinner than a cell there, or its vertices would have made triangles
        intersect.
        """
        return self._core.blunt()

    def centre_distances(self) -> Floats:
        """Distances of the solids' triangle centres from their surfaces, |f| / |f'|, ``(m,)``.

        Returns
        -------
        numpy.ndarray
            In model units.
        """
        return self._core.distances()[0]

    def worst_vertex(self) -> float:
        """The largest distance of a vertex of the solids from its surface.

        Returns
        -------
        float
            In model units.
        """
        return self._core.distances()[1]

    def crossings(self) -> int:
        """Number of intersecting pairs of triangles.

        Returns
        -------
        int
            0 for a mesh that is fit for use.
        """
        return self._core.crossings()

    def section(self, normal: Sequence[float], point: Sequence[float] = (0, 0, 0)) -> list[Contour]:
        """The contours in which a plane cuts the solids, on the surface and in the plane.

        Parameters
        ----------
        normal
            The normal of the plane, ``(3,)``.
        point
            A point of the plane, ``(3,)``.

        Returns
        -------
        list of Contour
            Closed ones run round solid parts counter-clockwise, seen against the normal.
        """
        from moldloft.implicit.moving import triple

        found = self._core.section(triple(normal, "normal"), triple(point, "point"))
        return [Contour(points, closed) for points, closed in found]

    def section_svg(
        self,
        normals: Sequence[Sequence[float]],
        point: Sequence[float] = (0, 0, 0),
        *,
        width: float = 160,
    ) -> str:
        """Sections through a point, as a drawing of adjacent views with filled solid parts.

        Parameters
        ----------
        normals
            A normal for each section.
        point
            A common point of the planes.
        width
            Width of each view, in millimetres.

        Returns
        -------
        str
            The drawing.
        """
        return _drawn([(n, self.section(n, point)) for n in normals], point, width)

    def write(self, path: str | os.PathLike[str], *, format: str | None = None) -> Path:
        """Write the facets to a file atomically; the extension selects the format.

        ``stl``, ``obj``, ``ply``, ``glb``, ``vtp`` and ``3mf`` contain solids and sheets; wires and
        points are written to ``obj`` and ``vtp``, and are an error in the others.

        Parameters
        ----------
        path
            The file.
        format
            The name of a format, see :data:`moldloft.exchange.files.FORMATS`.

        Returns
        -------
        pathlib.Path
            The file.
        """
        from moldloft.exchange.files import Output, commit

        target = Path(path)
        wanted = (format or target.suffix.lstrip(".")).lower()
        data = self._core.write(wanted, target.stem)
        return commit(target.parent, [Output(target.name, data)], make=False)[0]

    def picture(
        self, path: str | os.PathLike[str] | None = None, *, size: tuple[int, int] = (1200, 800)
    ) -> bytes:
        """A shaded picture, a PNG file, with wires as lines.

        Parameters
        ----------
        path
            The file.
        size
            Width and height, pixels.

        Returns
        -------
        bytes
            The PNG file.
        """
        png = self._core.picture(int(size[0]), int(size[1]))
        if path is not None:
            from moldloft.exchange.files import Output, commit

            target = Path(path)
            commit(target.parent, [Output(target.name, png)], make=False)
        return png

    def __repr__(self) -> str:
        state = "closed" if self.closed else "open"
        more = [f"{len(self.sheets)} sheets"] if self.sheets else []
        more += [f"{len(self.wires)} wires"] if self.wires else []
        more += [f"{len(self.points)} points"] if len(self.points) else []
        count = f"{len(self.triangles)} triangles, {len(self.vertices)} vertices"
        return f"<Facets: {', '.join([count, *more, state])}>"


def _frame(normal: Sequence[float]) -> tuple[Floats, Floats]:
    """Right and up of a view against the normal; z is up where it can be."""
    n = np.asarray(normal, dtype=np.float64)
    n = n / np.linalg.norm(n)
    up = np.array([0.0, 0.0, 1.0]) if abs(n[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, n)
    right /= np.linalg.norm(right)
    return right, np.cross(n, right)


def _drawn(
    views: list[tuple[Sequence[float], list[Contour]]], point: Sequence[float], width: float
) -> str:
    parts, offset, tallest = [], 0.0, 1.0
    for normal, contours in views:
        right, up = _frame(normal)
        at = np.asarray(point, dtype=np.float64)
        flat = [np.column_stack([(c.points - at) @ right, (c.points - at) @ up]) for c in contours]
        if flat:
            everything = np.vstack(flat)
            low, high = everything.min(axis=0), everything.max(axis=0)
        else:
            low, high = np.zeros(2), np.ones(2)
        scale = width / max(float(high[0] - low[0]), 1e-12)
        height = float(high[1] - low[1]) * scale
        paths = []
        for contour, xy in zip(contours, flat, strict=True):
            places = (xy - np.array([low[0], high[1]])) * np.array([scale, -scale])
            words = " L".join(f"{x + offset:.4f} {y:.4f}" for x, y in places)
            paths.append(f"M{words}{' Z' if contour.closed else ''}")
        parts.append(
            f'<path d="{" ".join(paths)}" fill="#c9d6e4" fill-rule="evenodd" '
            'stroke="#1d2b3a" stroke-width="0.4"/>'
        )
        offset += width + 10
        tallest = max(tallest, height)
    total = max(offset - 10, 1.0)
    margin = 3
    box = f"{-margin} {-margin} {total + 2 * margin:.3f} {tallest + 2 * margin:.3f}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{total + 2 * margin:.3f}mm" '
        f'height="{tallest + 2 * margin:.3f}mm" viewBox="{box}">\n'
        + "\n".join(parts)
        + "\n</svg>\n"
    )


explain(globals())
