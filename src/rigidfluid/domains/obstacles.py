"""Obstacles of a scene: bodies of any type that stay where they are and belong to the domain's boundary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydantic import ConfigDict, Field

from rigidfluid.core.model.interfaces import PartOptions
from rigidfluid.core.model.surface import Surface
from rigidfluid.core.model.types import Pose
from rigidfluid.core.model.wall import Wall
from rigidfluid.core.scene.scene import PRINTABLE, InitialAngle, InitialOrientation, Vector
from rigidfluid.core.scene.validation import read_table, unknown_key
from rigidfluid.core.setup.placing import check_orientation, initial_pose
from rigidfluid.domains.placed import PlacedBody
from rigidfluid.errors import SceneError
from rigidfluid.registry import BODY, DETECTOR, Registry

AT = "domain.obstacle"
"""Where obstacles stand in a scene."""


class ObstacleTable(PartOptions):
    """A body that stays where it is; beside these keys it has those of its type."""

    model_config = ConfigDict(extra="allow")

    name: str = Field(
        default="",
        pattern=PRINTABLE,
        description="Name of its surface; `obstacle0`, `obstacle1`, … if not given",
    )
    type: str = Field(description="Name of a body type")
    position: Vector = Field(description="Position of the centre of mass [length]")
    angle: InitialAngle = None
    orientation: InitialOrientation = None


def placed_obstacles(tables: Sequence[ObstacleTable], dimension: int) -> dict[str, PlacedBody]:
    """The obstacles by their names.

    Parameters
    ----------
    tables : sequence of ObstacleTable
        As they stand in the scene.
    dimension : int
        2 or 3.

    Returns
    -------
    dict of str to PlacedBody
        In the scene's order.

    Raises
    ------
    SceneError
        If a name comes twice, a key is unknown, a vector has a wrong length, or the shape cannot be.
    PluginError
        If there is no such body type.
    """
    found: dict[str, PlacedBody] = {}
    for number, table in enumerate(tables):
        name = table.name or f"obstacle{number}"
        if name in found:
            remedy = "Rename one of them."
            raise SceneError(f"{AT}.{number}.name", f"{name!r} for the second time", "a name of its own", remedy)
        found[name] = _placed(table, f"{AT}.{number}", dimension)
    return found


def refuse_overlap(obstacles: dict[str, PlacedBody], surfaces: dict[str, Surface]) -> None:
    """Raise SceneError for obstacles that touch each other or one of the ``surfaces`` around them."""
    if not obstacles:
        return
    shapes = [obstacle.shape for obstacle in obstacles.values()]
    poses = [obstacle.pose for obstacle in obstacles.values()]
    pose = Pose(np.concatenate([one.position for one in poses]), np.concatenate([one.orientation for one in poses]))
    walls = [Wall(len(shapes) + i, name, surface) for i, (name, surface) in enumerate(surfaces.items())]
    balls = all(shape.radius is not None for shape in shapes)
    detector = Registry.load().get(DETECTOR, "sphere" if balls else "brute_force")
    contacts = detector(detector.Options(), shapes, walls).detect(pose, None, 0.0)
    if len(contacts):
        names = [*obstacles, *surfaces]
        worst = int(np.argmin(contacts.gap))
        a, b = (int(numbers[worst]) for numbers in (contacts.body_a, contacts.body_b))
        place, depth = poses[a].position[0].tolist(), abs(contacts.gap[worst])
        raise SceneError(
            f"{AT}.{a}.position",
            f"{place}, where {names[a]!r} overlaps {names[b]!r} by {depth:.6g}",
            "a place inside the domain and clear of all other surfaces",
            "Move it, or make it smaller.",
        )


def _placed(table: ObstacleTable, at: str, dimension: int) -> PlacedBody:
    if len(table.position) != dimension:
        found, remedy = (
            f"{list(table.position)}, {len(table.position)} of them",
            f"The scene has {dimension} dimensions.",
        )
        raise SceneError(f"{at}.position", found, f"{dimension} numbers", remedy)
    check_orientation(table, dimension, at)
    part, options = Registry.load().get(BODY, table.type, f"{at}.type"), dict(table.model_extra or {})
    for key in options:
        if key not in part.Options.model_fields:
            raise unknown_key(f"{at}.{key}", {*part.Options.model_fields, *type(table).model_fields})
    try:
        shape = part(read_table(part.Options, options, at), dimension)
    except SceneError as error:  # a body does not know its place in the scene
        subject = error.subject if error.subject.startswith(at) else f"{at}.{error.subject.removeprefix('body.')}"
        raise SceneError(subject, error.found, error.allowed, error.remedy) from None
    return PlacedBody(shape, initial_pose([table], dimension))
