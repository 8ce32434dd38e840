"""Changes of parameters that make a law strong enough."""

from __future__ import annotations

from collections.abc import Mapping

from rigidfluid.checks.design_contacts import DesignContacts, RepresentativeContacts
from rigidfluid.checks.finding import round_down, round_up
from rigidfluid.core.contact.laws.repulsion import AUTO, Repulsion
from rigidfluid.core.model.wrapped_law import bare


def strength_remedy(design: DesignContacts | RepresentativeContacts, share: float) -> tuple[Mapping[str, float], str]:
    """Parameter change for laws that supply the fraction ``share`` < 1 of what is required: ``strength``, the factor on
    the law [1], with the parameter where it is known (a force ∝ 1/ε has ε · share), and the remedy in words."""
    if share <= 0.0:
        return {}, "Take a law that repels up to contact."
    enough = {"strength": 1.0 / share}
    repelling = [interaction for interaction in design.interactions if interaction.law.keeps_apart]
    if len(repelling) > 1:
        fields = " and ".join(interaction.field for interaction in repelling)
        return enough, f"Make the laws of {fields} {round_up(1.0 / share)} times as strong, or widen their ranges."
    law, field = bare(repelling[0].law), repelling[0].field
    if not isinstance(law, Repulsion):
        return enough, f"Make the law {round_up(1.0 / share)} times as strong, or widen its range."
    given = law.options.epsilon_wall if design.at_walls and law.options.epsilon_wall else law.options.epsilon
    if given == AUTO:
        return enough, f"Widen {field}.range, or raise {field}.smallest_gap."
    key = "epsilon_wall" if design.at_walls else "epsilon"
    enough[key] = float(given) * share
    return enough, f'Set {field}.{key} to {round_down(enough[key])} or less, or to "auto".'
