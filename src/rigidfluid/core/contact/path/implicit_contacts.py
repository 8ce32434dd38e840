"""Implicit step of the bodies through their contacts, stable at any stiffness, that keeps the energy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from scipy import sparse

from rigidfluid.core.contact.pairs.carried_springs import carried_springs, springs_at, transported, transported_turning
from rigidfluid.core.contact.path.contact_load import evaluate_damping, wall_power
from rigidfluid.core.contact.path.contact_newton import MOST_DENSE, Problem, contact_forces
from rigidfluid.core.contact.path.delassus import delassus, delassus_of_points, delassus_of_turning
from rigidfluid.core.contact.path.implicit_friction import (
    Condensed,
    Rubbing,
    Slip,
    condensed,
    contacts_of_mean_force,
    no_rubbing,
    rubbing,
)
from rigidfluid.core.contact.path.substep import (
    JUST_IN,
    relative_angular_velocity,
    relative_motion,
    relative_velocity,
)
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import WallVelocities
from rigidfluid.core.mechanics.matrices import full
from rigidfluid.core.mechanics.wrenches import contact_wrench, nothing
from rigidfluid.core.model.contacts import middle as centre
from rigidfluid.core.model.contacts import normal_part, sides, tangential_part, turning_radius
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.tangential_springs import TangentialSprings, spring_energy
from rigidfluid.core.model.types import Contacts, Motion, Pose, Twist, Wrench
from rigidfluid.errors import StepRejected

MOST_UPDATES = 40
"""Largest number of updates of normals, points and gaps."""

MOST_FORCE_UPDATES = 20
"""Update after which dampers, and the scale that makes the work exact, are kept: a damper that switches on at the
range, or a displacement close to zero, may have no value that fits."""

SLOPE_UPDATES = 8
"""Update after which friction is followed by secants: tangents may change between stick and slip for ever."""

TOLERANCE = 1e-10
"""Tolerance of the surfaces' positions at the end against those that the forces give, over the range."""

KEPT = 1e-5
"""Relative error of the energy above which a step is rejected, as bodies turn too far in it for one force in each
contact."""

_SCALES = 0.5, 2.0
_STILL = 1e-6
_ROUNDING = 1e-14


M = TypeVar("M", bound=BodyDynamics)


class Encounter(NamedTuple, Generic[M]):
    """Bodies and contacts at the start of a step.

    ``start`` are the m contacts that may come into range of the ``law`` in the step of this ``size`` Δt [time],
    ``contacts_at`` gives the same contacts, in the same order, at another pose; ``wall_velocity`` is as in
    `relative_motion`, None for walls at rest; ``springs`` are those along surfaces, None without any.
    """

    law: ForceLaw
    dynamics: M
    start: Contacts
    contacts_at: Callable[[Pose], Contacts]
    size: float
    wall_velocity: WallVelocities | None
    springs: TangentialSprings | None = None


class Crossing(NamedTuple, Generic[M]):
    """Result of a step: the bodies' ``dynamics`` at its end, the contacts' mean ``wrench``, the energy ``lost``, the
    ``wall_work`` done on the bodies by sliding walls, the energy ``stored`` in bodies and contacts [energy], and the
    ``springs`` along surfaces at the end, None without any."""

    dynamics: M
    wrench: Wrench
    lost: float
    wall_work: float
    stored: float
    springs: TangentialSprings | None


