"""Common part of the laws with a stiffness parameter: a law gives its formulas for ε = 1, and this divides by ε."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from operator import attrgetter
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, ValidationError, ValidatorFunctionWrapHandler, WrapValidator

from rigidfluid.core.contact.laws.loads import require_loads
from rigidfluid.core.contact.laws.work_to_stop import work_to_stop
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.latest import Latest
from rigidfluid.core.model.pair_formula import Formula, PairFormula
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Loads

AUTO: Literal["auto"] = "auto"
"""Value of ε in a scene that leaves it to the loads."""

_KEPT = 8
"""Number of choices of pairs whose work is kept: all in reach and those in range are asked about by turns."""

_columns = attrgetter(*(name for name in Contacts.__slots__ if name != "gap"))


def _one_complaint(value: object, validate: ValidatorFunctionWrapHandler) -> object:
    """Validate a value with one error message in place of one for each of its kinds."""
    try:
        return validate(value)
    except ValidationError:
        raise ValueError('a valid number greater than 0, or "auto"') from None


Epsilon = Annotated[Annotated[float, Field(gt=0)] | Literal["auto"], WrapValidator(_one_complaint)]


class RepulsionOptions(PartOptions):
    """Keys of a table that the laws with a stiffness parameter share.

    ``epsilon``: stiffness parameter ε; the smaller, the stiffer. ``epsilon_wall``: the same at walls.
    """

    epsilon: Epsilon = Field(
        description="Stiffness parameter ε; smaller is stiffer; `auto`: from the loads [length^p/force]"
    )
    epsilon_wall: Epsilon | None = Field(default=None, description="ε at walls; epsilon if not given [length^p/force]")


class Repulsion(ForceLaw):
    """Law F = F₁/ε n, U = U₁/ε, k = k₁/ε with the formulas of a law for ε = 1.

    ``auto`` sets ε = U₁(smallest_gap) / [E + W (range - smallest_gap)] for each contact, so that a head-on impact of
    the expected energy E, less the share of the film, on which the weight W still acts, ends at the smallest gap; it
    needs ``loads``, and raises SceneError if ε cannot be computed from them.
    """

    Options: ClassVar[type[PartOptions]] = RepulsionOptions
    options: RepulsionOptions

    def __init__(self, options: PartOptions, range: float, loads: Loads | None = None) -> None:
        super().__init__(options, range, loads)
        self._held: dict[tuple[bytes, ...], FloatArray] = {}
        self._latest = Latest[FloatArray]()
        if AUTO in (self.options.epsilon, self.options.epsilon_wall):
            self.loads = require_loads(loads, range)

    @abstractmethod
    def unit_force(self, contacts: Contacts) -> FloatArray:
        """Force F₁ along the normal, (m,) [force · ε]."""

    @abstractmethod
    def unit_energy(self, contacts: Contacts) -> FloatArray:
        """Energy U₁, (m,) [energy · ε]."""

    @abstractmethod
    def unit_stiffness(self, contacts: Contacts) -> FloatArray:
        """Stiffness k₁ = -dF₁/dgap, (m,) [force/length · ε]."""

    def force(self, contacts: Contacts) -> FloatArray:
        """Force F₁/ε along the normal on ``body_a``, (m, d) [force]."""
        return (self.unit_force(contacts) / self.epsilon(contacts))[:, None] * contacts.normal

    def energy(self, contacts: Contacts) -> FloatArray:
        """Energy U₁/ε, (m,) [energy]."""
        return self.unit_energy(contacts) / self.epsilon(contacts)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """Stiffness k₁/ε, (m,) [force/length]."""
        return self.unit_stiffness(contacts) / self.epsilon(contacts)

    def formula(self, function: Formula) -> PairFormula | None:
        """Formula of one contact by a ``function`` of range, ε and ε at walls; with ``auto`` both are each contact's
        own. None where ε depends on other laws too."""
        between, at_walls = self.options.epsilon, self.options.epsilon_wall
        if AUTO not in (between, at_walls):
            return PairFormula(function, np.array([self.range, between, between if at_walls is None else at_walls]))
        if self.loads is None or self.loads.attraction is not None:
            return None
        return PairFormula(function, np.zeros(3), each=self._each_parameters)

    def _each_parameters(self, contacts: Contacts) -> FloatArray:
        epsilon = self.epsilon(contacts)
        return np.column_stack([np.full_like(epsilon, self.range), epsilon, epsilon])

    def epsilon(self, contacts: Contacts) -> FloatArray:
        """Stiffness parameter ε of each contact, (m,) [length^p/force]; infinite with ``auto`` between two bodies of
        prescribed twist. It does not depend on the gap, and is kept for contacts that differ in that alone."""
        return self._latest.answer(_columns(contacts), lambda: self._each_epsilon(contacts))

    def _each_epsilon(self, contacts: Contacts) -> FloatArray:
        between, at_walls = self.options.epsilon, self.options.epsilon_wall
        if at_walls is None:
            return self._epsilon(between, contacts)
        return np.where(contacts.at_wall, self._epsilon(at_walls, contacts), self._epsilon(between, contacts))

    def closeness(self, contacts: Contacts) -> FloatArray:
        """Depth of each contact in the range w = max(range - gap, 0), (m,) [length]."""
        return np.maximum(self.range - contacts.gap, 0.0)

    def _epsilon(self, wanted: float | Literal["auto"], contacts: Contacts) -> FloatArray:
        if wanted != AUTO:
            return np.full(len(contacts), wanted)
        loads = require_loads(self.loads, self.range)
        held = self._work_to_stop(contacts, loads)
        stored = self.unit_energy(replace(contacts, gap=np.full(len(contacts), loads.smallest_gap)))
        epsilon = np.full(len(contacts), np.inf)
        np.divide(stored, held, out=epsilon, where=held > 0.0)
        return epsilon

    def _work_to_stop(self, contacts: Contacts, loads: Loads) -> FloatArray:
        """Work of impacts (m,) [energy], kept for the next questions: in substeps the same pairs are asked many times,
        and without attraction the work is that of the pair wherever it is."""
        if loads.attraction is not None:
            return work_to_stop(contacts, loads, self.range)
        pairs = tuple(
            column.tobytes() for column in (contacts.body_a, contacts.body_b, contacts.radius_a, contacts.radius_b)
        )
        if pairs not in self._held:
            if len(self._held) == _KEPT:
                self._held.clear()
            self._held[pairs] = work_to_stop(contacts, loads, self.range)
        return self._held[pairs]
