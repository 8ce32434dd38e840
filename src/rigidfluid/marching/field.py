"""The distance from surfaces of a mesh to its vertices, in a band or everywhere."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.marching.exact import Front, march, reset, seed
from rigidfluid.marching.first_order import march_first_order
from rigidfluid.marching.topology import Numbers, Target, Topology
from rigidfluid.marching.workspace import Workspace, new_workspace

Accuracy = Literal["exact", "first-order"]


class Band(NamedTuple):
    """Vertices at a distance D ≤ ``width`` + ``slack`` L [length, 1], L the longest edge of the vertex."""

    width: float
    slack: float = 0.0


class Wave(NamedTuple):
    """Numbers of vertices that a march has ``touched``, in the band, and found ``beyond`` it, and its ``target``."""

    touched: int
    beyond: int
    target: Target


@dataclass(frozen=True, slots=True)
class DistanceField:
    """Distances of the vertices in a band; ``largest`` stands for all others [length].

    ``vertices`` (m,) in the order the march reached them, ``distance`` (m,) [length], ``facet`` (m,) the boundary facet
    that is nearest (to first order: that the wave comes from).
    """

    vertices: Numbers
    distance: FloatArray
    facet: Numbers

    @property
    def largest(self) -> float:
        """The largest distance in the band [length]."""
        return float(self.distance.max(initial=0.0))

    def everywhere(self, count: int) -> FloatArray:
        """Distance of all ``count`` vertices, (count,), outside the band its largest [length]."""
        values = np.full(count, self.largest)
        values[self.vertices] = self.distance
        return values


def distance_field(
    topology: Topology,
    points: FloatArray,
    surfaces: Iterable[int],
    band_width: float = np.inf,
    accuracy: Accuracy = "exact",
    workspace: Workspace | None = None,
) -> DistanceField:
    """Distance D(x) = min |x - y| over the facets y of some surfaces, at the vertices with D ≤ ``band_width`` [length].

    Only vertices that paths through the band reach are in the field, for vertices at ``points`` (N, d) [length]. It is
    exact to round-off, or to first order by the paper's planar waves. A ``workspace`` may come from an earlier march
    over as many vertices; without it each call makes one.

    Notes
    -----
    Sethian's fast marching (1996), DOI 10.1073/pnas.93.4.1591, in the narrow band of Van Landeghem et al.,
    arXiv:2402.19093; that the nearest facet travels along is ours.
    """
    work = workspace or new_workspace(topology.vertices)
    wave = WAVES[accuracy](topology, points, surfaces, Band(band_width), work)
    vertices = work.visited[: wave.touched].copy()
    distance = work.key[vertices]
    facet = work.facet[vertices]
    reset(work, wave.touched, wave.beyond)
    return DistanceField(vertices, np.sqrt(distance) if accuracy == "exact" else distance, facet)


def exact_wave(topology: Topology, points: FloatArray, surfaces: Iterable[int], band: Band, work: Workspace) -> Wave:
    """March from facet to facet and leave the field, of squares, in ``work``, to be reset by the caller."""
    size, target = seed(points, topology.surfaces, topology.seeds(surfaces), work)
    touched, beyond = march(topology.adjacency.neighbours, target, band, work, Front(0, size, 0))
    return Wave(touched, beyond, target)


def planar_wave(topology: Topology, points: FloatArray, surfaces: Iterable[int], band: Band, work: Workspace) -> Wave:
    """The same to first order, by the paper's planar waves, which leave distances."""
    size, target = seed(points, topology.surfaces, topology.seeds(surfaces), work)
    touched = march_first_order(points, topology.adjacency, band, work, size)
    return Wave(touched, 0, target)


WAVES = {"exact": exact_wave, "first-order": planar_wave}
"""March by its accuracy."""
