"""Products of a STEP file that are placed more than once."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from moldloft.cad import identifier
from moldloft.cad.faces import Placement
from moldloft.cad.sewing import faces_of

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["NOWHERE", "Assemblies", "Content", "Inside", "label_name"]

Colour = tuple[float, float, float]

_RIGID = 1e-12
"""Largest difference of a placement from a rotation."""


class Inside(NamedTuple):
    """What a shape is placed in."""

    products: tuple[str, ...] = ()
    """Names of the assemblies, from the outermost one."""
    colour: Colour | None = None
    """The colour of the placement, sRGB."""


NOWHERE = Inside()
"""A shape that is in no assembly."""


@dataclass
class Content:
    """What a product, or the whole file, contains itself, and what is placed in it."""

    shapes: list[tuple[Any, Inside]] = field(default_factory=list)
    """Shapes in their places."""
    placed: list[Placement] = field(default_factory=list)
    """The products that are placed in it and are components."""


class Assemblies:
    """The tree of products of a document.

    Parameters
    ----------
    document
        The document.
    named
        The name of a shape, or an empty text.
    colour
        The colour of a label, or None.
    components
        True to look for products that are placed more than once.
    """

    def __init__(
        self,
        document: Any,
        named: Callable[[Any], str],
        colour: Callable[[Any], Colour | None],
        components: bool,
    ) -> None:
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        self._tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        self._named = named
        self._colour = colour
        self._free = _labels(self._tool.GetFreeShapes)
        uses: Counter[str] = Counter()
        labels: dict[str, Any] = {}
        single: set[str] = set()
        rigid = True

        def visit(label: Any) -> None:
            nonlocal rigid
            for part, product, place in self._components(label):
                key = _entry(product)
                uses[key] += 1
                rigid = rigid and _is_rigid(place)
                # The colour of one placement is not that of the product.
                if colour(part) is not None:
                    single.add(key)
                if key not in labels:
                    labels[key] = product
                    visit(product)

        for label in self._free:
            visit(label)
        self.coloured = bool(single)
        taken: set[str] = set()
        self._names: dict[str, str] = {}
        for key, product in labels.items():
            if (
                components
                and rigid
                and uses[key] > 1
                and key not in single
                and self._has_faces(product)
            ):
                self._names[key] = identifier(named(self._tool.GetShape_s(product)), taken)
        self._products = {self._names[key]: labels[key] for key in self._names}

    @property
    def names(self) -> list[str]:
        """Names of the products that are placed more than once."""
        return list(self._products)

    def content(self, name: str = "") -> Content:
        """Content of a product that is placed more than once, or without a name of the file.

        Parameters
        ----------
        name
            One of the names.
        """
        from OCP.TopLoc import TopLoc_Location

        found = Content()
        taken: set[str] = set()

        def expand(label: Any, place: Any, inside: Inside) -> None:
            shape = self._tool.GetShape_s(label)
            inner = self._components(label)
            if not inner:
                found.shapes.append((shape.Moved(place), inside))
                return
            own = self._named(shape)
            path = (*inside.products, identifier(own, set())) if own else inside.products
            for part, product, placed in inner:
                at = place.Multiplied(placed)
                key = self._names.get(_entry(product))
                if key is None:
                    expand(product, at, Inside(path, self._colour(part) or inside.colour))
                else:
                    label_of = label_name(part)
                    wished = key if not label_of or label_of.startswith("=>") else label_of
                    found.placed.append(_placement(key, identifier(wished, taken), at))

        for label in [self._products[name]] if name else self._free:
            expand(label, TopLoc_Location(), NOWHERE)
        return found

    def _components(self, label: Any) -> list[tuple[Any, Any, Any]]:
        """The parts of an assembly: label, label of the product, and place."""
        from OCP.TDF import TDF_Label

        found = []
        for part in _labels(lambda held: self._tool.GetComponents_s(label, held)):
            product = TDF_Label()
            if self._tool.GetReferredShape_s(part, product):
                found.append((part, product, self._tool.GetLocation_s(part)))
        return found

    def _has_faces(self, label: Any) -> bool:
        from OCP.TopAbs import TopAbs_FACE

        return bool(faces_of(self._tool.GetShape_s(label), TopAbs_FACE))


def _labels(ask: Callable[[Any], Any]) -> list[Any]:
    from OCP.collections import Sequence_TDF_Label

    held = Sequence_TDF_Label()
    ask(held)
    return [held.Value(k) for k in range(1, held.Length() + 1)]


def _entry(label: Any) -> str:
    from OCP.TCollection import TCollection_AsciiString
    from OCP.TDF import TDF_Tool

    text = TCollection_AsciiString()
    TDF_Tool.Entry_s(label, text)
    return str(text.ToCString())


def label_name(label: Any) -> str:
    """The name of a label of a document; empty if it has none."""
    from OCP.TDataStd import TDataStd_Name

    name = TDataStd_Name()
    if not label.IsAttribute(TDataStd_Name.GetID_s()):
        return ""
    label.FindAttribute(TDataStd_Name.GetID_s(), name)
    return str(name.Get().ToExtString())


def _rows(place: Any) -> list[list[float]]:
    """The rows of a placement: three numbers of the rotation and one of the translation."""
    change = place.Transformation()
    return [[change.Value(row, column) for column in (1, 2, 3, 4)] for row in (1, 2, 3)]


def _is_rigid(place: Any) -> bool:
    """True for a rotation and a translation, without scale and mirror."""
    rows = _rows(place)
    x, y, z = ([row[k] for row in rows] for k in range(3))
    cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
    length = sum(a * a for a in x)
    return abs(length - 1) < _RIGID and all(
        abs(a - b) < _RIGID for a, b in zip(cross, z, strict=True)
    )


def _placement(part: str, name: str, place: Any) -> Placement:
    rows = _rows(place)
    columns = [(rows[0][k], rows[1][k], rows[2][k]) for k in range(4)]
    return Placement(part, name, columns[3], columns[0], columns[1])
