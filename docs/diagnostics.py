"""Writes docs/diagnostics.md: each diagnostic with the shortest program of the corpus that raises it.

`python docs/diagnostics.py`. Programs come from `tests/corpus` and
from EXTRA below; what is printed is what the program prints today.
"""

from __future__ import annotations

import re
import signal
from pathlib import Path

import moldloft

ROOT = Path(__file__).resolve().parents[1]

HEAD = """# Diagnostics

Every message has an id, which stays the same when its wording gets better: `error[wrong-class]`. Here are the ids with a short program
that raises each, and what is printed, with the remedy in its `help`. Made by `docs/diagnostics.py`; each program is run by
`tests/python/test_diagnostics_page.py`.

Errors stop what depends on them and nothing else; warnings and remarks do not change the result. `moldloft check --json` prints the same
facts as data.
"""

EXTRA = [
    "AbsPoint P(1, 2);",
    "AbsPoint P(1, 2, 3); AbsPoint P(1, 2, 4);",
    "AbsPoint P(1, 2, 3); BCurve c(P, degree = 2);",
    "AbsPoint P(1, 2, 3); Line l(P, Q);",
    "AbsPoint P(1, 2, 3, colr = 3);",
    "Lien l(1);",
    "param float a = 12 in [1, 9];",
    "AbsPoint P(0/0, 0, 0);",
    "AbsPoint P(sqrt(-1), 0, 0);",
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); BCurve c({A, B}, degree = 5);",
    'Model info(units = "furlong");',
    "curve a[3]; curve b[4]; a = b;",
    "farray a[3]; print a[4];",
    'float a = 1; a = "text";',
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0);\n"
    "Line a(A, B); Line b(C, D); Line c(B, A);\n"
    'RuledSurf s(a, b); IntSnake i(s, "x=2");',
    'load "nothing.sdl";',
    "foreach (x in {1, 2, 3}) print x;",
    'assert 1 > 2, "one is not more than two";',
    "set a = set(sphere({0, 0, 0}, -1));",
    "AbsPoint A(0, 0, 0); Line l(A, A); RevSurf r(l, l);",
    "print nothing;",
    "AbsPoint A(0, 0, 0); AbsBead b(A, 0.5);",
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); Line l(A, B, divisions = -1);",
]


def programs() -> list[str]:
    """All programs that may raise something."""
    found = list(EXTRA)
    for path in sorted((ROOT / "tests" / "corpus").rglob("*.sdl")):
        for case in re.split(r"^#### .*\n", path.read_text(encoding="utf-8"), flags=re.M)[1:]:
            lines = [line for line in case.splitlines() if not re.match(r"#[>=<+?] ?", line)]
            found.append("\n".join(lines).strip())
    return sorted(set(found), key=lambda text: (len(text), text))


def examples() -> dict[str, tuple[str, str]]:
    """For each id the shortest program, and what is printed of it."""
    found: dict[str, tuple[str, str]] = {}
    for text in programs():
        if len(text) > 600 or not text or ("while" in text and "while (1)" not in text):
            continue
        model = moldloft.loads(text, name="model.sdl", strict=False)
        for diagnostic in model.diagnostics:
            if diagnostic.id not in found and "blocked" not in diagnostic.id:
                found[diagnostic.id] = (text, str(diagnostic).rstrip())
    return found


def page(found: dict[str, tuple[str, str]]) -> str:
    """The page."""
    parts = [HEAD]
    for name in sorted(found):
        text, printed = found[name]
        parts.append(f"\n## {name}\n\n```sdl\n{text}\n```\n\n```text\n{printed}\n```\n")
    return "".join(parts)


def _late(*_: object) -> None:
    raise TimeoutError


if __name__ == "__main__":
    signal.signal(signal.SIGALRM, _late)
    made = examples()
    (ROOT / "docs" / "diagnostics.md").write_text(page(made), encoding="utf-8")
    print(f"{len(made)} diagnostics")
