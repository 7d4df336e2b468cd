"""The text of STEP files: content that OCCT skips, and the rest of a truncated file."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from functools import cached_property

from moldloft.errors import FileError

__all__ = ["StepText"]

_STRING = r"'(?:[^']|'')*'"
_FACES = ("ADVANCED_FACE", "FACE_SURFACE")

_FACTORS = {
    "LENGTH_UNIT": {
        "INCH": 0.0254,
        "FOOT": 0.3048,
        "FEET": 0.3048,
        "YARD": 0.9144,
        "MILE": 1609.344,
        "MIL": 2.54e-5,
        "MICROINCH": 2.54e-8,
        "MILLIMETRE": 1e-3,
        "MILLIMETER": 1e-3,
        "CENTIMETRE": 1e-2,
        "CENTIMETER": 1e-2,
        "KILOMETRE": 1e3,
        "KILOMETER": 1e3,
        "METRE": 1.0,
        "METER": 1.0,
        "MICRON": 1e-6,
    },
    "PLANE_ANGLE_UNIT": {
        "DEGREE": math.pi / 180,
        "DEGREES": math.pi / 180,
        "GRAD": math.pi / 200,
        "GON": math.pi / 200,
        "RADIAN": 1.0,
    },
}
"""Units by conversion, in metres and radians."""

_SI = {"LENGTH_UNIT": "METRE", "PLANE_ANGLE_UNIT": "RADIAN"}
_WORDS = {"LENGTH_UNIT": "length", "PLANE_ANGLE_UNIT": "plane angle"}
_TAKEN = {"LENGTH_UNIT": "millimetres are taken", "PLANE_ANGLE_UNIT": "radians are taken"}
_PREFIXES = {"$": 1.0, ".MILLI.": 1e-3, ".CENTI.": 1e-2, ".DECI.": 0.1, ".MICRO.": 1e-6}
_PREFIXES |= {".KILO.": 1e3, ".NANO.": 1e-9}

_EXPONENT = re.compile(r"(?<![\d.])[-+]?\d++(?:\.\d*+)?[Ee]\+?\d{2,}")
"""Numbers that may exceed double precision."""
_LARGEST = 1e50
"""Largest coordinate, as for models."""

_ROUNDED = 1e-4
"""Factors of units are written with few digits: 0.01745 for a degree."""


@dataclass
class StepText:
    """The text of a STEP file and its entities."""

    text: str
    """Text for OCCT: with an end added to a truncated file, and faces named by number."""
    remarks: list[str] = field(default_factory=list)
    """Doubtful or lost content."""
    names: dict[int, str] = field(default_factory=dict)
    """Names of the faces of the file, by entity number."""

    @classmethod
    def of(cls, path: object, text: str) -> StepText:
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
            If it is not a STEP file, or has no complete face.
        """
        if not text.lstrip().startswith("ISO-10303-21"):
            raise FileError(
                f"cannot read `{path}`: not a STEP file (it must begin with ISO-10303-21)"
            )
        # A comment may hold what looks like an entity, and half a string.
        text = re.sub(rf"({_STRING})|/\*.*?(?:\*/|\Z)", _no_comment, text, flags=re.DOTALL)
        whole = re.search(r"END-ISO-10303-21\s*;", re.sub(_STRING, "''", text)) is not None
        made = cls(text if whole else _ended(text))
        made._check_numbers(path)
        made._look_at_references()
        if outside := made._outside():
            named = ", ".join(f"`{name}`" for name in outside[:_MOST])
            more = f" and {len(outside) - _MOST} more" if len(outside) > _MOST else ""
            made.remarks.append(
                f"parts are in other files, which are not read: {named}{more}; convert each of "
                "them, or write one file that contains all parts"
            )
        if whole:
            made._look_at_units()
            made._mark()
            return made
        if not made.whole_faces:
            raise FileError(
                f"cannot read `{path}`: the end is missing, and no face before it is whole; the "
                "file is cut short"
            )
        made.remarks.insert(
            0,
            f"the end of the file is missing: it is cut short after #{max(made.entities)}; "
            f"{len(made.whole_faces)} faces before are whole and kept, bodies and curves are not",
        )
        made._mark()
        return made.only_faces()

    def _check_numbers(self, path: object) -> None:
        """Rejects numbers beyond double precision, and coordinates beyond the limit of models."""
        for number, body in self.entities.items():
            for found in _EXPONENT.finditer(body):
                size = abs(float(found[0]))
                if size == math.inf or (size > _LARGEST and _kind(body) == "CARTESIAN_POINT"):
                    raise FileError(
                        f"cannot read `{path}`: #{number} ({_kind(body)}): expected numbers of at "
                        f"most {_LARGEST:g}, found {found[0]}"
                    )

    @cached_property
    def entities(self) -> dict[int, str]:
        """The entities of the original text by number, without the contents of their strings."""
        plain = re.sub(_STRING, "''", self.text)
        found = re.findall(r"#(\d+)\s*=\s*([^;]*);", plain)
        return {int(n): body.strip() for n, body in found}

    @cached_property
    def curve_names(self) -> list[tuple[str, int, int]]:
        """Name, degree and number of points of each B-spline in sets of curves, in their order."""
        sets = re.findall(
            rf"\bGEOMETRIC_(?:CURVE_)?SET\s*\(\s*{_STRING}\s*,\s*\(([#\d,\s]*)\)", self.text
        )
        numbers = [int(n) for held in sets for n in re.findall(r"\d+", held)]
        wanted = set(numbers)
        bodies = {
            int(n): body
            for n, body in re.findall(rf"#(\d+)\s*=\s*((?:{_STRING}|[^;'])*);", self.text)
            if wanted and int(n) in wanted
        }
        pattern = (
            rf"B_SPLINE_CURVE(?:_WITH_KNOTS)?\s*\(\s*(?:{_STRING}\s*,)?\s*(\d+)\s*,\s*\(([^)]*)\)"
        )
        found = []
        for n in numbers:
            body = bodies.get(n, "")
            if (spline := re.search(pattern, body)) is not None:
                name = re.search(_STRING, body)
                label = "" if name is None else _letters(name[0][1:-1])
                found.append((label, int(spline[1]), spline[2].count("#")))
        return found

    @cached_property
    def references(self) -> dict[int, list[int]]:
        """References of each entity."""
        return {n: [int(m) for m in re.findall(r"#(\d+)", b)] for n, b in self.entities.items()}

    @cached_property
    def faces(self) -> list[int]:
        """The numbers of faces."""
        return [n for n, body in self.entities.items() if _kind(body) in _FACES]

    def missing(self, number: int) -> list[int]:
        """Missing entities to which an entity refers, directly or indirectly."""
        seen, open_, lost = {number}, [number], set()
        while open_:
            for other in self.references[open_.pop()]:
                if other in seen:
                    continue
                seen.add(other)
                if other in self.references:
                    open_.append(other)
                else:
                    lost.add(other)
        return sorted(lost)

    def _look_at_references(self) -> None:
        """Entities that are missing, the faces that need them, and loops that do not close."""
        held = self.references
        lost = sorted({m for all_ in held.values() for m in all_ if m not in held})
        if lost:
            one = len(lost) == 1
            self.remarks.append(
                f"{len(lost)} {'entity' if one else 'entities'} that others refer to "
                f"{'is' if one else 'are'} missing ({_few(lost)})"
            )
        hurt = {n: m for n in self.faces if (m := self.missing(n))} if lost else {}
        for face, need in list(hurt.items())[:_MOST]:
            self.remarks.append(
                f"face #{face} needs {_few(need)}, which the file does not hold: the face is left "
                "out or has other edges"
            )
        if len(hurt) > _MOST:
            self.remarks.append(f"{len(hurt) - _MOST} more faces need missing entities")
        for face in self.faces:
            if face in hurt:
                continue
            for bound in held[face]:
                for loop in held[bound]:
                    if _kind(self.entities[loop]) == "EDGE_LOOP" and not self._closes(loop):
                        self.remarks.append(
                            f"loop #{loop} of face #{face} does not close: an edge of it is missing"
                        )

    def _outside(self) -> list[str]:
        """Names of other files to which the file refers.

        Documents of ISO 10303-41 with the names that external identifications give them (CAx-IF,
        *Recommended Practices for External References*), and the section REFERENCE of Part 21.
        """
        documents = {n for n, b in self.entities.items() if _DOCUMENT.search(b)}
        found: list[str] = []
        assigned = (
            rf"=\s*APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT\s*\(\s*({_STRING})"
            rf"(?:{_STRING}|[^;'])*?\(([#\d,\s]*)\)\s*\)\s*;"
        )
        for name, items in re.findall(assigned, self.text):
            own = {int(n) for n in re.findall(r"\d+", items)} & documents
            found += [_letters(name[1:-1])] * bool(own)
            documents -= own
        for n, identity, name in re.findall(
            rf"#(\d+)\s*=\s*DOCUMENT_FILE\s*\(\s*({_STRING})\s*,\s*({_STRING})", self.text
        ):
            if int(n) in documents:
                found.append(_letters(identity[1:-1]) or _letters(name[1:-1]))
        if (section := re.search(r"\bREFERENCE\s*;(.*?)\bENDSEC\s*;", self.text, re.S)) is not None:
            found += re.findall(r"[#@]\d+\s*=\s*<([^>#]+)", section[1])
        return list(dict.fromkeys(name for name in found if name.strip()))

    def _closes(self, loop: int) -> bool:
        ends = []
        for oriented in self.references[loop]:
            body = self.entities[oriented]
            edges = [
                n for n in self.references[oriented] if _kind(self.entities[n]) == "EDGE_CURVE"
            ]
            if _kind(body) != "ORIENTED_EDGE" or len(edges) != 1:
                return True
            if len(self.references[edges[0]]) < 2:
                return True
            start, end = self.references[edges[0]][:2]
            ends.append((start, end) if body.rstrip(" )").endswith(".T.") else (end, start))
        return all(end == ends[(k + 1) % len(ends)][0] for k, (_, end) in enumerate(ends))

    def _look_at_units(self) -> None:
        contexts = [n for n, b in self.entities.items() if "GLOBAL_UNIT_ASSIGNED_CONTEXT" in b]
        said: list[str] = []
        if not contexts:
            said = [f"the file names no unit of {_WORDS[k]}; {_TAKEN[k]}" for k in _SI]
        for context in contexts:
            inner = re.search(
                r"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\(([^)]*)", self.entities[context]
            )
            units = [int(n) for n in re.findall(r"#(\d+)", inner[1])] if inner else []
            units = [n for n in units if n in self.entities]
            for kind in _SI:
                own = [n for n in units if re.search(rf"(?<!\w){kind}\s*\(", self.entities[n])]
                if not own:
                    said.append(
                        f"context #{context} names no unit of {_WORDS[kind]}; {_TAKEN[kind]}"
                    )
                said += [fault for n in own if (fault := self._unit(n, kind))]
        self.remarks += dict.fromkeys(said)

    def _unit(self, number: int, kind: str) -> str:
        """Error of a unit, or an empty text."""
        body = self.entities[number]
        start = f"unit of {_WORDS[kind]} #{number}"
        if si := re.search(r"SI_UNIT\s*\(\s*([^,]*?)\s*,\s*\.(\w+)\.", body):
            if si[2] != _SI[kind]:
                return f"{start} is called {si[2].lower()}, which is none of {_WORDS[kind]}"
            return "" if si[1] in _PREFIXES else f"{start} has the prefix {si[1]}; check the size"
        if "CONVERSION_BASED_UNIT" not in body:
            return f"{start} is of no known kind; {_TAKEN[kind]}"
        # The names of units are strings, which `entities` does not keep.
        named = re.search(
            rf"#{number}\s*=[^;]*?CONVERSION_BASED_UNIT\s*\(\s*({_STRING})", self.text
        )
        name = named[1][1:-1] if named else ""
        factor = self._factor(number)
        if factor is None:
            return f"{start} (`{name}`) has no factor; {_TAKEN[kind]}"
        si_name = {"LENGTH_UNIT": "metres", "PLANE_ANGLE_UNIT": "radians"}[kind]
        known = _FACTORS[kind].get(name.upper().strip())
        if known is None:
            return f"{start} (`{name}`) is not known; it is taken as {factor:.6g} {si_name}"
        if abs(factor - known) > _ROUNDED * known:
            return (
                f"{start} (`{name}`) is {factor:.6g} {si_name} in the file, and {known:.6g} as "
                "that unit is defined; the file's is taken"
            )
        return ""

    def _factor(self, number: int, deep: int = 0) -> float | None:
        """Factor of a conversion-based unit to SI; None for a circular definition."""
        if deep > _DEEPEST:
            return None
        for measure in self.references[number]:
            body = self.entities.get(measure, "")
            # Its kind may be left out: LENGTH_MEASURE_WITH_UNIT(25.4,#7).
            value = re.search(r"(?:_MEASURE|_WITH_UNIT)\s*\(\s*([-+\d.Ee]+)\s*[,)]", body)
            if "MEASURE_WITH_UNIT" not in body or not value:
                continue
            for base in self.references[measure]:
                si = re.search(r"SI_UNIT\s*\(\s*([^,]*?)\s*,", self.entities.get(base, ""))
                if si and si[1] in _PREFIXES:
                    return float(value[1]) * _PREFIXES[si[1]]
                inner = self._factor(base, deep + 1) if base in self.entities else None
                if inner is not None:
                    return float(value[1]) * inner
        return None

    @cached_property
    def whole_faces(self) -> list[int]:
        """Faces without missing entities."""
        return [n for n in self.faces if not self.missing(n)]

    @cached_property
    def hurt(self) -> set[int]:
        """Entities that depend, directly or indirectly, on missing ones."""
        users: dict[int, list[int]] = {}
        for n, needs in self.references.items():
            for m in needs:
                users.setdefault(m, []).append(n)
        open_ = [m for m in users if m not in self.references]
        found: set[int] = set()
        while open_:
            for n in users.get(open_.pop(), ()):
                if n not in found:
                    found.add(n)
                    open_.append(n)
        return found

    def sound(self) -> StepText:
        """The file without the entities that depend on missing ones."""
        if not self.hurt:
            return self

        def kept(found: re.Match[str]) -> str:
            return "" if int(found[1]) in self.hurt else found[0]

        pattern = rf"#(\d+)\s*=\s*(?:{_STRING}|[^;'])*;"
        return StepText(re.sub(pattern, kept, self.text), list(self.remarks), dict(self.names))

    def only_faces(self, numbers: list[int] | None = None) -> StepText:
        """A file of the complete faces as one shell, since their own shells may be lost.

        Parameters
        ----------
        numbers
            The faces that are wanted; None for all.
        """
        remarks = list(self.remarks)
        whole = [n for n in self.whole_faces if numbers is None or n in numbers]
        last = max(self.entities)
        contexts = [
            n
            for n, b in self.entities.items()
            if "GLOBAL_UNIT_ASSIGNED_CONTEXT" in b and not self.missing(n)
        ]
        roots = "SHAPE_DEFINITION_REPRESENTATION|CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"
        kept, placed = re.subn(rf"#\d+\s*=\s*(?:{roots})\s*\([^;]*;", "", self.text)
        if placed > 1 or any("ITEM_DEFINED_TRANSF" in b for b in self.entities.values()):
            remarks.append("parts are where they were drawn: positions in assemblies are lost")
        if contexts:
            units = StepText(self.text)
            units._look_at_units()
            remarks += [remark for remark in units.remarks if remark not in remarks]
        else:
            remarks.append(f"the file names no unit of length; {_TAKEN['LENGTH_UNIT']}")
        shell = ",".join(f"#{n}" for n in whole)
        n = last
        added = [
            "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))",
            "(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))",
            "(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())",
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{n + 1},#{n + 2},"
            f"#{n + 3}))REPRESENTATION_CONTEXT('','3D'))",
            f"OPEN_SHELL('',({shell}))",
            f"SHELL_BASED_SURFACE_MODEL('',(#{n + 5}))",
            f"MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{n + 6}),"
            f"#{contexts[0] if contexts else n + 4})",
            "APPLICATION_CONTEXT('')",
            f"PRODUCT_CONTEXT('',#{n + 8},'mechanical')",
            f"PRODUCT('','','',(#{n + 9}))",
            f"PRODUCT_DEFINITION_FORMATION('','',#{n + 10})",
            f"PRODUCT_DEFINITION_CONTEXT('',#{n + 8},'design')",
            f"PRODUCT_DEFINITION('','',#{n + 11},#{n + 12})",
            f"PRODUCT_DEFINITION_SHAPE('','',#{n + 13})",
            f"SHAPE_DEFINITION_REPRESENTATION(#{n + 14},#{n + 7})",
        ]
        tail = "".join(f"#{n + k + 1}={body};\n" for k, body in enumerate(added))
        end = kept.rindex("ENDSEC")
        names = {n: name for n, name in self.names.items() if n in whole}
        return StepText(kept[:end] + tail + kept[end:], remarks, names)

    def _mark(self) -> None:
        """Names the faces by their numbers, so that faces dropped by OCCT can be identified."""

        def marked(found: re.Match[str]) -> str:
            number = int(found[2])
            self.names[number] = _letters(found[3][1:-1])
            return f"{found[1]}'#{number}'"

        pattern = rf"(#(\d+)\s*=\s*(?:{'|'.join(_FACES)})\s*\(\s*)({_STRING})"
        self.text = re.sub(pattern, marked, self.text)


