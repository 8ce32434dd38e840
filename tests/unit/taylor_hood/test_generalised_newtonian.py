"""Flows of fluids whose viscosity varies, against closed forms."""

import numpy as np
import pytest
from sheared_materials import (
    channel_flow,
    channel_speed,
    materials,
    turning_flow,
    turning_torque,
)

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.errors import StepRejected
from rigidfluid.materials.carreau import Carreau, CarreauOptions
from rigidfluid.taylor_hood.stepping import newton
from rigidfluid.testing.fluid.boxes import samples
from rigidfluid.testing.fluid.flow import Flow, figures


def channel_error(name, divisions, dimension=2):
    """Relative error of the velocity at points of the channel; the powers of the flow agree."""
    material = materials(dimension)[name]
    flow, points = channel_flow(material, divisions, dimension).after(None), samples(dimension)
    assert flow.advance.boundary_power == pytest.approx(flow.advance.dissipation, rel=1e-9)
    velocity, _ = flow.probe(points)
    exact = np.array([channel_speed(material, y) for y in points[:, 1]])
    return float(np.linalg.norm(velocity - np.outer(exact, np.eye(dimension)[0])) / np.linalg.norm(exact))


@pytest.mark.parametrize(
    "name", ["carreau", *(pytest.param(name, marks=pytest.mark.long) for name in ("cross", "power_law"))]
)
def test_a_channels_flow_converges_with_the_third_order(name):
    errors = [channel_error(name, divisions) for divisions in (4, 8, 16)]
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 2.8), errors


@pytest.mark.parametrize(
    "name", ["bingham", *(pytest.param(name, marks=pytest.mark.long) for name in ("thickening", "herschel_bulkley"))]
)
def test_a_channels_flow_converges_where_the_viscosity_varies_in_a_thin_layer(name):
    """Where γ̇ is small it does so faster than the coarser mesh resolves."""
    errors = [channel_error(name, divisions) for divisions in (4, 16)]
    assert np.log2(errors[0] / errors[1]) > 2.0 * 2.3, errors


def test_a_channels_flow_in_3d():
    errors = [channel_error("carreau", divisions, 3) for divisions in (2, 4)]
    assert np.log2(errors[0] / errors[1]) > 2.7, errors


@pytest.mark.parametrize("name", ["carreau", "bingham"])
def test_the_torque_on_a_turning_disk_converges_with_the_fourth_order(name):
    """On curved cells; a force converges with twice the order of the velocity's gradient."""
    material = materials(2)[name]
    errors = []
    for layers in (4, 8):
        torque = turning_flow(material, layers).advance.hydrodynamic_wrench.torque[0, 0]
        errors.append(abs(torque / -turning_torque(material) - 1.0))
    assert np.log2(errors[0] / errors[1]) > 3.6, errors


@pytest.mark.parametrize("name", ["carreau", "bingham"])
def test_blocks_solve_as_factors_do(name):
    """In 3D, whose pressures are preconditioned by the viscosity of each cell."""
    flow = channel_flow(materials(3)[name], 3, 3, inertia=True)
    by_blocks = ScikitFem(ScikitFem.Options(tolerance=1e-11, solver="schur"), flow.backend.problem)
    flows = [flow.after(0.1).after(0.1), Flow.start(by_blocks, flow.mesh, flow.pose).after(0.1).after(0.1)]
    found = [each.fluid["velocity"] for each in flows]
    np.testing.assert_allclose(found[1], found[0], atol=1e-8 * np.abs(found[0]).max())


def test_without_thinning_it_is_newtonian():
    options = CarreauOptions(viscosity=0.3, relaxation_time=2.0, exponent=1.0)
    flows = [channel_flow(each, 4, inertia=True) for each in (Carreau(options, 2), Newtonian(0.3))]
    for _ in range(3):
        flows = [flow.after(0.1) for flow in flows]
        carreau, newtonian = (figures(flow.advance) for flow in flows)
        for name, value in carreau.items():
            np.testing.assert_allclose(value, newtonian[name], rtol=1e-8, atol=1e-10)


def test_a_steps_stress_is_that_of_its_own_velocity():
    """Solved again from its solution, a steady flow stays as it is."""
    flow = channel_flow(materials(2)["carreau"], 4).after(None)
    again = flow.after(None)
    np.testing.assert_allclose(again.fluid["velocity"], flow.fluid["velocity"], atol=1e-9)


def test_an_iteration_that_does_not_converge_rejects_the_step(monkeypatch):
    monkeypatch.setattr(newton, "_MOST", 3)
    with pytest.raises(StepRejected, match=r"fluid\.material: found changes of the flow by 0\.\d+ after 3 iterations"):
        channel_flow(materials(2)["carreau"], 4).after(None)
