"""Numbers, objects and shapes of a model that is being written in Python.

Each is an expression of the language: arithmetic on it gives another, and the program that a model
function writes keeps the parameters and what was computed from them.
"""

from __future__ import annotations

import keyword
import math
from collections.abc import Callable, Mapping, Sequence, Set
from typing import TYPE_CHECKING, Any, ClassVar

from moldloft.arguments import explain
from moldloft.spelling import nearest

__all__ = [
    "AnyHandle",
    "AnyShape",
    "BeadHandle",
    "BodyHandle",
    "ContoursHandle",
    "CurveHandle",
    "Expr",
    "FieldShape",
    "FrameHandle",
    "Handle",
    "MagnetHandle",
    "PlaneHandle",
    "PointHandle",
    "RelabelHandle",
    "RingHandle",
    "SetShape",
    "Shape",
    "SnakeHandle",
    "SolidHandle",
    "SurfaceHandle",
    "arguments",
    "literal",
    "object_named",
    "result",
    "spelled",
]

_SUM, _PRODUCT, _SIGN, _POWER, _ATOM = range(5)


class Expr:
    """A number of a model, as an expression of the language, with its current value if it is known.

    Arithmetic and NumPy's elementary functions give further expressions. Comparisons use the value,
    so that a model function may branch. Conversion to a float raises an error, because it would
    lose the dependence on parameters.
    """

    __array_priority__ = 1000

    def __init__(self, text: str, value: float | None = None, rank: int = _ATOM) -> None:
        self.text = text
        self._value = value
        self._rank = rank

    @property
    def value(self) -> float:
        """The current value in this run of the model function."""
        if self._value is None:
            raise TypeError(
                f"the value of `{self.text}` is not known while the model function runs; "
                "branch on parameters instead"
            )
        return self._value

    def _in(self, rank: int) -> str:
        return self.text if self._rank >= rank else f"({self.text})"

    def _binary(self, other: object, sign: str, rank: int, *, swap: bool = False) -> Any:
        right = _expr(other)
        if right is None:
            return NotImplemented
        a, b = (right, self) if swap else (self, right)
        left_rank = rank + 1 if sign == "^" else rank
        text = f"{a._in(left_rank)} {sign} {b._in(rank + 1)}"
        return Expr(text, _apply(_ARITHMETIC[sign], a, b), rank)

    def __add__(self, other: object) -> Any:
        return self._binary(other, "+", _SUM)

    def __radd__(self, other: object) -> Any:
        return self._binary(other, "+", _SUM, swap=True)

    def __sub__(self, other: object) -> Any:
        return self._binary(other, "-", _SUM)

    def __rsub__(self, other: object) -> Any:
        return self._binary(other, "-", _SUM, swap=True)

    def __mul__(self, other: object) -> Any:
        return self._binary(other, "*", _PRODUCT)

    def __rmul__(self, other: object) -> Any:
        return self._binary(other, "*", _PRODUCT, swap=True)

    def __truediv__(self, other: object) -> Any:
        return self._binary(other, "/", _PRODUCT)

    def __rtruediv__(self, other: object) -> Any:
        return self._binary(other, "/", _PRODUCT, swap=True)

    def __pow__(self, other: object) -> Any:
        return self._binary(other, "^", _POWER)

    def __rpow__(self, other: object) -> Any:
        return self._binary(other, "^", _POWER, swap=True)

    def __neg__(self) -> Expr:
        return Expr(f"-{self._in(_POWER)}", _apply(lambda a: -a, self), _SIGN)

    def __pos__(self) -> Expr:
        return self

    def __abs__(self) -> Expr:
        return _function("abs", abs, self)

    def __float__(self) -> float:
        raise TypeError(
            f"`{self.text}` cannot become a float: the model would no longer follow its "
            "parameters. Use NumPy's functions (np.sin, np.sqrt) instead of those of math, and "
            ".value where only the number matters"
        )

    __int__ = __float__
    __index__ = __float__

    def __bool__(self) -> bool:
        return bool(self.value)

    def __hash__(self) -> int:
        return hash(self.text)

    def __eq__(self, other: object) -> bool:
        right = _expr(other)
        return right is not None and self.value == right.value

    def __lt__(self, other: object) -> bool:
        return self.value < _required(other).value

    def __le__(self, other: object) -> bool:
        return self.value <= _required(other).value

    def __gt__(self, other: object) -> bool:
        return self.value > _required(other).value

    def __ge__(self, other: object) -> bool:
        return self.value >= _required(other).value

    def __repr__(self) -> str:
        return f"Expr({self.text!r})"

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        """NumPy's elementary functions, and its arithmetic between arrays and expressions."""
        import numpy as np

        if method != "__call__" or kwargs:
            return NotImplemented
        if any(isinstance(x, np.ndarray) and x.ndim for x in inputs):
            arrays = np.broadcast_arrays(*(np.asarray(x, dtype=object) for x in inputs))
            out = np.empty(arrays[0].shape, dtype=object)
            for k in np.ndindex(*out.shape):
                out[k] = ufunc(*(a[k] for a in arrays))
            return out
        name = ufunc.__name__
        if name in _OPERATORS:
            return _OPERATORS[name](*inputs)
        if name in _FUNCTIONS:
            word, plain = _FUNCTIONS[name]
            return _function(word, plain, *(_required(x) for x in inputs))
        raise TypeError(f"numpy.{name} has no counterpart in the language")


