"""Models written in Python: functions whose calls declare objects.

A model function is recorded as a program of the language, with its parameters and their arithmetic.
A model made in Python is therefore equivalent to a text: only changed objects are evaluated again,
and derivatives are exact.
"""

from __future__ import annotations

import contextlib
import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from functools import update_wrapper
from typing import Any, Generic, ParamSpec

from moldloft import _core
from moldloft.arguments import ArgumentError, explain
from moldloft.errors import Error
from moldloft.expressions import (
    Expr,
    FieldShape,
    Handle,
    SetShape,
    Shape,
    arguments,
    literal,
    object_named,
    result,
    spelled,
)
from moldloft.language import entry, page, signature
from moldloft.loading import Origin
from moldloft.models import Model
from moldloft.spelling import nearest

__all__ = [
    "Builder",
    "Expr",
    "Function",
    "Handle",
    "Kind",
    "ModelFunction",
    "Range",
    "Shape",
    "model",
    "param",
]

P = ParamSpec("P")

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")


class Function:
    """A function of the language: calling it gives an expression of the model being built."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.__doc__ = page(entry(name))
        self.__signature__ = signature(entry(name))

    def __call__(self, *args: object, **named: object) -> Any:
        """The call; the arguments are those of the language."""
        _check_names(self, named)
        return result(entry(self.name)["class"], f"{self.name}({arguments(args, named)})")

    def __repr__(self) -> str:
        return f"<Function: {self.name}>"


class Kind:
    """A kind of entity: calling it declares an object in the model being built.

    ``Kind(name, *data, **named)`` takes the same arguments as the language.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.__doc__ = page(entry(name))
        self.__signature__ = signature(entry(name))

    def __call__(self, name: str, /, *args: object, **named: object) -> Any:
        """Declare an object of this kind; the arguments are those of the language."""
        _check_names(self, named)
        return Builder.current().declare(self.name, name, args, named)

    def __repr__(self) -> str:
        return f"<Kind: {self.name}>"


