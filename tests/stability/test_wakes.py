"""Wakes of disks that fall fast keep their energy, however long the step."""

from __future__ import annotations

import numpy as np
import pytest

import rigidfluid

FAST = {
    "scene": {"name": "fast", "dimension": 2},
    "fluid": {"density": 1.0, "viscosity": 0.01, "gravity": [0.0, -981.0]},
    "domain": {"lower": [0.0, 0.0], "upper": [2.0, 6.0]},
    "body": [{"name": "disk", "type": "sphere", "radius": 0.125, "density": 1.5, "position": [1.0, 4.0]}],
    "contact": {"law": "centre", "range": 0.015, "epsilon": 7e-5, "epsilon_wall": 5e-6},
    "mesh": {"size": 0.15, "size_body": 0.015},
    "time": {"end": 0.275, "step": 0.002},
    "output": {"every": 0.275},
}


def test_a_fast_disk_falls_as_published_at_a_long_step():
    """Re 330; 13.1 to 13.6 cm/s between .2 and .275 s (Bergmann et al. 2014, fig. 19)."""
    history = rigidfluid.run(rigidfluid.scene_from_dict(FAST))
    energy, bodies = history.summary["energy"], history.bodies
    assert energy["created"] < 1e-4
    assert energy["lost"] + energy["grad_div"] < 0.015
    late = bodies["time"] > 0.2
    assert -bodies["vy"][late].mean() == pytest.approx(13.35, abs=0.25)
    assert np.abs(np.diff(bodies["t"][late])).max() < 0.5 * np.ptp(bodies["t"][late])
