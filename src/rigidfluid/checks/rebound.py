"""What would come back of the expected impact, and does the law give back more?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.film import resolved_gap
from rigidfluid.checks.finding import Finding, figure
from rigidfluid.core.contact.gap_curvature import with_effective_radii
from rigidfluid.core.contact.stokes_number import Film
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.model.types import FluidProblem
from rigidfluid.core.scene.scene import MeshTable

QUESTION = "rebound"
REBOUND = 10.0
"""The Stokes number below which balls were not seen to rebound."""
BALLS = 35.0
"""β of balls in liquids: they come back with exp(-β/St) of the speed of a dry rebound."""


def in_a_film(met: DesignContacts, fluid: FluidProblem, mesh: MeshTable) -> Iterator[Finding]:
    """Say what a law without losses means at the Stokes number of the impact.

    Parameters
    ----------
    met : DesignContacts
        The bodies, with a wall or with each other.
    fluid : FluidProblem
        The fluid; without inertia it lets nothing rebound, and nothing is said.
    mesh : MeshTable
        Sizes of the cells, which may resolve the film before the law acts.

    Yields
    ------
    Finding
        A note for each kind of pair that moves, where no law takes energy out.

    Notes
    -----
    Gondret, Lance and Petit, Phys. Fluids 14 (2002) 643, doi:10.1063/1.1427920; Joseph, Zenit, Hunt and Rosenwinkel,
    J. Fluid Mech. 433 (2001) 329, doi:10.1017/S0022112001003470; β: Legendre, Daniel and Guiraud, Phys. Fluids 17
    (2005) 097105, doi:10.1063/1.2010527.
    """
    if met.law.dissipative or not fluid.inertia:
        return
    radius = np.array([equal_volume_radius(body) for body in met.system.bodies])
    film = Film(fluid.dynamic_viscosity, radius, met.system.loads)
    struck = (met.speed > 0.0) & (met.inverse_mass > 0.0)
    stokes = np.where(struck, met.speed * film.stokes_number(met.contacts), np.inf)
    system = met.system
    curved = with_effective_radii(met.contacts, system.bodies, system.walls, system.pose).effective_radius
    resolved = resolved_gap(mesh, curved)  # NaN is not: no film of facets is known
    for row in met.worst(-stokes):
        if struck[row]:
            yield _finding(met, row, float(stokes[row]), float(resolved[row]))


def _finding(met: DesignContacts, row: int, stokes: float, resolved: float) -> Finding:
    share = float(np.exp(-BALLS / stokes)) if stokes >= REBOUND else 0.0
    seen = f"come back with {figure(share)} of their speed" if share else "do not come back"
    lossless = next(one for one in met.interactions if one.law.conservative)
    text = f"{' and '.join(met.names(row))}: the impact's Stokes number is {figure(stokes)}, where balls in liquids "
    text += f"{seen}, and the law gives back all that reaches its range; "
    if resolved <= lossless.law.range:
        text += f"before that the film takes its part, which the mesh resolves down to a gap of {figure(resolved)}"
        text += f"; {lossless.field}.restitution takes some out of the rest" if share else ""
    else:
        field = lossless.field
        text += f"{field}.restitution and {field}.restitution_stokes = {BALLS:g} take some out"
    found = {"stokes_number": stokes, "rebound": share}
    if np.isfinite(resolved):
        found["resolved"] = resolved
    return Finding("note", QUESTION, met.names(row), text, found=found)
