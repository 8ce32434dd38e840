"""Narrow-band detection on the processes of a run: CPU beside that of one process, collective calls and bytes.

mpirun -n 2 python benchmarks/shared_detection.py

Each process' CPU time is that outside of the calls, in which it may wait; one process has the whole mesh. Times are the
least of twenty, in one run.
"""

from __future__ import annotations

import pickle
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from grids import RANGE, balls_in_a_box
from mesh_sizes import mesh_sizes
from mpi4py import MPI

from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.distribution import distributed
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.model.ranks import MpiRanks
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.narrow_band import NarrowBandDetector

CASES = ((2, 25), (2, 100), (3, 27), (3, 125))
REPEATS = 20


@dataclass
class Calls:
    """``number`` of collective calls, ``sent`` bytes, and the CPU ``seconds`` in them."""

    number: int = 0
    sent: int = 0
    seconds: float = 0.0


@dataclass
class CountedRanks(MpiRanks):
    """Ranks that count what a detection asks of them."""

    communicator: Any
    calls: Calls = field(default_factory=Calls)

    def __post_init__(self) -> None:
        super().__init__(self.communicator)

    def allgather(self, item: Any) -> list[Any]:
        return self._counted(super().allgather, item)

    def alltoall(self, items: Any) -> list[Any]:
        return self._counted(super().alltoall, items)

    def _counted(self, call: Any, item: Any) -> list[Any]:
        start = time.process_time()
        self.communicator.Barrier()
        found: list[Any] = call(item)
        self.calls.number += 1
        self.calls.sent += len(pickle.dumps(item))
        self.calls.seconds += time.process_time() - start
        return found


def measured(detector: NarrowBandDetector, pose: Pose, mesh: Mesh, calls: Calls) -> tuple[Contacts, float]:
    """The contacts, and the least CPU seconds outside of calls."""
    contacts, least = detector.detect(pose, mesh, RANGE), np.inf
    for _ in range(REPEATS):
        calls.number, calls.sent, calls.seconds = 0, 0, 0.0
        start = time.process_time()
        contacts = detector.detect(pose, mesh, RANGE)
        least = min(least, time.process_time() - start - calls.seconds)
    return contacts, least


def main() -> None:
    """Print a line for each arrangement."""
    ranks = CountedRanks(MPI.COMM_WORLD)
    for dimension, bodies in CASES:
        balls, pose, box, walls = balls_in_a_box(dimension, bodies)
        sizes = mesh_sizes(dimension, bodies)
        whole = initial_mesh(FluidDomain(balls, pose, box, walls), sizes) if ranks.is_root else None
        part = distributed(whole, ranks)
        alone, shared = (NarrowBandDetector(NarrowBandDetector.Options(threads=1), balls, walls) for _ in range(2))
        contacts, seconds = measured(shared, pose, part, ranks.calls)
        everyones = ranks.communicator.gather((seconds, ranks.calls.sent))
        number = ranks.calls.number
        if whole is not None:
            expected, on_one = measured(alone, pose, whole, Calls())
            assert np.array_equal(contacts.gap, expected.gap)
            each = ", ".join(f"{spent / on_one:.2f}" for spent, _ in everyones)
            sent = max(sent for _, sent in everyones) / 1000
            print(
                f"{dimension}D, {bodies}: one process {1e3 * on_one:.1f} ms; of it each of {ranks.size} takes {each};"
            )
            print(f"    {number} calls, up to {sent:.0f} kB sent by a process", flush=True)
        ranks.communicator.Barrier()


if __name__ == "__main__":
    main()
