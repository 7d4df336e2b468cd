"""A model as one file that opens offline: the workbench with its scene and its engine."""

from __future__ import annotations

import base64
import html
import json
import re
from collections.abc import Mapping, Sequence
from functools import partial
from importlib import resources
from pathlib import Path, PurePath
from typing import Any

from moldloft import _core
from moldloft.errors import Error
from moldloft.workbench.frames import head_of
from moldloft.workbench.page import engine_packed, page_parts, worker_script
from moldloft.workbench.text import applied, read

__all__ = ["exported_page", "page_of", "with_values"]

# A page with an engine runs scripts and WebAssembly of its own, and asks nothing of anybody.
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'{engine}; style-src 'unsafe-inline'; "
    "img-src data: blob:; base-uri 'none'; form-action 'none'"
)
_ENGINE_POLICY = " 'wasm-unsafe-eval' blob:; worker-src blob:"


def exported_page(
    path: Path,
    *,
    values: Mapping[str, float] | None = None,
    library: Sequence[str] = (),
    living: bool = True,
) -> bytes:
    """The page of a model's file; interactive if the package contains the engine for pages.

    Parameters
    ----------
    path
        The model.
    values
        Parameters, and literals of objects, that differ from the text's.
    library
        Further folders that the model may read.
    living
        False for a page without the engine: a fraction of the size, and nothing moves.

    Raises
    ------
    Error
        If a value cannot be set, or the page was not built.
    """
    folder = path.resolve().parent
    return page_of(
        path.name, read(path).text, folder, values=values, library=library, living=living
    )


def page_of(
    name: str,
    text: str,
    folder: Path | None,
    *,
    values: Mapping[str, float] | None = None,
    library: Sequence[str] = (),
    living: bool = True,
    cell: bool = False,
) -> bytes:
    """The page of a text: as :func:`exported_page`.

    Parameters
    ----------
    name
        Name of the model; the extension gives the format.
    text
        The text.
    folder
        The folder that it may read; ``None`` permits no reading.
    values, library, living
        As for :func:`exported_page`.
    cell
        True if the page is shown by a notebook's cell, which follows its text.

    Raises
    ------
    Error
        If a value cannot be set, or the page was not built.
    """
    session = _core.Session(name, text, None if folder is None else str(folder), list(library))
    asked = partial(_asked, session)
    asked(kind="show", contours=True)
    engine = engine_packed() if living else None
    if values and engine is not None:
        # The page's own engine begins with the text: what differs is written into it.
        text = with_values(session, text, values)
        asked(kind="text", text=text)
    elif values:
        asked(kind="set", values=dict(values))
    frames = {"open": asked(kind="sync", tab=1)}
    first = head_of(frames["open"])
    shown = any(o["class"] in ("surface", "mesh") for o in first.get("objects", []))
    hello = {
        "kind": "hello",
        "name": name,
        "text": text,
        "version": 0,
        "dirty": False,
        "words": head_of(asked(kind="words"))["words"],
        "watched": head_of(asked(kind="watch", expressions=_usual()))["watched"] if shown else [],
    }
    data = {
        "hello": hello,
        "frames": {kind: base64.b64encode(frame).decode() for kind, frame in frames.items()},
        "files": [] if engine is None else _carried(session.files(), folder),
        "cell": cell and engine is not None,
    }
    return _assembled(name, json.dumps(data), engine).encode()


def _usual() -> list[str]:
    """All that pages watch at first; each shows those for its model."""
    text = (resources.files("moldloft.workbench") / "usual.json").read_text(encoding="utf-8")
    return list(dict.fromkeys(word for words in json.loads(text).values() for word in words))


def _asked(session: _core.Session, **request: object) -> bytes:
    frame = session.answer(json.dumps(request))
    if "error" in (head := head_of(frame)):
        why = str(head["error"])
        raise Error(why)
    return frame


def with_values(session: _core.Session, text: str, values: Mapping[str, float]) -> str:
    """The text of a session with values of parameters, and literals of objects, written into it.

    Parameters
    ----------
    session
        A session of the text.
    text
        The text.
    values
        The values by name.

    Raises
    ------
    Error
        If a value cannot be set, or the text has no number for it.
    """
    _asked(session, kind="set", values=dict(values))
    reply = head_of(_asked(session, kind="commit"))
    if reply.get("kept"):
        names = ", ".join(reply["kept"])
        raise Error(
            f"`{names}` is not stated as a number in this text: change it where it is stated, "
            "or leave the engine out (`--still`)"
        )
    return _edited(text, reply.get("edits", []))


def _edited(text: str, edits: Sequence[Mapping[str, Any]]) -> str:
    """The text after disjoint edits with positions in UTF-16 units."""
    length = len(text.encode("utf-16-le", "surrogatepass")) // 2
    steps: list[Any] = []
    at = 0
    for edit in sorted(edits, key=lambda e: int(e["from"])):
        steps += [edit["from"] - at] if edit["from"] > at else []
        steps.append([edit["to"] - edit["from"], *str(edit["insert"]).split("\n")])
        at = edit["to"]
    return applied(text, [*steps, length - at] if length > at else steps)


def _carried(
    files: Sequence[tuple[str, str | None, str, bytes]], folder: Path | None
) -> list[dict[str, str | None]]:
    """The files that the model read, under names without paths of this machine."""

    def public(name: str | None) -> str | None:
        if name is None:
            return None
        place = PurePath(name)
        if folder is not None and place.is_relative_to(folder):
            return place.relative_to(folder).as_posix()
        return place.name

    return [
        {
            "path": path,
            "from": public(asker),
            "name": public(name),
            "data": base64.b64encode(data).decode(),
        }
        for path, asker, name, data in files
    ]


def _assembled(name: str, data: str, engine: bytes | None) -> str:
    """The built page as one file. Text of a model is escaped data that cannot end its element."""
    index, script, styles = page_parts()
    module, sheet = (
        r"<script type=\"module\"[^>]*></script>",
        r"<link rel=\"(?:stylesheet|modulepreload)\"[^>]*>",
    )
    index = re.sub(rf"\s*(?:{module}|{sheet})", "", index)
    script = re.sub(r"</(script)", r"<\\/\1", script, flags=re.I).replace("<!--", "<\\!--")
    policy = _POLICY.format(engine="" if engine is None else _ENGINE_POLICY)
    policy = f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
    head = f"{policy}\n<style>{styles}</style>\n"
    parts = [f'<script type="application/json" id="moldloft-model">{_as_data(data)}</script>']
    if engine is not None:
        worker = _as_data(json.dumps(worker_script()))
        parts.append(f'<script type="application/json" id="moldloft-worker">{worker}</script>')
    # The script runs when the elements before it are there: the engine, which is long, comes last.
    parts.append(f'<script>(() => {{"use strict";{script}\n}})()</script>')
    if engine is not None:
        packed = base64.b64encode(engine).decode()
        parts.append(
            f'<script type="application/octet-stream" id="moldloft-engine">{packed}</script>'
        )
    body = "\n".join(parts) + "\n"
    index = index.replace("__NONCE__", "")
    before, title, after = index.partition("<title>Moldloft</title>")
    index = f"{before}{head}<title>{html.escape(name)}</title>{after if title else ''}"
    start, end, rest = index.rpartition("</body>")
    return f"{start}{body}{end}{rest}"


def _as_data(text: str) -> str:
    """JSON that no parser of pages takes for anything else."""
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
