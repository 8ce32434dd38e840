import pytest

from rigidfluid.core.interfaces import ForceLaw
from rigidfluid.forces.centre import CentreLaw, CentreOptions
from rigidfluid.testing import ForceLawContract


class TestCentreLaw(ForceLawContract):
    @pytest.fixture(params=[None, 2e-6], ids=["one epsilon", "wall epsilon"])
    def law(self, request: pytest.FixtureRequest) -> ForceLaw:
        return CentreLaw(CentreOptions(epsilon=5e-6, epsilon_wall=request.param), range=0.02)
