"""Every built-in size field satisfies the contract."""

import pytest

from rigidfluid.core.mesh.size.wake import Wake
from rigidfluid.size_fields.vorticity import Vorticity, VorticityOptions
from rigidfluid.testing import SizeFieldContract


class TestVorticity(SizeFieldContract):
    @pytest.fixture(params=[2, 3])
    def field(self, request):
        return Vorticity(VorticityOptions(size=0.02, threshold=0.05), request.param)


class TestWake(SizeFieldContract):
    @pytest.fixture(params=[2, 3])
    def field(self, request):
        return Wake(0.5, 0.02, 0.2, request.param)
