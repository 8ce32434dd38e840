"""Trials of files in a process of their own: on damaged ones Netgen, Open CASCADE, HDF5 and meshio end the process, or
never end.

    python -m rigidfluid.domains.trial KIND FILE DIMENSION BYTES

reads a file as ``cad`` or as a ``mesh``, with at most so much memory; exit code 3 if that is too little.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from functools import lru_cache
from pathlib import Path
from typing import Literal

from rigidfluid.errors import SceneError
from rigidfluid.python_process import ONE_THREAD, environment, python

Kind = Literal["cad", "mesh"]

SECONDS = 120.0
"""Time in which a file has to be read [s]."""

_MEMORY, _PER_BYTE = 1 << 31, 500
"""Memory that a trial may take [byte], and for each byte of the file."""

_TOO_LITTLE = 3


def require_survival(kind: Kind, path: Path, dimension: int) -> None:
    """Raise SceneError where a process that reads this file does not come to an end of its own; a file that it refuses
    by an exception will be refused here in the same way."""
    stat = path.stat()
    reason = _outcome(kind, path, dimension, stat.st_size, stat.st_mtime_ns)
    if reason:
        remedy = "Write it again, or from another program."
        raise SceneError("domain.file", f"{path}, whose reading {reason}", "a whole file of that kind", remedy)


@lru_cache(maxsize=64)
def _outcome(kind: Kind, path: Path, dimension: int, size: int, _changed: int) -> str:
    """End of a trial in words, empty where it was a good one."""
    most = _MEMORY + _PER_BYTE * size
    command = python("-m", "rigidfluid.domains.trial", kind, str(path), str(dimension), str(most))
    try:
        ended = subprocess.run(
            command,
            timeout=SECONDS,
            check=False,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=environment() | ONE_THREAD,  # each thread would take some of the memory that is allowed
        )
    except subprocess.TimeoutExpired:
        return f"took more than {SECONDS:g} seconds"
    if ended.returncode < 0:
        return f"ended the process that tried it ({signal.strsignal(-ended.returncode)})"
    return f"took more than {most / 2**30:.1f} GiB" if ended.returncode == _TOO_LITTLE else ""


def main(kind: Kind, path: str, dimension: str, most: str) -> int:
    """Read a file; 3 where memory is not enough."""
    from rigidfluid.domains.cad import probe_cad
    from rigidfluid.domains.mesh_file import read_untried

    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        limit = int(most) if hard == resource.RLIM_INFINITY else min(int(most), hard)
        resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    try:
        (probe_cad if kind == "cad" else read_untried)(Path(path), int(dimension))
    except MemoryError:
        return _TOO_LITTLE
    except SceneError:  # told by the process that is to use the file
        return 0
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))  # type: ignore[arg-type]
