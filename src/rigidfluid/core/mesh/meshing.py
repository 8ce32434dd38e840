"""The first mesh: Netgen fills the box around the bodies with simplices whose facets know their surface."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np

from rigidfluid.core.mesh.topology import REMEDY, check_mesh, orient
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import FloatArray, IntArray, Mesh, Pose
from rigidfluid.errors import MeshError

ATTEMPTS = 8


def generate_mesh(
    bodies: Sequence[Body],
    pose: Pose,
    lower: FloatArray,
    upper: FloatArray,
    size: float,
    size_body: float,
    growth: float,
    finer: Sequence[tuple[FloatArray, float]] = (),
) -> Mesh:
    """Mesh of the box minus the bodies, {x : lower < x < upper} \\ ∪ B_i, vertices of a body's facets on its surface.

    Parameters
    ----------
    bodies : sequence of Body
        The shapes, in the scene's order.
    pose : Pose
        Where they are.
    lower, upper : (d,) array
        Corners of the box [length].
    size : float
        Longest edge wanted far from the bodies [length].
    size_body : float
        Longest edge allowed on a body [length].
    growth : float
        How fast the cell size grows with the distance to a body [1].
    finer : sequence of ((d,) array, float)
        Points where the edges must be shorter, and how long they may be [length].

    Returns
    -------
    Mesh
        Markers are surface numbers: bodies 0 … n-1, then left, right, bottom, top[, back, front].

    Raises
    ------
    MeshError
        When a body leaves the box, or Netgen makes no valid mesh.
    """
    refuse_bodies_outside(bodies, pose, lower, upper)
    asked = np.full(len(bodies), size_body)
    for _ in range(ATTEMPTS):
        mesh = netgen_mesh(bodies, pose, lower, upper, size, asked, growth, finer)
        refuse_touching_bodies(mesh, len(bodies))
        check_mesh(mesh, quality=0.0)
        excess = longest_edges(mesh, len(bodies)) / size_body
        if np.all(excess <= 1.0):
            return mesh
        asked = np.where(excess > 1.0, 0.95 * asked / excess, asked)
    worst = int(np.argmax(excess))
    found = f"a facet of length {excess[worst] * size_body:.4g}"
    raise MeshError(f"body.{worst}", found, f"at most size_body = {size_body:g}", REMEDY)


def longest_edges(mesh: Mesh, count: int) -> FloatArray:
    """Longest edge among each body's facets, (count,) [length]."""
    longest = np.zeros(count)
    for a, b in combinations(range(mesh.facets.shape[1]), 2):
        length = np.linalg.norm(mesh.points[mesh.facets[:, a]] - mesh.points[mesh.facets[:, b]], axis=1)
        on_body = mesh.markers < count
        np.maximum.at(longest, mesh.markers[on_body], length[on_body])
    return longest


def refuse_bodies_outside(bodies: Sequence[Body], pose: Pose, lower: FloatArray, upper: FloatArray) -> None:
    """Raise MeshError for the first body whose centre is not inside the box."""
    for i in range(len(bodies)):
        if not np.all((lower < pose.position[i]) & (pose.position[i] < upper)):
            box = f"inside the box from {lower.tolist()} to {upper.tolist()}"
            raise MeshError(f"body.{i}.position", pose.position[i].tolist(), box, "Move the body or enlarge the box.")


def refuse_touching_bodies(mesh: Mesh, count: int) -> None:
    """Raise MeshError for the first body without facets of its own, or with a vertex on another surface."""
    for i in range(count):
        mine = mesh.facets[mesh.markers == i]
        others = mesh.markers[np.isin(mesh.facets, mine).any(axis=1) & (mesh.markers != i)]
        if len(others) or not len(mine):
            found = f"contact with surface {others[0]}" if len(others) else "no surface of its own"
            raise MeshError(f"body.{i}.position", found, "a body apart from all others and from the walls", "Move it.")


