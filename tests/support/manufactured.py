"""Unit squares without bodies, and a scikit-fem backend on them, for manufactured solutions."""

import numpy as np
from skfem import MeshTri

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.time_scheme import derivative_weights, extrapolation_weights
from rigidfluid.core.types import BoundaryCondition, FluidProblem, Mesh, Pose, Step, Twist

NO_POSE = Pose(np.zeros((0, 2)), np.zeros((0, 1)))
NO_TWIST = Twist(np.zeros((0, 2)), np.zeros((0, 1)))
NORMALS = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])


def unit_square(refinements):
    mesh = MeshTri.init_symmetric().refined(refinements)
    points, facets = mesh.p.T.copy(), mesh.facets.T[mesh.boundary_facets()]
    x, y = points[facets].mean(axis=1).T
    markers = np.select([x < 1e-9, x > 1 - 1e-9, y < 1e-9], [0, 1, 2], 3)
    return Mesh(points, mesh.t.T.astype(np.int64), facets.astype(np.int64), markers)


def backend(velocity, density, viscosity, source=None, tolerance=1e-12):
    """Velocity prescribed on all four faces."""
    faces = tuple(BoundaryCondition(i, str(i), "velocity", NORMALS[i], velocity) for i in range(4))
    return ScikitFem(
        ScikitFem.Options(tolerance=tolerance), FluidProblem(2, 0, density, viscosity, True, faces, source)
    )


def step_to(time, points, size, previous_size=None, derivative=None):
    return Step(
        time=time,
        derivative=derivative_weights(size, previous_size) if derivative is None else derivative,
        extrapolation=extrapolation_weights(size, previous_size),
        pose=NO_POSE,
        points=points,
        mass_matrix=np.zeros((0, 3, 3)),
        load=np.zeros((0, 3)),
        controlled=np.zeros(0, dtype=bool),
        controlled_twist=np.zeros((0, 3)),
    )
