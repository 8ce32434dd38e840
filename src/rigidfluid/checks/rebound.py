"""Rebound expected of an impact in a film, compared with what the law gives back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.film import resolved_gap
from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.contact.laws.film_loss import REBOUND, braking
from rigidfluid.core.contact.laws.stokes_number import stokes_number, stokes_number_taken
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.types import Contacts, Film, Loads
from rigidfluid.core.scene.mesh_tables import MeshTable

QUESTION = "rebound"
BALLS = 35.0
"""β of balls in liquids: they come back with exp(-β/St) of the speed of a dry rebound."""
COMES_BACK = 0.1
"""Least part of the speed that counts as a rebound [1]: a law that gives back more is warned of where nothing should
come back."""
_HALVINGS = 50


def rebound_findings(design: DesignContacts, film: Film, mesh: MeshTable) -> Iterator[Finding]:
    """Compare the rebound that a law without losses gives with that expected at the Stokes number of the impact: a
    warning where nothing should come back and something does, else a note. In a fluid without inertia nothing rebounds,
    and there is no finding.

    Gondret, Lance and Petit, Phys. Fluids 14 (2002) 643, doi:10.1063/1.1427920; Joseph, Zenit, Hunt and Rosenwinkel, J.
    Fluid Mech. 433 (2001) 329, doi:10.1017/S0022112001003470; β: Legendre, Daniel and Guiraud, Phys. Fluids 17 (2005)
    097105, doi:10.1063/1.2010527.
    """
    if design.law.dissipative or not film.inertia:
        return
    struck = (design.speed > 0.0) & (design.inverse_mass > 0.0)
    stokes = np.where(struck, design.speed * stokes_number(design.contacts, film, design.system.loads), np.inf)
    resolved = resolved_gap(mesh, design.effective_radius())  # NaN for facets, whose film is not known
    back = np.where(np.isnan(resolved), 1.0, given_back(design, film, stokes))
    for row in design.worst(-stokes):
        if struck[row]:
            yield _finding(design, film, row, _Rebound(float(stokes[row]), float(resolved[row]), float(back[row])))


def given_back(design: DesignContacts, film: Film, stokes: FloatArray) -> FloatArray:
    """Speed at which a body leaves the law's range, over that of its impact (m,), if the resolved film takes its share
    alone [1]."""
    mass = np.divide(1.0, design.inverse_mass, out=np.ones_like(stokes), where=design.inverse_mass > 0.0)
    brakes = braking(design.law, design.contacts, mass, film, design.system.loads)
    left = np.maximum(1.0 - brakes.outside / stokes, 0.0)
    within = brakes.within(np.maximum(design.speed * left, np.finfo(float).tiny ** 0.25))
    return np.maximum(left - 2.0 * within / stokes, 0.0)


class _Rebound(NamedTuple):
    """An impact at a ``stokes`` number [1]: the gap down to which the mesh has ``resolved`` its film [length], NaN
    where there is none, and the part of the speed that comes ``back`` with that film alone [1]."""

    stokes: float
    resolved: float
    back: float

    @property
    def expected(self) -> float:
        """Part of the speed with which balls in liquids come back [1]."""
        return float(np.exp(-BALLS / self.stokes)) if self.stokes >= REBOUND else 0.0


def _finding(design: DesignContacts, film: Film, row: int, rebound: _Rebound) -> Finding:
    """Note or warning of the contact ``row``; the remedy is a restitution, or a range before which the film stops the
    body."""
    (stokes, resolved, back), share = rebound, rebound.expected
    seen = f"come back with {figure(share)} of their speed" if share else "do not come back"
    lossless = next(one for one in design.interactions if one.law.keeps_apart)
    field = lossless.field
    text = f"{' and '.join(design.names(row))}: the impact's Stokes number is {figure(stokes)}, where balls in liquids "
    text += f"{seen}, and the law gives back all that reaches its range; "
    if resolved <= lossless.law.range:
        text += f"before that the film takes its part, which the mesh resolves down to a gap of {figure(resolved)}"
        text += f", so that {figure(back)} of the speed comes back at range"
        text += f"; {field}.restitution_stokes = {BALLS:g} counts it and takes the rest" if back > share else ""
    else:
        text += f"{field}.restitution_stokes = {BALLS:g} takes some out"
    found = {"stokes_number": stokes, "rebound": share, "comes_back": back}
    if np.isfinite(resolved):
        found["resolved"] = resolved
    if share or back <= COMES_BACK:
        return Finding("note", QUESTION, design.names(row), text, found=found)
    enough, remedy = {"restitution_stokes": BALLS}, f"Set {field}.restitution_stokes to {BALLS:g}"
    thin = _range_that_stops(select(design.contacts, np.array([row])), film, design.system.loads, stokes)
    if thin is not None and thin > resolved:
        remedy, enough["range"] = f"{remedy}, or {field}.range to {round_down(thin)}", thin
    return Finding("warning", QUESTION, design.names(row), text, f"{remedy}.", found, enough)


def _range_that_stops(contacts: Contacts, film: Film, loads: Loads, stokes: float) -> float | None:
    """Widest range before which the film takes so much that COMES_BACK of the speed is left; None if there is none
    [length]."""
    wanted = (1.0 - COMES_BACK) * stokes
    low, high = np.log(film.radius.max()) - 50.0, float(np.log(film.radius.max()))
    if stokes_number_taken(contacts, film, loads, float(np.exp(low)))[0] < wanted:
        return None
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        enough = stokes_number_taken(contacts, film, loads, float(np.exp(middle)))[0] >= wanted
        low, high = (middle, high) if enough else (low, middle)
    return float(np.exp(low))
