"""Contacts that a detector found between facets of balls and of their walls, moved to the round shapes themselves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.types import Contacts, Pose

FACING = 0.5
"""Cosine of the angle to the wall's own normal: a contact farther off is with an edge of the wall."""


def on_round_shapes(contacts: Contacts, walls: Sequence[Wall], pose: Pose) -> Contacts:
    """Contacts, with those of balls with each other and with flat and round walls moved to the line through the
    centres.

    The nearest points between facets lie off that line: such a force would turn a ball, and its work would not be
    the loss of the gap's energy.
    """
    ball = np.isfinite(contacts.radius_a)
    pairs = np.flatnonzero(ball & ~contacts.at_wall & np.isfinite(contacts.radius_b))
    at_wall = np.flatnonzero(ball & contacts.at_wall & ~np.isnan(contacts.radius_b))
    if len(pairs) + len(at_wall) == 0:
        return contacts
    normal, foot = contacts.normal.copy(), contacts.point_b.copy()
    centre, radius = pose.position[contacts.body_a], contacts.radius_a
    other = pose.position[contacts.body_b[pairs]]
    normal[pairs] = _unit(centre[pairs] - other)
    foot[pairs] = other + contacts.radius_b[pairs, None] * normal[pairs]
    measured = np.zeros(len(contacts), dtype=bool)
    measured[pairs] = True
    shapes = {wall.surface: wall.shape for wall in walls}
    for row in at_wall.tolist():
        shape, at = shapes[int(contacts.body_b[row])], centre[row : row + 1]
        own = shape.normal(at)[0]
        if own @ normal[row] > FACING:
            normal[row], foot[row], measured[row] = own, shape.closest_point(at)[0], True
    away = np.sum((centre - foot) * normal, axis=1) - radius
    gap = np.where(measured, away, contacts.gap)
    point = np.where(measured[:, None], centre - radius[:, None] * normal, contacts.point_a)
    return replace(contacts, point_a=point, point_b=foot, normal=normal, gap=gap)


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
