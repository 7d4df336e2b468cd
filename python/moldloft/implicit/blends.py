"""Blends: surfaces tangent to others along prescribed rails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

from moldloft import _core
from moldloft.arguments import explain
from moldloft.implicit.fields import Field
from moldloft.implicit.moving import triple

if TYPE_CHECKING:
    from moldloft.implicit.sets import Set

__all__ = ["Blend"]

CIRCULAR = 2 / 3
"""The weight at which a fillet between perpendicular planes is a circular arc."""


@dataclass(frozen=True)
class Blend:
    """A blend with the set that it makes."""

    set: Set
    """The bodies with their blend."""
    field: Field
    """The surface of the blend."""

    @property
    def degree(self) -> int:
        """Degree of the blend's polynomial."""
        return self.field.degree


def _box(
    low: Sequence[float] | None, high: Sequence[float] | None
) -> tuple[list[float], list[float]] | None:
    if low is None and high is None:
        return None
    if low is None or high is None:
        raise ValueError("a box has two corners, and one is missing: give low and high, or neither")
    return triple(low, "low corner"), triple(high, "high corner")


def liming(
    l1: Field,
    l2: Field,
    l3: Field,
    l4: Field | None = None,
    *,
    lambda_: float = 0.5,
    contact: int = 1,
    low: Sequence[float] | None = None,
    high: Sequence[float] | None = None,
) -> Field:
    """The surface through the four curves in which ``l1`` and ``l2`` meet ``l3`` and ``l4``.

    ``lambda_ l1 l2 - (1 - lambda_) l3 l4``. Without ``l4``, ``l3`` is a rail: the blend touches
    both bodies where the rail does, with contact G^n.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    l3
        The rail of the first body, or of both.
    l4
        The rail of the second body.
    lambda_
        Shape of the blend, between 0 and 1.
    contact
        Order of contact: 1 for tangent planes, 2 for curvature too.
    low
        Low corner of a box over which the contact is proved, ``(3,)``.
    high
        High corner of the box.

    Returns
    -------
    Field
        A quartic for quadrics; its sign is that of the body.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> x, y, z = im.axes()
    >>> im.liming(x, y, x + y - 1, lambda_=2 / 3)((1, 0, 0))
    0.0
    """
    if l4 is None and (box := _box(low, high)) is not None:
        l1._core.check_rail(l2._core, l3._core, *box)
    other = None if l4 is None else l4._core
    return Field(l1._core.liming(l2._core, l3._core, other, float(lambda_), int(contact)))


def zhang(
    l1: Field,
    l2: Field,
    l3: Field,
    l4: Field,
    *,
    lambda_: float = 0.5,
    contact: int = 1,
    low: Sequence[float] | None = None,
    high: Sequence[float] | None = None,
) -> Field:
    """The transition from ``l1``, touched at the rail ``l3``, to ``l2``, touched at ``l4``.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    l3
        The rail of the first body, or of both.
    l4
        The rail of the second body.
    lambda_
        Shape of the blend, between 0 and 1.
    contact
        Order of contact: 1 for tangent planes, 2 for curvature too.
    low
        Low corner of a box over which the contact is proved, ``(3,)``.
    high
        High corner of the box.

    Returns
    -------
    Field
        Zero on the transition.
    """
    if (box := _box(low, high)) is not None:
        l1._core.check_rails(l2._core, l3._core, l4._core, *box)
    return Field(l1._core.zhang(l2._core, l3._core, l4._core, float(lambda_), int(contact)))


def setback(l1: Field, l2: Field, a: float, b: float | None = None) -> Field:
    """The rail of prescribed setbacks.

    It meets ``l1 = 0`` where ``l2 = b`` and ``l2 = 0`` where ``l1 = a``.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    a
        Setback on the second body: distance to the rail.
    b
        Setback on the first body; by default the same.

    Returns
    -------
    Field
        Zero at the setback from the edge.
    """
    return Field(l1._core.setback(l2._core, float(a), float(a if b is None else b)))


