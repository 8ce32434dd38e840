"""How many cells a mesh is going to have, from the sizes that are wanted alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.size_field import Sizes, wanted_size
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import BoolArray, FloatArray, Pose
from rigidfluid.core.model.wall import Wall

_CELLS = {2: 2.4, 3: 11.2}
"""In a volume of h^d, by the mesher; of regular simplices with edges h it would be 2.3 and 8.5."""

_MOST_GROWTH = 0.35
"""The mesher lets sizes grow no faster with the distance."""

_MOST_BOXES = 500_000
"""Of more the size at their middle is taken for all of them."""


def expected_cells(domain: Domain, bodies: Sequence[Body], pose: Pose, walls: Sequence[Wall], sizes: Sizes) -> float:
    """About how many cells a mesh has, c_d ∫ h^-d over the fluid, h the `wanted_size`.

    Boxes are halved until they are smaller than the size wanted at their middle, and count if that is in the fluid.

    Parameters
    ----------
    domain : Domain
        The part of it that is meshed.
    bodies : sequence of Body
        The shapes.
    pose : Pose
        Where they are.
    walls : sequence of Wall
        The walls whose gaps are resolved.
    sizes : Sizes
        What decides the size.

    Returns
    -------
    float
        Within a fifth, most often.
    """
    sizes = replace(sizes, growth=min(sizes.growth, _MOST_GROWTH))
    lower, upper = domain.extent
    dimension = len(lower)
    coarsest = max(sizes.size, float(np.prod(upper - lower) / _MOST_BOXES) ** (1.0 / dimension))
    count = np.ceil((upper - lower) / coarsest)
    edge = (upper - lower) / count
    halves = np.array(list(product((-0.25, 0.25), repeat=dimension)))
    steps = np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), axis=-1).reshape(-1, dimension)
    middle, cells = lower + (steps + 0.5) * edge, 0.0
    while len(middle):
        wanted = wanted_size(middle, bodies, pose, walls, sizes)
        split = (edge.max() > wanted) & (len(middle) * len(halves) <= _MOST_BOXES)
        counted = middle[~split]
        inside = _in_fluid(counted, domain, bodies, pose)
        cells += float(np.sum(np.prod(edge) / wanted[~split][inside] ** dimension))
        middle = (middle[split, None] + halves * edge).reshape(-1, dimension)
        edge = 0.5 * edge
    return _CELLS[dimension] * cells


def _in_fluid(points: FloatArray, domain: Domain, bodies: Sequence[Body], pose: Pose) -> BoolArray:
    inside = domain.contains(points)
    for i, body in enumerate(bodies):
        near = np.flatnonzero(np.linalg.norm(points - pose.position[i], axis=1) < body.bounding_radius)
        inside[near] &= distance_to_body(pose, i, body, points[near]) > 0.0
    return inside
