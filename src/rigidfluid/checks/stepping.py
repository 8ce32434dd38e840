"""Duration of contacts, and the substeps that resolve it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, log2

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import Finding, Grade, figure, round_down
from rigidfluid.core.contact.path.substep import RESOLUTION
from rigidfluid.core.contact.path.substep_path import MOST_SUBSTEPS
from rigidfluid.core.scene.run_tables import TimeTable

QUESTION = "step"
_STABLE = 2.0
"""Greatest frequency times substep at which Verlet's scheme is stable [1]."""
ACCURATE = 0.5
"""Greatest frequency times step at which a contact is resolved [1]."""


def step_findings(design: DesignContacts, time: TimeTable) -> Iterator[Finding]:
    """Compare the contact time π/ω, ω = √(k/m) with the greatest stiffness k that the impact reaches, with the step and
    its substeps.

    For fixed substeps h, ω h > 2 is an error and ω h > 0.5 a warning; for an implicit step h, ω h > 0.5 is a warning
    where there are dampers. Substeps that adapt are a warning, or an error, where they become too many.
    """
    stiffness = design.stiffness()
    frequency = np.sqrt(stiffness * design.inverse_mass)
    for row in design.worst(frequency):
        if frequency[row] > 0.0:
            yield _finding(design, row, float(frequency[row]), float(stiffness[row]), time)


def _finding(design: DesignContacts, row: int, frequency: float, stiffness: float, time: TimeTable) -> Finding:
    contact_time = np.pi / frequency
    found = {
        "contact_time": contact_time,
        "stiffness": stiffness,
        "frequency": frequency,
        "contact_time_over_step": contact_time / time.step,
        "way_over_range": float(design.speed[row]) * time.step / design.law.range,
    }
    pair = " and ".join(design.names(row))
    text = f"{pair}: a contact lasts about {figure(contact_time)}, and a step {figure(time.step)}"
    note = Finding("note", QUESTION, design.names(row), text, found=found)
    if design.system.implicit:
        return _implicit_finding(note, frequency, time, design.law.dissipative)
    if design.system.substeps is None:
        return _adapted_finding(note, frequency, time)
    return _fixed_finding(note, frequency * time.step, design.system.substeps)


def _extended(note: Finding, text: str, **found: float) -> Finding:
    """The note with this ``text`` and these figures added."""
    return replace(note, text=note.text + text, found={**note.found, **found})


def _fixed_finding(note: Finding, turn: float, substeps: int) -> Finding:
    """Judge fixed substeps by ω h; ``turn`` is ω times the whole step."""
    turn_per_substep = turn / substeps
    text = f" of {substeps} substeps; frequency times substep is {figure(turn_per_substep)}"
    note = _extended(note, text, substeps=substeps, turn_per_substep=turn_per_substep)
    if turn_per_substep <= ACCURATE:
        return note
    unstable = turn_per_substep > _STABLE
    grade: Grade = "error" if unstable else "warning"
    text = ", which explodes above 2" if unstable else ", which is inaccurate above 0.5"
    enough = {"substeps": ceil(turn / ACCURATE)}
    remedy = f"Set contact.substeps to {enough['substeps']} or more, or leave it out."
    return replace(_extended(note, text), grade=grade, remedy=remedy, enough=enough)


def _implicit_finding(note: Finding, frequency: float, time: TimeTable, damped: bool) -> Finding:
    turn = frequency * time.step
    note = _extended(note, f", which is implicit; frequency times step is {figure(turn)}", turn_per_step=turn)
    if turn <= ACCURATE or not damped:
        return note
    enough = {"time_step": ACCURATE / frequency}
    remedy = f"Set time.step to {round_down(enough['time_step'])} or less, or contact.stepping to substeps."
    return replace(_extended(note, ": dampers are missed above 0.5"), grade="warning", remedy=remedy, enough=enough)


def _adapted_finding(note: Finding, frequency: float, time: TimeTable) -> Finding:
    substeps = _adapted_substeps(time.step, frequency)
    note = _extended(note, f", divided into about {substeps}", substeps=substeps)
    if substeps <= MOST_SUBSTEPS:
        return note
    enough = {"time_step": MOST_SUBSTEPS * RESOLUTION / frequency / 2.0}  # their number is rounded up, to twice at most
    remedy = f"Soften the law, widen its range, or set time.step to {round_down(enough['time_step'])} or less."
    note = replace(note, grade="warning", remedy=remedy, enough=enough)
    if _adapted_substeps(time.shortest, frequency) <= MOST_SUBSTEPS:
        return _extended(note, ": steps will be cut")
    text = f", and even the shortest step more than the {MOST_SUBSTEPS} that are allowed"
    return replace(_extended(note, text), grade="error")


def _adapted_substeps(step: float, frequency: float) -> int:
    """Number of substeps, a power of two, that resolve a contact."""
    return int(2 ** ceil(log2(max(step * frequency / RESOLUTION, 1.0))))
