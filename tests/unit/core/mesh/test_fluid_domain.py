"""The fluid domain numbers its surfaces as a mesh does, and measures from them."""

import numpy as np
import pytest
from mesh_tools import ball, box, box_walls, upright

from rigidfluid.core.mesh.fluid_domain import FluidDomain

LOWER, UPPER = [0.0, 0.0], [2.0, 1.0]
TWO_DISKS = FluidDomain(
    [ball(0.1), ball(0.2)], upright([0.5, 0.5], [1.5, 0.5]), box(LOWER, UPPER), box_walls(LOWER, UPPER, 2)[:1]
)
POINTS = np.array([[0.8, 0.5], [1.5, 0.8], [1.0, 0.1]])


@pytest.mark.parametrize("surface", range(6))
def test_closest_points_are_on_the_body_or_the_piece_of_that_number(surface: int) -> None:
    found = TWO_DISKS.closest_points(surface, POINTS)
    if surface < 2:
        off = np.linalg.norm(found - TWO_DISKS.pose.position[surface], axis=1) - [0.1, 0.2][surface]
    else:
        off = TWO_DISKS.domain.pieces[surface - 2].shape.signed_distance(found)
    np.testing.assert_allclose(off, 0.0, atol=1e-15)


def test_distances_are_those_of_disks_and_walls() -> None:
    centres = np.linalg.norm(POINTS - TWO_DISKS.pose.position[:, None], axis=2)
    away = centres - np.array([[0.1], [0.2]])
    np.testing.assert_allclose(TWO_DISKS.body_distances(POINTS), away, rtol=1e-12)
    np.testing.assert_allclose(TWO_DISKS.two_nearest_bodies(POINTS, np.inf), np.sort(away, axis=0), rtol=1e-12)
    to_sides = np.minimum(POINTS - LOWER, np.array(UPPER) - POINTS).min(axis=1)
    first, second = np.sort(away, axis=0)
    np.testing.assert_allclose(TWO_DISKS.gap_widths(POINTS), first + np.minimum(second, to_sides), rtol=1e-12)
    wall = TWO_DISKS.walls[0].shape.signed_distance(POINTS)
    np.testing.assert_array_equal(TWO_DISKS.nearest_wall(POINTS), wall)
