"""One step of a transported scalar on the moved mesh, after the fluid's.

With θ = T - c, c the mean of T, the step solves

d₀(θⁿ⁺¹, v)ₙ₊₁ + d₁(θⁿ, v)ₙ + d₂(θⁿ⁻¹, v)ₙ₋₁ - ((u - w)θⁿ⁺¹, ∇v) + κ(∇θⁿ⁺¹, ∇v) = (s, v) + ∮ q v,

each product on the mesh of its own time, whose test functions move with it. The test v = 1 gives the balance of the
content, and θ = 0 solves it, so that a constant stays one, whatever divergence the elements leave in u and w.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.scalar import ScalarProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.scalar_account import ScalarAccount
from rigidfluid.core.model.types import FluidState, Mesh, Step
from rigidfluid.taylor_hood.elements.face import Face
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
class _Passage:
    """Transport by fluid through faces that hold no value: ``outflow`` (nodes, nodes) of what leaves, by the value
    there, ``inflow`` (nodes,) of what comes in with a value that is given."""

    outflow: sparse.csr_array
    inflow: FloatArray


@dataclass(frozen=True, eq=False)
class _System:
    """A θ = b on all nodes before any value is held, with ``matrix`` A and ``load`` b: ``sources`` (nodes,) are in it.

    ``passages`` are those through faces, by number, whose outflow is in A; ``given`` (surfaces,): fluxes that are told;
    ``constant``: c in θ = T - c; ``flow`` (nodes, d) past the mesh.
    """

    matrix: sparse.csr_array
    load: FloatArray
    sources: FloatArray
    passages: dict[int, _Passage]
    given: FloatArray
    constant: float
    flow: FloatArray


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
    moment = _Moment(equations, fluid, mesh, step)
    system = _system(moment, velocity)
    theta = _solution(moment, system)
    account = _account(moment, system, theta)
    return {**carried(fluid), "scalar": theta + system.constant, "scalar_previous": fluid["scalar"]}, account


@dataclass(frozen=True, eq=False)
class _Moment:
    """A ``step`` from ``fluid`` on ``mesh``, and the integrals of its ``equations``."""

    equations: ScalarEquations
    fluid: FluidState
    mesh: Mesh
    step: Step

    @property
    def points(self) -> FloatArray:
        """Geometry of the mesh at the end of the step."""
        return self.mesh.geometry if self.step.points is None else self.step.points

    @cached_property
    def node_points(self) -> FloatArray:
        """Its nodes (nodes, d)."""
        return self.equations.assembly.numbering.node_points(self.points)

    @property
    def mesh_velocity(self) -> FloatArray:
        """w at the nodes (nodes, d)."""
        d0, d1, d2 = self.step.derivative
        rate = d0 * self.points + d1 * self.mesh.geometry + d2 * self.fluid["points_previous"]
        return self.equations.assembly.numbering.node_points(rate)

    def history(self, constant: float) -> FloatArray:
        """d₁(θⁿ, v) + d₂(θⁿ⁻¹, v) of θ = T - ``constant``, each on the mesh of its time (nodes,)."""
        _, d1, d2 = self.step.derivative
        meshes, by_node = (self.mesh.geometry, self.fluid["points_previous"]), self.equations.content_by_node
        now, past = (by_node(points, self.fluid[name] - constant) for points, name in zip(meshes, NAMES, strict=True))
        return np.asarray(d1 * now + d2 * past)


def _system(moment: _Moment, velocity: FloatArray) -> _System:
    """The equations of a step with the fluid's ``velocity`` (nodes, d) at its end."""
    equations, step, node_points = moment.equations, moment.step, moment.node_points
    problem, surfaces = equations.problem, equations.surfaces
    flow = velocity - moment.mesh_velocity
    constant = equations.mean(moment.mesh.geometry, moment.fluid["scalar"])
    sources = np.zeros(len(node_points))
    if problem.source is not None:
        sources = equations.content_by_node(moment.points, problem.source(step.time, node_points))
    load, given = surfaces.given_fluxes(step.time, node_points)
    load += sources - moment.history(constant)
    matrix = equations.assembly.scalar_matrix(moment.points, float(step.derivative[0]), problem.diffusivity, flow)
    passages = {number: _passage(moment, number, face, flow, constant) for number, face in surfaces.open_faces}
    for passage in passages.values():
        matrix, load = matrix + passage.outflow, load + passage.inflow
    return _System(sparse.csr_array(matrix), load, sources, passages, given, constant, flow)


