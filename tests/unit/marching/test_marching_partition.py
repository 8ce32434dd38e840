import numpy as np
import pytest
from marching_meshes import INNER, OUTER, shell

from rigidfluid.marching.field import distance_field
from rigidfluid.marching.partition import field_in_threads, split
from rigidfluid.marching.topology import Topology


def sectors(mesh, count):
    """Part of each cell by the angle of its centre."""
    centre = mesh.points[mesh.cells].mean(axis=1)
    turn = np.arctan2(centre[:, 1], centre[:, 0]) / (2 * np.pi) + 0.5
    return np.minimum((turn * count).astype(int), count - 1)


def at_random(mesh, count):
    """Every cell in any part: borders everywhere."""
    return np.random.default_rng(0).integers(0, count, len(mesh.cells))


def layers(mesh, count):
    """Part of each cell by its distance: all but the first are reached through others alone."""
    radius = np.linalg.norm(mesh.points[mesh.cells].mean(axis=1), axis=1)
    return np.searchsorted(np.quantile(radius, np.linspace(0, 1, count + 1)[1:-1]), radius)


@pytest.mark.parametrize("surfaces", [[INNER], [OUTER], [INNER, OUTER]])
@pytest.mark.parametrize("owners", [sectors, layers, at_random])
@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize(("dimension", "size"), [(2, 0.06), (3, 0.2)])
def test_parts_give_the_field_of_the_whole(dimension, size, count, owners, surfaces):
    mesh = shell(dimension, 0.3, 1.2, size)
    parts = split(mesh, owners(mesh, count))
    whole = distance_field(Topology.from_mesh(mesh), mesh.points, surfaces, 0.6)
    field = field_in_threads(parts, mesh.points, surfaces, 0.6)
    again = field_in_threads(parts, mesh.points, surfaces, 0.6)
    assert set(field.vertices) == set(whole.vertices)
    expected = whole.everywhere(len(mesh.points))[field.vertices]
    np.testing.assert_allclose(field.distance, expected, rtol=0, atol=1e-15)
    assert dict(zip(field.vertices, field.distance, strict=True)) == dict(
        zip(again.vertices, again.distance, strict=True)
    )


@pytest.mark.parametrize("failing", [0, 2])
def test_a_part_that_fails_does_not_leave_the_others_waiting(failing):
    mesh = shell(2, 0.3, 1.2, 0.06)
    parts = split(mesh, layers(mesh, 3))
    parts[failing].topology.seeds = lambda _: [][0]
    with pytest.raises(IndexError, match="list index out of range"):
        field_in_threads(parts, mesh.points, [INNER])
