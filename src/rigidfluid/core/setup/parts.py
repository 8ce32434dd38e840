"""The parts that a scene names: their classes, and the keys of the scene's tables that are theirs."""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rigidfluid.core.model.domain import Domain, Piece
from rigidfluid.core.model.facet_surface import FacetSurface
from rigidfluid.core.model.interfaces import Body, Detector, FluidBackend, ForceLaw, Mechanism, Part, PartOptions
from rigidfluid.core.model.wall import is_round, radius_of
from rigidfluid.core.scene.scene import InteractionTable
from rigidfluid.core.scene.validation import fields_by_key, read_table, unknown_key
from rigidfluid.core.setup.along_strokes import refuse_overlap_along
from rigidfluid.core.setup.body_sizes import refuse_lost_body
from rigidfluid.core.setup.interactions import LawTable, has_own_restitution, law_tables
from rigidfluid.core.setup.mechanisms import append_components
from rigidfluid.core.setup.periodic import periodic_pairs
from rigidfluid.core.setup.quick_strokes import refuse_quick_mechanisms
from rigidfluid.errors import SceneError
from rigidfluid.registry import BODY, DETECTOR, DOMAIN, FLUID_BACKEND, FORCE_LAW, Registry

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import ContactTable, FluidTable, Scene

P = TypeVar("P", bound=Part)

AUTO = "auto"
"""Value of `contact.detector` that leaves the choice to `cheapest_detector`."""


_ROUNDING = 1e-6
"""Relative tolerance of the area of a whole circle or sphere [1]."""

_KNOWN: dict[int, Parts] = {}
"""Parts of the scenes in memory, by the scenes' `id`."""


@dataclass(frozen=True)
class Selected(Generic[P]):
    """A class that a scene names, and its validated options."""

    part: type[P]
    options: PartOptions


@dataclass(frozen=True)
class Parts:
    """All that a scene names; ``laws`` are those of its `law_tables`, in their order.

    ``scene`` has the components of its ``mechanisms``, by name, after its own bodies; ``bodies`` are of both.
    ``detector_why`` says who chose the detector, and for what reason; ``exact_detector`` is the cheapest that is exact
    without a mesh.
    """

    scene: Scene
    backend: Selected[FluidBackend]
    domain: Domain
    bodies: tuple[Body, ...]
    mechanisms: Mapping[str, Mechanism]
    detector: Selected[Detector]
    laws: tuple[Selected[ForceLaw], ...]
    detector_why: str
    exact_detector: type[Detector]


def select_plugins(scene: Scene) -> Parts:
    """Find the parts that a scene names, validate their options, and build its bodies and domain, on whose shapes the
    default detector depends.

    Raises PluginError if a part is missing, SceneError for an option that is unknown, missing or not allowed.
    """
    registry = Registry.load()
    domain = _domain(scene, registry)
    scene, mechanisms = append_components(scene, registry)
    bodies = tuple(_body(scene, registry, number) for number in range(len(scene.body)))
    backend = _backend(scene.fluid, registry)
    mesh = backend.part.needs_mesh
    tables = law_tables(scene)
    laws = [registry.get(FORCE_LAW, table.law, f"{table.at}.law") for table in tables]
    detector, why = _detector(scene.contact, registry, bodies, domain, mesh and bool(laws))
    _refuse_detector(detector, mesh)
    _refuse_contact_keys(scene.contact, detector, laws)
    chosen = tuple(_law(table, law, scene, bodies) for table, law in zip(tables, laws, strict=True))
    exact = exact_detector(bodies, domain, registry)
    refuse_quick_mechanisms(mechanisms, scene.time)
    refuse_overlap_along(mechanisms, scene.time.end, exact)
    found = Selected(detector, _options(detector, scene.contact.options, "contact"))
    return Parts(scene, backend, domain, bodies, mechanisms, found, chosen, why, exact)


def known_parts(scene: Scene) -> Parts:
    """Parts of a scene by `select_plugins`, selected and built on the first call, and kept as long as this very object:
    an equal scene may have been read where other plug-ins were installed."""
    if id(scene) not in _KNOWN:
        _KNOWN[id(scene)] = select_plugins(scene.model_copy())  # itself it would live for ever
        weakref.finalize(scene, _KNOWN.pop, id(scene))
    return _KNOWN[id(scene)]


def cheapest_detector(bodies: Sequence[Body], domain: Domain, mesh: bool) -> tuple[str, str]:
    """Name of the cheapest detector that is exact for these bodies between these surfaces, and the reason; ``mesh`` is
    whether a mesh surrounds them and no gap beyond the range of a law matters.

    ``sphere`` serves balls alone; ``ellipsoid`` balls, ellipses and ellipsoids where all walls are flat, round bumps or
    whole round hollows; ``facets`` also polygons and polyhedra, and walls of facets; else ``narrow_band``, exact to the
    facets, on a mesh, and ``brute_force`` without.
    """
    if all(body.radius is not None for body in bodies):
        return "sphere", "all bodies are balls"
    reason = "not all bodies are ellipsoids"
    if all(body.semi_axes is not None for body in bodies):
        if all(piece.shape.plane or _is_whole(piece) for piece in domain.pieces):
            return "ellipsoid", "all bodies are balls or ellipsoids"
        reason = "not all bodies are balls and not all walls are flat or round"
    elif all(body.semi_axes is not None or body.facets is not None for body in bodies):
        long = any(body.semi_axes is not None and body.radius is None for body in bodies)
        if all(_meets_facets(piece, long) for piece in domain.pieces):
            return "facets", "all bodies are balls, ellipsoids or made of facets"
        reason = "not all bodies are balls and a wall is neither flat nor round nor made of facets"
    if mesh:
        return "narrow_band", f"{reason}, and there is a mesh and a law"
    return "brute_force", f"{reason}, and there is no mesh or no law"


