"""Meshes around coarse bodies that meet in 3D, their gaps left to the cells that they have anyway."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.api import scene_from_dict
from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps
from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

TABLES = {
    "scene": {"name": "meeting", "dimension": 3},
    "fluid": {"density": 1.0, "viscosity": 1.0},
    "domain": {"lower": [-1.0, -0.7, -0.7], "upper": [1.0, 0.7, 0.7]},
    "body": [
        {"type": "sphere", "radius": 0.3, "density": 2.0, "position": [-0.52, 0.0, 0.0]},
        {"type": "ellipsoid", "semi_axes": [0.3, 0.2, 0.25], "density": 2.0, "position": [0.52, 0.05, 0.0]},
    ],
    "contact": {"law": "normal", "range": 0.05, "epsilon": 1e-3},
    "mesh": {"size": 0.8, "size_body": 0.25, "growth": 0.6, "cells_per_gap": 1, "refinements": 0},
    "time": {"end": 1.0, "step": 0.01},
    "output": {"every": 1.0},
}


def test_cells_stay_good_and_few_until_bodies_touch(monkeypatch: pytest.MonkeyPatch) -> None:
    """No fluid is solved for: the bodies are moved until a tenth of a cell is left between them."""
    simulation = Simulation(scene_from_dict(TABLES))
    system, updater, state = simulation.system, simulation.mesh_updater, simulation.state
    monkeypatch.setattr(system.backend, "transfer", lambda fluid, *_: (fluid, 0.0))
    worst, cells, made = [], [len(state.mesh.cells)], 0
    for approach in 0.217 * (1.0 - np.geomspace(0.8, 0.04, 14)):
        moved = system.pose.position + approach * np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
        pose = replace(system.pose, position=moved)
        before, state = state.mesh, updater.remesh_if_needed(state, pose)
        made += state.mesh is not before
        mesh = updater.deform(state, pose)
        gaps = detect_contacts_and_gaps(system, pose, mesh)[1]
        state = replace(state, tick=state.tick + 1, pose=pose, mesh=mesh, gaps=gaps)
        worst.append(updater.quality(state))
        cells.append(len(mesh.cells))
    assert gaps.min() < 0.03
    assert made > 0
    assert min(worst) > 0.1
    assert max(cells) < 1.2 * cells[0]
