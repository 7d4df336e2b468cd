"""Free-form deformation: meshes and NURBS surfaces moved by the control points of B-spline boxes.

A point of a box at the parameters (u, v, w) moves by the sum of B_i(u) B_j(v) B_k(w) d_ijk over the
displacements d of the control points (Sederberg and Parry 1986, with B-splines). It is linear in
them, so a deformed shape is an ordinary model: its points plus the sum of parameters times fixed
displacements. All that models have is there: exact derivatives, measures, files, studies.

>>> import numpy as np
>>> from moldloft.deformation import Box, Deformation
>>> corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1.0)])
>>> faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
>>> box = Box((0, 0, 0), np.eye(3), counts=(3, 3, 3), degrees=2)
>>> longer = box.move("longer", np.s_[2], "x", low=0, high=1)
>>> m = Deformation.of_mesh(corners, faces, [longer]).model()
>>> m["longer"] = 0.5
>>> m.eval("mesh.volume"), m.derivatives(["mesh.volume"], ["longer"])
(1.5, [[1.0]])
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error
from moldloft.exchange.mesh_files import mesh_of_file, mesh_statement
from moldloft.shapes.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["Box", "Deformation", "Variable"]

#: Points within this distance of a side of a box count as on it, in lengths of the box.
ON_SIDE = 1e-9

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def _basis(degree: int, count: int, u: Floats) -> tuple[Integers, Floats]:
    """The first nonzero B-spline of uniform clamped knots and all nonzero values, by de Boor."""
    spans = count - degree
    knots = np.concatenate([np.zeros(degree), np.linspace(0, 1, spans + 1), np.ones(degree)])
    first = np.clip((u * spans).astype(np.int64), 0, spans - 1)
    # Rounding may put a point beside a knot into its neighbour's span.
    first -= (first > 0) & (u < knots[first + degree])
    first += (first < spans - 1) & (u >= knots[np.minimum(first + degree + 1, knots.size - 1)])
    values = np.ones((u.size, 1))
    for p in range(1, degree + 1):
        wider = np.zeros((u.size, p + 1))
        for r in range(p):
            right = knots[first + degree + r + 1]
            left = knots[first + degree + r + 1 - p]
            term = values[:, r] / (right - left)
            wider[:, r] += (right - u) * term
            wider[:, r + 1] += (u - left) * term
        values = wider
    return first, values


@dataclass(frozen=True, eq=False)
class Variable:
    """A design variable: displacements of a box's control points per unit of its value."""

    name: str
    """Name of the parameter of the model."""
    box: Box
    displacements: Floats
    """``(nu, nv, nw, 3)``."""
    low: float | None = None
    high: float | None = None
    start: float = 0.0


