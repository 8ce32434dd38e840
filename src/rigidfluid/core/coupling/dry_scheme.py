"""Steps of bodies without a fluid: substeps or implicit steps of their contacts are the whole motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.contact.path.implicit_path import implicit_free
from rigidfluid.core.contact.path.look_ahead import look_ahead
from rigidfluid.core.contact.path.substep_path import SubstepPath, fly_freely
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import body_load
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detection import Sight
from rigidfluid.core.model.dynamics import BodyDynamics, ImpulsiveDynamics
from rigidfluid.core.model.joints import NoJoints
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Mesh, Pose, Step, Wrench


class DryScheme:
    """`Scheme` of a system without a fluid: there is no coupling, and one path is enough."""

    def __init__(self, system: System) -> None:
        self._system = system

    def expect(self, state: State, time: float, size: float) -> Coupling | None:
        return None

    def follow(self, state: State, start: float, size: float, coupling: Coupling | None) -> BodyStep:
        """Follow the bodies by velocity Verlet, or with implicit contacts by implicit steps."""
        system, dynamics = self._system, self._dynamics(state, start)
        if system.law is None:
            path = fly_freely(system, dynamics, size)
        elif system.implicit:
            path, dynamics = implicit_free(system, system.law, dynamics, size, state.springs)
        else:
            sight = look_ahead(system, dynamics, size)
            near = self._contacts_at_start(state, sight)
            path = SubstepPath(system, system.law, dynamics, size, state.springs).advance(sight, near)
        if isinstance(system.joints, NoJoints):
            return path
        by_joints = dynamics.link_work
        dissipated, actuator_work = path.dissipated + by_joints.damped, path.actuator_work + by_joints.drive_work
        return replace(path, dissipated=dissipated, actuator_work=actuator_work, link=by_joints.load(size))

    def prepare(self, step: Step, state: State, path: BodyStep) -> Step:
        return step

    def is_unsteady(self, state: State, path: BodyStep, size: float) -> bool:
        return False

    def changes_gaps_too_fast(self, state: State, pose: Pose, mesh_at: Callable[[Pose], Mesh]) -> bool:
        return False

    def restarted(self, state: State, first_level: int) -> State:
        """The state as after a start at once; the next step may be as long as ever."""
        return replace(state, ledger=replace(state.ledger, since_start=0.0))

    def repeats_start(self, state: State, path: BodyStep) -> bool:
        return False

    def converge(self, state: State, candidate: State, path: BodyStep, step: Step) -> tuple[State, bool]:
        return candidate, True

    def bodies_now(self, state: State, time: float) -> BodyDynamics:
        return self._system.motions.carry(self._motions(state, time, body_load(self._system, state)), time)

    def _dynamics(self, state: State, start: float) -> BodyDynamics:
        """Dynamics of the bodies, on motions with their joints."""
        system, load = self._system, body_load(self._system, state)
        linked = system.joints.over(self._motions(state, start, load), start)
        return system.motions.carry(linked, start, load)

    def _contacts_at_start(self, state: State, sight: Sight) -> Contacts:
        """Contacts of a state as far as the sight reaches: its own, which go as far as the system's reach, or else
        detected."""
        if sight.reach > self._system.reach:
            return sight.contacts_at(state.pose)
        return select(state.contacts, state.contacts.gap <= sight.reach)

    def _motions(self, state: State, start: float, load: Wrench) -> ImpulsiveDynamics:
        """Dynamics of the motions, with a constant ``load`` on the bodies and without joints."""
        system, now = self._system, state.motions

        def prescribed_twist(elapsed: float) -> FloatArray:
            return system.prescribed_twist(start + elapsed)

        return system.motions.dry_dynamics(now, load, system.arms, start, prescribed_twist)
