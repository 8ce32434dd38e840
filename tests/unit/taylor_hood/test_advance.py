"""Velocity of a mesh in motion, as a step differences it and as convection is told of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.backends.scikit_fem.backend import ScikitFem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.stepping.advance import Equations, step_matrix
from rigidfluid.testing.fluid.boxes import box, nobody
from rigidfluid.testing.fluid.exact import DENSITY, problem
from rigidfluid.testing.fluid.flow import Flow

BEFORE, STEP = 0.1, 0.2
"""Length of the latest step and of the next one."""


def moving(latest: FloatArray) -> tuple[ScikitFem, Flow]:
    """Fluid at rest, on a mesh whose points have come from ``latest`` in the step before."""
    backend = ScikitFem(ScikitFem.Options(), problem(2))
    flow = Flow.start(backend, box(2, 2), nobody(2))
    fluid = {**flow.fluid, "points_previous": latest}
    return backend, replace(flow, fluid=fluid, past=(flow.pose, flow.twist, BEFORE))


def test_a_mesh_that_grows_faster_and_faster_has_the_velocity_at_the_end_of_the_step() -> None:
    """Exact for points on parabolas: X (1 + t + t²) at t = -0.1, 0, 0.2."""
    points = box(2, 2).points
    backend, flow = moving((1.0 - BEFORE + BEFORE**2) * points)
    step = flow.step_after(STEP, points=(1.0 + STEP + STEP**2) * points)
    discretisation = backend._discretisation(flow.mesh, flow.bodies.prescribed)
    matrix = step_matrix(discretisation, flow.fluid, flow.mesh, step)
    expected = (1.0 + 2.0 * STEP) * discretisation.numbering.node_points(points)
    found = Equations(discretisation, matrix, flow.fluid, flow.mesh, step).mesh_velocity()
    np.testing.assert_allclose(found, expected, atol=1e-14)
    np.testing.assert_allclose(matrix.advection, -DENSITY * expected, atol=1e-14)


def test_a_mesh_without_new_points_goes_on_as_it_did() -> None:
    """Fluid at rest is convected against the mesh's velocity, on the points where the mesh is now."""
    velocity = np.array([0.3, -0.2])
    backend, flow = moving(box(2, 2).points - BEFORE * velocity)
    step = replace(flow.step_after(STEP), points=None)
    matrix = step_matrix(backend._discretisation(flow.mesh, flow.bodies.prescribed), flow.fluid, flow.mesh, step)
    np.testing.assert_array_equal(matrix.points, flow.mesh.geometry)
    np.testing.assert_allclose(matrix.advection, np.broadcast_to(-DENSITY * velocity, matrix.advection.shape))
