"""Steps of many balls in a fluid on one process and on several.

As in Tables 2 and 3 of Van Landeghem et al., arXiv:2402.19093. Needs DOLFINx and `mpirun`.

    python benchmarks/parallel.py [--ranks 1 2] [--most-bodies 125] [--coarseness 1] [--json FILE]
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from collisions import PAPER
from mesh_sizes import PAPER_NODES
from processes import measured_apart
from row_command import at_least, row_parser, show_rows

from rigidfluid.registry import FLUID_BACKEND, Registry

BACKEND = "dolfinx"
"""The fluid backend that several processes can share."""

PAPER_SPEEDUP = {
    2: {
        1: (3.14, 8.22, 11.04),
        25: (1.88, 2.06, 2.12),
        49: (1.90, 2.08, 2.15),
        81: (1.92, 2.09, 2.13),
        100: (1.81, 2.01, 2.10),
    },
    3: {1: (2.23, 6.49, 7.99), 27: (1.94, 3.99, 5.03), 64: (1.98, 3.98, 5.22), 125: (1.99, 3.59, 5.13)},
}
"""Dimension → bodies → speed-up of the collision algorithm on 4, 16 and 24 processes; the same tables."""

PAPER_SHARE = {2: 0.20, 3: 0.05}
"""Dimension → most that the collision algorithm takes of a step; the text below the tables."""


@dataclass(frozen=True, slots=True)
class ParallelRow:
    """One arrangement on some number of ranks: means over ten steps.

    ``seconds_collision``: detection on the parts of the mesh, forces, wrenches and the bodies' way through their
    contacts. ``seconds_step``: all of a step, fluid and bodies. ``speedup_…``: of one rank's time over this; None
    where one rank was not measured. ``share``: collision in the step. ``paper_speedup_…``: of the collision algorithm
    on so many processes; ``paper_largest_share``: the most of all arrangements of that dimension.
    """

    dimension: int
    bodies: int
    ranks: int
    mesh_nodes: int
    unknowns: int
    body_body: int
    body_wall: int
    seconds_collision: float
    speedup_collision: float | None
    seconds_step: float
    speedup_step: float | None
    share: float
    paper_mesh_nodes: int
    paper_body_body: int
    paper_body_wall: int
    paper_speedup_4: float
    paper_speedup_16: float
    paper_speedup_24: float
    paper_largest_share: float


def parallel_rows(
    ranks: Sequence[int] = (1, 2), most_bodies: int = 125, coarseness: float = 1.0
) -> Iterator[ParallelRow]:
    """Measure each of the paper's arrangements of at most ``most_bodies`` on each number of ``ranks``, 2D first.

    ``coarseness`` [1] is edge length over that of meshes as fine as the paper's. Raises PluginError without DOLFINx,
    LaunchError without `mpirun` or if a run fails.
    """
    Registry.load().get(FLUID_BACKEND, BACKEND)
    for dimension, table in PAPER.items():
        for bodies in table:
            if bodies <= most_bodies:
                alone: Mapping[str, Any] | None = None
                for count in sorted(set(ranks)):
                    measured = _measured(dimension, bodies, count, coarseness)
                    alone = measured if count == 1 else alone
                    yield row(dimension, bodies, count, measured, alone)


def row(
    dimension: int, bodies: int, ranks: int, measured: Mapping[str, Any], alone: Mapping[str, Any] | None
) -> ParallelRow:
    """Build the row of an arrangement ``measured`` on some ranks; speed-ups are against ``alone``, on one rank."""
    pairs, at_wall = PAPER[dimension][bodies]
    on_4, on_16, on_24 = PAPER_SPEEDUP[dimension][bodies]
    collision, step = measured["seconds_collision"], measured["seconds_step"]
    return ParallelRow(
        dimension=dimension,
        bodies=bodies,
        ranks=ranks,
        **measured,
        speedup_collision=None if alone is None else alone["seconds_collision"] / collision,
        speedup_step=None if alone is None else alone["seconds_step"] / step,
        share=collision / step,
        paper_mesh_nodes=PAPER_NODES[dimension][bodies],
        paper_body_body=pairs,
        paper_body_wall=at_wall,
        paper_speedup_4=on_4,
        paper_speedup_16=on_16,
        paper_speedup_24=on_24,
        paper_largest_share=PAPER_SHARE[dimension],
    )


def _measured(dimension: int, bodies: int, ranks: int, coarseness: float) -> Mapping[str, Any]:
    child = Path(__file__).with_name("parallel_child.py")
    found: Mapping[str, Any] = measured_apart([str(child), str(dimension), str(bodies), str(coarseness)], ranks)
    return found


def main() -> None:
    """Read the arguments, measure and print."""
    parser = row_parser(__doc__)
    parser.add_argument("--ranks", type=at_least(1), nargs="+", default=[1, 2], help="on how many processes")
    parser.add_argument("--most-bodies", type=at_least(1), default=125, help="leave out arrangements of more")
    parser.add_argument(
        "--coarseness", type=at_least(1.0, float), default=1.0, help="edge lengths over those of the paper's meshes"
    )
    arguments = parser.parse_args()
    show_rows(parallel_rows(arguments.ranks, arguments.most_bodies, arguments.coarseness), arguments.json)


if __name__ == "__main__":
    main()
