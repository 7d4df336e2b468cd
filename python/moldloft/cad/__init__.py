"""CAD files: writers of DXF and 3DM, readers of STEP and IGES.

STEP and IGES are written without any other package. The readers of STEP and IGES and the writers of
DXF and 3DM need packages of the extra ``cad``: ``pip install 'moldloft[cad]'``.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from moldloft.errors import Error

__all__ = ["identifier", "needed"]


def needed(module: str, package: str, purpose: str) -> ModuleType:
    """A module of an extra, or an error that says what to install.

    Parameters
    ----------
    module
        Its name.
    package
        What installs it.
    purpose
        What it is for.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise Error(
            f"{purpose} needs the package {package}: pip install 'moldloft[cad]' ({error})"
        ) from error


def identifier(label: str, taken: set[str]) -> str:
    """A name that the language takes, used once.

    Parameters
    ----------
    label
        The name that is wished for.
    taken
        The names in use; the new one is added.
    """
    base = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in label)
    base = base.strip("_") or "face"
    if not (base[0].isalpha()):
        base = "f_" + base
    name, k = base, 1
    while name in taken:
        k += 1
        name = f"{base}_{k}"
    taken.add(name)
    return name
