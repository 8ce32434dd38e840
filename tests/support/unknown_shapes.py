"""A shape that no exact detector knows."""

import numpy as np

from rigidfluid.bodies.sphere import Sphere


class Cross(Sphere):
    """A ball that does not say that it is one."""

    name = "cross"
    radius = None  # type: ignore[assignment]
    volume = bounding_radius = 1.0  # type: ignore[assignment]

    @property
    def unit_inertia(self):
        return np.eye(1 if self.dimension == 2 else 3)
