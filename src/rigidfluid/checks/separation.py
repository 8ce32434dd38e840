"""Is there anything at all that keeps the bodies apart?"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from itertools import chain

import numpy as np

from rigidfluid.checks.design_contacts import representative_contacts
from rigidfluid.checks.finding import Finding, Grade, figure
from rigidfluid.core.contact.laws.strength import chosen_strengths
from rigidfluid.core.contact.pairs.representative_contacts import body_classes, facing_normal, free
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.mesh.adaptation.crossing import bodies_cross
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.system import System


def law_findings(system: System) -> Iterator[Finding]:
    """Find moving bodies that no law with an energy keeps apart: a warning in a fluid, whose film also brakes, and an
    error without. A warning for walls or pairs without such a law where there is one elsewhere."""
    moving = [i for i in free(system, range(len(system.bodies))) if _moves(system, i)]
    if not moving:
        return
    if system.law is not None and system.law.keeps_apart:
        yield from _lawless_findings(system)
        return
    text = "nothing keeps bodies apart"
    laws = " and ".join(repr(interaction.law.name) for interaction in system.interactions)
    text += f": law {laws} {_only(system.interactions)}" if laws else ": the scene names no law"
    grade: Grade = "warning" if system.has_fluid else "error"
    remedy = 'Set contact.law = "normal", contact.range and contact.epsilon = "auto".'
    yield Finding(grade, "law", (system.surfaces[moving[0]],), text, remedy, {"moving_bodies": len(moving)})


def _lawless_findings(system: System) -> Iterator[Finding]:
    for design in representative_contacts(system):
        if not any(interaction.law.keeps_apart for interaction in design.interactions):
            names = system.surfaces[design.contacts.body_a[0]], system.surfaces[design.contacts.body_b[0]]
            laws = " and ".join(interaction.field for interaction in design.interactions)
            text = f"nothing keeps {names[0]} and {names[1]} apart: "
            text += f"{laws} {_only(design.interactions)}" if laws else "no law acts between them"
            remedy = "Add an [[interaction]] for them; ignore this if it is intended."
            yield Finding("warning", "law", names, text, remedy, {"pairs": len(design.contacts)})


def open_face_findings(system: System, ends: Container[str | None] = ()) -> Iterator[Finding]:
    """Find surfaces that a weight drives bodies to but that are no walls, and do not repel; a warning for each that is
    not at one of the ``ends``, where bodies leave, and that they do not cross as a periodic one."""
    solid = {wall.name for wall in system.walls}
    crossed = set(chain(*system.domain.periodic)) if bodies_cross(system) else set()
    for number, piece in enumerate(system.domain.pieces):
        if number in crossed:
            continue
        name, moving = piece.name, (kind[0] for kind in body_classes(system) if free(system, kind))
        driven = [body for body in moving if _drives(system, body, piece.shape)]
        if driven and name not in solid and name not in ends:
            text = f"{system.surfaces[driven[0]]} is driven to {name}, which is no wall and does not repel"
            remedy = "End before it gets there, or make that surface a wall."
            yield Finding("warning", "open-face", (system.surfaces[driven[0]], name), text, remedy)


def strength_findings(system: System) -> Iterator[Finding]:
    """Report the largest and the smallest ε that `auto` has chosen, at walls and between bodies, and why."""
    for row in chosen_strengths(system):
        a, b = row.pop("between")
        epsilon, speed, gap = (figure(row[key]) for key in ("epsilon", "impact_speed", "smallest_gap"))
        text = f"{a} and {b}: epsilon is {epsilon}, so that an impact at a speed of {speed} ends at a gap of {gap}"
        yield Finding("note", "auto", (a, b), text, found=row)


def _only(interactions: Sequence[Interaction]) -> str:
    return "only attracts" if any(one.law.conservative for one in interactions) else "only takes energy out"


def _moves(system: System, body: int) -> bool:
    return bool(system.loads.weight[body] > 0.0 or system.loads.speed[body] > 0.0)


def _drives(system: System, body: int, shape: Surface) -> bool:
    """Tell whether the weight is within 60° of pointing at a surface."""
    weight = system.weight[body]
    return bool(weight @ facing_normal(system, body, shape) < -0.5 * np.linalg.norm(weight))
