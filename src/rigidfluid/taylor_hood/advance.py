"""One step of fluid and bodies together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.types import Advance, FloatArray, FluidState, Mesh, Step, Twist, Wrench
from rigidfluid.taylor_hood.boundary import face_power, pressure_load
from rigidfluid.taylor_hood.coupled import CoupledSystem
from rigidfluid.taylor_hood.discretisation import Discretisation, dissipation, kinetic_energy


@dataclass(frozen=True)
class _Equations:
    """The step's system, and the part of its load that comes from the faces (nodes, d)."""

    system: CoupledSystem
    pressure_load: FloatArray


def advance(discretisation: Discretisation, tolerance: float, fluid: FluidState, mesh: Mesh, step: Step) -> Advance:
    """Assemble, constrain, solve and measure one step from ``fluid`` on ``mesh`` to ``step.points``."""
    equations = _equations(discretisation, fluid, mesh, step)
    system, problem, surfaces = equations.system, discretisation.problem, discretisation.surfaces
    solution = discretisation.solve(system, tolerance)
    velocity, twist = solution.velocity, solution.twist
    state = {
        "velocity": velocity,
        "velocity_previous": fluid["velocity"],
        "pressure": _centred(discretisation, system.points, solution.pressure),
        "pressure_previous": fluid["pressure"],
        "points_previous": mesh.points,
        "twist": twist,
        "twist_previous": fluid["twist"],
        "position": step.pose.position,
        "position_previous": fluid["position"],
    }
    d, at = problem.dimension, system.node_points
    on_bodies = -surfaces.resultants(solution.reaction, at, step.pose.position)
    return Advance(
        fluid=state,
        twist=Twist(twist[:, :d], twist[:, d:]),
        hydrodynamic_wrench=Wrench(on_bodies[:, :d], on_bodies[:, d:]),
        kinetic_energy=kinetic_energy(discretisation, system.points, velocity),
        dissipation=dissipation(discretisation, system.points, velocity),
        boundary_power=face_power(
            surfaces, problem.inert_density, at, velocity, equations.pressure_load, solution.reaction
        ),
    )


def _equations(discretisation: Discretisation, fluid: FluidState, mesh: Mesh, step: Step) -> _Equations:
    problem, numbering, surfaces = discretisation.problem, discretisation.numbering, discretisation.surfaces
    points, density = _new_points(step), problem.inert_density
    d0, d1, d2 = step.derivative
    e0, e1 = step.extrapolation
    node_points = numbering.node_points(points)
    mesh_velocity = numbering.node_points(d0 * points + d1 * mesh.points + d2 * fluid["points_previous"])
    extrapolated = e0 * fluid["velocity"] + e1 * fluid["velocity_previous"]
    density_of_load = -density * (d1 * fluid["velocity"] + d2 * fluid["velocity_previous"])
    if problem.source is not None:
        density_of_load += problem.source(step.time, node_points)
    on_faces = pressure_load(surfaces, node_points, step.time)
    expected = e0 * fluid["twist"] + e1 * fluid["twist_previous"]
    position, controlled = step.pose.position, step.controlled
    system = CoupledSystem(
        points=points,
        node_points=node_points,
        inertia=density * d0,
        viscosity=problem.dynamic_viscosity,
        advection=density * (extrapolated - mesh_velocity),
        load=discretisation.mass_times(points, density_of_load) + on_faces,
        given=surfaces.prescribed(step.time, node_points, position, step.controlled_twist, controlled),
        position=position,
        mass_matrix=step.mass_matrix,
        body_load=step.load,
        controlled=controlled,
        velocity=extrapolated,
        pressure=e0 * fluid["pressure"] + e1 * fluid["pressure_previous"],
        twist=np.where(controlled[:, None], step.controlled_twist, expected),
    )
    return _Equations(system, on_faces)


def _new_points(step: Step) -> FloatArray:
    assert step.points is not None, "backends of finite elements declare needs_mesh"
    return step.points


def _centred(discretisation: Discretisation, points: FloatArray, pressure: FloatArray) -> FloatArray:
    """In an enclosed flow the pressure's constant is free: take the one with zero mean."""
    surfaces, cells = discretisation.surfaces, discretisation.numbering.cells
    if not surfaces.enclosed:
        return pressure
    volume = np.abs(np.linalg.det(points[cells[:, 1:]] - points[cells[:, :1]]))
    integral, whole = surfaces.ranks.sum(np.array([volume @ pressure[cells].mean(axis=1), volume.sum()]))
    return np.asarray(pressure - integral / whole)
