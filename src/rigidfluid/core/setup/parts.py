"""The parts that a scene names: their classes, and the keys of the scene's tables that are theirs."""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rigidfluid.core.contact.detection import detection_by
from rigidfluid.core.contact.detector_choice import choose_detector, exact_detector
from rigidfluid.core.mesh.size_interface import SizeField
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.interfaces import Body, Detector, FluidBackend, ForceLaw, Mechanism, Part, PartOptions
from rigidfluid.core.scene.scene import InteractionTable
from rigidfluid.core.scene.validation import fields_by_key, read_table, unknown_key
from rigidfluid.core.setup.along_strokes import refuse_overlap_along
from rigidfluid.core.setup.body_sizes import refuse_lost_body
from rigidfluid.core.setup.interactions import LawTable, has_own_restitution, law_tables
from rigidfluid.core.setup.mechanisms import append_components
from rigidfluid.core.setup.periodic import periodic_pairs
from rigidfluid.core.setup.quick_strokes import refuse_quick_mechanisms
from rigidfluid.errors import SceneError
from rigidfluid.registry import BODY, DETECTOR, DOMAIN, FLUID_BACKEND, FORCE_LAW, SIZE_FIELD, Registry

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import ContactTable, FluidTable, Scene, SizeFieldTable

P = TypeVar("P", bound=Part)

AUTO = "auto"
"""Value of `contact.detector` that leaves the choice to `choose_detector`."""

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
    size_fields: tuple[SizeField, ...]

    @property
    def wet(self) -> bool:
        """Whether there is a fluid around the bodies, on a mesh."""
        return self.backend.part.wet


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
    wet = backend.part.wet
    tables = law_tables(scene)
    laws = [registry.get(FORCE_LAW, table.law, f"{table.at}.law") for table in tables]
    detector, why = _detector(scene.contact, registry, bodies, domain, wet and bool(laws))
    _refuse_detector(detector, wet)
    _refuse_contact_keys(scene.contact, detector, laws)
    chosen = tuple(_law(table, law, scene, bodies) for table, law in zip(tables, laws, strict=True))
    exact = exact_detector(bodies, domain.pieces, registry)
    refuse_quick_mechanisms(mechanisms, scene.time)
    refuse_overlap_along(mechanisms, scene.time.end, exact)
    found = Selected(detector, _options(detector, scene.contact.options, "contact"))
    fields = _size_fields(scene, registry)
    return Parts(scene, backend, domain, bodies, mechanisms, found, chosen, why, exact, fields)


def known_parts(scene: Scene) -> Parts:
    """Parts of a scene by `select_plugins`, selected and built on the first call, and kept as long as this very object:
    an equal scene may have been read where other plug-ins were installed."""
    if id(scene) not in _KNOWN:
        _KNOWN[id(scene)] = select_plugins(scene.model_copy())  # itself it would live for ever
        weakref.finalize(scene, _KNOWN.pop, id(scene))
    return _KNOWN[id(scene)]


def _domain(scene: Scene, registry: Registry) -> Domain:
    table = scene.domain
    part = registry.get(DOMAIN, table.type)
    _refuse_unread(table.options, [part], type(table).model_fields, "domain")
    domain = part(read_table(part.Options, table.options, "domain"), scene.dimension)
    return domain.with_periodic(periodic_pairs(scene, domain))


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


def _size_fields(scene: Scene, registry: Registry) -> tuple[SizeField, ...]:
    tables = () if scene.mesh is None else scene.mesh.field
    return tuple(_size_field(table, f"mesh.field.{n}", registry, scene.dimension) for n, table in enumerate(tables))


def _size_field(table: SizeFieldTable, at: str, registry: Registry, dimension: int) -> SizeField:
    part = registry.get(SIZE_FIELD, table.type, f"{at}.type")
    _refuse_unread(table.options, [part], type(table).model_fields, at)
    options = read_table(part.Options, table.options, at)
    try:
        return part(options, dimension)
    except SceneError as error:  # a field does not know its number
        subject = f"{at}.{error.subject.removeprefix('mesh.field.')}"
        raise SceneError(subject, error.found, error.allowed, error.remedy) from None


def _backend(table: FluidTable, registry: Registry) -> Selected[FluidBackend]:
    part = registry.find(FLUID_BACKEND, table.backend)  # whoever reads results needs no more than its class
    _refuse_unread(table.options, [part], type(table).model_fields, "fluid")
    return Selected(part, read_table(part.Options, table.options, "fluid"))


def _detector(
    table: ContactTable, registry: Registry, bodies: Sequence[Body], domain: Domain, mesh: bool
) -> tuple[type[Detector], str]:
    if table.detector != AUTO:
        return registry.get(DETECTOR, table.detector), "the scene names it"
    detector, why = choose_detector(bodies, domain.pieces, mesh, registry)
    return detector, f"chosen as {why}"


def _refuse_detector(detector: type[Detector], mesh: bool) -> None:
    if detection_by(detector).on_mesh and not mesh:
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