def _passage(moment: _Moment, number: int, face: Face, flow: FloatArray, constant: float) -> _Passage:
    """Transport by the ``flow`` (nodes, d) through a face that holds no value."""
    node_points, nodes = moment.node_points, face.facet_nodes
    value, count = moment.equations.problem.conditions[number].value, len(node_points)
    shapes, through = face.inflow_at_points(node_points, flow)
    leaves, inflow = -through, np.zeros(count)
    if value is not None:
        leaves, where = np.maximum(leaves, 0.0), np.einsum("qi,fid->fqd", shapes, node_points[nodes])
        brought = value(moment.step.time, where.reshape(-1, where.shape[2])).reshape(through.shape) - constant
        np.add.at(inflow, nodes, (np.maximum(through, 0.0) * brought) @ shapes)
    each = np.einsum("fq,qi,qj->fij", leaves, shapes, shapes)
    rows, columns = np.broadcast_arrays(nodes[:, :, None], nodes[:, None, :])
    outflow = sparse.csr_array((each.ravel(), (rows.ravel(), columns.ravel())), shape=(count, count))
    return _Passage(outflow, inflow)


def _solution(moment: _Moment, system: _System) -> FloatArray:
    """θ (nodes,), from its extrapolation in time onwards."""
    surfaces, step = moment.equations.surfaces, moment.step
    d0, d1, d2 = step.derivative
    now, past = (moment.fluid[name] - system.constant for name in NAMES)
    held = surfaces.held_values(step.time, moment.node_points)
    held = np.where(surfaces.is_held, held - system.constant, 0.0)
    spread, first = surfaces.prolongation, surfaces.first_lumped
    body = surfaces.representative[first:]
    own = np.concatenate([np.zeros(first), d0 * surfaces.capacities])
    matrix = sparse.csr_array(spread.T @ system.matrix @ spread + sparse.diags_array(own))
    right_side = spread.T @ (system.load - system.matrix @ held)
    right_side[first:] -= surfaces.capacities * (d1 * now[body] + d2 * past[body])
    guess = (step.extrapolation @ np.stack([now, past]))[surfaces.representative]
    scale = max(float(np.linalg.norm(right_side)), float(np.linalg.norm(matrix @ guess)))
    correction = moment.equations.solve(matrix, right_side - matrix @ guess, _TOLERANCE * scale)
    return np.asarray(spread @ (guess + correction) + held)


def _account(moment: _Moment, system: _System, theta: FloatArray) -> ScalarAccount:
    """Balance at the end of a step whose solution is ``theta`` (nodes,)."""
    equations, values = moment.equations, theta + system.constant
    flux, source = _fluxes(moment, system, theta), float(system.sources.sum())
    content = float(equations.content_by_node(moment.points, values).sum())
    rate = float(moment.step.derivative[0] * content + moment.history(0.0).sum())
    return ScalarAccount(
        content=content,
        rate=rate,
        source=source,
        imbalance=rate - float(flux.sum()) - source,
        least=float(values.min()),
        greatest=float(values.max()),
        remeshing=float(moment.fluid[REMESHING]),
        flux=flux,
        value=equations.surfaces.means(moment.node_points, values),
    )


def _fluxes(moment: _Moment, system: _System, theta: FloatArray) -> FloatArray:
    """Flux of T into the fluid through each surface (surfaces,): given ones, residuals of rows whose value is fixed,
    and what the fluid carries; with it goes the constant that ``theta`` (nodes,) is without."""
    surfaces = moment.equations.surfaces
    flux, fixed = system.given.copy(), surfaces.owner >= 0
    np.add.at(flux, surfaces.owner[fixed], (system.matrix @ theta - system.load)[fixed])
    for number, passage in system.passages.items():
        flux[number] += passage.inflow.sum() - (passage.outflow @ theta).sum()
    for number, face in enumerate(surfaces.faces, surfaces.first_face):
        if face.condition.passes:
            flux[number] += system.constant * face.inflow(moment.node_points, system.flow).sum()
    return flux
