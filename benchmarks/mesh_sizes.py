"""Cell sizes with which the box of balls gets about as many vertices as the paper's meshes."""

from __future__ import annotations

from math import ceil, log2

from rigidfluid.core.mesh.size.size_field import Sizes

PAPER_NODES = {
    2: {1: 16462, 25: 17780, 49: 18284, 81: 18813, 100: 19139},
    3: {1: 17073, 27: 18213, 64: 18789, 125: 20301},
}
"""Dimension → bodies → nodes of the mesh; arXiv:2402.19093, Tables 2 and 3."""

EDGES = {
    2: {1: 0.00815, 25: 0.0067, 49: 0.0066, 81: 0.0065, 100: 0.0065},
    3: {1: 0.0485, 27: 0.06, 64: 0.08, 125: 0.077},
}
"""Dimension → bodies → edge length that gives about as many vertices, found by trial [length]."""


def mesh_sizes(dimension: int, bodies: int, coarseness: float = 1.0) -> Sizes:
    """Build uniform cell sizes for ``bodies`` balls in the unit box; cells in gaps are half as long in 3D.

    ``coarseness`` [1] is edge length over that of a mesh as fine as the paper's; cells in gaps stay as fine.
    """
    size = coarseness * EDGES[dimension][bodies]
    return Sizes(size, 0.98 * size, refinements=ceil(log2(coarseness)) + (dimension == 3))
