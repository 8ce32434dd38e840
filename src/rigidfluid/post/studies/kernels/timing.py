"""Durations of calls."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import TypeVar

Result = TypeVar("Result")


def timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """Result of a call, and its duration [s]."""
    start = perf_counter()
    result = call()
    return result, perf_counter() - start


def fastest(call: Callable[[], object], repeats: int) -> float:
    """The shortest of several calls, after one that compiles and warms the caches [s]."""
    call()
    return min(timed(call)[1] for _ in range(repeats))