@dataclass(frozen=True, eq=False)
class Box:
    """A parallelepiped of B-spline control points, uniform clamped knots in each direction.

    Parameters
    ----------
    origin
        The corner at the parameters (0, 0, 0), ``(3,)``.
    edges
        Its edges along u, v and w as rows, ``(3, 3)``, in any directions.
    counts
        Numbers of control points along the edges.
    degrees
        Polynomial degrees, one for all or one for each edge.
    fixed
        Layers of control points that do not move: a number for all six sides, or a pair (at 0, at
        1) for each edge. With k layers the deformed shape joins the part outside the box with k - 1
        continuous derivatives; 0 is for sides that the shape does not pass through.

    Raises
    ------
    Error
        For edges in one plane, and for fewer control points than degree + 1.
    """

    origin: Floats
    edges: Floats
    counts: tuple[int, int, int]
    degrees: int | tuple[int, int, int] = 3
    fixed: int | tuple[tuple[int, int], tuple[int, int], tuple[int, int]] = 0
    _inverse: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        origin = np.asarray(self.origin, dtype=np.float64)
        edges = np.asarray(self.edges, dtype=np.float64)
        if origin.shape != (3,) or edges.shape != (3, 3):
            raise Error(
                f"a box has an origin (3,) and edges (3, 3), found {origin.shape}, {edges.shape}"
            )
        lengths = np.linalg.norm(edges, axis=1)
        if not (lengths > 0).all() or abs(np.linalg.det(edges / lengths[:, None])) < 1e-9:
            raise Error("the edges of a box are three directions, found two or less")
        degrees = (self.degrees,) * 3 if isinstance(self.degrees, int) else tuple(self.degrees)
        fixed = self.fixed
        pairs = ((fixed, fixed),) * 3 if isinstance(fixed, int) else tuple(map(tuple, fixed))
        for axis, count, degree, pair in zip("uvw", self.counts, degrees, pairs, strict=True):
            if degree < 1 or count < degree + 1:
                raise Error(
                    f"{count} control points along {axis} do not fit degree {degree}: "
                    f"at least {max(degree, 1) + 1} are needed"
                )
            if min(pair) < 0 or sum(pair) >= count:
                raise Error(f"{pair} fixed layers along {axis} leave no free layer of {count}")
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "edges", edges)
        object.__setattr__(self, "degrees", degrees)
        object.__setattr__(self, "fixed", pairs)
        object.__setattr__(self, "_inverse", np.linalg.inv(edges))

    @classmethod
    def around(
        cls, points: ArrayLike, counts: tuple[int, int, int], margin: float = 0.01, **more: Any
    ) -> Box:
        """A box along the axes around points.

        Parameters
        ----------
        points
            ``(n, 3)``.
        counts
            Numbers of control points.
        margin
            Distance from the points, in lengths of the greatest edge.
        **more
            `degrees` and `fixed`, as for :class:`Box`.
        """
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        room = margin * float((high - low).max())
        return cls(low - room, np.diag(high - low + 2 * room), counts, **more)

    @property
    def control_points(self) -> Floats:
        """Undeformed control points, ``(nu, nv, nw, 3)``: at Greville's abscissae."""
        rows = []
        for count, degree in zip(self.counts, self.degrees, strict=True):  # type: ignore[arg-type]
            inner = np.linspace(0, 1, count - degree + 1)
            knots = np.concatenate([np.zeros(degree), inner, np.ones(degree)])
            rows.append(np.array([knots[k + 1 : k + degree + 1].mean() for k in range(count)]))
        grid = np.stack(np.meshgrid(*rows, indexing="ij"), axis=-1)
        found: Floats = self.origin + grid @ self.edges
        return found

    @property
    def free(self) -> NDArray[np.bool_]:
        """The control points outside fixed layers, ``(nu, nv, nw)``."""
        found = np.ones(self.counts, dtype=bool)
        for axis, (low, high) in enumerate(self.fixed):  # type: ignore[arg-type]
            rows = np.arange(self.counts[axis])
            inside = (rows >= low) & (rows < self.counts[axis] - high)
            found &= inside.reshape([-1 if k == axis else 1 for k in range(3)])
        return found

    def parameters(self, points: ArrayLike) -> Floats:
        """Parameters of points, ``(n, 3)``: within [0, 1] in the box.

        The undeformed box is an affine map of its parameters, so this is exact, without a search.
        """
        found: Floats = (np.asarray(points, dtype=np.float64) - self.origin) @ self._inverse
        return np.where(np.abs(found - np.round(found)) <= ON_SIDE, np.round(found), found)

    def weights(self, points: ArrayLike) -> tuple[Integers, Floats]:
        """Derivatives of points with respect to control points.

        Parameters
        ----------
        points
            ``(n, 3)``.

        Returns
        -------
        tuple of two numpy.ndarray
            Numbers of control points in C order and weights, ``(n, (p+1)(q+1)(r+1))`` each. Weights
            add to 1; those of points outside the box are 0.
        """
        at = self.parameters(points)
        inside = ((at >= 0) & (at <= 1)).all(axis=1)
        at = np.clip(at, 0, 1)
        number = np.zeros((len(at), 1), dtype=np.int64)
        weight = np.where(inside, 1.0, 0.0)[:, None]
        for axis, (count, degree) in enumerate(zip(self.counts, self.degrees, strict=True)):  # type: ignore[arg-type]
            first, values = _basis(degree, count, at[:, axis])
            row = first[:, None] + np.arange(degree + 1)
            number = (number[:, :, None] * count + row[:, None, :]).reshape(len(at), -1)
            weight = (weight[:, :, None] * values[:, None, :]).reshape(len(at), -1)
        return number, weight

    def displaced(self, displacements: Floats, points: ArrayLike) -> Floats:
        """Displacements of points for given displacements of control points, ``(n, 3)``."""
        number, weight = self.weights(points)
        net = np.asarray(displacements, dtype=np.float64).reshape(-1, 3)
        found: Floats = np.einsum("nk,nkc->nc", weight, net[number])
        return found

    def move(
        self,
        name: str,
        where: Any = None,
        direction: str | ArrayLike = "z",
        *,
        low: float | None = None,
        high: float | None = None,
        start: float = 0.0,
    ) -> Variable:
        """A variable that moves some control points in one direction.

        Parameters
        ----------
        name
            Name of the parameter.
        where
            An index of the array of control points, such as ``np.s_[3, :, 0]``; by default all that
            are free.
        direction
            ``"x"``, ``"y"``, ``"z"``, or a vector in the model's axes: the displacement for the
            value 1.
        low, high
            Range of the parameter.
        start
            Its value as written.

        Raises
        ------
        Error
            If a fixed control point would move.
        """
        chosen = np.zeros(self.counts, dtype=bool)
        try:
            chosen[self.free if where is None else where] = True
        except IndexError as error:
            raise Error(f"`{name}`: no such control points among {self.counts}: {error}") from None
        if (chosen & ~self.free).any():
            place = tuple(int(k) for k in np.argwhere(chosen & ~self.free)[0])
            raise Error(
                f"`{name}`: the control point {place} is in a fixed layer; "
                f"`fixed` of the box is {self.fixed}"
            )
        if isinstance(direction, str) and direction not in AXES:
            raise Error(f"`{name}`: expected direction x, y or z, found `{direction}`")
        vector = AXES[direction] if isinstance(direction, str) else direction
        moved = chosen[..., None] * np.asarray(vector, dtype=np.float64)
        return Variable(name, self, moved, low, high, start)


