"""Where a run starts."""

from __future__ import annotations

from rigidfluid.core.contact.proximity import detect_contacts_and_gaps
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.mesh.mesh_adaptation import MeshUpdater, reference_of
from rigidfluid.core.model.energy import Ledger, Power
from rigidfluid.core.model.state import FreeMotions, State
from rigidfluid.core.model.system import System
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.step import bodies_energy, stored_energy

START_LEVEL = 6
"""In a fluid in motion the first step is the step halved so many times, and each later one at most twice the last."""


def initial_state(system: System, mesh_updater: MeshUpdater, clock: Clock, starts_short: bool = False) -> State:
    """The state at time zero, on its first mesh; raises MeshError where there is none."""
    zero = nothing(system.pose)
    mesh = mesh_updater.first_mesh()
    contacts, gaps = detect_contacts_and_gaps(system, system.pose, mesh)
    fluid, kinetic = system.backend.initial(mesh, system.pose, system.twist)
    kinetic += bodies_energy(system, system.pose, system.twist)
    motions = system.pose if system.mechanisms is None else system.mechanisms.pose
    stored = stored_energy(system, contacts, motions, 0.0)
    return State(
        tick=0,
        count=0,
        level=start_level(clock) if starts_short else _level(system, clock, stored),
        pose=system.pose,
        twist=system.twist,
        past=None,
        mesh=mesh,
        reference=None if mesh is None else reference_of(mesh, system.pose, gaps, 0),
        fluid=fluid,
        contacts=contacts,
        coupling=None,
        gaps=gaps,
        hydrodynamic_wrench=zero,
        contact_wrench=zero,
        ledger=Ledger(kinetic, stored, kinetic + stored, power=_power(system)),
        free=_free_motions(system),
    )


def _power(system: System) -> Power | None:
    """None where the fluid starts in motion: nobody has solved for its stresses yet."""
    problem = system.backend.problem
    return Power() if problem is None or problem.initial == "rest" else None


def _free_motions(system: System) -> FreeMotions | None:
    motions = system.mechanisms
    if motions is None:
        return None
    return FreeMotions(motions.pose, motions.twist, nothing(motions.pose), nothing(motions.pose))


def _level(system: System, clock: Clock, stored: float) -> int | None:
    """The level that the first step may be twice as long as; any where the motion starts smoothly.

    Bodies that start with a velocity set the fluid in motion at once, but for a layer on them that spreads fast; so do
    contacts that let go, weight where the fluid has no inertia, and a flow that is given past bodies that hold it.
    """
    problem = system.backend.problem
    if not system.backend.needs_mesh or problem is None:
        return None
    moves = system.twist.velocity.any() or system.twist.angular_velocity.any()
    given = not isinstance(problem.initial, str)
    at_once = moves or given or stored > 0.0 or (not problem.inertia and system.weight.any())
    return start_level(clock) if at_once else None


def start_level(clock: Clock) -> int:
    """The level that the next step may be twice as long as after something has changed at once."""
    return min(START_LEVEL + 1, clock.levels)
