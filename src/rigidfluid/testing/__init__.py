"""Contract tests for plug-in authors: subclass one, provide its fixture or factory, and run pytest.

::

    from rigidfluid.testing import BodyContract

    class TestMyBody(BodyContract):
        @pytest.fixture
        def body(self):
            return MyBody(MyOptions(length=1.0), dimension=2)
"""

from rigidfluid.testing.arrangement import Arrangement
from rigidfluid.testing.body import BodyContract
from rigidfluid.testing.detector import DetectorContract
from rigidfluid.testing.fluid_backend import FluidBackendContract
from rigidfluid.testing.force_law import ForceLawContract

__all__ = ["Arrangement", "BodyContract", "DetectorContract", "FluidBackendContract", "ForceLawContract"]
