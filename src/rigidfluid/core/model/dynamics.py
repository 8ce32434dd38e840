"""Dynamics of bodies between contacts, as contacts, joints and motions see them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, Self

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.state import LinkLoad, MotionState
from rigidfluid.core.model.types import Pose, Twist, Wrench


@dataclass(frozen=True, slots=True)
class LinkWork:
    """Sums over the work of joints: the ``impulse`` (c,) of each link [force·time | force·length·time], the ``pushed``
    (N, d+k) impulse of all links and springs on the motions, the energies ``drive_work``, put into the motions by
    prescribed ones, and ``damped`` away [energy]."""

    impulse: FloatArray
    pushed: FloatArray
    drive_work: float
    damped: float

    def load(self, time: float) -> LinkLoad:
        """Mean loads over ``time``."""
        return LinkLoad(self.impulse / time, self.pushed / time)


class BodyDynamics(Protocol):
    """Dynamics of n bodies; kicked and drifting in turn they follow the velocity Verlet scheme."""

    @property
    def pose(self) -> Pose:
        """Present pose."""

    @property
    def kinematics(self) -> Kinematics:
        """Present G and g of the motions that carry the bodies."""

    @property
    def motion_twist(self) -> Twist:
        """Present twist of the motions that carry the bodies."""

    @property
    def twist(self) -> Twist:
        """Present twist."""

    def inverse_mass_along(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """Inverse mass e·M⁻¹e of some bodies (m,) in directions e (m, d), (m,); zero for prescribed bodies [1/mass]."""

    @property
    def inverse_mass(self) -> FloatArray:
        """Inverse mass M⁻¹ of each body alone in translation (n, d, d), zero for prescribed bodies [1/mass]."""

    @property
    def inverse_inertia(self) -> FloatArray:
        """Inverse inertia (R I Rᵀ)⁻¹ (n, k, k), zero for prescribed bodies [1/(mass·length²)]."""

    def inverse_masses(self, time: float) -> Any:
        """Matrix M⁻¹ of all velocities (n·(d+k), n·(d+k)), an array or sparse, zero for prescribed bodies: M⁻¹ W
        ``time`` is the change of the velocities by a wrench W that lasts for ``time`` [1/mass | 1/(mass·length²)]."""

    @property
    def friction_loss(self) -> float:
        """Energy dissipated by drag within substeps, unresolved by the fluid solves [energy]."""

    @property
    def drag_left_out(self) -> float:
        """Energy by which the fluid solves take less than their flow dissipates, as velocities turn [energy]."""

    @property
    def resisted(self) -> bool:
        """Tell whether drag acts in kicks too: the work of a force is then its product with the displacement in drifts
        alone."""

    @property
    def link_work(self) -> LinkWork:
        """Work of joints so far."""

    def motions(self, impulse: Wrench) -> MotionState:
        """Motions that carry the bodies, after the ``impulse`` of contacts on these."""

    def prescribed_part(self, prescribed: BoolArray) -> Twist:
        """Prescribed part of the bodies' twists, n rows, valid where a body has one; the motions ``prescribed`` (N,)
        are prescribed."""

    def copied(self) -> Self:
        """Copy, for a trial."""

    def max_acceleration(self, time: float) -> FloatArray:
        """Greatest acceleration of each body (n,) within ``time`` from now, contacts apart [length/time²]."""

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change the twist by contacts with this ``wrench``, and by all other forces, for ``time``.

        ``at``: kinematics at the pose that the wrench belongs to, None for the present one.
        """

    def drift(self, time: float) -> None:
        """Change the pose with the present twist for ``time``."""


class MotionDynamics(BodyDynamics, Protocol):
    """Dynamics of the motions themselves."""

    def max_angular_acceleration(self, time: float) -> FloatArray:
        """Greatest angular acceleration of each motion (N,) within ``time`` from now, contacts apart [rad/time²]."""


class ImpulsiveDynamics(MotionDynamics, Protocol):
    """Dynamics of motions that impulses can change at once, as those of rigid joints do."""

    def begin(self, ahead: float) -> None:
        """Read prescribed rates no earlier than ``ahead`` after the start [time], so that a jump of them at the start
        is in the twist before the first drift."""

    def apply_impulse(self, impulse: FloatArray) -> None:
        """Change the twist at once by impulses (N, d+k) [force·time | force·length·time]."""
