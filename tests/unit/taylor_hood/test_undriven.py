"""A flow without inertia that nothing drives any more."""

from __future__ import annotations

import numpy as np

from rigidfluid.api import Simulation, scene_from_dict


def test_a_creeping_flow_whose_inflow_ends_is_at_rest() -> None:
    """Then the right side of its system is zero, and no residual is small beside it."""
    inflow = {"on": "left", "type": "velocity", "velocity": [1.0, 0.0], "profile": "parabolic"}
    disk = {"name": "disk", "type": "sphere", "radius": 0.2, "density": 1.0, "position": [1.0, 0.5], "fixed": True}
    run = Simulation(
        scene_from_dict(
            {
                "scene": {"name": "undriven", "dimension": 2},
                "fluid": {"model": "stokes", "density": 1.0, "viscosity": 1.0},
                "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
                "boundary": [
                    inflow | {"over_time": [[0.0, 1.0], [0.25, 1.0], [0.5, 0.0], [1.0, 0.0]]},
                    {"on": "right", "type": "pressure", "pressure": 0.0},
                ],
                "body": [disk],
                "mesh": {"size": 0.5, "size_body": 0.2},
                "time": {"end": 1.0, "step": 0.25},
                "output": {"every": 1.0},
            }
        )
    )
    run.go(0.25)
    assert np.abs(run.state.fluid["velocity"]).max() > 0.5
    run.go()
    assert np.abs(run.state.fluid["velocity"]).max() == 0.0
