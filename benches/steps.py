"""Processor time of a step, for each function of the language beside a plain loop.

Run with `python benches/steps.py [NAME ...]`. A loop calls the function with the arguments of its
example, the first number a little different each time, until the limit of steps or of time ends it.
A step is to take at most 20 times that of a plain loop; a call that has no such end is not counted.
"""

from __future__ import annotations

import re
import sys
import time

import moldloft
from moldloft.language import reference

#: Steps and seconds of a loop.
STEPS, SECONDS = 20_000, 4.0

#: The types of a result to try, by the class of the function.
TYPES = {
    "number": ["float"],
    "vector": ["vector"],
    "text": ["string"],
    "field": ["field"],
    "set": ["set"],
    "farray": ["farray"],
    "curve or surface": ["curve", "surface"],
}
ALL_TYPES = ["float", "farray", "vector", "curve", "surface", "pcurve", "psurface", "set", "field"]


def call_in(row: dict[str, object]) -> tuple[str, str] | None:
    """What comes before the first call of the function in its example, and the call."""
    text, name = str(row["example"]), str(row["name"])
    found = re.search(rf"\b{name}\(", text)
    if found is None:
        return None
    depth = 0
    for at in range(found.end() - 1, len(text)):
        depth += (text[at] in "([{") - (text[at] in ")]}")
        if depth == 0:
            before = text[: text.rfind(";", 0, found.start()) + 1]
            return before, text[found.start() : at + 1]
    return None


def varied(call: str) -> str:
    """The call with its first number a function of the loop's variable."""
    number = re.search(r"(?<![\w.\"])\d+(\.\d+)?(?![\w.\"])", call)
    if number is None or '"' in call[: number.start()]:
        return call
    return f"{call[: number.start()]}({number.group()} + k * 1e-7){call[number.end() :]}"


def seconds_of(text: str) -> tuple[float, str]:
    """Processor time until a limit ends the program, and the id of that limit."""
    start = time.process_time()
    try:
        moldloft.loads(text)
    except moldloft.Error as error:
        limit = re.search(r"too-many-steps|out-of-time", str(error))
        return time.process_time() - start, limit.group() if limit else ""
    return time.process_time() - start, ""


def main() -> None:
    moldloft.limits(steps=STEPS, seconds=SECONDS)
    # The least of some: the first runs of a process are slower.
    plain = min(seconds_of('string q; for (k = 1:1e6) { q = "a"; }')[0] / STEPS for _ in range(5))
    print(f"plain loop: {plain * 1e9:.0f} ns a step")
    ratios: list[tuple[float, str, str]] = []
    for row in reference():
        name = str(row["name"])
        found = call_in(row)
        if row["is_kind"] or (sys.argv[1:] and name not in sys.argv[1:]) or found is None:
            continue
        before, call = found
        for body in dict.fromkeys([varied(call), call]):
            for kind in [*TYPES.get(str(row["class"]), []), *ALL_TYPES]:
                text = f"{before} {kind} q; for (k = 1:1e6) {{ q = {body}; }}"
                taken, limit = seconds_of(text)
                if limit:
                    break
            if limit:
                more = " or more: out of time" if limit == "out-of-time" else ""
                ratios.append((taken / STEPS / plain, name, more))
                break
    for ratio, name, more in sorted(ratios, reverse=True):
        print(f"{ratio:8.1f} {name}{more}")
    print(f"{len(ratios)} functions, {sum(r > 20 for r, _, _ in ratios)} beyond 20")


if __name__ == "__main__":
    main()