class Deformation:
    """Points that move with variables, and the program of their shape.

    Made by :meth:`of_file`, :meth:`of_mesh` and :meth:`of_surfaces`. Boxes that overlap add their
    displacements; all of them embed the undeformed points.

    Attributes
    ----------
    points : numpy.ndarray
        Undeformed points, ``(n, 3)``.
    modes : numpy.ndarray
        Displacements for the value 1 of each variable, ``(variables, n, 3)``: the constant
        derivatives of the points.
    text : str
        The program: a parameter for each variable.
    """

    def __init__(
        self,
        points: Floats,
        variables: Sequence[Variable],
        edges: Integers,
        symmetry: str,
    ) -> None:
        if not variables:
            raise Error("a deformation needs a variable")
        if symmetry not in ("", *AXES):
            raise Error(f"the plane of symmetry is x, y or z, found `{symmetry}`")
        self.points = points
        self.variables = tuple(variables)
        self.remarks: list[str] = []
        self.text = ""
        modes = []
        for variable in self.variables:
            moved = variable.displacements
            if moved.shape != (*variable.box.counts, 3):
                raise Error(
                    f"`{variable.name}`: displacements {moved.shape} of {variable.box.counts} "
                    "control points"
                )
            if symmetry:
                moved = _mirrored(variable, points, "xyz".index(symmetry))
            _untorn(variable, moved, points, edges)
            modes.append(variable.box.displaced(moved, points))
        self.modes: Floats = np.array(modes)
        for variable, mode in zip(self.variables, self.modes, strict=True):
            if not mode.any():
                raise Error(
                    f"`{variable.name}` moves no point: the box contains no point of the shape"
                )

    # -- making ----------------------------------------------------------------------------

    @classmethod
    def of_file(
        cls,
        path: str | os.PathLike[str],
        variables: Sequence[Variable],
        *,
        symmetry: str = "",
        units: str = "",
        file_units: str = "",
    ) -> Deformation:
        """The deformation of a mesh or panel file.

        Parameters
        ----------
        path, units, file_units
            See :func:`moldloft.read_mesh`. Warnings are in ``remarks``.
        variables
            Variables in the unit of the model.
        symmetry
            Plane in which the deformation is symmetric, ``"y"`` for y = 0: control points move with
            their images.
        """
        unit, points, faces, remarks = mesh_of_file(path, units=units, file_units=file_units)
        found = cls.of_mesh(points, faces, variables, symmetry=symmetry, units=unit)
        found.remarks = remarks
        return found

    @classmethod
    def of_mesh(
        cls,
        points: ArrayLike,
        faces: ArrayLike,
        variables: Sequence[Variable],
        *,
        symmetry: str = "",
        units: str = "",
    ) -> Deformation:
        """The deformation of a mesh, a ``MeshBody``.

        Parameters
        ----------
        points
            ``(n, 3)``.
        faces
            Corners from 0, ``(m, 3)`` or ``(m, 4)``; a triangle among quadrilaterals repeats its
            last.
        variables
            Design variables.
        symmetry
            See :meth:`of_file`. For half a mesh the model has that plane of symmetry.
        units
            Unit of length of the model.
        """
        points = np.array(points, dtype=np.float64)
        corners = np.array(faces, dtype=np.int64)
        if points.ndim != 2 or points.shape[1:] != (3,) or corners.ndim != 2 or not corners.size:
            raise Error(
                f"a mesh is points (n, 3) and faces (m, 3 or 4), found {points.shape}, "
                f"{corners.shape}"
            )
        if corners.min() < 0 or corners.max() >= len(points):
            raise Error(f"a face has the corner {corners.max()}, of {len(points)} points")
        if corners.shape[1] == 3:
            corners = np.concatenate([corners, corners[:, 2:]], axis=1)
        edges = np.concatenate([corners[:, [k, (k + 1) % 4]] for k in range(4)])
        found = cls(points, variables, edges, symmetry)
        body = mesh_statement(found._moved(slice(None)), corners)
        found.text = found._program(body, symmetry, units)
        return found

    @classmethod
    def of_surfaces(
        cls,
        surfaces: Mapping[str, Nurbs],
        variables: Sequence[Variable],
        *,
        symmetry: str = "",
        units: str = "",
    ) -> Deformation:
        """The deformation of NURBS surfaces by their control points.

        An affine deformation is exact. Otherwise the control points are moved, and the surface
        differs from the deformed one by an error proportional to the square of the distance between
        control points.

        Parameters
        ----------
        surfaces
            Surfaces by name, such as ``{"hull": m["hull"].to_nurbs()}``.
        variables
            Design variables.
        symmetry, units
            See :meth:`of_mesh`.
        """
        nets = [s.points.reshape(-1, 3) for s in surfaces.values()]
        if not nets:
            raise Error("a deformation needs a surface")
        ends = np.cumsum([0, *map(len, nets)])
        edges = []
        for first, surface in zip(ends, surfaces.values(), strict=False):
            number = first + np.arange(surface.points[..., 0].size).reshape(
                surface.points.shape[:-1]
            )
            for axis in range(number.ndim):
                rows = np.moveaxis(number, axis, 0)
                edges.append(np.stack([rows[:-1].ravel(), rows[1:].ravel()], axis=1))
        found = cls(np.concatenate(nets), variables, np.concatenate(edges), symmetry)
        statements = [
            surface.to_sdl(name, points=found._moved(slice(first, first + net.shape[0])))
            for (name, surface), net, first in zip(surfaces.items(), nets, ends, strict=False)
        ]
        found.text = found._program("\n".join(statements) + "\n", symmetry, units)
        return found

    def _moved(self, rows: slice) -> str:
        """The points as an expression in the variables."""
        text = _listed(self.points[rows])
        for variable, mode in zip(self.variables, self.modes, strict=True):
            if mode[rows].any():
                text += f" + {variable.name} * {_listed(mode[rows])}"
        return text

    def _program(self, body: str, symmetry: str, units: str) -> str:
        info = [f'units = "{units}"'] if units else []
        if symmetry and self._half("xyz".index(symmetry)):
            info.append(f'symmetry = "{symmetry}"')
        head = f"Model info({', '.join(info)});\n" if info else ""
        for v in self.variables:
            limits = ""
            if v.low is not None or v.high is not None:
                low, high = ("" if x is None else repr(float(x)) for x in (v.low, v.high))
                limits = f" in [{low or '-1e300'}, {high or '1e300'}]"
            head += f"param float {v.name} = {float(v.start)!r}{limits};\n"
        return head + body

    def _half(self, axis: int) -> bool:
        return _one_sided(self.points[:, axis])

    # -- use -------------------------------------------------------------------------------

    def model(self) -> Model:
        """The model: ``body``, or the surfaces; its parameters are the variables."""
        from moldloft.loading import loads

        return loads(self.text, name="deformation.sdl")

    def deformed(self, values: ArrayLike | Mapping[str, float]) -> Floats:
        """The points for values of the variables, ``(n, 3)``.

        Parameters
        ----------
        values
            ``(variables,)``, or by name; variables without a value are 0.
        """
        if isinstance(values, Mapping):
            known = [v.name for v in self.variables]
            if unknown := [name for name in values if name not in known]:
                raise Error(f"unknown variable `{unknown[0]}`; variables: {', '.join(known)}")
            values = [values.get(name, 0.0) for name in known]
        row = np.asarray(values, dtype=np.float64)
        if row.shape != (len(self.variables),):
            raise Error(f"{len(self.variables)} values are needed, found {row.shape}")
        found: Floats = self.points + np.einsum("k,knc->nc", row, self.modes)
        return found

    def gradient(self, weights: ArrayLike) -> Floats:
        """Derivatives with respect to the variables from those with respect to the points.

        Parameters
        ----------
        weights
            Derivatives of the number by the points, as an adjoint solver has them: ``(n, 3)``, or
            ``(numbers, n, 3)``.

        Returns
        -------
        numpy.ndarray
            ``(variables,)``, or ``(numbers, variables)``.
        """
        rows = np.asarray(weights, dtype=np.float64)
        if rows.shape[-2:] != self.points.shape:
            raise Error(f"weights {rows.shape} of {len(self.points)} points")
        found: Floats = np.einsum("...nc,knc->...k", rows, self.modes)
        return found


