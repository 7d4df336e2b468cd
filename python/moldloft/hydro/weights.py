"""Weights of a model: a list by group, with its sum."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from moldloft.arguments import explain
from moldloft.errors import Error
from moldloft.units import Units

__all__ = ["Weight", "WeightTable"]


@dataclass(frozen=True)
class Weight:
    """A weight; see the kind ``Weight``."""

    name: str
    """Its name in the model."""
    group: str
    """The group it is listed in; may be empty."""
    mass: float
    """The mass, with its margin."""
    margin: float
    """The margin in percent."""
    centre: tuple[float, float, float]
    """The centre."""
    status: str
    """``estimated``, ``calculated`` or ``weighed``."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", tuple(self.centre))


class WeightTable:
    """Weights by group, in the order of the first occurrence of each group."""

    def __init__(self, rows: Sequence[Weight], units: Units) -> None:
        groups = list(dict.fromkeys(row.group for row in rows))
        self.rows = tuple(sorted(rows, key=lambda row: groups.index(row.group)))
        self.units = units

    @property
    def mass(self) -> float:
        """The mass of all."""
        return sum(row.mass for row in self.rows)

    @property
    def centre(self) -> tuple[float, float, float]:
        """The centre of gravity."""
        return _centre(self.rows)

    @property
    def groups(self) -> dict[str, tuple[float, tuple[float, float, float]]]:
        """Mass and centre of each group."""
        found: dict[str, list[Weight]] = {}
        for row in self.rows:
            found.setdefault(row.group, []).append(row)
        return {name: (sum(r.mass for r in rows), _centre(rows)) for name, rows in found.items()}

    def as_list(self) -> list[dict[str, Any]]:
        """The rows as dictionaries."""
        return [
            {
                "name": row.name,
                "group": row.group,
                "mass": row.mass,
                "x": row.centre[0],
                "y": row.centre[1],
                "z": row.centre[2],
                "margin": row.margin,
                "status": row.status,
            }
            for row in self.rows
        ]

    def csv(self) -> str:
        """The rows as comma-separated text (RFC 4180), a header with units first."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\r\n")
        names = ["name", "group", "mass", "x", "y", "z", "margin", "status"]
        units = {"margin": "%", **{n: self.units.of(n) for n in ("mass", "x", "y", "z")}}
        writer.writerow([f"{n} [{units[n]}]" if units.get(n) else n for n in names])
        writer.writerows([[row[n] for n in names] for row in self.as_list()])
        return text.getvalue()

    def _repr_html_(self) -> str:
        from moldloft.display import weights_html

        return weights_html(self)

    def __str__(self) -> str:
        from moldloft.text_table import table

        names = ("mass", "x", "y", "z")
        header = ["group", "weight"]
        header += [f"{n} [{self.units.of(n)}]" if self.units.of(n) else n for n in names]
        header += ["margin [%]", "status"]
        rows = []
        for row in self.rows:
            numbers = [f"{x:.6g}" for x in (row.mass, *row.centre)]
            rows.append([row.group, row.name, *numbers, f"{row.margin:g}", row.status])
        for name, (mass, centre) in self.groups.items():
            if name:
                rows.append([name, "sum", *[f"{x:.6g}" for x in (mass, *centre)], "", ""])
        if self.rows:
            rows.append(["", "all", *[f"{x:.6g}" for x in (self.mass, *self.centre)], "", ""])
        return table(header, rows, left=2)


def _centre(rows: Sequence[Weight]) -> tuple[float, float, float]:
    mass = sum(row.mass for row in rows)
    if not mass:
        raise Error("the weights have no mass, so no centre of gravity")
    x, y, z = (sum(row.mass * row.centre[k] for row in rows) / mass for k in range(3))
    return x, y, z


explain(globals())
