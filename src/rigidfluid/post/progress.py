"""Progress of several runs, one after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RunsProgress:
    """Runs ``done``, a fraction of the present one included, of ``total``; the words ``about`` the present one."""

    done: float
    total: int
    about: str


Observer = Callable[[RunsProgress], None]


def begin_run(progress: Observer | None, number: int, total: int, about: str) -> Callable[[float], None]:
    """Tell ``progress`` that a run begins; return a function that tells it which fraction of that run is done."""

    def show(part: float) -> None:
        if progress is not None:
            progress(RunsProgress(number + part, total, about))

    show(0.0)
    return show
