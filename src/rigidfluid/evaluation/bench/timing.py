"""Durations of calls."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter, thread_time
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


def least_processor_time(call: Callable[[], object], repeats: int) -> float:
    """The least time of several calls that a processor works on this thread, whatever else the machine does [s]."""
    call()
    return min(_processor_time(call) for _ in range(repeats))


def _processor_time(call: Callable[[], object]) -> float:
    start = thread_time()
    call()
    return thread_time() - start
