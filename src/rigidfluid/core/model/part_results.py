"""Refuses numbers that no run may go on with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Pose
from rigidfluid.errors import StepRejected


def refuse_no_number(subject: str, quantity: str, values: FloatArray | float, key: str) -> None:
    """Raise StepRejected if any of ``values`` is not finite; ``key`` of the scene names where they come from."""
    numbers = np.asarray(values)
    finite = np.isfinite(numbers)
    if not finite.all():
        raise StepRejected(
            subject,
            f"a {quantity} of {numbers[~finite].flat[0]}",
            "finite numbers",
            f"Shorten time.step; if that does not help, look for the cause in what `{key}` says or names.",
        )


def refuse_lost_pose(names: Sequence[str], pose: Pose) -> None:
    """Raise StepRejected if a body is nowhere; ``names`` are the bodies' and more."""
    for quantity, values in (("position", pose.position), ("orientation", pose.orientation)):
        if not np.isfinite(values).all():
            lost = int(np.argmin(np.isfinite(values).all(axis=1)))
            refuse_no_number(f"body {names[lost]}", quantity, values[lost], "body")
