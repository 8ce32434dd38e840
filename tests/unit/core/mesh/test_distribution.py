"""A mesh in parts, one for each rank."""

import numpy as np
import pytest
from marching_meshes import box, stars
from threaded_ranks import on_ranks

from rigidfluid.core.mesh.distribution import distributed, partition, surface_vertices, whole
from rigidfluid.core.model.ranks import ALONE
from rigidfluid.core.model.types import Mesh


def part_of(mesh, ranks):
    return distributed(mesh if ranks.is_root else None, ranks)


def assert_equal(one, other):
    for name in ("points", "cells", "facets", "markers"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


@pytest.mark.parametrize("parts", [1, 2, 3, 7])
@pytest.mark.parametrize("dimension", [2, 3])
def test_parts_are_of_one_size_and_none_is_empty(dimension, parts):
    mesh = box(dimension, 5, seed=0)
    sizes = np.bincount(partition(mesh, parts), minlength=parts)
    assert np.ptp(sizes) <= np.ceil(np.log2(parts))
    assert np.array_equal(partition(mesh, parts), partition(mesh, parts))


def test_the_longest_side_is_halved():
    mesh = box(2, 6, seed=0)
    long = Mesh(mesh.points * [1.0, 3.0], mesh.cells, mesh.facets, mesh.markers)
    height = long.points[long.cells].mean(axis=1)[:, 1]
    owner = partition(long, 2)
    assert height[owner == 0].max() <= height[owner == 1].min()


def test_alone_the_whole_is_the_part():
    mesh = box(2, 3)
    assert distributed(mesh, ALONE) is mesh
    assert whole(mesh) is mesh


@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("dimension", [2, 3])
def test_parts_make_the_whole_again_wherever_its_points_have_gone(dimension, count):
    mesh, _ = stars(dimension, 3)
    moved = Mesh(mesh.points**2, mesh.cells, mesh.facets, mesh.markers)

    def there_and_back(ranks):
        part = part_of(mesh, ranks)
        return whole(Mesh(part.points**2, part.cells, part.facets, part.markers, part.part))

    first, *others = on_ranks(count, there_and_back)
    assert_equal(first, moved)
    assert others == [None] * (count - 1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_part_knows_its_place(dimension):
    mesh, _ = stars(dimension, 4)
    owners = np.zeros(len(mesh.points), dtype=int)
    seen = []
    for rank, part in enumerate(on_ranks(3, lambda ranks: part_of(mesh, ranks))):
        place = part.part
        assert (place.ranks.rank, place.ranks.size) == (rank, 3)
        assert np.array_equal(place.counts, [len(mesh.points), len(mesh.cells), len(mesh.facets)])
        assert np.array_equal(part.points, mesh.points[place.vertices])
        assert np.array_equal(place.vertices[part.cells], mesh.cells[place.cells])
        assert np.array_equal(place.vertices[part.facets], mesh.facets[place.facets])
        assert np.array_equal(np.unique(part.cells), np.arange(len(part.points)))
        assert all(np.all(np.diff(numbers) > 0) for numbers in (place.vertices, place.cells, place.facets))
        owners[place.vertices[place.owned]] += 1
        assert not np.isin(place.vertices[place.owned], seen).any()  # the lowest rank has it
        seen.extend(place.vertices)
    assert np.all(owners == 1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_surface_vertices_are_known_where_no_facet_is(dimension):
    mesh, _ = stars(dimension, 5)
    parts = on_ranks(7, lambda ranks: (part := part_of(mesh, ranks), surface_vertices(part, 0)))
    expected = surface_vertices(mesh, 0)
    assert np.array_equal(expected, np.unique(mesh.facets[mesh.markers == 0]))
    for part, found in parts:
        assert np.array_equal(part.part.vertices[found], np.intersect1d(expected, part.part.vertices))
    assert any(len(found) > len(np.unique(part.facets[part.markers == 0])) for part, found in parts)