def _apply(function: Callable[..., float], *args: Expr) -> float | None:
    values = [a._value for a in args]
    if any(v is None for v in values):
        return None
    try:
        return float(function(*values))
    except (ArithmeticError, ValueError):
        return None


def _function(word: str, plain: Callable[..., float], *args: Expr) -> Expr:
    return Expr(f"{word}({', '.join(a.text for a in args)})", _apply(plain, *args))


_ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "^": lambda a, b: a**b,
}
_FUNCTIONS: dict[str, tuple[str, Callable[..., float]]] = {
    "sqrt": ("sqrt", math.sqrt),
    "sin": ("sin", math.sin),
    "cos": ("cos", math.cos),
    "tan": ("tan", math.tan),
    "arcsin": ("asin", math.asin),
    "arccos": ("acos", math.acos),
    "arctan": ("atan", math.atan),
    "arctan2": ("atan2", math.atan2),
    "exp": ("exp", math.exp),
    "log": ("log", math.log),
    "log10": ("log10", math.log10),
    "sinh": ("sinh", math.sinh),
    "cosh": ("cosh", math.cosh),
    "tanh": ("tanh", math.tanh),
    "absolute": ("abs", abs),
    "floor": ("floor", math.floor),
    "ceil": ("ceil", math.ceil),
    "hypot": ("hypot", math.hypot),
    "minimum": ("min", min),
    "maximum": ("max", max),
    "deg2rad": ("radians", math.radians),
    "rad2deg": ("degrees", math.degrees),
}
_OPERATORS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: _required(a) + _required(b),
    "subtract": lambda a, b: _required(a) - _required(b),
    "multiply": lambda a, b: _required(a) * _required(b),
    "divide": lambda a, b: _required(a) / _required(b),
    "power": lambda a, b: _required(a) ** _required(b),
    "negative": lambda a: -_required(a),
    "positive": lambda a: a,
    "square": lambda a: a * a,
    "less": lambda a, b: _required(a) < _required(b),
    "less_equal": lambda a, b: _required(a) <= _required(b),
    "greater": lambda a, b: _required(a) > _required(b),
    "greater_equal": lambda a, b: _required(a) >= _required(b),
}


def literal(x: float) -> str:
    """A number in the notation of the language."""
    if not math.isfinite(x):
        raise ValueError(f"a number of a model must be finite, not {x}")
    return repr(int(x)) if x == int(x) and abs(x) < 1e15 else repr(x)


