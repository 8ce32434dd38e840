"""Row of each kind of pair that may touch: its impact, film, law and friction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from math import comb

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts, design_contacts
from rigidfluid.checks.film import resolved_gap
from rigidfluid.checks.rebound import given_back
from rigidfluid.core.contact.laws.film_loss import FilmLoss
from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.contact.laws.rough_film import RoughFilm
from rigidfluid.core.contact.laws.stokes_number import stokes_number
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.model.wrapped_law import bare, layer
from rigidfluid.core.scene.mesh_tables import MeshTable


@dataclass(frozen=True)
class PairRow:
    """Fastest impact expected of one kind of pair, ``names``, of which there are ``count``.

    ``laws`` act from the gap ``range`` on; the mesh resolves the film down to the gap ``resolved``, and the surfaces
    touch at their ``roughness`` [length], None where there is none. ``speed`` of the approach [length/time], its
    ``stokes_number`` [1], None without a fluid that has inertia. ``friction``: its regime, in words. ``restitution``:
    of a dry impact, and ``rebound`` of one in the fluid, as its Stokes number lets it be expected [1], None where the
    laws do not say it.
    """

    names: tuple[str, str]
    count: int
    laws: tuple[str, ...]
    speed: float
    stokes_number: float | None
    resolved: float | None
    range: float
    roughness: float | None
    friction: str
    restitution: float | None
    rebound: float | None


def pair_rows(system: System, mesh: MeshTable | None) -> Iterator[PairRow]:
    """Rows of all kinds of pairs in which a law repels, walls first."""
    for design in design_contacts(system):
        for row in design.worst(design.speed):
            yield _pair_row(design, mesh, row)


def _pair_row(design: DesignContacts, mesh: MeshTable | None, row: int) -> PairRow:
    laws = [interaction.law for interaction in design.interactions]
    dry, losses = _dry_restitution(laws), _losses(laws)
    stokes = _stokes_number(design, row)
    return PairRow(
        names=design.names(row),
        count=_alike(design, row),
        laws=tuple(bare(law).name for law in laws),
        speed=float(design.speed[row]),
        stokes_number=stokes,
        resolved=_resolved(design, mesh, row),
        range=design.law.range,
        roughness=next((loss.roughness for loss in losses if isinstance(loss, RoughFilm)), None),
        friction=_friction(laws),
        restitution=dry,
        rebound=dry if design.system.loads.film is None else _rebound(design, laws, row, dry, stokes),
    )


def _stokes_number(design: DesignContacts, row: int) -> float | None:
    film = design.system.loads.film
    if film is None or not film.inertia or design.inverse_mass[row] == 0.0:
        return None
    return float(design.speed[row] * stokes_number(_only(design, row), film, design.system.loads)[0])


def _resolved(design: DesignContacts, mesh: MeshTable | None, row: int) -> float | None:
    """Gap down to which the mesh resolves the film; None without one, or where its curvature is not known [length]."""
    if mesh is None or design.system.loads.film is None:
        return None
    gap = float(resolved_gap(mesh, design.effective_radius())[row])
    return gap if np.isfinite(gap) else None


def _dry_restitution(laws: list[ForceLaw]) -> float | None:
    """Restitution on which all laws that repel agree [1]."""
    found = {_own_restitution(law) for law in laws if law.keeps_apart}
    return found.pop() if len(found) == 1 else None


def _losses(laws: list[ForceLaw]) -> list[FilmLoss | RoughFilm]:
    """Losses of impacts in the film that laws know of."""
    restitutions = [layer(Restitution, law) for law in laws]
    return [each.loss for each in restitutions if each is not None and each.loss is not None]


def _own_restitution(law: ForceLaw) -> float | None:
    if restitution := layer(Restitution, law):
        return restitution.restitution
    law = bare(law)
    if law.dissipative:
        given: float | None = getattr(law.options, "restitution", None)
        return given
    return 1.0


def _friction(laws: list[ForceLaw]) -> str:
    """Regime of friction: none, sliding alone, or static and sliding."""
    rubbing = [law for law in laws if law.friction > 0.0]
    if not rubbing:
        return "none"
    sticks = any(law.sticking for law in rubbing)
    return f"{'static and sliding' if sticks else 'sliding'}, μ {sum(law.friction for law in rubbing):g}"


def _rebound(
    design: DesignContacts, laws: list[ForceLaw], row: int, dry: float | None, stokes: float | None
) -> float | None:
    """Restitution to be expected in the fluid [1]: by the loss that a law has, or by the resolved film alone; None
    where a law of films or dampers of a law's own take more."""
    film = design.system.loads.film
    if film is None or stokes is None or not stokes > 0.0 or dry is None:
        return None
    losses = _losses(laws)
    if len(losses) == len([law for law in laws if law.keeps_apart]) == 1:
        return float(losses[0].whole(dry, _only(design, row), np.array([stokes]))[0])
    if design.law.dissipative:
        return None
    return float(given_back(design, film, np.full(len(design.contacts), stokes))[row])


def _only(design: DesignContacts, row: int) -> Contacts:
    return select(design.contacts, np.array([row]))


def _alike(design: DesignContacts, row: int) -> int:
    """Number of pairs of the kind of this one; a body counts once at all walls."""
    sizes, first = Counter(design.kind.values()), design.kind[int(design.contacts.body_a[row])]
    if design.at_walls:
        return sizes[first]
    second = design.kind[int(design.contacts.body_b[row])]
    return comb(sizes[first], 2) if first == second else sizes[first] * sizes[second]
