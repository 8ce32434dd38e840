"""On a moving mesh, with flows that P2–P1 represents exactly, only time errs: order 2, and 0 for uniform flow."""

import numpy as np
import pytest
from manufactured import NO_POSE, NO_TWIST, backend, step_to, unit_square

from rigidfluid.taylor_hood.numbering import Numbering

DENSITY, VISCOSITY, END = 1.3, 0.2, 0.5


def moving(mesh, time):
    """Vertices of a mesh whose inside sways while its boundary stays."""
    bump = np.prod(np.sin(np.pi * mesh.points), axis=1)[:, None]
    return mesh.points + 0.06 * bump * np.array([np.sin(6 * time), np.cos(5 * time) - 1.0])


def velocity(time, points):
    x, y = points.T
    return np.column_stack([y, x]) * np.sin(3 * time) + np.array([np.cos(2 * time), 0.5 * np.sin(time)])


def source(time, points):
    u = velocity(time, points)
    unsteady = points[:, ::-1] * 3 * np.cos(3 * time) + np.array([-2 * np.sin(2 * time), 0.5 * np.cos(time)])
    return DENSITY * (unsteady + u[:, ::-1] * np.sin(3 * time))


def run(sizes, velocity, source, density=DENSITY):
    """Largest nodal error at END after steps of these sizes on the swaying mesh."""
    mesh = unit_square(2)
    fluid = backend(velocity, density, VISCOSITY, source)
    state = dict(fluid.initial(mesh, NO_POSE, NO_TWIST)[0])
    space = Numbering(mesh.cells, len(mesh.points))
    state["velocity"] = velocity(0.0, space.node_points(mesh.points))
    time, before, now = 0.0, None, mesh
    for size in sizes:
        time += size
        points = moving(mesh, time)
        state = fluid.advance(state, now, step_to(time, points, size, before)).fluid
        now, before = type(mesh)(points, mesh.cells, mesh.facets, mesh.markers), size
    return np.abs(state["velocity"] - velocity(time, space.node_points(points))).max()


def uneven(count):
    """Steps that halve and double again and again."""
    pattern = np.tile([1.0, 0.5, 0.5, 1.0, 1.0], count)
    return pattern * (END / pattern.sum())


@pytest.mark.parametrize("sizes", [lambda n: np.full(5 * n, END / (5 * n)), uneven], ids=["even", "uneven"])
def test_order_two_on_a_moving_mesh(sizes):
    coarse, fine = run(sizes(4), velocity, source), run(sizes(16), velocity, source)
    order = np.log2(coarse / fine) / 2
    assert order > 1.85, (coarse, fine)


def test_uniform_flow_is_kept():
    def uniform(_time, points):
        return np.tile([1.0, -0.5], (len(points), 1))

    assert run(uneven(6), uniform, None) < 1e-10
