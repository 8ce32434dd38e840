"""A falling disk, bodies and fluid and mesh together: order 2 in time, also through a remesh and changes of step."""

import numpy as np
import pytest
from falling import falling_disk

from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

END, REMESH = 0.16, 0.08


class Interrupted(Simulation):
    """Re-makes its mesh half-way, and may halve every other step."""

    def __init__(self, step, uneven):
        super().__init__(
            falling_disk(mesh={"size": 0.3, "size_body": 0.03}, time={"step": step, "end": END}, output={"every": 1.0}),
            None,
            False,
        )
        self.uneven = uneven
        self.mesh_updater.needs_remesh = lambda state, pose: state.tick == self.clock.tick_from(REMESH)
        self.stepper.propose = self._uneven

    def _uneven(self, state):
        odd = state.tick // self.clock.ticks(0) % 2
        return max(self.stepper.longest(state), int(self.uneven and odd))


def fall(step, uneven):
    simulation = Interrupted(step, uneven)
    simulation.go()
    assert simulation.counts.remeshes == 1
    assert simulation.state.count == round(END / step * (1.5 if uneven else 1.0))
    return np.array([simulation.state.pose.position[0, 1], simulation.state.twist.velocity[0, 1]])


@pytest.mark.parametrize("uneven", [False, True], ids=["even", "uneven"])
def test_height_and_velocity_have_order_two(uneven):
    coarse, middle, fine = (fall(step, uneven) for step in (0.008, 0.004, 0.002))
    order = np.log2(np.abs(coarse - middle) / np.abs(middle - fine))
    assert np.all(order > 1.8), order
