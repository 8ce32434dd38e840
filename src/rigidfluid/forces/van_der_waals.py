"""Attraction of balls by dispersion forces."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.contact.laws.balls import require_balls
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw, Overlap, Sign
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Loads


class VanDerWaalsOptions(PartOptions):
    """Keys of a table with law ``van-der-waals``.

    ``hamaker``: the constant A of both materials in the fluid between them [energy·length^(3-d)]. ``cutoff``: the gap
    below which the force grows no steeper [length].
    """

    hamaker: float = Field(gt=0, description="Hamaker constant A [energy·length^(3-d)]")
    cutoff: float = Field(gt=0, description="Gap below which the force grows no steeper [length]")


class VanDerWaalsLaw(ForceLaw):
    """U = -A R/(6 gap) in 3D, -A √R/(12√2 gap^(3/2)) in 2D, shifted so that U and F vanish at range.

    With U = -C gap^-p, p = 1 in 3D and 3/2 in 2D, and a the cutoff, for a ≤ gap ≤ range

        U = -C [gap^-p - range^-p - p (range - gap) range^(-p-1)],   F = -p C [gap^(-p-1) - range^(-p-1)],

    and the stiffness is -p (p+1) C gap^(-p-2). Below the cutoff, and in overlap, U is its Taylor polynomial of second
    degree about it. R = r_a r_b/(r_a + r_b), the ball's radius at a flat wall, with r_b < 0 in a round hollow. Half-
    spaces attract each other with the pressure A/(6π gap³), which Derjaguin's approximation integrates over the gap of
    the balls, and in 2D of cylinders, for a unit length: balls are to be large compared with the range.

    A cutoff that is not below range, and a surface that is neither round nor flat, raise SceneError.

    Notes
    -----
    Israelachvili, Intermolecular and Surface Forces, 3rd ed. (2011), chapters 11 and 13; Parsegian, Van der Waals
    Forces (2006), tables S. Nothing of retardation or of ions is in it.
    """

    name: ClassVar[str] = "van-der-waals"
    balls_only: ClassVar[bool] = True
    sign: Sign = "attracts"
    overlap: Overlap = "attracts"
    Options: ClassVar[type[PartOptions]] = VanDerWaalsOptions
    options: VanDerWaalsOptions

    def __init__(self, options: PartOptions, range: float, loads: Loads | None = None) -> None:
        super().__init__(options, range, loads)
        self.require_below_range("cutoff", self.options.cutoff)

    def force(self, contacts: Contacts) -> FloatArray:
        """-p C [h^(-p-1) - range^(-p-1)] along the normal on ``body_a``, h = gap, (m, d) [force]."""
        power, strength = _power(contacts), self._strength(contacts)
        outside = np.maximum(contacts.gap, self.options.cutoff)
        along = -power * strength * (outside ** (-power - 1.0) - self.range ** (-power - 1.0))
        along -= self.stiffness(contacts) * (contacts.gap - outside)
        return np.where(contacts.gap < self.range, along, 0.0)[:, None] * contacts.normal

    def energy(self, contacts: Contacts) -> FloatArray:
        """-C [h^-p - range^-p - p (range - h) range^(-p-1)], h = gap, (m,) [energy]."""
        power, strength = _power(contacts), self._strength(contacts)
        outside = np.maximum(contacts.gap, self.options.cutoff)
        inward, last = outside - contacts.gap, self.range ** (-power - 1.0)
        energy = outside**-power - self.range**-power - power * (self.range - outside) * last
        energy += power * (outside ** (-power - 1.0) - last) * inward
        energy += 0.5 * power * (power + 1.0) * outside ** (-power - 2.0) * inward**2
        return np.where(contacts.gap < self.range, -strength * energy, 0.0)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """-p (p+1) C h^(-p-2), h = gap, (m,) [force/length]."""
        power, strength = _power(contacts), self._strength(contacts)
        outside = np.maximum(contacts.gap, self.options.cutoff)
        stiffness = -power * (power + 1.0) * strength * outside ** (-power - 2.0)
        return np.where(contacts.gap < self.range, stiffness, 0.0)

    def _strength(self, contacts: Contacts) -> FloatArray:
        """C, (m,) [energy·length^p]."""
        require_balls(contacts, self.name)
        radius = 1.0 / (1.0 / contacts.radius_a + 1.0 / contacts.radius_b)
        if contacts.normal.shape[1] == 3:
            return np.asarray(self.options.hamaker * radius / 6.0)
        return np.asarray(self.options.hamaker * np.sqrt(radius / 2.0) / 12.0)


def _power(contacts: Contacts) -> float:
    """p [1]."""
    return 1.0 if contacts.normal.shape[1] == 3 else 1.5
