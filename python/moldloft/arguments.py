"""Errors about wrong arguments, raised as :class:`ArgumentError` with the name of the argument.

Nothing is checked before a call, so that valid calls cost nothing. When a call fails with an error
of Python or NumPy, its arguments are compared with their annotations, and the first mismatch is
named. Without a mismatch the original error propagates.
"""

from __future__ import annotations

import functools
import inspect
import linecache
import operator
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, get_args

from moldloft.errors import Error
from moldloft.spelling import nearest

__all__ = ["ArgumentError", "explain", "names_of"]


class ArgumentError(Error, TypeError, ValueError):
    """An argument has the wrong type for the function.

    Attributes
    ----------
    argument : str
        Its name.
    """

    argument: str

    def __init__(self, message: str, argument: str = "") -> None:
        super().__init__(message)
        self.argument = argument


def names_of(names: Sequence[str] | str) -> list[str]:
    """Names as a list; a text is one name, not its letters.

    >>> names_of("beam"), names_of(("beam", "draft"))
    (['beam'], ['beam', 'draft'])
    """
    return [names] if isinstance(names, str) else list(names)


#: What Python and NumPy raise about values of wrong kinds.
_RAW = (TypeError, ValueError, OverflowError, AttributeError, IndexError, KeyError)

#: Methods of these names are called by people, too.
_SPECIAL = {"__init__", "__call__", "__getitem__", "__setitem__"}

_WORDS = {
    "float": "a number",
    "int": "a whole number",
    "str": "a text",
    "bool": "True or False",
    "None": "None",
    "ArrayLike": "an array of numbers",
    "NDArray[np.float64]": "an array of numbers",
    "Floats": "an array of numbers",
    "Triple": "three numbers",
}


def explain(module: dict[str, Any]) -> None:
    """Make errors of a module's public functions and classes name the invalid argument.

    Parameters
    ----------
    module
        The module's ``globals()``, at its end.
    """
    for name, thing in list(module.items()):
        if getattr(thing, "__module__", "") != module["__name__"]:
            continue
        if name.startswith("_") and not inspect.isclass(thing):
            continue
        if inspect.isfunction(thing):
            module[name] = _explained(thing)
        elif inspect.isclass(thing) and not issubclass(thing, BaseException):
            _explain_class(thing)


def _explain_class(thing: type) -> None:
    for name, member in list(vars(thing).items()):
        if name.startswith("_") and name not in _SPECIAL:
            continue
        if inspect.isfunction(member):
            setattr(thing, name, _explained(member))
        elif isinstance(member, (classmethod, staticmethod)):
            setattr(thing, name, type(member)(_explained(member.__func__)))


def _explained(function: Callable[..., Any]) -> Callable[..., Any]:
    if inspect.isgeneratorfunction(function) or hasattr(function, "__wrapped__"):
        return function

    @functools.wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        try:
            return function(*arguments, **options)
        except Error as error:
            # Arguments that a function passes on are named as its caller knows them.
            if isinstance(error, ArgumentError) and (found := _fault(function, arguments, options)):
                raise ArgumentError(found[1], found[0]) from error
            raise
        except _RAW as error:
            found = _fault(function, arguments, options) or _said(function, error)
            if found is None:
                raise
            name, text = found
            raise ArgumentError(text, name) from error

    return call


def _fault(
    function: Callable[..., Any], arguments: tuple[Any, ...], options: dict[str, Any]
) -> tuple[str, str] | None:
    """The first mismatching argument, and the message about it."""
    signature = inspect.signature(function)
    # Methods that several classes have from a private one are named without it.
    where = re.sub(r"^_\w+\.", "", function.__qualname__.removesuffix(".__init__"))
    try:
        bound = signature.bind(*arguments, **options)
    except (TypeError, ValueError):
        # Too few or too many arguments: Python says so.
        return _misspelt(where, signature, options)
    own = bound.arguments.get("self")
    names = {**function.__globals__, "Self": type(own)} if own is not None else function.__globals__
    for name, value in bound.arguments.items():
        parameter = bound.signature.parameters[name]
        written = parameter.annotation
        if not isinstance(written, str):
            continue
        many = parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)
        values = value.values() if parameter.kind is parameter.VAR_KEYWORD else value
        for one in values if many else [value]:
            if not _fits(one, written, names):
                kinds = [_WORDS.get(kind, kind) for kind in _alternatives(written)]
                expected = " or ".join(dict.fromkeys(kinds))
                return name, f"`{name}` of `{where}`: expected {expected}, found {_shown(one)}"
    return None


