"""Options that a scene hands to PETSc choose a solver: they write no files, and import no modules."""

from __future__ import annotations

import pytest

from rigidfluid.backends.dolfinx.options import DolfinxOptions
from rigidfluid.core.scene.validation import read_table
from rigidfluid.errors import SceneError

SOLVERS = {
    "pc_factor_mat_solver_type": "umfpack",
    "mat_mumps_icntl_14": 40,
    "ksp_rtol": 1e-5,
    "ksp_monitor": True,
    "pc_fieldsplit_0_fields": "0,1",
    "pc_bddc_dirichlet_pc_type": "lu",
}


def test_solvers_are_chosen_and_tuned() -> None:
    assert read_table(DolfinxOptions, {"petsc": SOLVERS}, "fluid").petsc == SOLVERS


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("ksp_view", "ascii:victim"),
        ("ksp_view_mat", "binary"),
        ("ksp_monitor", "socket"),
        ("pc_type", "python"),
        ("pc_python_type", "antigravity.module"),
        ("mat_mumps_ooc_tmpdir", "victims"),
        ("options_file", "victim"),
        ("pc_type", "/tmp/library.so"),
        ("-ksp_type", "cg"),
        ("ksp_type cg -ksp_view", True),
    ],
)
def test_what_writes_or_imports_is_refused(key: str, value: object) -> None:
    with pytest.raises(SceneError, match=r"^fluid\.petsc: found .*; allowed is "):
        read_table(DolfinxOptions, {"petsc": {key: value}}, "fluid")
