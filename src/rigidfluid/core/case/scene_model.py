"""A scene becomes a model: its tables in the place of which the parts that they name are put."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache, singledispatch
from typing import NamedTuple

from rigidfluid.core.case.boundary import condition_makers
from rigidfluid.core.case.boundary_table_checks import check_boundary_tables
from rigidfluid.core.case.contact_table_checks import check_contact_table, check_numbered_names
from rigidfluid.core.case.fluid import scene_fluid
from rigidfluid.core.case.joint_kinds import scene_joints
from rigidfluid.core.case.laws import scene_laws, scene_pair_forces
from rigidfluid.core.case.mechanisms import placed_mechanisms
from rigidfluid.core.case.periodic import periodic_pairs
from rigidfluid.core.case.table_values import values_of
from rigidfluid.core.contact.path.detector_choice import choose_detector
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import Part
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.nested.part_options import build_part, own_options, read_options, refuse_unread
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.body_tables import BodyTable
from rigidfluid.core.scene.contact_tables import ContactTable
from rigidfluid.core.scene.domain_table import DomainTable
from rigidfluid.core.scene.mesh_tables import AUTO
from rigidfluid.core.scene.scalar_table import ScalarTable
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.components import component_bodies
from rigidfluid.core.setup.contact_laws import ContactLaw, told_apart
from rigidfluid.core.setup.fluid import Fluid, NoFluid
from rigidfluid.core.setup.made_bodies import check_made_bodies
from rigidfluid.core.setup.model import ContactStepping, Model
from rigidfluid.core.setup.pair_forces import PairForce
from rigidfluid.core.setup.rigid_body import JoinedBodies, PlacedMechanism, RigidBody
from rigidfluid.errors import ArgumentError, SceneError
from rigidfluid.registry import BODY, DETECTOR, DOMAIN, Registry

Case = Scene | Model
"""A scene, or a model that was made of objects."""


@singledispatch
def model_of(case: Case) -> Model:
    """The model that a scene describes; a model is its own.

    Raises PluginError if a part is missing, SceneError for what is unknown, missing or not allowed.
    """
    raise ArgumentError("case", repr(case), "a Scene or a Model", "Read a file with load_scene first.")


@model_of.register
def _itself(case: Model) -> Model:
    return case


@model_of.register
def _latest(case: Scene) -> Model:
    return _kept(_ThisScene(case))


class _ThisScene:
    """A scene as a key: an equal one may have been read where other plug-ins were installed."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def __hash__(self) -> int:
        return id(self.scene)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ThisScene) and self.scene is other.scene


@lru_cache(maxsize=1)
def _kept(this: _ThisScene) -> Model:
    """Model of a scene, the latest of which is kept: a scene is loaded, and then run, checked or reported."""
    return _model(this.scene, Registry.load())


def _model(scene: Scene, registry: Registry) -> Model:
    with all_told() as ask:
        ask(check_contact_table, scene.contact, scene.interaction)
        names = [table.name for table in scene.body], [table.name for table in scene.source]
        ask(check_numbered_names, scene.interaction, *names)
        domain = ask(scene_domain, scene.domain, registry, scene.dimension)
        if domain is not None:
            domain = domain.called(names_used(scene))
            domain = ask(with_pairs, domain, scene) or domain
        mechanisms = ask(placed_mechanisms, scene.mechanism, registry, scene.dimension)
        bodies = tuple(
            ask(scene_body, table, f"body.{n}", registry, scene.dimension) for n, table in enumerate(scene.body)
        )
        fluid = ask(scene_fluid, scene.fluid, scene.mesh, registry, scene.dimension)
        laws = ask(scene_laws, scene.contact, scene.interaction, registry)
        pair_forces = ask(scene_pair_forces, scene.contact, scene.interaction, registry)
        joints = ask(scene_joints, scene.joint, registry, scene.dimension)
        model = (
            None
            if ask.errors
            else ask(_compose, scene, registry, _Parts(domain, bodies, mechanisms, fluid, laws, pair_forces, joints))
        )
        if ask.errors and domain is not None:
            ask(check_made_bodies, domain, bodies, mechanisms or (), registry)
    assert model is not None
    return model


