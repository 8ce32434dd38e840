"""Wakes of disks that fall fast keep their energy, however long the step."""

from __future__ import annotations

import numpy as np
import pytest
from falling import SCENES

import rigidfluid

pytestmark = pytest.mark.long


def test_a_fast_disk_falls_as_published_at_a_long_step():
    """Re 330; 13.1 to 13.6 cm/s between .2 and .275 s (Bergmann et al. 2014, fig. 19)."""
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "fast_disk.toml", ["time.step=0.002"]))
    energy, bodies = history.summary["energy"], history.bodies
    assert energy["created"] < 1e-4
    assert energy["lost"] + energy["grad_div"] < 0.015
    late = bodies["time"] > 0.2
    assert -bodies["vy"][late].mean() == pytest.approx(13.35, abs=0.25)
    assert np.abs(np.diff(bodies["t"][late])).max() < 0.5 * np.ptp(bodies["t"][late])
