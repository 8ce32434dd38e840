"""A law with springs along the surfaces of balls, as a compiled loop evaluates it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.laws.friction import Friction
from rigidfluid.core.contact.laws.hunt_crossley import excess_per_share
from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.pair_formula import PairFormula, PairSprings, own_formula
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.model.wrapped_law import WrappedLaw, bare, layer
from rigidfluid.errors import PluginError

Cubics = tuple[FloatArray, FloatArray, FloatArray]


class BallLaw(NamedTuple):
    """The ``formula`` of a bare law, and what is around it.

    ``springs``: stiffness k_t, μ, μ_r and μ_o; zero where their dashpot is not bounded by itself, else one; the factor
    on √(m k_t) in the coefficient of the dashpot; gap and factor on the formula's force there, which is k_t where that
    is not a number. ``excess``: cubics of a restitution's excess per share, without any if there is none, see
    `PiecewiseCubic`.
    """

    formula: PairFormula
    springs: tuple[float, ...]
    excess: Cubics

    def parameters(self, contacts: Contacts) -> FloatArray:
        """Parameters of the formula in each contact, (m, p), or in all, (1, p); raises PluginError if others are
        given."""
        formula = self.formula
        if formula.each is None:
            return formula.parameters[None]
        rows = np.ascontiguousarray(formula.each(contacts), dtype=np.float64)
        if rows.ndim != 2 or len(rows) != len(contacts):
            subject = f"formula {formula.function.__module__}.{formula.function.__qualname__}"
            remedy = "Give a row of parameters for each contact in PairFormula.each, or None for pair_formula."
            raise PluginError(subject, f"parameters of shape {rows.shape}", f"shape ({len(contacts)}, p)", remedy)
        return rows


def ball_law(law: ForceLaw) -> BallLaw | None:
    """Law of balls with springs along their surfaces, None where it has none or no formula for them."""
    formula = own_formula(bare(law))
    if formula is None or not law.sticking or not _has_known_layers(law):
        return None
    friction, restitution = layer(Friction, law), layer(Restitution, law)
    if friction is not None and bare(law).dissipative:
        return None  # dampers of its own along the surfaces are no part of those beside the springs
    springs = _numbers(formula.springs) if friction is None else friction.ball_springs()
    return None if springs is None else BallLaw(formula, springs, _cubics(restitution))


def _has_known_layers(law: ForceLaw) -> bool:
    """Tell whether nothing is around the bare law but friction, and a restitution that is its own."""
    while isinstance(law, WrappedLaw):
        if type(law) not in (Friction, Restitution) or (isinstance(law, Restitution) and law.loss is not None):
            return False
        law = law.law
    return True


def _numbers(springs: PairSprings | None) -> tuple[float, ...] | None:
    if springs is None:
        return None
    frictions = springs.friction, springs.rolling, springs.twisting
    return (springs.stiffness, *frictions, float(springs.bounded), 0.0, 0.0, 0.0)


def _cubics(restitution: Restitution | None) -> Cubics:
    if restitution is None:
        return np.zeros(0), np.zeros(0), np.zeros((0, 4))
    cubic = excess_per_share(restitution.restitution)
    return cubic.inner, cubic.starts, cubic.terms