def implicit_contact_step(encounter: Encounter[M]) -> Crossing[M]:
    """Advance x₁ = x₀ + Δt (U₀ + U₁)/2, U₁ = U₀ + Δt (A + M⁻¹ Σ f n), with one force f in each contact for the whole
    step.

    f = -[U(g₁) - U(g₀)]/(n·Δx), the discrete gradient of the law's energy U, does the work that the energy loses; Δx is
    the way of the surfaces past each other by their mean velocity in both kicks, or in the drift where friction acts in
    kicks too, n and the points are those in mid-step (Gonzalez, J. Nonlinear Sci. 6 (1996) 449, doi:10.1007/BF02440162;
    Simo, Tarnow & Wong, Comput. Methods Appl. Mech. Eng. 100 (1992) 63, doi:10.1016/0045-7825(92)90115-Z). Dampers act
    with the mean velocity, across the surfaces implicitly, along them and by couples with that of the iteration before;
    springs along the surfaces, those that resist turning, and dampers beside them are solved together with the gaps.
    The step is of second order where it resolves the contact, and keeps the energy at any length.

    The encounter's dynamics is left as it is. StepRejected is raised if bodies would overlap, no forces are found, or
    bodies turn too far for the forces to keep the energy.
    """
    law, start, size, wall_velocity = encounter.law, encounter.start, encounter.size, encounter.wall_velocity
    iterate = _straight_on(encounter)
    force, gap, dampers = np.zeros(len(start)), start.gap, _dampers(law, iterate, size)
    d = start.normal.shape[1]
    rub = no_rubbing(_unheld(law, dampers))
    along = rub.force
    for update in range(MOST_UPDATES):
        response = _response(law, iterate, rub, force, along)
        offset = iterate.way - iterate.gap
        problem = Problem(law, start, response.free, response.compliance, iterate.scale, dampers.across, offset)
        force, gap = contact_forces(problem, force, gap)
        spring = (force + dampers.across * (gap + offset)) / iterate.scale
        along = response.along(force)
        total = _normal_components(iterate.middle, force, along) + along
        used = _used(law, iterate.middle, dampers, along)
        before = iterate
        acting = contact_wrench(iterate.middle, total[:, :d], iterate.pose, used.couple)
        iterate = _evaluate(encounter, acting, iterate.place)
        if update < MOST_FORCE_UPDATES:
            dampers = _dampers(law, iterate, size)
        else:
            iterate = iterate._replace(scale=before.scale)
        rub = no_rubbing(_unheld(law, dampers))
        if law.sticking:
            slip = Slip(iterate.motion, size, along, update >= SLOPE_UPDATES)
            rub = _rubbing(encounter, iterate, gap, spring, slip)
        pressing = iterate.scale * spring - dampers.across * iterate.way
        wanted = _normal_components(iterate.middle, pressing, along) + rub.force
        if _converged(law, iterate, gap, wanted - total) and _turned_as_wanted(law, iterate, size, used, dampers):
            wall_work = 0.0
            if wall_velocity is not None:
                wall_work = size * wall_power(wall_velocity, iterate.middle, total[:, :d], used.couple)
            stored = _most_stored(encounter, iterate)
            _refuse_to_create(encounter, iterate, before.scale * spring, stored)
            springs = _springs(encounter, iterate, rub)
            return _crossing(encounter, iterate, used, springs, wall_work, stored)
        gap = iterate.gap
    raise _rejected(f"no forces after {MOST_UPDATES} updates of the normals")


class _Iterate(NamedTuple, Generic[M]):
    """Bodies and contacts under some forces.

    ``dynamics`` at the end; ``pose``, ``place`` on the motions, contacts and mean motion in mid-step; ``way`` n·Δx and
    ``gap`` at the end (m,) [length]; ``scale`` (g₁ - g₀)/(n·Δx) (m,) [1]; ``compliance`` Δt²/2 D (m, m) of the gaps, or
    (c·m, c·m) of all ways where springs stick [length/force]; the ``wrench``.
    """

    dynamics: M
    pose: Pose
    place: Kinematics
    middle: Contacts
    motion: Motion
    way: FloatArray
    gap: FloatArray
    scale: FloatArray
    compliance: Any
    wrench: Wrench


