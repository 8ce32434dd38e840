"""Steps of bodies in a fluid: near contacts their path follows a reduced model, whose terms the fluid solves give."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigidfluid.core.contact.pairs.extrapolated_contacts import ExtrapolatedContacts
from rigidfluid.core.contact.pairs.gap_changes import change_too_fast
from rigidfluid.core.contact.path.body_step import BodyStep, undisturbed
from rigidfluid.core.contact.path.implicit_path import implicit_coupled
from rigidfluid.core.contact.path.look_ahead import near_contacts
from rigidfluid.core.contact.path.substep_path import SubstepPath
from rigidfluid.core.coupling.coupled_dynamics import CoupledDynamics
from rigidfluid.core.coupling.impulse_responses import updated_model
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.motions import (
    accelerations,
    own_inverse_masses,
    round_motions,
    twist_arms,
)
from rigidfluid.core.mechanics.time_scheme import derivative_weights, predict_pose
from rigidfluid.core.mechanics.wrenches import flat, nothing
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling, ReducedModel, load_within, uncoupled
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Mesh, Pose, Step

CONVERGED = 1e-3
"""Relative change of the bodies' velocities below which the iteration of a step has converged."""

CONVERGED_SHARED = 1e-2
"""The same where bodies share right sides in the solve for impulse responses, which are no more exact then."""

STEADY = 0.1
"""Change of velocities by contacts, relative to the velocities, below which one fluid solve may be enough: the model
that gives it is known to a hundredth."""


