"""How many processes a launcher has started, and which of them this is: known from it before MPI is there."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

_VARIABLES = (
    ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),  # Open MPI's mpirun
    ("PMI_RANK", "PMI_SIZE"),  # MPICH's and Intel's mpiexec (Hydra), and srun with PMI-2
    ("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"),  # srun with PMIx; a batch script itself has no number of tasks of a step
)


@dataclass(frozen=True, slots=True)
class Launch:
    """This process is number ``rank`` of ``size`` that were started together."""

    rank: int = 0
    size: int = 1

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> Launch:
        """From the variables that the launcher has set; one process where none is found."""
        for rank, size in _VARIABLES:
            if rank in environment and size in environment:
                return cls(int(environment[rank]), int(environment[size]))
        return cls()

    def end(self) -> None:
        """End all processes at once, where this one cannot go on; the others would wait for it for ever."""
        if self.size > 1:
            try:
                from mpi4py import MPI
            except ImportError:
                return  # then nobody waits
            MPI.COMM_WORLD.Abort(1)
