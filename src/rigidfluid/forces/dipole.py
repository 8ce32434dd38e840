"""Two point dipoles, fixed in their bodies."""

from __future__ import annotations

from typing import ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.force_law import Between, Sign
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.pose_law import PairPoses, PoseLaw
from rigidfluid.errors import SceneError

SWITCHED = 0.8
"""Distance over range from which the energy is switched off."""

_STRAIGHT, _TURNING = 36.0, 10.0
"""Bounds of the second derivatives of the dipoles' energy, by displacement and by rotation, over k |m_a| |m_b| r⁻⁵ and
r⁻³: with the mixed ones shared out to both."""

_SLOPE, _BEND = 1.875, 5.7736
"""Greatest slope and second derivative of the switch."""


class DipoleOptions(PartOptions):
    """Keys of a table with law ``dipole``.

    ``strength``: k [energy·length³/moment²], such as μ₀/4π of magnetic dipoles. ``moments``: of both bodies, in the
    order of ``names``, each a vector in the frame of its body [moment].
    """

    strength: float = Field(gt=0, description="Constant k [energy·length³/moment²]")
    moments: tuple[tuple[float, ...], tuple[float, ...]] = Field(
        description="Dipole moments of both bodies in the order of `names`, in the frames of the bodies [moment]"
    )


class DipoleLaw(PoseLaw):
    """U = S(r) k [m_a·m_b - 3 (m_a·n)(m_b·n)]/r³.

    r is the distance of the centres of mass, n the unit vector from b to a, m_a and m_b the moments, which turn with
    their bodies. Force and torque on a, before they are switched off, are

        F = 3 k/r⁴ [(m_a·n) m_b + (m_b·n) m_a + (m_a·m_b) n - 5 (m_a·n)(m_b·n) n],
        T_a = m_a × B,   B = k [3 (m_b·n) n - m_b]/r³

    (Jackson, Classical Electrodynamics, 3rd ed., sections 5.6 and 5.7). S is 1 up to .8 range, zero from range on, and
    1 - 10 x³ + 15 x⁴ - 6 x⁵ between, x from 0 to 1: energy, force and stiffness fade out there. The force -S' U/S n is
    added. In 2D the formulas are the same, those of points in a plane, and moments lie in it.
    """

    name: ClassVar[str] = "dipole"
    sign: Sign = "either"
    acts_in: Between = "pairs"
    Options: ClassVar[type[PartOptions]] = DipoleOptions
    options: DipoleOptions

    def require_dimension(self, dimension: int) -> None:
        """Raise SceneError unless moments have as many components, one of them at least not zero."""
        for number, vector in enumerate(self.options.moments):
            if len(vector) != dimension or not any(vector):
                allowed = f"{dimension} components, not all zero"
                raise SceneError(f"contact.moments.{number}", list(vector), allowed, "Correct the moment.")

    def pair_energy(self, pairs: PairPoses) -> FloatArray:
        """U, (m,) [energy]."""
        return self._switch(pairs)[0] * self._dipoles(pairs).energy

    def pair_force(self, pairs: PairPoses) -> FloatArray:
        """F on a, (m, d) [force]."""
        (part, slope), there = self._switch(pairs), self._dipoles(pairs)
        return part[:, None] * there.force - (slope * there.energy)[:, None] * there.normal

    def pair_couple(self, pairs: PairPoses) -> FloatArray:
        """T_a + ½ s × F, (m, k) [force·length]."""
        torque = self._switch(pairs)[0][:, None] * self._dipoles(pairs).torque
        return np.asarray(torque + 0.5 * moment(pairs.separation, self.pair_force(pairs)))

    def pair_stiffness(self, distance: FloatArray) -> FloatArray:
        """36 K/r⁵ and 10 K/r³, K = k |m_a| |m_b|, or what the switch makes of it where that is more, (m, 2)."""
        sizes = [float(np.linalg.norm(vector)) for vector in self.options.moments]
        strength, width, near = self.options.strength * sizes[0] * sizes[1], 1.0 - SWITCHED, SWITCHED * self.range
        switched = 2.0 * _BEND / width**2 + 20.0 * _SLOPE / width
        straight = np.maximum(_STRAIGHT / distance**5, switched / (near**3 * self.range**2))
        return np.asarray(strength * np.column_stack([straight, _TURNING / distance**3]))

    def _switch(self, pairs: PairPoses) -> tuple[FloatArray, FloatArray]:
        """S and dS/dr, (m,) [1, 1/length]."""
        width = (1.0 - SWITCHED) * self.range
        x = np.clip((np.linalg.norm(pairs.separation, axis=1) - SWITCHED * self.range) / width, 0.0, 1.0)
        return 1.0 - x**3 * (10.0 - 15.0 * x + 6.0 * x**2), -30.0 * (x * (1.0 - x)) ** 2 / width

    def _dipoles(self, pairs: PairPoses) -> _Dipoles:
        a, b = (
            np.einsum("mij,j->mi", rotation, np.array(vector))
            for rotation, vector in zip((pairs.rotation_a, pairs.rotation_b), self.options.moments, strict=True)
        )
        r = np.linalg.norm(pairs.separation, axis=1)
        n, k = pairs.separation / r[:, None], self.options.strength
        along_a, along_b, both = (np.sum(one * other, axis=1) for one, other in ((a, n), (b, n), (a, b)))
        field = (k / r**3)[:, None] * (3.0 * along_b[:, None] * n - b)
        radial = (both - 5.0 * along_a * along_b)[:, None] * n
        force = (3.0 * k / r**4)[:, None] * (along_a[:, None] * b + along_b[:, None] * a + radial)
        return _Dipoles(k * (both - 3.0 * along_a * along_b) / r**3, force, moment(a, field), n)


class _Dipoles(NamedTuple):
    """Dipoles without the switch: ``energy`` (m,) [energy], ``force`` (m, d) on a [force], ``torque`` (m, k) on a about
    its centre [force·length]; ``normal`` (m, d) from b to a."""

    energy: FloatArray
    force: FloatArray
    torque: FloatArray
    normal: FloatArray
