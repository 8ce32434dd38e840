"""Two disks on a rod that the fluid does not feel turn in a channel whose walls slide, without inertia."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from rigidfluid.api import Simulation, scene_from_dict

pytestmark = pytest.mark.long


def dumbbell(angle, density, end, step):
    """Centres 2.4 radii apart, walls 5 from the middle, and the channel's ends too far to be felt."""
    disks = [
        {"name": name, "type": "sphere", "radius": 1.0, "density": density, "position": [x, 0.0]}
        for name, x in (("left", -1.2), ("right", 1.2))
    ]
    walls = [{"on": side, "type": "wall", "velocity": [way, 0.0]} for side, way in (("top", 5.0), ("bottom", -5.0))]
    ends = [{"on": side, "type": "velocity", "velocity": ["y", 0.0]} for side in ("left", "right")]
    return Simulation(
        scene_from_dict(
            {
                "scene": {"name": "dumbbell", "dimension": 2},
                "fluid": {"model": "stokes", "density": density, "viscosity": 1.0},
                "domain": {"lower": [-15.0, -5.0], "upper": [15.0, 5.0]},
                "boundary": walls + ends,
                "mechanism": [
                    {"name": "it", "type": "articulated", "position": [0.0, 0.0], "angle": angle, "component": disks}
                ],
                "mesh": {"size": 2.0, "size_body": 0.3, "growth": 0.3},
                "time": {"end": end, "step": step},
                "output": {"every": end},
            }
        )
    )


def rate(angle):
    """Angular velocity of the pair at rest but for the flow, after a moment that is long for its inertia."""
    it = dumbbell(angle, density=1e-8, end=1e-4, step=1e-4)
    it.go()
    return it.bodies["it"].angular_velocity[0]


def test_a_turn_takes_the_time_that_rates_at_rest_say():
    """Rates at angles between 0 and π/2, a series of cosines of 2φ, and the integral of 1/rate, know no time step."""
    angles = np.linspace(0.0, pi / 2, 7)
    rates = np.array([rate(angle) for angle in angles])
    assert np.all(np.diff(rates) < 0.0)
    assert np.all(rates < 0.0)
    assert rate(-angles[2]) == pytest.approx(rates[2], rel=2e-3)
    orders = np.arange(len(angles))
    series = np.linalg.solve(np.cos(2.0 * np.outer(angles, orders)), rates)
    period, _ = quad(lambda angle: -1.0 / (series @ np.cos(2.0 * orders * angle)), 0.0, 2.0 * pi, limit=200)
    it, turned = dumbbell(0.0, density=1e-3, end=1.05 * period, step=0.1), []
    it.observe(lambda now: turned.append([now.time, *now.bodies["it"].orientation]))
    it.go()
    times, found = np.array(turned).T
    assert CubicSpline(-found, times)(2.0 * pi) == pytest.approx(period, rel=2e-3)
    np.testing.assert_allclose(it.bodies["it"].position, 0.0, atol=0.01)
