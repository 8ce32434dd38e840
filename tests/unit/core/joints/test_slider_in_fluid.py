"""Sliders in a fluid, with contacts: they stay on their axis and give no energy."""

import numpy as np
import pytest
from linked_runs import linked_scene, misfit
from paths import SCENES

from rigidfluid.core.case.load import load_scene
from rigidfluid.core.output.energy_account import energy_account
from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

SCENE = SCENES / "slider.toml"


def test_a_piston_that_hits_the_bottom_creates_no_energy():
    it, gaps = Simulation(load_scene(SCENE, ["time.step=0.002"])), []
    pushed = []
    it.observe(lambda now: gaps.append(misfit(now)))
    it.observe(lambda now: pushed.append(now.bodies["piston"].contact_force[1]))
    it.go()
    account = energy_account(it.history.energy)
    assert max(pushed) > 0.0
    assert it.history.joints["rate"].max() > 1.0
    assert max(gaps) < 1e-12
    assert account.created < 2e-4
    assert account.lost < 0.012
    way = it.history.joints["displacement"][-1] * np.array([0.3, 1.0]) / np.hypot(0.3, 1.0)
    np.testing.assert_allclose(it.bodies["piston"].position, [0.9, 0.5] + way, atol=1e-12)


@pytest.mark.parametrize("model", ["navier-stokes", pytest.param("stokes", marks=pytest.mark.nightly)])
def test_two_bodies_on_one_axis_that_turn_as_one_of_them_lands(model):
    """The axis is neither along the wall nor across it: the pair turns, and slides together against its spring."""
    keys = {"type": "ellipsoid", "semi_axes": [0.15, 0.1], "density": 3.0}
    bodies = [keys | {"name": "low", "position": [0.8, 0.19]}, keys | {"name": "high", "position": [1.1, 0.5]}]
    axis = {"type": "slider", "between": ["high", "low"], "axis": [1.0, 1.0], "stiffness": 40.0, "damping": 0.1}
    it = Simulation(
        linked_scene(
            bodies,
            [axis],
            contact={"law": "contact", "range": 0.06, "epsilon": "auto"},
            fluid={"density": 1.0, "viscosity": 0.3, "gravity": [0.0, -981.0], "model": model},
            mesh={"size": 0.3, "size_body": 0.07},
            end=0.06,
            step=0.002,
            upper=1.6,
        )
    )
    gaps, pushed = [], []
    it.observe(lambda now: gaps.append(misfit(now)))
    it.observe(lambda now: pushed.append(now.bodies["low"].contact_force[1]))
    it.go()
    account = energy_account(it.history.energy)
    joints = it.history.joints
    assert max(pushed) > 0.0
    assert max(gaps) < 1e-12
    assert np.abs(joints["displacement"]).max() > 0.01
    assert np.abs(it.bodies["low"].orientation[0]) > 0.03
    np.testing.assert_allclose(it.bodies["low"].orientation, it.bodies["high"].orientation, atol=1e-12)
    assert account.created < 1e-4
    assert account.lost < 0.006
