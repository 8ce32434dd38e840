"""States whose velocity comes from elsewhere, from another mesh or a blow; it is projected to zero divergence."""

from __future__ import annotations

import numpy as np

from rigidfluid.backends.scikit_fem.constraint import rigid_velocity
from rigidfluid.backends.scikit_fem.discretisation import Discretisation, kinetic_energy
from rigidfluid.backends.scikit_fem.factorization import factorise
from rigidfluid.backends.scikit_fem.location import locate, quadratic_basis
from rigidfluid.backends.scikit_fem.space import TaylorHood
from rigidfluid.backends.scikit_fem.state import at_rest
from rigidfluid.core.types import FloatArray, FluidState, Mesh, Pose, Twist


def transfer(
    source: TaylorHood, target: Discretisation, fluid: FluidState, old: Mesh, new: Mesh
) -> tuple[FluidState, float]:
    """The state on ``new`` and the kinetic energy lost on the way.

    Both time levels are carried as functions on the present mesh; the mesh's own displacement over the last step is
    one more such function, so that the mesh velocity of the next step stays second order. Interpolated velocities
    are not divergence-free on the new mesh, which would show as a blow of pressure at the next step: each level is
    projected, on the mesh where it belongs.
    """
    space = target.space
    cell, coordinates = locate(old.points, source.cell_vertices, space.node_points(new.points))
    quadratic, linear = quadratic_basis(coordinates), coordinates[: space.vertices]
    vertex_cells = source.cell_vertices[cell[: space.vertices]]

    def on_nodes(field: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("ni,nid->nd", quadratic, field[source.cell_nodes[cell]]))

    def on_vertices(field: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("ni,ni...->n...", linear, field[vertex_cells]))

    moved = dict(fluid)
    moved["points_previous"] = new.points - on_vertices(old.points - fluid["points_previous"])
    for suffix, points in (("", new.points), ("_previous", moved["points_previous"])):
        moved["pressure" + suffix] = on_vertices(fluid["pressure" + suffix])
        velocity = on_nodes(fluid["velocity" + suffix])
        _move_with_bodies(target, velocity, points, fluid["position" + suffix], fluid["twist" + suffix])
        moved["velocity" + suffix] = project(target, velocity, points)
    before = kinetic_energy(target.problem, source, old.points, fluid["velocity"])
    return moved, before - kinetic_energy(target.problem, space, new.points, moved["velocity"])


def initial(target: Discretisation, mesh: Mesh, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
    """Fluid that was at rest when its bodies were set in motion, and its kinetic energy.

    A blow on the bodies sends a wave of pressure through the fluid, which is projection: the flow is a potential flow.
    """
    state = dict(at_rest(target.space, mesh, pose, twist))
    if state["velocity"].any():
        state["velocity"] = state["velocity_previous"] = project(target, state["velocity"], mesh.points)
    return state, kinetic_energy(target.problem, target.space, mesh.points, state["velocity"])


def project(target: Discretisation, velocity: FloatArray, points: FloatArray) -> FloatArray:
    """The divergence-free velocity nearest to ``velocity`` in L², unchanged on bodies and prescribed faces."""
    space, constraint = target.space, target.constraint
    matrix = space.matrix(target.matrix_data(points, 1.0, 0.0, np.zeros_like(velocity)))
    excess = np.zeros(space.unknowns)
    excess[velocity.size :] = -(matrix @ np.concatenate([velocity.ravel(), np.zeros(space.vertices)]))[velocity.size :]
    coupled = (constraint.transposed @ matrix @ constraint.operator).tocsr()
    correction = constraint.operator @ factorise(coupled).solve(constraint.transposed @ excess)
    return velocity + correction[: velocity.size].reshape(velocity.shape)


def _move_with_bodies(
    target: Discretisation, velocity: FloatArray, points: FloatArray, position: FloatArray, twist: FloatArray
) -> None:
    node_points = target.space.node_points(points)
    for body, nodes in enumerate(target.constraint.body_nodes):
        velocity[nodes] = rigid_velocity(twist[body], node_points[nodes] - position[body])
