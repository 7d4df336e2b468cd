"""Distances of points from the surfaces of a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error, UnknownNameError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["Deviation", "deviation"]

_ALONG = 0.02
"""Sine of the angle from the normal beyond which a point is beyond an edge of its surface."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """Points with the nearest points of the model; arrays have a row for each point."""

    points: Floats
    """The points, ``(n, 3)``."""
    distances: Floats
    """Distances, ``(n,)``, positive on the side to which the surface's panels face: that of
    S_u x S_v, or the other one by its ``orientation``; of an imported solid that is outside."""
    feet: Floats
    """The nearest points; of a mirrored model on the side of the point, ``(n, 3)``."""
    surfaces: NDArray[np.str_]
    """The names of the surfaces that they are on, ``(n,)``."""
    parameters: Floats
    """Their parameters (u, v), ``(n, 2)``."""
    beside: NDArray[np.bool_]
    """True if the foot is on an edge or knuckle and the point is off the normal there: its distance
    is that from the edge, ``(n,)``.
    """

    @property
    def largest(self) -> float:
        """The largest distance."""
        return float(np.abs(self.distances).max())

    @property
    def rms(self) -> float:
        """The root of the mean square of the distances."""
        return float(np.sqrt(np.mean(self.distances**2)))

    @property
    def worst(self) -> int:
        """Index of the point with the largest distance."""
        return int(np.abs(self.distances).argmax())

    def summary(self) -> str:
        """A line for each surface: number of points, rms, largest distance and its position.

        Returns
        -------
        str
            For people; the figures are attributes.
        """
        rows = [f"{'surface':20} {'points':>8} {'rms':>11} {'largest':>11}  at"]
        for name in dict.fromkeys(self.surfaces.tolist()):
            own = np.flatnonzero(self.surfaces == name)
            d = np.abs(self.distances[own])
            at = ", ".join(f"{x:.6g}" for x in self.points[own[d.argmax()]])
            rms = float(np.sqrt(np.mean(d**2)))
            rows.append(f"{name:20} {len(own):8} {rms:11.4g} {d.max():11.4g}  ({at})")
        beside = int(self.beside.sum())
        if beside:
            rows.append(
                f"{beside} points are beyond the surfaces: their distance is that from an edge"
            )
        return "\n".join(rows)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``: x, y, z, distance, surface, u, v, beside.

        Returns
        -------
        pandas.DataFrame
            A row for each point.
        """
        from moldloft.adapters import frame

        x, y, z = self.points.T
        u, v = self.parameters.T
        return frame(
            {
                "x": x,
                "y": y,
                "z": z,
                "distance": self.distances,
                "surface": self.surfaces,
                "u": u,
                "v": v,
                "beside": self.beside,
            }
        )

    def __repr__(self) -> str:
        figures = f"rms {self.rms:.4g}, largest {self.largest:.4g}"
        return f"<Deviation: {len(self.points)} points, {figures}>"


def deviation(model: Model, points: ArrayLike, *, objects: Sequence[str] | str = ()) -> Deviation:
    """Distances of points from the surfaces of a model.

    For a model with planes of symmetry, the images of its surfaces are included.

    Parameters
    ----------
    model
        The model.
    points
        ``(n, 3)``, in its unit.
    objects
        Names of its surfaces; by default all that it shows.

    Returns
    -------
    Deviation
        For each point its foot, its signed distance and the surface.

    Raises
    ------
    Error
        Without points or surfaces, and for a model that shows bodies, which exist only as
        triangles: name the surfaces.
    """
    at = np.asarray(points, dtype=np.float64)
    if at.ndim != 2 or at.shape[1] != 3:
        raise Error(f"points are of shape (n, 3), not {at.shape}")
    if not len(at):
        raise Error("there are no points to measure")
    names = _surfaces(model, objects)
    best = np.full(len(at), np.inf)
    found = Deviation(
        at,
        np.empty(len(at)),
        np.empty_like(at),
        np.empty(len(at), dtype=f"<U{max(map(len, names))}"),
        np.empty((len(at), 2)),
        np.zeros(len(at), dtype=bool),
    )
    facing = {name: _facing(model, name) for name in names}
    signs = [(1.0, -1.0) if axis in model.symmetry else (1.0,) for axis in "xyz"]
    for image in product(*signs):
        mirrored = at * image
        for name in names:
            near = model[name].nearest(mirrored)
            nearer = np.flatnonzero(near.distances < best)
            if not len(nearer):
                continue
            best[nearer] = near.distances[nearer]
            parameters = near.parameters[nearer]
            off = mirrored[nearer] - near.points[nearer]
            cosine = facing[name] * _against(_normals(model[name], parameters), off)
            found.distances[nearer] = np.where(cosine < 0, -1, 1) * near.distances[nearer]
            found.feet[nearer] = near.points[nearer] * image
            found.surfaces[nearer] = name
            found.parameters[nearer] = parameters
            found.beside[nearer] = np.abs(cosine) < np.sqrt(1 - _ALONG**2)
    # A point on the surface to rounding has no side.
    size = float(np.ptp(at, axis=0).max()) + float(np.abs(found.feet).max())
    found.beside[best <= 1e-12 * size] = False
    return found


def _surfaces(model: Model, objects: Sequence[str] | str) -> list[str]:
    from moldloft.shapes.objects import Surface

    if objects:
        names = [objects] if isinstance(objects, str) else list(objects)
        for name in names:
            if name not in model:
                raise UnknownNameError(f"the model has no object `{name}`")
            if not isinstance(model[name], Surface):
                raise Error(f"`{name}` is not a surface; distances are those from surfaces")
        return names
    shown = list(dict.fromkeys(patch.name.split(".")[0] for patch in model.mesh().patches))
    names = [name for name in shown if name in model and isinstance(model[name], Surface)]
    others = [name for name in shown if name not in names]
    if others:
        raise Error(
            f"`{others[0]}` consists of triangles and is not a surface\n"
            "help: name the surfaces to measure against: objects = [...]"
        )
    if not names:
        raise Error("the model shows no surface to measure against")
    return names


def _facing(model: Model, name: str) -> float:
    """1 where the panels of a surface face along S_u x S_v, -1 where they face against it."""
    mesh = model.mesh()
    own = [p for p in mesh.patches if p.name == name]
    if not own:
        return 1.0
    corners = mesh.vertices[mesh.faces[own[0].start : own[0].stop]]
    crossed = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    largest = int(np.argmax(np.linalg.norm(crossed, axis=1)))
    foot = model[name].nearest(corners[largest].mean(axis=0)[None])
    normal = _normals(model[name], foot.parameters)[0]
    return -1.0 if normal @ crossed[largest] < 0 else 1.0


def _normals(surface: Any, parameters: Floats) -> Floats:
    """Unit normals by differences, used only for their side; at a pole those of adjacent points."""
    step = 1e-4
    inside = np.clip(parameters, step, 1 - step)
    u, v = inside.T
    by_u = surface(u + step, v) - surface(u - step, v)
    by_v = surface(u, v + step) - surface(u, v - step)
    return np.asarray(np.cross(by_u, by_v))


def _against(normals: Floats, off: Floats) -> Floats:
    """The cosines between normals and offsets; 1 where either has no direction."""
    size = np.linalg.norm(normals, axis=1) * np.linalg.norm(off, axis=1)
    dot = np.einsum("ij,ij->i", normals, off)
    cosine: Floats = np.divide(dot, size, out=np.ones(len(off)), where=size > 0)
    return cosine


explain(globals())
