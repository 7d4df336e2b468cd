"""Resistance of ships: the regression of Holtrop and Mennen, and Michell's integral.

>>> from moldloft.resistance import Ship, holtrop
>>> ship = Ship(length=205, beam=32, draft=10, volume=37500, cm=0.98, cwp=0.75, lcb=-0.75,
...             bulb_area=20, bulb_height=4, transom_area=16, stern=10)
>>> found = holtrop(ship, 25 * 1852 / 3600, appendages=50, appendage_factor=1.5)
>>> round(found.total / 1000)
1793
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Resistance", "Ship", "holtrop", "michell"]

GRAVITY = 9.81
"""In m/s²."""

SEA_WATER = 1025.0
"""Density in kg/m³, at 15 °C."""

VISCOSITY = 1.18831e-6
"""Kinematic viscosity of sea water at 15 °C in m²/s."""

#: Greatest Froude number of the regression of 1982 (container ships of its table).
MAX_FROUDE = 0.45

#: Ranges of the ships behind the regression.
RANGES = {"cp": (0.55, 0.85), "length / beam": (3.9, 9.5), "beam / draft": (2.1, 4.0)}


@dataclass(frozen=True)
class Ship:
    """Dimensions of a displacement ship in metres."""

    length: float
    """On the waterline."""
    beam: float
    draft: float
    """Mean of both ends, also used as the draft at the fore perpendicular."""
    volume: float
    """Displacement, m³."""
    cm: float
    """Midship section coefficient."""
    cwp: float
    """Waterplane coefficient."""
    lcb: float
    """Centre of buoyancy forward of the middle of the waterline, in percent of its length."""
    wetted_area: float | None = None
    """By default the regression's."""
    bulb_area: float = 0.0
    """Transverse area of the bulb at the fore perpendicular."""
    bulb_height: float = 0.0
    """Height of the centroid of this area above the keel."""
    transom_area: float = 0.0
    """Immersed area of the transom at rest."""
    stern: float = 0.0
    """-25 pram with gondola, -10 V sections, 0 normal, 10 U sections with Hogner stern."""

    def __post_init__(self) -> None:
        for name in ("length", "beam", "draft", "volume", "cm", "cwp"):
            if not getattr(self, name) > 0 or not math.isfinite(getattr(self, name)):
                raise Error(f"`{name}` of a ship is above 0, found {getattr(self, name)}")
        for name, value in (("cb", self.cb), ("cp", self.cp), ("cm", self.cm), ("cwp", self.cwp)):
            if value >= 1:
                raise Error(f"`{name}` of a ship is below 1, found {value:.4g}")
        if self.bulb_area > 0 and self.draft <= 1.5 * self.bulb_height:
            raise Error("the centre of the bulb is at most two thirds of the draft above the keel")

    @property
    def cb(self) -> float:
        """Block coefficient."""
        return self.volume / (self.length * self.beam * self.draft)

    @property
    def cp(self) -> float:
        """Prismatic coefficient."""
        return self.cb / self.cm

    @property
    def outside(self) -> list[str]:
        """Ratios outside the range of the regression's ships, each with its range."""
        ratios = (self.cp, self.length / self.beam, self.beam / self.draft)
        return [
            f"{name} is {ratio:.3g}, outside {low:g} to {high:g}"
            for (name, (low, high)), ratio in zip(RANGES.items(), ratios, strict=True)
            if not low <= ratio <= high
        ]


@dataclass(frozen=True)
class Resistance:
    """Resistance by parts, in newtons."""

    friction: float
    """Friction coefficient of ITTC 1957."""
    form_factor: float
    """1 + k1."""
    appendages: float
    wave: float
    bulb: float
    """Pressure of a bulb near the surface."""
    transom: float
    """Pressure of an immersed transom."""
    correlation: float
    """Model-ship correlation allowance."""
    wetted_area: float
    """In m²."""
    outside: tuple[str, ...]
    """Ratios outside the ships behind the regression."""

    @property
    def total(self) -> float:
        """The sum of all parts, including the form factor of friction."""
        return (
            self.friction * self.form_factor
            + self.appendages
            + self.wave
            + self.bulb
            + self.transom
            + self.correlation
        )


