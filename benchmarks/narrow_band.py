"""Distance from the inner of two concentric circles or spheres, in bands of growing width.

As in Table 1 of Van Landeghem et al., arXiv:2402.19093, whose figures stand beside.

    python benchmarks/narrow_band.py [--refinement 1] [--json FILE]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from time import thread_time

import numpy as np
from nearest_facet import nearest_facet_distances
from row_command import at_least, row_parser, show_rows

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.marching.field import DistanceField, distance_field
from rigidfluid.marching.partition import field_in_threads, split
from rigidfluid.marching.topology import Topology
from rigidfluid.marching.workspace import new_workspace
from rigidfluid.post.studies.kernels.shells import INNER, shell
from rigidfluid.post.studies.kernels.timing import fastest, timed

INNER_RADIUS, OUTER_RADIUS = 0.1, 2.0
SIZES = {2: 0.01, 3: 0.0591}
"""Distances of vertices that give as many cells as the paper's meshes of size 0.01 and 0.05."""

PAPER = {
    2: {
        0.0625: (2262, 0.261),
        0.125: (4104, 0.276),
        0.25: (9430, 0.316),
        0.5: (27082, 0.411),
        1.0: (89898, 0.722),
        1.9: (294918, 1.959),
    },
    3: {
        0.125: (4537, 1.759),
        0.25: (10238, 1.815),
        0.5: (43784, 2.368),
        1.0: (254365, 5.869),
        1.9: (1385385, 22.851),
    },
}
"""Dimension → threshold → elements of the band and seconds, Table 1 of Van Landeghem et al., arXiv:2402.19093."""


@dataclass(frozen=True, slots=True)
class BandRow:
    """One band: ``threshold`` [length], and the best of several times.

    ``seconds`` is what `distance_field` takes. It marches one field with one thread, so ``seconds_one_thread`` is the
    same; ``seconds_two_threads`` is for the two halves of the mesh side by side, as parts. ``processor_seconds`` leaves
    out when others had the processor. ``elements`` of the mesh;
    ``band_elements`` with a vertex in the band; ``max_error`` to the facets over the threshold. ``mesh_seconds``,
    ``adjacency_seconds`` and ``partition_seconds`` are paid once for each mesh; ``paper_…`` are the paper's figures,
    on its mesh and machine.
    """

    dimension: int
    threshold: float
    elements: int
    band_elements: int
    seconds: float
    seconds_one_thread: float
    processor_seconds: float
    seconds_two_threads: float
    max_error: float
    mesh_seconds: float
    adjacency_seconds: float
    partition_seconds: float
    paper_band_elements: int
    paper_seconds: float


def band_rows(refinement: float = 1.0, repeats: int = 20) -> Iterator[BandRow]:
    """Measure each band of the paper's table, 2D first, the widest band last; the fastest of ``repeats`` counts.

    ``refinement`` [1] is vertices per length, relative to the paper's meshes.
    """
    for dimension, table in PAPER.items():
        size = SIZES[dimension] / refinement
        mesh, mesh_seconds = timed(partial(shell, dimension, INNER_RADIUS, OUTER_RADIUS, size))
        Topology.from_mesh(shell(dimension, INNER_RADIUS, 2 * INNER_RADIUS, INNER_RADIUS / 2))  # compiles
        topology, adjacency_seconds = timed(partial(Topology.from_mesh, mesh))
        parts, partition_seconds = timed(partial(split, mesh, _halves(mesh)))
        work = new_workspace(len(mesh.points))
        true = nearest_facet_distances(mesh.points, mesh.points[mesh.facets[mesh.markers == INNER]])
        for threshold, (paper_elements, paper_seconds) in table.items():
            one = partial(distance_field, topology, mesh.points, [INNER], threshold, workspace=work)
            two = partial(field_in_threads, parts, mesh.points, [INNER], threshold)
            field, alone, together = one(), fastest(one, repeats), fastest(two, repeats)
            yield BandRow(
                dimension=dimension,
                threshold=threshold,
                elements=len(mesh.cells),
                band_elements=_band_elements(mesh, field),
                seconds=alone,
                seconds_one_thread=alone,
                processor_seconds=least_processor_time(one, repeats),
                seconds_two_threads=together,
                max_error=float(np.abs(field.distance - true[field.vertices]).max() / threshold),
                mesh_seconds=mesh_seconds,
                adjacency_seconds=adjacency_seconds,
                partition_seconds=partition_seconds,
                paper_band_elements=paper_elements,
                paper_seconds=paper_seconds,
            )


def _halves(mesh: Mesh) -> IntArray:
    halves: IntArray = (mesh.points[mesh.cells, 0].mean(axis=1) > 0).astype(np.int64)
    return halves


def _band_elements(mesh: Mesh, field: DistanceField) -> int:
    reached = np.zeros(len(mesh.points), dtype=bool)
    reached[field.vertices] = True
    return int(np.count_nonzero(reached[mesh.cells].any(axis=1)))


def least_processor_time(call: Callable[[], object], repeats: int) -> float:
    """The least time of several calls that a processor works on this thread, whatever else the machine does [s]."""
    call()
    return min(_processor_time(call) for _ in range(repeats))


def _processor_time(call: Callable[[], object]) -> float:
    start = thread_time()
    call()
    return thread_time() - start


def main() -> None:
    """Read the arguments, measure and print."""
    parser = row_parser(__doc__)
    parser.add_argument(
        "--refinement", type=at_least(0.3, float), default=1.0, help="vertices per length, relative to the paper's"
    )
    arguments = parser.parse_args()
    show_rows(band_rows(arguments.refinement), arguments.json)


if __name__ == "__main__":
    main()
