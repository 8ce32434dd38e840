"""Runs without a folder, to their end."""

from __future__ import annotations

from rigidfluid.core.model.state import State
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene


def run_to_end(scene: Scene) -> State:
    """State at the end of a scene."""
    simulation = Simulation(scene, None, False)
    while not simulation.ended:
        simulation.step()
    return simulation.state