def _check_names(thing: Function | Kind, named: Mapping[str, object]) -> None:
    """Rejects unknown arguments of a kind or function, at the calling line."""
    known = thing.__signature__.parameters
    for name in named:
        # The language takes the words of Python without the underscore.
        if name in known or f"{name}_" in known or name.removesuffix("_") in known:
            continue
        if any(p.kind is p.VAR_KEYWORD for p in known.values()):
            continue
        near = nearest(name, known)
        hint = f"; did you mean `{near}`?" if near else f"; expected {', '.join(known)}"
        raise ArgumentError(f"{thing.name} has no argument `{name}`{hint}", name)


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
        """The builder whose ``with`` block or model function is running.

        Returns
        -------
        Builder
            The innermost.

        Raises
        ------
        Error
            If no model function is running.
        """
        builder = cls._current.get()
        if builder is None:
            raise Error(
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
        """Declare an object; the arguments are those of the language.

        Parameters
        ----------
        kind
            The name of a kind.
        name
            The name of the object.
        args
            The arguments by position.
        named
            The arguments by name.

        Returns
        -------
        Handle
            Objects that later statements refer to.

        Raises
        ------
        ArgumentError
            If the name is not one of the language.

        Examples
        --------
        >>> from moldloft.builder import Builder
        >>> b = Builder()
        >>> _ = b.declare("AbsPoint", "P", (1, 2, 3), {})
        >>> b.model()["P"].y
        2.0
        """
        _check_name(name)
        self._lines.append(f"{kind} {name}({arguments(args, named)});")
        try:
            class_ = entry(kind)["class"]
        except KeyError:
            class_ = ""
        return object_named(class_, name)

    def field(self, name: str, value: Shape | Handle | float) -> FieldShape:
        """Declare a field: an implicit function under a name.

        Parameters
        ----------
        name
            The name of the field.
        value
            The field.

        Returns
        -------
        FieldShape
            Primitives of sets.

        Raises
        ------
        ArgumentError
            If the name is not one of the language.

        Examples
        --------
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
        self._implicit("field", name, value)
        return FieldShape(name)

    def set(self, name: str, value: Shape | Handle) -> SetShape:
        """Declare a set: the solid sides of fields, combined, under a name; see :meth:`field`.

        Parameters
        ----------
        name
            The name of the set.
        value
            The set.

        Returns
        -------
        SetShape
            Sets of bodies.

        Raises
        ------
        ArgumentError
            If the name is not one of the language.

        Examples
        --------
        >>> from moldloft import functions as f
        >>> from moldloft.builder import Builder
        >>> with Builder() as b:
        ...     ball = b.set("ball", f.set(f.sphere([0, 0, 0], 1)))
        >>> print(b.text, end="")
        set ball = set(sphere({0, 0, 0}, 1));
        """
        self._implicit("set", name, value)
        return SetShape(name)

    def _implicit(self, word: str, name: str, value: object) -> None:
        _check_name(name)
        self._lines.append(f"{word} {name} = {spelled(value)};")

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
        """Declare a design parameter; ``value`` is its value in this run.

        Parameters
        ----------
        name
            The name of the parameter.
        default
            Default value.
        low
            The least value.
        high
            The greatest value.
        whole
            Whole numbers only.
        value
            Its value in this run.

        Returns
        -------
        Expr
            A number for arithmetic, which stays an expression in the text.

        Raises
        ------
        ArgumentError
            If the name is not one of the language, or the default out of the range.

        Examples
        --------
        >>> from moldloft.builder import Builder
        >>> b = Builder()
        >>> half = b.param("beam", 4, 3, 5) / 2
        >>> half, half.value
        (Expr('beam / 2'), 2.0)
        """
        _check_name(name)
        _check_range(name, float(default), low, high)
        text = f"param {'int' if whole else 'float'} {name} = {literal(float(default))}"
        if low is not None and high is not None:
            text += f" in [{literal(float(low))}, {literal(float(high))}]"
        self._lines.append(text + ";")
        return Expr(name, float(default if value is None else value))

    def model(self) -> Model:
        """The model of the declared objects.

        Returns
        -------
        Model
            It has been run.

        Raises
        ------
        ModelError
            If it has an error; positions refer to :attr:`text`.

        Examples
        --------
        >>> from moldloft.builder import Builder
        >>> b = Builder()
        >>> _ = b.param("beam", 4, 3, 5)
        >>> b.model()["beam"]
        4.0
        """
        from moldloft.loading import loads

        return loads(self.text, name="model.py.sdl")


def _check_name(name: str) -> None:
    if not _NAME.match(name):
        raise ValueError(
            f"{name!r} is not a valid name: expected a letter, then letters, digits and _"
        )


def _check_range(name: str, default: float, low: float | None, high: float | None) -> None:
    if low is not None and high is not None and not low <= default <= high:
        raise ValueError(f"`{name}` = {default:g} is not in its range {low:g} .. {high:g}")


@dataclass(frozen=True)
class Range:
    """A parameter's default and range; made by :func:`param`."""

    default: float
    """Default value."""
    low: float | None = None
    """The least value."""
    high: float | None = None
    """The greatest value."""
    whole: bool = False
    """True for integers."""


def param(
    default: float, low: float | None = None, high: float | None = None, *, whole: bool = False
) -> Any:
    """Default and range of an argument of a model function.

    Parameters
    ----------
    default
        Default value.
    low
        The least value.
    high
        The greatest value.
    whole
        Whole numbers only.

    Returns
    -------
    Range
        To be the default of an argument.

    Raises
    ------
    ValueError
        If one end of the range is missing, or the default out of it.

    Examples
    --------
    >>> param(4, 3, 5)
    Range(default=4.0, low=3, high=5, whole=False)
    """
    if (low is None) != (high is None):
        raise ValueError("give both ends of the range, or none")
    _check_range("default", float(default), low, high)
    return Range(float(default), low, high, whole)


class ModelFunction(Generic[P]):
    """A function of design parameters that declares objects; made by :func:`model`."""

    def __init__(self, function: Callable[P, object]) -> None:
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

    def __call__(self, *args: P.args, **values: P.kwargs) -> Model:
        """The model for these values of the parameters; the others have their defaults."""
        given: dict[str, Any] = dict(values)
        if len(args) > len(self._params):
            raise TypeError(
                f"{self._function.__name__} has {len(self._params)} parameters; "
                f"{len(args)} were given"
            )
        for name, value in zip(self._params, args, strict=False):
            if name in given:
                raise TypeError(f"the parameter `{name}` was given twice")
            given[name] = value
        return _PythonModel(self, self._checked(given))

    def _checked(self, values: Mapping[str, float]) -> dict[str, float]:
        for name in values:
            if name not in self._params:
                near = nearest(name, self._params)
                known = ", ".join(self._params)
                hint = f"did you mean `{near}`?" if near else f"expected one of: {known}"
                raise TypeError(f"unknown parameter `{name}`; {hint}")
        return {name: float(value) for name, value in values.items()}

    def text(self, values: Mapping[str, float]) -> str:
        """The program that the function generates for these values.

        Parameters
        ----------
        values
            Values of the parameters by name.
        """
        with Builder() as builder:
            args = {
                name: builder.param(
                    name, p.default, p.low, p.high, whole=p.whole, value=values.get(name)
                )
                for name, p in self._params.items()
            }
            function: Callable[..., object] = self._function
            function(**args)
        return builder.text

    @property
    def names(self) -> list[str]:
        """The names of the parameters."""
        return list(self._params)


def model(function: Callable[P, object]) -> ModelFunction[P]:
    """Turn a function of design parameters into a model.

    Parameters
    ----------
    function
        The function; its defaults come from :func:`param` or are numbers.

    Returns
    -------
    ModelFunction
        Called with values of its parameters it returns a :class:`Model`.

    Raises
    ------
    TypeError
        If an argument has no number as its default.

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
    >>> round(m.eval("S.area"), 9), round(m.derivative("S.area", "breadth"), 9)
    (6.0, 3.0)
    >>> m["breadth"] = 5
    >>> round(m.eval("S.area"), 9)
    15.0
    """
    return ModelFunction(function)


class _PythonModel(Model):
    """A model whose function rewrites its text when a parameter changes."""

    def __init__(self, function: ModelFunction[Any], values: dict[str, float]) -> None:
        self._source = function
        self._values = values
        text = function.text(values)
        name = f"{function.__name__}.sdl"  # type: ignore[attr-defined]
        super().__init__(_core.Document.from_text(name, text, None, []), Origin(name))
        if values:
            self._document.set(list(values.items()))
        self.check()

    def _state(self) -> tuple[Any, ...]:
        # The function itself may be nowhere to be imported: a copy is the program that it wrote.
        changed = {p.name: p.value for p in self.params.values() if p.value != p.default}
        return self._origin, self.text, changed, self._refined

    def copy(self) -> Model:
        """An independent model with the same parameters, still generated by its function."""
        return _PythonModel(self._source, dict(self._values))

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


explain(globals())
