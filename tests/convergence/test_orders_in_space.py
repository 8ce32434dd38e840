"""A steady manufactured flow: velocity of order 3, pressure of order 2 in L²."""

import numpy as np
from manufactured import NO_POSE, NO_TWIST, backend, step_to, unit_square

from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly
from rigidfluid.taylor_hood.numbering import Numbering

DENSITY, VISCOSITY = 1.3, 0.7
DRIFT = np.array([1.0, 0.5])


def waves(points):
    x, y = np.pi * points.T
    return np.sin(x), np.cos(x), np.sin(y), np.cos(y)


def velocity(_time, points):
    sx, cx, sy, cy = waves(points)
    return np.column_stack([sx * cy, -cx * sy]) + DRIFT


def pressure(points):
    return np.cos(np.pi * points[:, 0]) * np.sin(2 * np.pi * points[:, 1])


def source(time, points):
    sx, cx, sy, cy = waves(points)
    u = velocity(time, points)
    along_x = np.pi * np.column_stack([cx * cy, sx * sy])
    along_y = np.pi * np.column_stack([-sx * sy, -cx * cy])
    convection = u[:, :1] * along_x + u[:, 1:] * along_y
    laplacian = -2 * np.pi**2 * (u - DRIFT)
    twice = 2 * np.pi * points[:, 1]
    slope = np.pi * np.column_stack([-sx * np.sin(twice), 2 * cx * np.cos(twice)])
    return DENSITY * convection - VISCOSITY * laplacian + slope


def l2(integrals, points, error):
    vectors = error.reshape(len(error), -1) @ np.eye(error.ndim, 2)
    return np.sqrt(np.sum(vectors * integrals.mass_times(points, vectors)))


def errors(refinements):
    """L² errors of the Oseen step whose advecting field is the exact one: the space alone decides."""
    mesh = unit_square(refinements)
    fluid = backend(velocity, DENSITY, VISCOSITY, source)
    state = dict(fluid.initial(mesh, NO_POSE, NO_TWIST)[0])
    numbering = Numbering(mesh.cells, len(mesh.points))
    nodes = numbering.node_points(mesh.points)
    state["velocity"] = velocity(0.0, nodes)
    found = fluid.advance(state, mesh, step_to(0.0, mesh.points, 1.0, derivative=np.zeros(3))).fluid
    off = numbering.node_points(found["pressure"]) - pressure(nodes)
    measured = (found["velocity"] - velocity(0.0, nodes), off - off.mean())
    return [l2(CompiledAssembly(numbering), mesh.points, error) for error in measured]


def test_velocity_has_order_three_and_pressure_order_two():
    coarse, fine = errors(3), errors(5)
    velocity_order, pressure_order = np.log2(np.divide(coarse, fine)) / 2
    assert velocity_order > 2.95
    assert pressure_order > 1.9
    assert fine[0] < 1e-6
