"""Restitution of a law in a fluid: the loss of the whole impact less the share of the resolved film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.laws.stokes_number import stokes_number, stokes_number_taken
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Film, Loads

_PARTS = 12
"""Number of parts of the way from range to contact over which the film's share is summed."""

REBOUND = 10.0
"""The Stokes number below which balls were not seen to rebound."""

_MAY_FALL = 0.5
"""With a lower dry restitution e never falls with the speed: a faster impact would end slower, and so have no one speed
at range for each state."""

_LEAST_TAKEN = 1e-9
"""Least part of β that a film takes: below it 1/A - 1 in the marginal Stokes number has no digits left."""


class Braking(NamedTuple):
    """Loss of an impact's Stokes number in the resolved film [1]: ``outside`` (m,) before the law's range is reached,
    and ``within`` it on the way in, (m,) over the speed at range; ``per_speed`` (m,) St/v [time/length]."""

    per_speed: FloatArray
    outside: FloatArray
    within: Callable[[FloatArray], FloatArray]


def braking(law: ForceLaw, contacts: Contacts, mass: FloatArray, film: Film, loads: Loads) -> Braking:
    """Loss of the Stokes number in the film where the law turns bodies of the effective ``mass`` (m,) [mass]: within
    range the film acts at v √(1 - 2U/(m v²)), U the law's energy."""
    edges = law.range * np.linspace(1.0, 0.0, _PARTS + 1)
    middles = 0.5 * (edges[1:] + edges[:-1])
    taken = np.array([stokes_number_taken(contacts, film, loads, gap) for gap in edges[:-1]])
    stored = np.array([law.energy(replace(contacts, gap=np.full(len(contacts), gap))) for gap in middles[:-1]])

    def within(speed: FloatArray) -> FloatArray:
        left = np.sqrt(np.clip(1.0 - 2.0 * stored / (mass * speed**2), 0.0, 1.0))
        return np.asarray(np.sum(np.diff(taken, axis=0) * left, axis=0))

    return Braking(stokes_number(contacts, film, loads), taken[0], within)


@dataclass(frozen=True, slots=True)
class FilmLoss:
    """Loss of impacts in a fluid: e falls as exp(-β/St) with the ``decay`` β [1], whether the mesh resolves the
    ``film`` or not; ``loads`` has the masses."""

    decay: float
    film: Film
    loads: Loads

    @property
    def words(self) -> str:
        """Words after those for the dry restitution."""
        return f" · exp(-{self.decay:g}/St)"

    def whole(self, dry: float, contacts: Contacts, stokes: FloatArray) -> FloatArray:
        """Restitution of whole impacts, the film included, at Stokes numbers (m,) at its edge, (m,) [1]."""
        return np.asarray(dry * np.exp(-self.decay / stokes))

    def restitution(
        self, dry: float, law: ForceLaw, contacts: Contacts, mass: FloatArray
    ) -> Callable[[FloatArray], FloatArray]:
        """Restitution (m,) [1] of the law alone over the speed v (m,) at range [length/time].

        The film takes A of St before range, and B within it on the way in; on the way out it takes both again. A body
        that reaches range at St has thus come with St + A, and comes back with e₀ exp(-β/(St + A)) of that where

            e = [e₀ exp(-β/(St + A)) (St + A) + A + B]/(St - B),

        e₀ the ``dry`` one. This e is least at one speed, and more in slower impacts, of which the film takes more than
        the formula: there the law gives back what the film takes on the way out, all at the most. Up to twice REBOUND,
        where next to nothing is to come back, e keeps its least value, so that the body stays near, and goes from one
        to the other up to three times REBOUND. With ``dry`` below _MAY_FALL all slower impacts have the least value.
        """
        braked = braking(law, contacts, mass, self.film, self.loads)

        def restitution_at(speed: FloatArray) -> FloatArray:
            both, stokes = braked.outside + braked.within(speed), braked.per_speed * speed + braked.outside
            least = self._left_to_law(dry, np.maximum(stokes, self._marginal(dry, both)), both)
            if dry < _MAY_FALL:
                return least
            wanted = np.maximum(self._left_to_law(dry, stokes, both), least)
            return np.asarray(least + np.clip(stokes / REBOUND - 2.0, 0.0, 1.0) * (wanted - least))

        return restitution_at

    def _left_to_law(self, dry: float, stokes: FloatArray, taken: FloatArray) -> FloatArray:
        """e of the formula (m,) at St (m,) before the film, which takes ``taken`` (m,) each way, at most one."""
        left = stokes - taken
        given = dry * np.exp(-self.decay / stokes) * stokes + taken
        return np.asarray(np.divide(np.minimum(given, left), left, out=np.ones_like(left), where=left > 0.0))

    def _marginal(self, dry: float, taken: FloatArray) -> FloatArray:
        """Stokes number St (m,) at which e is least where the film takes ``taken`` (m,) of it: with s = β/St and a =
        taken/β,

            exp(s)/e₀ + s = 1/a - 1.
        """
        from scipy.special import wrightomega

        known = self.decay / np.maximum(taken, _LEAST_TAKEN * self.decay) - 1.0
        ratio = known - wrightomega(known - np.log(dry)).real
        return np.asarray(self.decay / np.maximum(ratio, _LEAST_TAKEN))
