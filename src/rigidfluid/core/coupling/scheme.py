"""Scheme that takes bodies, contacts and fluid through a step: predict, follow contacts, solve, converge."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Mesh, Pose, Step


class Scheme(Protocol):
    """Scheme of one system's steps.

    A step expects a coupling, follows the bodies with it, prepares what the backend solves, and converges; until path
    and solution agree, it follows the bodies again with the coupling that the solution has shown.
    """

    def expect(self, state: State, time: float, size: float) -> Coupling | None:
        """Expected coupling of bodies and fluid in a step from ``time`` over ``size`` [time], by what is known at its
        start; None where nothing can touch, and without a fluid."""

    def follow(self, state: State, start: float, size: float, coupling: Coupling | None) -> BodyStep:
        """Follow the bodies from ``start`` over ``size`` [time]; raises StepRejected if bodies overlap on their path,
        or a contact is too stiff to be followed."""

    def prepare(self, step: Step, state: State, path: BodyStep) -> Step:
        """Add to a step what its solution has to know of contacts on the bodies' ``path``; its load may be changed in
        place."""

    def is_unsteady(self, state: State, path: BodyStep, size: float) -> bool:
        """Tell whether contact impulses changed so much that a second solution of the step is certain."""

    def changes_gaps_too_fast(self, state: State, pose: Pose, mesh_at: Callable[[Pose], Mesh]) -> bool:
        """Tell whether gaps change by more than a step to ``pose`` can follow, on the mesh ``mesh_at(pose)``."""

    def restarted(self, state: State, first_level: int) -> State:
        """The state at a corner, where rates change at once; ``first_level``: of a step that follows a fluid's layers
        from there."""

    def repeats_start(self, state: State, path: BodyStep) -> bool:
        """Tell whether a step without a past, as the first, is solved again along the path that its solution shows."""

    def converge(self, state: State, candidate: State, path: BodyStep, step: Step) -> tuple[State, bool]:
        """The ``candidate`` with the coupling that its solution has shown, and whether path and solution agree."""

    def bodies_now(self, state: State, time: float) -> BodyDynamics:
        """Dynamics of the bodies of a state as contacts see them, without joints."""