class _Dampers(NamedTuple):
    """Forces of dampers, ``across``: force over way along the normal (m,) [force/length]; ``along``: force in the
    surfaces (m, d), zero where springs and dampers there are solved together; ``couple`` on ``body_a`` (m, k), None
    without any, or where springs resist turning [force·length]."""

    across: FloatArray
    along: FloatArray
    couple: FloatArray | None = None

    def turning_loss(self, motion: Motion) -> float:
        """Power that the couples take in this ``motion`` [energy/time]."""
        return 0.0 if self.couple is None else -float(np.sum(self.couple * motion.angular_velocity))


def _straight_on(encounter: Encounter[M]) -> _Iterate[M]:
    """First guess, which accepts overlaps: without contact forces, with all surfaces flat."""
    law, dynamics, start, _, size, wall_velocity, _ = encounter
    trial, none = dynamics.copied(), nothing(dynamics.pose)
    trial.kick(none, 0.5 * size)
    motion = relative_motion(start, trial, wall_velocity, law.couples)
    way = size * normal_part(motion.velocity, start)
    scale, compliance = np.ones(len(start)), _compliance(law, start, dynamics, size)
    place = dynamics.pose, dynamics.kinematics
    return _Iterate(trial, *place, start, motion, way, start.gap + way, scale, compliance, none)


def _evaluate(encounter: Encounter[M], wrench: Wrench, place: Kinematics) -> _Iterate[M]:
    law, dynamics, start, contacts_at, size, wall_velocity, _ = encounter
    trial = dynamics.copied()
    trial.kick(wrench, 0.5 * size, place)
    kicked = trial.motion_twist
    trial.drift(0.5 * size)
    pose, kinematics, middle = trial.pose, trial.kinematics, contacts_at(trial.pose)
    motion, compliance = relative_motion(middle, trial, wall_velocity), _compliance(law, middle, trial, size)
    trial.drift(0.5 * size)
    drifted = trial.motion_twist
    trial.kick(wrench, 0.5 * size, place)
    drift = kicked, drifted
    twist = _mean(drift if trial.resisted else (dynamics.motion_twist, *drift, trial.motion_twist))
    bodies = kinematics.component_twist(twist)
    velocity = relative_velocity(middle, pose, bodies)
    if wall_velocity is not None:
        velocity -= wall_velocity(middle.body_b, centre(middle))
    motion = replace(motion, velocity=velocity)
    if law.couples:
        motion = replace(motion, angular_velocity=relative_angular_velocity(middle, bodies, wall_velocity))
    gap = contacts_at(trial.pose).gap
    if np.any(gap <= 0.0):
        raise _rejected("an overlap where they take the bodies")
    way = size * normal_part(motion.velocity, middle)
    moves = np.abs(way) > _STILL * law.range
    scale = np.divide(gap - start.gap, way, out=np.ones_like(way), where=moves)
    return _Iterate(trial, pose, kinematics, middle, motion, way, gap, np.clip(scale, *_SCALES), compliance, wrench)


def _compliance(law: ForceLaw, contacts: Contacts, dynamics: BodyDynamics, size: float) -> Any:
    responses = delassus_of_turning if law.rolling else delassus_of_points if law.sticking else delassus
    matrix = 0.5 * size**2 * responses(contacts, dynamics, 0.5 * size)
    return full(matrix) if len(contacts) <= MOST_DENSE else sparse.csr_matrix(matrix)


def _response(law: ForceLaw, iterate: _Iterate[M], rub: Rubbing, force: FloatArray, along: FloatArray) -> Condensed:
    """Forces along the surfaces as they depend on those across them, or as they are where nothing sticks."""
    if law.sticking:
        return condensed(iterate.compliance, iterate.middle, rub, iterate.gap, force, along)
    return Condensed(iterate.compliance, iterate.gap - iterate.compliance @ force, rub.force)


