"""How bodies, contacts and fluid are taken through one step together: predict, follow contacts, solve, converge."""

from __future__ import annotations

from typing import Protocol

from rigidfluid.core.contact.body_step import BodyStep
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Step


class Scheme(Protocol):
    """Scheme of one system's steps."""

    def expect(self, state: State, time: float, size: float) -> Coupling | None:
        """Coupling of a step from ``time`` over ``size`` [time] that its start lets expect; None where nothing can
        touch."""

    def follow(self, state: State, start: float, size: float, coupling: Coupling | None) -> BodyStep:
        """Follow the bodies from ``start`` over ``size`` [time]; raises StepRejected if bodies overlap on the way, or a
        contact is too stiff to be followed."""

    def prepare(self, step: Step, state: State, path: BodyStep) -> Step:
        """Add to a step what its solution has to know of contacts on the bodies' ``path``."""

    def is_unsteady(self, state: State, path: BodyStep, size: float) -> bool:
        """Whether contact impulses changed so much that a second solution of the step is certain."""

    def repeats_start(self, state: State, path: BodyStep) -> bool:
        """Whether a first step is solved again along the path that its solution has shown."""

    def missed_contacts(self, state: State, candidate: State) -> bool:
        """Whether a contact came into range that nobody followed."""

    def converge(self, state: State, candidate: State, path: BodyStep, step: Step) -> tuple[State, bool]:
        """The ``candidate`` with the coupling that its solution has shown, and whether path and solution agree."""

    def bodies_now(self, state: State, time: float) -> BodyDynamics:
        """Dynamics of the bodies of a state as contacts see them, without joints."""
