"""The hydrostatic stiffness matrix of a floating or submerged body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error, UnknownNameError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.hydro.hydrostatics import Hydrostatics

__all__ = ["kh_files", "stiffness"]

#: The figures that the matrix is a function of.
_FIGURES = (
    *("weight", "volume", "lcb", "tcb", "vcb", "waterplane_area", "lcf", "tcf"),
    *("waterplane_it", "waterplane_il", "waterplane_product", "level", "trim", "heel"),
)

#: The step of a derivative along the imaginary axis: its error is below rounding.
_IMAGINARY_STEP = 1e-40


def stiffness(
    state: Hydrostatics,
    cg: Sequence[float],
    *,
    mass: float | None = None,
    about: Sequence[float] | None = None,
    by: str | None = None,
) -> NDArray[np.float64]:
    """See :meth:`moldloft.Hydrostatics.stiffness`."""
    if state.weight is None or state.displacement is None:
        raise Error('a stiffness needs the density of the water\nhelp: give density="salt"')
    if state.sides == "one":
        raise Error('a stiffness is of the whole body\nhelp: leave out sides="one"')
    for name, place in (("cg", cg), ("about", cg if about is None else about)):
        if len(place) != 3 or not np.all(np.isfinite(place)):
            raise Error(f"`{name}` is three finite numbers x, y, z")
    values = {name: getattr(state, name) or 0.0 for name in _FIGURES}
    ratio = 1.0 if mass is None else mass / state.displacement
    places = np.asarray(cg, float), np.asarray(cg if about is None else about, float)
    if by is None:
        return np.real(_matrix(values, ratio, *places)) + 0.0
    slopes = state.derivatives
    if not any(by in row for row in slopes.values()):
        raise UnknownNameError(
            f"the figures have no derivatives by `{by}`\nhelp: give by=[{by!r}] to hydrostatics"
        )
    if mass is not None:
        raise Error("the matrix has no derivatives with a given mass: omit `mass` or `by`")
    moved = {
        name: value + 1j * _IMAGINARY_STEP * slopes.get(name, {}).get(by, 0.0)
        for name, value in values.items()
    }
    return np.imag(_matrix(moved, 1.0, *places)) / _IMAGINARY_STEP


def _matrix(f: dict[str, Any], ratio: float, cg: Any, about: Any) -> NDArray[Any]:
    """The matrix of figures, which may be complex; ``ratio`` is the weight over the buoyancy."""
    buoyancy = f["weight"]
    gamma = buoyancy / f["volume"] if f["volume"] else 0.0
    s, c = np.sin(f["trim"]), np.cos(f["trim"])
    sf, cf = np.sin(f["heel"]), np.cos(f["heel"])
    along = np.array([c, -s * sf, s * cf])
    across = np.array([0.0 * s, cf, sf])
    up = np.array([-s, -c * sf, c * cf])
    centre = np.array([f["lcb"], f["tcb"], f["vcb"]]) - about
    arm = cg - about
    # The centre of flotation is in the water plane: its z in the body's axes follows.
    x, y = f["lcf"], f["tcf"]
    flotation = np.array([x, y, (f["level"] - up[0] * x - up[1] * y) / up[2]]) - about
    area = f["waterplane_area"]
    xf, yf = flotation @ along, flotation @ across
    heights = buoyancy * (centre @ up - ratio * (arm @ up))
    k = np.zeros((6, 6), dtype=np.result_type(*f.values(), float))
    k[2, 2] = gamma * area
    k[2, 3] = k[3, 2] = gamma * area * yf
    k[2, 4] = k[4, 2] = -gamma * area * xf
    k[3, 3] = gamma * (f["waterplane_it"] + area * yf * yf) + heights
    k[4, 4] = gamma * (f["waterplane_il"] + area * xf * xf) + heights
    k[3, 4] = k[4, 3] = -gamma * (f["waterplane_product"] + area * xf * yf)
    k[3, 5] = -buoyancy * (centre @ along - ratio * (arm @ along))
    k[4, 5] = -buoyancy * (centre @ across - ratio * (arm @ across))
    return k


def kh_files(state: Hydrostatics, cg: Sequence[float], mass: float | None) -> dict[str, bytes]:
    """``KH.dat`` and ``Hydrostatics.dat`` as Nemoh's mesher writes them."""
    matrix = stiffness(state, cg, mass=mass)
    rows = "".join("".join(f"{x:14.6E}" for x in row) + "\n" for row in matrix)
    centre = (state.lcb or 0.0, state.tcb or 0.0, (state.vcb or 0.0) - state.level)
    weight = (cg[0], cg[1], cg[2] - state.level)
    lines = [
        f" {letter}F = {b:7.3f} - {letter}G = {g:7.3f} \n"
        for letter, b, g in zip("XYZ", centre, weight, strict=True)
    ]
    lines.append(f" Displacement = {state.volume:E} \n")
    lines.append(f" Waterplane area = {state.waterplane_area or 0.0:E} \n")
    return {"KH.dat": rows.encode(), "Hydrostatics.dat": "".join(lines).encode()}
