"""Units of a model, and conversion of its numbers.

>>> units = Units.parse("ft lb")
>>> units.of("volume"), units.of("displacement"), units.of("heel")
('ft³', 'lb', 'deg')
>>> round(units.water("salt"), 4)
63.9887
>>> round(units.factor("volume", Units.parse("m kg")), 12)
0.028316846592
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from moldloft.arguments import explain
from moldloft.errors import Error

__all__ = ["ANGLES", "DIMENSIONS", "WATERS", "Units", "header", "shown"]

_LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0}
_LENGTHS |= {"ft": 0.3048, "in": 0.0254, "yd": 0.9144}
_MASSES = {"kg": 1.0, "t": 1000.0, "g": 0.001}
_MASSES |= {"lb": 0.45359237, "slug": 14.593902937206364, "LT": 1016.0469088}
_FORCES = {"N": 1.0, "kN": 1e3, "MN": 1e6}
_FORCES |= {"lbf": 4.4482216152605, "kgf": 9.80665, "tf": 9806.65}
_ANGLES = {"deg": math.pi / 180, "rad": 1.0}
_TABLES = {"length": _LENGTHS, "mass": _MASSES, "force": _FORCES, "angle": _ANGLES}

WATERS = {"salt": 1025.0, "fresh": 1000.0}
"""Densities of water by name, in kg/m³ (statutory values)."""

_POWERS = {1: "", 2: "²", 3: "³", 4: "⁴"}

DIMENSIONS: dict[str, tuple[int, int, int]] = {
    **dict.fromkeys(
        ("level", "draft", "lcb", "tcb", "vcb", "lcf", "tcf", "kb", "bmt", "bml", "kmt", "kml"),
        (1, 0, 0),
    ),
    **dict.fromkeys(
        ("waterline_low_x", "waterline_high_x", "waterline_length", "waterline_beam", "freeboard"),
        (1, 0, 0),
    ),
    **dict.fromkeys(
        ("draft_low_x", "draft_mid", "draft_high_x", "gmt", "gml", "gz", "trim_arm", "kn"),
        (1, 0, 0),
    ),
    **dict.fromkeys(("x", "y", "z", "station", "height"), (1, 0, 0)),
    **dict.fromkeys(("wetted_area", "waterplane_area", "midship_area", "area"), (2, 0, 0)),
    "volume": (3, 0, 0),
    "moment_of_area": (3, 0, 0),
    **dict.fromkeys(("waterplane_it", "waterplane_il", "waterplane_product"), (4, 0, 0)),
    "displacement": (0, 1, 0),
    "mass": (0, 1, 0),
    "tpc": (0, 1, 0),
    "mtc": (1, 1, 0),
    "weight": (0, 0, 1),
    "righting_moment": (1, 0, 1),
}
"""Powers of length, mass and force in each figure; other figures are dimensionless."""

ANGLES = ("trim", "heel")
"""Figures that are angles: in radians in Python, in degrees in tables and files."""


@dataclass(frozen=True)
class Units:
    """Units by their words; empty if not stated."""

    length: str = ""
    mass: str = ""
    force: str = ""
    angle: str = "deg"

    @classmethod
    def parse(cls, text: str) -> Units:
        """The units of a text such as ``m t kN``, at most one per dimension.

        Parameters
        ----------
        text
            The units, with blanks between.

        Returns
        -------
        Units
            Unnamed units are empty.
        """
        found: dict[str, str] = {}
        for word in text.replace(",", " ").split():
            if word in ("s", "sec"):
                continue
            names = {unit.lower(): unit for table in _TABLES.values() for unit in table}
            names |= {unit: unit for table in _TABLES.values() for unit in table}
            unit = names.get(word) or names.get(word.lower())
            if unit is None:
                known = ", ".join(u for table in _TABLES.values() for u in table)
                raise Error(f"`{word}` is not a unit; expected one of: {known}")
            dimension = next(name for name, table in _TABLES.items() if unit in table)
            if dimension in found:
                raise Error(f"two units of {dimension}: {found[dimension]} and {unit}")
            found[dimension] = unit
        return cls(**found)

    @property
    def metres(self) -> float:
        """The unit of length in metres."""
        if not self.length:
            raise Error(
                "the model states no unit of length\n"
                'help: Model info(units = "m t"); states length and mass'
            )
        return _LENGTHS[self.length]

    @property
    def kilograms(self) -> float:
        """The unit of mass in kilograms."""
        if not self.mass:
            raise Error(
                'the model states no unit of mass\nhelp: Model info(units = "m t"); states it'
            )
        return _MASSES[self.mass]

    def complete(self) -> Units:
        """The units, with mass and force added if the length is known.

        Kg and N for metric lengths, lb and lbf for feet, inches and yards.

        Returns
        -------
        Units
            A new one; this stays as it is.
        """
        if not self.length:
            return self
        metric = self.length in ("m", "cm", "mm", "km")
        mass = self.mass or ("kg" if metric else "lb")
        force = self.force or ("N" if metric else "lbf")
        return Units(self.length, mass, force, self.angle)

    def force_scale(self) -> float:
        """Mass times acceleration in the unit of force; 1 if a unit is missing.

        Returns
        -------
        float
            A factor.

        Examples
        --------
        >>> Units.parse("m t kN").force_scale(), Units.parse("m t N").force_scale()
        (1.0, 1000.0)
        """
        if not (self.length and self.mass and self.force):
            return 1.0
        return self.kilograms * self.metres / _FORCES[self.force]

    def water(self, density: float | str | None) -> float | None:
        """A density in these units: of a name in :data:`WATERS`, or the number itself.

        Parameters
        ----------
        density
            ``"salt"``, ``"fresh"``, or mass per volume in the model's units.

        Returns
        -------
        float or None
            Mass per volume; None if not given.
        """
        if density is None:
            return None
        if isinstance(density, str):
            if density not in WATERS:
                raise Error(
                    f"unknown water `{density}`; expected {', '.join(WATERS)}, or a density"
                )
            units = self.complete()
            return WATERS[density] * units.metres**3 / units.kilograms
        if not (math.isfinite(density) and density > 0):
            raise Error(f"a density is a positive number, not {density}")
        return float(density)

    def of(self, figure: str) -> str:
        """The unit of a figure as text; empty if it is dimensionless or not stated.

        Parameters
        ----------
        figure
            The name of a figure, such as ``"volume"``.

        Returns
        -------
        str
            Such as ``"m³"``.
        """
        if figure in ANGLES:
            return self.angle
        length, mass, force = DIMENSIONS.get(figure, (0, 0, 0))
        words = []
        if force:
            words.append(self.force)
        if mass:
            words.append(self.mass)
        if length:
            words.append(self.length + _POWERS[length] if self.length else "")
        return "·".join(words) if all(words) else ""

    def factor(self, figure: str, to: Units) -> float:
        """Conversion factor of a figure to other units.

        Parameters
        ----------
        figure
            The name of a figure, such as ``"volume"``.
        to
            The other units.

        Returns
        -------
        float
            1 where the dimension is not stated in both.
        """
        length, mass, force = DIMENSIONS.get(figure, (0, 0, 0))
        scale = 1.0
        for power, table, a, b, what in (
            (length, _LENGTHS, self.length, to.length, "length"),
            (mass, _MASSES, self.mass, to.mass, "mass"),
            (force, _FORCES, self.force, to.force, "force"),
        ):
            if not power or not b:
                continue
            if not a:
                raise Error(f"the model states no unit of {what}, so {figure} cannot be converted")
            scale *= (table[a] / table[b]) ** power
        return scale


explain(globals())


def shown(name: str, value: Any) -> Any:
    """A figure as in tables and files: angles in degrees.

    Parameters
    ----------
    name
        Name of the figure, such as ``heel``.
    value
        Its value; angles in radians.

    Returns
    -------
    float, str or None
        Figures that are not angles are unchanged.

    Examples
    --------
    >>> shown("volume", 2.0), round(shown("heel", math.pi), 9), shown("trim", None)
    (2.0, 180.0, None)
    """
    return math.degrees(value) if name in ANGLES and value is not None else value


def header(name: str, units: Units) -> str:
    """The name of a figure with its unit, for headers of tables.

    Parameters
    ----------
    name
        Name of the figure.
    units
        Units of the figures.

    Returns
    -------
    str
        Such as ``"volume [m³]"``.

    Examples
    --------
    >>> header("volume", Units.parse("ft lb")), header("cb", Units())
    ('volume [ft³]', 'cb')
    """
    unit = units.of(name)
    return f"{name} [{unit}]" if unit else name
