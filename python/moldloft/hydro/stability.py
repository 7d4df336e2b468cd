"""Stability of a loading: righting arms with exact areas, special angles, and criteria of rules.

>>> import math
>>> from moldloft.hydro.stability import Opening
>>> Opening("vent", (1.0, 2.0, 3.0)).height(0.0, 0.0, 0.5)
2.5
"""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft.arguments import explain
from moldloft.errors import Error
from moldloft.storage import read_text
from moldloft.units import Units

if TYPE_CHECKING:
    from moldloft.hydro.hydrostatics import Hydrostatics
    from moldloft.models import Model

__all__ = [
    "Assessment",
    "Check",
    "CrossCurves",
    "Opening",
    "Stability",
    "Wind",
    "cross_curves",
    "rules",
]

_STEP = math.radians(5.0)
_ANGLE_ACCURACY = 1e-11


#: Degrees of heel between which criteria take areas under the curve of righting arms.
_AREAS = ((0, 30), (0, 40), (30, 40))


@dataclass(frozen=True)
class Opening:
    """A downflooding point."""

    name: str
    """Its name in reports."""
    place: tuple[float, float, float]
    """Position in the model's axes."""

    def height(self, heel: float, trim: float, level: float) -> float:
        """The height of the opening above the water.

        Parameters
        ----------
        heel
            Heel, radians; positive sinks what has large y.
        trim
            Trim, radians; positive sinks what has large x.
        level
            Height of the water, in model units.
        """
        normal = _level_axes(heel, trim)[2]
        return _dot(normal, self.place) - level


@dataclass(frozen=True)
class Wind:
    """Wind data of the weather criterion of the 2008 IS Code, in metres."""

    area: float
    """Projected lateral area of the ship and deck cargo above the water, m²."""
    lever: float
    """Height of its centre over the centre of the lateral area under water, or half the draught."""
    bilge: float = 1.0
    """Factor k: 1 for a round bilge without keels, 0.7 for a sharp one; see ``keel_area``."""
    keel_area: float | None = None
    """Area of bilge keels or bar keel, m²: the factor follows from the table of the code."""
    pressure: float = 504.0
    """Wind pressure, Pa."""


def _level_axes(
    heel: float, trim: float
) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    s, c, sf, cf = math.sin(trim), math.cos(trim), math.sin(heel), math.cos(heel)
    return (c, -s * sf, s * cf), (0.0, cf, sf), (-s, -c * sf, c * cf)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


