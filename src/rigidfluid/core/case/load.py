"""Tables become a scene that the parts it names can run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigidfluid.core.case.auto_size import auto_size, auto_size_body
from rigidfluid.core.case.boundary_table_checks import check_surface_names
from rigidfluid.core.case.joint_kinds import read_drives
from rigidfluid.core.case.laws import scene_pair_forces
from rigidfluid.core.case.mechanisms import placed_mechanisms
from rigidfluid.core.case.part_tables import check_part_tables
from rigidfluid.core.case.remaining import remaining_tables
from rigidfluid.core.case.scene_model import model_of, names_used, scene_body, scene_domain, with_pairs
from rigidfluid.core.case.time_factor import read_time_tables
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.model.memory import told_memory
from rigidfluid.core.nested.placing import initial_pose
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.earlier import tables_now
from rigidfluid.core.scene.mesh_tables import AUTO
from rigidfluid.core.scene.overrides import override
from rigidfluid.core.scene.places import told_in_file
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.scene.toml_file import read_toml
from rigidfluid.core.scene.validation import read_table
from rigidfluid.core.setup.image_checks import crossable_lattice
from rigidfluid.core.setup.made_bodies import check_made_bodies, told_by_numbers
from rigidfluid.core.setup.placed_bodies import PlacedBodies
from rigidfluid.errors import ArgumentError, SceneError
from rigidfluid.registry import FLUID_BACKEND, Registry, missing_packages
from rigidfluid.regular_file import path_of

_ANY = 1.0
"""Edge length in tables from which no mesh is made [length]."""

if TYPE_CHECKING:
    from rigidfluid.core.seeding.seed import Occupied


def scene_from_dict(data: Mapping[str, Any]) -> Scene:
    """Validate the tables of a scene.

    Parameters
    ----------
    data : mapping
        The tables, as TOML gives them.

    Returns
    -------
    Scene
        With all defaults filled in.

    Raises
    ------
    SceneError
        If a key or value is not allowed, naming it, what is allowed and the remedy; SceneErrors if there are several.
    PluginError
        If it names a part that is not there.
    """
    if not isinstance(data, Mapping):
        raise ArgumentError("scene", describe(data), "tables, as a dict", "load_scene takes a scene file.")
    scene = scene_of_results(data)
    if missing_packages(model_of(scene).fluid.backend.part):
        Registry.load().get(FLUID_BACKEND, scene.fluid.backend)  # says what is missing
    return scene


@told_memory()
def scene_of_results(data: Mapping[str, Any]) -> Scene:
    """Scene of stored results, which may come from a place where other packages are installed.

    It is read like `scene_from_dict` does, but its backend may lack packages here, and then cannot run it.
    """
    data = _with_size(data)
    if not _has_seeds(data):
        return _sized(data)
    from rigidfluid.core.case.swarms import told_by_swarms, with_seeded_bodies  # few scenes have swarms

    tables = tables_now(data)
    scene = _tables(_with_any_size(tables))
    seeded = with_seeded_bodies(tables, scene.swarm, scene.scene.seed, _occupied(scene, Registry.load()))
    with told_by_swarms(tables, seeded):
        return _sized(seeded)


def _has_seeds(data: Mapping[str, Any]) -> bool:
    """Tell whether tables have a swarm that is not seeded yet."""
    swarms = data.get("swarm")
    return isinstance(swarms, list) and any(isinstance(one, Mapping) and "seeded" not in one for one in swarms)


def _occupied(scene: Scene, registry: Registry) -> Occupied:
    """The domain of a scene with the bodies that are there before all swarms; raises SceneError or PluginError."""
    from rigidfluid.core.seeding.placement import Others
    from rigidfluid.core.seeding.seed import Occupied

    with all_told() as ask:
        domain = ask(scene_domain, scene.domain, registry, scene.dimension)
        mechanisms = ask(placed_mechanisms, scene.mechanism, registry, scene.dimension)
        bodies = [ask(scene_body, table, f"body.{n}", registry, scene.dimension) for n, table in enumerate(scene.body)]
        forces = ask(scene_pair_forces, scene.contact, scene.interaction, registry)
    domain = with_pairs(domain.called(names_used(scene)), scene)
    placed = PlacedBodies(domain, tuple(bodies), mechanisms, registry).all_bodies
    shapes = tuple(body.shape for body in placed)
    lattice = domain.alone if forces else crossable_lattice(domain)
    return Occupied(domain, Others(shapes, initial_pose(placed, scene.dimension)), lattice, registry)


def _sized(data: Mapping[str, Any]) -> Scene:
    """Scene of tables, its cells at bodies as small as the flow demands where that is asked for."""
    if not _asks_for_size(data):
        return _checked(data)
    return _checked({**data, "mesh": {**data["mesh"], "size_body": auto_size_body(_checked(_with_any_size(data)))}})


def _with_size(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Tables with cells as large as the domain allows, where an accuracy is to refine them; raises SceneError without
    one."""
    mesh = data.get("mesh")
    if not isinstance(mesh, Mapping) or mesh.get("size") != AUTO:
        return data
    if mesh.get("accuracy") is None:
        raise SceneError("mesh.size", repr(AUTO), "a number above 0 without `accuracy`", "Add accuracy = 0.05.")
    scene = _tables(tables_now({**data, "mesh": {**mesh, "size": _ANY, "size_body": _ANY}}))
    size = auto_size(scene_domain(scene.domain, Registry.load(), scene.dimension))
    return {**data, "mesh": {"size_body": AUTO, **mesh, "size": size}}


