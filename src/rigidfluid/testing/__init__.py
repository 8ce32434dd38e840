"""Contract tests for plug-in authors: subclass one, provide its fixture or factory, and run pytest.

::

    from rigidfluid.testing import BodyContract

    class TestMyBody(BodyContract):
        @pytest.fixture
        def body(self):
            return MyBody(MyOptions(length=1.0), dimension=2)
"""

# ruff: noqa: E402  pytest must know the modules before they are imported: an assertion that fails then shows its values.

import pytest

_MODULES = (
    "arrangement",
    "body",
    "detector",
    "domain",
    "fluid",
    "fluid_backend",
    "force_law",
    "joint",
    "material",
    "mechanism",
    "pose_law",
    "size_field",
)
pytest.register_assert_rewrite(*(f"rigidfluid.testing.{module}" for module in _MODULES))

from rigidfluid.testing.arrangement import Arrangement
from rigidfluid.testing.body import BodyContract
from rigidfluid.testing.detector import DetectorContract
from rigidfluid.testing.domain import DomainContract
from rigidfluid.testing.fluid_backend import FluidBackendContract
from rigidfluid.testing.force_law import ForceLawContract
from rigidfluid.testing.joint import JointContract
from rigidfluid.testing.material import MaterialContract
from rigidfluid.testing.mechanism import MechanismContract
from rigidfluid.testing.pose_law import PoseLawContract
from rigidfluid.testing.size_field import SizeFieldContract

__all__ = [
    "Arrangement",
    "BodyContract",
    "DetectorContract",
    "DomainContract",
    "FluidBackendContract",
    "ForceLawContract",
    "JointContract",
    "MaterialContract",
    "MechanismContract",
    "PoseLawContract",
    "SizeFieldContract",
]
