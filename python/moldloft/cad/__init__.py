"""CAD files: writers of DXF and 3DM, readers of STEP and IGES.

STEP and IGES are written without any other package. The readers of STEP and IGES and the writers of
DXF and 3DM need packages of the extra ``cad``: ``pip install 'moldloft[cad]'``.
"""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from types import ModuleType

from moldloft.errors import MissingPackageError

__all__ = ["check_occt", "identifier", "needed"]


def needed(module: str, package: str, purpose: str) -> ModuleType:
    """A module of an extra; if it is missing, an error with the command to install it.

    Parameters
    ----------
    module
        Its name.
    package
        Command that installs it.
    purpose
        Purpose of the package.

    Raises
    ------
    MissingPackageError
        If it is not installed, or OCP belongs to another package.
    """
    try:
        found = import_module(module)
    except ImportError as error:
        raise MissingPackageError(
            f"{purpose} needs the package {package}: pip install 'moldloft[cad]' ({error})"
        ) from error
    if module == "OCP":
        check_occt(purpose)
    return found


_OCCT = "cadquery-ocp-novtk"
"""The package of OCCT."""


def check_occt(purpose: str) -> None:
    """Looks for OCCT without loading it, which takes most of a second.

    Parameters
    ----------
    purpose
        Purpose of the package.

    Raises
    ------
    MissingPackageError
        If it is not installed, or is of another package.
    """
    found = find_spec("OCP")
    if found is None:
        raise MissingPackageError(
            f"{purpose} needs the package {_OCCT}: pip install 'moldloft[cad]'"
        )
    if not _has_collections(found):
        raise MissingPackageError(_clash(purpose, _OCCT))


def _has_collections(found: ModuleSpec) -> bool:
    """True for the module of OCCT 8."""
    places = found.submodule_search_locations
    return PathFinder.find_spec("OCP.collections", places) is not None


def _clash(purpose: str, package: str) -> str:
    """Remedy if another package has installed the same module."""
    installed = []
    for name in ("cadquery-ocp", "cadquery-ocp-proxy", package):
        with suppress(PackageNotFoundError):
            installed.append(f"{name} {version(name)}")
    return (
        f"{purpose} needs OCCT 8, but the module OCP is that of an older release: the packages "
        f"{', '.join(installed)} install the same folder, and the last one installed replaces the "
        f"files of the others\nhelp: install moldloft[cad] in an environment without CadQuery, or "
        f"put OCCT 8 back: pip install --force-reinstall --no-deps {package}"
    )


def identifier(label: str, taken: set[str]) -> str:
    """A unique valid name of the language.

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
