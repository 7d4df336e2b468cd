"""Structured mutants of STEP and IGES files: entities, references, numbers and flags are changed.

The grammar of the file stays, so that the faults reach what reads the shapes.
"""

from __future__ import annotations

import random
import re
import warnings
from pathlib import Path

NUMBERS = (
    "0.", "-1.", "1.", "1.E-7", "1.E-12", "1.E7", "-1.E7", "1.E30", "0.5", "3.1415926535897931",
    "1.E400", "-0.",
)  # fmt: skip

#: Kinds of entities of STEP that may stand for one another.
ALIKE = (
    ("PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "SPHERICAL_SURFACE", "TOROIDAL_SURFACE"),
    ("LINE", "CIRCLE", "ELLIPSE"),
    ("FACE_BOUND", "FACE_OUTER_BOUND"),
    ("CLOSED_SHELL", "OPEN_SHELL"),
    ("MANIFOLD_SOLID_BREP", "FACETED_BREP", "SHELL_BASED_SURFACE_MODEL"),
    ("DIRECTION", "CARTESIAN_POINT", "VECTOR"),
    ("EDGE_CURVE", "ORIENTED_EDGE"),
)

_TURNED = {".T.": ".F.", ".F.": ".T."}

MODELS = {
    "box": """Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 2, 0}, {1, 2, 0}); RuledSurf low(a, b);
        Line c({0, 0, 3}, {1, 0, 3}); Line d({0, 2, 3}, {1, 2, 3}); RuledSurf high(d, c);
        RuledSurf front(c, a); RuledSurf back(b, d);""",
    "body": """AbsPoint O(0, 0, 0); Line z({0, 0, -2}, {0, 0, 2});
        set block = cuboid({-1, -1, -1}, {1, 1, 1});
        set s = block - set(cylinder(z, 0.5)) | set(sphere({1, 0, 0}, 0.4));
        SetBody b(s, {-2, -2, -2}, {2, 2, 2}, depth = 4);""",
    "curved": """BCurve a({{0, 0, 0}, {1, 0, 1}, {2, 0, 0}});
        BCurve b({{0, 2, 0}, {1, 3, 1}, {2, 2, 1}});
        RuledSurf s(a, b); AbsMagnet m1(s, 0.2, 0.2); AbsMagnet m2(s, 0.8, 0.3);
        AbsMagnet m3(s, 0.5, 0.8); LineSnake k1(m1, m2); LineSnake k2(m2, m3); LineSnake k3(m3, m1);
        TrimSurf t(s, {k1, k2, k3}); Line p({0, 0, 5}, {0, 1, 5}); RevSurf r(a, p);""",
}


def seeds() -> dict[str, list[bytes]]:
    """STEP and IGES files of a box, of a body of sets and of trimmed and round faces."""
    import moldloft

    found: dict[str, list[bytes]] = {"step": [], "iges": []}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, text in MODELS.items():
            model = moldloft.loads(text)
            for ending, files in found.items():
                try:
                    files += model.encoded(ending, name).values()
                except moldloft.Error:
                    # Triangles are not of IGES.
                    continue
    assert all(found.values())
    return found


def step(rng: random.Random, data: bytes) -> bytes:
    """A STEP file with some of its entities changed."""
    text = data.decode("latin-1")
    head, mark, rest = text.partition("DATA;\n")
    lines = rest.split("\n")
    rows = [k for k, line in enumerate(lines) if line.startswith("#")]
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        k = rng.choice(rows)
        line = lines[k]
        match rng.randrange(10):
            case 0:
                lines[k] = ""
            case 1 | 2:
                lines[k] = _one(
                    rng, r"(?<=[(,])#\d+", line, lambda _: f"#{_number(rng, lines, rows)}"
                )
            case 3 | 4:
                lines[k] = _one(
                    rng, r"-?\d+\.\d*(?:E[-+]?\d+)?", line, lambda _: rng.choice(NUMBERS)
                )
            case 5:
                lines[k] = _one(rng, r"\.[TF]\.", line, lambda m: _TURNED[m[0]])
            case 6:
                kinds = [g for g in ALIKE if any(f"={word}(" in line for word in g)]
                if kinds:
                    word = next(w for w in kinds[0] if f"={w}(" in line)
                    lines[k] = line.replace(f"={word}(", f"={rng.choice(kinds[0])}(")
            case 7:
                # An item of a list twice, or left out.
                lines[k] = _one(rng, r"#\d+,", line, lambda m: m[0] * rng.choice((0, 2, 2, 50)))
            case 8:
                # The content of another entity of its kind.
                kind = line.partition("=")[2].partition("(")[0]
                others = [j for j in rows if f"={kind}(" in lines[j]]
                if others:
                    lines[k] = (
                        f"{line.partition('=')[0]}={lines[rng.choice(others)].partition('=')[2]}"
                    )
            case _:
                # Degrees and multiplicities.
                lines[k] = _one(
                    rng,
                    r"(?<=[(,])\d+(?=[,)])",
                    line,
                    lambda _: str(rng.choice((0, 1, 2, 9, 10**6))),
                )
    return (head + mark + "\n".join(lines)).encode("latin-1")


def _number(rng: random.Random, lines: list[str], rows: list[int]) -> str:
    return lines[rng.choice(rows)].partition("=")[0].removeprefix("#").strip() or "1"


def _one(rng: random.Random, pattern: str, line: str, by: object) -> str:
    """The line with one of its matches changed."""
    assert callable(by)
    matches = list(re.finditer(pattern, line))
    if not matches:
        return line
    found = rng.choice(matches)
    return line[: found.start()] + by(found) + line[found.end() :]


def iges(rng: random.Random, data: bytes) -> bytes:
    """An IGES file with some of its parameters or of its directory changed."""
    lines = data.decode("latin-1").split("\n")
    parts = {c: [k for k, line in enumerate(lines) if line[72:73] == c] for c in "DPG"}
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        section = rng.choice("DPPPPG")
        if not parts[section]:
            continue
        k = rng.choice(parts[section])
        line = lines[k]
        width = 72 if section == "G" else 64 if section == "P" else 72
        body, tail = line[:width], line[width:]
        if section == "D":
            column = 8 * rng.randrange(9)
            value = rng.choice(("0", "1", "-1", "7", "128", "142", "144", "999999", "x"))
            body = body[:column] + value.rjust(8) + body[column + 8 :]
        else:
            word = rng.choice((*NUMBERS, "3", "0", "-7", "999999")).replace("E", rng.choice("ED"))
            body = _one(rng, r"(?<=,)[-\d.ED+]+(?=[,;])", body, lambda _, word=word: word)
        lines[k] = body[:width].ljust(width) + tail
    return "\n".join(lines).encode("latin-1")


MUTATED = {"step": step, "iges": iges}


def mutant(rng: random.Random, files: dict[str, list[bytes]], folder: Path) -> Path:
    """A mutant of one of the files, in a folder."""
    ending = rng.choice(("step", "step", "iges"))
    path = folder / f"mutant.{ending}"
    path.write_bytes(MUTATED[ending](rng, rng.choice(files[ending])))
    return path
