"""Substeps of velocity Verlet, one by one, whatever the bodies, their contacts and the law are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from rigidfluid.core.contact.pairs.proximity import refuse_overlap
from rigidfluid.core.contact.path.body_step import add_wrench
from rigidfluid.core.contact.path.contact_load import ContactLoad, contact_load, damping_loss
from rigidfluid.core.model.detection import Sight
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Wrench


class Span(NamedTuple):
    """Time over which substeps are equal: ``left`` of the step and ``planned`` [time], the ``substep``, ``most`` of
    them, the remainder taken for ``rounding`` [time], and whether it ``stops`` as soon as nothing is in range."""

    left: float
    planned: float
    substep: float
    most: int
    rounding: float
    stops: bool


class SubstepResult(NamedTuple):
    """Result of some ``substeps``, as many as this says: the time ``left`` and ``planned`` after them, ``contacts`` and
    their ``load`` at their end, and the energies ``dissipated`` and of ``actuator_work``."""

    substeps: int
    left: float
    planned: float
    contacts: Contacts
    load: ContactLoad
    dissipated: float
    actuator_work: float


class Substeps(Protocol):
    """Takes substeps; the dynamics of the bodies change in place."""

    def advance(self, span: Span, sight: Sight, load: ContactLoad, impulse: Wrench) -> SubstepResult:
        """Take at least one substep of a ``span`` in ``sight``, from a ``load``, and add to the ``impulse`` in place;
        raises StepRejected where surfaces overlap."""


@dataclass(frozen=True)
class SingleSubsteps:
    """`Substeps` one by one, of bodies with these ``dynamics`` under a ``law``."""

    system: System
    law: ForceLaw
    dynamics: BodyDynamics

    def advance(self, span: Span, sight: Sight, load: ContactLoad, impulse: Wrench) -> SubstepResult:
        system, dynamics, part = self.system, self.dynamics, span.substep
        dynamics.kick(load.wrench, 0.5 * part)
        dynamics.drift(part)
        contacts = sight.contacts_at(dynamics.pose)
        _refuse_overlaps(system, contacts)
        before, load = load, contact_load(system, self.law, contacts, dynamics, load.springs, part)
        dynamics.kick(load.wrench, 0.5 * part)
        load = load._replace(loss=damping_loss(system, contacts, dynamics, load.damping))
        add_wrench(add_wrench(impulse, before.wrench, 0.5 * part), load.wrench, 0.5 * part)
        dissipated = 0.5 * part * (before.loss + load.loss) + load.slipped
        actuator_work = 0.5 * part * (before.actuator_work + load.actuator_work)
        left = span.left - part if span.left - part > span.rounding else 0.0
        return SubstepResult(1, left, span.planned - part, contacts, load, dissipated, actuator_work)


def _refuse_overlaps(system: System, contacts: Contacts) -> None:
    """Raise StepRejected if the surfaces of a contact touch or overlap."""
    if len(contacts) == 0 or contacts.gap.min() > 0.0:
        return
    worst = int(np.argmin(contacts.gap))
    refuse_overlap(system, int(contacts.body_a[worst]), float(contacts.gap[worst]))
