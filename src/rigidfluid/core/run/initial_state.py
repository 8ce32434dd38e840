"""State at which a run starts."""

from __future__ import annotations

from dataclasses import replace

from rigidfluid.core.contact.laws.spot_check import spot_check
from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.mesh.adaptation.updater import FirstMesh
from rigidfluid.core.model.energy import Ledger, Power
from rigidfluid.core.model.state import MotionState, State
from rigidfluid.core.model.system import System
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.step import bodies_energy, stored_energy
from rigidfluid.core.run.sudden_start import faces_start_at_once, struck

START_LEVEL = 6
"""Number of halvings of the first step in a fluid in motion; each later step is at most twice the last, and after a
start at once at most half of the time since."""


def initial_state(system: System, mesh_updater: FirstMesh, clock: Clock, starts_short: bool = False) -> State:
    """The state at time zero, on its first mesh; raises MeshError where there is none,
    PluginError where a detector or law is not what it should be."""
    zero = nothing(system.pose)
    mesh = mesh_updater.first_mesh()
    spot_check(system, system.pose, mesh, 0)
    contacts, gaps = detect_contacts_and_gaps(system, system.pose, mesh)
    motions = system.motions
    stored = stored_energy(system, contacts, motions.pose, 0.0)
    state = State(
        tick=0,
        count=0,
        level=start_level(clock) if starts_short else None,
        pose=system.pose,
        twist=system.twist,
        past=None,
        mesh=mesh,
        reference=mesh_updater.first_reference(mesh, gaps),
        fluid={},
        contacts=contacts,
        coupling=None,
        gaps=gaps,
        hydrodynamic_wrench=zero,
        contact_wrench=zero,
        motions=MotionState(motions.pose, motions.twist, nothing(motions.pose), nothing(motions.pose)),
        link=system.joints.unloaded(motions.pose),
        ledger=Ledger(0.0, stored, stored),
    )
    return _with_flow(system, clock, state)


def _with_flow(system: System, clock: Clock, state: State) -> State:
    """The state with the fluid as it starts, bodies that it sets in motion, and what they store."""
    faces = _faces_start_at_once(system, state)
    after = struck(system, state, clock.step) if faces and not system.quasi_steady else None
    if after is None:
        faces = faces and system.quasi_steady
        fluid, kinetic = system.backend.initial(state.mesh, state.pose, state.twist)
        state = replace(state, fluid=fluid)
    else:
        state, kinetic = after
    kinetic += bodies_energy(system, state.pose, state.twist)
    stored = state.ledger.contact
    ledger = Ledger(kinetic, stored, kinetic + stored, power=_power(system, state, faces))
    if _starts_at_once(system, state, faces):
        ledger = ledger if system.quasi_steady else replace(ledger, since_start=0.0)
        return replace(state, level=start_level(clock), ledger=ledger)
    return replace(state, ledger=ledger)


def _faces_start_at_once(system: System, state: State) -> bool:
    """Tell whether faces drive a fluid at once that was at rest."""
    problem = system.fluid
    if problem is None or problem.initial != "rest":
        return False
    return faces_start_at_once(problem, state.mesh)


def _power(system: System, state: State, faces: bool) -> Power | None:
    """Power at the start; None where the fluid starts in motion, since nobody has solved for its stresses yet."""
    problem = system.fluid
    at_rest = problem is None or (problem.initial == "rest" and not faces and not _bodies_move(state))
    return Power() if at_rest else None


def _starts_at_once(system: System, state: State, faces: bool) -> bool:
    """Tell whether the motion does not start smoothly.

    Bodies or faces that start with a velocity set the fluid in motion at once, but for a layer on them that spreads
    fast; so do contacts that let go, weight where the fluid has no inertia, and a flow that is given past bodies that
    hold it. Without inertia free bodies alone take time to follow the faces.
    """
    problem = system.fluid
    if problem is None:
        return False
    given = not isinstance(problem.initial, str)
    driven = faces and (problem.inertia or not system.motions.prescribed.all())
    released = state.ledger.contact != 0.0 or (not problem.inertia and system.weight.any())
    return bool(_bodies_move(state) or given or driven or released)


def _bodies_move(state: State) -> bool:
    return bool(state.twist.velocity.any() or state.twist.angular_velocity.any())


def start_level(clock: Clock) -> int:
    """The level that the next step may be twice as long as after something has changed at once."""
    return min(START_LEVEL + 1, clock.levels)
