"""One step of fluid and bodies together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.mechanics.kinematics import given_twist
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.types import Advance, FloatArray, FluidState, Mesh, Step, Twist, Wrench
from rigidfluid.taylor_hood.boundary import face_leak, face_power, pressure_load
from rigidfluid.taylor_hood.container import container_velocity
from rigidfluid.taylor_hood.coupled import CoupledMatrix, CoupledSystem, with_masses
from rigidfluid.taylor_hood.discretisation import Discretisation, dissipation, kinetic_energy, stress_power
from rigidfluid.taylor_hood.grad_div import grad_div_dissipation
from rigidfluid.taylor_hood.links import solve_linked

_TURNING_TOLERANCE = 1e-3
"""Relative residual of the solve that corrects the advection near bodies which contacts turn around [1]."""


def advance(
    discretisation: Discretisation,
    matrix: CoupledMatrix,
    tolerance: float,
    fluid: FluidState,
    mesh: Mesh,
    step: Step,
    attempt: FluidState | None,
) -> Advance:
    """Constrain, solve and measure one step from ``fluid`` on ``mesh`` by its ``matrix``.

    The solution of an earlier ``attempt`` at the step is the first guess; without one, the extrapolation in time.
    """
    problem, surfaces, points = discretisation.problem, discretisation.surfaces, matrix.points
    before = mesh.geometry
    on_faces = pressure_load(surfaces, matrix.node_points, step.time)
    system = _system(discretisation, matrix, on_faces, fluid, step)
    if attempt is not None:
        guess = step.kinematics.motion_twist(attempt["twist"])
        velocity, pressure = attempt["velocity"], attempt["pressure"]
        system = replace(system, velocity=velocity, pressure=pressure, twist=guess, again=True)
    solution, link_force = solve_linked(discretisation, system, step.links, tolerance)
    d = problem.dimension
    if solution.jump_load is not None:
        on_faces = on_faces + solution.jump_load
    velocity, twist = solution.velocity, Twist(solution.twist[:, :d], solution.twist[:, d:])
    state = {
        "velocity": velocity,
        "velocity_previous": fluid["velocity"],
        "pressure": centre_pressure(discretisation, points, solution.pressure),
        "pressure_previous": fluid["pressure"],
        "points_previous": before,
        "twist": flat(step.kinematics.component_twist(twist)),
        "twist_previous": fluid["twist"],
        "position": step.pose.position,
        "position_previous": fluid["position"],
    }
    at = matrix.node_points

    def mesh_velocity() -> FloatArray:
        """Written so that it is zero to the last bit where nothing moves."""
        d0, _, d2 = step.derivative
        moved, moved_before = points - before, before - fluid["points_previous"]
        return discretisation.numbering.node_points(d0 * moved - d2 * moved_before)

    mean = 0.5 * (fluid["velocity"] + velocity)
    begins = problem.inertia and step.derivative[2] == 0.0
    on_bodies = -surfaces.resultants(solution.reaction, at, step.pose.position)
    return Advance(
        fluid=state,
        twist=twist,
        hydrodynamic_wrench=Wrench(on_bodies[:, :d], on_bodies[:, d:]),
        kinetic_energy=kinetic_energy(discretisation, points, velocity),
        dissipation=dissipation(discretisation, points, velocity),
        dissipation_midway=dissipation(discretisation, 0.5 * (before + points), mean),
        boundary_power=face_power(
            surfaces, problem.inert_density, at, velocity, mesh_velocity, on_faces, solution.reaction
        ),
        link_force=link_force,
        leak=face_leak(surfaces, problem.inert_density, at, velocity, mesh_velocity),
        grad_div=grad_div_dissipation(discretisation, matrix, velocity),
        source_power=_source_power(discretisation, matrix, velocity, step.time),
        stress_power=stress_power(discretisation, points, velocity, mean) if begins else None,
    )


def _source_power(discretisation: Discretisation, matrix: CoupledMatrix, velocity: FloatArray, time: float) -> float:
    """∫ f·u of the source f [energy/time]."""
    source, ranks = discretisation.problem.source, discretisation.surfaces.ranks
    if source is None:
        return 0.0
    load = discretisation.mass_times(matrix.points, source(time, matrix.node_points))
    return float(ranks.sum(np.sum(velocity * load)))


def step_matrix(discretisation: Discretisation, fluid: FluidState, mesh: Mesh, step: Step) -> CoupledMatrix:
    """The matrix of a step: BDF's inertia, viscosity, and convection by u* - w, u* extrapolated and w differenced.

    Without new points it is that of the present mesh, which moves on as it did.
    """
    problem, numbering, density = discretisation.problem, discretisation.numbering, discretisation.problem.inert_density
    (d0, d1, d2), (e0, e1) = step.derivative, step.extrapolation
    present, before = mesh.geometry, fluid["points_previous"]
    points = present if step.points is None else step.points
    expected = e0 * present + e1 * before if step.points is None else points
    node_points, flow = numbering.node_points(points), density * extrapolated(fluid, step.extrapolation)
    frame = np.zeros(problem.dimension)
    if density > 0.0:
        frame = container_velocity(discretisation.surfaces, step.time, node_points)
    mesh_velocity = numbering.node_points(d0 * expected + d1 * present + d2 * before)
    matrix = CoupledMatrix(
        points=points,
        node_points=node_points,
        inertia=density * d0,
        viscosity=problem.dynamic_viscosity,
        advection=flow - density * mesh_velocity,
        flow=flow - density * frame,
        position=step.kinematics.centres(step.pose),
        mass_matrix=step.mass_matrix,
        controlled=step.controlled,
        frame=frame,
    )
    if density == 0.0 or d0 == 0.0:
        return matrix
    matrix = with_masses(matrix, d0)
    if matrix.at_once is None or not step.turning.any():
        return matrix
    turned = density * discretisation.velocity_response(matrix.at_once, step.turning, _TURNING_TOLERANCE)
    return replace(matrix, advection=matrix.advection + turned, flow=matrix.flow + turned)


def _system(
    discretisation: Discretisation, matrix: CoupledMatrix, on_faces: FloatArray, fluid: FluidState, step: Step
) -> CoupledSystem:
    problem, surfaces = discretisation.problem, discretisation.surfaces
    node_points, controlled = matrix.node_points, matrix.controlled
    _, d1, d2 = step.derivative
    e0, e1 = step.extrapolation
    history = d1 * fluid["velocity"] + d2 * fluid["velocity_previous"]
    density_of_load = -problem.inert_density * history - matrix.inertia * matrix.frame
    if problem.source is not None:
        density_of_load += problem.source(step.time, node_points)
    expected = step.kinematics.motion_twist(e0 * fluid["twist"] + e1 * fluid["twist_previous"])
    given, driven = given_twist(step)
    return CoupledSystem(
        matrix,
        load=discretisation.mass_times(matrix.points, density_of_load) + on_faces,
        body_load=step.load,
        given=surfaces.prescribed(step.time, node_points, step.pose.position, flat(given), driven),
        velocity=extrapolated(fluid, step.extrapolation),
        pressure=e0 * fluid["pressure"] + e1 * fluid["pressure_previous"],
        twist=np.where(controlled[:, None], step.controlled_twist, expected),
        pressure_jump=surfaces.pressure_jump(step.time, matrix.points[: discretisation.numbering.vertices]),
        scale=step.load_scale,
    )


def extrapolated(fluid: FluidState, weights: FloatArray) -> FloatArray:
    """u* = e₀uⁿ + e₁uⁿ⁻¹ with ``weights`` e (2,)."""
    e0, e1 = weights
    return np.asarray(e0 * fluid["velocity"] + e1 * fluid["velocity_previous"])


def centre_pressure(discretisation: Discretisation, points: FloatArray, pressure: FloatArray) -> FloatArray:
    """Pressure (vertices,) with zero mean in an enclosed flow, whose constant is free; unchanged in others."""
    surfaces, cells = discretisation.surfaces, discretisation.numbering.cells
    if not surfaces.enclosed:
        return pressure
    volume = np.abs(cell_volumes(points, cells))
    integral, whole = surfaces.ranks.sum(np.array([volume @ pressure[cells].mean(axis=1), volume.sum()]))
    return np.asarray(pressure - integral / whole)
