"""Refusal of laws that must not act together."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.contact.laws.rough_film import RoughFilm
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import ContactStepping


def check_interactions(interactions: Sequence[Interaction], stepping: ContactStepping) -> None:
    """Refuse, with SceneError, laws that would hold the same displacement along surfaces, or count a film twice."""
    _check_sticking(interactions, stepping)
    _check_films(interactions)


def _check_sticking(interactions: Sequence[Interaction], stepping: ContactStepping) -> None:
    """Refuse two laws with springs along the surfaces in one contact, and such a law in implicit steps."""
    sticking = [interaction for interaction in interactions if interaction.law.sticking]
    for one, other in combinations(sticking, 2):
        if _may_meet(one, other):
            found, allowed = f"a spring along surfaces that {one.field} has one along too", "one such law in a contact"
            remedy = "Keep them to different contacts by `between` or `names`."
            raise SceneError(f"{other.field}.law", found, allowed, remedy)
    if sticking and stepping.implicit:
        found, allowed = "'implicit' with springs along the surfaces", "'substeps'"
        raise SceneError("contact.stepping", found, allowed, "Leave it out, or remove `tangential_stiffness`.")


def _check_films(interactions: Sequence[Interaction]) -> None:
    """Refuse the law of a film where surfaces have a roughness, down to which their own law counts the film."""
    rough = [
        each for each in interactions if isinstance(each.law, Restitution) and isinstance(each.law.loss, RoughFilm)
    ]
    for film in (each for each in interactions if each.law.film):
        for one in rough:
            if _may_meet(one, film):
                found, allowed = f"{film.law.name!r} where {one.field} has a roughness", "a film that is counted once"
                remedy = "Remove either, or keep them to different contacts by `between` or `names`."
                raise SceneError(f"{film.field}.law", found, allowed, remedy)


def _may_meet(one: Interaction, other: Interaction) -> bool:
    """Tell whether there may be contacts in which both act."""
    alike = one.between == other.between or "all" in (one.between, other.between)
    return alike and len({*one.surfaces, *other.surfaces}) <= 2
