"""Forces of single contacts in the table of contacts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rigidfluid.api import Simulation, scene_from_dict

LAW = {"law": "normal", "range": 0.05, "epsilon": 1e-4}
LOWER = {"name": "lower", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.5, 0.13]}
UPPER = LOWER | {"name": "upper", "position": [0.5, 0.36]}


def run(*bodies: dict[str, Any], wet: bool = False, end: float = 0.2, step: float = 0.01, **contact: Any) -> Simulation:
    fluid = {"backend": "scikit-fem", "density": 1.0, "viscosity": 1.0} if wet else {"backend": "dry"}
    tables = {
        "scene": {"name": "rows", "dimension": 2},
        "fluid": fluid | {"gravity": [0.0, -1.0]},
        "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        "body": list(bodies),
        "contact": LAW | contact,
        "mesh": {"size": 0.2, "size_body": 0.05},
        "time": {"end": end, "step": step},
        "output": {"every": end},
    }
    simulation = Simulation(scene_from_dict(tables))
    simulation.go()
    return simulation


def total_forces(simulation: Simulation, name: str, step: int) -> np.ndarray:
    """Of the contacts of a body (d,), by the rows of a step."""
    rows = simulation.history.contacts
    force, now = np.column_stack([rows["fx"], rows["fy"]]), rows["step"] == step
    return np.asarray(force[now & (rows["a"] == name)].sum(axis=0) - force[now & (rows["b"] == name)].sum(axis=0))


@pytest.mark.parametrize(
    ("wet", "restitution", "error"), [(True, 1.0, 2e-3), (True, 0.3, 2e-3), (False, 1.0, 2e-3), (False, 0.3, 0.02)]
)
def test_forces_of_contacts_add_up_to_those_on_bodies(wet: bool, restitution: float, error: float) -> None:
    """Dampers change fast: a substep of a dry run takes their force at velocities of half a substep before its end."""
    bodies = LOWER | {"position": [0.125, 0.125]}, UPPER | {"position": [0.2, 0.325], "velocity": [0.0, -0.3]}
    simulation = run(*bodies, wet=wet, end=4e-3, step=5e-4, restitution=restitution)
    now = simulation.state.count
    assert np.count_nonzero(simulation.history.contacts["step"] == now) == 3
    for name in ("lower", "upper"):
        halves = (total_forces(simulation, name, step) for step in (now - 1, now))
        mean = simulation.bodies[name].contact_force
        np.testing.assert_allclose(0.5 * sum(halves), mean, atol=error * np.abs(mean).max())
