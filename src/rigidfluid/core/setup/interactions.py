"""The list of interactions that a scene gives: a law in `[contact]`, and one in each `[[interaction]]`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from rigidfluid.core.contact.film_loss import FilmLoss
from rigidfluid.core.contact.restitution import Restitution
from rigidfluid.core.model.interactions import Between, Interaction
from rigidfluid.core.model.interfaces import ForceLaw
from rigidfluid.core.model.types import Loads
from rigidfluid.core.setup.boundary_tables import tables_of_walls
from rigidfluid.errors import SceneError
from rigidfluid.registry import suggestion

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.scene.scene import Scene
    from rigidfluid.core.setup.parts import Parts, Selected

SMALLEST_GAP = 0.25
"""The smallest gap wanted over the range of the law, if the scene gives none."""


class LawTable(NamedTuple):
    """Keys of a table that names a ``law``; ``at`` is its place in the scene, ``options`` are the keys of its part."""

    at: str
    law: str
    range: float
    smallest_gap: float | None
    restitution: float | None
    restitution_stokes: float | None
    between: Between
    names: tuple[str, ...]
    options: Mapping[str, Any]


def law_tables(scene: Scene) -> tuple[LawTable, ...]:
    """All tables that name a law, `[contact]` first; its options are the detector's too."""
    contact, found = scene.contact, []
    if contact.law is not None and contact.range is not None:
        own = contact.smallest_gap, contact.restitution, contact.restitution_stokes
        found.append(LawTable("contact", contact.law, contact.range, *own, "all", (), contact.options))
    for number, table in enumerate(scene.interaction):
        at, names = f"interaction.{number}", table.names or ()
        own = table.smallest_gap, table.restitution, table.restitution_stokes
        found.append(LawTable(at, table.law, table.range, *own, table.between, names, table.options))
    return tuple(found)


def check_interactions(scene: Scene, domain: Domain) -> None:
    """Refuse, with SceneError, tables of laws that act nowhere, or whose smallest gap is not below their range."""
    for table in law_tables(scene):
        if table.smallest_gap is not None and table.smallest_gap >= table.range:
            allowed = f"a length above 0 and below {table.at}.range = {table.range}"
            raise SceneError(f"{table.at}.smallest_gap", table.smallest_gap, allowed, "Shorten it, or widen the range.")
        _check_names(scene, domain, table)


def build_interactions(scene: Scene, parts: Parts, surfaces: Sequence[str], loads: Loads) -> tuple[Interaction, ...]:
    """Laws, each with the contacts that it acts in, in the order of the tables; ``surfaces`` are the names of bodies
    and then of faces. Raises SceneError if a law refuses its options or loads."""
    return tuple(
        Interaction(
            field=table.at,
            law=_law(table, selected, loads),
            between=table.between,
            surfaces=tuple(surfaces.index(name) for name in table.names),
            smallest_gap=table.smallest_gap,
        )
        for table, selected in zip(law_tables(scene), parts.laws, strict=True)
    )


def _law(table: LawTable, selected: Selected[ForceLaw], loads: Loads) -> ForceLaw:
    own = replace(loads, smallest_gap=table.smallest_gap or SMALLEST_GAP * table.range)
    try:
        law = selected.part(selected.options, table.range, own)
        if table.restitution_stokes is None and (
            table.restitution in (None, 1.0) or has_own_restitution(selected.part)
        ):
            return law
        return Restitution(law, table.restitution or 1.0, _film_loss(table, selected.part, own))
    except SceneError as error:  # a law does not know its table
        subject = f"{table.at}.{error.subject.removeprefix('contact.')}"
        allowed = (error.allowed or "").replace("contact.range", f"{table.at}.range") or None
        raise SceneError(subject, error.found, allowed, error.remedy) from None


def has_own_restitution(law: type[ForceLaw]) -> bool:
    """Whether the restitution is an option of the law itself."""
    return "restitution" in law.Options.model_fields


def _film_loss(table: LawTable, law: type[ForceLaw], loads: Loads) -> FilmLoss | None:
    if table.restitution_stokes is None:
        return None
    given = f"{table.at}.restitution_stokes", table.restitution_stokes
    if has_own_restitution(law):
        allowed = f"a law whose restitution is not its own, as it is with {law.name!r}"
        raise SceneError(*given, allowed, "Remove it, or choose another law.")
    if loads.film is None:
        allowed = "a fluid with a viscosity, which the Stokes number of an impact is made of"
        raise SceneError(*given, allowed, "Remove it, or choose a backend with a fluid.")
    return FilmLoss(table.restitution_stokes, loads.film, loads)


def _check_names(scene: Scene, domain: Domain, table: LawTable) -> None:
    bodies, walls = [body.name for body in scene.body], _walls(scene, domain)
    for number, name in enumerate(table.names):
        if name not in (*bodies, *walls):
            raise _unknown(domain, f"{table.at}.names.{number}", name, [*bodies, *walls])
    at_walls = any(name in walls for name in table.names)
    pair = len(table.names) == 2
    if pair and (len(set(table.names)) == 1 or all(name in walls for name in table.names)):
        raise _nowhere(table, "two different surfaces, one of them a body")
    if (at_walls and table.between == "pairs") or (pair and not at_walls and table.between == "walls"):
        raise _nowhere(table, f"surfaces that meet with between = {table.between!r}")
    wholes = [scene.body[bodies.index(name)].part_of for name in table.names if name in bodies]
    if pair and len(wholes) == 2 and wholes[0] is not None and wholes[0] == wholes[1]:
        raise _nowhere(table, "bodies that are not parts of one articulated body, which do not touch")


def _walls(scene: Scene, domain: Domain) -> list[str]:
    return [place.piece.name for _, place in tables_of_walls(scene, domain)]


def _unknown(domain: Domain, field: str, name: str, known: Sequence[str]) -> SceneError:
    open_face = "a surface that is no wall, and does not repel" if name in domain.names else "no surface"
    shown = ", ".join(known[:20]) + (", …" if len(known) > 20 else "")
    remedy = suggestion(name, known) or "Name a body or a wall."
    return SceneError(field, f"{name!r}, {open_face}", f"one of {shown}", remedy)


def _nowhere(table: LawTable, allowed: str) -> SceneError:
    return SceneError(f"{table.at}.names", list(table.names), allowed, "Correct the names, or `between`.")
