"""The detectors that read the mesh, held to the contract on meshes of balls in a box."""

import numpy as np

from rigidfluid.core.interfaces import Detector
from rigidfluid.core.meshing import generate_mesh
from rigidfluid.core.types import FloatArray, Mesh
from rigidfluid.detectors.fast_marching import FastMarchingDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector, NarrowBandOptions
from rigidfluid.testing import Arrangement, DetectorContract

SIZE_BODY = {2: 0.02, 3: 0.1}


class MarchingContract(DetectorContract):
    """Chords h of two circles cut off h²/(8R) each, in space h²/(6R) or so: 0.007 with R = 0.25 and h = 0.1."""

    gap_tolerance = 0.008
    point_tolerance = 0.2
    detects_overlap = False

    def make_mesh(self, arrangement: Arrangement) -> Mesh:
        key = (arrangement.radii.tobytes(), arrangement.centres.tobytes(), arrangement.corners.tobytes())
        return _mesh(key, arrangement)

    def rotation(self, dimension: int) -> FloatArray:
        quarter = np.eye(dimension)
        quarter[:2, :2] = [[0.0, -1.0], [1.0, 0.0]]
        return quarter


class TestNarrowBandDetector(MarchingContract):
    def make_detector(self, arrangement: Arrangement) -> Detector:
        return NarrowBandDetector(NarrowBandOptions(), arrangement.bodies, arrangement.walls)


class TestFastMarchingDetector(MarchingContract):
    def make_detector(self, arrangement: Arrangement) -> Detector:
        return FastMarchingDetector(FastMarchingDetector.Options(), arrangement.bodies, arrangement.walls)


class TestFirstOrderNarrowBand(MarchingContract):
    def make_detector(self, arrangement: Arrangement) -> Detector:
        return NarrowBandDetector(NarrowBandOptions(accuracy="first-order"), arrangement.bodies, arrangement.walls)


_meshes: dict[tuple[bytes, ...], Mesh] = {}


def _mesh(key: tuple[bytes, ...], arrangement: Arrangement) -> Mesh:
    if key not in _meshes:
        _meshes[key] = _made(arrangement)
    return _meshes[key]


def _made(arrangement: Arrangement) -> Mesh:
    lower, upper = np.sort(arrangement.corners, axis=0)
    scale = (upper - lower)[0] / 4.0
    size_body = scale * SIZE_BODY[arrangement.dimension]
    mesh = generate_mesh(arrangement.bodies, arrangement.pose, lower, upper, 0.5 * scale, size_body, 0.5)
    return Mesh(mesh.points, mesh.cells, mesh.facets, _surface_numbers(arrangement, lower, upper)[mesh.markers])


def _surface_numbers(arrangement: Arrangement, lower: FloatArray, upper: FloatArray) -> np.ndarray:
    """The arrangement's number of each surface of the mesh: balls, faces that are walls, other faces."""
    count, further = len(arrangement.radii), len(arrangement.radii) + len(arrangement.walls)
    numbers = list(range(count))
    for face in range(2 * arrangement.dimension):
        corner, axis = (lower, upper)[face % 2], face // 2
        inward = np.eye(arrangement.dimension)[axis] * (1 - 2 * (face % 2))
        here = [
            wall.surface
            for wall in arrangement.walls
            if np.allclose(wall.normal, inward) and np.isclose(wall.point[axis], corner[axis])
        ]
        numbers.append(here[0] if here else further)
        further += not here
    return np.array(numbers)