def _expr(x: object) -> Expr | None:
    if isinstance(x, Expr):
        return x
    if isinstance(x, bool) or not (isinstance(x, (int, float)) or hasattr(x, "__float__")):
        return None
    if getattr(x, "ndim", 0):
        return None
    try:
        value = float(x)
    except OverflowError:
        raise ValueError("a number of a model must be below 1.8e308") from None
    return Expr(literal(value), value, _ATOM if value >= 0 else _SIGN)


def _required(x: object) -> Expr:
    expr = _expr(x)
    if expr is None:
        raise TypeError(f"expected a number, found {type(x).__name__}")
    return expr


def spelled(x: object) -> str:
    """An argument in the notation of the language."""
    if isinstance(x, Handle):
        return x.name
    if isinstance(x, Shape):
        return x.text
    if isinstance(x, str):
        escaped = x.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    expr = _expr(x)
    if expr is not None:
        return expr.text
    # Neither has an order that the language could keep, or would lose its values.
    if isinstance(x, (bytes, Mapping, Set)):
        raise TypeError(f"{type(x).__name__} cannot be an argument of an object")
    if isinstance(x, Sequence) or hasattr(x, "__iter__"):
        return "{" + ", ".join(spelled(item) for item in x) + "}"
    raise TypeError(f"{type(x).__name__} cannot be an argument of an object")


class Handle:
    """A named object, for use in others.

    ``P.x`` is an expression, like the component of a point of a curve or surface, ``hull(0.5,
    0.25).y``. Each class of objects has a subclass with its members.
    """

    #: Members by name, with what each is; empty where the class of the object is not known.
    members: ClassVar[dict[str, type[Handle] | None]] = {}

    def __init__(self, name: str) -> None:
        self.name = name

    if not TYPE_CHECKING:

        def __getattr__(self, member: str) -> Expr | Handle:
            if member.startswith("_"):
                raise AttributeError(member)
            own = type(self).members
            text = f"{self.name}.{member}"
            if member in own:
                made = own[member]
                return Expr(text) if made is None else made(text)
            if own and member not in _FOUND:
                near = nearest(member, own)
                hint = f"did you mean `{near}`?" if near else f"it has: {', '.join(own)}"
                raise AttributeError(f"`{self.name}` has no member `{member}`; {hint}")
            return Expr(text)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *type(self).members})

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.name}>"


#: Members of what a search found.
_FOUND = frozenset({"status", "residual", "iterations", "start", "alternatives"})


class AnyHandle(Handle):
    """An object of a class without members, such as a list or a weight."""

    def __call__(self, *parameters: object) -> PointHandle:
        """A point of it, if it is a curve or surface."""
        return PointHandle(_called(self.name, parameters))

    if TYPE_CHECKING:

        def __getattr__(self, member: str) -> Expr: ...


class PointHandle(Handle):
    """A point or vector."""

    x: Expr
    y: Expr
    z: Expr
    members: ClassVar = {"x": None, "y": None, "z": None}


class BeadHandle(PointHandle):
    """A point on a curve."""

    t: Expr
    members: ClassVar = {**PointHandle.members, "t": None}


class MagnetHandle(PointHandle):
    """A point on a surface."""

    u: Expr
    v: Expr
    members: ClassVar = {**PointHandle.members, "u": None, "v": None}


class RingHandle(BeadHandle, MagnetHandle):
    """A point on a snake."""

    members: ClassVar = {**BeadHandle.members, **MagnetHandle.members}


class CurveHandle(Handle):
    """A curve; calling it gives the point at ``t``."""

    length: Expr
    members: ClassVar = {"length": None}

    def __call__(self, t: float | Expr, /) -> PointHandle:
        """The point at ``t``."""
        return PointHandle(_called(self.name, (t,)))


class SnakeHandle(CurveHandle):
    """A curve on a surface."""


