"""Expected number of cells and boundary facets of a mesh, from the wanted sizes alone."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.made_size import made_size
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.domain import Domain

_CELLS = {2: 2.42, 3: 11.1}
"""Number of cells in a volume of h^d, fitted to meshes made; of regular simplices with edges h it would be 2.3 and
8.5."""

_FACETS = {2: 2.0, 3: 4.6}
"""Number of facets in a volume of h^d within h/2 of the boundary, of regular simplices."""

_MOST_BOXES = 500_000
"""Most boxes: where halving would make more, h at each box's middle is taken for all of it."""


class Count(NamedTuple):
    """Number of ``cells`` of a mesh, and of ``facets`` on bodies and on the domain's boundary."""

    cells: float
    facets: float


def expected_count(fluid_domain: FluidDomain, sizes: Sizes) -> Count:
    """Expected number of cells, `_CELLS` ∫ h^-d over the fluid, within 15 %, and of boundary facets, `_FACETS` ∫ h^-d
    within h/2 of the boundary; h is the `made_size`.

    The integrals are sums over boxes, halved until they are smaller than h at their middle. A box counts if its middle
    is in the fluid.
    """
    domain = fluid_domain.domain
    middle, edge = _boxes(domain, sizes.size)
    dimension = len(edge)
    to_halves = np.array(list(product((-0.25, 0.25), repeat=dimension)))
    cells = facets = 0.0
    while len(middle):
        size, to_body = made_size(middle, fluid_domain, sizes)
        split = (edge.max() > size) & (len(middle) * len(to_halves) <= _MOST_BOXES)
        counted = ~split & (to_body > 0.0)
        counted[counted] = domain.contains(middle[counted])
        points, size = middle[counted], size[counted]
        integral = np.prod(edge) / size**dimension
        to_domain = (np.abs(piece.shape.signed_distance(points)) for piece in domain.pieces)
        distance = np.min([to_body[counted], *to_domain], axis=0)
        share_at_boundary = np.clip((0.5 * size - distance) / edge.max() + 0.5, 0.0, 1.0)
        cells += float(integral.sum())
        facets += float(integral @ share_at_boundary)
        middle = (middle[split, None] + to_halves * edge).reshape(-1, dimension)
        edge = 0.5 * edge
    return Count(_CELLS[dimension] * cells, _FACETS[dimension] * facets)


def _boxes(domain: Domain, size: float) -> tuple[FloatArray, FloatArray]:
    """Middles (b, d) and edges (d,) of equal boxes, of about this size, that fill the domain's extent [length]."""
    lower, upper = domain.extent
    dimension = len(lower)
    longest = max(size, float(np.prod(upper - lower) / _MOST_BOXES) ** (1.0 / dimension))
    count = np.ceil((upper - lower) / longest)
    edge = (upper - lower) / count
    numbers = np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), axis=-1).reshape(-1, dimension)
    return lower + (numbers + 0.5) * edge, edge
