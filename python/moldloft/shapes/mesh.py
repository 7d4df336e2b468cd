"""Panels of a model, as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from moldloft.arguments import explain

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moldloft import _core

__all__ = ["Mesh", "Patch", "Quality"]


@dataclass(frozen=True)
class Patch:
    """The panels of one surface: a range of the mesh's faces, with its measures."""

    name: str
    """The surface's name."""
    kind: str
    """Its entity kind."""
    tag: str
    """Its role: ``"wetted"``, ``"lid"``, ``"waterline"``, ``"symmetry"`` or a name."""
    tags: list[str]
    """The ``tags`` of the patch in the model, and the material of an implicit solid."""
    colour: int | None
    """Index of a palette colour, 0 to 15."""
    start: int
    """Its first face."""
    stop: int
    """One past its last face."""
    divisions: tuple[int, int] | None
    """Panels along u and v, for a structured patch."""
    area: float
    """Area of its panels."""
    closed: bool
    """True if its panels enclose a volume without other patches."""
    volume: float
    """The enclosed volume. For an open patch, the signed volume of the cone from the origin to it:
    meaningless alone, but the sum over a closed mesh is the enclosed volume.
    """
    vertices: int
    """Vertices that its panels use."""
    quality: dict[str, Any]
    """Aspect ratio, skewness, warp, smallest angle (radians), and jump of area to the neighbours:
    ``min``, ``max`` and ``mean`` of each, and its worst panel by index in the mesh (``worst``), in
    the patch (``panel``), along u and v (``place``) and by its ``centre``; and the numbers of
    quads, triangles and panels of zero area.
    """

    @property
    def panels(self) -> int:
        """The number of panels."""
        return self.stop - self.start


class Quality(dict[str, dict[str, Any]]):
    """Quality of the panels by patch; a table in a notebook."""

    def _repr_html_(self) -> str:
        from moldloft.display import quality_html

        return quality_html(self)


class Mesh:
    """Panels of all shown surfaces of a model, at one state of it.

    Panels are counter-clockwise seen from outside. Common vertices of patches are shared.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 0);
    ... Line a(A, B); Line b(C, D);
    ... RuledSurf plate(a, b, divisions = {4, 2});
    ... ''')
    >>> mesh = m.mesh()
    >>> mesh.vertices.shape, mesh.faces.shape
    ((15, 3), (8, 4))
    >>> mesh.area
    2.0
    >>> mesh.closed, mesh.patch("plate").panels
    (False, 8)
    """

    def __init__(self, core: _core.Mesh | _Frozen, symmetry: str = "") -> None:
        self._core = core
        self._symmetry = symmetry

    @cached_property
    def vertices(self) -> NDArray[np.float64]:
        """Positions, ``(n, 3)``."""
        return self._core.vertices()

    @cached_property
    def faces(self) -> NDArray[np.uint32]:
        """Corners of the panels as indices of vertices, ``(m, 4)``; a triangle repeats its last."""
        return self._core.faces()

    @cached_property
    def patches(self) -> tuple[Patch, ...]:
        """The patches, in the order of their faces."""
        return tuple(Patch(**facts) for facts in self._core.patches())

    def patch(self, name: str) -> Patch:
        """The patch of the surface called ``name``.

        Parameters
        ----------
        name
            The name of a surface.

        Returns
        -------
        Patch
            Its panels with their measures.

        Raises
        ------
        UnknownNameError
            If no surface of this name has panels.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.mesh().patch("plate").name
        'plate'
        """
        for patch in self.patches:
            if patch.name == name:
                return patch
        from moldloft.errors import UnknownNameError

        known = ", ".join(patch.name for patch in self.patches)
        raise UnknownNameError(f"unknown patch `{name}`; expected one of: {known or 'none'}")

    def quality(self) -> Quality:
        """Quality of the panels by patch: see :attr:`Patch.quality`.

        Returns
        -------
        Quality
            By patch, and in it by measure: the figures of all panels.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 0);
        ... Line a(A, B); Line b(C, D);
        ... RuledSurf plate(a, b, divisions = {4, 4}, spacing = {2, 1});
        ... ''')
        >>> jump = m.mesh().quality()["plate"]["jump"]
        >>> round(jump["max"], 9)
        2.0
        """
        return Quality({patch.name: patch.quality for patch in self.patches})

    def closure(self, *, level: float | None = 0.0) -> dict[str, Any]:
        """Open edges, by patch and edge, and their closures.

        Parameters
        ----------
        level
            Height of the water: open edges there are closed by a lid. None for no lids.

        Returns
        -------
        dict
            ``closed``: no edge is open. ``closed_with_lids_and_mirror``: none but those that the
            model's mirror image and a lid at ``level`` close. ``edges``: the open ones with
            ``patch``, ``edge`` (``"v = 0"`` and so on), ``closed_by`` (``"mirror y"``, ``"lid"`` or
            None), ``panels``, ``length``, ``low`` and ``high``, the corners of the box around it.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.mesh().closure(level=None)["closed"]
        False
        """
        return self._core.closure(self._symmetry, level)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Panels, vertices, area, volume, closure and orientation of the whole, as data."""
        return self._core.summary()

    @property
    def closed(self) -> bool:
        """True when every panel edge belongs to two panels."""
        return bool(self.summary["closed"])

    @property
    def area(self) -> float:
        """Area of all panels."""
        return float(self.summary["area"])

    @property
    def volume(self) -> float:
        """The enclosed volume; for an open mesh the signed volume of the cone from the origin."""
        return float(self.summary["volume"])

    def __reduce__(self) -> tuple[Any, ...]:
        return _thawed, (_frozen(self), self._symmetry)

    def _repr_html_(self) -> str:
        from moldloft.display import mesh_html

        return mesh_html(self)

    def __repr__(self) -> str:
        count = f"{self.summary['panels']} panels, {self.summary['vertices']} vertices"
        return f"<Mesh: {count}, {'closed' if self.closed else 'open'}>"


@dataclass(frozen=True)
class _Frozen:
    """A mesh without its model, for pickles."""

    arrays: tuple[Any, Any]
    data: tuple[dict[str, Any], list[Any], list[dict[str, Any]]]
    closures: dict[tuple[str, float | None], dict[str, Any]]

    def vertices(self) -> Any:
        return self.arrays[0]

    def faces(self) -> Any:
        return self.arrays[1]

    def summary(self) -> dict[str, Any]:
        return self.data[0]

    def blocks(self) -> list[Any]:
        return self.data[1]

    def patches(self) -> list[dict[str, Any]]:
        return self.data[2]

    def closure(self, mirrors: str, level: float | None) -> dict[str, Any]:
        try:
            return self.closures[mirrors, level]
        except KeyError:
            from moldloft.errors import Error

            raise Error(
                "a pickled mesh has its closure for the levels 0 and None only\n"
                "help: pickle the model, and take its mesh where it is unpickled"
            ) from None


def _frozen(mesh: Mesh) -> _Frozen:
    core = mesh._core
    if isinstance(core, _Frozen):
        return core
    return _Frozen(
        (core.vertices(), core.faces()),
        (core.summary(), core.blocks(), core.patches()),
        {(mesh._symmetry, level): core.closure(mesh._symmetry, level) for level in (0.0, None)},
    )


def _thawed(frozen: _Frozen, symmetry: str) -> Mesh:
    return Mesh(frozen, symmetry)


explain(globals())
