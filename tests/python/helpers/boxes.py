"""Boxes along the axes as panels of six surfaces."""

from __future__ import annotations

from collections.abc import Sequence

CORNERS = {
    "A": "000",
    "B": "100",
    "C": "110",
    "D": "010",
    "E": "001",
    "F": "101",
    "G": "111",
    "H": "011",
}
LINES = ("AB", "DC", "EF", "HG", "AD", "BC", "EH", "FG")
FACES = ("AB DC", "EF HG", "AB EF", "DC HG", "AD EH", "BC FG")


def box(k: int, low: Sequence[float], size: Sequence[float]) -> str:
    """The box of number `k` from a corner, one panel a face; coordinates are sums of the text."""
    rows = []
    for name, far in CORNERS.items():
        at = ", ".join(
            f"{x!r} + {s!r}" if one == "1" else repr(x)
            for x, s, one in zip(low, size, far, strict=True)
        )
        rows.append(f"AbsPoint {name}{k}({at});")
    rows += [f"Line l{p}{q}{k}({p}{k}, {q}{k});" for p, q in LINES]
    for face in FACES:
        first, second = face.split()
        name = first + second
        rows.append(f"RuledSurf {name}{k}(l{first}{k}, l{second}{k}, divisions = {{1, 1}});")
    return "\n".join(rows)
