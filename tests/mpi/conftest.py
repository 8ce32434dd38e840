"""Processes of their own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from gathered_backend import install_gathered

SUPPORT = Path(__file__).parents[1] / "support"


@pytest.fixture
def mpi(tmp_path):
    """Starts Python in so many processes, which must end by themselves."""
    plugin = tmp_path / "plugin"
    install_gathered(plugin)
    paths = [plugin, SUPPORT, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    more = {
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
        "OMP_NUM_THREADS": "1",
        "COLUMNS": "200",
    }

    def start(count, *arguments, **variables):
        command = ["mpirun", "-n", str(count), sys.executable, "-W", "error", *map(str, arguments)]
        return subprocess.Popen(
            command, env=os.environ | more | variables, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    return start


@pytest.fixture
def mpirun(mpi):
    """Runs Python in so many processes until they end."""

    def run(count, *arguments, **variables):
        process = mpi(count, *arguments, **variables)
        try:
            said, complaint = process.communicate(timeout=900)
        except subprocess.TimeoutExpired:
            process.terminate()  # killed, mpirun would leave its processes behind
            process.communicate()
            raise
        return subprocess.CompletedProcess(process.args, process.returncode, said, complaint)

    return run