def _meets_facets(piece: Piece, long: bool) -> bool:
    """Whether the detector of facets takes a piece; ``long``: some bodies are ellipsoids that are no balls."""
    if isinstance(piece.shape, FacetSurface) or piece.shape.plane:
        return True
    return _is_whole(piece) if long else is_round(piece.shape)


def _is_whole(piece: Piece) -> bool:
    """Whether a piece is round, and a hollow has no end that bodies could meet."""
    if not is_round(piece.shape):
        return False
    radius, dimension = radius_of(piece.shape), len(piece.shape.bounds[0])
    whole = 2.0 * pi * abs(radius) if dimension == 2 else 4.0 * pi * radius**2
    return radius > 0 or piece.area > (1.0 - _ROUNDING) * whole


def exact_detector(bodies: Sequence[Body], domain: Domain, registry: Registry) -> type[Detector]:
    """The cheapest detector that is exact for these bodies between these surfaces and needs no mesh."""
    return registry.get(DETECTOR, cheapest_detector(bodies, domain, mesh=False)[0])


def _domain(scene: Scene, registry: Registry) -> Domain:
    table = scene.domain
    part = registry.get(DOMAIN, table.type)
    _refuse_unread(table.options, [part], type(table).model_fields, "domain")
    domain = part(read_table(part.Options, table.options, "domain"), scene.dimension)
    domain.periodic = periodic_pairs(scene, domain)
    return domain


def _body(scene: Scene, registry: Registry, number: int) -> Body:
    table, at = scene.body[number], f"body.{number}"
    part = registry.get(BODY, table.type, f"{at}.type")
    _refuse_unread(table.options, [part], type(table).model_fields, at)
    options = read_table(part.Options, table.options, at)
    try:
        body = part(options, scene.dimension)
    except SceneError as error:  # a body does not know its number
        subject = f"{at}.{error.subject.removeprefix('body.')}"
        raise SceneError(subject, error.found, error.allowed, error.remedy) from None
    refuse_lost_body(body, at)
    return body


def _backend(table: FluidTable, registry: Registry) -> Selected[FluidBackend]:
    part = registry.find(FLUID_BACKEND, table.backend)  # whoever reads results needs no more than its class
    _refuse_unread(table.options, [part], type(table).model_fields, "fluid")
    return Selected(part, read_table(part.Options, table.options, "fluid"))


def _detector(
    table: ContactTable, registry: Registry, bodies: Sequence[Body], domain: Domain, mesh: bool
) -> tuple[type[Detector], str]:
    if table.detector != AUTO:
        return registry.get(DETECTOR, table.detector), "the scene names it"
    name, why = cheapest_detector(bodies, domain, mesh)
    return registry.get(DETECTOR, name), f"chosen as {why}"


def _refuse_detector(detector: type[Detector], mesh: bool) -> None:
    if detector.needs_mesh and not mesh:
        remedy = 'Use detector = "auto", or a backend with a mesh.'
        raise SceneError("contact.detector", f"{detector.name!r} without a mesh", "a detector that needs none", remedy)


def _refuse_contact_keys(table: ContactTable, detector: type[Detector], laws: Sequence[type[ForceLaw]]) -> None:
    """Refuse keys of `[contact]` that neither its detector nor its law reads; the law is the first of ``laws``, if the
    table names one."""
    readers: list[type[Part]] = [detector, laws[0]] if table.law else [detector]
    hint = "" if table.law else "Name the law that reads it: `law = …`."
    _refuse_unread(table.options, readers, type(table).model_fields, "contact", hint)


def _law(table: LawTable, law: type[ForceLaw], scene: Scene, bodies: Sequence[Body]) -> Selected[ForceLaw]:
    if table.at != "contact":
        _refuse_unread(table.options, [law], InteractionTable.model_fields, table.at)
    named = [body for body, given in zip(bodies, scene.body, strict=True) if given.name in table.names]
    met = named if len(table.names) == 2 else bodies
    if law.balls_only and any(body.radius is None for body in met):
        remedy = "Choose another law; `rigidfluid plugins` lists what is installed."
        found = f"{law.name!r} with bodies that are no balls"
        raise SceneError(f"{table.at}.law", found, "a law for any shape", remedy)
    if law.film and any(body.semi_axes is None for body in met):
        remedy = "Keep it to other contacts by `between` or `names`, or choose another law."
        found = f"{law.name!r} with bodies of unknown curvature"
        raise SceneError(f"{table.at}.law", found, "balls, ellipses and ellipsoids", remedy)
    own = {"restitution": table.restitution} if has_own_restitution(law) and table.restitution is not None else {}
    return Selected(law, _options(law, {**table.options, **own}, table.at))


def _options(part: type[Part], given: Mapping[str, Any], at: str) -> PartOptions:
    """The part's own of the keys given."""
    own = fields_by_key(part.Options)
    return read_table(part.Options, {key: given[key] for key in given if key in own}, at)


def _refuse_unread(
    options: Mapping[str, Any], readers: Sequence[type[Part]], common: Mapping[str, Any], at: str, hint: str = ""
) -> None:
    known = set().union(*(fields_by_key(reader.Options) for reader in readers))
    for key in options:
        if key not in known:
            raise unknown_key(f"{at}.{key}", known | set(common), hint)
