"""Impacts that lose energy: a damper of given restitution for any law with an energy."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from rigidfluid.core.contact.laws.film_loss import FilmLoss
from rigidfluid.core.contact.laws.hunt_crossley import LEAST, Hardening, excess, excess_by_speed, hardening
from rigidfluid.core.contact.laws.rough_film import RoughFilm
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.contacts import normal_part, select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.core.model.wrapped_law import WrappedLaw
from rigidfluid.errors import SceneError


class Restitution(WrappedLaw):
    """Law F = f (1 + x ẇ/v), f the force of a ``law`` with the energy U, ẇ the closing speed, v that at range.

    x follows from the ``restitution`` e, from LEAST to 1, by x (1 + e) = ln[(1 + x)/(1 - e x)]: a head-on impact of two
    bodies alone ends with e times its speed, whatever the law, the speed and the mass (Hunt and Crossley, J. Appl.
    Mech. 42 (1975) 440, doi:10.1115/1.3423596; x as in Marhefka and Orin, IEEE Trans. Syst. Man Cybern. A 29 (1999)
    566, doi:10.1109/3468.798060). Nothing has to be remembered, as v follows from the present state, with the effective
    mass m and G(y) = y - ln(1 + y):

        (v/x)² [G(x) - G(x ẇ/v)] = U/m

    The damper acts along the normal alone. Its force neither presses at rest nor pulls, and fades out at range as the
    law does; where the law itself pulls, it is zero.

    A ``loss`` is of a whole impact, the resolved film included: ``restitution`` is then the limit of ever faster
    impacts, and e of the law makes up for the film's share, but is at least LEAST. With a `FilmLoss` the impact ends
    with restitution · exp(-β/St) of the speed at the film's edge, St the Stokes number there (Legendre, Daniel and
    Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527). With a `RoughFilm` it is a dry impact behind a film
    that ends at the surfaces' roughness (Barnocky and Davis, Phys. Fluids 31 (1988) 1324, doi:10.1063/1.866725).
    SceneError is raised if the law has no energy or dampers of its own, or the restitution is too small.
    """

    name: ClassVar[str] = "restitution"

    def __init__(self, law: ForceLaw, restitution: float, loss: FilmLoss | RoughFilm | None = None) -> None:
        super().__init__(law)
        if not law.conservative or law.dissipative:
            kind = "dampers of its own" if law.dissipative else "no energy to give back"
            remedy = "Leave `restitution` and `restitution_stokes` out, or choose another law."
            found = f"a restitution for {law.name!r}, which has {kind}"
            raise SceneError("contact.law", found, "a law with an energy and without dampers", remedy)
        if law.sign == "attracts":
            remedy = "Leave `restitution` and `restitution_stokes` out, and give them to the law that repels."
            raise SceneError("contact.law", f"a restitution for {law.name!r}", "a law that repels", remedy)
        if restitution < LEAST:
            raise SceneError("contact.restitution", restitution, f"from {LEAST} to 1", f"Set it to {LEAST} or more.")
        self.dissipative = True
        self.restitution = restitution
        self.loss = loss

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Damping force f x ẇ/v along the normal on ``body_a``, (m, d) [force]."""
        damping = np.zeros_like(contacts.normal)
        inside = (contacts.gap < self.range) & (motion.mass > 0.0)
        if inside.any():
            near = select(contacts, inside)
            force = np.maximum(normal_part(self.law.force(near), near), 0.0)
            stored = np.maximum(2.0 * self.law.energy(near) / motion.mass[inside], 0.0)
            closing = -normal_part(motion.velocity[inside], near)
            excess = self._excess(near, closing, stored, motion.mass[inside])
            damping[inside] = (force * excess)[:, None] * near.normal
        return damping

    def _excess(self, contacts: Contacts, closing: FloatArray, stored: FloatArray, mass: FloatArray) -> FloatArray:
        """Excess x ẇ/v (m,) [1] at ẇ (m,) [length/time] and 2U/m (m,) [length²/time²], for effective masses (m,)
        [mass]."""
        if self.loss is None:
            whole = np.sqrt(closing**2 + stored)
            return excess(self.restitution, np.divide(closing, whole, out=np.zeros_like(whole), where=whole > 0.0))
        restitution = self.loss.restitution(self.restitution, self.law, contacts, mass)

        def hardening_at(speed: FloatArray) -> Hardening:
            return hardening(np.maximum(restitution(speed), LEAST))

        return excess_by_speed(closing, stored, hardening_at)
