"""Correct the advecting velocity for bodies whose velocity a contact reverses within the step."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.coupling.impulse_responses import CHANGED
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import reaches, round_motions
from rigidfluid.core.mechanics.rigid import rotation_between
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Step


def turning(system: System, state: State, path: BodyStep, step: Step) -> FloatArray:
    """Impulses (n, d+k) that give the advecting velocity the bodies' velocity on the mesh [force·time |
    force·length·time].

    Extrapolated velocities do not know of an impact, but the mesh has gone with the bodies: fluid would seem to flow
    through their surfaces, with up to twice their speed. Both velocities are made equal on the surfaces of bodies near
    contacts; elsewhere the fluid follows as it does to an impact. The impulses are zero where the ways by both
    velocities in a step differ by less than CHANGED of the body's radius. ``state`` is that at the start of the step,
    ``path`` the bodies' way through it, with its coupling.
    """
    none, coupling = np.zeros_like(step.load), path.coupling
    if coupling is None:
        return none
    change = _on_the_mesh(system, state, path, step) - _extrapolated(state, step)
    reach, farthest = reaches(system)
    way = np.abs(change) / step.derivative[0]
    way[:, : system.dimension] /= reach[:, None]
    way[:, system.dimension :] *= (farthest / reach)[:, None]
    velocities = coupling.model.velocities
    if not np.any(way.flat[velocities] > CHANGED):
        return none
    none.flat[velocities] = coupling.model.mass_times(change.flat[velocities])
    return none


def _on_the_mesh(system: System, state: State, path: BodyStep, step: Step) -> FloatArray:
    """Twists (n, d+k) by the poses, differenced as the mesh's velocity is; balls turn without it, as on their path."""
    d0, _, d2 = step.derivative
    found = d0 * _way(state.motions.pose, path.motions.pose)
    if state.past is not None:
        found = found - d2 * _way(state.past.pose, state.motions.pose)
    is_ball = round_motions(system)
    found[is_ball, system.dimension :] = path.motions.twist.angular_velocity[is_ball]
    return np.asarray(found)


def _way(start: Pose, end: Pose) -> FloatArray:
    """Displacement and rotation vector from pose to pose, (n, d+k) [length | rad]."""
    turned = rotation_between(start.orientation, end.orientation)
    return np.concatenate([end.position - start.position, turned], axis=1)


def _extrapolated(state: State, step: Step) -> FloatArray:
    """Twists (n, d+k) at the end of the step, extrapolated from those before."""
    e0, e1 = step.extrapolation
    return np.asarray(e0 * flat(state.motions.twist) + e1 * flat(state.past_twist or state.motions.twist))
