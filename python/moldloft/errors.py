"""Exceptions of Moldloft: a base class and the built-in classes that each one also derives from."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moldloft._core import Diagnostic

__all__ = [
    "Error",
    "FairingError",
    "FileError",
    "FormatError",
    "MissingPackageError",
    "ModelError",
    "UnknownNameError",
]


class Error(Exception):
    """Base class of errors due to a model, a file or an argument.

    Parameters
    ----------
    message
        Text to print: the rendered diagnostics, if there are any.
    diagnostics
        The same facts as data.

    Attributes
    ----------
    diagnostics : tuple of Diagnostic
        Each with id, severity, message, places, help. Empty for an error outside a model, such as a
        full disk.

    Examples
    --------
    >>> import moldloft
    >>> try:
    ...     moldloft.loads("AbsPoint P(1, 2, 3);").eval("Q.x")
    ... except moldloft.Error as error:
    ...     print(error.diagnostics[0].severity)
    error
    """

    diagnostics: tuple[Diagnostic, ...]

    def __init__(self, message: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        super().__init__(message)
        self.diagnostics = tuple(diagnostics)
        cause = _raised_by_functions(self.diagnostics)
        if cause is not None and not isinstance(cause, Exception):
            # Ctrl-C and sys.exit inside of a model's function are no errors of the model.
            raise cause
        if cause is not None:
            self.__cause__ = cause

    def __str__(self) -> str:
        return str(self.args[0])

    def __reduce__(self) -> tuple[Any, ...]:
        recorded = [
            d if isinstance(d, Recorded) else Recorded(d.to_dict(), str(d))
            for d in self.diagnostics
        ]
        more = {name: value for name, value in vars(self).items() if name != "diagnostics"}
        return _again, (type(self), self.args[0], recorded, more)

    @property
    def rendered(self) -> str:
        """The message for a terminal: diagnostics unchanged, other errors after ``error:``."""
        text = str(self).rstrip()
        return text if self.diagnostics else f"error: {text}"


#: What functions of models raised, by the message of its diagnostic; the latest last.
_raised: dict[str, BaseException] = {}
_MOST_RAISED = 64


def record_raised(function: str, error: BaseException) -> None:
    """Store the exception of a model's Python function for the error that the model raises."""
    _raised.pop(key := f"{function} raised {type(error).__name__}: {error}", None)
    _raised[key] = error
    while len(_raised) > _MOST_RAISED:
        _raised.pop(next(iter(_raised)))


def _raised_by_functions(diagnostics: Sequence[Diagnostic]) -> BaseException | None:
    for diagnostic in diagnostics:
        if getattr(diagnostic, "id", "") == "function-failed":
            text = diagnostic.message
            for key in [key for key in _raised if key in text]:
                return _raised.pop(key)
    return None


class Recorded:
    """A diagnostic that was pickled, with the same attributes."""

    def __init__(self, data: dict[str, Any], text: str) -> None:
        self._data = data
        self._text = text

    def to_dict(self) -> dict[str, Any]:
        """The facts as data."""
        return self._data

    @property
    def is_error(self) -> bool:
        """True for an error."""
        return self._data.get("severity") == "error"

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._data:
            raise AttributeError(name)
        value = self._data[name]
        if isinstance(value, dict):
            return SimpleNamespace(**value)
        if name == "secondary":
            return [SimpleNamespace(**label) for label in value]
        return value

    def __str__(self) -> str:
        return self._text


def _again(made: type[Error], message: str, recorded: list[Any], more: dict[str, Any]) -> Error:
    error = made.__new__(made)
    Error.__init__(error, message, recorded)
    vars(error).update(more)
    return error


class ModelError(Error, ValueError):
    """The model, an expression or a value is invalid; see ``diagnostics``."""


class FairingError(Error, ValueError):
    """The data cannot be faired under the given conditions.

    Attributes
    ----------
    index : int or None
        The point that is at fault, counted from 0, where it is one.
    """

    index: int | None

    def __init__(
        self, message: str, diagnostics: Sequence[Diagnostic] = (), index: int | None = None
    ) -> None:
        super().__init__(message, diagnostics)
        self.index = index


class UnknownNameError(Error, KeyError):
    """A name is not that of a parameter or object."""


class FileError(Error, OSError):
    """A file or folder cannot be read or written; no file is left partly written."""

    def __init__(self, message: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        Error.__init__(self, message, diagnostics)


class MissingPackageError(Error, ImportError):
    """A package of an extra is not installed, or another package provides its module."""

    def __init__(self, message: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        Error.__init__(self, message, diagnostics)


class FormatError(Error, ValueError):
    """Invalid content of a file, an unknown format, or a format that cannot represent the model.

    Attributes
    ----------
    format : str
        The format.
    place : str
        Unit of ``number`` for a file: ``line`` and ``block`` from 1, ``byte`` from 0; else empty.
    number : int
        Where.
    expected, found : str
        Expected and found content.
    """

    def __init__(
        self,
        message: str,
        format: str = "",
        place: str = "",
        number: int = 0,
        expected: str = "",
        found: str = "",
        diagnostics: Sequence[Diagnostic] = (),
    ) -> None:
        super().__init__(message, diagnostics)
        self.format = format
        self.place = place
        self.number = number
        self.expected = expected
        self.found = found
