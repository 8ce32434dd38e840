"""One step of a transported scalar on the moved mesh, after the fluid's.

With θ = T - c, c the mean of T, the step solves

d₀(θⁿ⁺¹, v)ₙ₊₁ + d₁(θⁿ, v)ₙ + d₂(θⁿ⁻¹, v)ₙ₋₁ - ((u - w)θⁿ⁺¹, ∇v) + κ(∇θⁿ⁺¹, ∇v) = (s, v) + ∮ q v,

each product on the mesh of its own time, whose test functions move with it. The test v = 1 gives the balance of the
content, and θ = 0 solves it, so that a constant stays one, whatever divergence the elements leave in u and w.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.scalar import ScalarProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.scalar_account import ScalarAccount
from rigidfluid.core.model.types import FluidState, Mesh, Step
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.scalar_surfaces import ScalarSurfaces

NAMES = ("scalar", "scalar_previous")
"""Arrays of the fluid's state at the nodes (nodes,)."""

REMESHING = "scalar_remeshing"
"""Array of the fluid's state with the content that corrections at new meshes have restored so far, in absolute
value ()."""

_TOLERANCE = 1e-13
"""Relative residual of the linear system."""

Solve = Callable[[sparse.csr_array, FloatArray, float], FloatArray]
"""x with ‖b - A x‖ ≤ tolerance, of a matrix A, a right side b and the tolerance; raises StepRejected."""


class ScalarAssembly(Protocol):
    """Integrals over the cells of one topology that the scalar needs."""

    numbering: Numbering

    def scalar_matrix(
        self, points: FloatArray, inertia: float, diffusivity: float, flow: FloatArray
    ) -> sparse.csr_array:
        """Matrix of inertia (T, v) - (c T, ∇v) + diffusivity (∇T, ∇v), with the ``flow`` c (nodes, d)."""

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        """(field, v) for every nodal test function, (nodes, d)."""


@dataclass(frozen=True, eq=False)
class ScalarEquations:
    """Equation of the scalar on one topology: its ``problem``, ``assembly`` and ``surfaces``, and what solves it."""

    problem: ScalarProblem
    assembly: ScalarAssembly
    surfaces: ScalarSurfaces
    solve: Solve

    def content_by_node(self, points: FloatArray, values: FloatArray) -> FloatArray:
        """(T, v) of ``values`` T (nodes,) for every test function on a geometry ``points``, (nodes,)."""
        field = np.zeros((len(values), self.assembly.numbering.dimension))
        field[:, 0] = values
        return self.assembly.mass_times(points, field)[:, 0]

    def mean(self, points: FloatArray, values: FloatArray) -> float:
        """Mean over the fluid."""
        volume = self.content_by_node(points, np.ones_like(values)).sum()
        return float(self.content_by_node(points, values).sum() / volume)


@dataclass(frozen=True, eq=False)
class _System:
    """A θ = b on all nodes, before any value is held: the ``matrix`` A with what ``open_faces`` carry, ``load`` b, and
    the history of each lumped body (lumped,)."""

    matrix: sparse.csr_array
    load: FloatArray
    history: FloatArray


def start(equations: ScalarEquations, mesh: Mesh) -> FluidState:
    """Arrays of the scalar in the fluid's state at the start."""
    values = equations.surfaces.start_values(equations.assembly.numbering.node_points(mesh.geometry))
    return {**dict.fromkeys(NAMES, values), REMESHING: np.zeros(())}


def carried(fluid: FluidState) -> FluidState:
    """The same scalar one step later, of a step that is not to be accepted."""
    return {name: fluid[name] for name in (*NAMES, REMESHING)}


