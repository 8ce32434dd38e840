"""Representative bodies, and hypothetical contacts of them at which a law is evaluated."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from rigidfluid.core.contact.pairs.proximity import are_separate
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wall import Wall, radius_of
from rigidfluid.core.mechanics.shapes import shape_key
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts

FAR_AHEAD = 1e6
"""Distance of a far point, over the size of the domain."""

MOST = 40
"""Largest number of representatives; of more those with the extremes of mass, weight, size, speed and stack remain."""


def body_classes(system: System) -> tuple[tuple[int, ...], ...]:
    """Classes of bodies of one shape, mass, weight and freedom, each in the order of the expected speed."""
    found = defaultdict(list)
    for i in np.argsort(system.loads.speed, kind="stable").tolist():
        body = shape_key(system.bodies[i]), float(system.mass[i]), *system.weight[i].tolist()
        found[(*body, bool(system.prescribed[i]))].append(i)
    return tuple(map(tuple, found.values()))


def representatives(system: System) -> tuple[int, ...]:
    """Numbers of the bodies that stand for all: of each kind the two slowest and fastest, the least and most stacked.

    Bodies with the extremes of mass, weight, size, speed and stack alone stand for all if these are too many.
    """
    loads = system.loads
    stacks = loads.stacked_weight, loads.stacked_energy
    chosen = sorted({i for kind in body_classes(system) for i in _extremes(kind, (loads.speed, *stacks))})
    if len(chosen) <= MOST:
        return tuple(chosen)
    size = system.bounding_radii
    weight = np.linalg.norm(system.weight, axis=1)
    return tuple(sorted(_extremes(chosen, (system.mass, weight, size, loads.speed, *stacks))))


def _extremes(bodies: Sequence[int], columns: Sequence[FloatArray]) -> set[int]:
    """Members of ``bodies`` with the two least and the two greatest values in each of the columns (n,)."""
    orders = (np.argsort(column[list(bodies)], kind="stable") for column in columns)
    return {bodies[i] for order in orders for i in (*order[:2], *order[-2:])}


def wall_contacts(system: System, bodies: Sequence[int], walls: Sequence[Wall]) -> Contacts:
    """Contact of each of ``bodies`` with its wall, one of ``walls`` for each, gap zero."""
    normals = [facing_normal(system, body, wall.shape) for body, wall in zip(bodies, walls, strict=True)]
    radius = np.array([radius_of(wall.shape) for wall in walls])
    at_wall, normal = np.ones(len(walls), dtype=bool), np.array(normals).reshape(-1, system.dimension)
    pairs = [(body, wall.surface) for body, wall in zip(bodies, walls, strict=True)]
    return _touching(system, pairs, normal, radius, at_wall)


def facing_normal(system: System, body: int, shape: Surface) -> FloatArray:
    """Normal (d,) of a surface where the weight drives a body to in the end: nearest to a point far ahead."""
    weight = system.weight[body]
    ahead = weight / max(float(np.linalg.norm(weight)), np.finfo(float).tiny)
    far = system.pose.position[body] + FAR_AHEAD * float(system.domain.size.max()) * ahead
    return np.asarray(shape.normal(far[None])[0])


def free(system: System, bodies: Sequence[int]) -> list[int]:
    """Members of ``bodies`` whose twist is not prescribed."""
    return [i for i in bodies if not system.prescribed[i]]


def pair_contacts(system: System, bodies: Sequence[int]) -> Contacts:
    """Contact of each pair of separate ``bodies`` of which one is free, gap zero."""
    pairs = [pair for pair in combinations(bodies, 2) if free(system, pair)]
    radius, at_wall = np.array([radius_of(system.bodies[b]) for _, b in pairs]), np.zeros(len(pairs), dtype=bool)
    contacts = _touching(system, pairs, np.eye(system.dimension)[0], radius, at_wall)
    return select(contacts, are_separate(system, contacts))


def contacts_at_gaps(contacts: Contacts, gaps: FloatArray) -> Contacts:
    """Contacts (m · G) that each of m contacts has at each of its gaps (m, G)."""
    many = select(contacts, np.repeat(np.arange(len(contacts)), gaps.shape[1]))
    gap = gaps.ravel()
    return replace(many, gap=gap, point_a=many.point_b + gap[:, None] * many.normal)


def _touching(
    system: System, pairs: Sequence[tuple[int, int]], normal: FloatArray, radius_b: FloatArray, at_wall: BoolArray
) -> Contacts:
    points = np.zeros((len(pairs), system.dimension))
    a, b = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return Contacts(
        body_a=a,
        body_b=b,
        point_a=points,
        point_b=points,
        normal=points + normal,
        gap=np.zeros(len(pairs)),
        radius_a=np.array([radius_of(system.bodies[i]) for i in a]),
        radius_b=radius_b,
        at_wall=at_wall,
    )
