"""Flow between a plane of symmetry and a wall, driven by pressures: P2-P1 has it exactly, in 2D and in 3D."""

from dataclasses import replace

import numpy as np
import pytest
from manufactured import step_to
from skfem import MeshTet, MeshTri

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.boundary import inward_normal
from rigidfluid.core.types import BoundaryCondition, FluidProblem, Mesh, Pose, Twist
from rigidfluid.taylor_hood.numbering import Numbering

DENSITY, VISCOSITY, DROP, BACK = 1.3, 0.7, 2.0, 0.4


def box(dimension):
    """The unit box; its faces carry the markers of a scene's: left, right, bottom, top, back, front."""
    mesh = (MeshTri if dimension == 2 else MeshTet).init_tensor(*[np.linspace(0, 1, 3 + i) for i in range(dimension)])
    facets = mesh.facets.T[mesh.boundary_facets()]
    middle = mesh.p.T[facets].mean(axis=1)
    near = np.stack([middle, 1 - middle], axis=2).reshape(len(facets), -1)
    return Mesh(mesh.p.T.copy(), mesh.t.T.astype(np.int64), facets.astype(np.int64), np.argmin(near, axis=1))


def channel(dimension, inertia):
    types = ["pressure", "pressure", "slip", "wall", "slip", "slip"][: 2 * dimension]
    values = {0: lambda _, x: np.full(len(x), DROP + BACK), 1: lambda _, x: np.full(len(x), BACK)}
    faces = tuple(
        BoundaryCondition(i, str(i), kind, inward_normal(i, dimension), values.get(i)) for i, kind in enumerate(types)
    )
    return ScikitFem(ScikitFem.Options(tolerance=1e-12), FluidProblem(dimension, 0, DENSITY, VISCOSITY, inertia, faces))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("inertia", [False, True], ids=["stokes", "navier-stokes"])
def test_half_a_channel(dimension, inertia):
    mesh, fluid = box(dimension), channel(dimension, inertia)
    rotations = 1 if dimension == 2 else 3
    size = dimension + rotations
    nobody = Pose(np.zeros((0, dimension)), np.zeros((0, 1 if dimension == 2 else 4)))
    state, _ = fluid.initial(mesh, nobody, Twist(np.zeros((0, dimension)), np.zeros((0, rotations))))
    nodes = Numbering(mesh.cells, len(mesh.points)).node_points(mesh.points)
    exact = np.zeros_like(nodes)
    exact[:, 0] = DROP / (2 * VISCOSITY) * (1 - nodes[:, 1] ** 2)
    step = replace(
        step_to(0.0, mesh.points, 1.0, derivative=np.zeros(3)),
        pose=nobody,
        mass_matrix=np.zeros((0, size, size)),
        load=np.zeros((0, size)),
        controlled_twist=np.zeros((0, size)),
    )
    found = fluid.advance({**state, "velocity": exact}, mesh, step)
    np.testing.assert_allclose(found.fluid["velocity"], exact, atol=1e-9)
    np.testing.assert_allclose(found.fluid["pressure"], BACK + DROP * (1 - mesh.points[:, 0]), atol=1e-9)
    work = DROP**2 / (3 * VISCOSITY)  # pressure drop times flow rate
    assert found.dissipation == pytest.approx(work)
    assert found.boundary_power == pytest.approx(work)
    kinetic = 0.5 * DENSITY * (DROP / (2 * VISCOSITY)) ** 2 * 8 / 15
    assert found.kinetic_energy == (pytest.approx(kinetic) if inertia else 0.0)