def scalar_step(
    equations: ScalarEquations, fluid: FluidState, mesh: Mesh, step: Step, velocity: FloatArray
) -> tuple[FluidState, ScalarAccount]:
    """Arrays of the scalar after a step in which the fluid has got this ``velocity`` (nodes, d), and their account."""
    problem, surfaces, numbering = equations.problem, equations.surfaces, equations.assembly.numbering
    points = mesh.geometry if step.points is None else step.points
    node_points, (d0, d1, d2) = numbering.node_points(points), step.derivative
    before = fluid["points_previous"]
    flow = velocity - numbering.node_points(d0 * points + d1 * mesh.geometry + d2 * before)
    constant = equations.mean(mesh.geometry, fluid["scalar"])
    now, past = (fluid[name] - constant for name in NAMES)
    history = d1 * equations.content_by_node(mesh.geometry, now) + d2 * equations.content_by_node(before, past)
    source = np.zeros(len(node_points))
    if problem.source is not None:
        source = equations.content_by_node(points, problem.source(step.time, node_points))
    given, given_sums = surfaces.given_fluxes(step.time, node_points)
    matrix = equations.assembly.scalar_matrix(points, d0, problem.diffusivity, flow)
    outflow, inflow, carry = _through_faces(equations, step.time, node_points, flow, constant)
    first = [surfaces.nodes[body][0] for body in surfaces.lumped]
    of_bodies = -surfaces.capacities * (d1 * now[first] + d2 * past[first])
    system = _System(sparse.csr_array(matrix + outflow), source + given + inflow - history, of_bodies)
    held = surfaces.held_values(step.time, node_points)
    held = np.where(surfaces.owner >= 0, held - constant, 0.0)
    held[np.isin(surfaces.owner, surfaces.lumped)] = 0.0
    expected = step.extrapolation @ np.stack([now, past])
    theta = _solve(equations.solve, surfaces, system, d0, held, expected)
    reaction = system.matrix @ theta - system.load
    flux = given_sums + carry(theta)
    np.add.at(flux, surfaces.owner[surfaces.owner >= 0], reaction[surfaces.owner >= 0])
    for number, face in enumerate(surfaces.faces, surfaces.first_face):
        if face.condition.passes:  # what is held there is θ, and the fluid brings the constant with it
            flux[number] += constant * float(face.inflow(node_points, flow).sum())
    values = theta + constant
    content = equations.content_by_node(points, values).sum()
    earlier = d1 * equations.content_by_node(mesh.geometry, fluid["scalar"]).sum()
    earlier += d2 * equations.content_by_node(before, fluid["scalar_previous"]).sum()
    rate = float(d0 * content + earlier)
    account = ScalarAccount(
        content=float(content),
        rate=rate,
        source=float(source.sum()),
        residual=rate - float(flux.sum()) - float(source.sum()),
        least=float(values.min()),
        greatest=float(values.max()),
        remeshing=float(fluid[REMESHING]),
        flux=flux,
        value=surfaces.means(node_points, values),
    )
    return {"scalar": values, "scalar_previous": fluid["scalar"], REMESHING: fluid[REMESHING]}, account


def _through_faces(
    equations: ScalarEquations, time: float, node_points: FloatArray, flow: FloatArray, constant: float
) -> tuple[sparse.csr_array, FloatArray, Callable[[FloatArray], FloatArray]]:
    """Carried by the ``flow`` through faces that hold no value: matrix of what leaves, load (nodes,) of what comes in
    with a value that is given, and the flux of θ (surfaces,) into the fluid by both."""
    surfaces, count = equations.surfaces, len(node_points)
    outflow, inflow = sparse.csr_array((count, count)), np.zeros(count)
    parts: list[tuple[int, sparse.csr_array, float]] = []
    for number, face in surfaces.open_faces:
        nodes, value = face.facet_nodes, equations.problem.conditions[number].value
        shapes, through = face.inflow_at_points(node_points, flow)
        leaves = -through if value is None else np.maximum(-through, 0.0)
        each = np.einsum("fq,qi,qj->fij", leaves, shapes, shapes)
        rows, columns = np.broadcast_arrays(nodes[:, :, None], nodes[:, None, :])
        matrix = sparse.csr_array((each.ravel(), (rows.ravel(), columns.ravel())), shape=(count, count))
        brought = 0.0
        if value is not None:
            where = np.einsum("qi,fid->fqd", shapes, node_points[nodes])
            given = value(time, where.reshape(-1, where.shape[2])).reshape(through.shape) - constant
            load = (np.maximum(through, 0.0) * given) @ shapes
            np.add.at(inflow, nodes, load)
            brought = float(load.sum())
        outflow = outflow + matrix
        parts.append((number, matrix, brought))

    def carry(theta: FloatArray) -> FloatArray:
        found = np.zeros(len(surfaces.nodes))
        for number, matrix, brought in parts:
            found[number] = brought - float((matrix @ theta).sum())
        return found

    return outflow, inflow, carry


def _solve(
    solve: Solve, surfaces: ScalarSurfaces, system: _System, d0: float, held: FloatArray, expected: FloatArray
) -> FloatArray:
    """θ (nodes,) with the values that are ``held``, from an ``expected`` one onwards."""
    spread, first = surfaces.prolongation, surfaces.first_lumped
    own = np.zeros(surfaces.unknowns)
    own[first:] = d0 * surfaces.capacities
    matrix = sparse.csr_array(spread.T @ system.matrix @ spread + sparse.diags_array(own))
    right_side = spread.T @ (system.load - system.matrix @ held)
    right_side[first:] += system.history
    guess = expected[surfaces.representative]
    scale = max(float(np.linalg.norm(right_side)), float(np.linalg.norm(matrix @ guess)))
    residual = right_side - matrix @ guess
    return np.asarray(spread @ (guess + solve(matrix, residual, _TOLERANCE * scale)) + held)
