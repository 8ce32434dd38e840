"""Abstract class of a mechanism, and the components it consists of."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.answers import number, optional
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.model import part_answers as parts
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import SpatialPart
from rigidfluid.core.model.types import Pose, Twist


@dataclass(frozen=True)
class Component:
    """A rigid body in a mechanism: its ``name`` there, its ``shape`` and its ``density`` [mass/length^d]."""

    name: str
    shape: Body
    density: float


class Mechanism(SpatialPart):
    """Several rigid bodies that move as one: freely together, and relatively as a function of time or not at all.

    Parameters
    ----------
    options : PartOptions
        The type's own keys of the ``[[mechanism]]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "mechanism"
    driven: bool = False
    """Tell whether the placement changes with time; else it is asked for once."""

    @property
    @abstractmethod
    @gives(parts.components)
    def components(self) -> Sequence[Component]:
        """Components, m of them; the type of each shape is one that a scene can name."""

    @abstractmethod
    @gives(parts.placement)
    def placement(self, time: float) -> Pose:
        """Pose of the components in the mechanism's own frame, whose origin may be anywhere: m positions [length] and
        orientations [rad | 1]."""

    @gives(parts.rate)
    def rate(self, time: float) -> Twist:
        """Rate of the placement, in the same frame: velocities [length/time] and angular velocities [rad/time]."""
        m, k = len(self.components), 1 if self.dimension == 2 else 3
        return Twist(np.zeros((m, self.dimension)), np.zeros((m, k)))

    @property
    @gives(optional(number(0.0)))
    def period(self) -> float | None:
        """Time after which the placement repeats itself; None where it does not [time]."""
        return None

    @gives(parts.later)
    def next_corner(self, time: float) -> float:
        """The first time after this at which the rate jumps; infinite where it does not [time].

        A step ends there, or less than a tick before, and the next restarts. The rate at a corner is that before it,
        at time 0 that after it.
        """
        return math.inf
