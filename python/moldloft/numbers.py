"""Dual numbers, which carry derivatives through a user's functions.

A Python function in a model is called with plain floats in a plain run, and with :class:`Dual`
numbers for derivatives. Arithmetic and NumPy's elementary functions work on both; conversion of a
dual number to a float would lose the derivative and raises.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

__all__ = ["Dual"]

Number = "float | Dual"


class Dual:
    """A number with its derivatives in a few directions.

    Parameters
    ----------
    value
        The number.
    eps
        Its derivative in each direction.

    Examples
    --------
    >>> from moldloft.numbers import Dual
    >>> import numpy as np
    >>> x = Dual(3.0, (1.0, 0.0))
    >>> y = np.sqrt(x * x + 16)
    >>> y.value, y.eps
    (5.0, (0.6..., 0.0))
    >>> float(y)
    Traceback (most recent call last):
      ...
    TypeError: a number with derivatives cannot become a float: ...
    """

    __slots__ = ("eps", "value")
    # NumPy arrays leave operations with a dual number to the number.
    __array_priority__ = 1000

    def __init__(self, value: float, eps: Sequence[float]) -> None:
        self.value = float(value)
        self.eps = tuple(float(e) for e in eps)

    def _chain(self, value: float, slope: float) -> Dual:
        # A zero direction stays zero where the slope is infinite.
        return Dual(value, [e * slope if e else 0.0 for e in self.eps])

    def _with(
        self, other: object, value: Callable[[float, float], float], a: float, b: float
    ) -> Dual:
        """The value of a function of both, with slopes ``a`` by self and ``b`` by other."""
        if isinstance(other, Dual):
            eps = [a * x + b * y for x, y in zip(self.eps, other.eps, strict=True)]
            return Dual(value(self.value, other.value), eps)
        return self._chain(value(self.value, _plain(other)), a)

    def __add__(self, other: object) -> Any:
        if not _is_number(other):
            return NotImplemented
        return self._with(other, lambda a, b: a + b, 1.0, 1.0)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return self._chain(-self.value, -1.0)

    def __pos__(self) -> Dual:
        return self

    def __sub__(self, other: object) -> Any:
        if not _is_number(other):
            return NotImplemented
        return self._with(other, lambda a, b: a - b, 1.0, -1.0)

    def __rsub__(self, other: object) -> Any:
        return (-self) + other

    def __mul__(self, other: object) -> Any:
        if not _is_number(other):
            return NotImplemented
        return self._with(other, lambda a, b: a * b, _value(other), self.value)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Any:
        if not _is_number(other):
            return NotImplemented
        b = _value(other)
        return self._with(other, lambda a, b: a / b, 1 / b, -self.value / (b * b))

    def __rtruediv__(self, other: object) -> Any:
        if not _is_number(other):
            return NotImplemented
        a = _plain(other)
        return self._chain(a / self.value, -a / (self.value * self.value))

    def __pow__(self, other: object) -> Any:
        if not _is_number(other):
            return NotImplemented
        a, b = self.value, _value(other)
        power = a**b
        slope = b * a ** (b - 1) if b else 0.0
        by_exponent = power * math.log(a) if isinstance(other, Dual) else 0.0
        return self._with(other, lambda _a, _b: power, slope, by_exponent)

    def __rpow__(self, other: object) -> Any:
        if not _is_number(other):
            return NotImplemented
        a = _plain(other)
        power = a**self.value
        return self._chain(power, power * math.log(a))

    def __abs__(self) -> Dual:
        return -self if self.value < 0 else self

    def __float__(self) -> float:
        raise TypeError(
            "a number with derivatives cannot become a float: that would lose the derivatives. "
            "Use NumPy's functions (np.sin, np.sqrt) instead of those of math, and .value where "
            "only the number matters"
        )

    def __bool__(self) -> bool:
        return bool(self.value)

    def __hash__(self) -> int:
        return hash((self.value, self.eps))

    def __eq__(self, other: object) -> bool:
        return _is_number(other) and self.value == _value(other)

    def __lt__(self, other: object) -> bool:
        return self.value < _value(other)

    def __le__(self, other: object) -> bool:
        return self.value <= _value(other)

    def __gt__(self, other: object) -> bool:
        return self.value > _value(other)

    def __ge__(self, other: object) -> bool:
        return self.value >= _value(other)

    def __repr__(self) -> str:
        return f"Dual({self.value!r}, {self.eps!r})"

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        """NumPy's elementary functions, and its arithmetic between arrays and dual numbers."""
        import numpy as np

        if method != "__call__" or kwargs:
            return NotImplemented
        if any(isinstance(x, np.ndarray) and x.ndim for x in inputs):
            arrays = np.broadcast_arrays(*(np.asarray(x, dtype=object) for x in inputs))
            out = np.empty(arrays[0].shape, dtype=object)
            for k in np.ndindex(*out.shape):
                out[k] = ufunc(*(_item(a[k]) for a in arrays))
            return out
        if len(inputs) == 1 and ufunc.__name__ in _FUNCTIONS:
            value, slope = _FUNCTIONS[ufunc.__name__](self.value)
            return self._chain(value, slope)
        operator = _OPERATORS.get(ufunc.__name__)
        if operator is None:
            raise TypeError(f"numpy.{ufunc.__name__} has no derivative here")
        return operator(*(_item(x) for x in inputs))

    # np.sqrt of an object array calls the method of each item.
    def sqrt(self) -> Dual:
        """Square root."""
        return self._function("sqrt")

    def sin(self) -> Dual:
        """Sine."""
        return self._function("sin")

    def cos(self) -> Dual:
        """Cosine."""
        return self._function("cos")

    def tan(self) -> Dual:
        """Tangent."""
        return self._function("tan")

    def exp(self) -> Dual:
        """Exponential."""
        return self._function("exp")

    def log(self) -> Dual:
        """Natural logarithm."""
        return self._function("log")

    def _function(self, name: str) -> Dual:
        value, slope = _FUNCTIONS[name](self.value)
        return self._chain(value, slope)


