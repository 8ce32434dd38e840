"""Contract tests tell third parties which values differ."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

TEST = """
import numpy as np
import pytest
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.testing import BodyContract


class Half(Sphere):
    @property
    def volume(self):
        return 0.5 * super().volume


class TestHalf(BodyContract):
    @pytest.fixture
    def body(self):
        return Half(Sphere.Options(radius=1.0), dimension=2)
"""


def test_a_failed_contract_shows_the_values(tmp_path: Path) -> None:
    (tmp_path / "test_half.py").write_text(TEST)
    command = [sys.executable, "-m", "pytest", "-q", "-k", "volume", "-p", "no:cacheprovider", "test_half.py"]
    failed = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert failed.returncode == 1
    assert "Obtained: 3.14" in failed.stdout, failed.stdout
