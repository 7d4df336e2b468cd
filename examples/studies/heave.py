"""Heave period of the platform, its added mass by Capytaine."""

from __future__ import annotations

import math
from functools import lru_cache

import moldloft

DENSITY, GRAVITY = 1025.0, 9.81

#: The period of the constraint: added mass is taken there.
PERIOD = 20.0

#: Panels on a quarter of a circle: with twice as many the period changes by 0.1 %.
FINE = 4


@lru_cache(maxsize=1)
def coarse(text: str) -> moldloft.Model:
    """The model of this text with :data:`FINE` panels on a quarter of a circle."""
    given = "int fine = 22;"
    if given not in text:
        raise ValueError(f"the model has no `{given}`")
    return moldloft.loads(text.replace(given, f"int fine = {FINE};"))


def heave_period(model: moldloft.Model) -> float:
    """The natural period of heave in s, exact where it is that of the constraint."""
    import capytaine

    capytaine.set_logging("ERROR")
    panels = coarse(model.text)
    panels.set({name: each.value for name, each in model.params.items()})
    body = panels.to_capytaine(dofs=False)
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
