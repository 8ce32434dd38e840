import pytest

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
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
