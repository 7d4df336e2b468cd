"""Heave period of the platform, its added mass by Capytaine."""

from __future__ import annotations

import math

import moldloft

DENSITY, GRAVITY = 1025.0, 9.81

#: The period of the constraint: added mass is taken there.
PERIOD = 20.0

#: Panels on a quarter of a circle: with twice as many the period changes by 0.1 %.
FINE = 6


def coarse(model: moldloft.Model, fine: int) -> moldloft.Model:
    """The same platform with `fine` panels on a quarter of a circle."""
    text, given = model.text, "int fine = 22;"
    if given not in text:
        raise ValueError(f"the model has no `{given}`")
    found = moldloft.loads(text.replace(given, f"int fine = {fine};"))
    found.set({name: each.value for name, each in model.params.items()})
    return found


def heave_period(model: moldloft.Model) -> float:
    """The natural period of heave in s, exact where it is that of the constraint."""
    import capytaine

    capytaine.set_logging("ERROR")
    body = coarse(model, FINE).to_capytaine(dofs=False)
    body.add_translation_dof(name="Heave")
    problem = capytaine.RadiationProblem(
        body=body,
        radiating_dof="Heave",
        omega=2 * math.pi / PERIOD,
        water_depth=math.inf,
        rho=DENSITY,
        g=GRAVITY,
    )
    added = float(capytaine.BEMSolver().solve(problem).added_masses["Heave"])
    state = model.hydrostatics()
    mass, stiffness = DENSITY * state.volume, DENSITY * GRAVITY * state.waterplane_area
    return 2 * math.pi * math.sqrt((mass + added) / stiffness)
