"""Refusal of laws that must not act together."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, combinations
from typing import TYPE_CHECKING

from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.contact.laws.rough_film import RoughFilm
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.wrapped_law import bare, layer
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.geometry.wall import Wall
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.setup.model import ContactStepping


def check_interactions(
    interactions: Sequence[Interaction], stepping: ContactStepping, bodies: Sequence[Body], walls: Sequence[Wall]
) -> None:
    """Refuse, with SceneError, laws that would hold the same displacement along surfaces, count a film twice or need
    substeps, and those with an option that the shapes of their ``bodies`` or ``walls`` do not allow."""
    _check_sticking(interactions)
    _check_sliding(interactions, stepping)
    _check_films(interactions)
    for interaction in interactions:
        if interaction.law.round_option:
            _check_round(interaction, bodies, walls)


def _check_round(interaction: Interaction, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
    """Refuse the option of a law for surfaces of known curvature where it meets others."""
    law, option = interaction.law, interaction.law.round_option
    known = {wall.surface for wall in walls if wall.shape.radius is not None}
    known |= {number for number, body in enumerate(bodies) if _has_known_curvature(body, law)}
    if not known.issuperset(_surfaces_met(interaction, len(bodies), walls)):
        value = getattr(law, option) if hasattr(law, option) else getattr(law.options, option)
        given, off = ("true", "false") if value is True else (value, "0")
        others, allowed = "that are neither round nor flat", "balls, and flat or round walls"
        if law.curved:
            others, allowed = "of unknown curvature", "balls, ellipses and ellipsoids, and flat or round walls"
        found = f"{given} for {bare(law).name!r} with surfaces {others}"
        remedy = f"Set it to {off}, or keep the law to other contacts by `between` or `names`."
        raise SceneError(f"{interaction.field}.{option}", found, allowed, remedy)


def _has_known_curvature(body: Body, law: ForceLaw) -> bool:
    return body.radius is not None or (law.curved and body.semi_axes is not None)


def _surfaces_met(interaction: Interaction, bodies: int, walls: Sequence[Wall]) -> tuple[int, ...]:
    """Surfaces in whose contacts an interaction acts, with this number of ``bodies``."""
    own, every_wall = tuple(chain(*interaction.surfaces)), tuple(wall.surface for wall in walls)
    if len(interaction.surfaces) == 2:
        return own
    if own and own[0] >= bodies:
        return (*range(bodies), *own)
    if interaction.surfaces and interaction.between == "walls":
        return own + every_wall
    return tuple(range(bodies)) + (() if interaction.between == "pairs" else every_wall)


def _check_sticking(interactions: Sequence[Interaction]) -> None:
    """Refuse two laws with springs along the surfaces in one contact."""
    sticking = [interaction for interaction in interactions if interaction.law.sticking]
    for one, other in combinations(sticking, 2):
        if _may_meet(one, other):
            found, allowed = f"a spring along surfaces that {one.field} has one along too", "one such law in a contact"
            remedy = "Keep them to different contacts by `between` or `names`."
            raise SceneError(f"{other.field}.friction", found, allowed, remedy)


def _check_sliding(interactions: Sequence[Interaction], stepping: ContactStepping) -> None:
    """Refuse in implicit steps what resists sliding beside springs, whose friction would bound both together there."""
    if not stepping.implicit:
        return
    for one in (each for each in interactions if each.law.sticking):
        for other in (each for each in interactions if _slides(each.law)):
            if _may_meet(one, other):
                found = f"{other.law.name!r} that resists sliding where {one.field} has a spring along surfaces"
                remedy = "Leave contact.stepping out, or keep them to different contacts by `between` or `names`."
                key = "friction" if other.law.friction > 0.0 else "law"
                raise SceneError(f"{other.field}.{key}", found, "one such law in a contact in implicit steps", remedy)


def _slides(law: ForceLaw) -> bool:
    return not law.sticking and (law.friction > 0.0 or (law.film and law.couples))


def _check_films(interactions: Sequence[Interaction]) -> None:
    """Refuse the law of a film where surfaces have a roughness, down to which their own law counts the film."""
    rough = [each for each in interactions if _is_rough(each.law)]
    for film in (each for each in interactions if each.law.film):
        for one in rough:
            if _may_meet(one, film):
                found, allowed = f"{film.law.name!r} where {one.field} has a roughness", "a film that is counted once"
                remedy = "Remove either, or keep them to different contacts by `between` or `names`."
                raise SceneError(f"{film.field}.law", found, allowed, remedy)


def _is_rough(law: ForceLaw) -> bool:
    restitution = layer(Restitution, law)
    return restitution is not None and isinstance(restitution.loss, RoughFilm)


def _may_meet(one: Interaction, other: Interaction) -> bool:
    """Tell whether there may be contacts in which both act."""
    alike = one.between == other.between or "all" in (one.between, other.between)
    (first, second), theirs = ((*each.surfaces, None, None)[:2] for each in (one, other))
    return alike and any(_share(first, a) and _share(second, b) for a, b in (theirs, theirs[::-1]))


def _share(group: tuple[int, ...] | None, other: tuple[int, ...] | None) -> bool:
    """Tell whether two groups of surfaces share one; None is of all."""
    return group is None or other is None or not set(group).isdisjoint(other)
