"""The energy balance of a run: what came in, what went out, and what is there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any


class Cause(StrEnum):
    """Cause of a step's part of the residual: the entry of the ledger that it is added to."""

    START = "residual_start"
    REMESHING = "residual_remeshing"
    CONTACTS = "residual_contacts"


@dataclass(frozen=True, slots=True)
class Power:
    """Rates at one time [energy/time]: of what enters by the boundary, of what drives bodies through the fluid, of
    viscous dissipation, also ``dissipation_midway`` through the step that led there, of what the dampers of joints
    take, of what convection takes through faces that let nothing pass, of grad-div stabilisation, and of the force on
    the fluid; and in a step without a past ``stress_power``, of the end's viscous stress in the mean velocity of the
    step that led there."""

    boundary: float = 0.0
    control: float = 0.0
    dissipation: float = 0.0
    dissipation_midway: float = 0.0
    damping: float = 0.0
    spurious_flux: float = 0.0
    grad_div: float = 0.0
    source: float = 0.0
    stress_power: float | None = None


@dataclass(frozen=True, slots=True)
class Work:
    """Work done in one step [energy]: by gravity, by what drives bodies and walls against contacts, what the dampers of
    contacts took, and what friction took between the fluid's solutions, ``drag_loss`` where the fluid has no inertia
    and that is known for certain."""

    gravity: float = 0.0
    control: float = 0.0
    contact_loss: float = 0.0
    path_friction: float = 0.0
    drag_loss: float = 0.0


@dataclass(frozen=True, slots=True)
class Ledger:
    """Sums since the start [energy], and what is stored now.

    Stored: ``kinetic`` (fluid and bodies), ``contact`` (and springs). In: ``gravity``, ``boundary``, ``control``,
    ``body_force`` (on the fluid), ``exchange`` (with bodies that entered, less what left with others). Out:
    ``dissipation``, ``grad_div_loss`` (by stabilisation), ``contact_loss`` (by dampers of contacts and joints),
    ``transfer_loss`` (by re-meshing).
    ``path_friction`` is no part of the balance: of what it leaves unaccounted for, friction in impacts shorter than a
    step explains so much at most, since the fluid's own solutions see some of it.
    The residual has five parts. ``residual_mesh``: spurious flux through faces. The rest of each step's is in
    ``residual_start``, ``residual_remeshing`` or ``residual_contacts`` where a `Cause` is named for it, and else in
    ``residual_steps``; ``in_impact`` says whether contacts were the cause in the latest step, and ``smooth_rate`` is
    how fast the residual grew in the latest step without a cause [energy/time].
    ``since_start``: time since a fluid with inertia was last set in motion at once, infinite where it never was [time].
    ``initial`` was stored at the start; ``power`` is now's, None where a flow in motion starts and nobody knows it yet.
    """

    kinetic: float
    contact: float
    initial: float
    gravity: float = 0.0
    boundary: float = 0.0
    control: float = 0.0
    body_force: float = 0.0
    exchange: float = 0.0
    dissipation: float = 0.0
    grad_div_loss: float = 0.0
    contact_loss: float = 0.0
    transfer_loss: float = 0.0
    path_friction: float = 0.0
    residual_start: float = 0.0
    residual_remeshing: float = 0.0
    residual_contacts: float = 0.0
    residual_mesh: float = 0.0
    in_impact: bool = False
    smooth_rate: float = 0.0
    since_start: float = math.inf
    power: Power | None = Power()

    @property
    def residual_steps(self) -> float:
        """The part of all other steps: motion and flow are smooth there, and the error is that of the time scheme."""
        special = self.residual_start + self.residual_remeshing + self.residual_contacts + self.residual_mesh
        return self.residual - special

    @property
    def works(self) -> tuple[float, ...]:
        """Energies supplied since the start: by gravity, faces, what drives bodies, the force on the fluid, and bodies
        that entered."""
        return self.gravity, self.boundary, self.control, self.body_force, self.exchange

    @property
    def residual(self) -> float:
        """Energy that the balance does not account for: in - out - (stored now - stored at the start)."""
        incoming = sum(self.works)
        outgoing = self.dissipation + self.grad_div_loss + self.contact_loss + self.transfer_loss
        return incoming - outgoing - (self.kinetic + self.contact - self.initial)

    @property
    def put_in(self) -> float:
        """Energy stored at the start, of attraction its size, and that which came in since, as far as more came in than
        went out the same way."""
        return abs(self.initial) + sum(max(work, 0.0) for work in self.works)

    @property
    def relative_residual(self) -> float:
        """The residual over the energy that has passed through."""
        passed = max(sum(map(abs, self.works)), self.kinetic, abs(self.initial))
        return self.residual / passed if passed > 0 else 0.0

    def after(self, step: float, power: Power, work: Work, kinetic: float, contact: float) -> Ledger:
        """Ledger one step later, rates integrated by the trapezoidal rule.

        Dissipation is by Simpson's, exact for velocities that change linearly: in an impact they change their sign. A
        power unknown at the start is taken from the end of the first step. Dissipation is then the
        work of the step's own viscous impulse: the rate at the start is that of a layer without thickness.
        """
        before = self.power or power

        def total(name: str, sum_before: float) -> float:
            mean: float = 0.5 * (getattr(before, name) + getattr(power, name))
            return sum_before + step * mean

        damped = 0.5 * step * (before.damping + power.damping)
        dissipated = (before.dissipation + 4.0 * power.dissipation_midway + power.dissipation) / 6.0
        if self.power is None and power.stress_power is not None:
            dissipated = power.stress_power
        return replace(
            self,
            kinetic=kinetic,
            contact=contact,
            gravity=self.gravity + work.gravity,
            boundary=total("boundary", self.boundary),
            control=total("control", self.control) + work.control,
            body_force=total("source", self.body_force),
            dissipation=self.dissipation + step * dissipated + work.drag_loss,
            grad_div_loss=total("grad_div", self.grad_div_loss),
            contact_loss=self.contact_loss + work.contact_loss + damped,
            path_friction=self.path_friction + work.path_friction,
            residual_mesh=total("spurious_flux", self.residual_mesh),
            since_start=self.since_start + step,
            power=power,
        )

    def attributed(self, before: Ledger, step: float, cause: Cause | None) -> Ledger:
        """This ledger with the growth of the residual in a ``step`` since ``before``, beyond the spurious flux, put to
        the ``cause``; to re-meshing, as far as more grew, or otherwise, than in as much time of smooth motion before
        it."""
        grown = self.residual - before.residual - (self.residual_mesh - before.residual_mesh)
        if cause is None:
            return replace(self, in_impact=False, smooth_rate=grown / step)
        smooth = _common(grown, step * before.smooth_rate) if cause is Cause.REMESHING else 0.0
        part: Any = {cause.value: getattr(self, cause.value) + grown - smooth}
        return replace(self, in_impact=cause is Cause.CONTACTS, **part)

    def after_exchange(self, kinetic: float, contact: float) -> Ledger:
        """The ledger after bodies entered or left, by what is stored then."""
        gained = kinetic + contact - self.kinetic - self.contact
        return replace(self, kinetic=kinetic, contact=contact, exchange=self.exchange + gained)

    def after_transfer(self, loss: float) -> Ledger:
        """The ledger after a transfer that lost this much kinetic energy."""
        return replace(self, kinetic=self.kinetic - loss, transfer_loss=self.transfer_loss + loss)


def _common(a: float, b: float) -> float:
    """The smaller of both where they have the same sign, else zero."""
    return min(a, b, key=abs) if a * b > 0.0 else 0.0
