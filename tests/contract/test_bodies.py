from pathlib import Path

import numpy as np
import pytest

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.polygon import Polygon, PolygonOptions
from rigidfluid.bodies.polyhedron import Polyhedron, PolyhedronOptions
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


def wedge_with_a_notch() -> tuple[np.ndarray, list[list[int]]]:
    """A box, longer than wide, whose top goes in to a point; seen from outside its triangles go round to the left."""
    corners = [[x, y, z] for x in (0.0, 2.0) for y in (0.0, 1.0) for z in (0.0, 0.7)]
    squares = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4]]
    triangles = [[a, b, c] for a, b, c, _ in squares] + [[a, c, d] for a, _, c, d in squares]
    triangles += [[1, 5, 8], [5, 7, 8], [7, 3, 8], [3, 1, 8]]
    # turned, as faces along the grid that the contract counts on would be a cell off
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    return np.array([*corners, [0.8, 0.5, 0.3]]) @ turn, triangles


def write_stl(path: Path, points: np.ndarray, triangles: list[list[int]]) -> str:
    facets = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex " + " ".join(map(repr, points[corner].tolist())) + "\n" for corner in corners)
        + "endloop\nendfacet\n"
        for corners in triangles
    ]
    path.write_text("solid\n" + "".join(facets) + "endsolid\n", encoding="ascii")
    return str(path)


class TestPolyhedron(BodyContract):
    @pytest.fixture(params=[1.0, 0.01])
    def body(self, request: pytest.FixtureRequest, tmp_path: Path) -> Body:
        file = write_stl(tmp_path / "wedge.stl", *wedge_with_a_notch())
        return Polyhedron(PolyhedronOptions(file=file, scale=request.param), 3)
