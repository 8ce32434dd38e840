"""A spring and a dashpot, with friction: the usual contact of granular dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.coulomb import (
    Bedding,
    TurningFriction,
    dashpot_coefficient,
    held_displacement,
    sliding_friction,
)
from rigidfluid.core.model.contacts import normal_part, tangential_part
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.latest import Latest
from rigidfluid.core.model.pair_formula import PairFormula, PairSprings
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Loads, Motion


class SpringDashpotOptions(PartOptions):
    """Keys of a table with law ``spring-dashpot``.

    ``stiffness``: of the spring, k [force/length]. ``restitution`` e or ``damping`` γ [force·time/length], not both,
    set the dissipation of the dashpot; without either there is none. ``friction``: the coefficient μ.
    ``tangential_damping``: the ratio x of the dashpots along and across the surfaces. ``tangential_stiffness``: of a
    spring along the surfaces, k_t [force/length]; without it friction has no memory, and what rests on a slope creeps.
    ``bounded_dashpot``: false for LAMMPS' dashpot beside that spring, which creates energy in fast slip.
    ``rolling_friction``, ``twisting_friction``: the coefficients μ_r and μ_o of friction that resists rolling, and the
    turning about the normal; they need the spring.
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

    tangential_stiffness: float | None = Field(
        default=None,
        gt=0,
        description="Stiffness k_t of a spring along the surfaces, which holds static friction [force/length]",
    )

    bounded_dashpot: bool = Field(
        default=True,
        description="false: beside a spring along the surfaces the dashpot alone may exceed the bound, as in LAMMPS",
    )

    rolling_friction: float = Field(
        default=0.0, ge=0, description="Coefficient of rolling friction μ_r: the largest couple is μ_r R F_n [1]"
    )
    twisting_friction: float = Field(
        default=0.0, ge=0, description="Coefficient of twisting friction μ_o: the largest couple is μ_o R F_n [1]"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.restitution is not None and self.damping is not None:
            raise ValueError("`restitution` or `damping`, not both")
        if self.tangential_stiffness is not None and self.friction == 0.0:
            raise ValueError("`tangential_stiffness` with `friction` above 0 alone")
        if self.tangential_stiffness is None and not self.bounded_dashpot:
            raise ValueError("`bounded_dashpot = false` with `tangential_stiffness` alone")
        if self.tangential_stiffness is None and (self.rolling_friction > 0.0 or self.twisting_friction > 0.0):
            raise ValueError("`rolling_friction` and `twisting_friction` with `tangential_stiffness` alone")
        return self


@dataclass(frozen=True, slots=True)
class _Pressed:
    """Forces in contacts: γ v_n, ``damped`` (m,), the ``bedding`` of springs, ``most``, μ |F_n|, (m,), and that of the
    dashpots along the surfaces, ``rubbing`` (m, d) [force]."""

    damped: FloatArray
    bedding: Bedding
    most: FloatArray
    rubbing: FloatArray


class SpringDashpotLaw(ForceLaw):
    """F = k δ n - γ v_n n - min(μ |F_n|, x γ |v_t|) v_t/|v_t| for δ = range - gap > 0.

    v_n and v_t are the relative velocity of the surfaces along the normal and across it, F_n = k δ - γ v_n. The energy
    is k δ²/2. γ is given, or γ = -2 ln e √(m k/(π² + ln² e)) with the effective mass m, for which a dry head-on impact
    ends with e times its speed. Contact begins at range: the bodies wear a shell of half that thickness. F_n is not cut
    where it pulls, at the end of an impact: e would not be exact.

    With ``tangential_stiffness`` k_t the force along the surfaces is that of the dashpot and -k_t ξ, together at most
    μ |F_n|: ξ, the displacement of the surfaces past each other, is shortened where they slip until that holds (Cundall
    & Strack, Géotechnique 29 (1979) 47, doi:10.1680/geot.1979.29.1.47). Its energy is k_t ξ²/2. A dashpot x γ v_t
    without a bound of its own, ``bounded_dashpot = false``, stretches the spring backwards in fast slip, to
    -(x γ v_t - μ F_n)/k_t, with an energy for which nothing has worked.

    With ``rolling_friction`` μ_r or ``twisting_friction`` μ_o it is so for the relative angular velocity w too (Luding,
    Granular Matter 10 (2008) 235, doi:10.1007/s10035-008-0099-x): the couple is

        C = -R (k_t ζ + x γ R w),   |C across n| ≤ μ_r R |F_n|,   |C along n| ≤ μ_o R |F_n|

    with the effective radius R = r_a r_b/(r_a + r_b), r_a at a flat wall, and ζ = ∫ R w dt [length], shortened as ξ is.
    The energy is k_t ζ²/2. In 2D bodies roll and do not twist.

    Notes
    -----
    Across the surfaces it is LAMMPS' ``pair_style granular`` with ``pair_coeff * * hooke k e damping coeff_restitution
    tangential linear_nohistory x μ``, or ``hooke k γ damping velocity`` with γ given, without ``limit_damping``, for
    balls of radius r + range/2 and walls range/2 further in; with k_t given and ``bounded_dashpot = false``, or x γ
    zero, it is ``linear_history k_t x μ``. Along the surfaces the formula is the same, and forces act where LAMMPS lets
    them act between balls, in the middle of the overlap; but LAMMPS takes v_t at the surfaces of the enlarged balls and
    not at that middle, which differs by ω δ/2, and gives a ball at a wall the arm of its whole radius.
    https://docs.lammps.org/pair_granular.html
    """

    name: ClassVar[str] = "spring-dashpot"
    dissipative: bool = True
    Options: ClassVar[type[PartOptions]] = SpringDashpotOptions
    options: SpringDashpotOptions

    def __init__(self, options: PartOptions, range: float, loads: Loads | None = None) -> None:
        super().__init__(options, range, loads)
        self.friction = self.options.friction
        self.sticking = self.options.tangential_stiffness is not None
        self._pressed = Latest[_Pressed]()
        self._turning = TurningFriction(self.options.rolling_friction, self.options.twisting_friction)
        self.rolling = self.couples = bool(self._turning.keys)
        self.round_option = self._turning.keys[0] if self.rolling else ""

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
        pressed = self._pressed_in(contacts, motion)
        return np.asarray(-pressed.damped[:, None] * contacts.normal - pressed.rubbing)

    def pair_formula(self) -> PairFormula | None:
        """k δ, the dashpot across the surfaces and the friction along them, or the dashpot there and the springs."""
        options = self.options
        scale = np.nan if options.restitution is None else dashpot_coefficient(options.restitution, 1.0, np.ones(1))[0]
        bound = np.inf if self.sticking else options.friction
        numbers = [self.range, options.stiffness, options.damping or 0.0, scale, bound, options.tangential_damping]
        return PairFormula(_formula, np.array(numbers), self._pair_springs())

    def _pair_springs(self) -> PairSprings | None:
        options = self.options
        if options.tangential_stiffness is None:
            return None
        turning = options.rolling_friction, options.twisting_friction
        return PairSprings(options.tangential_stiffness, options.friction, *turning, options.bounded_dashpot)

    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """k_t where the shells overlap, (m,) [force/length]."""
        return np.where(self._overlap(contacts) > 0.0, self.options.tangential_stiffness or 0.0, 0.0)

    def held_displacement(self, contacts: Contacts, motion: Motion, displacement: FloatArray) -> FloatArray:
        """ξ with -k_t ξ and the dashpot at most μ |F_n|, the nearest along that force, (m, d) [length]."""
        pressed = self._pressed_in(contacts, motion)
        return held_displacement(pressed.bedding.stiffness, pressed.rubbing, pressed.most, displacement)

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """-x γ R² w of what friction resists, at most what it holds, on ``body_a``, (m, k) [force·length]."""
        return self._turning.couple(contacts, motion, self._pressed_in(contacts, motion).bedding)

    def held_turning(self, contacts: Contacts, motion: Motion, turning: FloatArray) -> FloatArray:
        """ζ with |k_t ζ + x γ R w| ≤ μ |F_n| along the normal and across it, with its own μ each, (m, k) [length]."""
        return self._turning.held(contacts, motion, self._pressed_in(contacts, motion).bedding, turning)

    def _pressed_in(self, contacts: Contacts, motion: Motion) -> _Pressed:
        """Forces in the contacts, kept for the same records: each substep asks two to four times."""
        return self._pressed.answer((contacts, motion), lambda: self._press(contacts, motion))

    def _press(self, contacts: Contacts, motion: Motion) -> _Pressed:
        overlap = self._overlap(contacts)
        coefficient = np.where(overlap > 0.0, self._coefficient(motion.mass), 0.0)
        damped = coefficient * normal_part(motion.velocity, contacts)
        normal_force = np.abs(self.options.stiffness * overlap - damped)
        most = self.options.friction * normal_force
        rubbing = self._rubbing(coefficient, most, tangential_part(motion.velocity, contacts))
        along = self.options.tangential_damping * coefficient
        return _Pressed(damped, Bedding(self.tangential_stiffness(contacts), along, normal_force), most, rubbing)

    def _rubbing(self, coefficient: FloatArray, most: FloatArray, sliding: FloatArray) -> FloatArray:
        """Force of the dashpots along the surfaces that slide with this velocity (m, d), beside dashpots across them of
        this ``coefficient`` (m,) and at most ``most`` (m,) if they are bounded, (m, d) [force]."""
        along = self.options.tangential_damping * coefficient
        if self.options.bounded_dashpot:
            return sliding_friction(along, most, sliding)
        return np.asarray(along[:, None] * sliding)

    def _overlap(self, contacts: Contacts) -> FloatArray:
        return np.maximum(self.range - contacts.gap, 0.0)

    def _coefficient(self, mass: FloatArray) -> FloatArray:
        """γ, (m,) [force·time/length]."""
        if self.options.restitution is None:
            return np.full(len(mass), self.options.damping or 0.0)
        return dashpot_coefficient(self.options.restitution, self.options.stiffness, mass)


def _formula(parameters, gap, radius_a, radius_b, mass, opening, sliding):  # type: ignore[no-untyped-def]
    """Energy and force of one contact: it is compiled."""
    law_range, stiffness, damping, scale, friction, ratio = parameters
    overlap = max(law_range - gap, 0.0)
    force = stiffness * overlap
    if force == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    if not np.isnan(scale):
        damping = scale * np.sqrt(mass * stiffness)
    along, most = ratio * damping, friction * abs(force - damping * opening)
    if along * sliding > most:
        along = most / sliding
    return 0.5 * force * overlap, force, -damping * opening, along
