"""The long-range laws that come with rigidfluid keep the contract of such laws."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.model.pose_law import PoseLaw
from rigidfluid.forces.dipole import DipoleLaw, DipoleOptions
from rigidfluid.testing.pose_law import PoseLawContract


class TestDipole(PoseLawContract):
    @pytest.fixture
    def law(self, dimension: int) -> PoseLaw:
        moments = np.array([[0.3, -1.2, 0.7], [2.0, 0.4, -0.5]])[:, :dimension].tolist()
        return DipoleLaw(DipoleOptions(strength=0.2, moments=moments), 1.7)
