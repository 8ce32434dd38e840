"""Runs that are closed on the way and resumed from their folder."""

from __future__ import annotations

from pathlib import Path

from rigidfluid import Scene
from rigidfluid.api import Simulation


def run_in_two_parts(scene: Scene, folder: Path, until: float) -> Simulation:
    """Run a scene to a time, and resume it to its end; the second run, closed."""
    first = Simulation(scene, folder)
    first.go(until)
    first.close()
    resumed = Simulation(scene, folder, resume=True)
    resumed.go()
    resumed.finish("complete")
    resumed.close()
    return resumed