class _Parts(NamedTuple):
    """Objects of a model that the tables of a scene describe."""

    domain: Domain
    bodies: tuple[RigidBody, ...]
    mechanisms: tuple[PlacedMechanism, ...]
    fluid: Fluid | NoFluid
    laws: Sequence[ContactLaw]
    pair_forces: Sequence[PairForce]
    joints: tuple[JoinedBodies, ...]


def _compose(scene: Scene, registry: Registry, parts: _Parts) -> Model:
    domain, bodies, mechanisms, fluid, laws, pair_forces, joints = parts
    if scene.scalar is not None:
        fluid = _with_scalar(fluid, scene.scalar, domain, (*bodies, *component_bodies(mechanisms, scene.dimension)))
    shapes = [body.shape for body in bodies] + [one.shape for each in mechanisms for one in each.mechanism.components]
    detector, why = _detector(scene.contact, registry, (shapes, domain), fluid.backend.part.wet, laws)
    model = Model(
        domain=domain,
        bodies=bodies,
        time=scene.time,
        fluid=fluid,
        gravity=scene.fluid.gravity,
        boundary=condition_makers(scene.boundary, domain),
        mechanisms=mechanisms,
        joints=joints,
        laws=told_apart(laws, domain.pieces),
        pair_forces=tuple(pair_forces),
        detector=detector,
        stepping=ContactStepping(
            scene.contact.substeps, scene.contact.stepping == "implicit", scene.contact.impact_speed
        ),
        window=scene.domain.window,
        output=scene.output,
        name=scene.name,
        seed=scene.scene.seed,
        registry=registry,
    )
    told = model.told_by(scene, why)
    if scene.source or scene.sink:
        from rigidfluid.core.case.exchange_checks import check_exchange  # few scenes have any

        check_exchange(told)
    return told


def _with_scalar(fluid: Fluid | NoFluid, table: ScalarTable, domain: Domain, bodies: Sequence[RigidBody]) -> Fluid:
    """The fluid with the scalar that it carries along; raises SceneError where there is none to do so."""
    from rigidfluid.core.case.scalar import scene_scalar  # few scenes have one

    if isinstance(fluid, NoFluid):
        found = f"one with backend {fluid.backend.part.name!r}"
        raise SceneError("scalar", found, "a backend with a fluid", "Choose backend = 'scikit-fem'.")
    names = [body.name for body in bodies]
    return replace(fluid, scalar=scene_scalar(table, domain, names))


def names_used(scene: Scene) -> set[str]:
    """Names of surfaces in the scene's tables."""
    return {table.on for table in scene.boundary} | {name for table in scene.interaction for name in table.names or ()}


def scene_domain(table: DomainTable, registry: Registry, dimension: int) -> Domain:
    """The domain of a scene, without pairs of periodic surfaces; raises SceneError or PluginError."""
    part = registry.get(DOMAIN, table.type)
    return part(read_options(part, table.options, type(table).model_fields, "domain"), dimension)


def with_pairs(domain: Domain, scene: Scene) -> Domain:
    """The domain with the scene's pairs of periodic surfaces; raises SceneError for what is wrong with its tables."""
    check_boundary_tables(scene.boundary, domain, scene.time.end)
    return domain.with_periodic(periodic_pairs(scene.boundary, domain))


def scene_body(table: BodyTable, at: str, registry: Registry, dimension: int) -> RigidBody:
    """The body of a table at a place in the scene; raises SceneError or PluginError."""
    shape = build_part(BODY, table, at, registry, dimension)
    return RigidBody(shape=shape, **values_of(table, RigidBody, "shape"))


def _detector(
    table: ContactTable,
    registry: Registry,
    around: tuple[Sequence[Body], Domain],
    wet: bool,
    laws: Sequence[ContactLaw],
) -> tuple[Selected[Detector], str]:
    """The detector that a scene names, or the cheapest that is exact for shapes in a domain; and why it is this one."""
    if table.detector == AUTO:
        shapes, domain = around
        part, why = choose_detector(shapes, domain.pieces, wet and bool(laws), registry)
    else:
        part, why = registry.get(DETECTOR, table.detector), "the scene names it"
    readers: list[type[Part]] = [part, laws[0].law.part] if table.law else [part]
    hint = "" if table.law else "Name the law that reads it: `law = …`."
    refuse_unread(table.options, readers, type(table).model_fields, "contact", hint)
    return Selected(part, own_options(part, table.options, "contact")), why
