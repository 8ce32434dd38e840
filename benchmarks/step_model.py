"""A model of a 3D step on many processes, T(N, p) = c N/p + r α log₂ p + m α + v (N/p)^⅔ / β, and its table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

PROCESSES = (2, 16, 64, 256, 1000)
UNKNOWNS = (340_000, 3_000_000, 30_000_000)


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


def model_lines(found: Constants, latency: float, bandwidth: float) -> Iterator[str]:
    """Table of seconds a step, and of the speed-up over one process."""
    yield "| unknowns | " + " | ".join(f"{count:,}" for count in PROCESSES) + " processes |"
    yield "|---" * (len(PROCESSES) + 1) + "|"
    for size in UNKNOWNS:
        alone = found.step(size, 1, latency, bandwidth)
        times = [found.step(size, count, latency, bandwidth) for count in PROCESSES]
        cells = [f"{_two_digits(seconds)}, {alone / seconds:.0f}" for seconds in times]
        yield f"| {size:,} | " + " | ".join(cells) + " |"


def _two_digits(seconds: float) -> str:
    return f"{seconds:.0f}" if seconds >= 100.0 else f"{seconds:.2g}"
