"""Can the law hold each body at rest?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import Finding, figure
from rigidfluid.checks.remedies import strength_remedy
from rigidfluid.checks.response import largest_force, rest_gap

QUESTION = "rest"
_STACK = "stack"
_ROUNDING = 1e-9


def rest_findings(met: DesignContacts) -> Iterator[Finding]:
    """Compare the largest force without overlap with the weight, and report the gap at which they balance; an error
    where the law is too weak."""
    rows = np.flatnonzero(met.weight > 0.0)
    if len(rows) == 0:
        return
    most, _ = largest_force(met.law, met.contacts)
    gaps = rest_gap(met.law, met.contacts, met.weight, _deepest(met))
    share = np.divide(most, met.weight, out=np.full(len(most), np.inf), where=met.weight > 0.0)
    for row in met.worst(-share):
        if met.weight[row] > 0.0:
            yield _finding(met, row, float(share[row]), float(gaps[row]))


def stack_findings(met: DesignContacts) -> Iterator[Finding]:
    """Compare the largest force without overlap with the weight of all that may come to press on the contact, where
    that is more than its own; a warning where the law is too weak."""
    most, _ = largest_force(met.law, met.contacts)
    borne = (met.stacked_weight > met.weight * (1.0 + _ROUNDING)) & (most >= met.weight)
    share = np.divide(most, met.stacked_weight, out=np.full(len(most), np.inf), where=borne)
    gaps = rest_gap(met.law, met.contacts, met.stacked_weight, _deepest(met))
    for row in met.worst(-share):
        if borne[row]:
            yield _stack_finding(met, row, float(share[row]), float(gaps[row]))


def _stack_finding(met: DesignContacts, row: int, share: float, gap: float) -> Finding:
    pressing = float(met.stacked_weight[row])
    found = {"force_over_stacked_weight": share, "stacked_weight": pressing, "rest_gap": gap}
    text = f"{' on '.join(met.names(row))} may bear a weight of {figure(pressing)} with the bodies that press on it"
    if share >= 1.0:
        return Finding("note", _STACK, met.names(row), f"{text}, and rests at a gap of {figure(gap)}", found=found)
    enough, remedy = strength_remedy(met, share)
    text += f", of which the law gives at most {figure(share)}: they may press it through"
    return Finding("warning", _STACK, met.names(row), text, remedy, found, enough)


def _finding(met: DesignContacts, row: int, share: float, gap: float) -> Finding:
    pair = " on ".join(met.names(row))
    found = {"force_over_weight": share, "rest_gap": gap, "weight": float(met.weight[row])}
    if share >= 1.0:
        force = "without bound" if np.isinf(share) else f"at most {figure(share)} times its weight"
        text = f"{pair} rests at a gap of {figure(gap)}; the law gives {force}"
        return Finding("note", QUESTION, met.names(row), text, found=found)
    end = "nothing stops it" if np.isnan(gap) else f"it would rest only in overlap, at a gap of {figure(gap)}"
    text = f"{pair}: the law gives at most {figure(share)} of its weight; {end}"
    enough, remedy = strength_remedy(met, share)
    return Finding("error", QUESTION, met.names(row), text, remedy, found, enough)


def _deepest(met: DesignContacts) -> float:
    """Greatest overlap at which a law is evaluated [length]: no body is passed through."""
    return min(met.law.range, min(body.bounding_radius for body in met.system.bodies))
