"""What a hull displaces and how stiffly it floats."""

from __future__ import annotations

from dataclasses import dataclass, fields

__all__ = ["Hydrostatics"]


@dataclass(frozen=True)
class Hydrostatics:
    """The figures of a body floating at a level; lengths in the model's unit.

    Figures that have no meaning, such as those of the waterplane of a body that is all under
    water, are ``None``.
    """

    level: float
    """Height z of the water."""
    sides: str
    """``"both"`` when a mirrored model counts with its image, ``"one"`` when it does not, and
    ``"whole"`` for a model without symmetry."""
    volume: float
    """Displaced volume."""
    displacement: float
    """Density times volume."""
    wetted_area: float
    """Area of the skin below the water."""
    draft: float
    """Depth of the lowest point below the water."""
    open_edges: int
    """Open panel edges below the water, not in the symmetry plane: 0 when the skin holds water."""
    closure_error: float
    """Largest difference between the volumes by x, y and z over the volume."""
    waterplane_error: float
    """Difference between the waterplane's area from the skin and from the waterline, over it."""
    outward: bool
    """True when the panels' normals point out of the body; else the figures are those of the
    turned mesh."""
    lcb: float | None = None
    """Centre of buoyancy, x."""
    tcb: float | None = None
    """Centre of buoyancy, y."""
    vcb: float | None = None
    """Centre of buoyancy, z."""
    waterplane_area: float | None = None
    """Area of the cut with the water."""
    lcf: float | None = None
    """Centre of flotation, x."""
    tcf: float | None = None
    """Centre of flotation, y."""
    waterplane_it: float | None = None
    """Second moment of the waterplane about its longitudinal axis."""
    waterplane_il: float | None = None
    """Second moment of the waterplane about its transverse axis."""
    waterline_low_x: float | None = None
    """Lowest x of the waterline."""
    waterline_high_x: float | None = None
    """Highest x of the waterline."""
    waterline_length: float | None = None
    """Extent of the waterline in x."""
    waterline_beam: float | None = None
    """Extent of the waterline in y."""
    midship_area: float | None = None
    """Immersed area of the section half-way between the ends of the waterline."""
    cb: float | None = None
    """Block coefficient, volume / (length beam draft)."""
    cp: float | None = None
    """Prismatic coefficient, volume / (midship area length)."""
    cm: float | None = None
    """Midship coefficient, midship area / (beam draft)."""
    cwp: float | None = None
    """Waterplane coefficient, waterplane area / (length beam)."""
    kb: float | None = None
    """Height of the centre of buoyancy above the lowest point."""
    bmt: float | None = None
    """Transverse metacentric radius."""
    bml: float | None = None
    """Longitudinal metacentric radius."""
    kmt: float | None = None
    """Height of the transverse metacentre above the lowest point."""
    kml: float | None = None
    """Height of the longitudinal metacentre above the lowest point."""

    def as_dict(self) -> dict[str, float | int | bool | str]:
        """All figures that have a meaning, by name, in a fixed order."""
        pairs = ((field.name, getattr(self, field.name)) for field in fields(self))
        return {name: value for name, value in pairs if value is not None}
