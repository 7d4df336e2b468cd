"""Models written in Python: functions whose calls declare objects.

What a model function does is written down as a program of the language, its parameters and the
arithmetic on them included. So a model made in Python has everything that a text has: only what
changed is evaluated again, and derivatives are exact.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from functools import update_wrapper
from typing import Any

from moldloft import _core
from moldloft.models import Model

__all__ = ["Builder", "Expr", "Handle", "Kind", "ModelFunction", "Range", "model", "param"]

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_SUM, _PRODUCT, _SIGN, _POWER, _ATOM = range(5)


class Expr:
    """A number of a model, as an expression of the language; it also knows its value, if it can.

    Arithmetic and NumPy's elementary functions give further expressions. Comparisons look at the
    value, so that a model function may branch. Turning an expression into a float would cut it
    off from its parameters and raises.
    """

    __array_priority__ = 1000

    def __init__(self, text: str, value: float | None = None, rank: int = _ATOM) -> None:
        self.text = text
        self._value = value
        self._rank = rank

    @property
    def value(self) -> float:
        """The number in this run of the model function."""
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


def _literal(x: float) -> str:
    if not math.isfinite(x):
        raise ValueError(f"a number of a model must be finite, not {x}")
    return repr(int(x)) if x == int(x) and abs(x) < 1e15 else repr(x)


def _expr(x: object) -> Expr | None:
    if isinstance(x, Expr):
        return x
    if isinstance(x, bool) or not (isinstance(x, (int, float)) or hasattr(x, "__float__")):
        return None
    value = float(x)
    return Expr(_literal(value), value, _ATOM if value >= 0 else _SIGN)


def _required(x: object) -> Expr:
    expr = _expr(x)
    if expr is None:
        raise TypeError(f"expected a number, found {type(x).__name__}")
    return expr


def _spelled(x: object) -> str:
    """An argument as the language writes it."""
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
    if isinstance(x, Sequence) or hasattr(x, "__iter__"):
        return "{" + ", ".join(_spelled(item) for item in x) + "}"
    raise TypeError(f"{type(x).__name__} cannot be an argument of an object")


class Handle:
    """An object under its name, to build others on.

    ``P.x`` is an expression, and so is the component of a point of a curve or surface,
    ``hull(0.5, 0.25).y``.
    """

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, *parameters: object) -> Handle:
        """A point of the curve or surface."""
        return Handle(f"{self.name}({', '.join(_spelled(p) for p in parameters)})")

    def __getattr__(self, member: str) -> Expr:
        if member.startswith("_"):
            raise AttributeError(member)
        return Expr(f"{self.name}.{member}")

    def __repr__(self) -> str:
        return f"<Handle: {self.name}>"


class Shape:
    """A field or set of a model, as an expression of the language.

    Fields combine by ``+ - * /`` and ``**``, sets by ``|``, ``&``, ``-``, ``^``, and ``-`` is the
    complement. Functions such as ``sphere`` and ``set`` come from :mod:`moldloft.functions`.
    """

    __array_ufunc__ = None

    def __init__(self, text: str, rank: int = _ATOM) -> None:
        self.text = text
        self._rank = rank

    def _in(self) -> str:
        return self.text if self._rank == _ATOM else f"({self.text})"

    def _binary(self, other: object, sign: str, *, swap: bool = False) -> Any:
        if isinstance(other, Shape):
            right = other._in()
        elif isinstance(other, Handle):
            right = other.name
        else:
            number = _expr(other)
            if number is None:
                return NotImplemented
            right = number._in(_ATOM)
        a, b = (right, self._in()) if swap else (self._in(), right)
        return Shape(f"{a} {sign} {b}", _SUM)

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

    def __neg__(self) -> Shape:
        return Shape(f"-{self._in()}", _SIGN)

    def __abs__(self) -> Shape:
        return Shape(f"abs({self.text})")

    def __call__(self, point: object) -> Expr:
        """The value at a point."""
        return Expr(f"{self._in()}({_spelled(point)})")

    def __repr__(self) -> str:
        return f"Shape({self.text!r})"


class Function:
    """A function of the language: calling it gives an expression of a model that is being built."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, *args: object, **named: object) -> Shape:
        """The call; the arguments are those of the language."""
        words = [_spelled(a) for a in args]
        words += [f"{key} = {_spelled(value)}" for key, value in named.items()]
        return Shape(f"{self.name}({', '.join(words)})")

    def __repr__(self) -> str:
        return f"<Function: {self.name}>"


