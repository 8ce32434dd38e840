"""How much memory this process has taken at most."""

from __future__ import annotations

import re
import sys
from pathlib import Path

_STATUS = Path("/proc/self/status")
_HIGHEST = re.compile(r"^VmHWM:\s*(\d+) kB$", re.MULTILINE)


def peak_memory() -> int | None:
    """Highest resident memory of this process until now.

    Returns
    -------
    int or None
        Memory [byte]; None where the system does not tell.
    """
    if sys.platform == "win32":
        return None
    return _of_this_program() or _of_this_process()


def _of_this_program() -> int | None:
    """From Linux' own figures: those of `getrusage` count what the parent held when it started this process."""
    try:
        found = _HIGHEST.search(_STATUS.read_text(encoding="ascii"))
    except OSError:
        return None
    return int(found[1]) * 1024 if found else None


def _of_this_process() -> int:
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
