"""Can the law hold each body at rest?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.checks.encounters import Encounters
from rigidfluid.checks.finding import Finding, at_most, figure
from rigidfluid.checks.remedies import stronger
from rigidfluid.checks.response import largest_force, rest_gap
from rigidfluid.core.repulsion import Repulsion

QUESTION = "rest"


def at_rest(met: Encounters) -> Iterator[Finding]:
    """Compare the largest force without overlap with the weight, and say at which gap they balance.

    Parameters
    ----------
    met : Encounters
        The bodies, one at a wall or on another body.

    Yields
    ------
    Finding
        One for each kind of pair with weight; an error where the law is too weak.
    """
    rows = np.flatnonzero(met.weight > 0.0)
    if len(rows) == 0:
        return
    most, _ = largest_force(met.law, met.contacts)
    gaps = rest_gap(met.law, met.contacts, met.weight, _deepest(met))
    share = np.divide(most, met.weight, out=np.full(len(most), np.inf), where=met.weight > 0.0)
    for row in met.worst(-share):
        if met.weight[row] > 0.0:
            yield _finding(met, row, float(share[row]), float(gaps[row]))


def under_the_others(met: Encounters) -> Iterator[Finding]:
    """Compare the largest force of a wall on each body with the weight of all bodies that may come to lie on it.

    Parameters
    ----------
    met : Encounters
        The bodies, each at a wall.

    Yields
    ------
    Finding
        A warning for the worst kind of body where the wall's law holds less.
    """
    free = ~met.system.controlled
    together = float(np.linalg.norm(met.system.weight[free].sum(axis=0)))
    if not met.at_walls or np.count_nonzero(free) < 2 or together == 0.0:
        return
    share = largest_force(met.law, met.contacts)[0] / together
    row = int(np.argmin(share))
    if share[row] >= 1.0 or share[row] * together < met.weight[row]:
        return  # that it cannot hold itself is an error of its own
    names = met.names(row)
    text = f"{names[0]} on {names[1]}: the law gives at most {figure(float(share[row]))} of the weight of all bodies"
    text += "; others that come to lie on it may press it through"
    enough, remedy = {"strength": 1.0 / float(share[row])}, "Make the law stronger at walls."
    if isinstance(met.law, Repulsion):
        enough["epsilon_wall"] = float(share[row] * met.law.epsilon(met.contacts)[row])
        remedy = f"Set contact.epsilon_wall to {at_most(enough['epsilon_wall'])} or less."
    found = {"force_over_all_weights": float(share[row]), "all_weights": together}
    yield Finding("warning", "stack", names, text, remedy, found, enough)


def _finding(met: Encounters, row: int, share: float, gap: float) -> Finding:
    pair = " on ".join(met.names(row))
    found = {"force_over_weight": share, "rest_gap": gap, "weight": float(met.weight[row])}
    if share >= 1.0:
        force = "without bound" if np.isinf(share) else f"at most {figure(share)} times its weight"
        text = f"{pair} rests at a gap of {figure(gap)}; the law gives {force}"
        return Finding("note", QUESTION, met.names(row), text, found=found)
    end = "nothing stops it" if np.isnan(gap) else f"it would rest only in overlap, at a gap of {figure(gap)}"
    text = f"{pair}: the law gives at most {figure(share)} of its weight; {end}"
    enough, remedy = stronger(met.law, met.at_walls, share)
    return Finding("error", QUESTION, met.names(row), text, remedy, found, enough)


def _deepest(met: Encounters) -> float:
    """How far into overlap a law is asked: no body is gone through [length]."""
    return min(met.law.range, min(body.bounding_radius for body in met.system.bodies))
