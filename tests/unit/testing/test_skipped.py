"""A contract skips what a backend does not offer, and asks it all else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

MODEST = """\
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.testing import FluidBackendContract


class Modest(ScikitFem):
    exchanges_bodies = held_fluxes = stresslets = boundary_forces = initial_flows = False
    oblique_faces = periodic_faces = False


class TestModest(FluidBackendContract):
    backend = Modest
"""


@pytest.mark.parametrize(("test", "outcome"), [("flat_mapping", "2 passed"), ("enter_a_flow", "2 skipped")])
def test_a_backend_that_offers_little_is_still_tested(test: str, outcome: str, tmp_path: Path) -> None:
    file = tmp_path / "test_modest.py"
    file.write_text(MODEST)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", test, str(file)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert f"{outcome}, " in done.stdout, done.stdout