def _misspelt(
    where: str, signature: inspect.Signature, options: Mapping[str, Any]
) -> tuple[str, str] | None:
    """An unknown named argument of a function, with the nearest known one."""
    parameters = signature.parameters.values()
    known = [p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    takes_others = any(p.kind is p.VAR_KEYWORD for p in parameters)
    for name in options:
        if name in known:
            continue
        near = nearest(name, (k for k in known if k not in ("self", *options)))
        if near:
            return name, f"`{where}` has no argument `{name}`; did you mean `{near}`?"
        if not takes_others:
            return name, f"`{where}` has no argument `{name}`"
    return None


def _said(function: Callable[..., Any], error: Exception) -> tuple[str, str] | None:
    """Message of a function of this package about its argument, from its own ``raise``."""
    if isinstance(error, (OverflowError, UnicodeError)):
        # Some number or text within an argument, which no argument is as a whole.
        return "", f"`{function.__qualname__}`: {error}"
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None or not isinstance(error, (TypeError, ValueError)):
        return None
    place = trace.tb_frame.f_code.co_filename
    line = linecache.getline(place, trace.tb_lineno).lstrip()
    ours = Path(place).is_relative_to(Path(__file__).parent) and line.startswith("raise ")
    return ("", str(error)) if ours else None


def _alternatives(written: str) -> list[str]:
    """The kinds of an annotation: ``Sequence[int | str] | None`` has two."""
    kinds, depth, kind = [], 0, ""
    for letter in written:
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if letter == "|" and depth == 0:
            kinds.append(kind.strip())
            kind = ""
        else:
            kind += letter
    return [*kinds, kind.strip()]


def _fits(value: Any, written: str, names: Mapping[str, Any]) -> bool:
    return any(_is_of(value, kind, names) for kind in _alternatives(written))


def _is_of(value: Any, kind: str, names: Mapping[str, Any]) -> bool:
    """True if a value may have the given kind, or the kind is unknown."""
    head, _, inner = kind.partition("[")
    if kind == "None":
        return value is None
    if kind == "float":
        return not isinstance(value, (str, bytes)) and _passes(float, value)
    if kind == "int":
        return _passes(operator.index, value) and -(1 << 63) <= operator.index(value) < 1 << 63
    if kind == "bool":
        return _passes(bool, value)
    if kind == "str":
        return isinstance(value, str) and _passes(str.encode, value)
    if head in ("ArrayLike", "NDArray", "Floats"):
        return _passes(_as_array, value) and not (head != "ArrayLike" and _is_scalar(value))
    if head == "Triple":
        # How many there are the function says itself.
        return _passes(_as_array, value) and not (isinstance(value, Mapping) or _is_scalar(value))
    if head in ("Sequence", "Iterable", "Collection"):
        plain = not isinstance(value, (bytes, Mapping)) and _passes(iter, value)
        return plain and _items_fit(value, inner.removesuffix("]"), names)
    if head in ("Mapping", "dict"):
        keys = isinstance(value, Mapping) and inner.startswith("str,")
        return isinstance(value, Mapping) and (not keys or _items_fit(list(value), "str", names))
    if head == "Callable":
        return callable(value)
    if head in ("os.PathLike", "Path"):
        return hasattr(value, "__fspath__")
    thing = _thing(head, names) if re.fullmatch(r"(_core\.)?\w+", head) else None
    parts = get_args(thing)
    if parts and all(inspect.isclass(part) for part in parts):
        return any(_is_of(value, p.__name__, {p.__name__: p}) for p in parts)
    # From Python 3.11 on `Any` is a class that nothing is an instance of.
    return thing is Any or not inspect.isclass(thing) or isinstance(value, thing)


def _thing(head: str, names: Mapping[str, Any]) -> Any:
    """Object of an annotation; modules import some of these for the type checker only."""
    if head in names:
        return names[head]
    if head.startswith("_core."):
        return getattr(import_module("moldloft._core"), head.removeprefix("_core."), None)
    package = import_module("moldloft")
    if head in package.__all__:
        return getattr(package, head)
    # A type has one name in the whole package.
    ours = (vars(m).get(head) for n, m in list(sys.modules.items()) if n.startswith("moldloft."))
    return next((thing for thing in ours if inspect.isclass(thing)), None)


def _items_fit(value: Any, kind: str, names: Mapping[str, Any]) -> bool:
    # An iterator is used up already.
    if kind not in ("str", "int", "float", "ArrayLike", "Triple") or iter(value) is value:
        return True
    if isinstance(value, str):
        return kind == "str" and _passes(str.encode, value)
    return all(_fits(item, kind, names) for item in value)


def _passes(call: Callable[[Any], Any], value: Any) -> bool:
    try:
        call(value)
    except Exception:
        return False
    return True


def _as_array(value: Any) -> None:
    import numpy as np

    if isinstance(value, (str, bytes)) or np.iscomplexobj(value):
        raise TypeError
    np.asarray(value, dtype=np.float64)


def _is_scalar(value: Any) -> bool:
    import numpy as np

    return np.ndim(value) == 0


def _shown(value: Any) -> str:
    """Short text of the value found."""
    kind = type(value).__name__
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return f"{kind} of shape {shape}"
    try:
        text = repr(value)
    except Exception:
        return kind
    if isinstance(value, (int, float, str)) and len(text) <= 40:
        return f"{kind} {text}"
    return f"{kind} {text[:40]}…" if len(text) > 40 else f"{kind} {text}"
