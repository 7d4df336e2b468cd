"""The routines of the libraries that come with the program, as rows of the reference."""

from __future__ import annotations

import re
from typing import Any

from moldloft import _core

__all__ = ["picture", "routines"]

_ROUTINE = re.compile(r"(?:subroutine|function (\w+)) (\w+)\((.*)\) \{$")
_ARGUMENT = re.compile(r"(returned )?(\w+) (\w+)(\.\.\.)?(?: = (.+))?$")
_MEANING = re.compile(r"^- (\w+): (.*)$", re.MULTILINE)
_ARRAY = re.compile(r"\b(?:curve|surface) (\w+)\[")


def routines() -> list[dict[str, Any]]:
    """A row for each routine with an example in its comment, in the order of the files.

    Rows have the keys of :func:`moldloft.language.reference`, ``library``, the file to load, and
    ``signature``, the form of a call. Routines without an example are internal to their file. A
    line ``- name: meaning`` of the comment describes an argument.

    >>> row = next(row for row in routines() if row["name"] == "naca4")
    >>> row["library"], row["signature"]
    ('naca.sdl', 'naca4(returned curve c, float m, float p, float t)')
    """
    rows: list[dict[str, Any]] = []
    for library, text in _core.libraries():
        comment: list[str] = []
        for line in text.splitlines():
            found = _ROUTINE.match(line)
            if line.startswith("#"):
                comment.append(line[1:].removeprefix(" "))
                continue
            example = [part.strip() for part in comment if part.startswith("  ")]
            if found and example:
                result, name, arguments = found.groups()
                said = dict(_MEANING.findall("\n".join(comment)))
                prose = [part for part in comment if not part.startswith(("  ", "- "))]
                doc = " ".join(prose).strip()
                rows.append(
                    {
                        "name": name,
                        "class": result or "subroutine",
                        "is_kind": False,
                        "summary": doc,
                        "doc": doc,
                        "fields": [_field(text, said) for text in arguments.split(", ") if text],
                        "columns": None,
                        "example": f'load "{library}"; ' + " ".join(example),
                        "signature": f"{name}({arguments})",
                        "library": library,
                    }
                )
            comment = []
    return rows


def _field(text: str, said: dict[str, str]) -> dict[str, Any]:
    found = _ARGUMENT.match(text)
    assert found is not None, text
    returned, kind, name, many, default = found.groups()
    return {
        "name": name,
        "class": kind,
        "many": bool(many),
        "required": not many and default is None,
        "default": default,
        "help": ("Filled by the routine. " if returned else "") + said[name],
    }


def picture(row: dict[str, Any]) -> bytes | None:
    """A PNG of the curve or surface in a routine's example; None for other examples.

    Parameters
    ----------
    row
        A row of :func:`routines`.
    """
    import moldloft

    name = pictured(row)
    if name is None:
        return None
    kind, shown = "BCurve", f"BCurve shown({name}, degree = 1);"
    if f"surface {name}[" in row["example"]:
        kind, shown = (
            "BSurf",
            (
                f"BSurf shown({name}, nu = {name}.d1, nv = {name}.d2, degree_u = 1, degree_v = 1, "
                f"divisions = {{{name}.d1 - 1, {name}.d2 - 1}});"
            ),
        )
    model = moldloft.loads(f"{row['example']} {shown}", name=f"{row['name']}.sdl")
    return bytes(model.kind_picture(kind, 360, 240))


def pictured(row: dict[str, Any]) -> str | None:
    """The last curve or surface that a routine's example declares.

    Parameters
    ----------
    row
        A row of :func:`routines`.
    """
    names = _ARRAY.findall(row["example"])
    return names[-1] if names else None
