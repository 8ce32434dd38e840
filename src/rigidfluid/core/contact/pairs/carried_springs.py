"""Tangential springs of one pose in the contacts of another: found again, and turned with the normals."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.pairs.body_points import body_arms, placed_points
from rigidfluid.core.contact.pairs.same_contacts import PointPairs, distances, nearest_contacts, strictly_rising
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.contacts import points_of_b, select
from rigidfluid.core.model.tangential_springs import TangentialSprings
from rigidfluid.core.model.types import Contacts, Pose

_OPPOSITE = 1e-12
"""Least 1 + cosine of the angle between two normals at which their common plane is known."""


_MOST_AT_ONCE = 10_000
"""Largest number of distances, of all springs to all contacts, that are measured at once."""


def carried_springs(springs: TangentialSprings | None, contacts: Contacts, pose: Pose) -> tuple[FloatArray, FloatArray]:
    """Displacements (m, d) and turning (m, k) of ``springs`` in the ``contacts`` of bodies at ``pose``, zero where none
    is [length]."""
    carried = np.zeros_like(contacts.normal)
    turning = np.zeros((len(contacts), 1 if carried.shape[1] == 2 else 3))
    if springs is not None and len(contacts):
        mine, theirs = _matched(springs, contacts, pose)
        kept, normal = springs.select(mine), contacts.normal[theirs]
        carried[theirs] = transported(kept.displacement, kept.normal, normal)
        turning[theirs] = transported_turning(kept.turning, kept.normal, normal)
    return carried, turning


def springs_at(
    contacts: Contacts, displacement: FloatArray, stiffness: FloatArray, pose: Pose, turning: FloatArray | None = None
) -> TangentialSprings:
    """Springs of this ``displacement`` (m, d) and ``turning`` (m, k), None for none, [length] and ``stiffness`` (m,)
    [force/length] in the ``contacts`` of bodies at ``pose``, without those that are not there or relaxed."""
    if turning is None:
        turning = np.zeros((len(contacts), 1 if displacement.shape[1] == 2 else 3))
    chosen = np.flatnonzero((stiffness != 0.0) & (displacement.any(axis=1) | turning.any(axis=1)))
    near, turned_back = select(contacts, chosen), np.swapaxes(rotation_matrices(pose.orientation), -1, -2)
    return TangentialSprings(
        near.body_a,
        near.body_b,
        body_arms(near.body_a, near.point_a, pose.position, turned_back),
        body_arms(near.body_b, points_of_b(near), pose.position, turned_back),
        near.normal,
        displacement[chosen],
        stiffness[chosen],
        turning[chosen],
    )


def transported(displacement: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """Parallel transport of displacements (s, d) from the plane across the normals ``before`` (s, d) to that across
    the normals ``after`` (s, d), by the smallest rotation that takes one normal to the other:

        ξ - (n + n') (n'·ξ)/(1 + n·n'),  ξ where n' = -n.
    """
    closeness = 1.0 + np.sum(before * after, axis=1)
    along = np.sum(displacement * after, axis=1)
    part = np.divide(along, closeness, out=np.zeros_like(along), where=closeness > _OPPOSITE)
    turned = displacement - part[:, None] * (before + after)
    return np.asarray(turned - np.sum(turned * after, axis=1)[:, None] * after)


def transported_turning(turning: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """Vectors ``turning`` (s, k) transported from normals ``before`` (s, d) to those ``after`` as displacements are,
    and their part along the normal with this."""
    if turning.shape[1] == 1:
        return turning
    twisting = np.sum(turning * before, axis=1)[:, None]
    return np.asarray(transported(turning - twisting * before, before, after) + twisting * after)


def _matched(springs: TangentialSprings, contacts: Contacts, pose: Pose) -> tuple[IntArray, IntArray]:
    """Rows of springs and of the contacts that they go on in: those of the same pair, of several the nearest to the
    points that the bodies carry along."""
    base = int(max(springs.body_b.max(), contacts.body_b.max())) + 1
    before, now = (2 * (each.body_a * base + each.body_b) for each in (springs, contacts))
    before, now = before + (springs.stiffness > 0.0), now + (contacts.sign > 0.0)
    if strictly_rising(before) and strictly_rising(now):
        _, mine, theirs = np.intersect1d(before, now, assume_unique=True, return_indices=True)
        return mine, theirs
    points = _carried_points(springs, pose)
    own, found = _plain_matches(points, before, contacts, now)
    if len(own) == len(before):
        return own, found
    mine, theirs = [own], [found]
    for pair in np.setdiff1d(np.intersect1d(before, now), before[own]):
        rows, others = np.flatnonzero(before == pair), np.flatnonzero(now == pair)
        there = PointPairs(contacts.point_a[others], points_of_b(contacts)[others])
        own, found, _ = nearest_contacts(PointPairs(points.a[rows], points.b[rows]), there)
        mine.append(rows[own])
        theirs.append(others[found])
    return np.concatenate(mine), np.concatenate(theirs)


def _plain_matches(
    points: PointPairs, before: IntArray, contacts: Contacts, now: IntArray
) -> tuple[IntArray, IntArray]:
    """Rows of springs and contacts of the pairs in which each spring has a nearest contact of its own, so that no other
    sum of distances is less; none where they are too many to be measured at once."""
    same = before[:, None] == now
    if not 0 < same.size <= _MOST_AT_ONCE:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    away = np.where(same, distances(points, PointPairs(contacts.point_a, points_of_b(contacts))), np.inf)
    nearest = np.argmin(away, axis=1)
    alone = same.any(axis=1) & (np.bincount(nearest, minlength=len(now))[nearest] == 1)
    if alone.all():
        return np.arange(len(before)), nearest
    rows = np.flatnonzero(np.isin(before, before[~alone], invert=True))
    return rows, nearest[rows]


def _carried_points(springs: TangentialSprings, pose: Pose) -> PointPairs:
    place = pose.position, rotation_matrices(pose.orientation)
    arms = (springs.body_a, springs.arm_a), (springs.body_b, springs.arm_b)
    return PointPairs(*(placed_points(body, arm, *place) for body, arm in arms))
