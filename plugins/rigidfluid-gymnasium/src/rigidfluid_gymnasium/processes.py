"""Environments in processes of their own, each with one thread."""

from __future__ import annotations

import multiprocessing
import os
from dataclasses import dataclass

from gymnasium.vector import AsyncVectorEnv

from rigidfluid_gymnasium.env import FluidEnv
from rigidfluid_gymnasium.task import Task

_VARIABLES = ("MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


@dataclass(frozen=True)
class SingleThreaded:
    """Maker of environments for a ``task`` that computes with one thread, where it is called in a process that another
    one has started."""

    task: Task

    def __call__(self) -> FluidEnv:
        if multiprocessing.parent_process() is not None:
            _use_one_thread()
        return FluidEnv(self.task)


def parallel_envs(task: Task, count: int) -> AsyncVectorEnv:
    """Environments of a ``task`` side by side, ``count`` processes that are started afresh.

    A program that calls it has to be importable: what it does stands below ``if __name__ == "__main__":``.
    """
    return AsyncVectorEnv([SingleThreaded(task)] * count, context="spawn")


def _use_one_thread() -> None:
    """Limit libraries that are loaded, and, by the environment, those that are loaded later."""
    from threadpoolctl import threadpool_limits

    os.environ |= dict.fromkeys(_VARIABLES, "1")
    threadpool_limits(1)
