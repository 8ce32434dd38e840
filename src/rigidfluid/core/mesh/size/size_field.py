"""The cell size wanted at a point: fine near bodies and in chosen regions, finer still in a narrow gap, coarse
elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.regions import Region

ALONG_FILM = 0.12
"""Longest edge wanted in a film over √(R gap), the length over which its pressure varies."""

FINER_IN_FILMS = 0.125
"""Least edge wanted in a film over the smallest size for a gap."""

RESOLVED = 5
"""Fewest refinements with which films have finer cells; with fewer, gaps are kept coarse on purpose."""

LONGEST = 1.5
"""An edge on a body or a curved wall is bisected when it is longer than this many times the wanted size."""


@dataclass(frozen=True, slots=True)
class Sizes:
    """Parameters of the wanted cell size.

    ``size``: edge length far from the bodies, ``size_body``: that on a body [length]; ``growth`` of the size with the
    distance to a body [1]; ``cells_per_gap``: number of cells across a gap, for which size_body is halved at most
    ``refinements`` times; ``order`` of the cells at bodies and curved walls: 1 straight, 2 curved; ``regions`` with a
    size of their own, unless cells are finer there anyway; ``asked``: edge lengths (N,) at points (N, d) by size fields
    at the moment [length], which count where they are less.
    """

    size: float
    size_body: float
    growth: float = 0.2
    cells_per_gap: float = 2.0
    refinements: int = 6
    order: int = 2
    regions: tuple[Region, ...] = ()
    asked: tuple[Callable[[FloatArray], FloatArray], ...] = ()

    @property
    def smallest(self) -> float:
        """Smallest size wanted for a gap, size_body / 2^refinements [length]."""
        return self.size_body / 2.0**self.refinements


def wanted_size(points: FloatArray, fluid_domain: FluidDomain, sizes: Sizes) -> FloatArray:
    """Wanted edge length at points (N, d), h = min(h_open, max(h_min, g/cells_per_gap)), g = d₁ + d₂, (N,) [length].

    h_open is `size_away_from_gaps`, d₁ the distance to the nearest body, d₂ that to the next body or the nearest wall,
    so that g equals the gap on the segment that joins two surfaces and is larger off it. Two walls make no gap. h_min
    is `Sizes.smallest`, or ALONG_FILM √(R g) down to FINER_IN_FILMS of that, with R the least radius of curvature of a
    body: cells may be flat in a film, but the pressure along it is to be resolved. With fewer
    refinements than RESOLVED h_min is `Sizes.smallest`.
    """
    first, second = fluid_domain.two_nearest_bodies(points, reach_of_bodies(sizes))
    return size_between(points, first, second, fluid_domain, sizes)


def size_between(
    points: FloatArray, first: FloatArray, second: FloatArray, fluid_domain: FluidDomain, sizes: Sizes
) -> FloatArray:
    """`wanted_size` of points at distances ``first`` and ``second`` (N,) from the two nearest bodies, (N,) [length]."""
    open_size = _size_at(first, points, fluid_domain, sizes)
    near = np.flatnonzero(first < 1.001 * sizes.cells_per_gap * open_size)  # elsewhere no gap is narrow
    gap = first[near] + np.minimum(second[near], fluid_domain.nearest_wall(points[near]))
    wanted = open_size.copy()
    least = _least_in_gaps(gap, fluid_domain, sizes)
    wanted[near] = np.minimum(open_size[near], np.maximum(gap / sizes.cells_per_gap, least))
    return wanted


def _least_in_gaps(gap: FloatArray, fluid_domain: FluidDomain, sizes: Sizes) -> FloatArray:
    """h_min in gaps of these widths (N,), with the least radius of curvature of all bodies that tell theirs."""
    radii = [radius for radius in (body.least_radius for body in fluid_domain.bodies) if radius is not None]
    if not radii or sizes.refinements < RESOLVED:
        return np.full_like(gap, sizes.smallest)
    return np.clip(ALONG_FILM * np.sqrt(min(radii) * gap), FINER_IN_FILMS * sizes.smallest, sizes.smallest)


def size_away_from_gaps(points: FloatArray, fluid_domain: FluidDomain, sizes: Sizes) -> FloatArray:
    """Wanted edge length without regard to gaps, (N,) [length].

    h = min(size, size_body + growth·d₁, size_r + growth·d_r, h_f) for all regions r at distances d_r and size fields f.
    """
    first, _ = fluid_domain.two_nearest_bodies(points, reach_of_bodies(sizes))
    return _size_at(first, points, fluid_domain, sizes)


def _size_at(first: FloatArray, points: FloatArray, fluid_domain: FluidDomain, sizes: Sizes) -> FloatArray:
    """h of points at distances ``first`` (N,) from the nearest body; regions and fields are those in the domain."""
    points = fluid_domain.domain.wrapped(points)
    wanted = np.minimum(sizes.size_body + sizes.growth * first, sizes.size)
    for region in sizes.regions:
        np.minimum(wanted, region.size + sizes.growth * region.distance(points), out=wanted)
    for asked in sizes.asked:
        np.minimum(wanted, asked(points), out=wanted)
    return wanted


def reach_of_bodies(sizes: Sizes) -> float:
    """The distance beyond which bodies decide no size [length]."""
    return max((sizes.size - sizes.size_body) / sizes.growth, sizes.cells_per_gap * sizes.size)