def _blended(
    kind: str,
    l1: Field,
    l2: Field,
    setbacks: tuple[float, float],
    lambda_: float,
    box: tuple[list[float], list[float]] | None,
) -> Blend:
    from moldloft.implicit.sets import Set

    if box is not None:
        # The round of an edge is the fillet of the complements.
        bodies = (-l1, -l2) if kind == "round" else (l1, l2)
        bodies[0]._core.check_rail(bodies[1]._core, setback(*bodies, *setbacks)._core, *box)
    core, field = _core.Set.blended(kind, l1._core, l2._core, list(setbacks), float(lambda_))
    return Blend(Set(core), Field(field))


@overload
def fillet(
    l1: Field,
    l2: Field,
    width: float,
    other: float | None = None,
    *,
    lambda_: float = CIRCULAR,
    low: Sequence[float] | None = None,
    high: Sequence[float] | None = None,
) -> Blend: ...
@overload
def fillet(
    l1: Set,
    l2: Set | Field,
    width: float,
    other: float | None = None,
    *,
    lambda_: float = CIRCULAR,
    low: None = None,
    high: None = None,
) -> Set: ...
def fillet(
    l1: Field | Set,
    l2: Field | Set,
    width: float,
    other: float | None = None,
    *,
    lambda_: float = CIRCULAR,
    low: Sequence[float] | None = None,
    high: Sequence[float] | None = None,
) -> Blend | Set:
    """The union of two bodies with a fillet in their corner, of setback ``width`` on both.

    ``lambda_`` shapes it between 0 (a chamfer) and 1 (the corner). With true distances the widths
    are lengths. Of sets see :meth:`Set.filleted`.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    width
        Setback on the second body, in model units; on both by default.
    other
        Setback on the first body, if different.
    lambda_
        Shape of the blend, between 0 and 1.
    low
        Low corner of a box over which the contact of two fields is proved, ``(3,)``.
    high
        High corner of the box.

    Returns
    -------
    Blend or Set
        A shape for further combination.
    """
    from moldloft.implicit.sets import Set

    box = _box(low, high)
    if isinstance(l1, Set) or isinstance(l2, Set):
        if box is not None:
            raise ValueError("low and high prove the contact of two fields, not of sets")
        a = l1 if isinstance(l1, Set) else Set(l1)
        return a.filleted(l2, width, other, lambda_=lambda_)
    return _blended("fillet", l1, l2, _setbacks(width, other), lambda_, box)


def _setbacks(width: float, other: float | None) -> tuple[float, float]:
    return float(width), float(width if other is None else other)


def rounded(
    l1: Field,
    l2: Field,
    width: float,
    other: float | None = None,
    *,
    lambda_: float = CIRCULAR,
    low: Sequence[float] | None = None,
    high: Sequence[float] | None = None,
) -> Blend:
    """The intersection of two bodies with its edge rounded, of setback ``width`` on both.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    width
        Setback on the second body, in model units; on both by default.
    other
        Setback on the first body, if different.
    lambda_
        Shape of the blend, between 0 and 1.
    low
        Low corner of a box over which the contact is proved, ``(3,)``.
    high
        High corner of the box.

    Returns
    -------
    Blend
        A shape for further combination.
    """
    return _blended("round", l1, l2, _setbacks(width, other), lambda_, _box(low, high))


def transition(
    l1: Field,
    l2: Field,
    l3: Field,
    l4: Field,
    *,
    lambda_: float = 0.5,
    contact: int = 1,
    low: Sequence[float] | None = None,
    high: Sequence[float] | None = None,
) -> Blend:
    """The body ``l1`` up to its rail ``l3``, ``l2`` up to ``l4``, and Zhang's transition.

    The solid sides of the rails keep the bodies.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    l3
        The rail of the first body, or of both.
    l4
        The rail of the second body.
    lambda_
        Shape of the blend, between 0 and 1.
    contact
        Order of contact: 1 for tangent planes, 2 for curvature too.
    low
        Low corner of a box over which the contact is proved, ``(3,)``.
    high
        High corner of the box.

    Returns
    -------
    Blend
        A shape for further combination.
    """
    from moldloft.implicit.sets import Set

    if (box := _box(low, high)) is not None:
        l1._core.check_rails(l2._core, l3._core, l4._core, *box)
    cores = (l1._core, l2._core, l3._core, l4._core)
    core, field = _core.Set.transition(*cores, float(lambda_), int(contact))
    return Blend(Set(core), Field(field))


explain(globals())
