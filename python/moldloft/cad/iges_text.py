"""Repair of the text of IGES files: missing entities and truncated files."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from moldloft.errors import FileError

__all__ = ["IgesText"]


@dataclass
class IgesText:
    """The text of an IGES file."""

    text: str
    """Text for OCCT, with an end added to a truncated file."""
    remarks: list[str] = field(default_factory=list)
    """Doubtful or lost content."""
    names: dict[int, str] = field(default_factory=dict)
    """Names of faces by number: empty, since OCCT provides them."""
    resolution: float = 0.0
    """Resolution of the file in metres; 0 if it states no resolution."""
    levels: dict[int, str] = field(default_factory=dict)
    """Names of levels by number."""

    @classmethod
    def of(cls, path: object, text: str) -> IgesText:
        """The text of a file, with its faults as remarks.

        Parameters
        ----------
        path
            The file, for errors.
        text
            Content of the file.

        Raises
        ------
        FileError
            If the file is cut short before its entities are listed.
        """
        lines = text.splitlines()
        sections: dict[str, list[str]] = {letter: [] for letter in "SGDPT"}
        for line in lines:
            if len(line) >= 73 and line[72] in sections:
                sections[line[72]].append(line)
        made = cls(text, resolution=_resolution(sections["G"]))
        listed, given = _directory(sections["D"]), sections["P"]
        whole = bool(sections["T"])
        if not whole and not given:
            raise FileError(f"cannot read `{path}`: no terminate section; the file is cut short")
        # The last line of parameters may be cut itself.
        if not whole and len(lines[-1]) < 80 and lines[-1] is given[-1]:
            given.pop()
        lost = {n for n, (_, first, count) in listed.items() if first + count - 1 > len(given)}
        fields = {
            n: _fields(given[first - 1 : first - 1 + count])
            for n, (_, first, count) in listed.items()
            if n not in lost
        }

        _check_numbers(path, listed, fields)
        forms = _forms(sections["D"])
        for n, (kind, first, count) in listed.items():
            if kind == 406 and forms[n][0] == 3:
                held = given[first - 1 : first - 1 + count]
                made.levels[forms[n][1]] = _string("".join(line[:64] for line in held))
        faces = [n for n, (kind, _, _) in listed.items() if kind == 144]
        hurt = [n for n in faces if not _there(n, listed, fields)]
        if not whole:
            kept = len(faces) - len(hurt)
            if not kept:
                raise FileError(
                    f"cannot read `{path}`: no terminate section, and no face before it is whole; "
                    "the file is cut short"
                )
            made.remarks.append(
                f"the end of the file is missing: {kept} of {len(faces)} faces are whole and kept"
            )
            made.text = _ended(sections, listed, {n for n in listed if n in lost} | {*hurt})
        for n in hurt[:_MOST]:
            made.remarks.append(f"face D{n} needs entities that are missing in the file")
        if len(hurt) > _MOST:
            made.remarks.append(f"{len(hurt) - _MOST} more faces need missing entities")
        return made


_MOST = 20
"""Remarks of one kind that are written out."""


_METRES = {
    1: 0.0254, 2: 0.001, 4: 0.3048, 5: 1609.344, 6: 1.0, 7: 1000.0, 8: 2.54e-5, 9: 1e-6, 10: 0.01,
    11: 2.54e-8,
}  # fmt: skip
"""Units of length by their flags."""


def _resolution(lines: list[str]) -> float:
    """The resolution that the global section states, in metres."""
    text = "".join(line[:72] for line in lines)
    values: list[str] = []
    comma, end = ",", ";"
    while text and len(values) < 19:
        if string := re.match(r"\s*(\d+)H", text):
            last = string.end() + int(string[1])
            values.append(text[string.end() : last])
            text = text[last:].lstrip()
            if len(values) == 1 and len(values[0]) == 1:
                comma = values[0]
            elif len(values) == 2 and len(values[1]) == 1:
                end = values[1]
        else:
            at = min((k for k in (text.find(comma), text.find(end)) if k >= 0), default=len(text))
            values.append(text[:at].strip())
            text = text[at:]
        if text[:1] == end:
            break
        text = text[1:]
    try:
        return float(values[18].upper().replace("D", "E")) * _METRES.get(int(values[13]), 0.0)
    except (IndexError, ValueError):
        return 0.0


def _whole_number(text: str) -> int:
    return int(text) if text.strip().lstrip("-").isdigit() else 0


def _directory(lines: list[str]) -> dict[int, tuple[int, int, int]]:
    """Kind, first line of parameters and their count, by number."""
    found = {}
    for k in range(0, len(lines) - 1, 2):
        one, other = lines[k], lines[k + 1]
        count = max(_whole_number(other[24:32]), 1)
        found[k + 1] = _whole_number(one[:8]), _whole_number(one[8:16]), count
    return found


def _forms(lines: list[str]) -> dict[int, tuple[int, int]]:
    """Form and level, by number."""
    pairs = range(0, len(lines) - 1, 2)
    return {
        k + 1: (_whole_number(lines[k + 1][32:40]), _whole_number(lines[k][32:40])) for k in pairs
    }


def _string(text: str) -> str:
    """The first string of an entity's parameters."""
    found = re.search(r"[,;]\s*(\d+)H", text)
    return text[found.end() : found.end() + int(found[1])] if found else ""


