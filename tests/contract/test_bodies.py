from pathlib import Path

import numpy as np
import pytest
from facet_shapes import L_SHAPE, NOTCHED, NOTCHED_TRIANGLES, SQUARE, polygon, polyhedron, text_stl

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.model.body import Body
from rigidfluid.testing import BodyContract


class TestSphere(BodyContract):
    @pytest.fixture(params=[2, 3])
    def body(self, request: pytest.FixtureRequest) -> Body:
        return Sphere(SphereOptions(radius=0.3), request.param)


class TestEllipsoid(BodyContract):
    @pytest.fixture(
        params=[[2.0, 1.0], [0.05, 1.0], [1.0, 1.0], [1.0, 2.0, 3.0], [0.3, 0.1, 0.1], [0.5, 0.5, 0.1]], ids=str
    )
    def body(self, request: pytest.FixtureRequest) -> Body:
        return Ellipsoid(EllipsoidOptions(semi_axes=request.param), len(request.param))


TURNS = 0.2 * np.pi * np.arange(10)
CLOCKWISE_STAR = (np.resize([1.0, 0.3], 10) * [np.sin(TURNS), np.cos(TURNS)]).T.tolist()


class TestPolygon(BodyContract):
    @pytest.fixture(params=[SQUARE, L_SHAPE, CLOCKWISE_STAR], ids=["square", "L", "star"])
    def body(self, request: pytest.FixtureRequest) -> Body:
        return polygon(request.param)


class TestPolyhedron(BodyContract):
    @pytest.fixture(params=[1.0, 0.01])
    def body(self, request: pytest.FixtureRequest, tmp_path: Path) -> Body:
        # turned, as faces along the grid that the contract counts on would be a cell off
        turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
        return polyhedron(text_stl(tmp_path / "box.stl", NOTCHED @ turn, NOTCHED_TRIANGLES), request.param)
