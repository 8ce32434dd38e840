"""Restitution of a law between rough surfaces in a fluid: dry contact, less the film that nothing else counts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.contact.laws.film_loss import braking
from rigidfluid.core.contact.laws.stokes_number import stokes_number_taken
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Film, Loads


@dataclass(frozen=True, slots=True)
class RoughFilm:
    """Loss of impacts in a film that ends at the ``roughness`` [length], the gap at which surfaces touch, whether the
    mesh resolves the ``film`` or not; ``loads`` has the masses."""

    roughness: float
    film: Film
    loads: Loads

    @property
    def words(self) -> str:
        """Words after those for the dry restitution."""
        return f" behind a film down to a gap of {self.roughness:g}"

    def whole(self, dry: float, contacts: Contacts, stokes: FloatArray) -> FloatArray:
        """Restitution of whole impacts, the film included, at Stokes numbers (m,) at its edge, (m,) [1]."""
        taken = self.taken(contacts)
        return np.asarray(np.maximum(dry * (stokes - taken) - taken, 0.0) / stokes)

    def restitution(
        self, dry: float, law: ForceLaw, contacts: Contacts, mass: FloatArray
    ) -> Callable[[FloatArray], FloatArray]:
        """Restitution (m,) [1] of the law alone over the speed v (m,) at range [length/time].

        The film down to the roughness takes T of St on the way in, and again on the way out. The mesh resolves A of it
        before range and B within. A body that reaches range at St touches at St + A - T, and parts with e₀ of that, e₀
        the ``dry`` restitution. The law does the same with

            e = e₀ - (1 + e₀)(T - A - B)/(St - B),

        zero where the film stops the body first. This e grows with the speed. It is e₀ at the most, which faster
        impacts than expected reach, whose resolved film is thinner than the roughness.
        """
        braked, taken = braking(law, contacts, mass, self.film, self.loads), self.taken(contacts)

        def restitution_at(speed: FloatArray) -> FloatArray:
            within = braked.within(speed)
            left, unresolved = braked.per_speed * speed - within, np.maximum(taken - braked.outside - within, 0.0)
            share = np.divide(unresolved, left, out=np.ones_like(left), where=left > unresolved)
            return np.maximum(dry - (1.0 + dry) * share, 0.0)

        return restitution_at

    def taken(self, contacts: Contacts) -> FloatArray:
        """Loss T of the Stokes number in the whole film, down to the roughness, (m,) [1]."""
        return stokes_number_taken(contacts, replace(self.film, finest_cell=0.0), self.loads, self.roughness)
