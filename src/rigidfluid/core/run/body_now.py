"""Bodies of a run at present, by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist, Wrench


@dataclass(frozen=True, slots=True)
class BodyNow:
    """One body at present; ``force`` (d,) and ``torque`` (k,) are those of the fluid, ``contact_force`` and
    ``contact_torque`` those of its contacts in the latest step, ``gap`` the least to any surface [length].

    ``position`` goes on beyond periodic surfaces, ``wrapped_position`` is that of the image in the domain [length];
    ``orientation`` (1,) angle [rad] or (4,) unit quaternion.
    """

    position: FloatArray
    wrapped_position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    angular_velocity: FloatArray
    force: FloatArray
    torque: FloatArray
    contact_force: FloatArray
    contact_torque: FloatArray
    gap: float


def bodies_now(system: System, state: State) -> dict[str, BodyNow]:
    """All bodies by name in a state of the ``system``, and after them the mechanisms as wholes."""
    names = system.surfaces[: len(system.bodies)]
    parts = _named(
        system.domain, names, state.pose, state.twist, state.hydrodynamic_wrench, state.contact_wrench, state.gaps
    )
    motions, known = state.motions, system.motions
    whole = (motions.pose, motions.twist, motions.hydrodynamic, motions.contact, known.least(state.gaps))
    return parts | _named(system.domain, known.names, *whole, first=len(known.mass) - len(known.names))


def _named(
    domain: Domain,
    names: Sequence[str],
    pose: Pose,
    twist: Twist,
    by_fluid: Wrench,
    contact: Wrench,
    gaps: FloatArray,
    first: int = 0,
) -> dict[str, BodyNow]:
    """Bodies at present by these names, from row ``first`` on."""
    wrapped = domain.wrapped(pose.position)
    return {
        name: BodyNow(
            position=pose.position[i],
            wrapped_position=wrapped[i],
            orientation=pose.orientation[i],
            velocity=twist.velocity[i],
            angular_velocity=twist.angular_velocity[i],
            force=by_fluid.force[i],
            torque=by_fluid.torque[i],
            contact_force=contact.force[i],
            contact_torque=contact.torque[i],
            gap=float(gaps[i]),
        )
        for i, name in enumerate(names, start=first)
    }
