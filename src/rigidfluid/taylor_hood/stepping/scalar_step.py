"""One step of a transported scalar on the moved mesh, after the fluid's.

With θ = T - c, c the mean of T, the step solves

d₀(θⁿ⁺¹, v)ₙ₊₁ + d₁(θⁿ, v)ₙ + d₂(θⁿ⁻¹, v)ₙ₋₁ - ((u - w)θⁿ⁺¹, ∇v) + κ(∇θⁿ⁺¹, ∇v) = (s, v) + ∮ q v,

each product on the mesh of its own time, whose test functions move with it. The test v = 1 gives the balance of the
content, and θ = 0 solves it, so that a constant stays one, whatever divergence the elements leave in u and w. Inside
bodies that conduct c(d₀θⁿ⁺¹ + d₁θⁿ + d₂θⁿ⁻¹, v) + kκ(∇θⁿ⁺¹, ∇v) is added, v and θ on their surfaces being the fluid's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.scalar import ScalarProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.scalar_account import ScalarAccount
from rigidfluid.core.model.types import FluidState, Mesh, Pose, Step
from rigidfluid.taylor_hood.elements.face import Face
from rigidfluid.taylor_hood.elements.scalar_assembly import ScalarAssembly
from rigidfluid.taylor_hood.elements.scalar_surfaces import ScalarSurfaces
from rigidfluid.taylor_hood.stepping.insides import Insides

NAMES = ("scalar", "scalar_previous")
"""Arrays of the fluid's state at the nodes (nodes,)."""

INSIDE = ("scalar_inside", "scalar_inside_previous")
"""Arrays of the fluid's state at the nodes inside bodies that conduct, if there are any."""

REMESHING = "scalar_remeshing"
"""Array of the fluid's state with the content that corrections at new meshes have restored so far, in absolute
value ()."""

_TOLERANCE = 1e-13
"""Relative residual of the linear system."""

Solve = Callable[[sparse.csr_array, FloatArray, float], FloatArray]
"""x with ‖b - A x‖ ≤ tolerance, of a matrix A, a right side b and the tolerance; raises StepRejected."""


@dataclass(frozen=True, eq=False)
class ScalarEquations:
    """Equation of the scalar on one topology: its ``problem``, ``assembly``, ``surfaces``, the ``insides`` of bodies,
    and what solves it."""

    problem: ScalarProblem
    assembly: ScalarAssembly
    surfaces: ScalarSurfaces
    insides: Insides
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
    """Transport through a face that holds no value: ``outflow`` (nodes, nodes) of what leaves, by the value there, and
    ``inflow`` (nodes,) of what comes in with a value that is given."""

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


def start(equations: ScalarEquations, mesh: Mesh, pose: Pose) -> FluidState:
    """Arrays of the scalar in the fluid's state at the start, with the bodies, or their images, at ``pose``."""
    surfaces, node_points = equations.surfaces, equations.assembly.numbering.node_points(mesh.geometry)
    values, remeshing = surfaces.start_values(node_points), {REMESHING: np.zeros(())}
    if not equations.insides:
        return dict.fromkeys(NAMES, values) | remeshing
    inside = equations.insides.start_values(pose)
    values = values + surfaces.prolongation(node_points, pose)[:, surfaces.first_inside :] @ inside
    return dict.fromkeys(NAMES, values) | dict.fromkeys(INSIDE, inside) | remeshing


def carried(fluid: FluidState) -> FluidState:
    """The same scalar one step later, of a step that is not to be accepted."""
    return {name: fluid[name] for name in (*NAMES, *INSIDE, REMESHING) if name in fluid}


def scalar_step(
    equations: ScalarEquations, fluid: FluidState, mesh: Mesh, step: Step, velocity: FloatArray
) -> tuple[FluidState, ScalarAccount]:
    """Arrays of the scalar after a step in which the fluid has got this ``velocity`` (nodes, d), and their account."""
    moment = _Moment(equations, fluid, mesh, step)
    system = _system(moment, velocity)
    theta, inside = _solution(moment, system)
    account = _account(moment, system, theta, inside)
    after = {**carried(fluid), "scalar": theta + system.constant, "scalar_previous": fluid["scalar"]}
    if equations.insides:
        after |= dict(zip(INSIDE, (inside + system.constant, fluid[INSIDE[0]]), strict=True))
    return after, account


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

    def inside(self, constant: float) -> list[FloatArray]:
        """θ = T - ``constant`` at the nodes inside bodies, now and one step earlier."""
        return [self.fluid[name] - constant for name in INSIDE] if self.equations.insides else [np.zeros(0)] * 2

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


def _solution(moment: _Moment, system: _System) -> tuple[FloatArray, FloatArray]:
    """θ (nodes,) and θ at the nodes inside bodies, from their extrapolation in time onwards."""
    surfaces, insides, step = moment.equations.surfaces, moment.equations.insides, moment.step
    d0, d1, d2 = step.derivative
    now, past = (moment.fluid[name] - system.constant for name in NAMES)
    inside_now, inside_past = moment.inside(system.constant)
    held = surfaces.held_values(step.time, moment.node_points)
    held = np.where(surfaces.is_held, held - system.constant, 0.0)
    first, last = surfaces.first_lumped, surfaces.first_inside
    spread = surfaces.prolongation(moment.node_points, step.pose)
    body = surfaces.representative[first:]
    own = np.concatenate([np.zeros(first), d0 * surfaces.capacities])
    conducting = d0 * insides.capacity + insides.conductance
    of_bodies = sparse.block_diag([sparse.diags_array(own), conducting]) if insides else sparse.diags_array(own)
    matrix = sparse.csr_array(spread.T @ system.matrix @ spread + of_bodies)
    right_side = spread.T @ (system.load - system.matrix @ held)
    right_side[first:last] -= surfaces.capacities * (d1 * now[body] + d2 * past[body])
    right_side[last:] -= insides.capacity @ (d1 * inside_now + d2 * inside_past)
    guess = np.concatenate([
        (step.extrapolation @ np.stack([now, past]))[surfaces.representative],
        step.extrapolation @ np.stack([inside_now, inside_past]),
    ])  # fmt: skip
    scale = max(float(np.linalg.norm(right_side)), float(np.linalg.norm(matrix @ guess)))
    correction = moment.equations.solve(matrix, right_side - matrix @ guess, _TOLERANCE * scale)
    found = guess + correction
    return np.asarray(spread @ found + held), found[last:]


def _account(moment: _Moment, system: _System, theta: FloatArray, inside: FloatArray) -> ScalarAccount:
    """Balance at the end of a step whose solution is ``theta`` (nodes,), and ``inside`` at nodes in bodies."""
    equations, values = moment.equations, theta + system.constant
    flux, source = _fluxes(moment, system, theta), float(system.sources.sum())
    content = float(equations.content_by_node(moment.points, values).sum())
    rate = float(moment.step.derivative[0] * content + moment.history(0.0).sum())
    every = np.concatenate([values, inside + system.constant])
    value = equations.surfaces.means(moment.node_points, values)
    return ScalarAccount(
        content=content,
        rate=rate,
        source=source,
        imbalance=rate - float(flux.sum()) - source,
        least=float(every.min()),
        greatest=float(every.max()),
        remeshing=float(moment.fluid[REMESHING]),
        flux=flux,
        value=value,
        inside=equations.insides.means(value, inside + system.constant),
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
