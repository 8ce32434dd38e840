"""The flow that a mesh and one of halved edges give in the same state: their difference tells the error by the mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import NamedTuple, TypeVar

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.halved_simplex import CHILDREN, EDGES
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.flow_error import ErrorRate, MeshVelocity, Refinement
from rigidfluid.core.model.types import Advance, FluidState, Mesh, Step, Twist, Wrench
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.stepping.advance import Equations, advance, step_matrix
from rigidfluid.taylor_hood.stepping.momentum import momentum
from rigidfluid.taylor_hood.system.discretisation import Discretisation

Vectors = TypeVar("Vectors", Twist, Wrench)

_SETTLED = 1e-3
"""A flow convects itself when an iteration changes it by this part of its change since the start [1]."""

_ROUNDING = 10.0
"""Changes below so many tolerances of the solver are none [1]."""

_MOST, _DEPTH = 30, 6
"""Greatest number of iterations, and how many of the latest are combined."""

_NODAL = ("velocity", "velocity_previous", "scalar", "scalar_previous")
_AT_VERTICES = ("pressure", "pressure_previous")


class InPlace(NamedTuple):
    """A ``step`` in place on a ``mesh``, with its equations ``target`` and the ``tolerance`` of its solutions."""

    target: Discretisation
    mesh: Mesh
    step: Step
    tolerance: float


def refinement(
    coarse: InPlace, fine: InPlace, fluid: FluidState, rate: ErrorRate | None, mesh_velocity: MeshVelocity
) -> Refinement:
    """Change by the ``fine`` of two steps from the ``fluid``'s flow on the ``coarse`` mesh; see
    `FluidBackend.refinement`."""
    numberings = here, there = coarse.target.numbering, fine.target.numbering
    own = self_convected(coarse, fluid, lambda _: np.zeros(()))

    def follow(twist: Twist) -> FloatArray:
        velocity = here.node_points(mesh_velocity(flat(_difference(twist, own.twist))))
        return there.geometry_of(on_finer(velocity, *numberings))

    prolongation = prolonged(fluid, here, coarse.mesh, there, fine.mesh)
    if rate is not None:
        prolongation = _with_past_error(fine, prolongation, rate.velocity / fine.step.derivative[2])
        fine = fine._replace(step=replace(fine.step, load=fine.step.load + rate.load))
    refined = self_convected(fine, prolongation, follow)
    return Refinement(
        _difference(refined.twist, own.twist),
        _difference(refined.hydrodynamic_wrench, own.hydrodynamic_wrench),
        refined.fluid["velocity"] - on_finer(own.fluid["velocity"], *numberings),
    )


def self_convected(place: InPlace, fluid: FluidState, follow: Callable[[Twist], FloatArray]) -> Advance:
    """Solve a step whose advecting velocity u* is its own solution, from the flow of ``fluid`` on, with mesh velocities
    (vertices + K, d) that ``follow`` the motions besides.

    Picard's iteration, accelerated by Anderson's (1965, doi:10.1145/321296.321305): of the latest iterates that
    combination is taken whose changes cancel best.

    Raises
    ------
    StepRejected
        If the iteration does not converge.
    """
    (target, mesh, step, tolerance), start = place, fluid["velocity"]
    attempt, found, changes, before = fluid, list[FloatArray](), list[FloatArray](), fluid["points_previous"]
    for _ in range(_MOST):
        advecting = {**fluid, "velocity": attempt["velocity"], "points_previous": before}
        matrix = step_matrix(target, advecting, mesh, step)
        advanced = advance(Equations(target, matrix, fluid, mesh, step), tolerance, attempt)
        velocity = advanced.fluid["velocity"]
        found, changes = [*found, velocity][-_DEPTH:], [*changes, velocity - attempt["velocity"]][-_DEPTH:]
        change, moved, whole = (_norm(target, mesh, each) for each in (changes[-1], velocity - start, velocity))
        if change <= _SETTLED * moved + _ROUNDING * tolerance * whole or target.problem.inert_density == 0.0:
            return advanced
        attempt = {**advanced.fluid, "velocity": combined(found, changes)}
        before = fluid["points_previous"] + follow(advanced.twist) / step.derivative[2]
    raise StepRejected(
        "output.error_bars",
        f"changes of the flow by {change / moved:.1g} after {_MOST} iterations",
        f"at most {_SETTLED:g}",
        "Make the mesh finer.",
    )


def prolonged(fluid: FluidState, coarse: Numbering, mesh: Mesh, fine: Numbering, finer: Mesh) -> FluidState:
    """The state of a ``fluid`` on ``mesh``, on a ``finer`` one whose vertices are the nodes of that."""
    state, points = dict(fluid), coarse.node_points(mesh.geometry)
    state |= {name: on_finer(fluid[name], coarse, fine) for name in _NODAL if name in fluid}
    state |= {name: coarse.interpolate_to_nodes(fluid[name]) for name in _AT_VERTICES}
    moved = on_finer(points - coarse.node_points(fluid["points_previous"]), coarse, fine)
    return state | {"points_previous": finer.geometry - fine.geometry_of(moved)}


def _with_past_error(place: InPlace, fluid: FluidState, error: FloatArray) -> FluidState:
    """The state of a ``fluid`` whose velocity one step earlier has one more ``error`` (nodes, d)."""
    state = {**fluid, "velocity_previous": fluid["velocity_previous"] + error}
    if place.target.problem.keeps_momentum:
        more = momentum(place.target, place.mesh.geometry, error)
        state["momentum_previous"] = fluid["momentum_previous"] + more
    return state


def on_finer(field: FloatArray, coarse: Numbering, fine: Numbering) -> FloatArray:
    """Values (nodes, …) at the nodes of the fine mesh of a quadratic ``field`` (nodes, …) on the coarse one."""
    d, edges = coarse.dimension, EDGES[coarse.dimension]
    corners = np.eye(d + 1)
    nodes = np.concatenate([corners, [corners[list(edge)].mean(axis=0) for edge in edges]])  # barycentric
    found = np.concatenate([field, np.zeros((fine.nodes - coarse.nodes, *field.shape[1:]))])
    for child in CHILDREN[d]:
        for a, b in edges:
            ends = [child[a], child[b]]
            x = nodes[ends].mean(axis=0)
            basis = np.array([*(x * (2.0 * x - 1.0)), *(4.0 * x[i] * x[j] for i, j in edges)])
            middles = fine.edge_nodes(coarse.cell_nodes[:, ends])
            found[middles] = np.einsum("b,mb...->m...", basis, field[coarse.cell_nodes])
    return found


def combined(found: list[FloatArray], changes: list[FloatArray]) -> FloatArray:
    """Combination (nodes, d) of the velocities ``found`` whose ``changes``, combined alike, are least."""
    differences = np.diff([change.ravel() for change in changes], axis=0)
    if not len(differences):
        return found[-1]
    weights = np.linalg.lstsq(differences.T, changes[-1].ravel(), rcond=1e-10)[0]
    return np.asarray(found[-1] - np.tensordot(weights, np.diff(found, axis=0), axes=1))


def _norm(target: Discretisation, mesh: Mesh, velocity: FloatArray) -> float:
    """Norm of a velocity (nodes, d) in L²."""
    return float(np.sqrt(np.sum(velocity * target.mass_times(mesh.geometry, velocity))))


def _difference(vectors: Vectors, others: Vectors) -> Vectors:
    """Twists or wrenches less others."""
    names = [each.name for each in fields(vectors)]
    return replace(vectors, **{name: getattr(vectors, name) - getattr(others, name) for name in names})
