"""Can the law stop the expected impact?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import Finding, Grade, figure
from rigidfluid.checks.remedies import strength_remedy
from rigidfluid.checks.response import barrier, energy_along
from rigidfluid.core.geometry.arrays import FloatArray

QUESTION = "impact"
_SLACK = 0.8
"""An impact may end at this share of the smallest gap wanted."""


def impact_findings(met: DesignContacts) -> Iterator[Finding]:
    """Compare the energy that the law stores up to contact with that of the impact, in a stack if need be, + W range.

    An error where the law is too weak for the two alone and nothing else brakes; a warning where a fluid or the law's
    dampers brake too, or bodies come down together.
    """
    work = met.energy + met.stacked_weight * met.law.range
    stored = barrier(met.law, met.contacts)
    share = np.divide(stored, work, out=np.full(len(work), np.inf), where=work > 0.0)
    stops_two = stored >= met.pair_energy + met.weight * met.law.range
    gaps = met.turning_gaps()
    for row in met.worst(-share):
        if work[row] > 0.0:
            yield _finding(met, row, float(share[row]), bool(stops_two[row]), float(gaps[row]))
    wanted = met.smallest_gap()
    if wanted is not None:
        yield from _near_findings(met, gaps, wanted)


def _finding(met: DesignContacts, row: int, share: float, stops_two: bool, gap: float) -> Finding:
    found = _figures(met, row, gap if share >= 1.0 else np.nan) | {"barrier_over_impact": share}
    fast = f"{' against '.join(met.names(row))} at a speed of {figure(met.speed[row])}"
    if met.energy[row] > met.pair_energy[row]:
        fast += " (with the bodies that come down on it)"
    if share >= 1.0:
        text = f"{fast} is stopped at a gap of {figure(gap)}, if nothing else brakes it"
        return Finding("note", QUESTION, met.names(row), text, found=found)
    text = f"{fast}: up to contact the law takes up only {figure(share)} of the impact"
    enough, remedy = strength_remedy(met, share)
    braked = met.system.has_fluid or met.law.dissipative
    if braked:
        text += "; the film between them must brake the rest" if met.system.has_fluid else "; dampers brake too"
    grade: Grade = "warning" if braked or stops_two else "error"
    return Finding(grade, QUESTION, met.names(row), text, remedy, found, enough)


def _near_findings(met: DesignContacts, gaps: FloatArray, wanted: float) -> Iterator[Finding]:
    """Report impacts that end nearer than the smallest gap that the scene asks for."""
    needed = met.energy + met.stacked_weight * (met.law.range - wanted)
    stored = energy_along(met.law, met.contacts, np.full((len(gaps), 1), wanted))[:, 0]
    for row in met.worst(-gaps):
        if gaps[row] < _SLACK * wanted:
            enough, remedy = strength_remedy(met, float(stored[row] / needed[row]))
            pair = " and ".join(met.names(row))
            text = f"{pair} may come as near as {figure(gaps[row])}, and smallest_gap is {figure(wanted)}"
            found = _figures(met, row, float(gaps[row]))
            yield Finding("warning", "smallest-gap", met.names(row), text, remedy, found, enough)


def _figures(met: DesignContacts, row: int, gap: float) -> dict[str, float]:
    return {
        "turning_gap": gap,
        "impact_speed": float(met.speed[row]),
        "impact_energy": float(met.energy[row]),
        "pair_energy": float(met.pair_energy[row]),
        "weight_work": float(met.stacked_weight[row] * met.law.range),
    }
