"""Optional packages of studies."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from moldloft.errors import MissingPackageError

__all__ = ["needed"]


def needed(module: str, extra: str, purpose: str) -> Any:
    """A module of another package.

    Parameters
    ----------
    module
        Its name.
    extra
        The extra of Moldloft that brings it.
    purpose
        The feature that needs it, for the message.

    Raises
    ------
    MissingPackageError
        If it is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise MissingPackageError(
            f"{purpose} needs {package}: pip install 'moldloft[{extra}]' ({error})"
        ) from error