def _rubbing(encounter: Encounter[M], iterate: _Iterate[M], gap: FloatArray, spring: FloatArray, slip: Slip) -> Rubbing:
    """Forces of springs along the surfaces, where the mean forces ``spring`` (m,) lead to the ``gap`` (m,)."""
    law, dynamics, start = encounter.law, encounter.dynamics, encounter.start
    displacement, turning = carried_springs(encounter.springs, start, dynamics.pose)
    middle = contacts_of_mean_force(law, start, iterate.middle, gap, spring)
    held = transported(displacement, start.normal, middle.normal)
    if law.rolling:
        held = np.hstack([held, transported_turning(turning, start.normal, middle.normal)])
    return rubbing(law, middle, replace(middle, gap=iterate.gap), held, slip)


def _springs(encounter: Encounter[M], iterate: _Iterate[M], rub: Rubbing) -> TangentialSprings | None:
    """Springs along the surfaces at the end, None where all are relaxed."""
    if not encounter.law.sticking:
        return None
    stiffness = encounter.law.tangential_stiffness(replace(iterate.middle, gap=iterate.gap))
    d = iterate.middle.normal.shape[1]
    turning = rub.displacement[:, d:] if encounter.law.rolling else None
    springs = springs_at(iterate.middle, rub.displacement[:, :d], stiffness, iterate.pose, turning)
    return springs if len(springs) else None


def _dampers(law: ForceLaw, iterate: _Iterate[M], size: float) -> _Dampers:
    if not law.dissipative:
        return _Dampers(np.zeros_like(iterate.way), np.zeros_like(iterate.middle.normal))
    speed, normal = normal_part(iterate.motion.velocity, iterate.middle), iterate.middle.normal
    speed = np.where(speed == 0.0, 1.0, speed)
    straight = law.damping(iterate.middle, Motion(speed[:, None] * normal, iterate.motion.mass))
    across = -normal_part(straight, iterate.middle) / speed / size
    whole, couple = evaluate_damping(law, iterate.middle, iterate.motion)
    if law.sticking:
        return _Dampers(across, np.zeros_like(normal), None if law.rolling else couple)
    return _Dampers(across, tangential_part(whole, iterate.middle), couple)


def _unheld(law: ForceLaw, dampers: _Dampers) -> FloatArray:
    """Forces of dampers along the surfaces (m, c), without any where springs resist turning."""
    if not law.rolling:
        return dampers.along
    return np.hstack([dampers.along, np.zeros((len(dampers.along), 1 if dampers.along.shape[1] == 2 else 3))])


def _used(law: ForceLaw, contacts: Contacts, dampers: _Dampers, along: FloatArray) -> _Dampers:
    """Dampers, with the forces ``along`` the surfaces (m, c) and the couples in them."""
    d = contacts.normal.shape[1]
    couple = turning_radius(contacts) * along[:, d:] if law.rolling else dampers.couple
    return dampers._replace(along=along[:, :d], couple=couple)


def _normal_components(contacts: Contacts, force: FloatArray, along: FloatArray) -> FloatArray:
    """The ``force`` (m,) along the normals in as many components as those ``along`` the surfaces (m, c)."""
    whole, d = np.zeros_like(along), contacts.normal.shape[1]
    whole[:, :d] = force[:, None] * contacts.normal
    return whole


def _converged(law: ForceLaw, iterate: _Iterate[M], gap: FloatArray, missing: FloatArray) -> bool:
    """Tell whether gaps match the prediction and the residual force displaces no body beyond tolerance."""
    enough = _tolerance(law, iterate.pose)
    softest = iterate.compliance.diagonal().reshape(-1, len(gap)).max(axis=0)
    moved = softest * np.linalg.norm(missing, axis=1)
    return bool(np.all(np.abs(iterate.gap - gap) <= enough) and np.all(moved <= enough))