class SurfaceHandle(Handle):
    """A surface; calling it gives the point at ``u, v``."""

    area: Expr
    volume: Expr
    centroid: PointHandle
    u0: SnakeHandle
    u1: SnakeHandle
    v0: SnakeHandle
    v1: SnakeHandle
    c00: MagnetHandle
    c10: MagnetHandle
    c11: MagnetHandle
    c01: MagnetHandle
    members: ClassVar = {
        "area": None,
        "volume": None,
        "centroid": PointHandle,
        **dict.fromkeys(("u0", "u1", "v0", "v1"), SnakeHandle),
        **dict.fromkeys(("c00", "c10", "c11", "c01"), MagnetHandle),
    }

    def __call__(self, u: float | Expr, v: float | Expr, /) -> PointHandle:
        """The point at ``u, v``."""
        return PointHandle(_called(self.name, (u, v)))


class SolidHandle(Handle):
    """A parametric solid."""

    volume: Expr
    members: ClassVar = {"volume": None}


class BodyHandle(Handle):
    """A body of triangles."""

    volume: Expr
    area: Expr
    centroid: PointHandle
    members: ClassVar = {
        "volume": None,
        "area": None,
        "centroid": PointHandle,
        **dict.fromkeys(("undecided", "blunt", "touching")),
    }


class PlaneHandle(Handle):
    """A plane."""


class FrameHandle(Handle):
    """A frame of three axes."""


class ContoursHandle(Handle):
    """A family of plane sections."""


class RelabelHandle(Handle):
    """A law that redistributes a parameter."""


def arguments(args: Sequence[object], named: Mapping[str, object]) -> str:
    """Arguments in the notation of the language; ``lambda_`` and ``from_`` lose the underscore."""
    words = [spelled(a) for a in args]
    for key, value in named.items():
        plain = key[:-1] if keyword.iskeyword(key[:-1]) else key
        words.append(f"{plain} = {spelled(value)}")
    return ", ".join(words)


def _called(name: str, parameters: Sequence[object]) -> str:
    return f"{name}({', '.join(spelled(p) for p in parameters)})"


class Shape:
    """A field or set of a model, as an expression of the language.

    Fields combine by ``+ - * /`` and ``**``, sets by ``|``, ``&``, ``-``, ``^`` and unary ``-``,
    the complement. Functions such as ``sphere`` and ``set`` come from :mod:`moldloft.functions`.
    """

    __array_ufunc__ = None

    def __init__(self, text: str, rank: int = _ATOM) -> None:
        self.text = text
        self._rank = rank

    def _in(self) -> str:
        return self.text if self._rank == _ATOM else f"({self.text})"

    def _binary(self, other: object, sign: str, *, swap: bool = False) -> Any:
        made = type(self)
        if isinstance(other, Shape):
            right = other._in()
            made = SetShape if isinstance(other, SetShape) else made
        elif isinstance(other, Handle):
            right = other.name
        else:
            number = _expr(other)
            if number is None:
                return NotImplemented
            right = number._in(_ATOM)
        a, b = (right, self._in()) if swap else (self._in(), right)
        return made(f"{a} {sign} {b}", _SUM)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.text!r})"


class FieldShape(Shape):
    """A field: negative inside, positive outside, zero on its surface."""

    def __add__(self, other: FieldShape | PlaneHandle | Expr | float | AnyShape) -> FieldShape:
        made: FieldShape = self._binary(other, "+")
        return made

    def __radd__(self, other: PlaneHandle | Expr | float) -> FieldShape:
        made: FieldShape = self._binary(other, "+", swap=True)
        return made

    def __sub__(self, other: FieldShape | PlaneHandle | Expr | float | AnyShape) -> FieldShape:
        made: FieldShape = self._binary(other, "-")
        return made

    def __rsub__(self, other: PlaneHandle | Expr | float) -> FieldShape:
        made: FieldShape = self._binary(other, "-", swap=True)
        return made

    def __mul__(self, other: FieldShape | PlaneHandle | Expr | float | AnyShape) -> FieldShape:
        made: FieldShape = self._binary(other, "*")
        return made

    def __rmul__(self, other: PlaneHandle | Expr | float) -> FieldShape:
        made: FieldShape = self._binary(other, "*", swap=True)
        return made

    def __truediv__(self, other: FieldShape | PlaneHandle | Expr | float | AnyShape) -> FieldShape:
        made: FieldShape = self._binary(other, "/")
        return made

    def __pow__(self, exponent: int) -> FieldShape:
        made: FieldShape = self._binary(exponent, "^")
        return made

    def __neg__(self) -> FieldShape:
        return FieldShape(f"-{self._in()}", _SIGN)

    def __abs__(self) -> FieldShape:
        return FieldShape(f"abs({self.text})")

    def __call__(self, point: object) -> Expr:
        """The value at a point."""
        return Expr(f"{self._in()}({spelled(point)})")


