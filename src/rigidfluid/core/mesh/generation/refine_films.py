"""Bisects edges inside films that are thinner than the cells wanted in them, between surfaces whose vertices stay."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.refine_surface import bisect_all, edge_numbers, edges_of_facets
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes, wanted_size
from rigidfluid.core.mesh.topology import distinct_edges
from rigidfluid.core.model.types import Mesh


def refine_films(mesh: Mesh, fluid_domain: FluidDomain, sizes: Sizes) -> Mesh:
    """Bisect inner edges in films until none is longer than LONGEST times the wanted size.

    MMG puts no vertex nearer to others than the wanted size. In a film that is thinner, between two bodies, each place
    is near a vertex of one of them, and all those are kept: it leaves long edges from one to the other, and slivers.
    """
    return bisect_all(mesh, lambda now: _long_in_films(now, fluid_domain, sizes))


def _long_in_films(mesh: Mesh, fluid_domain: FluidDomain, sizes: Sizes) -> tuple[IntArray, FloatArray]:
    """Inner edges (E, 2) that are too long in films thinner than the wanted size, and their middles (E, d)."""
    edges = distinct_edges(mesh.cells)
    on_surfaces, _ = edges_of_facets(mesh, np.ones(len(mesh.facets), dtype=bool))
    edges = edges[edge_numbers(edges, (0, 1), on_surfaces, len(mesh.points)) < 0]
    middles = np.asarray(mesh.points[edges].mean(axis=1))
    wanted = wanted_size(middles, fluid_domain, sizes)
    long = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1) > LONGEST * wanted
    edges, middles, wanted = edges[long], middles[long], wanted[long]
    thin = fluid_domain.gap_widths(middles) < wanted
    return edges[thin], middles[thin]