def _asks_for_size(data: Mapping[str, Any]) -> bool:
    mesh = data.get("mesh")
    return isinstance(mesh, Mapping) and mesh.get("size_body") == AUTO


def _with_any_size(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Tables with coarse cells at bodies in place of such as the flow demands."""
    mesh = data.get("mesh")
    return {**data, "mesh": {**mesh, "size_body": mesh.get("size")}} if mesh and _asks_for_size(data) else data


def _checked(data: Mapping[str, Any]) -> Scene:
    tables = _tables(tables_now(data))
    with all_told() as ask:
        rows = {"boundary": ask(read_time_tables, tables.boundary), "joint": ask(read_drives, tables.joint)}
        if ask.errors:
            ask(_check_remaining, tables_now(data), ask.subjects, Registry.load())
    scene = tables.model_copy(update=rows)
    model_of(scene)
    return scene


def _tables(data: Mapping[str, Any]) -> Scene:
    """Tables of a scene; where one is refused, the parts that they name are asked too, and what the others say."""
    with all_told() as ask:
        scene = ask(read_table, Scene, data)
        if scene is None:
            ask(check_part_tables, data, Registry.load())
            ask(_check_remaining, data, ask.subjects, Registry.load())
    return scene


def _check_remaining(data: Mapping[str, Any], refused: Sequence[str], registry: Registry) -> None:
    """Raise SceneError or PluginError for wrong names of surfaces, and wrong names and places of bodies, in tables that
    hold none of the ``refused`` values."""
    tables, kept = remaining_tables(data, refused)
    with told_by_numbers(kept), all_told() as ask:
        scene = read_table(Scene, tables)
        domain = ask(scene_domain, scene.domain, registry, scene.dimension)
        mechanisms = ask(placed_mechanisms, scene.mechanism, registry, scene.dimension)
        bodies = [ask(scene_body, table, f"body.{n}", registry, scene.dimension) for n, table in enumerate(scene.body)]
        if domain is not None:
            ask(check_surface_names, scene.boundary, domain)
        if domain is not None and not any(table.type == "periodic" for table in scene.boundary):
            ask(check_made_bodies, domain, bodies, mechanisms or (), registry)


def load_scene(path: str | Path, overrides: Iterable[str] = ()) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    path : str or Path
        A TOML file.
    overrides : iterable of str
        Values to set before validation, as ``contact.range=0.02`` or ``body.0.density=1.5``.

    Returns
    -------
    Scene
        Validated, with all defaults filled in.

    Raises
    ------
    SceneError
        If the file cannot be read or is not named by a path, is no TOML, or says something that is not allowed, and in
        which line; SceneErrors if there are several such things.
    PluginError
        If it names a part that is not there.
    """
    file = path_of("path", path, "a path", "Give a scene file; scene_from_dict takes tables.")
    assignments = _assignments(overrides)
    data = read_toml(file)
    with told_in_file(file, assignments):
        override(data, assignments)
        return scene_from_dict(data)


def _assignments(overrides: Iterable[str]) -> tuple[str, ...]:
    """The assignments as texts; raises ArgumentError where they are none."""
    try:
        given = None if isinstance(overrides, str) else tuple(overrides)
    except TypeError:
        given = None
    if given is None or not all(isinstance(one, str) for one in given):
        allowed = "several texts such as 'contact.range=0.02'"
        raise ArgumentError("overrides", describe(overrides), allowed, "Give them in a list.")
    return given
