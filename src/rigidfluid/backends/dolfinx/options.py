"""Keys of ``[fluid]`` that the DOLFINx backend reads."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigidfluid.taylor_hood.backend import TaylorHoodOptions


class DolfinxOptions(TaylorHoodOptions):
    """Keys of ``[fluid]`` that this backend reads."""

    solver: Literal["auto", "lu", "schur"] = Field(
        "auto",
        description="`lu` factorises by MUMPS; `schur` needs far less memory in 3D; `auto`: `lu` in 2D, `schur` in 3D",
    )
    petsc: dict[str, str | float | int | bool] = Field(
        default_factory=dict,
        description='PETSc options of the solver, without a leading dash, as `pc_factor_mat_solver_type = "umfpack"`',
    )
