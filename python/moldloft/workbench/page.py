"""The built page: read from the package, by path."""

from __future__ import annotations

from importlib import resources

from moldloft.errors import Error

__all__ = ["NO_ENGINE", "engine_packed", "page_files", "page_parts", "worker_script"]

_NO_PAGE = (
    "the page of the workbench is not built: run `make web` in the clone (it needs Node.js 20 or "
    "newer), or install a released wheel"
)

#: Message if the engine for pages is missing.
NO_ENGINE = (
    "the engine for pages is not built: run `make engine` in the clone (it needs the target "
    "wasm32-unknown-unknown: `rustup target add wasm32-unknown-unknown`), or install a released "
    "wheel"
)

_FOLDER = resources.files("moldloft") / "workbench"


def page_files() -> dict[str, bytes]:
    """The files of the page by path.

    Raises
    ------
    Error
        If the page was not built.
    """
    root = _FOLDER / "page"
    index = root / "index.html"
    if not index.is_file():
        raise Error(_NO_PAGE)
    files = {"/index.html": index.read_bytes()}
    for entry in (root / "assets").iterdir():
        files[f"/assets/{entry.name}"] = entry.read_bytes()
    return files


def page_parts() -> tuple[str, str, str]:
    """The page for one file: its frame, script and style.

    A page opened from disk cannot load other files, so the script contains all chunks.
    """
    index = page_files()["/index.html"].decode()
    root = _FOLDER / "page"
    script, style = ((root / f"page.{kind}").read_text(encoding="utf-8") for kind in ("js", "css"))
    return index, script, style


def engine_packed() -> bytes | None:
    """The engine in WebAssembly, packed by XZ; ``None`` when it was not built."""
    engine = _FOLDER / "wasm" / "engine.wasm.xz"
    return engine.read_bytes() if engine.is_file() else None


def worker_script() -> str:
    """The script of the worker that holds the engine."""
    return (_FOLDER / "page" / "worker.js").read_text(encoding="utf-8")
