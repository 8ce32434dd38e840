"""What would make a law strong enough."""

from __future__ import annotations

from collections.abc import Mapping

from rigidfluid.checks.finding import at_least, at_most
from rigidfluid.core.contact.repulsion import AUTO, Repulsion
from rigidfluid.core.model.interfaces import ForceLaw


def stronger(law: ForceLaw, at_walls: bool, share: float) -> tuple[Mapping[str, float], str]:
    """How to make a law strong enough that gives only a ``share`` < 1 of what is needed.

    Parameters
    ----------
    law : ForceLaw
        The law; where it has a stiffness parameter ε, its force is proportional to 1/ε.
    at_walls : bool
        Whether it is too weak at walls, or between bodies.
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
    if not isinstance(law, Repulsion):
        return enough, f"Make the law {at_least(1.0 / share)} times as strong, or widen its range."
    given = law.options.epsilon_wall if at_walls and law.options.epsilon_wall else law.options.epsilon
    if given == AUTO:
        return enough, "Widen contact.range, or raise contact.smallest_gap."
    key = "epsilon_wall" if at_walls else "epsilon"
    enough[key] = float(given) * share
    return enough, f'Set contact.{key} to {at_most(enough[key])} or less, or to "auto".'
