"""Abstract class of a joint, and a joint between two bodies of a system."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.answers import rows, several
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.joints.constraints import Constraint
from rigidfluid.core.joints.coordinates import Coordinate, Drive
from rigidfluid.core.joints.markers import MarkerPair
from rigidfluid.core.joints.springs import Spring
from rigidfluid.core.model.part import SpatialPart


class Joint(SpatialPart):
    """Relative motion that a joint leaves to two bodies, or to a body and the ground.

    It knows no bodies: it is asked for constraints and springs between two markers, which stand at the joint's point
    and are one at the start. Options that contradict each other, or the dimension, raise SceneError, with a field
    ``joint.key``.

    Parameters
    ----------
    options : PartOptions
        The kind's own keys of the ``[[joint]]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "joint"
    needs_point: ClassVar[bool] = False
    """Tell whether a scene has to say where it is; else, if none is given, it is at the first body's centre of mass."""
    coordinate: Coordinate | None = None
    """The coordinate that the joint leaves free, or drives, as ``joints.csv`` tells it; None where there is none, or no
    single one."""
    drive: Drive | None = None
    """Drive of the coordinate; None where it is free."""

    @property
    @gives(rows(lambda part: (part.dimension, part.dimension)))
    def axes(self) -> FloatArray:
        """Axes (d, d) of both markers in space at the start, right-handed unit vectors in columns; those of space
        unless said otherwise. Angles are about the last, displacements along it [1]."""
        return np.eye(self.dimension)

    @abstractmethod
    @gives(several(lambda: Constraint, least=1))
    def constraints(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        """Constraints that hold, drive and damp the first marker, seen from the second.

        Parameters
        ----------
        name : str
            The joint's name in messages, which its constraints take.
        markers : MarkerPair
            The markers on the bodies; those of the first constraint, at least.

        Returns
        -------
        sequence of Constraint
            One or more.
        """

    @gives(several(lambda: Spring))
    def springs(self, markers: MarkerPair) -> Sequence[Spring]:
        """Springs between the ``markers``; none unless said otherwise."""
        return ()


@dataclass(frozen=True, slots=True)
class PlacedJoint:
    """A joint named ``name`` of a ``kind`` between two bodies, by number, the ``second`` None for the ground; ``at``
    (d,): its point at the start [length]."""

    name: str
    kind: Joint
    first: int
    second: int | None
    at: FloatArray
