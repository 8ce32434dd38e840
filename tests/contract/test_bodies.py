import numpy as np
import pytest

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.polygon import Polygon, PolygonOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.model.interfaces import Body
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


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
L_SHAPE = [[3.0, 1.0], [5.0, 1.0], [5.0, 1.5], [3.5, 1.5], [3.5, 2.0], [3.0, 2.0]]
TURNS = 0.2 * np.pi * np.arange(10)
CLOCKWISE_STAR = (np.resize([1.0, 0.3], 10) * [np.sin(TURNS), np.cos(TURNS)]).T.tolist()


class TestPolygon(BodyContract):
    @pytest.fixture(params=[SQUARE, L_SHAPE, CLOCKWISE_STAR], ids=["square", "L", "star"])
    def body(self, request: pytest.FixtureRequest) -> Body:
        return Polygon(PolygonOptions(points=request.param), 2)
