"""Thrust and torque of a propeller by blade elements and momentum, with Prandtl's tip and hub loss.

Lift by thin-aerofoil theory of a = 0.8 mean lines (no lift at the incidence -1.95 f/c), drag 0.008
and its growth with lift; the induced velocities follow from the momentum of each ring (Carlton,
Marine Propellers and Propulsion, chapter 8). An estimate for a design's first round.
"""

from __future__ import annotations

import math

import numpy as np

import moldloft

#: Advance ratio V/(n D), blades, ring edges r/R.
ADVANCE, BLADES = 0.8, 5
EDGES = np.linspace(0.2, 1.0, 41)

#: r/R and c/D of the data sheet of examples/propeller.
R_R = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0)
C_D = (0.1735, 0.2283, 0.275, 0.3125, 0.3375, 0.3475, 0.3342, 0.2808, 0.2192, 0.0)

ZERO_LIFT = 1.95
"""Radians of zero-lift incidence for each f/c."""


def coefficients(model: moldloft.Model) -> dict[str, float]:
    """KT, 10 KQ, the efficiency, and the greatest lift coefficient of a section."""
    r = (EDGES[1:] + EDGES[:-1]) / 2
    t = np.linspace(0, 1, 201)
    pitch, camber = (np.asarray(model[name](t))[:, :2] for name in ("pitch", "camber"))
    return of_rings(
        r, np.interp(r, *pitch.T), np.interp(r, *camber.T), np.interp(r, R_R, C_D), ADVANCE
    )


def of_rings(
    r: np.ndarray, pitch: np.ndarray, camber: np.ndarray, chord: np.ndarray, advance: float
) -> dict[str, float]:
    """The sums over rings of even width."""
    width = r[1] - r[0]
    geometric = np.arctan(pitch / (np.pi * r))
    low = np.full(r.shape, 1e-4)
    high = np.arctan(pitch / (np.pi * r)) + ZERO_LIFT * camber - 1e-6
    # The hydrodynamic pitch angle of each ring, where its residual changes sign.
    for _ in range(60):
        middle = (low + high) / 2
        above = _ring(middle, r, geometric, camber, chord, advance)[0] > 0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    _, lift, drag, speed = _ring((low + high) / 2, r, geometric, camber, chord, advance)
    phi = (low + high) / 2
    # In n D = 1: radii in D are r / 2.
    force = BLADES * chord * speed**2 / 2 * width / 2
    kt = float((force * (lift * np.cos(phi) - drag * np.sin(phi))).sum())
    kq = float((force * (lift * np.sin(phi) + drag * np.cos(phi)) * r / 2).sum())
    return {
        "kt": kt,
        "kq10": 10 * kq,
        "efficiency": advance * kt / (2 * math.pi * kq),
        "lift": float(np.abs(lift).max()),
    }


def _ring(
    phi: np.ndarray,
    r: np.ndarray,
    geometric: np.ndarray,
    camber: np.ndarray,
    chord: np.ndarray,
    advance: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The residual of momentum at the angles phi, lift and drag coefficients, inflow speed."""
    sine, cosine = np.sin(phi), np.cos(phi)
    lift = 2 * np.pi * (geometric - phi + ZERO_LIFT * camber)
    drag = 0.008 + 0.01 * lift**2
    tip = BLADES / 2 * (1 - r) / (r * sine)
    hub = BLADES / 2 * (r - EDGES[0]) / (r * sine)
    loss = (2 / np.pi) ** 2 * np.arccos(np.exp(-tip)) * np.arccos(np.exp(-hub))
    solidity = BLADES * chord / (np.pi * r)
    axial = solidity * (lift * cosine - drag * sine) / (4 * loss * sine**2)
    swirl = solidity * (lift * sine + drag * cosine) / (4 * loss * sine * cosine)
    # V (1 + a) / sin = omega r (1 - a') / cos, with a = x / (1 - x), a' = y / (1 + y).
    residual = advance * cosine * (1 + swirl) - np.pi * r * sine * (1 - axial)
    speed = np.pi * r / cosine / (1 + swirl)
    return residual, lift, drag, speed