def holtrop(
    ship: Ship,
    speed: float,
    *,
    appendages: float = 0.0,
    appendage_factor: float = 1.5,
    density: float = SEA_WATER,
    viscosity: float = VISCOSITY,
) -> Resistance:
    """Resistance by the regression of Holtrop and Mennen (1982).

    Parameters
    ----------
    ship
        Its dimensions.
    speed
        In m/s.
    appendages
        Their wetted area, m².
    appendage_factor
        Their form factor 1 + k2.
    density, viscosity
        Density and kinematic viscosity of the water, kg/m³ and m²/s.

    Returns
    -------
    Resistance
        ``outside`` has the ratios beyond the range of the regression.

    Raises
    ------
    Error
        For a speed of 0 or less, and for Froude numbers above 0.45, where the regression ends.

    Notes
    -----
    The correlation allowance is of hull and appendages, as in the paper's example.
    J. Holtrop, G. G. J. Mennen, An approximate power prediction method, International Shipbuilding
    Progress 29 (1982) 166-170.
    """
    if not speed > 0 or not math.isfinite(speed):
        raise Error(f"the speed is above 0 m/s, found {speed}")
    froude = speed / math.sqrt(GRAVITY * ship.length)
    if froude > MAX_FROUDE:
        raise Error(
            f"the regression ends at the Froude number {MAX_FROUDE}, found {froude:.3f}: "
            f"at most {MAX_FROUDE * math.sqrt(GRAVITY * ship.length):.2f} m/s"
        )
    cp, lcb = ship.cp, ship.lcb
    run = ship.length * (1 - cp + 0.06 * cp * lcb / (4 * cp - 1))
    area = ship.wetted_area or _wetted_area(ship)
    plate = 0.075 / (math.log10(speed * ship.length / viscosity) - 2) ** 2
    pressure = 0.5 * density * speed**2
    form = (1 + 0.003 * ship.stern) * (
        0.93
        + _draft_factor(ship.draft / ship.length)
        * (ship.beam / run) ** 0.92497
        * (0.95 - cp) ** -0.521448
        * (1 - cp + 0.0225 * lcb) ** 0.6906
    )
    bulb_factor = _bulb_factor(ship)
    return Resistance(
        friction=pressure * plate * area,
        form_factor=form,
        appendages=pressure * plate * appendages * appendage_factor,
        wave=_wave(ship, froude, run, bulb_factor) * ship.volume * density * GRAVITY,
        bulb=_bulb(ship, speed) * density * GRAVITY,
        transom=pressure * ship.transom_area * _transom_factor(ship, speed),
        correlation=pressure * (area + appendages) * _allowance(ship, bulb_factor),
        wetted_area=area,
        outside=tuple(ship.outside),
    )


def _wetted_area(s: Ship) -> float:
    bare = s.length * (2 * s.draft + s.beam) * math.sqrt(s.cm)
    bare *= 0.453 + 0.4425 * s.cb - 0.2862 * s.cm - 0.003467 * s.beam / s.draft + 0.3696 * s.cwp
    return bare + 2.38 * s.bulb_area / s.cb


def _draft_factor(ratio: float) -> float:
    if ratio > 0.05:
        return float(ratio**0.2228446)
    if ratio > 0.02:
        return float(48.20 * (ratio - 0.02) ** 2.078 + 0.479948)
    return 0.479948


def _bulb_factor(s: Ship) -> float:
    if s.bulb_area <= 0:
        return 1.0
    depth = 0.31 * math.sqrt(s.bulb_area) + s.draft - s.bulb_height
    return math.exp(-1.89 * math.sqrt(0.56 * s.bulb_area**1.5 / (s.beam * s.draft * depth)))


