"""Obstacles of a scene: bodies of any type that stay where they are and belong to the domain's boundary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.model.surface import Surface
from rigidfluid.core.model.types import Pose
from rigidfluid.core.model.wall import Wall
from rigidfluid.core.setup.nested_bodies import NestedBodyTable, build_shape, tables_by_name
from rigidfluid.core.setup.placing import initial_pose
from rigidfluid.domains.placed import PlacedBody
from rigidfluid.errors import SceneError
from rigidfluid.registry import DETECTOR, Registry

AT = "domain.obstacle"
"""Where obstacles stand in a scene."""


def placed_obstacles(tables: Sequence[NestedBodyTable], dimension: int) -> dict[str, PlacedBody]:
    """The obstacles by their names.

    Parameters
    ----------
    tables : sequence of NestedBodyTable
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
    return {
        name: PlacedBody(build_shape(table, f"{AT}.{number}", dimension), initial_pose([table], dimension))
        for number, (name, table) in enumerate(tables_by_name(tables, AT).items())
    }


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
