"""Files of the page: a model in any format that the command writes, and CAD files as programs.

They are made in a process of its own from the text and the values that hold without being in it:
the writers are those of ``moldloft build`` and ``moldloft convert``, with their remarks.
"""

from __future__ import annotations

import base64
import re
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from moldloft.errors import Error
from moldloft.exchange.files import file_name, produce
from moldloft.formats import formats
from moldloft.workbench.frames import frame_of
from moldloft.workbench.room import answer_frames

if TYPE_CHECKING:
    from moldloft import _core
    from moldloft.models import Model

__all__ = ["Converter", "serve"]

#: Longest stem of a file's name, in characters.
_LONGEST_STEM = 80


class Converter:
    """A model's text, and files exported from it.

    Parameters
    ----------
    name
        The model's name; the ending gives the format.
    library
        Folders that the text may read.
    """

    def __init__(self, name: str, library: Sequence[str]) -> None:
        self._name, self._library = name, list(library)
        self._text = ""

    def sync(self, text: str) -> None:
        """Replace the model's text."""
        self._text = text

    def answer(self, request: dict[str, Any]) -> bytes:
        """The answer to a request of the page: a frame."""
        if isinstance(request.get("text"), str):
            self.sync(request["text"])
        number = request.get("id", 0)
        try:
            made = self._export(request) if request["kind"] == "export" else _import(request)
        except Error as error:
            return frame_of({"id": number, "error": str(error)}, {})
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            return frame_of({"id": number, "error": f"not a request for files: {error!r}"}, {})
        head, files = made
        return frame_of({"id": number, **head}, files)

    def _export(self, request: dict[str, Any]) -> tuple[dict[str, Any], dict[str, bytes]]:
        """The files of the model in a format, with the remarks that the command prints."""
        from moldloft import loads

        values: Mapping[str, float] = request.get("values") or {}
        # A name from a page is no path.
        stem = re.sub(r"[^\w-]", "_", str(request["stem"]))[:_LONGEST_STEM] or "model"
        model = loads(self._text, name=self._name, library=self._library, strict=False)
        if values:
            model.set({str(name): float(value) for name, value in values.items()})
        format = str(request["format"])
        said = {str(d) for d in model.diagnostics}
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            outputs = produce(model, format, Path(file_name(stem, format)))
        remarks = _remarks(model, format, said, [str(w.message) for w in warned])
        return {"remarks": remarks}, {output.name: output.data for output in outputs}


def _remarks(
    model: Model, format: str, said: set[str], warned: Sequence[str]
) -> list[dict[str, Any]]:
    """Remarks about a file, without those that the page has from its own engine."""
    row = formats()[format]
    found = [] if row.writer else list(model.export_remarks)
    of_panels = row.holds.startswith("panels") or row.panel_code
    # Making panels adds to the remarks of the run.
    found += [d for d in model.diagnostics if str(d) not in said]
    if of_panels and (mesh := model.mesh()).patches and not mesh.closed:
        found += model.junctions()
    rows = {str(d): _row(d) for d in found}
    for text in warned:
        rows.setdefault(text, {"severity": "warning", "message": text, "help": [], "object": None})
    if not model.objects:
        words = "the model has no objects; its files are empty"
        rows[words] = {"severity": "warning", "message": words, "help": [], "object": None}
    return list(rows.values())


def _row(d: _core.Diagnostic) -> dict[str, Any]:
    more = [f"expected {d.expected}" if d.expected else "", f"found {d.found}" if d.found else ""]
    return {
        "severity": d.severity,
        "message": d.message,
        "help": [words for words in [*more, *d.notes, *d.help] if words],
        "object": d.object,
    }


def _import(request: dict[str, Any]) -> tuple[dict[str, Any], dict[str, bytes]]:
    """A CAD file as a program, with its panels, and remarks about omitted and doubtful parts."""
    from moldloft import loads
    from moldloft.cad.importing import program

    name = Path(str(request["name"])).name
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(base64.b64decode(str(request["data"]), validate=True))
        try:
            text, remarks = program(path, units=str(request.get("units") or "m"))
        except Error as error:
            # The place of the copy is of no use to the reader.
            raise Error(str(error).replace(str(path), name)) from None
    model = loads(text, name=f"{path.stem}.sdl")
    files = model.encoded("ply", f"{name}.ply") if model.mesh().patches else {}
    return {"text": text, "remarks": [str(remark) for remark in remarks]}, files


def serve(memory: int, name: str, library: Sequence[str]) -> None:
    """Answer the parent until its end."""
    converter = Converter(name, library)
    # Writers of other projects use temporary files.
    answer_frames(memory, converter.sync, converter.answer, files=True)