_DOCUMENT = re.compile(r"(?<!\w)DOCUMENT_FILE\s*\(")

_DEEPEST = 8
"""Units that others are stated by, one by the next."""

_MOST = 20
"""Remarks of one kind that are written out."""

_END = "ENDSEC;\nEND-ISO-10303-21;\n"


def _no_comment(found: re.Match[str]) -> str:
    return found[1] or " "


def _kind(body: str) -> str:
    found = re.match(r"\w+", body)
    return found[0] if found else ""


def _few(numbers: list[int]) -> str:
    return ", ".join(f"#{n}" for n in numbers[:5]) + (", ..." if len(numbers) > 5 else "")


def _ended(text: str) -> str:
    """The complete statements of a truncated file, with an end section."""
    last = 0
    # A string that the cut leaves open holds no end of a statement.
    for token in re.finditer(r"'(?:[^']|'')*(?:'|\Z)|;", text):
        if token[0] == ";":
            last = token.end()
    kept = text[:last].rstrip()
    if re.search(r"\bDATA\s*;", kept) and kept.endswith("ENDSEC;"):
        kept = kept.removesuffix("ENDSEC;")
    return kept + "\n" + _END


def _letters(words: str) -> str:
    """A decoded string of Part 21."""

    def wide(found: re.Match[str]) -> str:
        size = 4 if found[1] == "2" else 8
        codes = [found[2][k : k + size] for k in range(0, len(found[2]), size)]
        try:
            return "".join(chr(int(code, 16)) for code in codes)
        except (ValueError, OverflowError):
            return "?"

    words = re.sub(r"\\X([24])\\([0-9A-Fa-f]*)\\X0\\", wide, words)
    words = re.sub(r"\\X\\([0-9A-Fa-f]{2})", lambda m: chr(int(m[1], 16)), words)
    words = re.sub(r"\\S\\(.)", lambda m: chr(ord(m[1]) + 128), words)
    return words.replace("''", "'").replace("\\\\", "\\")
