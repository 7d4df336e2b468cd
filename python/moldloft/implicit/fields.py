"""Implicit functions, and the primitives that they consist of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.implicit.moving import Moving, box_of, triple

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Triple = Sequence[float]

__all__ = ["Field"]


def points_of(points: ArrayLike) -> tuple[Floats, tuple[int, ...]]:
    """Points as a contiguous array (n, 3), and the shape without the last extent."""
    array = np.asarray(points, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"points have the shape (…, 3), found {array.shape}")
    return np.ascontiguousarray(array.reshape(-1, 3)), array.shape[:-1]


class Field(Moving):
    """An implicit function f(x, y, z): solid where negative, zero on the surface, air elsewhere.

    Fields are combined by ``+ - * / %`` with fields and numbers, ``**`` a whole number and the
    functions of this module; :func:`abs` gives a sheet. They never change.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> x, y, z = im.axes()
    >>> pipe = y**2 + z**2 - 4
    >>> pipe((7, 1, 1))
    -2.0
    >>> pipe([[0, 2, 0], [0, 0, 3]])
    array([0., 5.])
    >>> pipe.gradient((7, 1, 1)), pipe.degree
    (array([0., 2., 2.]), 2)
    """

    __array_ufunc__ = None
    __slots__ = ("_core",)

    def __init__(self, core: _core.Field) -> None:
        self._core = core

    def __call__(self, points: ArrayLike) -> Any:
        """The values at points ``(…, 3)``, an array ``(…)``; a float for one point."""
        flat, shape = points_of(points)
        values = self._core.values(flat).reshape(shape)
        return values if shape else float(values)

    def gradient(self, points: ArrayLike) -> Floats:
        """The exact gradients at points ``(…, 3)``, of the same shape.

        Parameters
        ----------
        points
            Points ``(…, 3)``.

        Returns
        -------
        numpy.ndarray
            Shape of the points; along x, y and z.

        Raises
        ------
        ArgumentError
            If the points have another shape.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> im.sphere((0, 0, 0), 1).gradient((1, 2, 3))
        array([2., 4., 6.])
        """
        flat, shape = points_of(points)
        return self._core.gradients(flat)[1].reshape(*shape, 3)

    def hessian(self, points: ArrayLike) -> Floats:
        """The exact matrices of second derivatives at points ``(…, 3)``, ``(…, 3, 3)``.

        Parameters
        ----------
        points
            Points ``(…, 3)``.

        Returns
        -------
        numpy.ndarray
            Shape ``(…, 3, 3)``, symmetric.

        Raises
        ------
        ArgumentError
            If the points have another shape.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> im.sphere((0, 0, 0), 1).hessian((1, 2, 3)).diagonal().tolist()
        [2.0, 2.0, 2.0]
        """
        flat, shape = points_of(points)
        return self._core.hessians(flat).reshape(*shape, 3, 3)

    def range(self, low: Triple, high: Triple) -> tuple[float, float]:
        """Proved bounds of the values over a box, rounded outward.

        Parameters
        ----------
        low
            The low corner of a box, ``(3,)``.
        high
            The high corner of a box, ``(3,)``.

        Returns
        -------
        tuple of float
            A lower and an upper bound of all values.

        Raises
        ------
        ArgumentError
            If the low corner is not below the high one, or a coordinate is not finite.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> low, high = im.sphere((0, 0, 0), 1).range((-1, -1, -1), (1, 1, 1))
        >>> bool(low <= -1 and high >= 2)
        True
        """
        return self._core.range(*box_of(low, high))

    @property
    def degree(self) -> int:
        """Degree as a polynomial.

        Numbers 0, planes 1, sums the maximum, products the sum, functions one more, external
        functions 100.
        """
        return self._core.degree

    @property
    def form(self) -> dict[str, Any]:
        """Type of the primitive with its dimensions.

        >>> from moldloft import implicit as im
        >>> im.sphere((1, 0, 0), 2).form
        {'kind': 'sphere', 'centre': [1.0, 0.0, 0.0], 'radius': 2.0}
        """
        return self._core.form()

    @property
    def is_sheet(self) -> bool:
        """True for the absolute value of a field: a surface without a solid side."""
        return self._core.is_sheet

    def same(self, other: Field) -> bool:
        """True when both are the same expression of the same numbers.

        Parameters
        ----------
        other
            The other field.

        Returns
        -------
        bool
            Two that are written differently, as ``x + y`` and ``y + x``, are not the same.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> im.sphere((0, 0, 0), 1).same(im.sphere((0, 0, 0), 1))
        True
        """
        return self._core.same(other._core)

    def mapped(self, matrix: ArrayLike, shift: Triple = (0, 0, 0)) -> Field:
        """The field moved by the affine map X -> matrix X + shift.

        Parameters
        ----------
        matrix
            Matrix ``(3, 3)``.
        shift
            Translation after the matrix, ``(3,)``.

        Returns
        -------
        Field
            A new one; this stays as it is.

        Raises
        ------
        Error
            If the matrix is singular.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> im.sphere((0, 0, 0), 1).mapped([[4, 0, 0], [0, 1, 0], [0, 0, 1]])((3, 0, 0)) < 0
        True
        """
        rows = np.asarray(matrix, dtype=np.float64)
        if rows.shape != (3, 3):
            raise ValueError(f"the matrix has the shape (3, 3), found {rows.shape}")
        return Field(self._core.mapped(rows.tolist(), triple(shift, "shift")))

    def remapped(self, x: Field, y: Field, z: Field) -> Field:
        """The field with its coordinates replaced: ``f(x, y, z)`` of three fields.

        Parameters
        ----------
        x
            The first field.
        y
            The second field.
        z
            The third field.

        Returns
        -------
        Field
            A new one; this stays as it is.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> x, y, z = im.axes()
        >>> im.sphere((0, 0, 0), 1).remapped(x, y, 2 * z)((0, 0, 0.5))
        0.0
        """
        return Field(self._core.remapped(x._core, y._core, z._core))

    def dumps(self) -> str:
        """The field as text, from which :func:`loads` makes the same one, bit for bit.

        Returns
        -------
        str
            One line a value.

        Raises
        ------
        Error
            If a part is a function from outside, which has no text.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.sphere((0, 0, 0), 1)
        >>> im.loads(im.Set(ball).dumps()).member((0, 0, 0))
        -1
        """
        return self._core.to_text()

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_text, (self.dumps(),)

    def __deepcopy__(self, memo: object) -> Field:
        return self

    def _with(self, other: object, name: str, *, swap: bool = False) -> Any:
        o = _field(other)
        if o is None:
            return NotImplemented
        a, b = (o, self) if swap else (self, o)
        return Field(a._core.binary(name, b._core))

    def __add__(self, other: object) -> Any:
        return self._with(other, "+")

    def __radd__(self, other: object) -> Any:
        return self._with(other, "+", swap=True)

    def __sub__(self, other: object) -> Any:
        return self._with(other, "-")

    def __rsub__(self, other: object) -> Any:
        return self._with(other, "-", swap=True)

    def __mul__(self, other: object) -> Any:
        return self._with(other, "*")

    def __rmul__(self, other: object) -> Any:
        return self._with(other, "*")

    def __truediv__(self, other: object) -> Any:
        return self._with(other, "/")

    def __rtruediv__(self, other: object) -> Any:
        return self._with(other, "/", swap=True)

    def __mod__(self, other: object) -> Any:
        return self._with(other, "%")

    def __pow__(self, exponent: float) -> Field:
        return Field(self._core.power(float(exponent)))

    def __neg__(self) -> Field:
        return Field(self._core.unary("-"))

    def __pos__(self) -> Field:
        return self

    def __abs__(self) -> Field:
        return Field(self._core.unary("abs"))

    def __repr__(self) -> str:
        kind = self._core.form()["kind"]
        word = "field" if kind == "field" else f"{kind} field"
        return f"<{word} of degree {self.degree}>"


def _field(x: object) -> Field | None:
    if isinstance(x, Field):
        return x
    if isinstance(x, bool) or not hasattr(x, "__float__"):
        return None
    return Field(_core.Field.real(float(x)))


def required(x: object) -> Field:
    """A field, or a number as a constant one."""
    field = _field(x)
    if field is None:
        raise TypeError(f"expected a field or a number, found {type(x).__name__}")
    return field


def axes() -> tuple[Field, Field, Field]:
    """The coordinates x, y and z as fields.

    Returns
    -------
    tuple of Field
        Three coordinates, in model units.
    """
    x, y, z = (
        Field(_core.call_row("plane", [normal, (0, 0, 0)]))
        for normal in ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    )
    return x, y, z


def function(
    value: Callable[[Floats], Floats],
    *,
    gradient: Callable[[Floats], Floats] | None = None,
    range: Callable[[tuple[float, ...], tuple[float, ...]], tuple[float, float]] | None = None,
    lipschitz: float | None = None,
) -> Field:
    """A field that is a Python function.

    Parameters
    ----------
    value
        Takes points ``(n, 3)`` and returns their values ``(n,)``.
    gradient
        Takes points ``(n, 3)`` and returns gradients ``(n, 3)``; without it differences are taken.
    range
        Takes the low and high corner of a box and returns numbers below and above all values in it.
        Wide ones cost time, wrong ones correctness.
    lipschitz
        Lipschitz constant, instead of a range: values differ by at most this times the distance of
        their points. Without either, boxes have no bounds, and every box of the division is
        evaluated.

    An exception of the function, or a result of the wrong shape, becomes a :class:`moldloft.Error`.

    Returns
    -------
    Field
        It calls the function wherever it is evaluated.

    Examples
    --------
    >>> import numpy as np
    >>> from moldloft import implicit as im
    >>> wave = im.function(lambda p: p[:, 2] - 0.2 * np.sin(p[:, 0]), lipschitz=1.02)
    >>> sea = im.Set(wave) & im.cuboid((-2, -2, -1), (2, 2, 1))
    >>> round(sea.mass(depth=4).volume, 2)
    16.0
    """
    if lipschitz is not None and not (np.isfinite(lipschitz) and lipschitz >= 0):
        raise ValueError(f"a Lipschitz constant is a finite number from 0, found {lipschitz}")
    return Field(_core.Field.user(value, gradient, range, lipschitz))


def _from_text(text: str) -> Field:
    return Field(_core.Field.from_text(text, "moldloft"))


def read_fidget(text: str) -> Field:
    r"""The field of a text of fidget: a line ``name operation operands`` for each value.

    Parameters
    ----------
    text
        The text.

    Returns
    -------
    Field
        The expression, operation by operation.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> im.read_fidget("_0 var-x\n_1 square _0")((3, 0, 0))
    9.0
    """
    return Field(_core.Field.from_text(text, "fidget"))


def read_libfive(text: str) -> Field:
    """The field of a text of libfive: nested lists.

    Parameters
    ----------
    text
        The text.

    Returns
    -------
    Field
        The expression, operation by operation.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> im.read_libfive("(- (sqrt (+ (square x) (square y))) 1)")((3, 4, 0))
    4.0
    """
    return Field(_core.Field.from_text(text, "libfive"))


def _unary(name: str, x: Field) -> Field:
    return Field(required(x)._core.unary(name))


def sin(x: Field) -> Field:
    """The sine, of radians.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        Values from -1 to 1.
    """
    return _unary("sin", x)


def cos(x: Field) -> Field:
    """The cosine, of radians.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        Values from -1 to 1.
    """
    return _unary("cos", x)


def exp(x: Field) -> Field:
    """The exponential.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        Values above 0.
    """
    return _unary("exp", x)


def ln(x: Field) -> Field:
    """The natural logarithm; it has no value where the field is not above zero.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        The logarithm to the base e.
    """
    return _unary("ln", x)


def tan(x: Field) -> Field:
    """The tangent, of radians.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        Any value.
    """
    return _unary("tan", x)


def twist(rate: float) -> tuple[Field, Field, Field]:
    """The coordinates of a twist about the z axis, by ``rate`` radians for each unit of z.

    Parameters
    ----------
    rate
        Turn per length along z, radians.

    Returns
    -------
    tuple of Field
        Three coordinates, for :meth:`Field.remapped`.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> drill = im.cuboid((-1, -0.3, 0), (1, 0.3, 4)).remapped(*im.twist(0.8))
    """
    x, y, z = axes()
    c, s = cos(z * float(rate)), sin(z * float(rate))
    return x * c + y * s, y * c - x * s, z


def sqrt(x: Field) -> Field:
    """The square root; zero where the field is negative.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        Values of 0 and above.
    """
    return _unary("sqrt", x)


def s_sqrt(x: Field) -> Field:
    """sgn(f) sqrt|f|. This is not a distance: its slope on the surface has no bound.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        Signed square root: with the sign of the field.
    """
    return _unary("s_sqrt", x)


def sign(x: Field) -> Field:
    """1 where the field is positive, else -1.

    Parameters
    ----------
    x
        The argument.

    Returns
    -------
    Field
        1 and -1.
    """
    return _unary("sign", x)


def minimum(a: Field | float, b: Field | float) -> Field:
    """The smaller of two.

    Parameters
    ----------
    a
        The first field.
    b
        The second field.

    Returns
    -------
    Field
        Solid where one is.
    """
    return Field(required(a)._core.binary("min", required(b)._core))


def maximum(a: Field | float, b: Field | float) -> Field:
    """The larger of two.

    Parameters
    ----------
    a
        The first field.
    b
        The second field.

    Returns
    -------
    Field
        Solid where both are.
    """
    return Field(required(a)._core.binary("max", required(b)._core))


def atan2(y: Field | float, x: Field | float) -> Field:
    """The angle of the point (x, y), in (-pi, pi].

    Parameters
    ----------
    y
        The second argument.
    x
        The argument.

    Returns
    -------
    Field
        In radians.
    """
    return Field(required(y)._core.binary("atan2", required(x)._core))


explain(globals())
