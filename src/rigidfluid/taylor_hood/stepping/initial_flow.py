"""Fluid that is in motion when a run starts: by a formula, or as a steady flow past bodies that keep their twists."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import NO_LINKS, FluidState, Mesh, Pose, Twist
from rigidfluid.errors import SceneError, StepRejected
from rigidfluid.taylor_hood.elements.container import container_velocity
from rigidfluid.taylor_hood.elements.state import resting_state
from rigidfluid.taylor_hood.stepping.advance import centre_pressure
from rigidfluid.taylor_hood.stepping.newton import solve_newton
from rigidfluid.taylor_hood.stepping.transfer import project
from rigidfluid.taylor_hood.system.boundary import pressure_load
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem
from rigidfluid.taylor_hood.system.discretisation import Discretisation

STEADY, MOST_ITERATIONS = 1e-8, 200
"""A flow is steady when an iteration changes it by so little, relative in L²; so many are tried."""


def formula_flow(target: Discretisation, tolerance: float, mesh: Mesh, pose: Pose, twist: Twist) -> FluidState:
    """The flow without divergence that is nearest to the formula of the problem at time 0, as bodies and boundary have
    it there."""
    velocity = target.problem.initial
    assert callable(velocity), "the flow starts otherwise"
    surfaces, state = target.surfaces, dict(resting_state(target.surfaces, mesh, pose, twist))
    node_points = target.numbering.node_points(mesh.geometry)
    with surfaces.ranks.raise_on_all():
        wanted = velocity(0.0, node_points)
    wanted += surfaces.prescribed_part(_prescribed_velocity(target, node_points, state) - wanted)
    state["velocity"] = state["velocity_previous"] = project(target, tolerance, wanted, mesh.geometry, pose.position)
    return state


def steady_flow(target: Discretisation, tolerance: float, mesh: Mesh, pose: Pose, twist: Twist) -> FluidState:
    """The flow past bodies with these twists that does not change in time, by Picard's iteration from Stokes flow
    (and within it Newton's where the viscosity varies):

    ρ((uᵏ·∇)uᵏ⁺¹ + ½(∇·uᵏ)uᵏ⁺¹, v) + μ(∇u + ∇uᵀ, ∇v) + (γ∇·u, ∇·v) - (p, ∇·v) = (f, v), (∇·uᵏ⁺¹, q) = 0, with the
    values at time 0.

    Raises
    ------
    SceneError
        If the iteration does not converge; with the Reynolds number.
    """
    state = dict(resting_state(target.surfaces, mesh, pose, twist))
    system = _picard(target, tolerance, _stokes(target, mesh, state))
    state["velocity"] = state["velocity_previous"] = system.velocity
    state["pressure"] = state["pressure_previous"] = centre_pressure(target, mesh.geometry, system.pressure)
    return state


def _stokes(target: Discretisation, mesh: Mesh, state: FluidState) -> CoupledSystem:
    """The flow's equations without convection, guessed to be at rest."""
    problem, node_points = target.problem, target.numbering.node_points(mesh.geometry)
    load, bodies = pressure_load(target.surfaces, node_points, 0.0), np.zeros_like(state["twist"])
    if problem.source is not None:
        load += target.mass_times(mesh.geometry, problem.source(0.0, node_points))
    still = np.zeros_like(node_points)
    matrix = CoupledMatrix(
        points=mesh.geometry,
        node_points=node_points,
        inertia=0.0,
        viscosity=problem.material.dynamic_viscosity,
        advection=still,
        flow=still,
        position=state["position"],
        mass_matrix=np.zeros((*bodies.shape, bodies.shape[1])),
        prescribed=np.ones(len(bodies), dtype=bool),
        frame=np.zeros(problem.dimension),
    )
    given = _prescribed_velocity(target, node_points, state)
    jump = target.surfaces.pressure_jump(0.0, mesh.points)
    return CoupledSystem(matrix, load, bodies, given, still, np.zeros(target.numbering.vertices), bodies, jump)


def _picard(target: Discretisation, tolerance: float, system: CoupledSystem) -> CoupledSystem:
    """The equations whose guess is their solution, and which convect with it."""
    density, matrix, change = target.problem.inert_density, system.matrix, np.inf
    frame = container_velocity(target.surfaces, 0.0, matrix.node_points)
    for _ in range(MOST_ITERATIONS):
        try:
            solution = solve_newton(target, system, NO_LINKS, 0.0, tolerance)[1].solution
        except StepRejected as error:
            raise _not_steady(target, matrix.node_points, system.velocity, str(error)) from None
        change = _relative_norm(target, matrix.points, solution.velocity - system.velocity, solution.velocity)
        flow = density * solution.velocity
        matrix = replace(matrix, advection=flow, flow=flow - density * frame, frame=frame)
        system = replace(system, matrix=matrix, velocity=solution.velocity, pressure=solution.pressure, again=True)
        if change < STEADY or density == 0.0:
            return system
    raise _not_steady(target, matrix.node_points, system.velocity, f"changes of {change:.1g} in the last iteration")


def _prescribed_velocity(target: Discretisation, node_points: FloatArray, state: FluidState) -> FloatArray:
    """Velocities (nodes, d) prescribed at time 0, with all bodies moving as they do then; zero elsewhere."""
    twist = state["twist"]
    every = np.ones(len(twist), dtype=bool)
    return target.surfaces.prescribed_velocity(0.0, node_points, state["position"], twist, every)


def _relative_norm(target: Discretisation, points: FloatArray, change: FloatArray, velocity: FloatArray) -> float:
    squares = [np.sum(field * target.mass_times(points, field)) for field in (change, velocity)]
    of_change, of_all = target.surfaces.ranks.sum(np.array(squares))
    return float(np.sqrt(of_change / of_all)) if of_all > 0.0 else 0.0


def _not_steady(target: Discretisation, node_points: FloatArray, velocity: FloatArray, found: str) -> SceneError:
    ranks, problem = target.surfaces.ranks, target.problem
    side = float(np.min(ranks.greatest(node_points.max(axis=0)) - ranks.min(node_points.min(axis=0))))
    speed = float(ranks.greatest(np.linalg.norm(velocity, axis=1).max()))
    reynolds = problem.density * speed * side / problem.material.dynamic_viscosity
    return SceneError(
        "fluid.initial",
        f"'steady' with {found}, at a Reynolds number of {reynolds:.3g} of the domain's shortest side",
        "a flow that is steady at its Reynolds number",
        "Start with initial = 'rest' and a ramp on the inflow, or with expressions.",
    )