class Kind:
    """A kind of entity: calling it declares an object in the model that is being built.

    ``Kind(name, *data, **named)`` takes the same arguments as the language.
    """

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, name: str, *args: object, **named: object) -> Handle:
        """Declare an object of this kind; the arguments are those of the language."""
        return Builder.current().declare(self.name, name, args, named)

    def __repr__(self) -> str:
        return f"<Kind: {self.name}>"


class Builder:
    """Collects declarations as the text of a program.

    Examples
    --------
    >>> from moldloft import kinds as k
    >>> from moldloft.builder import Builder
    >>> with Builder() as b:
    ...     beam = b.param("beam", 5, 3, 7)
    ...     ends = [k.AbsPoint("A", 0, 0, 0), k.AbsPoint("B", 10, beam / 2, 0)]
    ...     keel = k.Line("keel", *ends)
    >>> print(b.text, end="")
    param float beam = 5 in [3, 7];
    AbsPoint A(0, 0, 0);
    AbsPoint B(10, beam / 2, 0);
    Line keel(A, B);
    >>> b.model()["keel"](0.5)
    array([5.  , 1.25, 0.  ])
    """

    _current: ContextVar[Builder | None] = ContextVar("builder", default=None)

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._tokens: list[Any] = []

    @classmethod
    def current(cls) -> Builder:
        """The builder whose ``with`` block or model function is running."""
        builder = cls._current.get()
        if builder is None:
            raise RuntimeError(
                "objects are declared inside a function decorated with @moldloft.model, or in a "
                "`with Builder() as b:` block"
            )
        return builder

    def __enter__(self) -> Builder:
        self._tokens.append(self._current.set(self))
        return self

    def __exit__(self, *_: object) -> None:
        self._current.reset(self._tokens.pop())

    @property
    def text(self) -> str:
        """The program so far."""
        return "".join(line + "\n" for line in self._lines)

    def declare(
        self, kind: str, name: str, args: Sequence[object], named: Mapping[str, object]
    ) -> Handle:
        """Declare an object; the arguments are those of the language."""
        _check_name(name)
        words = [_spelled(a) for a in args]
        words += [f"{key} = {_spelled(value)}" for key, value in named.items()]
        self._lines.append(f"{kind} {name}({', '.join(words)});")
        return Handle(name)

    def field(self, name: str, value: Shape | float) -> Shape:
        """Declare a field: an implicit function under a name.

        >>> from moldloft import functions as f, kinds as k
        >>> from moldloft.builder import Builder
        >>> with Builder() as b:
        ...     r = b.param("r", 1, 0.5, 2)
        ...     ball = b.field("ball", f.sphere([0, 0, 0], r))
        ...     half = b.set("half", f.set(ball) & f.set(f.plane([0, 0, 1], [0, 0, 0])))
        ...     body = k.SetBody("body", half, depth=4)
        >>> print(b.text, end="")
        param float r = 1 in [0.5, 2];
        field ball = sphere({0, 0, 0}, r);
        set half = set(ball) & set(plane({0, 0, 1}, {0, 0, 0}));
        SetBody body(half, depth = 4);
        >>> round(b.model().eval("volume(half)"), 3)
        2.094
        """
        return self._implicit("field", name, value)

    def set(self, name: str, value: Shape) -> Shape:
        """Declare a set: the solid sides of fields, combined, under a name; see :meth:`field`."""
        return self._implicit("set", name, value)

    def _implicit(self, word: str, name: str, value: Shape | float) -> Shape:
        _check_name(name)
        self._lines.append(f"{word} {name} = {_spelled(value)};")
        return Shape(name)

    def param(
        self,
        name: str,
        default: float,
        low: float | None = None,
        high: float | None = None,
        *,
        whole: bool = False,
        value: float | None = None,
    ) -> Expr:
        """Declare a design parameter; ``value`` is its value in this run."""
        _check_name(name)
        text = f"param {'int' if whole else 'float'} {name} = {_literal(float(default))}"
        if low is not None and high is not None:
            text += f" in [{_literal(float(low))}, {_literal(float(high))}]"
        self._lines.append(text + ";")
        return Expr(name, float(default if value is None else value))

    def model(self) -> Model:
        """The model of what was declared."""
        from moldloft.models import loads

        return loads(self.text, name="model.py.sdl")


