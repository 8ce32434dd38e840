"""Abstract class of a law that knows poses: a long-range force between two bodies."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.answers import rows
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts


@dataclass(frozen=True, slots=True)
class PairPoses:
    """Poses of m pairs of bodies: ``separation`` (m, d) from the centre of mass of b to that of a [length], and
    ``rotation_a``, ``rotation_b`` (m, d, d) from the frames of the bodies to space."""

    separation: FloatArray
    rotation_a: FloatArray
    rotation_b: FloatArray

    def __len__(self) -> int:
        return len(self.separation)


class PoseLaw(ForceLaw):
    """A long-range force between two bodies, which an energy of their poses gives.

    Its range is a distance of the centres of mass. It acts between the two bodies that its table names, whatever is
    between them, and in no contact: there its force and energy are zero. On a acts a force F at the middle between both
    centres, and a couple C; on b the opposite of both, by ``core/mechanics/wrenches``. So a pair keeps its momentum and
    its angular momentum, and the torques about the centres of mass are

        T_a = C - ½ s × F,   T_b = -C - ½ s × F,   T_a + T_b + s × F = 0

    with the separation s from b to a.

    Parameters
    ----------
    options : PartOptions
        The law's own keys of the table that names it.
    range : float
        Distance of the centres above which it is zero [length].
    loads : Loads, optional
        Loads of contacts; not needed.
    """

    conservative: bool = False

    def require_dimension(self, dimension: int) -> None:
        """Raise SceneError where the options are not for this number of space dimensions."""

    @abstractmethod
    @gives(rows(lambda _, pairs: (len(pairs),), shorter=True))
    def pair_energy(self, pairs: PairPoses) -> FloatArray:
        """Potential energy U of each pair, (m,), zero from range on [energy]."""

    @abstractmethod
    @gives(rows(lambda _, pairs: pairs.separation.shape, shorter=True))
    def pair_force(self, pairs: PairPoses) -> FloatArray:
        """Force F = -∂U/∂s on a, (m, d) [force]."""

    @abstractmethod
    @gives(rows(lambda _, pairs: (len(pairs), 1 if pairs.separation.shape[1] == 2 else 3), shorter=True))
    def pair_couple(self, pairs: PairPoses) -> FloatArray:
        """Couple C = T_a + ½ s × F on a, with T_a = -∂U/∂(rotation of a), (m, k) [force·length]."""

    @abstractmethod
    @gives(rows(lambda _, distance: (len(distance), 2)))
    def pair_stiffness(self, distance: FloatArray) -> FloatArray:
        """Bounds (m, 2) of the stiffness at the ``distance`` (m,) or farther: κ_s [force/length] and κ_r [force·length]
        with |δᵀ U'' δ| ≤ κ_s |δs|² + κ_r (|δa|² + |δb|²) for displacements δs and rotations δa, δb."""

    def force(self, contacts: Contacts) -> FloatArray:
        """Zero in contacts, (m, d) [force]."""
        return np.zeros_like(contacts.normal)

    def energy(self, contacts: Contacts) -> FloatArray:
        """Zero in contacts, (m,) [energy]."""
        return np.zeros_like(contacts.gap)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """Zero in contacts, (m,) [force/length]."""
        return np.zeros_like(contacts.gap)
