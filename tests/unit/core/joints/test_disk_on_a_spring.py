"""A disk on a spring in a viscous fluid: frequency and decay as Stokes (1851) found for a cylinder that oscillates.

With time as exp(-iωt) the force per length is ρπa²ω² y (1 + 4 K₁(z)/(z K₀(z))), z = a √(-iω/ν), and so
k = ω² (m + ρπa² (1 + 4 K₁/(z K₀))). Walls at 20 radii add 0.1 %.
"""

import numpy as np
import pytest
from scipy.optimize import curve_fit, newton
from scipy.special import kve

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict

RADIUS, DENSITY, STIFFNESS, VISCOSITY, START = 0.5, 2.0, 10.0, 0.01, 0.02
DISPLACED = np.pi * RADIUS**2


def stokes_frequency() -> complex:
    def residual(frequency: complex) -> complex:
        z = RADIUS * np.sqrt(-1j * frequency / VISCOSITY)
        carried = 1.0 + 4.0 * kve(1, z) / (z * kve(0, z))
        return STIFFNESS - frequency**2 * DISPLACED * (DENSITY + carried)

    return complex(newton(residual, np.sqrt(STIFFNESS / (DISPLACED * (DENSITY + 1.0))) + 0j))


@pytest.mark.long
def test_it_swings_and_decays_as_stokes_found() -> None:
    expected = stokes_frequency()
    period = 2.0 * np.pi / expected.real
    spring = {"stiffness": [0.0, STIFFNESS], "rest": [0.0, 0.0]}
    disk = {"type": "sphere", "radius": RADIUS, "density": DENSITY, "position": [0.0, START]}
    scene = {
        "scene": {"name": "spring", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": VISCOSITY},
        "domain": {"lower": [-10.0, -10.0], "upper": [10.0, 10.0]},
        "body": [disk | {"free": ["y"], "spring": spring}],
        "mesh": {"size": 5.0, "size_body": 0.08, "growth": 0.3},
        "time": {"end": 2.5 * period, "step": period / 60.0},
        "output": {"every": 2.5 * period},
    }
    history = rigidfluid.run(scene_from_dict(scene))
    time, y = history.bodies["time"], history.bodies["y"]
    late = time > 0.5 * period

    def swing(at: np.ndarray, size: float, decay: float, frequency: float, phase: float) -> np.ndarray:
        return size * np.exp(-decay * at) * np.cos(frequency * at + phase)

    found = curve_fit(swing, time[late], y[late], (START, -expected.imag, expected.real, 0.0))[0]
    assert found[2] == pytest.approx(expected.real, rel=2e-3)
    assert found[1] == pytest.approx(-expected.imag, rel=1e-2)
    assert history.summary["energy"]["created"] < 1e-6
    assert np.abs(history.bodies["x"]).max() < 1e-14
