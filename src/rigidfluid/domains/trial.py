"""Trials of files in a process of their own: on damaged ones Netgen, Open CASCADE, HDF5 and meshio end the process, or
never end.

    python -m rigidfluid.domains.trial KIND FILE DIMENSION BYTES

reads a file as ``cad`` or as a ``mesh``, with at most so much memory; exit code 3 if that is too little, and 4 if the
file is refused: why is then the only output.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from functools import lru_cache
from pathlib import Path
from typing import Literal, cast

from rigidfluid.core.model.memory import available_memory
from rigidfluid.errors import SceneError
from rigidfluid.python_process import ONE_THREAD, environment, python

Kind = Literal["cad", "mesh"]

SECONDS = 120.0
"""Time in which a file has to be read [s]."""

_MEMORY, _PER_BYTE = 1 << 31, 500
"""Memory that a trial may take [byte], and for each byte of the file, unless less is available."""

_TOO_LITTLE, _REFUSED = 3, 4

_ALLOWED = "a whole file of that kind"

Refusal = tuple[str, str, str, str]
"""Parts of a SceneError: subject, found, allowed, remedy."""


def require_survival(kind: Kind, path: Path, dimension: int) -> None:
    """Raise SceneError unless a process of its own has read this file; what fails there is never tried here."""
    stat = path.stat()
    refusal = _outcome(kind, path, dimension, stat.st_size, stat.st_mtime_ns)
    if refusal:
        raise SceneError(*refusal)


@lru_cache(maxsize=64)
def _outcome(kind: Kind, path: Path, dimension: int, size: int, _changed: int) -> Refusal | None:
    """Refusal of a file by its trial, None where it was read."""
    most = int(max(_MEMORY, min(_MEMORY + _PER_BYTE * size, available_memory())))
    command = python("-W", "ignore", "-m", "rigidfluid.domains.trial", kind, str(path), str(dimension), str(most))
    try:
        ended = subprocess.run(
            command,
            timeout=SECONDS,
            check=False,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment() | ONE_THREAD,  # each thread would take some of the memory that is allowed
        )
    except subprocess.TimeoutExpired:
        return _bad_end(path, f"took more than {SECONDS:g} seconds")
    code = ended.returncode
    if code == 0:
        return None
    if code == _REFUSED:
        return cast("Refusal", tuple(json.loads(ended.stdout)))
    if code == _TOO_LITTLE:
        return _bad_end(path, f"took more than {most / 2**30:.1f} GiB")
    how = signal.strsignal(-code) if code < 0 else f"exit code {code}"
    return _bad_end(path, f"ended the process that tried it ({how})")


def _bad_end(path: Path, how: str) -> Refusal:
    return "domain.file", f"{path}, whose reading {how}", _ALLOWED, "Write it again, or from another program."


def main(kind: Kind, path: str, dimension: str, most: str) -> int:
    """Read a file; 3 where memory is not enough, 4 where the file is refused."""
    answer = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # readers print too
    _limit_memory(int(most))
    try:
        _read(kind, Path(path), int(dimension))
    except MemoryError:
        return _TOO_LITTLE
    except SceneError as error:
        refusal = error.subject, str(error.found), str(error.allowed), error.remedy
        os.write(answer, json.dumps(refusal).encode())
        return _REFUSED
    return 0


def _read(kind: Kind, path: Path, dimension: int) -> None:
    """Read a file; raises SceneError, or MemoryError."""
    from rigidfluid.domains.cad import probe_cad
    from rigidfluid.domains.mesh_file import read_untried

    try:
        (probe_cad if kind == "cad" else read_untried)(path, dimension)
    except (SceneError, MemoryError):
        raise
    except (Exception, SystemExit) as error:  # anything, from a damaged file; its words may quote the file
        raise SceneError(*_bad_end(path, f"failed ({type(error).__name__})")) from error


def _limit_memory(most: int) -> None:
    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))  # type: ignore[arg-type]
