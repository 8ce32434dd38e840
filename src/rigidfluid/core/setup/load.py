"""Tables become a scene that the parts it names can run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from rigidfluid.core.scene.earlier import tables_now
from rigidfluid.core.scene.overrides import override
from rigidfluid.core.scene.scene import AUTO, Scene, read_toml
from rigidfluid.core.scene.validation import read_table
from rigidfluid.core.setup.auto_size import auto_size_body
from rigidfluid.core.setup.boundary_checks import check_boundary
from rigidfluid.core.setup.interactions import check_interactions
from rigidfluid.core.setup.joint_checks import check_joints
from rigidfluid.core.setup.joint_kinds import read_drives
from rigidfluid.core.setup.parts import known_parts
from rigidfluid.core.setup.scene_checks import check_fluid, check_tables
from rigidfluid.core.setup.time_factor import read_time_tables
from rigidfluid.registry import FLUID_BACKEND, Registry, missing_packages


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
        If a key or value is not allowed, naming it, what is allowed and the remedy.
    PluginError
        If it names a part that is not there.
    """
    scene = scene_of_results(data)
    if missing_packages(known_parts(scene).backend.part):
        Registry.load().get(FLUID_BACKEND, scene.fluid.backend)  # says what is missing
    return scene


def scene_of_results(data: Mapping[str, Any]) -> Scene:
    """Scene of stored results, which may come from a place where other packages are installed.

    It is read like `scene_from_dict` does, but its backend may lack packages here, and then cannot run it.
    """
    mesh = data.get("mesh")
    if not isinstance(mesh, Mapping) or mesh.get("size_body") != AUTO:
        return _checked(data)
    coarse = _checked({**data, "mesh": {**mesh, "size_body": mesh.get("size")}})
    return _checked({**data, "mesh": {**mesh, "size_body": auto_size_body(coarse)}})


def _checked(data: Mapping[str, Any]) -> Scene:
    scene = read_drives(read_time_tables(read_table(Scene, tables_now(data))))
    check_tables(scene)
    parts = known_parts(scene)
    check_boundary(parts.scene, parts.domain)
    check_interactions(parts.scene, parts.domain)
    check_joints(parts.scene)
    check_fluid(parts)
    return scene


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
        If the file cannot be read, is no TOML, or says something that is not allowed.
    PluginError
        If it names a part that is not there.
    """
    data = read_toml(Path(path))
    override(data, overrides)
    return scene_from_dict(data)