_EXPONENT = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)[EeDd]\+?\d{2,}")
"""Numbers that may exceed double precision."""
_LARGEST = 1e50
"""Largest coordinate, as for models."""


def _check_numbers(
    path: object, listed: dict[int, tuple[int, int, int]], fields: dict[int, list[str]]
) -> None:
    """Rejects numbers beyond the limits of models."""
    for number, own in fields.items():
        for word in own:
            if _EXPONENT.fullmatch(word) and abs(float(_e(word))) > _LARGEST:
                raise FileError(
                    f"cannot read `{path}`: D{number} (entity {listed[number][0]}): expected "
                    f"numbers of at most {_LARGEST:g}, found {word}"
                )


def _e(number: str) -> str:
    """A number with the exponent of Fortran's double precision as Python reads it."""
    return number.upper().replace("D", "E")


def _fields(lines: list[str]) -> list[str]:
    text = "".join(line[:64] for line in lines)
    # Strings, which count their letters first, do not matter to faces.
    return [field.strip() for field in re.split(r"[,;]", text)]


def _there(
    number: int, listed: dict[int, tuple[int, int, int]], fields: dict[int, list[str]]
) -> bool:
    """True if an entity and all entities that its shape needs are in the file."""
    if number == 0:
        return True
    if number not in fields:
        return False
    own = [_whole_number(f) for f in fields[number][1:]]
    match listed[number][0]:
        case 144:
            needs = [own[0], *own[3 : 4 + own[2]]] if len(own) > 3 else own[:1]
        case 142:
            needs = own[1:4]
        case 102:
            needs = own[1 : 1 + own[0]] if own else []
        case 0:
            return False
        case _:
            return True
    return all(_there(n, listed, fields) for n in needs)


def _ended(
    sections: dict[str, list[str]], listed: dict[int, tuple[int, int, int]], lost: set[int]
) -> str:
    """The file with an end section, and null entities in place of lost ones."""
    directory = list(sections["D"][: 2 * len(listed)])
    given = list(sections["P"])
    if lost:
        # Parameters that belong to no entity any more are overwritten from the first lost one.
        used = [first + count for n, (_, first, count) in listed.items() if n not in lost]
        del given[max(used, default=1) - 1 :]
    for n in sorted(lost):
        at = len(given) + 1
        given.append(f"{'0;':<64} {n:>7}P{at:>7}")
        directory[n - 1] = f"{0:>8}{at:>8}{0:>8}{0:>8}{0:>8}{0:>8}{0:>8}{0:>8}00000000D{n:>7}"
        directory[n] = f"{0:>8}{0:>8}{0:>8}{1:>8}{0:>8}{'':>32}D{n + 1:>7}"
    counts = "".join(
        f"{letter}{len(lines):>7}"
        for letter, lines in zip(
            "SGDP", (sections["S"], sections["G"], directory, given), strict=True
        )
    )
    every = [*sections["S"], *sections["G"], *directory, *given, f"{counts:<72}T{1:>7}"]
    return "\n".join(every) + "\n"
