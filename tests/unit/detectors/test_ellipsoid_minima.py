"""Places of facets nearest to many ellipsoids, by a compiled loop, against those of one after the other in arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from ellipsoid_twin import minima_of_one
from facet_shapes import BAR, CUBE, L_SHAPE, SQUARE, TRIANGLES, binary_stl, polygon, polyhedron
from mesh_tools import ellipsoid

from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.detectors.ellipsoid_on_facets import PlacedEllipsoids, ellipsoid_touches
from rigidfluid.detectors.placed_facets import Solid

REACH = 0.8
COUNT = 200


def placed(shape: Body, d: int) -> PlacedEllipsoids:
    """Ellipsoids of all sizes around and in a shape, one of them on its plane of symmetry."""
    rng = np.random.default_rng(d)
    turns = rng.uniform(0.0, 7.0, (COUNT, 1)) if d == 2 else rng.normal(size=(COUNT, 4))
    turns = turns if d == 2 else turns / np.linalg.norm(turns, axis=1, keepdims=True)
    position = 1.5 * shape.bounding_radius * rng.uniform(-1.0, 1.0, (COUNT, d))
    position[0, 1:], turns[0] = 0.0, 0.0 if d == 2 else [1.0, 0.0, 0.0, 0.0]
    return PlacedEllipsoids(rng.uniform(0.02, 0.6, (COUNT, d)), position, rotation_matrices(turns))


@pytest.fixture(params=["square", "bar", "l", "cube"])
def shape(request: pytest.FixtureRequest, tmp_path: Path) -> Body:
    if request.param == "cube":
        return polyhedron(binary_stl(tmp_path / "cube.stl", CUBE, TRIANGLES))
    return polygon({"square": SQUARE, "bar": BAR, "l": L_SHAPE}[request.param])


def test_places_of_many_ellipsoids_are_those_of_each(shape: Body) -> None:
    solid, bodies = Solid(FacetSurface(shape.facets)), placed(shape, shape.dimension)
    found, apart = ellipsoid_touches(bodies, solid, REACH), 0
    for row, (axes, position, rotation) in enumerate(zip(*bodies, strict=True)):
        expected = minima_of_one(ellipsoid(*axes), position, rotation, solid, REACH)
        mine = found.select(found.point == row)
        order = np.argsort(mine.distance, kind="stable")
        if expected.distance.min(initial=np.inf) < 0.0:  # edges in an ellipsoid may end on either side of a kink
            order, expected = order[:1], expected.select(np.array([0]))
        assert len(order) == len(expected.distance), row
        np.testing.assert_allclose(mine.distance[order], expected.distance, atol=1e-13)
        np.testing.assert_allclose(mine.foot[order], expected.foot, atol=1e-12)
        np.testing.assert_allclose(mine.normal[order], expected.normal, atol=1e-11)
        apart += len(order) > 0 and expected.distance[0] > 0.0
    assert 50 < apart < COUNT


def test_no_ellipsoid_has_no_places() -> None:
    solid = Solid(FacetSurface(polygon(SQUARE).facets))
    nobody = PlacedEllipsoids(np.empty((0, 2)), np.empty((0, 2)), np.empty((0, 2, 2)))
    assert len(ellipsoid_touches(nobody, solid, REACH).distance) == 0
