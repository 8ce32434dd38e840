"""Contacts between two detections: their points move with the bodies."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.pairs.body_points import body_arms, placed_points
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.contacts import points_of_b
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Pose


class ExtrapolatedContacts:
    """Contacts detected at one ``pose``, carried along by the bodies' rigid motion.

    Gap and normal are exact between balls, and of balls with flat walls. Other surfaces are followed by their points,
    along the normal that was found: the gap is then right to first order in the motion since.
    """

    def __init__(self, contacts: Contacts, pose: Pose) -> None:
        self._contacts = contacts
        self._pose = pose
        self._round = np.isfinite(contacts.radius_a) & np.isfinite(contacts.radius_b) & ~contacts.at_wall
        turned_back = np.swapaxes(rotation_matrices(pose.orientation), -1, -2)
        self._points_a = _points(contacts.body_a, contacts.point_a, contacts.radius_a, pose, turned_back)
        self._points_b = _points(contacts.body_b, points_of_b(contacts), contacts.radius_b, pose, turned_back)

    def extrapolate(self, pose: Pose) -> Contacts:
        """Contacts when the bodies are at ``pose``, in the same order."""
        rotation = rotation_matrices(pose.orientation)
        old, normal = self._contacts, self._contacts.normal.copy()
        point_a, point_b = (each.moved(self._pose, pose, rotation) for each in (self._points_a, self._points_b))
        if old.shift is not None:
            point_b += old.shift
        gap = np.sum((point_a - point_b) * normal, axis=1)
        point_b[old.at_wall] = point_a[old.at_wall] - gap[old.at_wall, None] * normal[old.at_wall]
        if self._round.any():
            self._measure_balls(pose, point_a, point_b, normal, gap)
        return replace(old, point_a=point_a, point_b=point_b, normal=normal, gap=gap)

    def missed(self, law: ForceLaw, pose: Pose) -> float:
        """Zero: contacts that come or go between two detections are not known."""
        return 0.0

    def _measure_balls(
        self, pose: Pose, point_a: FloatArray, point_b: FloatArray, normal: FloatArray, gap: FloatArray
    ) -> None:
        """Set gap = |x_a - x_b| - r_a - r_b of pairs of balls along the line of centres, in place, and its points and
        normal."""
        which, old = self._round, self._contacts
        a, b = pose.position[old.body_a[which]], pose.position[old.body_b[which]]
        if old.shift is not None:
            b = b + old.shift[which]
        distance = np.linalg.norm(a - b, axis=1)
        normal[which] = (a - b) / distance[:, None]
        point_a[which] = a - old.radius_a[which, None] * normal[which]
        point_b[which] = b + old.radius_b[which, None] * normal[which]
        gap[which] = distance - old.radius_a[which] - old.radius_b[which]


class _Points(NamedTuple):
    """Points of contacts on their ``body`` (m,): the ``point`` (m, d) at the detection, its ``arm`` (m, d) from the
    centre of mass in the body's frame, for walls the point itself [length], and whether it ``turns`` (m,) with it."""

    body: IntArray
    point: FloatArray
    arm: FloatArray
    turns: BoolArray

    def moved(self, old: Pose, pose: Pose, rotation: FloatArray) -> FloatArray:
        """Present positions (m, d) [length]."""
        moved = placed_points(self.body, self.arm, pose.position, rotation)
        shifted = ~self.turns & (self.body < len(pose.position))
        index = self.body[shifted]
        moved[shifted] = self.point[shifted] + pose.position[index] - old.position[index]
        return moved


def _points(body: IntArray, point: FloatArray, radius: FloatArray, pose: Pose, turned_back: FloatArray) -> _Points:
    """Points on bodies of this ``radius`` (m,); that of a ball does not turn with it, as its nearest point does not."""
    return _Points(body, point, body_arms(body, point, pose.position, turned_back), ~np.isfinite(radius))