def _is_number(x: object) -> bool:
    if isinstance(x, (int, float, Dual)):
        return True
    return hasattr(x, "dtype") and getattr(x, "ndim", 1) == 0


def _plain(x: Any) -> float:
    return float(x)


def _value(x: Any) -> float:
    return x.value if isinstance(x, Dual) else float(x)


def _item(x: Any) -> Any:
    return x.item() if hasattr(x, "item") and not isinstance(x, Dual) else x


def _sqrt(x: float) -> tuple[float, float]:
    root = math.sqrt(x)
    return root, 0.5 / root if root else math.inf


_FUNCTIONS: dict[str, Callable[[float], tuple[float, float]]] = {
    "negative": lambda x: (-x, -1.0),
    "positive": lambda x: (x, 1.0),
    "absolute": lambda x: (abs(x), -1.0 if x < 0 else 1.0),
    "square": lambda x: (x * x, 2 * x),
    "reciprocal": lambda x: (1 / x, -1 / (x * x)),
    "sqrt": _sqrt,
    "exp": lambda x: (math.exp(x), math.exp(x)),
    "log": lambda x: (math.log(x), 1 / x),
    "log10": lambda x: (math.log10(x), 1 / (x * math.log(10))),
    "sin": lambda x: (math.sin(x), math.cos(x)),
    "cos": lambda x: (math.cos(x), -math.sin(x)),
    "tan": lambda x: (math.tan(x), 1 + math.tan(x) ** 2),
    "arcsin": lambda x: (math.asin(x), 1 / math.sqrt(1 - x * x)),
    "arccos": lambda x: (math.acos(x), -1 / math.sqrt(1 - x * x)),
    "arctan": lambda x: (math.atan(x), 1 / (1 + x * x)),
    "sinh": lambda x: (math.sinh(x), math.cosh(x)),
    "cosh": lambda x: (math.cosh(x), math.sinh(x)),
    "tanh": lambda x: (math.tanh(x), 1 - math.tanh(x) ** 2),
    "floor": lambda x: (math.floor(x), 0.0),
    "ceil": lambda x: (math.ceil(x), 0.0),
    "sign": lambda x: (float((x > 0) - (x < 0)), 0.0),
    "deg2rad": lambda x: (math.radians(x), math.pi / 180),
    "rad2deg": lambda x: (math.degrees(x), 180 / math.pi),
}


def _arctan2(y: Any, x: Any) -> Any:
    a, b = _value(y), _value(x)
    size = a * a + b * b
    angle = math.atan2(a, b)
    if isinstance(y, Dual):
        return y._with(x, lambda _a, _b: angle, b / size, -a / size)
    return x._chain(angle, -a / size)


_OPERATORS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "power": lambda a, b: a**b,
    "float_power": lambda a, b: a**b,
    "minimum": lambda a, b: b if _value(b) < _value(a) else a,
    "maximum": lambda a, b: b if _value(b) > _value(a) else a,
    "hypot": lambda a, b: (a * a + b * b) ** 0.5,
    "arctan2": _arctan2,
    "less": lambda a, b: _value(a) < _value(b),
    "less_equal": lambda a, b: _value(a) <= _value(b),
    "greater": lambda a, b: _value(a) > _value(b),
    "greater_equal": lambda a, b: _value(a) >= _value(b),
    "equal": lambda a, b: _value(a) == _value(b),
    "not_equal": lambda a, b: _value(a) != _value(b),
}


def _call(
    function: Callable[..., Any], args: Sequence[tuple[list[int] | str, list[list[float]] | None]]
) -> tuple[list[int], list[list[float]]]:
    """Call a user's function with plain or dual arguments.

    An argument is a text, or a shape with its numbers in C order; a number is its value, followed
    by its derivatives if they are requested. The result has the same form.
    """
    import numpy as np

    width = max((len(x) for _, xs in args for x in xs or ()), default=1)

    def number(x: list[float]) -> Any:
        return x[0] if len(x) == 1 else Dual(x[0], x[1:])

    given: list[Any] = []
    for shape, numbers in args:
        if numbers is None:
            given.append(shape)
        elif not shape:
            given.append(number(numbers[0]))
        else:
            array = np.empty(len(numbers), dtype=float if width == 1 else object)
            for k, x in enumerate(numbers):
                array[k] = number(x)
            given.append(array.reshape([int(n) for n in shape]))
    result = function(*given)
    if isinstance(result, Dual):
        return [], [[result.value, *result.eps]]
    array = np.asarray(result, dtype=object)
    parts = []
    for x in array.reshape(-1):
        if isinstance(x, Dual):
            parts.append([x.value, *x.eps])
        elif isinstance(x, (int, float, np.number, np.bool_)):
            parts.append([float(x), *([0.0] * (width - 1))])
        else:
            found = "None" if x is None else f"{type(x).__name__} {x!r}"
            raise TypeError(
                f"the function returned {found}; expected a number, or an array of numbers of "
                "shape (3,), (n,), (n, 3) or (m, n, 3)"
            )
    return list(array.shape), parts
