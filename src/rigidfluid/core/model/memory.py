"""The memory that is left, and errors where it is too little: a system that is out of memory ends programs unasked."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rigidfluid.errors import StepError

_SYSTEM, _PROCESS = Path("/proc/meminfo"), Path("/proc/self/status")
_GROUP, _GROUPS = Path("/proc/self/cgroup"), Path("/sys/fs/cgroup")
_GIBIBYTE = 2.0**30

REMEDY = (
    'Set fluid.solver = "schur" in 3D, raise mesh.size and mesh.size_body, or share the run with backend "dolfinx".'
)
"""Remedy against factors that are too large."""


def available_memory() -> float:
    """Memory that this process may still take [byte], infinite where none tells: the least of what the system has, and
    what its control group (version 2) and its limit of addresses leave."""
    return min(_system_memory(), _group_memory(), _address_space())


def require_memory(needed: float, what: str) -> None:
    """Raise StepError where more than the available memory is ``needed`` [byte] for ``what``, as "factors of … "."""
    available = available_memory()
    if needed > available:
        raise StepError("memory", f"{what} that need {gigabytes(needed)}", f"up to {gigabytes(available)}", REMEDY)


@contextmanager
def told_memory() -> Iterator[None]:
    """Turn a MemoryError within into a StepError that names what is available."""
    try:
        yield
    except MemoryError as error:
        found = f"too little of it ({error})" if str(error) else "too little of it"
        raise StepError("memory", found, f"up to {gigabytes(available_memory())}", REMEDY) from error


def gigabytes(size: float) -> str:
    """``size`` [byte] in words."""
    return f"{size / _GIBIBYTE:.3g} GiB"


def _system_memory() -> float:
    found = re.search(r"^MemAvailable:\s*(\d+) kB$", _read(_SYSTEM), re.MULTILINE)
    return 1024.0 * int(found[1]) if found else float("inf")


def _group_memory() -> float:
    """Memory that the control group's limit leaves [byte], files in the cache not counted, since they give way."""
    path = re.search(r"^0::/(.*)$", _read(_GROUP), re.MULTILINE)
    folder = _GROUPS / path[1] if path else _GROUPS
    most, used = _read(folder / "memory.max").strip(), _read(folder / "memory.current").strip()
    if not (most.isdigit() and used.isdigit()):
        return float("inf")
    files = re.search(r"^inactive_file (\d+)$", _read(folder / "memory.stat"), re.MULTILINE)
    return float(int(most) - int(used) + (int(files[1]) if files else 0))


def _address_space() -> float:
    """Address space that `ulimit -v` leaves [byte]."""
    if sys.platform == "win32":
        return float("inf")
    import resource

    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    used = re.search(r"^VmSize:\s*(\d+) kB$", _read(_PROCESS), re.MULTILINE)
    return float("inf") if most == resource.RLIM_INFINITY or not used else float(most - 1024 * int(used[1]))


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii")
    except OSError:
        return ""
