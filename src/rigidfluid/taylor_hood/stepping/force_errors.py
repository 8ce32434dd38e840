"""Errors of forces on bodies by cells: residuals of a flow, weighted by dual flows on a mesh of halved edges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.quadratic_cells import node_gradients
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.types import FluidState, Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.stepping.advance import Equations, coupled_system, step_matrix
from rigidfluid.taylor_hood.stepping.refined_flow import InPlace, combined, on_finer, prolonged
from rigidfluid.taylor_hood.system.boundary import pressure_load
from rigidfluid.taylor_hood.system.coupled import CoupledSystem, Solution
from rigidfluid.taylor_hood.system.dimensionless import Dimensionless
from rigidfluid.taylor_hood.system.discretisation import Discretisation, TellsResidual
from rigidfluid.taylor_hood.system.driving import driving_load, fluxes, held_faces, unit_drop

_TOLERANCE = 1e-3
"""Relative residual of dual flows, and _SETTLED their change, that are let pass: they are weights alone [1]."""

_SETTLED, _MOST = 0.03, 10
"""An iteration for a dual flow ends with changes so small, or after so many."""


def force_errors(fine: InPlace, fluid: FluidState, coarse: Numbering, mesh: Mesh) -> FloatArray:
    """Parts of the cells (M,) [force] in errors of the forces on all bodies: each vertex gives √Σ_j η_ij² of its
    `weighted_residuals` to the cells around it, by volume.

    Residuals of different vertices cancel in the true error, so that their sum is a bound.
    """
    return _on_cells(np.linalg.norm(weighted_residuals(fine, fluid, coarse, mesh), axis=0), mesh)


def weighted_residuals(fine: InPlace, fluid: FluidState, coarse: Numbering, mesh: Mesh) -> FloatArray:
    r"""Residuals η_ij (d+k, vertices) [force] of a ``fluid`` on the ``coarse`` cells of ``mesh``, whose sums are the
    errors of the force along each axis j on all bodies, and of the torque about it over the bounding radius.

    All motions of the ``fine`` step, which is that fluid's own, are prescribed. A force is tested by a dual flow z, r
    with z = e_j on bodies, and a torque by one that turns as fast at the bounding radius:

    -ρ(u - w)·∇z + ρ(∇u)ᵀz - ∇·σ(z, r) = 0, ∇·z = 0, with ∂z/∂t omitted, and no flux where one is held

    The error is the residual R of u, p for what is left of z and r when they are interpolated on the coarse cells, all
    at halved edges; jumps of r at seams, which no pressure of the coarse equations has, are left whole. With the linear
    test functions φ_i of the coarse vertices, whose sum is one, η_ij = R(u, p; φ_i (z - Iz), φ_i (r - Ir)).

    Notes
    -----
    R. Becker and R. Rannacher, Acta Numerica 10, 1 (2001); parts by vertices: T. Richter and T. Wick, J. Comput. Appl.
    Math. 279, 192 (2015).
    """
    there, system = fine.target.numbering, _system(fine, fluid, coarse, mesh)
    assert isinstance(fine.target, Dimensionless)
    assert isinstance(fine.target.inner, TellsResidual)
    missed, divergence = np.split(fine.target.inner.residual(system), [system.velocity.size])
    missed = missed.reshape(system.velocity.shape)
    found = []
    for velocity, pressure, jump in _dual_flows(fine, system):
        left = velocity - on_finer(velocity[: coarse.nodes], coarse, there)
        left_pressure = pressure - coarse.interpolate_to_nodes((pressure - jump)[: coarse.vertices])
        weighted = _shared(np.sum(missed * left, axis=1), there) + divergence * left_pressure
        found.append(_shared(weighted, coarse))
    return np.array(found)


def _system(fine: InPlace, fluid: FluidState, coarse: Numbering, mesh: Mesh) -> CoupledSystem:
    """The step's equations on the fine mesh, whose guess is the flow on the coarse one."""
    target, finer, step, _ = fine
    prolongation = prolonged(fluid, coarse, mesh, target.numbering, finer)
    matrix = step_matrix(target, prolongation, finer, step)
    on_faces = pressure_load(target.surfaces, matrix.node_points, step.time)
    system = coupled_system(Equations(target, matrix, prolongation, finer, step), on_faces)
    return replace(system, load=system.load + driving_load(target.surfaces, system))