def netgen_mesh(
    bodies: Sequence[Body],
    pose: Pose,
    lower: FloatArray,
    upper: FloatArray,
    size: float,
    size_body: FloatArray,
    growth: float,
    finer: Sequence[tuple[FloatArray, float]],
) -> Mesh:
    """One call of Netgen; ``size_body`` (n,) is the target edge length on each body [length]."""
    from netgen import meshing, occ

    verbosity = meshing.SetMessageImportance(0)
    try:
        geometry = occ.OCCGeometry(fluid_shape(bodies, pose, lower, upper, size_body), dim=len(lower))
        parameters = meshing.MeshingParameters(maxh=size, grading=growth, parallel_meshing=False)
        for point, length in finer:
            parameters.RestrictH(*in_space(point), h=float(length))
        netgen = geometry.GenerateMesh(parameters)
    except (occ.OCCException, meshing.NgException, RuntimeError) as error:
        found = f"Netgen failed ({str(error).strip()})"
        raise MeshError("mesh", found, "bodies that neither overlap nor leave the box", REMEDY) from error
    finally:
        meshing.SetMessageImportance(verbosity)
    mesh = orient(from_netgen(netgen, len(lower)))
    for face in range(2 * len(lower)):
        on_face = mesh.facets[mesh.markers == len(bodies) + face]
        mesh.points[on_face, face // 2] = (lower, upper)[face % 2][face // 2]
    return mesh


def fluid_shape(bodies: Sequence[Body], pose: Pose, lower: FloatArray, upper: FloatArray, size_body: FloatArray) -> Any:
    """The box minus the bodies as a ``netgen.occ`` shape whose faces (edges in 2D) are named by surface number."""
    from netgen import occ

    shape = box_shape(lower, upper, len(bodies))
    for i, body in enumerate(bodies):
        placed = turned(body.cad_shape(), pose.orientation[i]).Move(occ.Vec(*in_space(pose.position[i])))
        for side in sides(placed, len(lower)):
            side.name, side.maxh = str(i), float(size_body[i])
        shape = shape - placed
    return shape


def box_shape(lower: FloatArray, upper: FloatArray, first: int) -> Any:
    """The box, its faces named ``first``, ``first`` + 1, … in the order left, right, bottom, top[, back, front]."""
    from netgen import occ

    if len(lower) == 2:
        box = occ.WorkPlane().Rectangle(*(upper - lower)).Face().Move(occ.Vec(*in_space(lower)))
    else:
        box = occ.Box(occ.Pnt(*lower), occ.Pnt(*upper))
    for side in sides(box, len(lower)):
        centre = np.array([side.center.x, side.center.y, side.center.z])[: len(lower)]
        distance = np.abs(np.column_stack([centre - lower, upper - centre]) / (upper - lower)[:, None])
        side.name = str(first + int(np.argmin(distance)))
    return box


def sides(shape: Any, dimension: int) -> Any:
    """The parts of a shape's boundary: edges in 2D, faces in 3D."""
    return shape.edges if dimension == 2 else shape.faces


def turned(shape: Any, orientation: FloatArray) -> Any:
    """A shape rotated about the origin by an angle (2D) or a unit quaternion (3D)."""
    from netgen import occ

    if len(orientation) == 1:
        axis, angle = np.array([0.0, 0.0, 1.0]), orientation[0]
    else:
        axis, angle = orientation[1:], 2.0 * np.arctan2(np.linalg.norm(orientation[1:]), orientation[0])
    if angle == 0.0:
        return shape
    return shape.Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.Dir(*axis)), float(np.degrees(angle)))


def in_space(vector: FloatArray) -> list[float]:
    """Three components: those of ``vector``, then zeros."""
    return [*map(float, vector), *[0.0] * (3 - len(vector))]


def from_netgen(netgen: Any, dimension: int) -> Mesh:
    """Netgen's mesh as arrays; only vertices that a cell uses are kept."""
    cells, _ = elements(netgen.Elements2D() if dimension == 2 else netgen.Elements3D(), dimension + 1)
    facets, regions = elements(netgen.Elements1D() if dimension == 2 else netgen.Elements2D(), dimension)
    markers = np.array([int(netgen.GetBCName(region)) for region in range(regions.max() + 1)], dtype=np.int64)
    used, compact = np.unique(cells, return_inverse=True)
    number = np.full(used.max() + 1, -1)
    number[used] = np.arange(len(used))
    points = np.ascontiguousarray(netgen.Coordinates()[used, :dimension])
    return Mesh(points, compact.reshape(cells.shape).astype(np.int64), number[facets], markers[regions])


def elements(container: Any, corners: int) -> tuple[IntArray, IntArray]:
    """Vertex numbers (M, corners) and region numbers (M,) of Netgen's elements, both from 0."""
    table = container.NumPy()
    return table["nodes"][:, :corners].astype(np.int64) - 1, table["index"].astype(np.int64) - 1
