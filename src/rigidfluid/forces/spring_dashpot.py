"""A spring and a dashpot, with friction: the usual contact of granular dynamics."""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Motion


class SpringDashpotOptions(PartOptions):
    """Keys of a table with law ``spring-dashpot``.

    ``stiffness``: of the spring, k [force/length]. ``restitution`` e or ``damping`` γ [force·time/length], not both,
    set the dissipation of the dashpot; without either there is none. ``friction``: the coefficient μ.
    ``tangential_damping``: the ratio x of the dashpots along and across the surfaces.
    """

    stiffness: float = Field(gt=0, description="Stiffness k of the spring [force/length]")
    restitution: float | None = Field(
        default=None, gt=0, le=1, description="Ratio of the speeds after and before a dry head-on impact [1]"
    )
    damping: float | None = Field(
        default=None, ge=0, description="Coefficient γ of the dashpot, instead of restitution [force·time/length]"
    )
    friction: float = Field(
        default=0.0, ge=0, description="Coefficient of friction μ: the largest ratio of tangential to normal force [1]"
    )
    tangential_damping: float = Field(
        default=1.0, ge=0, description="Ratio x of the dashpot's coefficient along the surfaces to γ [1]"
    )

    @model_validator(mode="after")
    def _one_dashpot(self) -> Self:
        if self.restitution is not None and self.damping is not None:
            raise ValueError("`restitution` or `damping`, not both")
        return self


class SpringDashpotLaw(ForceLaw):
    """F = k δ n - γ v_n n - min(μ |F_n|, x γ |v_t|) v_t/|v_t| for δ = range - gap > 0.

    v_n and v_t are the relative velocity of the surfaces along the normal and across it, F_n = k δ - γ v_n. The energy
    is k δ²/2. γ is given, or γ = -2 ln e √(m k/(π² + ln² e)) with the effective mass m, for which a dry head-on impact
    ends with e times its speed. Contact begins at range: the bodies wear a shell of half that thickness. F_n is not cut
    where it pulls, at the end of an impact: e would not be exact.

    Notes
    -----
    Across the surfaces it is LAMMPS' ``pair_style granular`` with ``pair_coeff * * hooke k e damping coeff_restitution
    tangential linear_nohistory x μ``, or ``hooke k γ damping velocity`` with γ given, without ``limit_damping``, for
    balls of radius r + range/2 and walls range/2 further in. Along the surfaces the formula is the same, and forces
    act where LAMMPS lets them act between balls, in the middle of the overlap; but LAMMPS takes v_t at the surfaces of
    the enlarged balls and not at that middle, which differs by ω δ/2, and gives a ball at a wall the arm of its whole
    radius. https://docs.lammps.org/pair_granular.html
    """

    name: ClassVar[str] = "spring-dashpot"
    dissipative: bool = True
    Options: ClassVar[type[PartOptions]] = SpringDashpotOptions
    options: SpringDashpotOptions

    def force(self, contacts: Contacts) -> FloatArray:
        """k δ along the normal on ``body_a``, (m, d) [force]."""
        return (self.options.stiffness * self._overlap(contacts))[:, None] * contacts.normal

    def energy(self, contacts: Contacts) -> FloatArray:
        """k δ²/2, (m,) [energy]."""
        return 0.5 * self.options.stiffness * self._overlap(contacts) ** 2

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """k where the shells overlap, (m,) [force/length]."""
        return np.where(self._overlap(contacts) > 0.0, self.options.stiffness, 0.0)

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Dashpot and friction on ``body_a``, (m, d) [force]."""
        coefficient = np.where(self._overlap(contacts) > 0.0, self._coefficient(motion.mass), 0.0)
        speed = np.sum(motion.velocity * contacts.normal, axis=1)
        sliding = motion.velocity - speed[:, None] * contacts.normal
        pressing = np.abs(self.options.stiffness * self._overlap(contacts) - coefficient * speed)
        rubbing = _limited(self.options.tangential_damping * coefficient, self.options.friction * pressing, sliding)
        return np.asarray(-(coefficient * speed)[:, None] * contacts.normal - rubbing)

    def _overlap(self, contacts: Contacts) -> FloatArray:
        return np.maximum(self.range - contacts.gap, 0.0)

    def _coefficient(self, mass: FloatArray) -> FloatArray:
        """γ, (m,) [force·time/length]."""
        if self.options.restitution is None:
            return np.full(len(mass), self.options.damping or 0.0)
        logarithm = np.log(self.options.restitution)
        return np.asarray(-2.0 * logarithm * np.sqrt(mass * self.options.stiffness / (np.pi**2 + logarithm**2)))


def _limited(coefficient: FloatArray, most: FloatArray, velocity: FloatArray) -> FloatArray:
    """min(coefficient |v|, most) v/|v|, zero at rest, (m, d)."""
    speed = np.linalg.norm(velocity, axis=1)
    ratio = np.minimum(coefficient, np.divide(most, speed, out=np.full_like(speed, np.inf), where=speed > 0.0))
    return np.asarray(ratio[:, None] * velocity)
