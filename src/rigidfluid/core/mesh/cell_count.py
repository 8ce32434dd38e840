"""Expected number of cells and boundary facets of a mesh, from the wanted sizes alone."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.made_size import made_size
from rigidfluid.core.mesh.size_field import Sizes
from rigidfluid.core.model.domain import Domain

_CELLS = {2: 2.42, 3: 11.1}
"""Number of cells in a volume of h^d, fitted to meshes made; of regular simplices with edges h it would be 2.3 and
8.5."""

_FACETS = {2: 2.0, 3: 4.6}
"""Number of facets in a volume of h^d within h/2 of the boundary, of regular simplices."""

_MOST_BOXES = 500_000
"""Number of boxes beyond which none is halved: the size at each box's middle is then taken for all of it."""


class Count(NamedTuple):
    """Number of ``cells`` of a mesh, and of ``facets`` on bodies and on the domain's boundary."""

    cells: float
    facets: float


def expected_count(fluid_domain: FluidDomain, sizes: Sizes) -> Count:
    """Expected number of cells c ∫ h^-d over the fluid, within 15 %, and of boundary facets f ∫ h^-d within h/2 of its
    boundary, h the `made_size`.

    Boxes are halved until they are smaller than the size at their middle, and count if that is in the fluid.
    """
    domain = fluid_domain.domain
    lower, upper = domain.extent
    dimension = len(lower)
    coarsest = max(sizes.size, float(np.prod(upper - lower) / _MOST_BOXES) ** (1.0 / dimension))
    count = np.ceil((upper - lower) / coarsest)
    edge = (upper - lower) / count
    halves = np.array(list(product((-0.25, 0.25), repeat=dimension)))
    steps = np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), axis=-1).reshape(-1, dimension)
    middle, cells, facets = lower + (steps + 0.5) * edge, 0.0, 0.0
    while len(middle):
        size, to_body = made_size(middle, fluid_domain, sizes)
        split = (edge.max() > size) & (len(middle) * len(halves) <= _MOST_BOXES)
        counted = ~split & (to_body > 0.0)
        counted[counted] = domain.contains(middle[counted])
        points, size = middle[counted], size[counted]
        weight = np.prod(edge) / size**dimension
        distance = np.minimum(to_body[counted], _distance_to_domain(points, domain))
        cells += float(weight.sum())
        facets += float(weight @ np.clip((0.5 * size - distance) / edge.max() + 0.5, 0.0, 1.0))
        middle = (middle[split, None] + halves * edge).reshape(-1, dimension)
        edge = 0.5 * edge
    return Count(_CELLS[dimension] * cells, _FACETS[dimension] * facets)


def _distance_to_domain(points: FloatArray, domain: Domain) -> FloatArray:
    """Distance to the nearest piece of the domain's boundary (N,) [length]."""
    nearest = np.full(len(points), np.inf)
    for piece in domain.pieces:
        np.minimum(nearest, np.abs(piece.shape.signed_distance(points)), out=nearest)
    return nearest
