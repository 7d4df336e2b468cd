"""A model as one file that opens offline: the page of the workbench with the last scene in it."""

from __future__ import annotations

import base64
import html
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from moldloft import _core
from moldloft.errors import Error
from moldloft.workbench.hub import head_of
from moldloft.workbench.page import page_files
from moldloft.workbench.text import read

__all__ = ["still_page"]

_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; base-uri 'none'; form-action 'none'"
)


def still_page(
    path: Path, *, values: Mapping[str, float] | None = None, library: Sequence[str] = ()
) -> bytes:
    """The page of a model's file.

    Parameters
    ----------
    path
        The model.
    values
        Parameters, and literals of objects, that differ from the text's.
    library
        Further folders that the model may read.

    Raises
    ------
    Error
        When a value cannot be set, or the page was not built.
    """
    stored = read(path)
    session = _core.Session(path.name, stored.text, str(path.resolve().parent), list(library))

    def asked(**request: object) -> bytes:
        frame = session.answer(json.dumps(request))
        if "error" in (head := head_of(frame)):
            why = str(head["error"])
            raise Error(why)
        return frame

    asked(kind="show", contours=True)
    if values:
        asked(kind="set", values=dict(values))
    watched = ["mesh.area", "hydrostatics.displacement", "hydrostatics.lcb", "hydrostatics.kmt"]
    objects = head_of(asked(kind="sync")).get("objects", [])
    if any(o["class"] in ("surface", "mesh") for o in objects):
        asked(kind="watch", expressions=watched)
    frames = {"open": asked(kind="sync", tab=1)}
    hello = {"kind": "hello", "name": path.name, "text": stored.text, "version": 0, "dirty": False}
    data = {
        "hello": hello,
        "frames": {kind: base64.b64encode(frame).decode() for kind, frame in frames.items()},
    }
    return _assembled(path.name, json.dumps(data)).encode()


def _assembled(name: str, data: str) -> str:
    """One file of the built page's parts. What a model says is data, and never ends its element."""
    files = page_files()
    index = files["/index.html"].decode()
    (script,) = [text.decode() for path, text in files.items() if path.endswith(".js")]
    styles = "\n".join(text.decode() for path, text in files.items() if path.endswith(".css"))
    module, style = r"<script type=\"module\"[^>]*></script>", r"<link rel=\"stylesheet\"[^>]*>"
    index = re.sub(rf"\s*(?:{module}|{style})", "", index)
    data = data.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    script = re.sub(r"</(script)", r"<\\/\1", script, flags=re.I).replace("<!--", "<\\!--")
    policy = f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
    head = f"{policy}\n<style>{styles}</style>\n"
    body = (
        f'<script type="application/json" id="moldloft-model">{data}</script>\n'
        f'<script type="module">{script}</script>\n'
    )
    index = index.replace("__NONCE__", "")
    before, title, after = index.partition("<title>Moldloft</title>")
    index = f"{before}{head}<title>{html.escape(name)}</title>{after if title else ''}"
    start, end, rest = index.rpartition("</body>")
    return f"{start}{body}{end}{rest}"