def _dual_flows(fine: InPlace, system: CoupledSystem) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
    """Velocity (nodes, d), pressure (vertices,) and its jump at seams (vertices,) of each dual flow. None goes through
    faces whose flux is held: it has as much of the flow by a unit drop of pressure there as that takes."""
    target, matrix, step, surfaces = fine.target, system.matrix, fine.step, fine.target.surfaces
    still, every = _unmoved(system), np.ones(len(step.pose.position), dtype=bool)
    turning = target.problem.inert_density * _mean_gradient(target.numbering, matrix.node_points, system.velocity)
    _, faces = held_faces(surfaces)
    units = [unit_drop(surfaces, face, still) for face in faces]
    driven = [_dual_flow(target, unit.added_to(still), turning) for unit in units]

    def through(velocity: FloatArray) -> FloatArray:
        return fluxes(surfaces, faces, matrix.node_points, velocity)

    by_unit = np.array([through(flow.velocity) for flow in driven]).T
    for twist in _unit_twists(fine):
        prescribed = still.prescribed.copy()
        surfaces.move_with_bodies(prescribed, matrix.node_points, step.pose.position, twist, every)
        moved = _dual_flow(target, replace(still, prescribed=prescribed), turning)
        velocity, pressure, jump = moved.velocity, moved.pressure, still.pressure_jump
        if driven:
            for factor, flow, unit in zip(np.linalg.solve(by_unit, through(velocity)), driven, units, strict=True):
                velocity, pressure = velocity - factor * flow.velocity, pressure - factor * flow.pressure
                jump = jump - factor * unit.jump
        yield velocity, pressure, jump


def _unmoved(system: CoupledSystem) -> CoupledSystem:
    """Equations of a dual flow that nothing drives: those of a ``system`` with convection backwards."""
    matrix, still = system.matrix, np.zeros_like(system.velocity)
    backwards = replace(
        matrix, inertia=0.0, advection=-matrix.advection, flow=-matrix.advection, frame=np.zeros_like(matrix.frame)
    )
    return replace(
        system,
        matrix=backwards,
        load=still,
        body_load=np.zeros_like(system.body_load),
        prescribed=still,
        velocity=still,
        pressure=np.zeros_like(system.pressure),
        twist=np.zeros_like(system.twist),
        pressure_jump=np.zeros_like(system.pressure_jump),
        scale=0.0,
    )


def _dual_flow(target: Discretisation, dual: CoupledSystem, turning: FloatArray) -> Solution:
    """Solution of the equations ``dual`` with the load -ρ(∇u)ᵀz besides, ``turning`` ρ∇u (nodes, d, d): Picard's
    iteration, accelerated as in `self_convected`."""
    given, found, changes = dual.load, list[FloatArray](), list[FloatArray]()
    for _ in range(_MOST):
        load = given - target.mass_times(dual.matrix.points, np.einsum("nij,ni->nj", turning, dual.velocity))
        solution = target.solve(replace(dual, load=load), _TOLERANCE)
        found, changes = [*found, solution.velocity], [*changes, solution.velocity - dual.velocity]
        dual = replace(dual, velocity=combined(found, changes), pressure=solution.pressure, again=True)
        if np.linalg.norm(changes[-1]) <= _SETTLED * np.linalg.norm(solution.velocity) or not turning.any():
            break
    return solution


def _unit_twists(fine: InPlace) -> Iterator[FloatArray]:
    """Twists (n, d+k) with all bodies at unit speed along each axis, and turning about it with it at their surface."""
    surfaces, position = fine.target.surfaces, fine.step.pose.position
    points, d = fine.target.numbering.node_points(fine.mesh.geometry), position.shape[1]
    arms = [points[nodes] - centre for nodes, centre in zip(surfaces.body_nodes, position, strict=True)]
    radius = np.array([np.linalg.norm(arm, axis=1).max(initial=0.0) for arm in arms])
    for direction in np.eye(d + (1 if d == 2 else 3)):
        twist = np.tile(direction, (len(position), 1))
        twist[:, d:] /= np.where(radius > 0.0, radius, 1.0)[:, None]
        yield twist


def _mean_gradient(numbering: Numbering, points: FloatArray, velocity: FloatArray) -> FloatArray:
    """∂u_i/∂x_j at the nodes (nodes, d, d): means of the cells around."""
    nodes, d = numbering.cell_nodes, numbering.dimension
    slopes = node_gradients(points[nodes], velocity[nodes]).reshape(-1, d * d)
    sums = [np.bincount(nodes.ravel(), slope, minlength=numbering.nodes) for slope in slopes.T]
    cells = np.bincount(nodes.ravel(), minlength=numbering.nodes)
    return np.asarray((np.stack(sums, axis=1) / cells[:, None]).reshape(-1, d, d))


def _shared(values: FloatArray, numbering: Numbering) -> FloatArray:
    """Σ of ``values`` (nodes,) times the linear test function of each vertex (vertices,)."""
    first, found = numbering.vertices, values[: numbering.vertices].copy()
    for end in numbering.edges.T:
        found += np.bincount(end, 0.5 * values[first:], minlength=first)
    return np.asarray(found)


def _on_cells(values: FloatArray, mesh: Mesh) -> FloatArray:
    """Shares (M,) of ``values`` (vertices,) that go to the cells around each vertex, by volume."""
    volume = np.abs(cell_volumes(mesh.points, mesh.cells))
    around = sum(np.bincount(corner, volume, minlength=len(values)) for corner in mesh.cells.T)
    return np.asarray(volume * np.sum((values / around)[mesh.cells], axis=1))
