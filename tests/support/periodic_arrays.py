"""Arrays of balls in a flow that is the same round each of them."""

from __future__ import annotations

import numpy as np

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.conditions import Periodic, no_pressure
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.model.types import Pose
from rigidfluid.testing.fluid.curved import CENTRE, RADIUS, ball_in_a_box
from rigidfluid.testing.fluid.flow import Bodies, Flow


def array_of_balls(dimension: int, layers: int) -> float:
    """Force on each ball of radius 0.2 in a cubic array of side 1, over μ times the mean velocity, in Stokes flow that
    a pressure drop drives; the flow is periodic in all directions."""
    faces = []
    for side in range(2 * dimension):
        lower, normal = side % 2 == 0, (1 - 2 * (side % 2)) * np.eye(dimension)[side // 2]
        drop = (lambda _, at: np.ones(len(at))) if side == 0 else no_pressure
        faces.append(Periodic(1 + side, str(side), normal, 2 + side if lower else None, drop))
    posed = FluidProblem(dimension, 1, 1.0, Newtonian(1.0), False, tuple(faces))
    pose = Pose(np.full((1, dimension), CENTRE), np.eye(1, 1 if dimension == 2 else 4))
    start = Flow.start(
        ScikitFem(ScikitFem.Options(tolerance=1e-12), posed),
        ball_in_a_box(dimension, layers),
        pose,
        Bodies.uniform(pose),
    )
    flow = start.after(None)
    force = float(flow.advance.hydrodynamic_wrench.force[0, 0])
    # power = force · mean velocity, since the ball rests
    return force**2 / flow.advance.boundary_power


def exact_array(dimension: int) -> float:
    """The same by series in the balls' share of the volume (Sangani and Acrivos 1982, doi:10.1016/0301-9322(82)90029-5
    for cylinders, doi:10.1016/0301-9322(82)90047-7 for spheres)."""
    if dimension == 2:
        c = np.pi * RADIUS**2
        return float(4.0 * np.pi / (-0.5 * np.log(c) - 0.738 + c - 0.887 * c**2 + 2.038 * c**3))
    c = 4.0 / 3.0 * np.pi * RADIUS**3
    root = np.cbrt(c)
    series = 1.0 - 1.7601 * root + c - 1.5593 * c**2 + 3.9799 * root**8 - 3.0734 * root**10
    return float(6.0 * np.pi * RADIUS / series)
