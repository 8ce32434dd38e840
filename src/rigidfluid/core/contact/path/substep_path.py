"""Path of the bodies through one step in velocity Verlet substeps, kicked by their contacts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from rigidfluid.core.contact.path.ball_substeps import ball_substeps
from rigidfluid.core.contact.path.body_step import BodyStep, arrived
from rigidfluid.core.contact.path.contact_load import contact_load
from rigidfluid.core.contact.path.look_ahead import fastest_speeds
from rigidfluid.core.contact.path.modal_substeps import modal_substeps
from rigidfluid.core.contact.path.spring_substeps import spring_substeps
from rigidfluid.core.contact.path.substep import Plan, Reach, plan
from rigidfluid.core.contact.path.substeps import SingleSubsteps, Span, Substeps
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.detection import Sight
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import TangentialSprings
from rigidfluid.core.model.types import Contacts
from rigidfluid.errors import StepRejected

MOST_SUBSTEPS = 100_000
"""Largest number of substeps in one step; more reject it."""

HOPELESS = 1_000 * MOST_SUBSTEPS
"""A planned substep count above this rejects the step at once; separating bodies need fewer in the end, but not by so
much."""

MOST_ALIKE = 1_000
"""Re-plan the substep length after this many equal substeps; separating bodies need fewer."""

SPRING_RESOLUTION = 0.2
"""Substep times the highest frequency of springs in joints: some thirty substeps in a period."""

ROUNDING = 1e-9
"""Remainder of a step, over the step, that is taken for the rounding of sums."""


def fly_freely(system: System, dynamics: BodyDynamics, size: float) -> BodyStep:
    """Advance without contacts, in as many substeps as springs of joints need; ``dynamics`` changes in place."""
    none, parts = nothing(dynamics.pose), spring_parts(system, size)
    for _ in range(parts):
        dynamics.kick(none, 0.5 * size / parts)
        dynamics.drift(size / parts)
        dynamics.kick(none, 0.5 * size / parts)
    return arrived(dynamics, none, 0.0, 0.0, parts)


def spring_parts(system: System, size: float) -> int:
    """Number of parts of a step that resolve the springs of joints."""
    return max(1, ceil(size * system.joints.frequency / SPRING_RESOLUTION))


@dataclass(frozen=True)
class SubstepPath:
    """Path of bodies through one step of this ``size`` [time], on which a ``law`` kicks them; their ``dynamics``
    changes in place. ``springs``: those along surfaces at its start, None without any."""

    system: System
    law: ForceLaw
    dynamics: BodyDynamics
    size: float
    springs: TangentialSprings | None = None

    def advance(self, sight: Sight, contacts: Contacts) -> BodyStep:
        """Advance by velocity Verlet: half a kick, a drift, half a kick; the second is that of the new pose.

        The ``contacts`` are those at the start, as far as the ``sight`` reaches.

        Substeps are planned for a span of the ``sight`` at a time, and again while nothing is in range. The sight is
        widened then for bodies that contacts have made faster.
        """
        system, dynamics, size = self.system, self.dynamics, self.size
        impulse, dissipated, actuator_work, count, left = nothing(dynamics.pose), 0.0, 0.0, 0, size
        load = contact_load(system, self.law, contacts, dynamics, self.springs)
        dissipated += load.slipped
        substeps = _substeps(system, self.law, dynamics)
        planned, free_flight, substep, longest = 0.0, 0.0, 0.0, size / spring_parts(system, size)
        while left > 0.0:
            if planned <= 0.0 or contacts.gap.min(initial=np.inf) > self.law.range:
                wider = system.detection.widened(sight, dynamics, size) if count else sight
                if wider is not sight:
                    sight, contacts = wider, wider.contacts_at(dynamics.pose)
                if left > HOPELESS * sight.span:
                    raise self._too_fast(sight.span)
                planned = min(left, sight.span)
                free_flight, substep = self._next_plan(contacts, planned)
                planned = min(planned, free_flight + MOST_ALIKE * substep)
            part = min(free_flight or substep, left, longest)
            most = 1 if free_flight else MOST_SUBSTEPS - count
            span = Span(left, planned, part, most, ROUNDING * size, not system.substeps)
            done = substeps.advance(span, sight, load, impulse)
            left, planned, contacts, load = done.left, done.planned, done.contacts, done.load
            dissipated += done.dissipated
            actuator_work += done.actuator_work
            count += done.substeps
            free_flight = free_flight - part if free_flight - part > ROUNDING * size else 0.0
            if count == MOST_SUBSTEPS and left > 0.0:
                raise _too_stiff(system, contacts, part)
        path = arrived(dynamics, impulse, dissipated, actuator_work, count)
        return path if load.springs is None else replace(path, springs=load.springs)

    def _too_fast(self, span: float) -> StepRejected:
        fastest = int(np.argmax(fastest_speeds(self.system, self.dynamics, self.size)))
        found = f"a speed with which contacts can be foreseen for {span:.1e} of a step of {self.size:.1e}"
        subject = f"body {self.system.surfaces[fastest]}"
        return StepRejected(subject, found, "slower bodies", "Look at velocities, gravity and units.")

    def planned(self, contacts: Contacts, span: float) -> Plan:
        """Free flight and substep of the next ``span`` [time], as the contacts need them."""
        reach = _surface_reach(self.system)
        return plan(self.law, contacts, self.dynamics, reach, self.size, span, self.system.quasi_steady)

    def _next_plan(self, contacts: Contacts, span: float) -> Plan:
        """Substeps of the scene where it fixes their number, else as planned; raises StepRejected if they are far too
        many."""
        if self.system.substeps:
            return Plan(0.0, self.size / self.system.substeps)
        planned = self.planned(contacts, span)
        touch = contacts.gap.min(initial=np.inf) <= self.law.range
        if touch and span - planned.free_flight > HOPELESS * planned.substep:
            raise _too_stiff(self.system, contacts, planned.substep)
        return planned


def _substeps(system: System, law: ForceLaw, dynamics: BodyDynamics) -> Substeps:
    """Compiled substeps where these are for such bodies and laws, else one by one."""
    for maker in (ball_substeps, spring_substeps, modal_substeps):
        if (found := maker(system, law, dynamics)) is not None:
            return found
    return SingleSubsteps(system, law, dynamics)


def _surface_reach(system: System) -> Reach:
    """Reach of the bodies' surface points: balls turn in their place, but not as components of a mechanism."""
    if not system.motions.names:
        return Reach(system.arms, system.rotational_factor)
    radii = system.bounding_radii
    alone = np.bincount(system.motions.carrier)[system.motions.carrier] == 1
    return Reach(np.where(alone, system.arms, radii), system.rotational_factor)


def _too_stiff(system: System, contacts: Contacts, part: float) -> StepRejected:
    """Error of contacts that need substeps as short as ``part`` [time]; it names the body with the least gap."""
    subject = "the bodies"
    if len(contacts):
        subject = f"body {system.surfaces[contacts.body_a[int(np.argmin(contacts.gap))]]}"
    return StepRejected(
        subject,
        f"a contact that needs substeps of {part:.1e}",
        f"at most {MOST_SUBSTEPS} substeps in a step",
        "Soften the contact force: raise its epsilon, or widen its range.",
    )
