"""The three-sphere swimmer in 3D against the exact flow without walls, which is held to known figures itself."""

import numpy as np
import pytest
from spheres_in_box import BACK, SCENE, swim_of, swim_scene
from spheres_on_a_line import cycle, drag, velocities

import rigidfluid
from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

ARM, STROKE = 10.0, 4.0


@pytest.mark.parametrize("alpha", [0.5, 1.0, 2.0])
def test_two_spheres_in_a_row_are_dragged_as_stimson_and_jeffery_say(alpha):
    """Proc. R. Soc. Lond. A 111 (1926) 110, doi:10.1098/rspa.1926.0053; centres are 2 cosh α apart."""
    n, sinh = np.arange(1, 60), np.sinh
    opposed = 4.0 * sinh((n + 0.5) * alpha) ** 2 - (2 * n + 1) ** 2 * sinh(alpha) ** 2
    term = 1.0 - opposed / (2.0 * sinh((2 * n + 1) * alpha) + (2 * n + 1) * sinh(2.0 * alpha))
    exact = 4.0 / 3.0 * sinh(alpha) * np.sum(n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * term)
    assert drag(np.array([0.0, 2.0 * np.cosh(alpha)]), np.ones(2)) == pytest.approx(exact, rel=1e-6)


def test_swimmers_of_short_strokes_go_as_golestanian_and_ajdari_say():
    """7/12 amplitude²/arm² for long arms (Phys. Rev. E 77 (2008) 036308, doi:10.1103/PhysRevE.77.036308)."""
    arm, amplitude = 400.0, 0.8
    assert cycle(arm, amplitude).sum() == pytest.approx(
        7.0 / 12.0 * (amplitude / (arm - amplitude / 2.0)) ** 2, rel=0.01
    )


def test_a_stroke_begins_with_the_exact_velocity():
    instant = ["time.step=1e-4", "time.end=1e-4", "mechanism.0.density=1e-9", "mesh.size_body=1.0"]
    simulation = Simulation(rigidfluid.load_scene(SCENE, instant))
    simulation.step()
    exact = velocities(np.array([-ARM, 0.0, ARM]), np.array([STROKE, 0.0, 0.0]))
    assert simulation.state.twist.velocity[:, 0] == pytest.approx(exact, rel=0.01)


@pytest.mark.validation
def test_a_cycle_moves_it_as_far_as_without_walls():
    """Without a new start at each corner of the strokes it would go 1.9 % too far."""
    found = swim_of(rigidfluid.run(swim_scene()))
    exact = cycle(ARM, STROKE)
    assert found.displacement == pytest.approx(exact.sum(), rel=0.01)
    assert found.strokes == pytest.approx(exact, rel=0.005)
    assert found.across < 1e-3


@pytest.mark.validation
def test_strokes_in_reverse_swim_back():
    back = swim_of(rigidfluid.run(swim_scene(overrides=[BACK])))
    assert back.displacement == pytest.approx(-cycle(ARM, STROKE).sum(), rel=0.01)