class Stability:
    """The righting arm of a loading as a function of heel; see :meth:`moldloft.Model.stability`.

    Every figure is computed in equilibrium at its heel, without interpolation between heels.
    Angles are in radians. The trim is free at each heel, or fixed if ``free_trim`` is false.
    """

    def __init__(
        self,
        model: Model,
        mass: float,
        cg: Sequence[float],
        *,
        density: float,
        gravity: float | None = None,
        trim: float = 0.0,
        free_trim: bool = True,
        openings: Iterable[Opening] = (),
        accuracy: float = 1e-6,
    ) -> None:
        if len(cg) != 3 or not all(map(math.isfinite, cg)):
            raise Error("a centre of gravity is three finite numbers x, y, z")
        self.mass = float(mass)
        self.cg = (float(cg[0]), float(cg[1]), float(cg[2]))
        self.density = density
        self.trim = trim
        self.free_trim = free_trim
        self.openings = tuple(openings)
        self._model = model
        self._options: dict[str, Any] = {
            "density": density,
            "gravity": gravity,
            "accuracy": accuracy,
        }
        self._rows: dict[float, Hydrostatics] = {}
        self.upright = self.at(0.0)

    def at(self, heel: float) -> Hydrostatics:
        """All figures at a heel, in equilibrium with the heeling moment.

        Parameters
        ----------
        heel
            Heel, radians; positive sinks what has large y.
        """
        heel = float(heel)
        if heel not in self._rows:
            self._compute([heel])
        return self._rows[heel]

    def _compute(self, heels: Sequence[float]) -> None:
        missing = [h for h in dict.fromkeys(map(float, heels)) if h not in self._rows]
        if not missing:
            return
        curve = self._model.righting_curve(
            missing,
            self.mass,
            cg=self.cg,
            trim=self.trim,
            free_trim=self.free_trim,
            **self._options,
        )
        for row in curve.rows:
            if row.status == "not-converged":
                angle = math.degrees(row.heel)
                raise Error(
                    f"at a heel of {angle:.4g} degrees the body finds no rest with this mass"
                )
        self._rows.update(zip(missing, curve.rows, strict=True))

    def gz(self, heel: float) -> float:
        """The righting arm.

        Parameters
        ----------
        heel
            Heel, radians; positive sinks what has large y.
        """
        arm = self.at(heel).gz
        return math.nan if arm is None else arm

    def energy(self, heel: float) -> float:
        """The height of the centre of gravity above the centre of buoyancy.

        Its change is the work of heeling divided by the weight: the area under GZ cos(trim)
        (Moseley's dynamical stability).

        Parameters
        ----------
        heel
            Heel, radians; positive sinks what has large y.
        """
        row = self.at(heel)
        normal = _level_axes(heel, row.trim)[2]
        centre = (row.lcb or 0.0, row.tcb or 0.0, row.vcb or 0.0)
        return _dot(normal, [g - b for g, b in zip(self.cg, centre, strict=True)])

    def area(self, low: float, high: float) -> float:
        """The area under the righting arm between two heels, as a difference of energies.

        NaN if an open edge is immersed before (:meth:`deck_edge`).

        Parameters
        ----------
        low
            The lesser heel, radians.
        high
            The greater heel, radians.
        """
        dry = high <= self._afloat(high)
        return self.energy(high) - self.energy(low) if dry else math.nan

    def slope(self, heel: float) -> float:
        """The exact derivative of the righting arm with respect to heel.

        Parameters
        ----------
        heel
            Heel, radians; positive sinks what has large y.
        """
        row = self.at(heel)
        if row.waterplane_it is None or row.waterplane_il is None or row.volume <= 0:
            return self.gz(heel + 1e-4) - self.gz(heel - 1e-4)
        e = self.energy(heel)
        across = row.waterplane_it / row.volume - e
        along = row.waterplane_il / row.volume - e
        both = (row.waterplane_product or 0.0) / row.volume
        arm = self.gz(heel)
        if not self.free_trim:
            return math.cos(row.trim) * across + math.sin(row.trim) * (row.trim_arm or 0.0)
        stiff = across - both * both / along
        return math.cos(row.trim) * stiff + math.sin(row.trim) * arm * both / along

    def grid(self, low: float, high: float, step: float = _STEP) -> list[float]:
        """Heels from ``low`` to ``high``, at most ``step`` apart, computed in one call.

        Parameters
        ----------
        low
            The first heel, radians.
        high
            The last heel, radians.
        step
            The largest step between heels, radians.
        """
        count = max(1, math.ceil((high - low) / step - 1e-9))
        heels = [low + (high - low) * k / count for k in range(count + 1)]
        self._compute(heels)
        return heels

    @property
    def gmt(self) -> float:
        """The transverse metacentric height, upright."""
        value = self.upright.gmt
        return math.nan if value is None else value

    @property
    def stable(self) -> bool:
        """True if small rotations in heel and trim of the upright body are righted."""
        row = self.upright
        return row.gmt is not None and row.gmt > 0 and row.gml is not None and row.gml > 0

    def loll(self, most: float = math.pi) -> float | None:
        """Angle of loll, the smallest positive heel at which the arm changes to righting.

        ``None`` for a body that is stable upright, or without such a heel up to ``most``.

        Parameters
        ----------
        most
            The largest heel that is searched, radians.
        """
        if self.gmt >= 0:
            return None
        most = self._afloat(most)
        heels = self.grid(0.0, most)
        low = heels[1]
        # A small angle of loll is below the first heel of the grid.
        while self.gz(low) >= 0 and low > 1e-6:
            low /= 4
        if self.gz(low) >= 0:
            return None
        for a, b in pairwise([low, *heels[1:]]):
            if self.gz(a) < 0 <= self.gz(b):
                heel = _root(self.gz, a, b)
                # Upside down the arm vanishes too; rounding may turn its sign there.
                if heel < most - 1e-6 or self.gz(0.999 * most) > 0:
                    return heel
        return None

    def largest(self, most: float = math.pi / 2) -> tuple[float, float]:
        """The heel and the value of the largest righting arm up to ``most``.

        Parameters
        ----------
        most
            The largest heel that is searched, radians.
        """
        heels = self.grid(0.0, self._afloat(most))
        k = max(range(len(heels)), key=lambda k: self.gz(heels[k]))
        low, high = heels[max(k - 1, 0)], heels[min(k + 1, len(heels) - 1)]
        if self.slope(low) > 0 > self.slope(high):
            heel = _root(self.slope, low, high)
            if self.gz(heel) >= self.gz(heels[k]):
                return heel, self.gz(heel)
        return heels[k], self.gz(heels[k])

    def vanishing(self, most: float = math.pi) -> float | None:
        """The angle of vanishing stability: the first heel at which the righting arm becomes zero.

        The arm decreases to zero there, or jumps below zero if the body capsizes over its ends.
        ``None`` if it is never righting, or remains righting up to ``most`` or until an open edge
        is immersed (:meth:`deck_edge`).

        Parameters
        ----------
        most
            The largest heel that is searched, radians.
        """
        start = 0.0 if self.gmt >= 0 else self.loll(most)
        if start is None:
            return None
        most = self._afloat(most)
        heels = [start, *(heel for heel in self.grid(0.0, most) if heel > start)]
        for a, b in pairwise(heels):
            # At rest the arm is zero; from the angle of loll on it rights.
            positive = self.gz(a) > 0 or (a == start and (start > 0 or self.slope(0.0) > 0))
            if positive and self.gz(b) <= 0:
                low = a if a > start else start + min(1e-6, (b - start) / 2)
                return _root(self.gz, low, b) if self.gz(low) > 0 else low
        return None

    def range(self, most: float = math.pi) -> float:
        """The range of positive stability, from upright or from the angle of loll.

        Parameters
        ----------
        most
            The largest heel that is searched, radians.
        """
        start = 0.0 if self.gmt >= 0 else self.loll(most)
        end = self.vanishing(most)
        if start is None or (end is None and self.largest(most)[1] <= 0):
            return 0.0
        return (self._afloat(most) if end is None else end) - start

    def immersed(self, opening: Opening, most: float = math.pi) -> float | None:
        """The smallest positive heel at which an opening reaches the water.

        ``None`` if it stays above the water up to ``most``, as is possible near the centre line.

        Parameters
        ----------
        opening
            The opening.
        most
            The largest heel that is searched, radians.
        """

        def height(heel: float) -> float:
            row = self.at(heel)
            return opening.height(heel, row.trim, row.level)

        heels = self.grid(0.0, self._afloat(most), math.radians(2.0))
        if height(0.0) <= 0:
            return 0.0
        for a, b in pairwise(heels):
            if height(b) <= 0:
                return _root(height, a, b)
        return None

    def flooding(self, most: float = math.pi) -> tuple[float, str] | None:
        """The smallest heel at which an opening or an open edge reaches the water, and its name.

        ``None`` if there is no opening, or no opening is reached.

        Parameters
        ----------
        most
            The largest heel that is searched, radians.
        """
        found = [(self.immersed(o, most), o.name) for o in self.openings]
        found.append((self.deck_edge(most), "open edge"))
        angles = [(angle, name) for angle, name in found if angle is not None]
        return min(angles) if angles else None

    def _afloat(self, most: float) -> float:
        """The largest heel up to ``most`` at which no open edge is immersed."""
        edge = self.deck_edge(most)
        return most if edge is None else edge

    def deck_edge(self, most: float = math.pi / 2) -> float | None:
        """The heel at which the lowest open edge reaches the water; ``None`` for a closed skin.

        Parameters
        ----------
        most
            The largest heel that is searched, radians.
        """
        if self.upright.freeboard is None:
            return None

        def height(heel: float) -> float:
            return self.at(heel).freeboard or 0.0

        # Step by step: far beyond the edge there may be no attitude with this mass.
        count = max(1, math.ceil(most / math.radians(2.0) - 1e-9))
        for a, b in pairwise(most * k / count for k in range(count + 1)):
            if height(a) > 0 >= height(b):
                return _root(height, a, b)
        return None

    def figures(self) -> dict[str, Any]:
        """The main figures of the loading; angles in radians. :meth:`summary` prints them.

        Returns
        -------
        dict
            ``None`` for a heel that is not reached up to pi, such as that of vanishing stability.
        """
        heel, largest = self.largest()
        flood = self.flooding()
        areas = {
            f"area_{low}_{high}": self.area(math.radians(low), math.radians(high))
            for low, high in _AREAS
        }
        return {
            "mass": self.mass,
            "cg": list(self.cg),
            "gmt": self.upright.gmt,
            "gml": self.upright.gml,
            "stable": self.stable,
            "loll": None if self.stable else self.loll(),
            "largest_gz": largest,
            "largest_gz_heel": heel,
            "vanishing": self.vanishing(),
            "range": self.range(),
            **areas,
            "deck_edge": self.deck_edge(),
            "flooding": None if flood is None else {"heel": flood[0], "opening": flood[1]},
        }

    def summary(self) -> str:
        """The main figures of the loading, a line each, with units."""
        row = self.upright
        unit = row.units
        arm = unit.of("gz")

        def line(name: str, text: str) -> str:
            return f"  {name.ljust(34)}{text}"

        def angle(value: float | None, otherwise: str) -> str:
            return otherwise if value is None else f"{math.degrees(value):.4f} deg"

        heel, largest = self.largest()
        flood, edge = self.flooding(), self.deck_edge()
        none = "none up to 180 deg" if edge is None else "none before the open edge is immersed"
        lines = [
            "stability, trim free" if self.free_trim else "stability, trim kept",
            line("mass", f"{self.mass:.7g} {unit.mass}".rstrip()),
            line("centre of gravity", "{:.6g}, {:.6g}, {:.6g}".format(*self.cg)),
            line("GM, transverse and longitudinal", f"{row.gmt:.6g}, {row.gml:.6g} {arm}".rstrip()),
            line("stable upright", "yes" if self.stable else "no"),
        ]
        if not self.stable:
            lines.append(line("angle of loll", angle(self.loll(), "none up to 180 deg")))
        lines += [
            line("largest GZ", f"{largest:.6g} {arm} at {math.degrees(heel):.4f} deg"),
            line("angle of vanishing stability", angle(self.vanishing(), none)),
            line("range", f"{math.degrees(self.range()):.4f} deg"),
        ]
        for low, high in _AREAS:
            area = self.area(math.radians(low), math.radians(high))
            text = f"{area:.6g} {arm}·rad" if arm else f"{area:.6g}"
            text = text if area == area else "the water enters over the open edge before"
            lines.append(line(f"area {low} to {high} deg", text))
        if edge is not None:
            lines.append(line("deck edge immersed", angle(edge, "")))
        if flood is not None:
            lines.append(line("flooding", f"{math.degrees(flood[0]):.4f} deg, {flood[1]}"))
        elif self.openings:
            lines.append(line("flooding", "no opening reaches the water up to 180 deg"))
        return "\n".join(lines)

    def assess(
        self,
        rule: str = "is-code-2008",
        *,
        wind: Wind | None = None,
        deck_edge: float | None = None,
    ) -> Assessment:
        """The criteria of a rule, one row for each clause.

        Parameters
        ----------
        rule
            One of :func:`rules`, or the path of a JSON file of the same form.
        wind
            For a weather criterion; without it the clause is ``data missing``.
        deck_edge
            The heel, in radians, at which the deck edge is immersed; by default that of the lowest
            open edge.
        """
        return _assess(self, rule, wind, deck_edge)