class FluidScheme(ABC):
    """`Scheme` of bodies in a fluid.

    Substeps take the place of small steps of the fluid: in them bodies near contacts have the mass and the resistance
    of the reduced model, and the fluid is then solved once with the impulse of their contacts.
    """

    def __init__(self, system: System) -> None:
        self._system = system

    def expect(self, state: State, time: float, size: float) -> Coupling | None:
        """Coupling expected by the present mesh and the latest step's loads; the state's own model serves
        where it still holds."""
        system, near = self._system, near_contacts(self._system, state, time, size)
        if len(near) == 0:
            return None
        velocities = _velocities(system, near)
        step = step_to(system, state, StepEnd(time + size, size, state.motions.pose, nothing(state.motions.pose)))
        known = None if state.coupling is None else state.coupling.model
        model = updated_model(system, state, step, state.contacts, flat(state.motions.twist), velocities, known)
        before, expected = self._expected_loads(state, model, size)
        return Coupling(model, expected, before, np.zeros(len(velocities)))

    def follow(self, state: State, start: float, size: float, coupling: Coupling | None) -> BodyStep:
        """Follow the bodies by Adams–Bashforth 2 in one formula where nothing can touch, else through contacts."""
        system, motions = self._system, state.motions
        if coupling is None or system.law is None:
            pose = predict_pose(motions.pose, motions.twist, state.past_twist, size, state.past_step)
            return undisturbed(system, pose, motions.twist, start + size)
        unlinked, near = self._motions(state, coupling), near_contacts(system, state, start, size)
        dynamics = system.motions.carry(system.joints.over(unlinked, start), start)
        unlinked.vary_load(size, self._varying(state, dynamics, near, size))
        if system.implicit:
            path = implicit_coupled(system, system.law, dynamics, near, size, state.springs)
        else:
            sight = system.detection.look_ahead(ExtrapolatedContacts(near, state.pose), dynamics, size)
            at_start = sight.contacts_at(dynamics.pose)
            path = SubstepPath(system, system.law, dynamics, size, state.springs).advance(sight, at_start)
            path = replace(path, friction=dynamics.friction_loss, drag_left_out=dynamics.drag_left_out)
        return replace(self._with_friction(path), coupling=coupling)

    def prepare(self, step: Step, state: State, path: BodyStep) -> Step:
        """Add the correction of the load, in place, and the impulses that correct the advecting velocity."""
        if path.coupling is None:
            return step
        step.load.flat[path.coupling.model.velocities] += path.coupling.correction
        return self._with_turning(step, state, path)

    def is_unsteady(self, state: State, path: BodyStep, size: float) -> bool:
        """Tell whether contacts change velocities by more than STEADY otherwise than in the step before."""
        if path.coupling is None:
            return False
        model, d0 = path.coupling.model, float(derivative_weights(size, state.past_step)[0])
        now, before = (model.components(flat(each)) for each in (path.motions.contact, state.motions.contact))
        gained, otherwise = (self._response(model, d0, impulse) for impulse in (now, now - size * before))
        arm, speed = model.components(twist_arms(self._system)), model.components(flat(state.motions.twist))
        scale = max(float(np.linalg.norm(arm * each)) for each in (speed, gained))
        return bool(np.linalg.norm(arm * otherwise) > STEADY * scale)

    def changes_gaps_too_fast(self, state: State, pose: Pose, mesh_at: Callable[[Pose], Mesh]) -> bool:
        return change_too_fast(self._system, state, pose, mesh_at)

    @abstractmethod
    def restarted(self, state: State, first_level: int) -> State: ...

    def repeats_start(self, state: State, path: BodyStep) -> bool:
        """Tell whether nothing touches in a first step."""
        return path.coupling is None and state.past is None

    def converge(self, state: State, candidate: State, path: BodyStep, step: Step) -> tuple[State, bool]:
        """The candidate with its coupling, and whether the fixed-point iteration has converged."""
        if path.coupling is None:
            return candidate, True
        found = self._shown(state, candidate, path, path.coupling, step)
        agree = self._agree(path.coupling, found, path, state, candidate)
        return self._with_impact(state, replace(candidate, coupling=found), path), agree

    def bodies_now(self, state: State, time: float) -> BodyDynamics:
        """Dynamics by the coupling that the state's solution has shown."""
        return self._system.motions.carry(self._motions(state, state.coupling or uncoupled()), time)

    @abstractmethod
    def _expected_loads(self, state: State, model: ReducedModel, size: float) -> tuple[FloatArray, FloatArray]:
        """Load Φ (c,) at the start of a step of this ``size`` [time], NaN where unknown, and at its end."""

    @abstractmethod
    def _known_load(self, state: State, coupling: Coupling) -> FloatArray | None:
        """Weight and applied wrenches (c,) in a fluid without inertia, as all else of Φ is its drag; None in others."""

    @abstractmethod
    def _varying(self, state: State, bodies: BodyDynamics, near: Contacts, size: float) -> BoolArray:
        """Components of Φ (N, d+k) that vary linearly in a step of this ``size`` [time] with its contacts ``near``; the
        others are constant."""

    @abstractmethod
    def _with_friction(self, path: BodyStep) -> BodyStep:
        """The path with its friction in the field from which the ledger takes it."""

    @abstractmethod
    def _with_turning(self, step: Step, state: State, path: BodyStep) -> Step:
        """The step with the impulses that correct its advecting velocity near contacts."""

    @abstractmethod
    def _with_impact(self, state: State, candidate: State, path: BodyStep) -> State:
        """The candidate with the tick of the latest impact that stirred the fluid."""

    @abstractmethod
    def _correction(self, model: ReducedModel, step: Step, missed: FloatArray) -> FloatArray:
        """Load (c,) to be added, where the solution of a step has missed the path's end by these velocities (c,)."""

    @abstractmethod
    def _response(self, model: ReducedModel, d0: float, impulse: FloatArray) -> FloatArray:
        """Velocities (c,) at the end of a step by an ``impulse`` (c,) in it."""

    def _motions(self, state: State, coupling: Coupling) -> CoupledDynamics:
        """Dynamics of the motions; those outside the model keep their acceleration, and respond with mass and added
        mass."""
        linear, angular = own_inverse_masses(self._system, state)
        now, rate = state.motions, accelerations(self._system, state, linear, angular)
        known = self._known_load(state, coupling)
        return CoupledDynamics(now.pose, now.twist, rate, linear, angular, coupling, known)

    def _shown(self, state: State, candidate: State, path: BodyStep, used: Coupling, step: Step) -> Coupling:
        """Coupling that the solution of a ``step`` from ``state`` to ``candidate`` along ``path`` has shown: responses
        on the mesh at its end, and loads in it, of the velocities of the coupling that was ``used``."""
        twist, velocities = flat(candidate.motions.twist), used.model.velocities
        model = updated_model(self._system, state, step, candidate.contacts, twist, velocities, used.model)
        past = state.past_twist or state.motions.twist
        twists = tuple(model.components(flat(twist)) for twist in (candidate.motions.twist, state.motions.twist, past))
        before = (flat(state.motions.contact) + _applied(state)) * (state.past_step or 0.0)
        applied = _applied(candidate)
        impulses = model.components(step.impulse + (candidate.past_step or 0.0) * applied), model.components(before)
        load = load_within(model, step.derivative, (twists[0], twists[1], twists[2]), impulses)
        load = load - used.correction + model.components(applied) - model.components(candidate.link.wrench)
        missed = model.components(flat(path.motions.twist)) - twists[0]
        return Coupling(model, load, used.load_before, used.correction + self._correction(model, step, missed))

    def _agree(self, used: Coupling, found: Coupling, path: BodyStep, state: State, candidate: State) -> bool:
        """Compare path and solution: changes of load and responses count by those of velocities at the end."""
        model, size = found.model, (candidate.past_step or 0.0)
        if len(model.velocities) == 0:
            return True
        impulse, d0 = model.components(flat(path.motions.contact)), float(derivative_weights(size, state.past_step)[0])
        gained = self._response(model, d0, impulse)
        before, after = (model.components(flat(twist)) for twist in (state.motions.twist, candidate.motions.twist))
        by_load = size * (self._response(model, d0, found.load) - self._response(used.model, d0, used.load))
        by_response = gained - self._response(used.model, d0, impulse)
        missed = model.response(d0, found.correction - used.correction) / d0
        arm = model.components(twist_arms(self._system))
        scale = max(float(np.linalg.norm(arm * each)) for each in (before, after, gained))
        enough = CONVERGED_SHARED if model.shared else CONVERGED
        return max(float(np.linalg.norm(arm * each)) for each in (by_load, by_response, missed)) <= enough * scale


def _velocities(system: System, near: Contacts) -> IntArray:
    """Numbers of the velocity components (N, d+k) of free motions that contacts can change: balls turn only where a law
    has dampers.

    Motions with joints are always among them, as joint forces are found from the responses of all.
    """
    d = system.dimension
    width = d + (1 if d == 2 else 3)
    moves = np.repeat((near_motions(system, near) & ~system.motions.prescribed)[:, None], width, axis=1)
    if system.law is not None and not system.law.dissipative:
        moves[round_motions(system), d:] = False
    moves[system.joints.linked & ~system.motions.prescribed] = True
    return np.flatnonzero(moves)


def near_motions(system: System, near: Contacts) -> BoolArray:
    """Tell which motions (N,) have bodies in the contacts ``near``."""
    carrier, found = system.motions.carrier, np.zeros(len(system.motions.prescribed), dtype=bool)
    found[carrier[near.body_a]] = True
    found[carrier[near.body_b[near.body_b < len(carrier)]]] = True
    return found


def _applied(state: State) -> FloatArray:
    """Mean applied wrench on the motions (N, d+k) in the step that led to a ``state``."""
    if state.past is None or state.past.applied is None:
        return np.zeros_like(flat(state.motions.contact))
    return flat(state.past.applied)