def _turned_as_wanted(law: ForceLaw, iterate: _Iterate[M], size: float, used: _Dampers, wanted: _Dampers) -> bool:
    """Tell whether the residual couple turns no surface beyond tolerance."""
    if used.couple is None or wanted.couple is None:
        return True
    pose, missing = iterate.pose, np.linalg.norm(wanted.couple - used.couple, axis=1)
    lightest, turned = np.linalg.eigvalsh(iterate.dynamics.inverse_inertia)[:, -1], np.zeros(len(missing))
    for body, point in sides(iterate.middle):
        on_body = np.flatnonzero(body < len(pose.position))
        arm = np.linalg.norm(point[on_body] - pose.position[body[on_body]], axis=1)
        turned[on_body] += 0.5 * size**2 * arm * lightest[body[on_body]] * missing[on_body]
    return bool(np.all(turned <= _tolerance(law, pose)))


def _tolerance(law: ForceLaw, pose: Pose) -> float:
    """Tolerance of the surfaces' positions [length]."""
    return TOLERANCE * law.range + _ROUNDING * float(np.abs(pose.position).max())


def _mean(twists: Sequence[Twist]) -> Twist:
    return Twist(
        np.mean([twist.velocity for twist in twists], axis=0),
        np.mean([twist.angular_velocity for twist in twists], axis=0),
    )


def _most_stored(encounter: Encounter[M], iterate: _Iterate[M]) -> float:
    """Greatest energy at the start, at the end, or in a contact that is just in range: a smaller scale is not worth
    another step [energy]."""
    law, start = encounter.law, encounter.start
    end = replace(start, gap=iterate.gap)
    just_in = [replace(start, gap=np.full(len(start), JUST_IN * begin)) for begin in law.ranges]
    touching = [float(np.abs(law.energy(contacts)).max()) for contacts in just_in]
    return max(_stored(law, encounter.dynamics, start), _stored(law, iterate.dynamics, end), *touching)


def _stored(law: ForceLaw, dynamics: BodyDynamics, contacts: Contacts) -> float:
    """Kinetic energy of free bodies and potential energy of the contacts, by its size where they attract [energy]."""
    twist, energy = dynamics.twist, float(np.abs(law.energy(contacts)).sum())
    for velocity, inverse in (
        (twist.velocity, dynamics.inverse_mass),
        (twist.angular_velocity, dynamics.inverse_inertia),
    ):
        free = inverse.any(axis=(1, 2))
        energy += 0.5 * float(np.einsum("ni,nij,nj->", velocity[free], np.linalg.inv(inverse[free]), velocity[free]))
    return energy


def _refuse_to_create(encounter: Encounter[M], iterate: _Iterate[M], force: FloatArray, stored: float) -> None:
    """Raise StepRejected if the work of the springs' ``force`` (m,) is not the loss of their energy."""
    law, start = encounter.law, encounter.start
    end = replace(start, gap=iterate.gap)
    created = float(np.sum(force * iterate.way + law.energy(end) - law.energy(start)))
    if abs(created) > KEPT * stored:
        raise _rejected(f"energy of {created:.1e} from nowhere, as bodies turn too far")


def _crossing(
    encounter: Encounter[M],
    iterate: _Iterate[M],
    dampers: _Dampers,
    springs: TangentialSprings | None,
    wall_work: float,
    stored: float,
) -> Crossing[M]:
    """Result of a converged step; raise StepRejected if dampers that were not updated to the end would give energy, or
    springs along the surfaces more than by their tolerance."""
    rubbed = -encounter.size * float(np.sum(dampers.along * iterate.motion.velocity))
    stretched = spring_energy(springs) - spring_energy(encounter.springs)
    lost = float(np.sum(dampers.across * iterate.way**2)) + rubbed - stretched
    lost += encounter.size * dampers.turning_loss(iterate.motion)
    if lost < (-KEPT * stored if encounter.law.sticking else 0.0):
        raise _rejected("dampers that would give energy")
    return Crossing(iterate.dynamics, iterate.wrench, lost, wall_work, stored, springs)


def _rejected(found: str) -> StepRejected:
    allowed = "forces that keep all surfaces apart"
    return StepRejected(
        "the implicit contact step", found, allowed, "Shorten the step, or set contact.stepping to substeps."
    )