def _check_name(name: str) -> None:
    if not _NAME.match(name):
        raise ValueError(
            f"{name!r} is not a valid name: expected a letter, then letters, digits and _"
        )


@dataclass(frozen=True)
class Range:
    """A parameter's default and range; made by :func:`param`."""

    default: float
    """The value when none is given."""
    low: float | None = None
    """The least value."""
    high: float | None = None
    """The greatest value."""
    whole: bool = False
    """True for whole numbers only."""


def param(
    default: float, low: float | None = None, high: float | None = None, *, whole: bool = False
) -> Any:
    """A default of a model function's argument with the range that it may take."""
    if (low is None) != (high is None):
        raise ValueError("give both ends of the range, or none")
    return Range(float(default), low, high, whole)


class ModelFunction:
    """A function of design parameters that declares objects; made by :func:`model`."""

    def __init__(self, function: Callable[..., object]) -> None:
        self._function = function
        self._params: dict[str, Range] = {}
        for name, parameter in inspect.signature(function).parameters.items():
            default = parameter.default
            if isinstance(default, Range):
                self._params[name] = default
            elif isinstance(default, (int, float)) and not isinstance(default, bool):
                whole = parameter.annotation in (int, "int")
                self._params[name] = Range(float(default), whole=whole)
            else:
                raise TypeError(
                    f"the argument `{name}` of {function.__name__} needs a number, or "
                    "moldloft.param(default, low, high), as its default"
                )
        update_wrapper(self, function)

    def __call__(self, **values: float) -> Model:
        """The model for these values of the parameters; the others have their defaults."""
        return _PythonModel(self, self._checked(values))

    def _checked(self, values: Mapping[str, float]) -> dict[str, float]:
        for name in values:
            if name not in self._params:
                known = ", ".join(self._params)
                raise TypeError(f"unknown parameter `{name}`; expected one of: {known}")
        return {name: float(value) for name, value in values.items()}

    def text(self, values: Mapping[str, float]) -> str:
        """The program that the function writes for these values."""
        with Builder() as builder:
            args = {
                name: builder.param(
                    name, p.default, p.low, p.high, whole=p.whole, value=values.get(name)
                )
                for name, p in self._params.items()
            }
            self._function(**args)
        return builder.text

    @property
    def names(self) -> list[str]:
        """The names of the parameters."""
        return list(self._params)


def model(function: Callable[..., object]) -> ModelFunction:
    """Make a model of a function whose arguments are design parameters.

    Examples
    --------
    >>> import moldloft
    >>> from moldloft import kinds as k
    >>> @moldloft.model
    ... def plate(length=moldloft.param(4, 1, 9), breadth: float = 2):
    ...     a = k.Line("a", k.AbsPoint("A", 0, 0, 0), k.AbsPoint("B", length, 0, 0))
    ...     b = k.Line("b", k.AbsPoint("C", 0, breadth, 0), k.AbsPoint("D", length, breadth, 0))
    ...     k.RuledSurf("S", a, b, divisions=[2, 2])
    >>> m = plate(length=3)
    >>> m.eval("S.area"), m.derivative("S.area", "breadth")
    (6.0, 3.0)
    >>> m["breadth"] = 5
    >>> m.eval("S.area")
    15.0
    """
    return ModelFunction(function)


class _PythonModel(Model):
    """A model whose text is written again by its function when a parameter changes."""

    def __init__(self, function: ModelFunction, values: dict[str, float]) -> None:
        self._source = function
        self._values = values
        text = function.text(values)
        super().__init__(_core.Document.from_text(f"{function.__name__}.sdl", text, None, []))  # type: ignore[attr-defined]
        if values:
            self._document.set(list(values.items()))
        self.check()

    def __setitem__(self, name: str, value: float) -> None:
        self.set({name: value})

    def set(self, values: Mapping[str, float]) -> None:
        """Change several numbers at once; see :meth:`Model.set`."""
        numbers = {name: float(value) for name, value in values.items()}
        new = {**self._values, **{k: v for k, v in numbers.items() if k in self._source.names}}
        with self._text_for(new):
            self._document.set(list(numbers.items()))
            self._values = new

    @contextlib.contextmanager
    def _text_for(self, values: Mapping[str, float]) -> Iterator[None]:
        old, new = self._document.text(), self._source.text(values)
        changed = new != self._source.text(self._values)
        if changed:
            self._document.set_text(new)
        try:
            yield
        except BaseException:
            if changed:
                self._document.set_text(old)
            raise
