"""One step of fluid and bodies together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.kinematics import prescribed_part
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.boundary_forces import BoundaryForces
from rigidfluid.core.model.types import Advance, FluidState, Mesh, Step, Twist, Wrench
from rigidfluid.taylor_hood.elements.container import container_velocity
from rigidfluid.taylor_hood.stepping.boundary_forces import BoundaryFlow, boundary_forces
from rigidfluid.taylor_hood.stepping.cell_errors import DiscreteFlow, cell_errors
from rigidfluid.taylor_hood.stepping.momentum import Moving, momentum, past_load
from rigidfluid.taylor_hood.stepping.newton import solve_newton
from rigidfluid.taylor_hood.stepping.stresslets import body_volumes, stresslets
from rigidfluid.taylor_hood.system.boundary import FaceFlow, pressure_load
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem, Solution, masses_alone
from rigidfluid.taylor_hood.system.discretisation import Discretisation, dissipation, kinetic_energy, stress_power
from rigidfluid.taylor_hood.system.grad_div import grad_div_dissipation
from rigidfluid.taylor_hood.system.linearised import local_viscosity

_TURNING_TOLERANCE = 1e-3
"""Relative residual of the solve that corrects the advection near bodies which contacts turn around [1]."""


@dataclass(frozen=True, eq=False)
class Equations:
    """Equations of one ``step`` from ``fluid`` on ``mesh``: their ``matrix`` is that of `step_matrix`."""

    discretisation: Discretisation
    matrix: CoupledMatrix
    fluid: FluidState
    mesh: Mesh
    step: Step

    def mesh_velocity(self) -> FloatArray:
        """Velocity of the nodes (nodes, d) at the end of the step, zero to the last bit where nothing moves."""
        d0, _, d2 = self.step.derivative
        before = self.mesh.geometry
        moved, moved_before = self.matrix.points - before, before - self.fluid["points_previous"]
        return self.discretisation.numbering.node_points(d0 * moved - d2 * moved_before)


def advance(equations: Equations, tolerance: float, attempt: FluidState | None) -> Advance:
    """Constrain, solve and measure one step.

    The solution of an earlier ``attempt`` at the step is the first guess; without one, the extrapolation in time.
    """
    discretisation, step = equations.discretisation, equations.step
    on_faces = pressure_load(discretisation.surfaces, equations.matrix.node_points, step.time)
    system = coupled_system(equations, on_faces)
    if attempt is not None:
        guess = step.kinematics.motion_twist(attempt["twist"])
        velocity, pressure = attempt["velocity"], attempt["pressure"]
        system = replace(system, velocity=velocity, pressure=pressure, twist=guess, again=True)
    matrix, driven = solve_newton(discretisation, system, step.links, step.time, tolerance)
    solution, on_faces = driven.solution, on_faces + driven.load
    if solution.jump_load is not None:
        on_faces = on_faces + solution.jump_load
    solution = with_momentum_kept(equations, solution, on_faces)
    return _measured(replace(equations, matrix=matrix), solution, on_faces, driven.link_force)


def with_momentum_kept(equations: Equations, solution: Solution, on_faces: FloatArray) -> Solution:
    """The solution with the momentum that loads, those ``on_faces`` (nodes, d) among them, have given, where nothing
    outside takes any."""
    moving = Moving(equations.discretisation, equations.step, equations.matrix.points)
    return moving.with_gain(solution, _momentum_load(equations, on_faces)) if moving.free else solution


def _momentum_load(equations: Equations, on_faces: FloatArray) -> FloatArray:
    """Load (d,) by which the momentum of fluid at earlier times, forces on it and those ``on_faces`` (nodes, d) give
    that at the end of the step."""
    discretisation, load, force = equations.discretisation, on_faces.sum(axis=0), _force(equations)
    if force is not None:
        load = load + discretisation.mass_times(equations.matrix.points, force).sum(axis=0)
    return np.asarray(discretisation.surfaces.ranks.sum(load) + past_load(equations.fluid, equations.step.derivative))


def _measured(equations: Equations, solution: Solution, on_faces: FloatArray, link_force: FloatArray) -> Advance:
    """The step's result: its state, and the forces and energies of its solution."""
    discretisation, matrix, fluid = equations.discretisation, equations.matrix, equations.fluid
    problem, surfaces, step = discretisation.problem, discretisation.surfaces, equations.step
    at, velocity = matrix.node_points, solution.velocity
    mean = 0.5 * (fluid["velocity"] + velocity)
    midway = 0.5 * (equations.mesh.geometry + matrix.points)
    begins = problem.inertia and step.derivative[2] == 0.0
    at_faces = FaceFlow(surfaces, problem.inert_density, at, velocity, equations.mesh_velocity)
    end = state_at_end(equations, solution)
    return Advance(
        fluid=end,
        twist=motion_twist(solution),
        hydrodynamic_wrench=hydrodynamic_wrench(equations, solution),
        kinetic_energy=kinetic_energy(discretisation, matrix.points, velocity),
        dissipation=dissipation(discretisation, matrix.points, velocity),
        dissipation_midway=dissipation(discretisation, midway, mean),
        boundary_power=at_faces.power(on_faces, solution.reaction),
        link_force=link_force,
        spurious_flux=at_faces.spurious_flux(),
        grad_div=grad_div_dissipation(discretisation, matrix, velocity),
        source_power=_source_power(equations, velocity),
        stress_power=stress_power(discretisation, matrix.points, velocity, mean) if begins else None,
        stresslet=_stresslets(equations, solution, end) if step.stresslets else None,
        boundary_forces=_boundary_forces(equations, solution, end) if step.boundary_forces else None,
        cell_errors=_cell_errors(equations, solution) if step.cell_errors and not step.provisional else None,
    )


