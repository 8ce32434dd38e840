"""Measurements in processes of their own, several sharing one where MPI starts them."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rigidfluid.errors import RigidfluidError
from rigidfluid.python_process import environment, failure, python


class LaunchError(RigidfluidError):
    """Processes that share a measurement cannot be started, or one of them fails."""


def measured_apart(program: Sequence[str], ranks: int = 1, threads: int = 1) -> Any:
    """Run a Python ``program`` in new processes, wait for its end, and read the JSON that it has written.

    ``program`` is what follows `python`; a file to write is added. More than one rank is started by `mpirun`; each has
    ``threads`` for linear algebra. Raises LaunchError without `mpirun` or if a process fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "measured.json"
        command = [*_launcher(ranks), *python(*program, str(file))]
        limits = {"OMP_NUM_THREADS": str(threads), "MKL_NUM_THREADS": str(threads)}
        ended = subprocess.run(
            command, env=environment() | limits, stdin=subprocess.DEVNULL, capture_output=True, check=False
        )
        if ended.returncode != 0:
            said = (ended.stdout + ended.stderr).decode(errors="replace")
            raise _failed(program, ranks, ended.returncode, said)
        return json.loads(file.read_text(encoding="utf-8"))


def _launcher(ranks: int) -> list[str]:
    if ranks == 1:
        return []
    found = shutil.which("mpirun") or shutil.which("mpiexec")
    if found is None:
        raise LaunchError(
            f"{ranks} ranks",
            "no mpirun or mpiexec on PATH",
            "the launcher of the MPI that mpi4py was built with",
            "Install it (`apt install openmpi-bin`, or conda-forge's openmpi or mpich), or measure one rank.",
        )
    return [found, "-n", str(ranks)]


def _failed(program: Sequence[str], ranks: int, code: int, said: str) -> LaunchError:
    found, remedy = _last_error(said) or failure(code, said), "Run the program by hand to see all that it says."
    if "--allow-run-as-root" in said:
        found = "an mpirun that does not run as root"
        remedy = "Run as a non-root user, or set OMPI_ALLOW_RUN_AS_ROOT=1 and OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1."
    return LaunchError(f"{' '.join(program)} on {ranks} ranks", found, "a run to the end", remedy)


def _last_error(said: str) -> str:
    return next((line.strip() for line in reversed(said.split("\n")) if "Error: " in line), "")
