"""The flow that a scene starts with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from rigidfluid.core.setup.expressions import VectorExpression
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.model.interfaces import FluidBackend
    from rigidfluid.core.scene.scene import Scene

_KEY = "fluid.initial"

_SAMPLES = 17
"""Points along each axis where the speed of expressions is looked at."""


def initial_flow(scene: Scene) -> Literal["rest", "steady"] | VectorExpression:
    """Initial condition of the fluid, as `FluidProblem.initial` takes it; raises SceneError for an invalid
    expression."""
    initial = scene.fluid.initial
    return initial if isinstance(initial, str) else VectorExpression.parse(initial, _KEY)


def check_initial_flow(scene: Scene, backend: type[FluidBackend], domain: Domain) -> None:
    """Refuse, with SceneError, an initial flow that the backend cannot make, or that is not finite in the domain."""
    if scene.fluid.initial == "rest":
        return
    if not backend.initial_flows:
        allowed = f"'rest' with backend {backend.name!r}"
        raise SceneError(_KEY, scene.fluid.initial, allowed, "Leave it out, or choose backend = 'scikit-fem'.")
    fastest_at_start(scene, domain)


def fastest_at_start(scene: Scene, domain: Domain) -> float:
    """The greatest speed in the domain of expressions of the flow at the start, else 0 [length/time]."""
    flow = initial_flow(scene)
    if isinstance(flow, str):
        return 0.0
    axes = [np.linspace(low, high, _SAMPLES) for low, high in zip(*domain.extent, strict=True)]
    grid = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    inside = grid[domain.contains(grid)]
    return float(np.linalg.norm(flow(0.0, inside), axis=1).max(initial=0.0))
