"""Distance fields and pair distances beside other libraries: scikit-fmm, potpourri3d, SciPy's cKDTree, coal.

pip install scikit-fmm potpourri3d coal
python benchmarks/distances.py
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import coal
import numpy as np
import potpourri3d
import skfmm
from nearest_facet import nearest_facet_distances
from scipy.spatial import cKDTree

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.marching.field import distance_field
from rigidfluid.marching.topology import Topology
from rigidfluid.marching.workspace import new_workspace
from rigidfluid.post.studies.kernels.shells import INNER, shell
from rigidfluid.post.studies.kernels.timing import fastest

RADIUS, OUTER, SIZE = 0.1, 2.0, 0.01
PAIRS = 50
CLOUD = 200


def ring_fields(mesh: Mesh) -> dict[str, tuple[int, Callable[[], object], FloatArray, FloatArray]]:
    """Name → values, the call to time, the points, the distances found there, all for the ring of Table 1."""
    topology, work = Topology.from_mesh(mesh), new_workspace(len(mesh.points))
    surface = np.unique(mesh.facets[mesh.markers == INNER])
    tree = cKDTree(mesh.points[surface])
    flat = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    heat = potpourri3d.MeshHeatMethodDistanceSolver(flat, mesh.cells)
    side = np.arange(-OUTER, OUTER + SIZE / 2, SIZE)
    grid = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    level = (np.linalg.norm(grid, axis=1) - RADIUS).reshape(len(side), -1)
    marches = {
        f"rigidfluid, {accuracy}": partial(
            distance_field, topology, mesh.points, [INNER], accuracy=accuracy, workspace=work
        )
        for accuracy in ("exact", "first-order")
    }
    calls = {
        "cKDTree to the surface's vertices": lambda: tree.query(mesh.points)[0],
        "potpourri3d, heat method": lambda: heat.compute_distance_multisource(surface),
    }
    made = {name: (call, mesh.points, call().everywhere(len(mesh.points))) for name, call in marches.items()}
    made |= {name: (call, mesh.points, call()) for name, call in calls.items()}
    for order in (1, 2):
        call = partial(skfmm.distance, level, dx=SIZE, order=order)
        made[f"scikit-fmm, order {order}, grid"] = (call, grid, np.asarray(call()).ravel())
    return made


def field_table() -> None:
    """Seconds, throughput and error of each way to the distance field."""
    mesh = shell(2, RADIUS, OUTER, SIZE)
    facets = mesh.points[mesh.facets[mesh.markers == INNER]]
    print("| distance field | values | seconds | values/s | largest error to the facets | to the circle |")
    print("|---|---|---|---|---|---|")
    for name, (call, points, found) in ring_fields(mesh).items():
        radius = np.linalg.norm(points, axis=1)
        inside = (radius >= RADIUS) & (radius <= OUTER)
        seconds = fastest(call, 3)
        polygon = np.abs(found - nearest_facet_distances(points, facets))[inside].max()
        circle = np.abs(found - (radius - RADIUS))[inside].max()
        print(
            f"| {name} | {len(points)} | {seconds:.3g} | {len(points) / seconds:.2g} | {polygon:.1e} | {circle:.1e} |"
        )


def pair_table() -> None:
    """Seconds and error for the gap of two ellipsoids."""
    rng = np.random.default_rng(0)
    axes, turns = rng.uniform(0.2, 1.0, (PAIRS, 2, 3)), rng.normal(size=(PAIRS, 2, 4))
    turns /= np.linalg.norm(turns, axis=2, keepdims=True)
    places = np.stack([np.zeros((PAIRS, 3)), rng.normal(size=(PAIRS, 3))], axis=1)
    places[:, 1] *= 2.2 / np.linalg.norm(places[:, 1], axis=1, keepdims=True)
    queries = [partial(_coal_gap, *pair) for pair in zip(axes, places, turns, strict=True)]
    exact = [partial(_exact_gap, *pair) for pair in zip(axes, places, turns, strict=True)]
    naive = [partial(_naive_gap, *pair) for pair in zip(axes, places, turns, strict=True)]
    true = np.array([query() for query in naive])
    error, ours = (np.abs([call() for call in calls] - true).max() for calls in (queries, exact))
    print("\n| gap of two ellipsoids | seconds for a pair | largest error |\n|---|---|---|")
    rows = [("coal", queries, error), ("rigidfluid, `ellipsoid`, a call for each", exact, ours)]
    for name, calls, worst in (*rows, ("rigidfluid, `brute_force`", naive, 0.0)):
        seconds = fastest(lambda calls=calls: [call() for call in calls], 1) / PAIRS
        print(f"| {name} | {seconds:.2g} | {f'{worst:.1e}' if worst else 'the reference'} |")
    seconds = _seconds_of_a_cloud()
    print(f"| rigidfluid, `ellipsoid`, {CLOUD} bodies in a call | {seconds:.2g} | |")


def _seconds_of_a_cloud() -> float:
    """Of one pair, when all pairs of many ellipsoids are asked for at once."""
    rng, pairs = np.random.default_rng(1), CLOUD * (CLOUD - 1) // 2
    bodies = [Ellipsoid(EllipsoidOptions(semi_axes=axes.tolist()), 3) for axes in rng.uniform(0.2, 1.0, (CLOUD, 3))]
    turns = rng.normal(size=(CLOUD, 4))
    pose = Pose(rng.uniform(0, 20, (CLOUD, 3)), turns / np.linalg.norm(turns, axis=1, keepdims=True))
    return fastest(lambda: EllipsoidDetector(PartOptions(), bodies, []).detect(pose, None, np.inf), 5) / pairs


def _coal_gap(axes: FloatArray, places: FloatArray, turns: FloatArray) -> float:
    shapes = [coal.Ellipsoid(*map(float, semi_axes)) for semi_axes in axes]
    poses = [coal.Transform3s(*pair) for pair in zip(rotation_matrices(turns), places, strict=True)]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    coal.distance(shapes[0], poses[0], shapes[1], poses[1], request, result)
    return float(result.min_distance)


def _exact_gap(axes: FloatArray, places: FloatArray, turns: FloatArray) -> float:
    bodies = [Ellipsoid(EllipsoidOptions(semi_axes=semi_axes.tolist()), 3) for semi_axes in axes]
    return float(EllipsoidDetector(PartOptions(), bodies, []).detect(Pose(places, turns), None, np.inf).gap[0])


def _naive_gap(axes: FloatArray, places: FloatArray, turns: FloatArray) -> float:
    bodies = [Ellipsoid(EllipsoidOptions(semi_axes=semi_axes.tolist()), 3) for semi_axes in axes]
    return float(BruteForceDetector(BruteForceOptions(), bodies, []).detect(Pose(places, turns), None, np.inf).gap[0])


if __name__ == "__main__":
    field_table()
    pair_table()
