"""Values of sets: primitives, attributes, results of queries."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moldloft.implicit.fields import Field

    Floats = NDArray[np.float64]
    Triple = Sequence[float]

__all__ = ["Attributes", "Distance", "Hit", "Lamp", "Leaf", "Mass", "Nearest", "Sun"]


def warn_of(remark: str, frames: int = 1) -> None:
    """Warn the caller of a method, ``frames`` up, about a number that misses its accuracy."""
    warnings.warn(remark, stacklevel=2 + frames)


@dataclass(frozen=True)
class Attributes:
    """Attributes of a set."""

    name: str | None = None
    """Name of its faces."""
    colour: int | None = None
    """Index of a palette colour, 0 to 15."""
    material: str | None = None
    """Material."""
    tolerance: float | None = None
    """Distance below which two points count as one."""
    tags: Mapping[str, str] = dataclass_field(default_factory=dict)
    """Further attributes, by tag."""


@dataclass(frozen=True)
class Leaf:
    """A primitive of a set with its attributes."""

    field: Field
    """The primitive, negated where a complement reached it."""
    kind: str
    """Type of the primitive."""
    attributes: Attributes
    """Its own attributes, completed by those of the sets around it."""

    @property
    def name(self) -> str:
        """Its name, or its kind."""
        return self.attributes.name or self.kind


@dataclass(frozen=True)
class Mass:
    """Mass properties for density 1: best values and proved brackets."""

    volume: float
    """Volume."""
    volume_bracket: tuple[float, float]
    """Its bounds."""
    uncertain: float
    """Proved bound on the error of ``volume``."""
    estimate: float
    """Difference between two levels of facets, 0 if they agree: an estimate of the error, not a
    bound.
    """
    centroid: Floats | None
    """Centre of mass ``(3,)``; None for zero volume."""
    centroid_bracket: Floats
    """Its bounds, ``(3, 2)``."""
    inertia: Floats | None
    """Matrix of inertia about the centroid ``(3, 3)``."""
    inertia_bracket: Floats
    """Its bounds, ``(3, 3, 2)``."""


@dataclass(frozen=True)
class Nearest:
    """The nearest point of a surface."""

    point: Floats
    """Position."""
    distance: float
    """Distance."""
    at_least: float
    """No point of the surface is nearer than this; proved."""


@dataclass(frozen=True)
class Distance:
    """The distance of two sets."""

    distance: float
    """Distance of the two points; 0 where the sets overlap or touch."""
    at_least: float
    """No two points of the sets are nearer than this; proved."""
    first: Floats
    """A point of the first set."""
    second: Floats
    """A point of the second."""


@dataclass(frozen=True)
class Hit:
    """An intersection of a ray with the surface of a set."""

    t: float
    """Distance along the ray, in lengths of the direction."""
    point: Floats
    """Where."""
    leaf: int
    """The number of the primitive in :attr:`Set.leaves`."""
    normal: Floats
    """Unit normal, from solid to air."""
    enters: bool
    """True where the ray enters the solid."""


@dataclass(frozen=True)
class Sun:
    """Light from afar."""

    direction: Triple
    """Direction of the light."""
    colour: Triple = (0.8, 0.8, 0.8)
    """Linear red, green, blue."""


@dataclass(frozen=True)
class Lamp:
    """Light from a point."""

    place: Triple
    """Position of the light."""
    colour: Triple = (0.8, 0.8, 0.8)
    """Linear red, green, blue."""
