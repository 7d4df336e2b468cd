"""The built page: read from the package, by path."""

from __future__ import annotations

from importlib import resources

from moldloft.errors import Error

__all__ = ["page_files"]

_NO_PAGE = (
    "the page of the workbench is not built: run `make web` in the clone (it needs Node.js 20 or "
    "newer), or install a released wheel"
)


def page_files() -> dict[str, bytes]:
    """The files of the page by path.

    Raises
    ------
    Error
        When the page was not built.
    """
    root = resources.files("moldloft") / "workbench" / "page"
    index = root / "index.html"
    if not index.is_file():
        raise Error(_NO_PAGE)
    files = {"/index.html": index.read_bytes()}
    for entry in (root / "assets").iterdir():
        files[f"/assets/{entry.name}"] = entry.read_bytes()
    return files
