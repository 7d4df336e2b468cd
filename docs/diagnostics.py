"""Writes docs/diagnostics.md anew: `python docs/diagnostics.py`.

The programs are in the page itself, the meanings in `moldloft.explanations`; the messages are those that
the programs print. For a new diagnostic write a section with a program, and run this for the rest. The
site has a page for each section.
"""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import moldloft
from moldloft.explanations import EXPLANATIONS

PAGE = Path(__file__).with_suffix(".md")

HEAD = """# Diagnostics

Find the meaning and remedy of a message by its id, such as `wrong-class` in `error[wrong-class]`, with a program that raises it and the
printed message. Ids are stable, wording may improve. `moldloft doc wrong-class` prints meaning and remedy in a terminal, and
`moldloft check --json` prints messages as data.

An error blocks only objects that depend on it; warnings and notes do not change results. The programs are run by
`tests/python/house/test_diagnostics_page.py`.
"""

#: Diagnostics without a program: they need an interrupt, an internal error, a rare failure of an iteration, derivatives, or the workbench.
WITHOUT = {
    "accuracy-not-reached",
    "assumed-unit",
    "blanked",
    "border-not-joined",
    "cancelled",
    "cannot-add",
    "coarse-panels",
    "diverged",
    "empty-list",
    "engine-ended",
    "no-outlines",
    "units-differ",
    "faces-apart",
    "faces-tangled",
    "folded-surface",
    "internal-error",
    "no-derivative",
    "no-distance",
    "no-mesh",
    "no-model",
    "no-parameter",
    "no-picture",
    "left-handed",
    "no-body",
    "no-curvature",
    "no-grid",
    "no-plane",
    "no-reverse",
    "no-run",
    "no-text",
    "no-weights",
    "not-faired",
    "not-fitted",
    "not-nested",
    "other-edge",
    "out-of-memory",
    "part-not-named",
    "rail-singular",
    "rough-volume",
    "search-unfinished",
    "sketch",
    "sketch-invalid",
    "start-failed",
    "thin-box",
    "undecided-cells",
    "too-many-triangles",
    "unknown-field",
    "unknown-format",
    "unknown-literal",
}

SECTION = re.compile(
    r"^## (\S+)\n\n.*?(?:```(sdl|ms2|python)\n(.*?)\n```.*?)?(?=^## |\Z)", re.M | re.S
)


def examples() -> dict[str, tuple[str, str]]:
    """The programs of the page: language and text of each diagnostic's."""
    found = SECTION.findall(PAGE.read_text(encoding="utf-8"))
    return {name: (language, text) for name, language, text in found if text}


@contextlib.contextmanager
def _elsewhere() -> Iterator[None]:
    here, before = Path.cwd(), moldloft.limits()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        # Messages about memory are the same on every machine.
        moldloft.limits(memory="4G")
        try:
            yield
        finally:
            os.chdir(here)
            moldloft.limits(**before._asdict())


def raised(language: str, text: str) -> list[tuple[str, str]]:
    """Ids and messages that a program of the page raises, without its folder."""
    with _elsewhere():
        folder = str(Path.cwd()) + os.sep
        return [(d.id, str(d).rstrip().replace(folder, "")) for d in _diagnostics(language, text)]


def _diagnostics(language: str, text: str) -> list[Any]:
    try:
        if language == "python":
            names: dict[str, Any] = {}
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                exec(compile(text, "example.py", "exec"), names)
            return list(names.get("found", ()))
        model = moldloft.loads(text, name="model." + language, strict=False)
        found = list(model.diagnostics)
        return found if model.has_errors else found + list(model.junctions())
    except moldloft.Error as error:
        return list(error.diagnostics)


def section(name: str, language: str, text: str) -> str:
    """The section of a diagnostic."""
    printed = dict(reversed(raised(language, text))).get(name)
    if printed is None:
        raise SystemExit(f"the program of {name} does not raise it")
    return f"\n## {name}\n\n{EXPLANATIONS[name]}\n\n```{language}\n{text}\n```\n\n```text\n{printed}\n```\n"


def page() -> str:
    """The page."""
    known = examples()
    parts = [HEAD]
    for name in sorted(EXPLANATIONS):
        if name in known:
            parts.append(section(name, *known[name]))
        else:
            parts.append(f"\n## {name}\n\n{EXPLANATIONS[name]}\n")
    return "".join(parts)


if __name__ == "__main__":
    text = page()
    PAGE.write_text(text, encoding="utf-8")
    print(f"{len(EXPLANATIONS)} diagnostics, {text.count('```text')} with a program")