def _wave(s: Ship, froude: float, run: float, bulb_factor: float) -> float:
    """Wave resistance by the weight of the displacement."""
    ratio, cp = s.beam / s.length, s.cp
    entrance = 1 + 89 * math.exp(
        -((s.length / s.beam) ** 0.80856)
        * (1 - s.cwp) ** 0.30484
        * (1 - cp - 0.0225 * s.lcb) ** 0.6367
        * (run / s.beam) ** 0.34574
        * (100 * s.volume / s.length**3) ** 0.16302
    )
    if ratio < 0.11:
        c7 = 0.229577 * ratio ** (1 / 3)
    elif ratio <= 0.25:
        c7 = ratio
    else:
        c7 = 0.5 - 0.0625 / ratio
    c1 = 2223105 * c7**3.78613 * (s.draft / s.beam) ** 1.07961 * (90 - entrance) ** -1.37565
    c5 = 1 - 0.8 * s.transom_area / (s.beam * s.draft * s.cm)
    wave_length = 1.446 * cp - (0.03 / ratio if 1 / ratio < 12 else 0.36)
    c16 = 8.07981 * cp - 13.8673 * cp**2 + 6.984388 * cp**3 if cp < 0.8 else 1.73014 - 0.7067 * cp
    slender = s.length / s.volume ** (1 / 3)
    m1 = 0.0140407 * s.length / s.draft - 1.75254 / slender - 4.79323 * ratio - c16
    if slender**3 < 512:
        c15 = -1.69385
    elif slender**3 > 1727:
        c15 = 0.0
    else:
        c15 = -1.69385 + (slender - 8) / 2.36
    m2 = c15 * cp**2 * math.exp(-0.1 * froude**-2)
    exponent = m1 * froude**-0.9 + m2 * math.cos(wave_length * froude**-2)
    return float(c1 * bulb_factor * c5 * math.exp(exponent))


def _bulb(s: Ship, speed: float) -> float:
    if s.bulb_area <= 0:
        return 0.0
    root = math.sqrt(s.bulb_area)
    emergence = 0.56 * root / (s.draft - 1.5 * s.bulb_height)
    depth = s.draft - s.bulb_height - 0.25 * root
    immersion = speed / math.sqrt(GRAVITY * depth + 0.15 * speed**2)
    factor = 0.11 * math.exp(-3 * emergence**-2) * immersion**3 / (1 + immersion**2)
    return float(factor * s.bulb_area**1.5)


def _transom_factor(s: Ship, speed: float) -> float:
    if s.transom_area <= 0:
        return 0.0
    froude = speed / math.sqrt(2 * GRAVITY * s.transom_area / (s.beam + s.beam * s.cwp))
    return max(0.2 * (1 - 0.2 * froude), 0.0)


def _allowance(s: Ship, bulb_factor: float) -> float:
    c4 = min(s.draft / s.length, 0.04)
    rough = 0.003 * math.sqrt(s.length / 7.5) * s.cb**4 * bulb_factor * (0.04 - c4)
    return float(0.006 * (s.length + 100) ** -0.16 - 0.00205 + rough)


def michell(
    mesh: Any,
    speed: ArrayLike,
    *,
    density: float = SEA_WATER,
    symmetric: bool = True,
    accuracy: float = 1e-4,
) -> Floats:
    """Wave resistance of a thin ship by Michell's integral (1898), in newtons.

    Parameters
    ----------
    mesh
        Panels of the hull in metres, along x, with the water at z = 0: a mesh with ``vertices`` and
        ``faces``, or that pair.
    speed
        Speeds in m/s.
    density
        Density of the water, kg/m³.
    symmetric
        True if the mesh is one side (y of one sign) of a ship that is symmetric in y = 0.
    accuracy
        Relative accuracy of the integral over the directions of the waves.

    Returns
    -------
    numpy.ndarray
        In the shape of `speed`. Panels are cut at the water; each triangle is integrated by a rule
        of seven points, and most of the error is that of the flat panels.

    Raises
    ------
    Error
        Without panels below the water, for speeds of 0 or less, and when the integral over the
        directions does not converge.
    """
    vertices, faces = mesh if isinstance(mesh, tuple) else (mesh.vertices, mesh.faces)
    triangles = _below(np.asarray(vertices, np.float64), np.asarray(faces, np.int64))
    if not len(triangles):
        raise Error("no panel is below the water, z = 0")
    speeds = np.asarray(speed, dtype=np.float64)
    if not (speeds > 0).all() or not np.isfinite(speeds).all():
        raise Error("speeds are above 0 m/s")
    sides = 1.0 if symmetric else 0.5
    found = [sides**2 * _michell(triangles, float(u), density, accuracy) for u in speeds.ravel()]
    return np.reshape(found, speeds.shape)