@dataclass(frozen=True)
class CrossCurves:
    """Arms KN over heel for several displaced volumes: GZ = KN - KG sin(heel)."""

    volumes: tuple[float, ...]
    """The displaced volumes."""
    heels: tuple[float, ...]
    """The heels, in radians."""
    kn: tuple[tuple[float, ...], ...]
    """The arms, ``[volume][heel]``, from the upright body's lowest height on the centre line."""
    free_trim: bool
    """True for free trim about the centre of buoyancy of the upright level state."""
    units: Units
    """Units of the numbers."""

    def as_list(self) -> list[dict[str, Any]]:
        """The rows as dictionaries; heels in degrees."""
        return [
            {"volume": v, "heel": math.degrees(h), "kn": x}
            for v, row in zip(self.volumes, self.kn, strict=True)
            for h, x in zip(self.heels, row, strict=True)
        ]

    def _table(self) -> tuple[list[str], list[list[float]]]:
        volume, arm = self.units.of("volume"), self.units.of("kn")
        unit = f" [{arm}]" if arm else ""
        head = [f"volume [{volume}]" if volume else "volume"]
        head += [f"KN{unit} at {math.degrees(h):g} deg" for h in self.heels]
        return head, [[v, *row] for v, row in zip(self.volumes, self.kn, strict=True)]

    def csv(self) -> str:
        """The arms as comma-separated text (RFC 4180), a row for each volume."""
        head, rows = self._table()
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\r\n")
        writer.writerow(head)
        writer.writerows(rows)
        return text.getvalue()

    def write_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write :meth:`csv` to a file atomically.

        Parameters
        ----------
        path
            The file.
        """
        from moldloft.exchange.files import Output, commit

        path = Path(path)
        return commit(path.parent, [Output(path.name, self.csv().encode())], make=False)[0]

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """Draw the arms over the displaced volume, a curve for each heel.

        Needs matplotlib (``pip install 'moldloft[plot]'``); the file's ending gives its form.

        Parameters
        ----------
        path
            The file.
        """
        from moldloft.hydro.hydrostatics import plot_curves

        volume, arm = self.units.of("volume"), self.units.of("kn")
        curves = {
            f"{math.degrees(h):g}°": [row[k] for row in self.kn] for k, h in enumerate(self.heels)
        }
        labels = (f"volume [{volume}]" if volume else "volume", f"KN [{arm}]" if arm else "KN")
        return plot_curves(path, self.volumes, curves, labels)

    def __str__(self) -> str:
        from moldloft.text_table import table

        head, rows = self._table()
        trim = "free" if self.free_trim else "kept"
        return table(head, [[f"{x:.6g}" for x in row] for row in rows], left=0) + f"\ntrim {trim}"


def cross_curves(
    model: Model,
    volumes: Sequence[float],
    heels: Sequence[float],
    *,
    free_trim: bool = True,
    accuracy: float = 1e-6,
) -> CrossCurves:
    """Cross curves of stability: arms KN at constant displacement.

    Parameters
    ----------
    model
        The model.
    volumes
        Displaced volumes.
    heels
        In radians.
    free_trim
        True for free trim: the centre of gravity is then over the centre of buoyancy of the upright
        level state, as is customary.
    accuracy
        Relative accuracy of the integrals.
    """
    keel = model.hydrostatics(draft=0.0, accuracy=accuracy).level
    rows = []
    for volume in volumes:
        level = model.equilibrium(volume, density=1.0, free=(), accuracy=accuracy)
        centre = (level.lcb or 0.0, 0.0, keel)
        curve = model.righting_curve(
            heels, volume, cg=centre, density=1.0, free_trim=free_trim, accuracy=accuracy
        )
        rows.append(tuple(math.nan if row.gz is None else row.gz for row in curve.rows))
    return CrossCurves(
        tuple(map(float, volumes)), tuple(map(float, heels)), tuple(rows), free_trim, model.units
    )


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    """A root between two arguments with values of different signs (Brent 1973, chapter 4)."""
    a, b, fa, fb = low, high, f(low), f(high)
    if fa == 0:
        return a
    if fb == 0:
        return b
    c, fc, d, e = a, fa, b - a, b - a
    for _ in range(100):
        if abs(fc) < abs(fb):
            a, b, c, fa, fb, fc = b, c, b, fb, fc, fb
        middle = 0.5 * (c - b)
        if abs(middle) <= _ANGLE_ACCURACY or fb == 0:
            return b
        if abs(e) < _ANGLE_ACCURACY or abs(fa) <= abs(fb):
            d = e = middle
        else:
            s = fb / fa
            if a == c:
                p, q = 2 * middle * s, 1 - s
            else:
                q, r = fa / fc, fb / fc
                p = s * (2 * middle * q * (q - r) - (b - a) * (r - 1))
                q = (q - 1) * (r - 1) * (s - 1)
            p, q = (p, -q) if p > 0 else (-p, q)
            if 2 * p < min(3 * middle * q - abs(_ANGLE_ACCURACY * q), abs(e * q)):
                e, d = d, p / q
            else:
                d = e = middle
        a, fa = b, fb
        b += d if abs(d) > _ANGLE_ACCURACY else math.copysign(_ANGLE_ACCURACY, middle)
        fb = f(b)
        if (fb > 0) == (fc > 0):
            c, fc, d, e = a, fa, b - a, b - a
    return b


@dataclass(frozen=True)
class Check:
    """A row of an assessment."""

    clause: str
    """The clause of the rule."""
    what: str
    """Requirement."""
    unit: str
    """The unit of the numbers."""
    required: float | None
    """The least value."""
    attained: float | None
    """The value of this loading."""
    result: str
    """``pass``, ``fail``, ``not applicable`` or ``data missing``."""
    note: str = ""
    """Explanation, if it is more than a comparison."""

    @property
    def margin(self) -> float | None:
        """Attained value minus required value."""
        if self.attained is None or self.required is None:
            return None
        return self.attained - self.required

    @property
    def margin_percent(self) -> float | None:
        """The margin in percent of the requirement."""
        if self.margin is None or not self.required:
            return None
        return 100 * self.margin / abs(self.required)


@dataclass(frozen=True)
class Assessment:
    """The criteria of a rule for a loading."""

    rule: str
    """The rule's name."""
    source: str
    """Source in the rules."""
    checks: tuple[Check, ...]
    """One for each clause."""
    details: Mapping[str, float] = field(default_factory=dict)
    """Numbers of the weather criterion by name; angles in degrees."""

    @property
    def passed(self) -> bool:
        """True when every applicable clause is passed; a clause with missing data is not."""
        return all(c.result in ("pass", "not applicable") for c in self.checks)

    def as_list(self) -> list[dict[str, Any]]:
        """The rows as dictionaries."""
        names = ("clause", "what", "unit", "required", "attained", "margin", "margin_percent")
        return [
            {**{n: getattr(c, n) for n in names}, "result": c.result, "note": c.note}
            for c in self.checks
        ]

    def csv(self) -> str:
        """The rows as comma-separated text (RFC 4180), a header first."""
        text = io.StringIO()
        rows = self.as_list()
        writer = csv.writer(text, lineterminator="\r\n")
        writer.writerow(rows[0])
        writer.writerows([["" if v is None else v for v in row.values()] for row in rows])
        return text.getvalue()

    def __str__(self) -> str:
        from moldloft.text_table import table

        header = ["clause", "what", "required", "attained", "margin", "", "unit", "result"]
        rows = []
        for c in self.checks:
            numbers = [_short(c.required), _short(c.attained), _short(c.margin)]
            percent = "" if c.margin_percent is None else f"{c.margin_percent:+.1f} %"
            rows.append([c.clause, c.what, *numbers, percent, c.unit, c.result])
        text = f"{self.rule}\n" + table(header, rows, left=2)
        notes = [f"{c.clause}: {c.note}" for c in self.checks if c.note]
        return "\n".join([text, *notes])


