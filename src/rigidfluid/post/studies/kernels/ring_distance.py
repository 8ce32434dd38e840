"""The distance field between two concentric circles or spheres."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.marching.field import Accuracy, DistanceField, distance_field
from rigidfluid.marching.partition import field_in_threads, split
from rigidfluid.marching.topology import Topology
from rigidfluid.marching.workspace import new_workspace
from rigidfluid.post.studies.kernels.kernel import Kernel
from rigidfluid.post.studies.kernels.shells import INNER, shell
from rigidfluid.post.studies.kernels.timing import fastest
from rigidfluid.post.studies.subject import Outcome

RADIUS, OUTER_RADIUS = 0.3, 1.2
REPEATS = 5


class RingDistance(Kernel):
    """D(x) = |x| - 0.3 at the vertices of a mesh of {x : 0.3 < |x| < 1.2}, marched from the facets inside.

    Seconds are those of the march, the best of five; mesh, adjacency and partition are made before.
    """

    figure: ClassVar[str] = "distance to a circle or sphere"
    against: ClassVar[str] = "|x| - 0.3"

    size: float = Field(gt=0, le=RADIUS, description="Distance of vertices [length]")
    dimension: Literal[2, 3] = Field(default=2, description="2 for circles, 3 for spheres")
    accuracy: Accuracy = Field(default="exact", description="`exact` to the facets, or `first-order`")
    band_width: float | None = Field(
        default=None, gt=0, description="Distance up to which is marched; everywhere if not given [length]"
    )
    threads: int = Field(default=1, ge=1, description="Parts of the mesh that are marched side by side if exact [1]")
    norm: Literal["largest", "mean"] = Field(default="largest", description="Which error over the vertices is taken")

    def reads(self, knob: str) -> bool:
        """The first-order march has one thread."""
        return knob != "threads" or self.accuracy == "exact"

    def run(self, progress: Callable[[float], None]) -> Outcome:
        """March from the inner surface, and compare with the true circle or sphere."""
        mesh = shell(self.dimension, RADIUS, OUTER_RADIUS, self.size)
        march = self._march(mesh)
        seconds = fastest(march, REPEATS)
        field = march()
        vertices, rows = np.unique(field.vertices, return_index=True)
        true = np.linalg.norm(mesh.points[vertices], axis=1) - RADIUS
        errors = np.abs(field.distance[rows] - true)
        figure = errors.max() if self.norm == "largest" else errors.mean()
        return Outcome(float(figure), seconds, len(mesh.points), steps=1)

    def _march(self, mesh: Mesh) -> Callable[[], DistanceField]:
        width = np.inf if self.band_width is None else self.band_width
        if self.threads > 1 and self.accuracy == "exact":
            return partial(field_in_threads, split(mesh, _sectors(mesh, self.threads)), mesh.points, [INNER], width)
        work = new_workspace(len(mesh.points))
        return partial(distance_field, Topology.from_mesh(mesh), mesh.points, [INNER], width, self.accuracy, work)


def _sectors(mesh: Mesh, count: int) -> IntArray:
    """Number of the sector that each cell is in."""
    x, y = mesh.points[mesh.cells].mean(axis=1)[:, :2].T
    sectors: IntArray = np.floor((np.arctan2(y, x) / (2 * np.pi) + 0.5) * count).astype(np.int64)
    return np.minimum(sectors, count - 1)
