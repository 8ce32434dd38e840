"""Keys of ``[fluid]`` that the DOLFINx backend reads."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from rigidfluid.taylor_hood.backend import TaylorHoodOptions

_Value = str | float | int | bool

_NAME, _FOREIGN, _SHOWS = re.compile(r"[a-z]\w*"), re.compile(r"python|file|tmpdir"), re.compile(r"view|monitor")
_WORDS = re.compile(r"[\w.,+-]*")
"""Texts that are no path, and name no file as ``ascii:FILE`` does."""


def _only_numerics(options: dict[str, _Value]) -> dict[str, _Value]:
    """Options that choose and tune a solver; others of PETSc write files or import modules, which no scene may do."""
    for key, value in options.items():
        if not _NAME.fullmatch(key) or _FOREIGN.search(key) or value == "python":
            raise ValueError("options of solvers, without Python, files and folders")
        if _SHOWS.search(key) and not isinstance(value, bool):
            raise ValueError(f"true or false as {key}, which then prints")
        if isinstance(value, str) and not _WORDS.fullmatch(value):
            raise ValueError("numbers, true, false and words without blanks, colons and slashes")
    return options


class DolfinxOptions(TaylorHoodOptions):
    """Keys of ``[fluid]`` that this backend reads."""

    solver: Literal["auto", "lu", "schur"] = Field(
        "auto",
        description="`lu` factorises by MUMPS; `schur` needs far less memory in 3D; `auto`: `lu` in 2D, `schur` in 3D",
    )
    petsc: Annotated[dict[str, _Value], AfterValidator(_only_numerics)] = Field(
        default_factory=dict,
        description="PETSc options of the solver, without a leading dash, such as "
        '`pc_factor_mat_solver_type = "umfpack"`; options that name files or Python are refused',
    )
