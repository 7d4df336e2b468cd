"""Two hundred ordinary programs of the corpus against NumPy, SciPy and plain Python.

Each is a task of its own: an algorithm, a formula of engineering, a construction of geometry. The
corpus keeps what they print to the last digit; here it is compared with other people's
implementations of the same.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import moldloft
import wanted_numbers
import wanted_shapes
from wanted import Near

pytest.importorskip("scipy")
CORPUS = Path(__file__).parents[2] / "corpus" / "run"
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?")
MODULES = {"numbers": wanted_numbers, "shapes": wanted_shapes}


def cases() -> list[tuple[str, str, str]]:
    found = []
    for kind in MODULES:
        for part in (CORPUS / f"{kind}.sdl").read_text().split("\n#### ")[1:]:
            name, _, rest = part.partition("\n")
            lines = rest.splitlines()
            # What is printed and said of it stands behind the program.
            text = "\n".join(line for line in lines if not re.match("#[<>+?] ", line))
            found.append((kind, name, text))
    return found


CASES = cases()


def test_there_are_two_hundred_and_all_are_different() -> None:
    assert len(CASES) >= 200
    assert len({name for _, name, _ in CASES}) == len({text for *_, text in CASES}) == len(CASES)


@pytest.mark.parametrize(("kind", "name", "text"), CASES, ids=[name for _, name, _ in CASES])
def test_programs_print_what_others_compute(kind: str, name: str, text: str) -> None:
    model = moldloft.loads(text)
    assert not [d for d in model.diagnostics if d.severity == "error"]
    printed = "\n".join(model.printed)
    want = getattr(MODULES[kind], re.sub(r"\W+", "_", name).strip("_"))()
    # Sums of some hundred terms are rounded in another order by NumPy.
    values, share = (want.values, want.share) if isinstance(want, Near) else (list(want), 1e-14)
    if any(isinstance(value, str) for value in values):
        assert printed.split() == " ".join(values).split()
        return
    found = np.array([float(x) for x in NUMBER.findall(printed)])
    values = np.array([float(x) for x in values])
    assert found.shape == values.shape, (found, values)
    assert (np.abs(found - values) <= share * np.maximum(1, np.abs(values))).all(), (found, values)
