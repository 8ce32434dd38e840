"""A scene's mechanisms: found and built, and their components as bodies of the scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.model.interfaces import Component, Mechanism
from rigidfluid.core.model.types import FloatArray
from rigidfluid.core.nested.placing import initial_pose, initial_twist
from rigidfluid.core.scene.scene import BodyTable, Scene
from rigidfluid.core.scene.validation import fields_by_key, read_table, table_of, unknown_key
from rigidfluid.errors import PluginError, SceneError
from rigidfluid.registry import MECHANISM, Registry

_ROUNDING = 1e-9


def append_components(scene: Scene, registry: Registry | None = None) -> tuple[Scene, dict[str, Mechanism]]:
    """Append the components of its mechanisms to a scene's bodies, and return it with the mechanisms by name.

    A component is a body named after mechanism and component, ``dumbbell.left``. Raises PluginError for a mechanism
    that is missing or invalid, SceneError for a refused option or a name that is taken.
    """
    if not scene.mechanism:
        return scene, {}
    registry = registry or Registry.load()
    built = [_built(scene, registry, number) for number in range(len(scene.mechanism))]
    _refuse_doubles(scene, built)
    mechanisms = dict(zip((table.name for table in scene.mechanism), built, strict=True))
    bodies = (*scene.body, *_component_tables(scene, mechanisms))
    return scene.model_copy(update={"body": bodies}), mechanisms


def _built(scene: Scene, registry: Registry, number: int) -> Mechanism:
    table, at = scene.mechanism[number], f"mechanism.{number}"
    part = registry.get(MECHANISM, table.type, f"{at}.type")
    known = fields_by_key(part.Options)
    for key in table.options:
        if key not in known:
            raise unknown_key(f"{at}.{key}", {*known, *type(table).model_fields})
    options = read_table(part.Options, table.options, at)
    try:
        mechanism = part(options, scene.dimension)
        mechanism.components  # noqa: B018  it may be there that it refuses its options
    except (SceneError, PluginError) as error:  # a mechanism does not know its number
        subject = f"{at}.{error.subject.partition('.')[2]}"
        raise type(error)(subject, error.found, error.allowed, error.remedy) from None
    _refuse_components(mechanism, at)
    _refuse_placement(mechanism, at)
    return mechanism


def _refuse_components(mechanism: Mechanism, at: str) -> None:
    """Names and densities that cannot be are an error of the mechanism's author."""
    names = [component.name for component in mechanism.components]
    densities = [component.density for component in mechanism.components]
    if not names or len(set(names)) < len(names):
        raise _plugin_error(at, f"components named {names}", "components, each with a name of its own")
    if not all(0.0 < density < np.inf for density in densities):
        raise _plugin_error(at, f"components of densities {densities}", "numbers above 0")


def _refuse_placement(mechanism: Mechanism, at: str) -> None:
    """Raise PluginError for a placement of a wrong shape, and for a rate of components that are not driven."""
    count, d = len(mechanism.components), mechanism.dimension
    k, q = (1, 1) if d == 2 else (3, 4)
    pose, rate = mechanism.placement(0.0), mechanism.rate(0.0)
    for name, values, width in (
        ("placement(0).position", pose.position, d),
        ("placement(0).orientation", pose.orientation, q),
        ("rate(0).velocity", rate.velocity, d),
        ("rate(0).angular_velocity", rate.angular_velocity, k),
    ):
        if np.shape(values) != (count, width) or not np.isfinite(values).all():
            allowed = f"finite numbers of shape {(count, width)}, a row for each component"
            raise _plugin_error(at, f"{name} of shape {np.shape(values)}", allowed)
    if d == 3 and np.abs(np.linalg.norm(pose.orientation, axis=1) - 1.0).max() > _ROUNDING:
        raise _plugin_error(at, f"quaternions {pose.orientation.tolist()}", "quaternions of length 1")
    if not mechanism.driven and (rate.velocity.any() or rate.angular_velocity.any()):
        raise _plugin_error(at, "a rate of what is not driven", "`driven = True` beside `rate`")


def _plugin_error(at: str, found: str, allowed: str) -> PluginError:
    return PluginError(at, found, allowed, "Mend the mechanism; MechanismContract in rigidfluid.testing shows more.")


def _component_tables(scene: Scene, mechanisms: Mapping[str, Mechanism]) -> list[BodyTable]:
    """Tables of the components where they are at the start, as if each were a body."""
    owners = [(name, part) for name, mechanism in mechanisms.items() for part in mechanism.components]
    mass = np.array([part.density * part.shape.volume for _, part in owners])
    inertia = mass[:, None, None] * np.array([part.shape.unit_inertia for _, part in owners])
    pose, twist = initial_pose(scene.mechanism, scene.dimension), initial_twist(scene.mechanism, scene.dimension)
    carried = CarriedBodies(mechanisms, mass, inertia, np.zeros(len(mass), dtype=bool), pose, twist)
    poses, twists = carried.poses(pose, 0.0), carried.kinematics(pose, 0.0).component_twist(twist)
    rows = zip(*map(_rows, (poses.position, poses.orientation, twists.velocity, twists.angular_velocity)), strict=True)
    turned = "angle" if scene.dimension == 2 else "orientation"
    return [
        BodyTable(
            name=_component_name(name, part),
            type=part.shape.name,
            density=part.density,
            position=position,
            velocity=velocity,
            angular_velocity=spin,
            part_of=name,
            **{turned: orientation[0] if scene.dimension == 2 else orientation},
            **table_of(part.shape.options),
        )
        for (name, part), (position, orientation, velocity, spin) in zip(owners, rows, strict=True)
    ]


def _rows(values: FloatArray) -> list[tuple[Any, ...]]:
    return [tuple(row) for row in values.tolist()]


def _component_name(mechanism: str, component: Component) -> str:
    return f"{mechanism}.{component.name}"


def _refuse_doubles(scene: Scene, mechanisms: Sequence[Mechanism]) -> None:
    names = [table.name for table in scene.body]
    names += [table.name for table in scene.mechanism]
    for table, mechanism in zip(scene.mechanism, mechanisms, strict=True):
        names += [_component_name(table.name, component) for component in mechanism.components]
    for name, count in Counter(names).items():
        if count > 1:
            raise SceneError(
                "mechanism.name", repr(name), "a name that no other body, component or mechanism has", "Rename it."
            )
