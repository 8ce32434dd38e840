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


def rest_findings(design: DesignContacts) -> Iterator[Finding]:
    """Compare the largest force without overlap with the weight, and report the gap at which they balance; an error
    where the law is too weak."""
    rows = np.flatnonzero(design.weight > 0.0)
    if len(rows) == 0:
        return
    most, _ = largest_force(design.law, design.contacts)
    gaps = rest_gap(design.law, design.contacts, design.weight, _deepest(design))
    share = np.divide(most, design.weight, out=np.full(len(most), np.inf), where=design.weight > 0.0)
    for row in design.worst(-share):
        if design.weight[row] > 0.0:
            yield _finding(design, row, float(share[row]), float(gaps[row]))


def stack_findings(design: DesignContacts) -> Iterator[Finding]:
    """Compare the largest force without overlap with the weight of all that may come to press on the contact, where
    that is more than its own; a warning where the law is too weak."""
    most, _ = largest_force(design.law, design.contacts)
    borne = (design.stacked_weight > design.weight * (1.0 + _ROUNDING)) & (most >= design.weight)
    share = np.divide(most, design.stacked_weight, out=np.full(len(most), np.inf), where=borne)
    gaps = rest_gap(design.law, design.contacts, design.stacked_weight, _deepest(design))
    for row in design.worst(-share):
        if borne[row]:
            yield _stack_finding(design, row, float(share[row]), float(gaps[row]))


def _stack_finding(design: DesignContacts, row: int, share: float, gap: float) -> Finding:
    pressing = float(design.stacked_weight[row])
    found = {"force_over_stacked_weight": share, "stacked_weight": pressing, "rest_gap": gap}
    text = f"{' on '.join(design.names(row))} may bear a weight of {figure(pressing)} with the bodies that press on it"
    if share >= 1.0:
        return Finding("note", _STACK, design.names(row), f"{text}, and rests at a gap of {figure(gap)}", found=found)
    enough, remedy = strength_remedy(design, share)
    text += f", of which the law gives at most {figure(share)}: they may press it through"
    return Finding("warning", _STACK, design.names(row), text, remedy, found, enough)


def _finding(design: DesignContacts, row: int, share: float, gap: float) -> Finding:
    pair = " on ".join(design.names(row))
    found = {"force_over_weight": share, "rest_gap": gap, "weight": float(design.weight[row])}
    if share >= 1.0:
        force = "without bound" if np.isinf(share) else f"at most {figure(share)} times its weight"
        text = f"{pair} rests at a gap of {figure(gap)}; the law gives {force}"
        return Finding("note", QUESTION, design.names(row), text, found=found)
    end = "nothing stops it" if np.isnan(gap) else f"it would rest only in overlap, at a gap of {figure(gap)}"
    text = f"{pair}: the law gives at most {figure(share)} of its weight; {end}"
    enough, remedy = strength_remedy(design, share)
    return Finding("error", QUESTION, design.names(row), text, remedy, found, enough)


def _deepest(design: DesignContacts) -> float:
    """Greatest overlap at which a law is evaluated [length]: no body is passed through."""
    return min(design.law.range, float(design.system.bounding_radii.min()))
