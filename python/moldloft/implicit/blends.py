"""Blends: surfaces that touch others along prescribed rails."""

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


def _box(box: tuple[Sequence[float], Sequence[float]]) -> tuple[list[float], list[float]]:
    low, high = box
    return triple(low, "low corner"), triple(high, "high corner")


def liming(
    l1: Field,
    l2: Field,
    l3: Field,
    l4: Field | None = None,
    *,
    lam: float = 0.5,
    contact: int = 1,
) -> Field:
    """The surface through the four curves in which ``l1`` and ``l2`` meet ``l3`` and ``l4``.

    ``lam l1 l2 - (1 - lam) l3 l4``. Without ``l4``, ``l3`` is a rail: the blend touches both
    bodies where the rail does, with contact G^n.

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
    lam
        Shape of the blend, between 0 and 1.
    contact
        Order of contact: 1 for tangent planes, 2 for curvature too.

    Returns
    -------
    Field
        A quartic for quadrics; its sign is that of the body.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> x, y, z = im.axes()
    >>> im.liming(x, y, x + y - 1, lam=2 / 3)((1, 0, 0))
    0.0
    """
    other = None if l4 is None else l4._core
    return Field(l1._core.liming(l2._core, l3._core, other, float(lam), int(contact)))


def zhang(
    l1: Field, l2: Field, l3: Field, l4: Field, *, lam: float = 0.5, contact: int = 1
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
    lam
        Shape of the blend, between 0 and 1.
    contact
        Order of contact: 1 for tangent planes, 2 for curvature too.

    Returns
    -------
    Field
        Zero on the transition.
    """
    return Field(l1._core.zhang(l2._core, l3._core, l4._core, float(lam), int(contact)))


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
        Setback on the second body: where the rail meets it.
    b
        Setback on the first body; by default the same.

    Returns
    -------
    Field
        Zero at the setback from the edge.
    """
    return Field(l1._core.setback(l2._core, float(a), float(a if b is None else b)))


def check_rail(
    l1: Field, l2: Field, rail: Field, box: tuple[Sequence[float], Sequence[float]]
) -> None:
    """Prove over a box that a blend on the rail touches both bodies with their own orientation.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    rail
        The rail.
    box
        Low and high corner.

    Raises
    ------
    Error
        With the place where it does not, or where that could not be proved.
    """
    l1._core.check_rail(l2._core, rail._core, *_box(box))


def check_rails(
    l1: Field, l2: Field, l3: Field, l4: Field, box: tuple[Sequence[float], Sequence[float]]
) -> None:
    """Prove over a box that a transition touches both bodies: its rails keep apart.

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
    box
        Low and high corner.

    Raises
    ------
    Error
        With the place where that fails.
    """
    l1._core.check_rails(l2._core, l3._core, l4._core, *_box(box))


def _blended(
    kind: str, l1: Field, l2: Field, width: float, other: float | None, lam: float
) -> Blend:
    from moldloft.implicit.sets import Set

    setbacks = [float(width), float(width if other is None else other)]
    core, field = _core.Set.blended(kind, l1._core, l2._core, setbacks, float(lam))
    return Blend(Set(core), Field(field))


@overload
def fillet(
    l1: Field, l2: Field, width: float, other: float | None = None, *, lam: float = CIRCULAR
) -> Blend: ...
@overload
def fillet(
    l1: Set, l2: Set | Field, width: float, other: float | None = None, *, lam: float = CIRCULAR
) -> Set: ...
def fillet(
    l1: Field | Set,
    l2: Field | Set,
    width: float,
    other: float | None = None,
    *,
    lam: float = CIRCULAR,
) -> Blend | Set:
    """The union of two bodies with a fillet in their corner, of setback ``width`` on both.

    ``lam`` shapes it between 0 (a chamfer) and 1 (the corner). With true distances the widths are
    lengths. Of sets see :meth:`Set.filleted`.

    Parameters
    ----------
    l1
        The first body.
    l2
        The second body.
    width
        Setback on the second body, in model units; on both by default.
    other
        Setback on the first body, where it differs.
    lam
        Shape of the blend, between 0 and 1.

    Returns
    -------
    Blend or Set
        What can be combined further.
    """
    from moldloft.implicit.sets import Set

    if isinstance(l1, Set) or isinstance(l2, Set):
        a = l1 if isinstance(l1, Set) else Set(l1)
        return a.filleted(l2, width, other, lam=lam)
    return _blended("fillet", l1, l2, width, other, lam)


def rounded(
    l1: Field, l2: Field, width: float, other: float | None = None, *, lam: float = CIRCULAR
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
        Setback on the first body, where it differs.
    lam
        Shape of the blend, between 0 and 1.

    Returns
    -------
    Blend
        What can be combined further.
    """
    return _blended("round", l1, l2, width, other, lam)


def transition(
    l1: Field, l2: Field, l3: Field, l4: Field, *, lam: float = 0.5, contact: int = 1
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
    lam
        Shape of the blend, between 0 and 1.
    contact
        Order of contact: 1 for tangent planes, 2 for curvature too.

    Returns
    -------
    Blend
        What can be combined further.
    """
    from moldloft.implicit.sets import Set

    cores = (l1._core, l2._core, l3._core, l4._core)
    core, field = _core.Set.transition(*cores, float(lam), int(contact))
    return Blend(Set(core), Field(field))


explain(globals())
