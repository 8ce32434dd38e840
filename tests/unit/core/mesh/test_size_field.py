"""The wanted size asks for a wall's distance where a gap may be narrow alone."""

import numpy as np
import pytest
from mesh_tools import ball, box, box_walls, ellipsoid, upright

from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import ALONG_FILM, FINER_IN_FILMS, Sizes, wanted_size


@pytest.mark.parametrize("cells", [1.0, 2.0, 7.0])
def test_it_is_what_the_formula_says_everywhere(cells: float) -> None:
    bodies, pose = [ball(0.2), ellipsoid(0.3, 0.1), ball(0.1)], upright([0.25, 0.5], [0.8, 0.52], [0.6, 1.6])
    walls, sizes = box_walls([0.0, 0.0], [2.0, 2.0], 3), Sizes(0.3, 0.05, 0.2, cells)
    points = np.random.default_rng(2).uniform(0.0, 2.0, (20000, 2))
    away = np.sort([np.maximum(distance_to_body(pose, i, body, points), 0.0) for i, body in enumerate(bodies)], axis=0)
    wall = np.min([wall.shape.signed_distance(points) for wall in walls], axis=0)
    gap = away[0] + np.minimum(away[1], wall)
    open_size = np.minimum(0.05 + 0.2 * away[0], 0.3)
    least = np.clip(ALONG_FILM * np.sqrt(0.1**2 / 0.3 * gap), FINER_IN_FILMS * sizes.smallest, sizes.smallest)
    expected = np.minimum(open_size, np.maximum(gap / cells, least))
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


@pytest.mark.parametrize("refinements", [5, 4])
def test_cells_in_a_film_resolve_the_pressure_along_it(refinements: int) -> None:
    """Down to an eighth of the smallest size for a gap; in wider gaps, and with fewer refinements, none are finer."""
    gap, sizes = np.array([1e-2, 1e-3, 1e-4, 1e-7]), Sizes(6.0, 0.25, refinements=refinements)
    domain = box([-9.0, 0.0], [9.0, 9.0])
    walls = box_walls([-9.0, 0.0], [9.0, 9.0], 1)
    wanted = [
        wanted_size(
            np.array([[0.0, 0.5 * each]]), FluidDomain([ball(1.0)], upright([0.0, 1.0 + each]), domain, walls), sizes
        )
        for each in gap
    ]
    expected = [sizes.smallest, 0.12 * np.sqrt(1e-3), 0.12 * np.sqrt(1e-4), sizes.smallest / 8.0]
    if refinements < 5:
        expected = [sizes.smallest] * 4
    np.testing.assert_allclose(np.concatenate(wanted), expected, rtol=1e-9)