def _short(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"


@cache
def _built_in() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(
        files("moldloft.hydro").joinpath("criteria.json").read_text(encoding="utf-8")
    )
    return data


def rules() -> list[str]:
    """The names of the rules that are built in.

    >>> "is-code-2008" in rules()
    True
    """
    return list(_built_in())


def _rule(name: str) -> dict[str, Any]:
    known = _built_in()
    if name in known:
        rule: dict[str, Any] = known[name]
        return rule
    path = Path(os.fspath(name))
    if path.suffix != ".json":
        raise Error(f"unknown rule `{name}`; expected one of: {', '.join(known)}, or a .json file")
    try:
        rule = json.loads(read_text(path))
    except (OSError, ValueError) as error:
        raise Error(f"cannot read the rule `{name}`: {error}") from error
    if not isinstance(rule, dict) or not isinstance(rule.get("clauses"), list):
        raise Error(f"the rule `{name}` has no list `clauses`")
    return rule


def _assess(
    stability: Stability, name: str, wind: Wind | None, deck_edge: float | None
) -> Assessment:
    rule = _rule(name)
    details: dict[str, float] = {}
    checks = []
    context = _Context(stability, wind, deck_edge, details)
    for clause in rule["clauses"]:
        kind = clause.get("kind")
        if kind not in _KINDS:
            known = ", ".join(_KINDS)
            raise Error(f"{name}: unknown kind of clause `{kind}`; expected one of: {known}")
        try:
            checks.append(_KINDS[kind](context, clause))
        except KeyError as error:
            clause_name = clause.get("clause", "?")
            raise Error(f"{name}: clause {clause_name} has no {error}") from error
    return Assessment(rule.get("title", name), rule.get("source", ""), tuple(checks), details)


@dataclass
class _Context:
    stability: Stability
    wind: Wind | None
    deck_edge: float | None
    details: dict[str, float]

    def check(
        self, clause: Mapping[str, Any], unit: str, required: float, attained: float, note: str = ""
    ) -> Check:
        result = "pass" if attained >= required else "fail"
        return Check(clause["clause"], clause["what"], unit, required, attained, result, note)

    def without(self, clause: Mapping[str, Any], unit: str, result: str, note: str) -> Check:
        required = clause.get("least")
        return Check(clause["clause"], clause["what"], unit, required, None, result, note)

    def unit(self) -> str:
        return self.stability._model.length_unit[0]

    def metres(self) -> float:
        """The model's unit of length in metres."""
        return self.stability._model.length_unit[1]


def _area_clause(context: _Context, clause: Mapping[str, Any]) -> Check:
    s = context.stability
    low, high = math.radians(clause["from"]), math.radians(clause["to"])
    note = ""
    if not s.openings:
        note = "no openings given: the angle of flooding is not considered"
    flood = s.flooding()
    if flood is not None and flood[0] < high:
        if not clause.get("to_flooding"):
            return context.without(
                clause,
                "m·rad",
                "fail",
                f"`{flood[1]}` floods at {math.degrees(flood[0]):.2f}°, before {clause['to']}°",
            )
        high, note = flood[0], f"to the flooding of `{flood[1]}` at {math.degrees(flood[0]):.2f}°"
    if high <= low:
        return context.without(clause, "m·rad", "fail", note)
    area = s.area(low, high) * context.metres()
    return context.check(clause, "m·rad", clause["least"], area, note)


def _arm_clause(context: _Context, clause: Mapping[str, Any]) -> Check:
    s = context.stability
    low, high = math.radians(clause["from"]), s._afloat(math.radians(clause.get("to", 90)))
    if high < low:
        return context.without(clause, "m", "fail", "the open edge of the skin floods before")
    heels = s.grid(low, high)
    best = max(map(s.gz, heels))
    heel, largest = s.largest(high)
    if heel >= low:
        best = max(best, largest)
    return context.check(clause, "m", clause["least"], best * context.metres())


def _largest_clause(context: _Context, clause: Mapping[str, Any]) -> Check:
    s = context.stability
    heel = math.degrees(s.largest()[0])
    least, other = clause["least"], clause.get("otherwise")
    if heel < least and other and heel >= other["from"]:
        need = other["area"] + other["per_degree"] * (other["below"] - heel)
        area = s.area(0.0, math.radians(heel)) * context.metres()
        note = f"the largest arm is at {heel:.2f}°: {other['clause']} asks for an area instead"
        return context.check(clause, "m·rad", need, area, note)
    return context.check(clause, "degrees", least, heel)


def _gm_clause(context: _Context, clause: Mapping[str, Any]) -> Check:
    return context.check(clause, "m", clause["least"], context.stability.gmt * context.metres())


def _range_clause(context: _Context, clause: Mapping[str, Any]) -> Check:
    attained = math.degrees(context.stability.range())
    return context.check(clause, "degrees", clause["least"], attained)


_X1 = [(2.4, 1.0), (2.5, 0.98), (2.6, 0.96), (2.7, 0.95), (2.8, 0.93), (2.9, 0.91), (3.0, 0.90)]
_X1 += [(3.1, 0.88), (3.2, 0.86), (3.3, 0.84), (3.4, 0.82), (3.5, 0.80)]
_X2 = [(0.45, 0.75), (0.5, 0.82), (0.55, 0.89), (0.6, 0.95), (0.65, 0.97), (0.7, 1.0)]
_KEEL = [(0.0, 1.0), (1.0, 0.98), (1.5, 0.95), (2.0, 0.88), (2.5, 0.79), (3.0, 0.74), (3.5, 0.72)]
_KEEL += [(4.0, 0.70)]
_PERIOD = [(6.0, 0.1), (7.0, 0.098), (8.0, 0.093), (12.0, 0.065), (14.0, 0.053), (16.0, 0.044)]
_PERIOD += [(18.0, 0.038), (20.0, 0.035)]


def _between(table: Sequence[tuple[float, float]], x: float) -> float:
    if x <= table[0][0]:
        return table[0][1]
    for (a, p), (b, q) in pairwise(table):
        if x <= b:
            return p + (q - p) * (x - a) / (b - a)
    return table[-1][1]


def _weather_clause(context: _Context, clause: Mapping[str, Any]) -> Check:
    s, wind = context.stability, context.wind
    if wind is None:
        return context.without(clause, "m·rad", "data missing", "no lateral area given")
    row, unit = s.upright, context.metres()
    needed = (row.waterline_length, row.waterline_beam, row.draft, row.cb, row.gmt, row.vcb)
    if any(x is None for x in needed):
        return context.without(clause, "m·rad", "data missing", "no waterplane")
    length, beam, draft = (float(x or 0.0) * unit for x in needed[:3])
    block, gm = float(row.cb or 0.0), float(row.gmt or 0.0) * unit
    if gm <= 0:
        return context.without(clause, "m·rad", "fail", "unstable upright")
    kg = s.cg[2] * unit - (row.level * unit - draft)
    ratio = kg / draft - 1
    roll = 2 * (0.373 + 0.023 * beam / draft - 0.043 * length / 100) * beam / math.sqrt(gm)
    if not (beam / draft < 3.5 and -0.3 <= ratio <= 0.5 and roll < 20):
        why = (
            f"B/d {beam / draft:.3g} (below 3.5), KG/d - 1 {ratio:.3g} (-0.3 to 0.5), roll period "
        )
        why += f"{roll:.3g} s (below 20): outside the tables; tests by MSC.1/Circ.1200 are needed"
        return context.without(clause, "m·rad", "not applicable", why)
    tonnes = s._model.tonnes(s.mass)
    if tonnes is None:
        return context.without(clause, "m·rad", "data missing", "the model states no unit of mass")
    steady = wind.pressure * wind.area * wind.lever / (1000 * 9.81 * tonnes)
    gust = 1.5 * steady
    x1, x2 = _between(_X1, beam / draft), _between(_X2, block)
    k = wind.bilge
    if wind.keel_area is not None:
        k = _between(_KEEL, 100 * wind.keel_area / (length * beam))
    r = 0.73 + 0.6 * ratio
    swing = math.radians(109 * k * x1 * x2 * math.sqrt(r * _between(_PERIOD, roll)))

    def over(lever: float) -> Callable[[float], float]:
        return lambda heel: s.gz(heel) * unit - lever

    heels = s.grid(0.0, math.radians(90))

    def crossing(lever: float, rising: bool) -> float | None:
        f = over(lever)
        for a, b in pairwise(heels):
            if (f(a) < 0 <= f(b)) if rising else (f(a) >= 0 > f(b)):
                return _root(f, a, b)
        return None

    calm, first, second = crossing(steady, True), crossing(gust, True), crossing(gust, False)
    if calm is None or first is None:
        return context.without(clause, "m·rad", "fail", "the wind lever exceeds the righting arms")
    edge = context.deck_edge if context.deck_edge is not None else s.deck_edge()
    flood = s.flooding()
    end = min(math.radians(50), second or math.pi, flood[0] if flood is not None else math.pi)
    start = calm - swing
    a = gust * (first - start) - (s.energy(first) - s.energy(start)) * unit
    b = (s.energy(end) - s.energy(first)) * unit - gust * (end - first)
    degrees = math.degrees
    context.details.update(
        {
            "lw1": steady,
            "lw2": gust,
            "X1": x1,
            "X2": x2,
            "k": k,
            "r": r,
            "s": _between(_PERIOD, roll),
            "roll_period": roll,
            "phi0": degrees(calm),
            "phi1": degrees(swing),
            "phi2": degrees(end),
            "first_intercept": degrees(first),
            "second_intercept": degrees(second) if second is not None else math.nan,
            "a": a,
            "b": b,
        }
    )
    most = math.radians(16)
    if edge is not None:
        most = min(most, 0.8 * edge)
    if calm > most:
        note = f"steady heel {degrees(calm):.2f}° is more than {degrees(most):.2f}°"
        return Check(clause["clause"], clause["what"], "m·rad", a, b, "fail", note)
    note = (
        "" if edge is not None else "no deck edge given: the steady heel is compared with 16° only"
    )
    return context.check(clause, "m·rad", a, b, note)


_KINDS: dict[str, Callable[[_Context, Mapping[str, Any]], Check]] = {
    "area": _area_clause,
    "arm": _arm_clause,
    "angle of largest arm": _largest_clause,
    "GM": _gm_clause,
    "range": _range_clause,
    "weather": _weather_clause,
}


explain(globals())
