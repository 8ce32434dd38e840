"""Abstract class of a force law."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Literal

import numpy as np

from rigidfluid.core.geometry.answers import rows
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.model import part_answers as parts
from rigidfluid.core.model.pair_formula import PairFormula, refuse_no_formula
from rigidfluid.core.model.part import Part, PartOptions
from rigidfluid.core.model.types import Contacts, Loads, Motion
from rigidfluid.errors import SceneError

Between = Literal["all", "walls", "pairs"]
Sign = Literal["repels", "attracts", "either"]
Overlap = Literal["repels", "attracts", "either", "unbounded"]


class ForceLaw(Part):
    """A short-range force between two surfaces: one that an energy gives, and one that takes energy out.

    All forces act on ``body_a``, half-way between the contact points; ``core/mechanics/wrenches`` applies the reaction.
    So it does with couples, which suffices for any interaction that keeps the angular momentum of a pair.

    Parameters
    ----------
    options : PartOptions
        The law's own keys of the table that names it.
    range : float
        The gap above which the law is zero [length].
    loads : Loads, optional
        What the contacts must hold, for laws that choose their strength by it.
    """

    kind: ClassVar[str] = "force law"
    range: float
    balls_only: ClassVar[bool] = False
    round_option: str = ""
    """Key of its table by which it is for round and flat surfaces alone, and for ellipsoids if it is ``curved``; false
    or 0, it is for any. Empty without such."""
    film: bool = False
    """Tell whether it resists as a film that no mesh resolves: it reads `Contacts.effective_radius`, which balls,
    ellipses and ellipsoids have."""
    curved: bool = False
    """Tell whether, as a film, it reads `Contacts.curvatures` too, of bodies that are no balls."""
    conservative: bool = True
    """Tell whether it has an energy; else force, energy and stiffness are zero."""
    dissipative: bool = False
    """Tell whether it has damping; else damping is zero."""
    sticking: bool = False
    """Tell whether it has springs along the surfaces, which remember how far these have moved past each other; else
    their stiffness is zero."""
    rolling: bool = False
    """Tell whether these springs resist rolling and twisting too, by couples."""
    couples: bool = False
    """Tell whether its dampers turn bodies by couples besides their force; else these are zero."""
    sign: Sign = "repels"
    """Sign of the energy's force between contact and range; "either" for one that changes or is zero in part of it."""
    overlap: Overlap = "repels"
    """Behaviour of the energy's force at gap < 0; either: any force, which may jump at contact; unbounded: the energy
    is infinite, and force and stiffness raise StepRejected."""
    acts_in: Between = "all"
    """Contacts that it is made for: `walls`, `pairs` of bodies, or `all`; it is not evaluated in others."""
    vanishes_at_range: bool = True
    """Tell whether its force fades out towards range; else it jumps to zero there. The energy is zero there anyway."""
    friction: float = 0.0
    """Coefficient of Coulomb friction: the largest ratio of tangential to normal force [1]."""
    loads: Loads | None = None
    """Loads from which a law sets its strength; bodies of equal loads then meet alike."""

    def __init__(self, options: PartOptions, range: float, loads: Loads | None = None) -> None:
        self.options = options
        self.range = range

    def require_below_range(self, key: str, length: float) -> None:
        """Raise SceneError unless a ``length`` of the law's table, by its ``key``, is below the range [length]."""
        if length >= self.range:
            allowed = f"a length below contact.range = {self.range}"
            raise SceneError(f"contact.{key}", length, allowed, "Shorten it, or widen the range.")

    @property
    @gives(parts.ranges)
    def ranges(self) -> tuple[float, ...]:
        """The gaps where it begins, in order: its range, and those of its parts where it has several [length]."""
        return (self.range,)

    @property
    def keeps_apart(self) -> bool:
        """Tell whether it can hold two surfaces apart at rest: it has an energy, and does not only attract."""
        return self.conservative and self.sign != "attracts"

    @abstractmethod
    @gives(rows(lambda _, contacts: contacts.normal.shape, shorter=True))
    def force(self, contacts: Contacts) -> FloatArray:
        """Force F = -dU/dgap · n on ``body_a``, (m, d) [force]."""

    @abstractmethod
    @gives(parts.energies)
    def energy(self, contacts: Contacts) -> FloatArray:
        """Potential energy U of each contact, (m,), zero at range [energy]."""

    @abstractmethod
    @gives(rows(lambda _, contacts: contacts.gap.shape, shorter=True))
    def stiffness(self, contacts: Contacts) -> FloatArray:
        """-d(F·n)/dgap of each contact, (m,) [force/length]."""

    @gives(rows(lambda _, contacts, motion: contacts.normal.shape, shorter=True))
    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Further force F on ``body_a`` that the relative motion gives, (m, d) [force]: F·v + C·w ≤ 0 with the couple C
        and the relative velocities v and w of the surfaces, and F·v ≤ 0 where w is zero."""
        return np.zeros_like(contacts.normal)

    @gives(rows(lambda _, contacts, motion: motion.angular_velocity.shape, shorter=True))
    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Couple C on ``body_a`` that the relative motion gives besides the moment of the force, (m, k)
        [force·length]; ``body_b`` takes the opposite one."""
        return np.zeros_like(motion.angular_velocity)

    @gives(rows(lambda _, contacts: contacts.gap.shape, shorter=True))
    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """Stiffness k of the springs along the surfaces, (m,) [force/length]."""
        return np.zeros_like(contacts.gap)

    @gives(rows(lambda _, contacts, motion, displacement: displacement.shape, shorter=True))
    def held_displacement(self, contacts: Contacts, motion: Motion, displacement: FloatArray) -> FloatArray:
        """Displacement ξ that friction holds of a ``displacement`` of these springs, (m, d) each and across the normals
        [length]: -k ξ and damping along the surfaces together are no more than friction gives."""
        return np.zeros_like(displacement)

    @gives(rows(lambda _, contacts, motion, turning: turning.shape, shorter=True))
    def held_turning(self, contacts: Contacts, motion: Motion, turning: FloatArray) -> FloatArray:
        """Displacement ζ that friction of rolling and twisting holds of ``turning``, (m, k) each, the relative angle
        times the effective radius R [length]; the couple of the springs is -R k ζ on ``body_a``. The parts of ζ across
        the normal and along it do not depend on each other."""
        return np.zeros_like(turning)

    @gives(refuse_no_formula)
    def pair_formula(self) -> PairFormula | None:
        """Formula of one contact of balls for compiled loops, the same as ``force`` and ``damping``; None without: then
        these are asked. Only the class that has it gives it, and not its subclasses."""
        return None
