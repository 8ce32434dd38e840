"""Duration of contacts, and the substeps that resolve it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, log2

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import Finding, Grade, figure, round_down
from rigidfluid.core.contact.substep import RESOLUTION
from rigidfluid.core.contact.substep_path import MOST_SUBSTEPS
from rigidfluid.core.scene.scene import TimeTable

QUESTION = "step"
_STABLE = 2.0
"""Verlet's scheme explodes above this substep times frequency."""
ACCURATE = 0.5
"""Greatest frequency times step at which a contact is resolved [1]."""


def step_findings(design: DesignContacts, time: TimeTable) -> Iterator[Finding]:
    """Compare the contact time π √(m/k), k the greatest stiffness that the impact reaches, with the step and its
    substeps.

    For fixed substeps h, ω h > 2 is an error and ω h > 0.5 a warning; for one implicit step h, ω h > 0.5 is a warning
    where there are dampers.
    """
    stiffness = design.stiffness()
    frequency = np.sqrt(stiffness * design.inverse_mass)
    for row in design.worst(frequency):
        if frequency[row] > 0.0:
            yield _finding(design, row, float(frequency[row]), float(stiffness[row]), time)


def _finding(design: DesignContacts, row: int, frequency: float, stiffness: float, time: TimeTable) -> Finding:
    found = {
        "contact_time": np.pi / frequency,
        "stiffness": stiffness,
        "frequency": frequency,
        "contact_time_over_step": np.pi / frequency / time.step,
        "way_over_range": float(design.speed[row]) * time.step / design.law.range,
    }
    pair = " and ".join(design.names(row))
    text = f"{pair}: a contact lasts about {figure(np.pi / frequency)}, and a step {figure(time.step)}"
    note = Finding("note", QUESTION, design.names(row), text, found=found)
    if design.system.implicit:
        return _implicit_finding(note, frequency, time, design.law.dissipative)
    if design.system.substeps is None:
        return _adapted_finding(note, frequency, time)
    return _fixed_finding(note, frequency * time.step, design.system.substeps)


def _told(note: Finding, text: str, **found: float) -> Finding:
    """The note with more ``text`` and figures."""
    return replace(note, text=note.text + text, found={**note.found, **found})


def _fixed_finding(note: Finding, turn: float, substeps: int) -> Finding:
    """Compare a fixed substep with the contact's frequency; ``turn`` is ω times the step."""
    each = turn / substeps
    text = f" of {substeps} substeps; frequency times substep is {figure(each)}"
    note = _told(note, text, substeps=substeps, turn_per_substep=each)
    if each <= ACCURATE:
        return note
    grade: Grade = "error" if each > _STABLE else "warning"
    more = ", which explodes above 2" if each > _STABLE else ", which is inaccurate above 0.5"
    enough = {"substeps": ceil(turn / ACCURATE)}
    remedy = f"Set contact.substeps to {enough['substeps']} or more, or leave it out."
    return replace(_told(note, more), grade=grade, remedy=remedy, enough=enough)


def _implicit_finding(note: Finding, frequency: float, time: TimeTable, damped: bool) -> Finding:
    turn = frequency * time.step
    note = _told(note, f", which is implicit; frequency times step is {figure(turn)}", turn_per_step=turn)
    if turn <= ACCURATE or not damped:
        return note
    enough = {"time_step": ACCURATE / frequency}
    remedy = f"Set time.step to {round_down(enough['time_step'])} or less, or contact.stepping to substeps."
    return replace(_told(note, ": dampers are missed above 0.5"), grade="warning", remedy=remedy, enough=enough)


def _adapted_finding(note: Finding, frequency: float, time: TimeTable) -> Finding:
    substeps, least = (2 ** ceil(log2(max(size * frequency / RESOLUTION, 1.0))) for size in (time.step, time.shortest))
    note = _told(note, f", divided into about {substeps}", substeps=substeps)
    if substeps <= MOST_SUBSTEPS:
        return note
    enough = {"time_step": MOST_SUBSTEPS * RESOLUTION / frequency / 2.0}
    remedy = f"Soften the law, widen its range, or set time.step to {round_down(enough['time_step'])} or less."
    note = replace(note, grade="warning", remedy=remedy, enough=enough)
    if least <= MOST_SUBSTEPS:
        return _told(note, ": steps will be cut")
    text = f", and even the shortest step more than the {MOST_SUBSTEPS} that are allowed"
    return replace(_told(note, text), grade="error")
