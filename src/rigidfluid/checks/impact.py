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


def impact_findings(design: DesignContacts) -> Iterator[Finding]:
    """Compare the energy that the law stores up to contact with that of the impact, in a stack if need be, + W range.

    An error where the law is too weak for the two alone and nothing else brakes; a warning where a fluid or the law's
    dampers brake too, or bodies come down together.
    """
    work = design.energy + design.stacked_weight * design.law.range
    stored = barrier(design.law, design.contacts)
    share = np.divide(stored, work, out=np.full(len(work), np.inf), where=work > 0.0)
    stops_two = stored >= design.pair_energy + design.weight * design.law.range
    gaps = design.turning_gaps()
    for row in design.worst(-share):
        if work[row] > 0.0:
            yield _finding(design, row, float(share[row]), bool(stops_two[row]), float(gaps[row]))
    wanted = design.smallest_gap()
    if wanted is not None:
        yield from _near_findings(design, gaps, wanted)


def _finding(design: DesignContacts, row: int, share: float, stops_two: bool, gap: float) -> Finding:
    found = _figures(design, row, gap if share >= 1.0 else np.nan) | {"barrier_over_impact": share}
    fast = f"{' against '.join(design.names(row))} at a speed of {figure(design.speed[row])}"
    if design.energy[row] > design.pair_energy[row]:
        fast += " (with the bodies that come down on it)"
    if share >= 1.0:
        text = f"{fast} is stopped at a gap of {figure(gap)}, if nothing else brakes it"
        return Finding("note", QUESTION, design.names(row), text, found=found)
    told = figure(min(share, 0.999))  # not 1, which would be enough
    text = f"{fast}: up to contact the law takes up only {told} of the impact"
    enough, remedy = strength_remedy(design, share)
    braked = design.system.has_fluid or design.law.dissipative
    if braked:
        text += "; the film between them must brake the rest" if design.system.has_fluid else "; dampers brake too"
    grade: Grade = "warning" if braked or stops_two else "error"
    return Finding(grade, QUESTION, design.names(row), text, remedy, found, enough)


def _near_findings(design: DesignContacts, gaps: FloatArray, wanted: float) -> Iterator[Finding]:
    """Report impacts that end nearer than the smallest gap that the scene asks for."""
    needed = design.energy + design.stacked_weight * (design.law.range - wanted)
    stored = energy_along(design.law, design.contacts, np.full((len(gaps), 1), wanted))[:, 0]
    for row in design.worst(-gaps):
        if gaps[row] < _SLACK * wanted:
            enough, remedy = strength_remedy(design, float(stored[row] / needed[row]))
            pair = " and ".join(design.names(row))
            text = f"{pair} may come as near as {figure(gaps[row])}, and smallest_gap is {figure(wanted)}"
            found = _figures(design, row, float(gaps[row]))
            yield Finding("warning", "smallest-gap", design.names(row), text, remedy, found, enough)


def _figures(design: DesignContacts, row: int, gap: float) -> dict[str, float]:
    return {
        "turning_gap": gap,
        "impact_speed": float(design.speed[row]),
        "impact_energy": float(design.energy[row]),
        "pair_energy": float(design.pair_energy[row]),
        "weight_work": float(design.stacked_weight[row] * design.law.range),
    }
