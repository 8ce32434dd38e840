"""Masses and weights of bodies in a fluid, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import wet_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_an_ellipse_in_a_fluid(model: str) -> None:
    """Weight is less by that of the fluid; only a fluid with inertia adds mass."""
    ellipse = {"type": "ellipsoid", "semi_axes": [0.2, 0.1], "density": 3.0, "position": [0.5, 0.5]}
    fluid = {"density": 2.0, "model": model, "gravity": [1.0, -7.0]}
    system, area = build_system(scene_from_dict(wet_tables(ellipse, fluid=fluid))), 0.02 * np.pi
    assert system.mass[0] == pytest.approx(3.0 * area)
    assert system.inertia[0, 0, 0] == pytest.approx(3.0 * area * (0.2**2 + 0.1**2) / 4.0)
    np.testing.assert_allclose(system.weight, [[area, -7.0 * area]])
    added = 2.0 * np.pi * np.diag([0.1**2, 0.2**2]) if model == "navier-stokes" else np.zeros((2, 2))
    np.testing.assert_allclose(system.added_mass[0], added)
