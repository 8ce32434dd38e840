"""What would make a law strong enough."""

from __future__ import annotations

from collections.abc import Mapping

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import at_least, at_most
from rigidfluid.core.contact.repulsion import AUTO, Repulsion
from rigidfluid.core.contact.restitution import without_restitution


def stronger(met: DesignContacts, share: float) -> tuple[Mapping[str, float], str]:
    """How to make laws strong enough that give only a ``share`` < 1 of what is needed.

    Parameters
    ----------
    met : DesignContacts
        Where they are too weak; a law with a stiffness parameter ε has a force proportional to 1/ε.
    share : float
        What it gives over what is needed [1].

    Returns
    -------
    mapping, str
        What would be enough: ``strength``, how many times as strong [1], and the parameter where it is known; and
        the remedy in words.
    """
    if share <= 0.0:
        return {}, "Take a law that repels up to contact."
    enough = {"strength": 1.0 / share}
    repelling = [interaction for interaction in met.interactions if interaction.law.conservative]
    if len(repelling) > 1:
        fields = " and ".join(interaction.field for interaction in repelling)
        return enough, f"Make the laws of {fields} {at_least(1.0 / share)} times as strong, or widen their ranges."
    law, field = without_restitution(repelling[0].law), repelling[0].field
    if not isinstance(law, Repulsion):
        return enough, f"Make the law {at_least(1.0 / share)} times as strong, or widen its range."
    given = law.options.epsilon_wall if met.at_walls and law.options.epsilon_wall else law.options.epsilon
    if given == AUTO:
        return enough, f"Widen {field}.range, or raise {field}.smallest_gap."
    key = "epsilon_wall" if met.at_walls else "epsilon"
    enough[key] = float(given) * share
    return enough, f'Set {field}.{key} to {at_most(enough[key])} or less, or to "auto".'
