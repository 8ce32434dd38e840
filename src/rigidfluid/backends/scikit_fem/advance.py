"""One step of fluid and bodies together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from rigidfluid.backends.scikit_fem.boundary import face_power, pressure_load
from rigidfluid.backends.scikit_fem.discretisation import Discretisation, kinetic_energy, mass_times
from rigidfluid.backends.scikit_fem.stale_solver import StaleSolver
from rigidfluid.core.types import Advance, FloatArray, FluidState, Mesh, Step, Twist, Wrench


@dataclass(frozen=True)
class _Assembled:
    """K x = load for all unknowns, at nodes ``node_points``; ``pressure_load`` is the part of load from the faces."""

    matrix: sparse.csr_array
    load: FloatArray
    pressure_load: FloatArray
    node_points: FloatArray
    extrapolated: FloatArray


def advance(
    discretisation: Discretisation, solver: StaleSolver, tolerance: float, fluid: FluidState, mesh: Mesh, step: Step
) -> Advance:
    """Assemble, constrain, solve and measure one step from ``fluid`` on ``mesh`` to ``step.points``."""
    constraint, space = discretisation.constraint, discretisation.space
    points, position = _new_points(step), step.pose.position
    assembled = _assemble(discretisation, fluid, mesh, points, step)
    constraint.place(assembled.node_points, position)
    given = constraint.given(step.time, assembled.node_points, position, step.controlled_twist)
    reduced = _solve(discretisation, solver, tolerance, assembled, given, fluid, step)

    everything = constraint.operator @ reduced + given
    velocity = everything[: space.nodes * space.dimension].reshape(-1, space.dimension)
    pressure = _centred(discretisation, points, everything[space.nodes * space.dimension :])
    reaction = (assembled.matrix @ everything - assembled.load)[: velocity.size].reshape(velocity.shape)
    twist = _twist(discretisation, reduced, step)
    state = {
        "velocity": velocity,
        "velocity_previous": fluid["velocity"],
        "pressure": pressure,
        "pressure_previous": fluid["pressure"],
        "points_previous": mesh.points,
        "twist": twist,
        "twist_previous": fluid["twist"],
        "position": position,
        "position_previous": fluid["position"],
    }
    d = space.dimension
    on_bodies = np.array(
        [-constraint.resultant(b, reaction, assembled.node_points, position) for b in range(len(twist))]
    ).reshape(twist.shape)
    return Advance(
        fluid=state,
        twist=Twist(twist[:, :d], twist[:, d:]),
        hydrodynamic_wrench=Wrench(on_bodies[:, :d], on_bodies[:, d:]),
        kinetic_energy=kinetic_energy(discretisation.problem, space, points, velocity),
        dissipation=discretisation.dissipation(points, velocity),
        boundary_power=face_power(discretisation, assembled.node_points, velocity, assembled.pressure_load, reaction),
    )


def _new_points(step: Step) -> FloatArray:
    assert step.points is not None, "the scikit-fem backend declares needs_mesh"
    return step.points


def _assemble(
    discretisation: Discretisation, fluid: FluidState, mesh: Mesh, points: FloatArray, step: Step
) -> _Assembled:
    space, problem = discretisation.space, discretisation.problem
    density = problem.density if problem.inertia else 0.0
    d0, d1, d2 = step.derivative
    node_points = space.node_points(points)
    mesh_velocity = space.node_points(d0 * points + d1 * mesh.points + d2 * fluid["points_previous"])
    e0, e1 = step.extrapolation
    extrapolated = e0 * fluid["velocity"] + e1 * fluid["velocity_previous"]
    data = discretisation.matrix_data(
        points, density * d0, problem.dynamic_viscosity, density * (extrapolated - mesh_velocity)
    )
    density_of_load = -density * (d1 * fluid["velocity"] + d2 * fluid["velocity_previous"])
    if problem.source is not None:
        density_of_load += problem.source(step.time, node_points)
    load = np.zeros(space.unknowns)
    load[: node_points.size] = mass_times(space, points, density_of_load).ravel()
    on_faces = pressure_load(discretisation, node_points, step.time)
    load[: node_points.size] += on_faces.ravel()
    return _Assembled(space.matrix(data), load, on_faces, node_points, extrapolated)


def _solve(
    discretisation: Discretisation,
    solver: StaleSolver,
    tolerance: float,
    assembled: _Assembled,
    given: FloatArray,
    fluid: FluidState,
    step: Step,
) -> FloatArray:
    """Solve Pᵀ(K(P x + given) - load) + (M x - L on the twists) = 0 from the extrapolated state onwards."""
    constraint = discretisation.constraint
    twists = slice(constraint.twist_start, constraint.twist_start + step.load[~step.controlled].size)
    inertia = sparse.block_diag([*step.mass_matrix[~step.controlled], sparse.csr_array((0, 0))], format="csr")

    def apply(x: FloatArray) -> FloatArray:
        result: FloatArray = constraint.transposed @ (assembled.matrix @ (constraint.operator @ x))
        result[twists] += inertia @ x[twists]
        return result

    def matrix() -> sparse.csr_array:
        entries = inertia.tocoo()
        place = (entries.row + twists.start, entries.col + twists.start)
        embedded = sparse.coo_array((entries.data, place), shape=(constraint.unknowns,) * 2)
        return sparse.csr_array(constraint.transposed @ assembled.matrix @ constraint.operator + embedded)

    right_side = constraint.transposed @ (assembled.load - assembled.matrix @ given)
    right_side[twists] += step.load[~step.controlled].ravel()
    guess = _guess(discretisation, assembled, fluid, step, twists)
    scale = float(np.linalg.norm(right_side))
    correction, _ = solver.solve(apply, matrix, right_side - apply(guess), tolerance * scale)
    return guess + correction


def _guess(
    discretisation: Discretisation, assembled: _Assembled, fluid: FluidState, step: Step, twists: slice
) -> FloatArray:
    constraint = discretisation.constraint
    e0, e1 = step.extrapolation
    pressure = e0 * fluid["pressure"] + e1 * fluid["pressure_previous"]
    if constraint.pinned is not None:
        pressure -= pressure[constraint.pinned]
    everything = np.concatenate([assembled.extrapolated.ravel(), pressure])
    guess = np.empty(constraint.unknowns)
    guess[constraint.free_columns] = everything[constraint.free_unknowns]
    guess[twists] = (e0 * fluid["twist"] + e1 * fluid["twist_previous"])[~step.controlled].ravel()
    return guess


def _twist(discretisation: Discretisation, reduced: FloatArray, step: Step) -> FloatArray:
    twist = step.controlled_twist.copy()
    start = discretisation.constraint.twist_start
    free = ~step.controlled
    twist[free] = reduced[start : start + twist[free].size].reshape(-1, twist.shape[1])
    return twist


def _centred(discretisation: Discretisation, points: FloatArray, pressure: FloatArray) -> FloatArray:
    """In an enclosed flow the pressure's constant is free: take the one with zero mean."""
    if discretisation.constraint.pinned is None:
        return pressure
    cells = discretisation.space.cell_vertices
    volume = np.abs(np.linalg.det(points[cells[:, 1:]] - points[cells[:, :1]]))
    return pressure - float(volume @ pressure[cells].mean(axis=1) / volume.sum())