def _below(vertices: Floats, faces: NDArray[np.int64]) -> Floats:
    """Triangles below z = 0, ``(n, 3, 3)``."""
    corners = faces if faces.shape[1] == 4 else np.concatenate([faces, faces[:, 2:]], axis=1)
    whole = np.concatenate([vertices[corners[:, [0, 1, 2]]], vertices[corners[:, [0, 2, 3]]]])
    deep = whole[..., 2]
    kept = [whole[(deep <= 0).all(axis=1)]]
    for triangle in whole[(deep < 0).any(axis=1) & (deep > 0).any(axis=1)]:
        ring = []
        for k in range(3):
            a, b = triangle[k], triangle[(k + 1) % 3]
            if a[2] <= 0:
                ring.append(a)
            if (a[2] < 0) != (b[2] < 0) and a[2] != 0 and b[2] != 0:
                ring.append(a + (b - a) * (a[2] / (a[2] - b[2])))
        kept += [np.array([[ring[0], ring[k], ring[k + 1]]]) for k in range(1, len(ring) - 1)]
    return np.concatenate(kept)


def _spectrum(triangles: Floats, wave: float, tangents: Floats) -> Floats:
    """|sum of (n_x dS) exp(wave (z s² + i x s))|² for s = sec of the waves' directions."""
    edges = triangles[:, 1:] - triangles[:, :1]
    across = 0.5 * np.cross(edges[:, 0], edges[:, 1])[:, 0]
    # Gauss points of degree 5 of a triangle (Dunavant), cut small enough by the caller's panels.
    a, b = (6 - math.sqrt(15)) / 21, (6 + math.sqrt(15)) / 21
    weights = np.array(
        [9 / 40, *[(155 - math.sqrt(15)) / 1200] * 3, *[(155 + math.sqrt(15)) / 1200] * 3]
    )
    rows = [[1 / 3] * 3]
    for c in (a, b):
        rows += [[1 - 2 * c, c, c], [c, 1 - 2 * c, c], [c, c, 1 - 2 * c]]
    places = np.einsum("gk,nkc->ngc", np.array(rows), triangles).reshape(-1, 3)
    strength = (across[:, None] * weights).ravel()
    found = np.empty(tangents.size)
    for k, t in enumerate(tangents):
        s = math.sqrt(1 + t * t)
        decay = strength * np.exp(wave * s * s * places[:, 2])
        phase = wave * s * places[:, 0]
        found[k] = (decay * np.cos(phase)).sum() ** 2 + (decay * np.sin(phase)).sum() ** 2
    return found


def _michell(triangles: Floats, speed: float, density: float, accuracy: float) -> float:
    wave = GRAVITY / speed**2
    # With tan of the direction as variable: lambda² / sqrt(lambda² - 1) dlambda = sqrt(1 + t²) dt.
    rule, weight = np.polynomial.legendre.leggauss(16)
    total, start, width = 0.0, 0.0, 0.25
    small = 0
    for _ in range(400):
        t = start + width * (rule + 1) / 2
        part = float(
            (width / 2 * weight * np.sqrt(1 + t * t) * _spectrum(triangles, wave, t)).sum()
        )
        total += part
        start += width
        small = small + 1 if part <= accuracy / 10 * total else 0
        if small == 6:
            return 4 * density * GRAVITY**2 / (math.pi * speed**2) * total
    raise Error(
        f"the integral over the directions of the waves does not converge at {speed:g} m/s: "
        "the panels are too long for waves of that length"
    )


explain(globals())