def _listed(points: Floats) -> str:
    rows = (f"{{{x!r}, {y!r}, {z!r}}}" for x, y, z in (points + 0.0).tolist())
    return "{" + ", ".join(rows).replace("0.0,", "0,").replace("0.0}", "0}") + "}"


def _one_sided(coordinates: Floats) -> bool:
    room = ON_SIDE * float(np.abs(coordinates).max())
    return bool((coordinates >= -room).all() or (coordinates <= room).all())


def _mirrored(variable: Variable, points: Floats, axis: int) -> Floats:
    """Displacements that move each control point's image as well."""
    box, moved = variable.box, variable.displacements
    net = box.control_points.reshape(-1, 3)
    room = ON_SIDE * float(np.linalg.norm(box.edges, axis=1).max())
    flip = np.where(np.arange(3) == axis, -1.0, 1.0)
    flat = moved.reshape(-1, 3)
    on = np.abs(net[:, axis]) <= room
    if flat[on, axis].any():
        raise Error(
            f"`{variable.name}` moves control points of the plane {'xyz'[axis]} = 0 out of it"
        )
    if _one_sided(points[:, axis]) and _one_sided(net[:, axis]):
        return moved
    found = flat.copy()
    for k in np.flatnonzero(flat.any(axis=1) & ~on):
        image = int(np.argmin(np.linalg.norm(net - net[k] * flip, axis=1)))
        if np.linalg.norm(net[image] - net[k] * flip) > room:
            raise Error(
                f"`{variable.name}`: the box is not symmetric in {'xyz'[axis]} = 0, and its shape "
                "is on both sides"
            )
        if flat[image].any() and not np.allclose(flat[image], flat[k] * flip, atol=1e-12):
            raise Error(
                f"`{variable.name}` moves the control points {k} and {image}, images of each "
                "other, differently; name only those of one side"
            )
        found[image] = flat[k] * flip
    return found.reshape(moved.shape)