def _cell_errors(equations: Equations, solution: Solution) -> FloatArray:
    """Squared errors of the cells (M,) [energy/time]."""
    matrix, discretisation = equations.matrix, equations.discretisation
    flow = DiscreteFlow(
        discretisation.numbering,
        matrix.node_points,
        solution.velocity,
        solution.pressure,
        matrix.advection,
        matrix.inertia * (solution.velocity - matrix.frame) - _load_density(equations),
    )
    return cell_errors(flow, discretisation.problem.material)


def _stresslets(equations: Equations, solution: Solution, end: FluidState) -> FloatArray:
    """Stresslets of the bodies (n, d, d), for the pressure of the state at the ``end``."""
    surfaces, points = equations.discretisation.surfaces, equations.matrix.node_points
    found = stresslets(surfaces, -solution.reaction, points, equations.step.pose.position)
    if not surfaces.enclosed:
        return found
    volumes = body_volumes(surfaces, equations.mesh, points)
    return np.asarray(found - _raised(solution, end) * volumes[:, None, None] * np.eye(points.shape[1]))


def _boundary_forces(equations: Equations, solution: Solution, end: FluidState) -> BoundaryForces:
    """Forces on the pieces of the boundary, for the pressure of the state at the ``end``."""
    flow = BoundaryFlow(
        surfaces=equations.discretisation.surfaces,
        mesh=equations.mesh,
        material=equations.discretisation.problem.material,
        time=equations.step.time,
        points=equations.matrix.node_points,
        velocity=solution.velocity,
        pressure=solution.pressure,
        reaction=solution.reaction,
        raised=_raised(solution, end),
    )
    return boundary_forces(flow)


def _raised(solution: Solution, end: FluidState) -> float:
    """Pressure of the state at the ``end`` less that of the solution, the same everywhere [force/length^(d-1)]."""
    return float(end["pressure"][0] - solution.pressure[0])


def hydrodynamic_wrench(equations: Equations, solution: Solution) -> Wrench:
    """The fluid's force and torque on each body."""
    at, position = equations.matrix.node_points, equations.step.pose.position
    on_bodies = -equations.discretisation.surfaces.resultants(solution.reaction, at, position)
    return Wrench(*np.split(on_bodies, [position.shape[1]], axis=1))


def state_at_end(equations: Equations, solution: Solution) -> FluidState:
    """The fluid's state at the end of the step, with what it keeps of the one before."""
    fluid, step, discretisation = equations.fluid, equations.step, equations.discretisation
    twist = motion_twist(solution)
    state = {
        "velocity": solution.velocity,
        "velocity_previous": fluid["velocity"],
        "pressure": centre_pressure(discretisation, equations.matrix.points, solution.pressure),
        "pressure_previous": fluid["pressure"],
        "points_previous": equations.mesh.geometry,
        "twist": flat(step.kinematics.component_twist(twist)),
        "twist_previous": fluid["twist"],
        "position": step.pose.position,
        "position_previous": fluid["position"],
    }
    if discretisation.problem.keeps_momentum:
        now = momentum(discretisation, equations.matrix.points, solution.velocity)
        state |= {"momentum": now, "momentum_previous": fluid["momentum"]}
    return state


def motion_twist(solution: Solution) -> Twist:
    """Twists of the motions."""
    return Twist(*np.split(solution.twist, [solution.velocity.shape[1]], axis=1))


def _source_power(equations: Equations, velocity: FloatArray) -> float:
    """∫ f·u of the force f on the fluid [energy/time]."""
    force, discretisation = _force(equations), equations.discretisation
    if force is None:
        return 0.0
    load = discretisation.mass_times(equations.matrix.points, force)
    return float(discretisation.surfaces.ranks.sum(np.sum(velocity * load)))


