"""CPU time."""

from __future__ import annotations

import resource


def cpu_seconds() -> float:
    """CPU time of this process and of those that it has waited for [s]."""
    used = (resource.getrusage(whose) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)
