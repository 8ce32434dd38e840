"""Bodies of next to no mass in a cell that no wall holds go with the fluxes that are held, without inertia."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scenes import wet_tables

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.errors import StepError

BALL = {"type": "sphere", "radius": 0.2, "position": [0.5, 0.5]}


def run(fluxes: tuple[float | None, float | None], **body: Any) -> Simulation:
    """A disk in a square that is periodic in both directions, in Stokes flow, after a step."""
    sides: list[dict[str, Any]] = [{"on": side, "type": "periodic"} for side in ("left", "right", "bottom", "top")]
    for side, flux in zip(sides[::2], fluxes, strict=True):
        side |= {} if flux is None else {"flux": flux}
    fluid = {"model": "stokes", "viscosity": 1.0, "gravity": [0.3, -1.0]}
    made = Simulation(scene_from_dict(wet_tables(BALL | body, boundary=sides, fluid=fluid, end=0.01, step=0.01)))
    made.step()
    return made


@pytest.mark.parametrize("density", [1e-8, 1e-16])
def test_a_light_disk_rises_as_one_that_is_held_in_the_opposite_flow_is_pushed(density: float) -> None:
    """In the frame of the disk both are one flow, however light it is."""
    rising = run((0.0, 0.0), density=density)
    u, v = rising.state.twist.velocity[0]
    assert v > 1e-3
    held = run((-u, -v), density=1.0, fixed=True)
    push = rising.system.weight[0]
    np.testing.assert_allclose(-held.state.motions.hydrodynamic.force[0], push, rtol=1e-6)


def test_a_light_disk_goes_with_the_fluid() -> None:
    went = run((1.0, -0.5), density=1e-10, position=[0.3, 0.4])
    still = run((0.0, 0.0), density=1e-10, position=[0.3, 0.4])
    change = went.state.twist.velocity[0] - still.state.twist.velocity[0]
    np.testing.assert_allclose(change, [1.0, -0.5], rtol=0, atol=1e-8)
    np.testing.assert_allclose(
        went.system.backend.driving(went.state.fluid, went.state.mesh)[:, 0], [1.0, -0.5], atol=1e-12
    )


@pytest.mark.parametrize("fluxes", [(None, None), (1.0, None)], ids=["none", "one"])
def test_a_light_disk_whose_velocity_nothing_tells_is_refused(fluxes: tuple[float | None, float | None]) -> None:
    with pytest.raises(StepError, match="a flux on one surface of each periodic pair"):
        run(fluxes, density=1e-10)
