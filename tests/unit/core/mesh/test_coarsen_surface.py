"""Facets that a gap has left behind on bodies in 3D."""

from __future__ import annotations

import numpy as np
import pytest
from mesh_tools import ball, box, box_walls, ellipsoid, upright

from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.coarsen_surface import SHORTEST, coarsen_surface
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.generation.refine_surface import refine_surface
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh

LOWER, UPPER = np.zeros(3), np.array([2.0, 2.0, 2.0])
BOX = box(LOWER, UPPER)
SIZES = Sizes(0.8, 0.3, 0.5)


BODIES = {"ball": ball(0.5, 3), "ellipsoid": ellipsoid(0.55, 0.55, 0.5), "three axes": ellipsoid(0.6, 0.55, 0.5)}


@pytest.fixture(scope="module", params=BODIES.values(), ids=BODIES.keys())
def above_a_floor(request):
    """A body with a gap of .06, the walls, its pose, its mesh, and the same bisected for the gap."""
    body, pose, walls = request.param, upright([1.0, 1.0, 0.56]), box_walls(LOWER, UPPER, 1)
    mesh = generate_mesh(FluidDomain([body], pose, BOX, ()), Sizes(SIZES.size, SIZES.size_body, SIZES.growth))
    return body, pose, walls, mesh, refine_surface(mesh, FluidDomain([body], pose, BOX, walls), SIZES)


def facets(mesh):
    return int(np.sum(mesh.markers == 0))


def test_facets_that_a_gap_has_left_are_merged(above_a_floor) -> None:
    body, pose, _, mesh, split = above_a_floor
    merged = coarsen_surface(split, FluidDomain([body], pose, BOX, []), SIZES)
    assert facets(split) > 4 * facets(mesh)
    assert facets(merged) < 1.6 * facets(mesh)
    check_mesh(merged, quality=0.0)
    on_body = merged.points[np.unique(merged.facets[merged.markers == 0])]
    np.testing.assert_allclose(distance_to_body(pose, 0, body, on_body), 0.0, atol=1e-9)
    assert cell_quality(merged.points, merged.cells).min() >= min(0.1, cell_quality(split.points, split.cells).min())


def test_facets_in_a_gap_stay(above_a_floor) -> None:
    body, pose, walls, mesh, split = above_a_floor
    merged = coarsen_surface(split, FluidDomain([body], pose, BOX, walls), SIZES)
    assert facets(merged) > 0.9 * facets(split)
    assert facets(merged) > 4 * facets(mesh)


def test_a_small_ball_keeps_the_facets_that_its_curvature_asks_for() -> None:
    """However coarse the wanted size: with 1.2 radii a ball would lose two thirds of its facets."""
    body, pose = ball(0.5, 3), upright([1.0, 1.0, 1.0])
    mesh = generate_mesh(FluidDomain([body], pose, BOX, ()), Sizes(0.8, 0.25, 0.5))
    merged = coarsen_surface(mesh, FluidDomain([body], pose, BOX, []), Sizes(0.8, 0.6, 0.5))
    assert facets(merged) > 0.9 * facets(mesh)


def test_no_facets_are_merged_where_none_is_short(above_a_floor) -> None:
    body, pose, _, mesh, _ = above_a_floor
    corners = mesh.points[mesh.facets[mesh.markers == 0]]
    shortest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).min()
    small = Sizes(0.8, 0.99 * shortest / SHORTEST, 0.5)
    assert coarsen_surface(mesh, FluidDomain([body], pose, BOX, []), small) is mesh


def test_a_mesh_made_anew_has_fewer_cells_once_the_gap_is_open(above_a_floor) -> None:
    body, pose, walls, _, split = above_a_floor
    before = remesh(split, FluidDomain([body], pose, BOX, walls), SIZES)
    after = remesh(before, FluidDomain([body], pose, BOX, []), SIZES)
    assert len(after.cells) < 0.7 * len(before.cells)
    assert np.sum(cell_volumes(after.points, after.cells)) == pytest.approx(8.0 - body.volume, rel=0.06)
