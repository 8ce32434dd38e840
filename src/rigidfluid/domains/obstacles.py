"""Obstacles of a scene: bodies of any type that stay where they are and belong to the domain's boundary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.model.piece import Piece
from rigidfluid.core.model.types import Pose
from rigidfluid.core.model.wall import Wall
from rigidfluid.core.setup.detector_choice import exact_detector
from rigidfluid.core.setup.nested_bodies import NestedBodyTable, build_shape, tables_by_name
from rigidfluid.core.setup.placing import initial_pose
from rigidfluid.domains.placed import PlacedBody
from rigidfluid.errors import SceneError
from rigidfluid.registry import Registry

AT = "domain.obstacle"
"""Place of obstacles in a scene, for messages."""


def placed_obstacles(tables: Sequence[NestedBodyTable], dimension: int) -> dict[str, PlacedBody]:
    """Obstacles by their names, in the scene's order.

    Raises SceneError if a name comes twice, a key is unknown, a vector has a wrong length, or the shape cannot be, and
    PluginError if there is no such body type.
    """
    return {
        name: PlacedBody(build_shape(table, f"{AT}.{number}", dimension), initial_pose([table], dimension))
        for number, (name, table) in enumerate(tables_by_name(tables, AT).items())
    }


def refuse_overlap(obstacles: dict[str, PlacedBody], pieces: Sequence[Piece]) -> None:
    """Raise SceneError for obstacles that touch each other or one of the ``pieces`` around them."""
    if not obstacles:
        return
    shapes = [obstacle.shape for obstacle in obstacles.values()]
    poses = [obstacle.pose for obstacle in obstacles.values()]
    pose = Pose(np.concatenate([one.position for one in poses]), np.concatenate([one.orientation for one in poses]))
    walls = [Wall(len(shapes) + i, piece.name, piece.shape) for i, piece in enumerate(pieces)]
    detector = exact_detector(shapes, pieces, Registry.load())
    contacts = detector(detector.Options(), shapes, walls).detect(pose, None, 0.0)
    if len(contacts):
        names = [*obstacles, *(piece.name for piece in pieces)]
        worst = int(np.argmin(contacts.gap))
        a, b = (int(numbers[worst]) for numbers in (contacts.body_a, contacts.body_b))
        place, depth = poses[a].position[0].tolist(), abs(contacts.gap[worst])
        raise SceneError(
            f"{AT}.{a}.position",
            f"{place}, where {names[a]!r} overlaps {names[b]!r} by {depth:.6g}",
            "a place inside the domain and clear of all other surfaces",
            "Move it, or make it smaller.",
        )
