"""Figures of bodies in water: hydrostatics, stability, weights, the stability booklet."""
