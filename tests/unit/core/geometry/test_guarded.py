"""What parts raise, as the program tells it."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import PluginError

NOBODY = Pose(np.zeros((0, 2)), np.zeros((0, 1)))


class Raising(SphereDetector):
    """A detector in whose compiled code something goes wrong."""

    name = "raising"
    cause: BaseException

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        raise SystemError("returned a result with an exception set") from self.cause


def through_another(cause: BaseException) -> SystemError:
    """Of compiled code that was called by compiled code, as while a loop is loaded from the cache."""
    error = SystemError("returned a result with an exception set")
    error.__cause__ = cause
    return error


@pytest.mark.parametrize(
    ("cause", "told"),
    [
        (KeyboardInterrupt(), KeyboardInterrupt),
        (through_another(through_another(KeyboardInterrupt())), KeyboardInterrupt),
        (ValueError(), PluginError),
        (through_another(ValueError()), PluginError),
    ],
)
def test_an_interrupt_within_compiled_code_is_no_fault_of_the_part(
    cause: BaseException, told: type[BaseException]
) -> None:
    detector = Raising(PartOptions(), [], ())
    detector.cause = cause
    with pytest.raises(told):
        detector.detect(NOBODY, None, 1.0)
