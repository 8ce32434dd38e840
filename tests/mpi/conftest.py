"""Processes of their own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from gathered_backend import install_gathered

SUPPORT = Path(__file__).parents[1] / "support"


@pytest.fixture
def mpirun(tmp_path):
    """Runs Python in so many processes, which must end by themselves."""
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

    def run(count, *arguments, **variables):
        command = ["mpirun", "-n", str(count), sys.executable, "-W", "error", *map(str, arguments)]
        return subprocess.run(
            command, env=os.environ | more | variables, capture_output=True, text=True, timeout=120, check=False
        )

    return run
