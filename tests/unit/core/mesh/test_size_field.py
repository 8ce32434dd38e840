"""The wanted size asks for a wall's distance where a gap may be narrow alone."""

import numpy as np
import pytest
from mesh_tools import ball, box, box_walls, ellipsoid, upright

from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes, wanted_size


@pytest.mark.parametrize("cells", [1.0, 2.0, 7.0])
def test_it_is_what_the_formula_says_everywhere(cells: float) -> None:
    bodies, pose = [ball(0.2), ellipsoid(0.3, 0.1), ball(0.1)], upright([0.25, 0.5], [0.8, 0.52], [0.6, 1.6])
    walls, sizes = box_walls([0.0, 0.0], [2.0, 2.0], 3), Sizes(0.3, 0.05, 0.2, cells)
    points = np.random.default_rng(2).uniform(0.0, 2.0, (20000, 2))
    away = np.sort([np.maximum(distance_to_body(pose, i, body, points), 0.0) for i, body in enumerate(bodies)], axis=0)
    wall = np.min([wall.shape.signed_distance(points) for wall in walls], axis=0)
    gap = away[0] + np.minimum(away[1], wall)
    open_size = np.minimum(0.05 + 0.2 * away[0], 0.3)
    expected = np.minimum(open_size, np.maximum(gap / cells, sizes.smallest))
    np.testing.assert_array_equal(
        wanted_size(points, FluidDomain(bodies, pose, box([0.0, 0.0], [2.0, 2.0]), walls), sizes), expected
    )
    assert np.mean(expected < open_size) > 0.001


def test_walls_are_not_asked_far_from_bodies(monkeypatch: pytest.MonkeyPatch) -> None:
    walls, asked = box_walls([0.0, 0.0], [10.0, 10.0], 1), []
    plain = type(walls[0].shape).signed_distance
    monkeypatch.setattr(
        type(walls[0].shape), "signed_distance", lambda self, points: asked.append(len(points)) or plain(self, points)
    )
    points = np.random.default_rng(2).uniform(0.0, 10.0, (1000, 2))
    wanted_size(
        points, FluidDomain([ball(0.2)], upright([5.0, 5.0]), box([0.0, 0.0], [10.0, 10.0]), walls), Sizes(0.3, 0.05)
    )
    assert max(asked) < 50
