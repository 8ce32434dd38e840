"""State of a run after bodies have entered or left it: rows of those that stay, and the flow around all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.case.population import Population, Present, assemble_present
from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mechanics.rigid import cross
from rigidfluid.core.mechanics.wrenches import flat, nothing
from rigidfluid.core.mesh.adaptation.updater import Updater
from rigidfluid.core.model.fluid_backend import Filling
from rigidfluid.core.model.state import LinkLoad, MotionState, Prescription, State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import TangentialSprings, spring_energy
from rigidfluid.core.model.types import Pose, Twist, Wrench
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.control import following, present_motion
from rigidfluid.core.run.initial_state import start_level
from rigidfluid.core.run.step import bodies_energy, stored_energy
from rigidfluid.core.setup.changeable import require_changeable
from rigidfluid.core.setup.model import Model
from rigidfluid.core.setup.prescribed import PrescribedMotion, prescribed_motion


@dataclass(frozen=True)
class Staying:
    """Rows of what stays in a change: ``kept`` (m,) before, and ``places`` (m,) after it."""

    kept: IntArray
    places: IntArray

    @classmethod
    def among(cls, before: Sequence[str], after: Sequence[str]) -> Staying:
        """Rows of the names that there are before and after."""
        places = {name: row for row, name in enumerate(after)}
        rows = [(row, places[name]) for row, name in enumerate(before) if name in places]
        return cls(*np.array(rows, dtype=np.int64).reshape(-1, 2).T)

    def rows(self, old: FloatArray, new: FloatArray) -> FloatArray:
        """``old`` (n, …) of those that stay, and ``new`` (n', …) of those that enter."""
        found = new.copy()
        found[self.places] = old[self.kept]
        return found

    def pose(self, old: Pose, new: Pose) -> Pose:
        """Pose after the exchange."""
        return Pose(self.rows(old.position, new.position), self.rows(old.orientation, new.orientation))

    def twist(self, old: Twist, new: Twist) -> Twist:
        """Twist after the exchange."""
        velocity = self.rows(old.velocity, new.velocity)
        return Twist(velocity, self.rows(old.angular_velocity, new.angular_velocity))

    def wrench(self, old: Wrench, now: Pose) -> Wrench:
        """Wrench after the exchange, zero on those that enter, at the pose ``now``."""
        new = nothing(now)
        return Wrench(self.rows(old.force, new.force), self.rows(old.torque, new.torque))


@dataclass(frozen=True)
class Exchange:
    """Bodies of a system ``before`` and ``after`` a change: rows of the ``bodies`` that stay, and of the ``motions``
    that carry them."""

    before: System
    after: System
    bodies: Staying
    motions: Staying

    @classmethod
    def between(cls, before: System, after: System) -> Exchange:
        """The exchange between two systems whose bodies go by their names."""
        bodies = Staying.among(_names(before), _names(after))
        return cls(before, after, bodies, Staying.among(_motion_names(before), _motion_names(after)))

    @property
    def gone(self) -> IntArray:
        """Rows before of the bodies that leave."""
        return np.setdiff1d(np.arange(len(self.before.bodies)), self.bodies.kept)

    @property
    def come(self) -> IntArray:
        """Rows after of the bodies that enter."""
        return np.setdiff1d(np.arange(len(self.after.bodies)), self.bodies.places)

    def prescription(self, old: Prescription, new: Prescription) -> Prescription:
        """Prescribed motions after the exchange."""
        names = ("twist", "before", "over", "amplitude", "frequency", "start")
        rows = {name: self.motions.rows(getattr(old, name), getattr(new, name)) for name in names}
        return Prescription(**rows, pose=self.motions.pose(old.pose, new.pose))

    def carried(self, old: MotionState) -> MotionState:
        """Motions after the exchange."""
        new, stay = self.after.motions, self.motions
        pose, twist = stay.pose(old.pose, new.pose), stay.twist(old.twist, new.twist)
        return MotionState(pose, twist, stay.wrench(old.contact, pose), stay.wrench(old.hydrodynamic, pose))

    def link(self, old: LinkLoad) -> LinkLoad:
        """Load of joints and springs, whose bodies stay."""
        return LinkLoad(old.force, self.motions.rows(old.wrench, flat(nothing(self.after.motions.pose))))

    def springs(self, old: TangentialSprings) -> TangentialSprings:
        """Springs between surfaces that stay."""
        numbers = {name: number for number, name in enumerate(self.after.surfaces)}
        now = np.array([numbers.get(name, -1) for name in self.before.surfaces], dtype=np.int64)
        body_a, body_b = now[old.body_a], now[old.body_b]
        stay = (body_a >= 0) & (body_b >= 0)
        return replace(old.select(stay), body_a=body_a[stay], body_b=body_b[stay])

    def filling(self, pose: Pose, twist: Twist) -> Filling:
        """Rigid velocities where bodies have left, which were at ``pose`` with ``twist``, or an image of them."""
        gone, lattice = self.gone, self.before.lattice

        def velocities(points: FloatArray) -> tuple[BoolArray, FloatArray]:
            left, velocity = np.zeros(len(points), dtype=bool), np.zeros_like(points)
            for body in gone:
                arm = lattice.shortened(points - pose.position[body])
                inside = distance_to_body(pose, body, self.before.bodies[body], pose.position[body] + arm) <= 0.0
                velocity[inside] = twist.velocity[body] + cross(twist.angular_velocity[body], arm[inside])
                left |= inside
            return left, velocity

        return velocities


@dataclass(frozen=True)
class Successor:
    """Bodies that a run goes on with: their ``population`` and ``model``, the ``exchange`` that leads to their system,
    and the ``prescription`` of their motions."""

    population: Population
    model: Model
    exchange: Exchange
    prescription: Prescription


def successor(
    origin: Model, model: Model, system: System, state: State, population: Population, time: float
) -> Successor:
    """The bodies of a ``population`` of the model ``origin`` after those of a ``model`` and ``system`` in a ``state``,
    at a ``time``; raises SceneError where they cannot be, or overlap."""
    require_changeable(model)
    population = population.placed(Present(time, _motion_names(system), state.motions.pose, state.motions.twist))
    now = population.model(origin)
    require_changeable(now)
    after = assemble_present(origin, now, population)
    exchange = Exchange.between(system, after)
    given = prescribed_motion(now.bodies, after.motions.pose, time).rows
    prescription = exchange.prescription(present_motion(model, system, state).rows, given)
    after = following(after, PrescribedMotion(prescription))
    return Successor(population, now, replace(exchange, after=after), prescription)


def exchanged(successor: Successor, state: State, updater: Updater, clock: Clock) -> State:
    """The state among the bodies of a successor, at the same time, on a new mesh; raises MeshError where there is
    none."""
    exchange, system = successor.exchange, successor.exchange.after
    stay, motions, time = exchange.bodies, exchange.carried(state.motions), clock.time(state.tick)
    pose, twist = stay.pose(state.pose, system.pose), stay.twist(state.twist, system.twist)
    mesh = updater.first_mesh()
    filling = exchange.filling(state.pose, state.twist)
    fluid, kinetic = system.backend.with_bodies(state.fluid, state.mesh, mesh, pose, twist, filling)
    contacts, gaps = detect_contacts_and_gaps(system, pose, mesh)
    springs = None if state.springs is None else exchange.springs(state.springs)
    stored = stored_energy(system, contacts, motions.pose, time) + spring_energy(springs)
    ledger = state.ledger.after_exchange(kinetic + bodies_energy(system, pose, twist), stored)
    now = replace(
        state,
        pose=pose,
        twist=twist,
        past=None,
        mesh=mesh,
        reference=replace(updater.first_reference(mesh, gaps), pose=pose, tick=state.tick),
        fluid=fluid,
        contacts=contacts,
        coupling=None,
        gaps=gaps,
        hydrodynamic_wrench=stay.wrench(state.hydrodynamic_wrench, pose),
        contact_wrench=stay.wrench(state.contact_wrench, pose),
        motions=motions,
        link=exchange.link(state.link),
        ledger=ledger,
        stresslet=None,
        boundary_forces=None,
        cell_errors=None,
        flow_error=None,
        remesh_failed=None,
        estimate=None if state.estimate is None else state.estimate.restarted,
        prescription=successor.prescription,
        applied=None if state.applied is None else stay.wrench(state.applied, pose),
        springs=springs,
    )
    return _started(system, clock, now) if system.has_fluid else now


def _started(system: System, clock: Clock, state: State) -> State:
    """The state, from which the fluid starts as after an impact: with short steps, and stresses that nobody knows."""
    ledger = replace(state.ledger, power=None)
    if not system.quasi_steady:
        ledger = replace(ledger, since_start=0.0)
    return replace(state, level=start_level(clock), ledger=ledger)


def _names(system: System) -> tuple[str, ...]:
    return system.surfaces[: len(system.bodies)]


def _motion_names(system: System) -> tuple[str, ...]:
    single = len(system.motions.mass) - len(system.motions.names)
    return (*system.surfaces[:single], *system.motions.names)
