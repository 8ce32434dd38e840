"""Forces on the pieces of the boundary: flows known in closed form, exact where elements have them, to the corners."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from curved_channels import ANGLE, DROP, INNER, OUTER, bend, bend_faces
from curved_channels import VISCOSITY as BEND_VISCOSITY
from sheared_materials import materials

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.conditions import NoSlip, Periodic, PrescribedPressure, PrescribedVelocity, Slip
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.boundary_forces import BoundaryForces
from rigidfluid.core.model.types import Mesh
from rigidfluid.testing.fluid.boxes import box, nobody
from rigidfluid.testing.fluid.exact import FACES, LinearFlow, enclosed, inward_normal, problem
from rigidfluid.testing.fluid.flow import Flow

PUSH = 2.0


def forces_of(posed: FluidProblem, mesh: Mesh) -> BoundaryForces:
    backend = ScikitFem(ScikitFem.Options(tolerance=1e-12), posed)
    flow = Flow.start(backend, mesh, nobody(posed.dimension))
    found = flow.taken(replace(flow.step_after(None), boundary_forces=True), None).advance.boundary_forces
    assert found is not None
    return found


def half_channel(dimension: int, turn: FloatArray) -> BoundaryForces:
    """Forces in the frame of a channel that is turned: a wall below, planes of symmetry above and aside, and pressures
    at both ends."""
    kinds: dict[str, Any] = {"x1": PrescribedPressure, "y1": Slip, "z0": Slip, "z1": Slip}
    kinds["x0"] = partial(PrescribedPressure, value=lambda _, at: np.full(len(at), PUSH))
    posed, mesh = problem(dimension, kinds, inertia=False), box(dimension, 3)
    conditions = [replace(one, normal=turn @ one.normal) for one in posed.conditions if one.normal is not None]
    found = forces_of(replace(posed, conditions=tuple(conditions)), mesh.moved_to(mesh.points @ turn.T))
    return replace(found, force=found.force @ turn)


def turned(dimension: int) -> FloatArray:
    axis = np.array([[0.9, 0.2, -0.3, 0.1]])
    orientation = np.array([[0.4]]) if dimension == 2 else axis / np.linalg.norm(axis)
    return np.asarray(rotation_matrices(orientation)[0])


@pytest.mark.parametrize("oblique", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_half_a_channel_holds_what_its_ends_push(dimension: int, oblique: bool) -> None:
    """The wall has all the shear; slip has the pressure alone, and ends also their shear."""
    found = half_channel(dimension, turned(dimension) if oblique else np.eye(dimension))
    wanted = np.zeros((2 * dimension, dimension))
    wanted[0, :2] = -PUSH, 0.5 * PUSH  # ∫ μ du/dy = G/2 · height²
    wanted[1, :2] = 0.0, -0.5 * PUSH
    wanted[2, :2] = PUSH, -0.5 * PUSH
    wanted[3, :2] = 0.0, 0.5 * PUSH
    if dimension == 3:
        wanted[4:, 2] = -0.5 * PUSH, 0.5 * PUSH
    np.testing.assert_allclose(found.force, wanted, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.area, 1.0, rtol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("name", ["carreau", "bingham"])
def test_a_viscosity_that_varies_is_that_of_the_shear_rate(name: str, dimension: int) -> None:
    """A uniform shear, on all faces, with the stress of its rate, also at corners."""
    material, exact = materials(dimension)[name], LinearFlow.shear(dimension)
    posed = replace(enclosed(dimension, exact.velocity, inertia=False), material=material)
    strain = exact.gradient + exact.gradient.T
    viscosity = material.viscosity(np.array([np.sqrt(0.5 * np.sum(strain**2))]))[0]
    assert abs(viscosity / material.dynamic_viscosity - 1.0) > 0.1
    found = forces_of(posed, box(dimension, 2))
    wanted = [viscosity * strain @ inward_normal(face, dimension) for face in range(2 * dimension)]
    np.testing.assert_allclose(found.force, wanted, rtol=0, atol=1e-7)


def forces_in_bend(layers: int, inner: type[Any]) -> BoundaryForces:
    return forces_of(FluidProblem(2, 0, 1.0, Newtonian(BEND_VISCOSITY), False, bend_faces(inner)), bend(layers))


def exact_in_bend(inner: type[Any]) -> FloatArray:
    """Forces (2, 2) on the inner and the outer wall of u = (G/2μ)(A r + B/r - r ln r), p = DROP - G φ, by Gauss' rule:
    -p n and the stress along the wall, -G (B/r² + ½)."""
    slope = DROP / ANGLE
    if inner is Slip:
        b = -0.5 * INNER**2
    else:
        b = np.linalg.solve([[r, 1.0 / r] for r in (INNER, OUTER)], [r * np.log(r) for r in (INNER, OUTER)])[1]
    root, weight = np.polynomial.legendre.leggauss(30)
    turn, weight = 0.5 * ANGLE * (1.0 + root), 0.5 * ANGLE * weight
    across, along = np.column_stack([np.cos(turn), np.sin(turn)]), np.column_stack([-np.sin(turn), np.cos(turn)])
    pressure = DROP - slope * turn
    found = []
    for radius, sign in ((INNER, 1.0), (OUTER, -1.0)):
        shear = -slope * (b / radius**2 + 0.5)
        found.append(sign * radius * weight @ (shear * along - pressure[:, None] * across))
    return np.array(found)


@pytest.mark.parametrize("inner", [NoSlip, Slip])
def test_forces_on_curved_walls_converge(inner: type[Any]) -> None:
    """With the third order at least; areas are those of arcs."""
    wanted, errors = exact_in_bend(inner), []
    for layers in (4, 8):
        found = forces_in_bend(layers, inner)
        errors.append(np.linalg.norm(found.force[:2] - wanted) / np.linalg.norm(wanted))
        np.testing.assert_allclose(found.force.sum(axis=0), 0.0, atol=1e-9)
    assert errors[0] > 7.0 * errors[1] > 0.0
    assert errors[1] < 1e-4
    np.testing.assert_allclose(found.area[:2], ANGLE * np.array([INNER, OUTER]), rtol=1e-5)


def test_walls_that_meet_in_a_flow_with_errors_hold_all_of_its_force() -> None:
    """A lid slides in a cavity with a slippery floor, which feels nothing along itself: forces add up to zero."""

    def sliding(_time: float, at: FloatArray) -> FloatArray:
        return np.column_stack([at[:, 0] * (1.0 - at[:, 0]), np.zeros(len(at))])

    lid = partial(PrescribedVelocity, value=sliding)
    found = forces_of(problem(2, {FACES[2]: Slip, FACES[3]: lid}, inertia=False), box(2, 6)).force
    np.testing.assert_allclose(found.sum(axis=0), 0.0, atol=1e-10)
    assert abs(found[2, 0]) < 1e-10
    assert found[3, 0] < -0.5


def test_walls_of_a_periodic_duct_hold_the_drop_of_pressure() -> None:
    """Its edges go on through the ends: what nodes there and their images have is one force."""
    posed = problem(3, inertia=False)
    first, second, *walls = posed.conditions
    ends = (
        Periodic(0, first.name, first.normal, 1, lambda _, at: np.full(len(at), PUSH)),
        Periodic(1, second.name, second.normal),
    )
    found = forces_of(replace(posed, conditions=(*ends, *walls)), box(3, 4))
    np.testing.assert_array_equal(found.force[:2], 0.0)
    np.testing.assert_array_equal(found.area[:2], 0.0)
    np.testing.assert_allclose(found.force.sum(axis=0), [PUSH, 0.0, 0.0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.force[2:, 0], 0.25 * PUSH, rtol=0.02)


def test_a_part_of_the_mesh_may_have_no_facet_of_a_piece() -> None:
    """As with several processes: the piece then has nothing here."""
    mesh = box(2, 2)
    found = forces_of(problem(2, inertia=False), mesh)
    without = replace(mesh, facets=mesh.facets[mesh.markers != 3], markers=mesh.markers[mesh.markers != 3])
    assert found.area[3] == pytest.approx(1.0)
    assert forces_of(problem(2, inertia=False), without).area[3] == 0.0
