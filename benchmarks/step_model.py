"""A model of a 3D step on many processes, of its time and of the memory of each process, and its tables.

T(N, p) = c N/p + r α log₂ p + m α + v (N/p)^⅔ / β, M(N, p) = b + s N/p, of the root also max(M, b' + g N)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

PROCESSES = (2, 16, 64, 256, 1000)
UNKNOWNS = (1_000_000, 10_000_000, 100_000_000)


@dataclass(frozen=True)
class Constants:
    """Of a step: ``seconds`` a process and unknown, ``sums``, ``rounds`` of messages, ``bytes`` over (N/p)^⅔."""

    seconds: float
    sums: float
    rounds: float
    bytes: float

    def step(self, unknowns: float, processes: int, latency: float, bandwidth: float) -> float:
        """T(N, p) [s]."""
        local = unknowns / processes
        if processes == 1:
            return self.seconds * local
        waits = latency * (self.sums * math.log2(processes) + self.rounds)
        return self.seconds * local + waits + self.bytes * local ** (2 / 3) / bandwidth


@dataclass(frozen=True)
class Line:
    """A quantity at ``start`` without unknowns, that grows by ``slope`` with each."""

    start: float
    slope: float

    @classmethod
    def through(cls, rows: Sequence[dict[str, Any]], name: str) -> Line:
        """The line through the first and the last of measured ``rows``, each with ``unknowns`` and the named figure."""
        first, last = rows[0], rows[-1]
        slope = (last[name] - first[name]) / (last["unknowns"] - first["unknowns"])
        return cls(first[name] - slope * first["unknowns"], slope)

    def at(self, unknowns: float) -> float:
        """The figure with so many unknowns."""
        return self.start + self.slope * unknowns


def model_lines(found: Constants, latency: float, bandwidth: float) -> Iterator[str]:
    """Table of seconds a step, and of the speed-up over one process."""

    def cell(size: float, count: int) -> str:
        seconds = found.step(size, count, latency, bandwidth)
        return f"{_two_digits(seconds)}, {found.step(size, 1, latency, bandwidth) / seconds:.0f}"

    return _table(cell)


def memory_lines(share: Line, whole: Line) -> Iterator[str]:
    """Table of the memory of a process [GB], and of the root while it makes the mesh, from lines in bytes."""
    return _table(
        lambda size, count: f"{_two_digits(1e-9 * share.at(size / count))}, {_two_digits(1e-9 * whole.at(size))}"
    )


def _table(cell: Callable[[float, int], str]) -> Iterator[str]:
    yield "| unknowns | " + " | ".join(f"{count:,}" for count in PROCESSES) + " processes |"
    yield "|---" * (len(PROCESSES) + 1) + "|"
    for size in UNKNOWNS:
        yield f"| {size:,} | " + " | ".join(cell(size, count) for count in PROCESSES) + " |"


def _two_digits(value: float) -> str:
    return f"{value:.0f}" if value >= 100.0 else f"{value:.2g}"