def _untorn(variable: Variable, moved: Floats, points: Floats, edges: Integers) -> None:
    """Rejects a variable that would tear the shape where it passes through a side of the box."""
    box = variable.box
    at = box.parameters(points)
    inside = np.asarray(((at >= 0) & (at <= 1)).all(axis=1))
    crossing = edges[inside[edges[:, 0]] != inside[edges[:, 1]]]
    if not crossing.size:
        return
    swap = ~inside[crossing[:, 0]]
    crossing[swap] = crossing[swap][:, ::-1]
    start, step = at[crossing[:, 0]], at[crossing[:, 1]] - at[crossing[:, 0]]
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(step > 0, (1 - start) / step, np.where(step < 0, -start / step, np.inf))
    leaves = np.clip(start + reach.min(axis=1)[:, None] * step, 0, 1)
    on_box = box.origin + leaves @ box.edges
    jump = np.linalg.norm(box.displaced(moved, on_box), axis=1)
    worst = int(np.argmax(jump))
    if jump[worst] > ON_SIDE * float(np.abs(moved).max()):
        axis = int(np.argmin(reach[worst]))
        end = int(step[worst, axis] > 0)
        raise Error(
            f"`{variable.name}` tears the shape: it passes through the side {'uvw'[axis]} = {end} "
            f"of the box, where points move by {jump[worst]:.3g} of its value; "
            "fix layers of control points there, or take a greater box"
        )


explain(globals())
