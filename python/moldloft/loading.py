"""Loading of models from files and texts, and restoration from copies and pickles."""

from __future__ import annotations

import inspect
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FileError, record_raised
from moldloft.models import Model

if TYPE_CHECKING:
    from moldloft.implicit import Field, Set

__all__ = ["Origin", "load", "loads", "restored"]


@dataclass(frozen=True)
class Origin:
    """Data that, with its text, restore a model in this or another process."""

    name: str
    """The name that messages show."""
    folder: str | None = None
    """The folder that the text may load from."""
    library: tuple[str, ...] = ()
    """Further folders."""
    functions: dict[str, Any] = field(default_factory=dict)
    """Python functions, by their names in the text."""
    edited: bool = False
    """True while the text is being edited: the valid part of a faulty one is run."""


def _absolute(folders: Sequence[str]) -> tuple[str, ...]:
    return tuple(os.fspath(Path(folder).absolute()) for folder in folders)


def restored(origin: Origin | None, text: str, values: Mapping[str, float], refined: int) -> Model:
    """A model in the state stored in a copy or a pickle.

    Parameters
    ----------
    origin
        Origin of the model.
    text
        The text of the model.
    values
        Values by name.
    refined
        The refinement level.
    """
    origin = origin or Origin("model.sdl")
    document = _core.Document.from_text(
        origin.name, text, origin.folder, list(origin.library), origin.edited
    )
    model = Model(document, origin)
    _add_functions(model, origin.functions)
    if refined:
        model.refine(refined)
    if values:
        model.set(values)
    return model


def load(
    path: str | os.PathLike[str],
    *,
    library: Sequence[str | os.PathLike[str]] = (),
    functions: Mapping[str, Callable[..., Any] | Field | Set] | None = None,
    strict: bool = True,
    edited: bool = False,
) -> Model:
    """Load a model from a file.

    Parameters
    ----------
    path
        An ``.sdl`` program, an ``.ms2`` model file or a ``.skt`` sketch.
    library
        Folders from which it may load, in addition to its own.
    functions
        Python functions that the model may call, by name. They take and return floats, vectors
        ``(3,)`` and arrays; for derivatives they receive :class:`moldloft.numbers.Dual` numbers, on
        which arithmetic and NumPy's elementary functions work. A :class:`moldloft.implicit.Field`
        or :class:`moldloft.implicit.Set` is called without arguments: ``field f = scan();``.
    strict
        True to raise errors. Otherwise they are in :attr:`Model.diagnostics` only, and objects that
        do not depend on a failed one are evaluated. Nothing of a text with a syntax error is run.
    edited
        True while the text is being edited: the valid part of a text with a syntax error is run,
        and nothing raises.

    Returns
    -------
    Model
        It has been run: parameters have their stated values.

    Raises
    ------
    ModelError
        If the model has an error.
    FileError
        If the file cannot be read, or states a later version of the language.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "point.sdl"
    ...     _ = path.write_text("AbsPoint P(1, 2, 3);")
    ...     load(path)["P"].z
    3.0
    """
    from moldloft.storage import utf8_path

    folders = [utf8_path(folder) for folder in library]
    place = Path(utf8_path(path))
    origin = Origin(
        place.name,
        utf8_path(place.parent.absolute()),
        _absolute(folders),
        dict(functions or {}),
        edited,
    )
    model = Model(_core.Document.open(os.fspath(path), folders, edited), origin)
    _add_functions(model, functions)
    if strict and not edited:
        unread = [d for d in model.diagnostics if d.id == "cannot-read"]
        if unread and not model.text:
            raise FileError(str(unread[0]).rstrip(), unread)
        model.check()
    return model


def loads(
    text: str,
    *,
    name: str = "model.sdl",
    library: Sequence[str | os.PathLike[str]] = (),
    functions: Mapping[str, Callable[..., Any] | Field | Set] | None = None,
    strict: bool = True,
    edited: bool = False,
) -> Model:
    """Load a model from a text.

    Parameters
    ----------
    text
        The program, or the model file's content.
    name
        The name that messages show; ``.ms2`` at its end means a model file.
    library
        Folders from which the text may load.
    functions
        See :func:`load`.
    strict, edited
        See :func:`load`.

    Returns
    -------
    Model
        It has been run: parameters have their stated values.

    Raises
    ------
    ModelError
        If the model has an error.
    FileError
        If the text states a later version of the language: ``# moldloft 2`` in its first line.

    Examples
    --------
    >>> import numpy as np
    >>> def rise(x):
    ...     return np.sqrt(x) + 1
    >>> text = "param float a = 4 in [1, 9]; AbsPoint P(0, 0, rise(a));"
    >>> m = loads(text, functions={"rise": rise})
    >>> m["P"].z, m.derivative("P.z", "a")
    (3.0, 0.25)
    """
    from moldloft.storage import utf8_path

    folders = [utf8_path(folder) for folder in library]
    origin = Origin(name, None, _absolute(folders), dict(functions or {}), edited)
    model = Model(_core.Document.from_text(name, text, None, folders, edited), origin)
    _add_functions(model, functions)
    if strict and not edited:
        model.check()
    return model


def _add_functions(
    model: Model, functions: Mapping[str, Callable[..., Any] | Field | Set] | None
) -> None:
    for name, function in (functions or {}).items():
        if not name.isidentifier() or not name.isascii():
            raise ValueError(
                f"{name!r} is not a valid name: expected a letter, then letters, digits and _"
            )
        core = getattr(function, "_core", None)
        if isinstance(core, (_core.Field, _core.Set)):
            model._document.add_shape(name, core)
            continue
        if not callable(function):
            raise TypeError(f"`{name}` is neither a function nor a field or set")
        arguments = list(inspect.signature(function).parameters)
        doc = inspect.getdoc(function) or f"The Python function {name}."
        model._document.add_function(name, arguments, doc, _guarded(model, name, function))


def _guarded(model: Model, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """The function as called by its model, which cannot be used inside it."""
    inside = model._inside

    def call(*arguments: Any) -> Any:
        thread = threading.get_ident()
        inside.add(thread)
        try:
            return function(*arguments)
        except BaseException as error:
            record_raised(name, error)
            raise
        finally:
            inside.discard(thread)

    return call


explain(globals())