class SetShape(Shape):
    """A set: the solid sides of fields, combined."""

    def __or__(self, other: SetShape | FieldShape | PlaneHandle | AnyShape) -> SetShape:
        made: SetShape = self._binary(other, "|")
        return made

    def __and__(self, other: SetShape | FieldShape | PlaneHandle | AnyShape) -> SetShape:
        made: SetShape = self._binary(other, "&")
        return made

    def __sub__(self, other: SetShape | FieldShape | PlaneHandle | AnyShape) -> SetShape:
        made: SetShape = self._binary(other, "-")
        return made

    def __xor__(self, other: SetShape | FieldShape | PlaneHandle | AnyShape) -> SetShape:
        made: SetShape = self._binary(other, "^")
        return made

    def __neg__(self) -> SetShape:
        return SetShape(f"-{self._in()}", _SIGN)

    def __call__(self, point: object) -> Expr:
        """The value at a point: negative inside."""
        return Expr(f"{self._in()}({spelled(point)})")


class AnyShape(Shape):
    """A value whose class depends on arguments, such as that of ``max`` or ``translated``."""

    def __add__(self, other: object) -> Any:
        return self._binary(other, "+")

    def __radd__(self, other: object) -> Any:
        return self._binary(other, "+", swap=True)

    def __sub__(self, other: object) -> Any:
        return self._binary(other, "-")

    def __rsub__(self, other: object) -> Any:
        return self._binary(other, "-", swap=True)

    def __mul__(self, other: object) -> Any:
        return self._binary(other, "*")

    def __rmul__(self, other: object) -> Any:
        return self._binary(other, "*", swap=True)

    def __truediv__(self, other: object) -> Any:
        return self._binary(other, "/")

    def __pow__(self, exponent: int) -> Any:
        return self._binary(exponent, "^")

    def __or__(self, other: object) -> Any:
        return self._binary(other, "|")

    def __and__(self, other: object) -> Any:
        return self._binary(other, "&")

    def __xor__(self, other: object) -> Any:
        return self._binary(other, "^")

    def __neg__(self) -> AnyShape:
        return AnyShape(f"-{self._in()}", _SIGN)

    def __abs__(self) -> AnyShape:
        return AnyShape(f"abs({self.text})")

    def __call__(self, *parameters: object) -> Any:
        """The value at a point, or at parameters of a curve or surface."""
        return AnyShape(_called(self._in(), parameters))


#: What an expression of each class of the registry is in Python.
_RESULTS: dict[str, type[Expr] | type[Handle] | type[Shape]] = {
    "number": Expr,
    "integer": Expr,
    "vector": PointHandle,
    "point": PointHandle,
    "bead": BeadHandle,
    "magnet": MagnetHandle,
    "ring": RingHandle,
    "curve": CurveHandle,
    "snake": SnakeHandle,
    "surface": SurfaceHandle,
    "solid": SolidHandle,
    "mesh": BodyHandle,
    "plane": PlaneHandle,
    "frame": FrameHandle,
    "contours": ContoursHandle,
    "relabel": RelabelHandle,
    "field": FieldShape,
    "set": SetShape,
}


def result(class_: str, text: str) -> Any:
    """An expression of a given class.

    >>> result("curve", "keel")
    <CurveHandle: keel>
    """
    return _RESULTS.get(class_, AnyShape)(text)


def object_named(class_: str, name: str) -> Handle:
    """A named object of a given class."""
    made = _RESULTS.get(class_, AnyHandle)
    return made(name) if issubclass(made, Handle) else AnyHandle(name)


explain(globals())
