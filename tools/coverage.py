"""Coverage of lines by crate, as a table, from what `cargo llvm-cov --lcov` writes.

    python tools/coverage.py lcov.info [--least 80]

The status is 1 where a crate has less. `registry-derive` runs while others are compiled and is not
counted there.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

#: Crates whose lines run where nothing counts them.
UNCOUNTED = {"registry-derive"}


def by_crate(text: str) -> dict[str, tuple[int, int]]:
    """Lines that ran and all lines, by crate."""
    found: dict[str, tuple[int, int]] = {}
    for record in text.split("end_of_record"):
        source = re.search(r"^SF:.*\bcrates/([^/]+)/src/", record, re.M)
        if source:
            ran, all_ = (
                int(re.search(rf"^{name}:(\d+)", record, re.M)[1])  # type: ignore[index]
                for name in ("LH", "LF")
            )
            before = found.get(source[1], (0, 0))
            found[source[1]] = (before[0] + ran, before[1] + all_)
    return found


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--least", type=float, default=80.0)
    options = parser.parse_args()
    found = by_crate(options.file.read_text(encoding="utf-8"))
    print("| crate | lines | covered |\n| --- | ---: | ---: |")
    low = []
    for name, (ran, all_) in sorted(found.items()):
        percent = 100 * ran / max(all_, 1)
        print(f"| `{name}` | {all_} | {percent:.1f} % |")
        if percent < options.least and name not in UNCOUNTED:
            low.append(f"{name} {percent:.1f} %")
    if low:
        print(f"below {options.least:g} %: {', '.join(low)}", file=sys.stderr)
    return 1 if low or not found else 0


if __name__ == "__main__":
    sys.exit(main())