def _force(equations: Equations) -> FloatArray | None:
    """Force on the fluid at the nodes (nodes, d), of the problem's source and of buoyancy [force/volume]; None without
    any."""
    problem, step, fluid = equations.discretisation.problem, equations.step, equations.fluid
    force = None if problem.source is None else problem.source(step.time, equations.matrix.node_points)
    if problem.scalar is None or problem.scalar.buoyancy is None:
        return force
    expected = step.extrapolation @ np.stack([fluid["scalar"], fluid["scalar_previous"]])
    buoyancy = problem.scalar.buoyancy.force(problem.density, expected)
    return buoyancy if force is None else force + buoyancy


def step_matrix(discretisation: Discretisation, fluid: FluidState, mesh: Mesh, step: Step) -> CoupledMatrix:
    """The matrix of a step: BDF's inertia, viscosity, and convection by u* - w, u* extrapolated and w differenced.

    Without new points it is that of the present mesh, which moves on as it did.
    """
    problem, numbering, density = discretisation.problem, discretisation.numbering, discretisation.problem.inert_density
    (d0, d1, d2), (e0, e1) = step.derivative, step.extrapolation
    present, before = mesh.geometry, fluid["points_previous"]
    points = present if step.points is None else step.points
    expected = e0 * present + e1 * before if step.points is None else points
    expected_velocity = extrapolated(fluid, step.extrapolation)
    node_points, flow = numbering.node_points(points), density * expected_velocity
    frame = np.zeros(problem.dimension)
    if density > 0.0:
        frame = _frame(Moving(discretisation, step, points), node_points, fluid, expected_velocity)
    mesh_velocity = numbering.node_points(d0 * expected + d1 * present + d2 * before)
    matrix = CoupledMatrix(
        points=points,
        node_points=node_points,
        inertia=density * d0,
        viscosity=problem.material.dynamic_viscosity,
        advection=flow - density * mesh_velocity,
        flow=flow - density * frame,
        position=step.pose.position - step.kinematics.arm,
        mass_matrix=step.mass_matrix,
        prescribed=step.prescribed,
        frame=frame,
        local=local_viscosity(discretisation, points, expected_velocity),
    )
    if density == 0.0 or d0 == 0.0:
        return matrix
    masses = masses_alone(matrix, d0)
    if not step.turning.any():
        return replace(matrix, masses=masses)
    turned = density * discretisation.velocity_response(masses, step.turning, _TURNING_TOLERANCE)
    return replace(matrix, advection=matrix.advection + turned, flow=matrix.flow + turned, masses=masses)


def _frame(moving: Moving, node_points: FloatArray, fluid: FluidState, velocity: FloatArray) -> FloatArray:
    """Velocity (d,) of the frame in which convection makes no energy: of the walls, or of all where nothing holds
    them."""
    if not moving.free:
        return container_velocity(moving.discretisation.surfaces, moving.step.time, node_points)
    return moving.mean_velocity(velocity, _expected_twist(fluid, moving.step))


def _expected_twist(fluid: FluidState, step: Step) -> FloatArray:
    """Twists (N, d+k) of the motions, extrapolated from those of the bodies."""
    e0, e1 = step.extrapolation
    return step.kinematics.motion_twist(e0 * fluid["twist"] + e1 * fluid["twist_previous"])


def coupled_system(equations: Equations, on_faces: FloatArray) -> CoupledSystem:
    """The linear system of a step, with the force ``on_faces`` (nodes, d) of given pressures and its guess."""
    discretisation, matrix = equations.discretisation, equations.matrix
    fluid, step = equations.fluid, equations.step
    node_points, prescribed, surfaces = matrix.node_points, matrix.prescribed, discretisation.surfaces
    e0, e1 = step.extrapolation
    expected = _expected_twist(fluid, step)
    twist, moved = prescribed_part(step)
    return CoupledSystem(
        matrix,
        load=discretisation.mass_times(matrix.points, _load_density(equations)) + on_faces,
        body_load=step.load,
        prescribed=surfaces.prescribed_velocity(step.time, node_points, step.pose.position, flat(twist), moved),
        velocity=extrapolated(fluid, step.extrapolation),
        pressure=e0 * fluid["pressure"] + e1 * fluid["pressure_previous"],
        twist=np.where(prescribed[:, None], step.prescribed_twist, expected),
        pressure_jump=surfaces.pressure_jump(step.time, matrix.points[: discretisation.numbering.vertices]),
        scale=step.load_scale,
    )


def _load_density(equations: Equations) -> FloatArray:
    """Load of the fluid's own equations at the nodes (nodes, d): forces on it, and inertia that is known
    [force/volume]."""
    matrix, fluid, (_, d1, d2) = equations.matrix, equations.fluid, equations.step.derivative
    history = d1 * fluid["velocity"] + d2 * fluid["velocity_previous"]
    density = -equations.discretisation.problem.inert_density * history - matrix.inertia * matrix.frame
    force = _force(equations)
    return np.asarray(density if force is None else density + force)


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
