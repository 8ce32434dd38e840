"""Does all fall together, since no surface holds the fluid?"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.checks.finding import Finding
from rigidfluid.core.fluid.conditions import Periodic, no_pressure
from rigidfluid.core.model.system import System

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model


def free_fall_findings(model: Model, system: System) -> Iterator[Finding]:
    """Warn of a fluid between periodic surfaces alone, to which the weight of the bodies gives momentum for ever."""
    periodic = [condition for condition in model.conditions if isinstance(condition, Periodic)]
    if system.fluid is None or system.prescribed.any() or len(periodic) < len(model.conditions):
        return
    weight, force = system.weight.sum(axis=0), system.fluid.source
    axis = int(np.argmax(np.abs(weight)))
    across = [
        condition
        for condition, piece in zip(periodic, model.domain.pieces, strict=True)
        if piece.shape.plane is not None and abs(piece.shape.plane.unit_normal[axis]) > 0.5
    ]
    held = force is not None or any(one.held_flux is not None or one.drop is not no_pressure for one in across)
    if held or weight[axis] == 0.0:
        return
    text = "all surfaces are periodic, and nothing holds the fluid: it falls with the bodies, ever faster"
    remedy = f'Hold the flux across {"xyz"[axis]}: a [[boundary]] of type "periodic" with flux = 0.0 on one side.'
    yield Finding("warning", "free-fall", (), text, remedy)
