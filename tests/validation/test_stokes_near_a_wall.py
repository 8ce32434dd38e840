"""Stokes flow by a cylinder that moves near a plane wall, against the exact drag of Jeffrey & Onishi 1981.

With α = arccosh(height / radius): 4πμU/α along the wall, without torque, and 4πμV/(α - tanh α) towards it
(Q. J. Mech. Appl. Math. 34 (1981) 129, doi:10.1093/qjmam/34.2.129).
"""

import numpy as np
import pytest

import rigidfluid

pytestmark = pytest.mark.long

VISCOSITY, SPEED, FAR = 0.7, 0.3, 60.0


def drag(height, direction=(0.0, 0.0), spin=0.0):
    """Force (2,) and torque on a cylinder of radius 1 that moves at SPEED or turns, ``height`` above the floor."""
    scene = rigidfluid.scene_from_dict(
        {
            "scene": {"name": "cylinder", "dimension": 2},
            "fluid": {"model": "stokes", "density": 1.0, "viscosity": VISCOSITY},
            "domain": {"lower": [-FAR, 0.0], "upper": [FAR, FAR]},
            "boundary": [{"on": face, "type": "pressure", "pressure": 0.0} for face in ("left", "right", "top")],
            "body": [
                {
                    "type": "sphere",
                    "radius": 1.0,
                    "density": 1.0,
                    "position": [0.0, height],
                    "prescribed": {
                        "velocity": [SPEED * component for component in direction],
                        "angular_velocity": spin,
                    },
                }
            ],
            "mesh": {"size": 6.0, "size_body": 0.05},
            "time": {"end": 2e-6, "step": 1e-6},
            "output": {"every": 1.0},
        }
    )
    bodies = rigidfluid.run(scene).bodies
    return np.array([bodies["fx"][-1], bodies["fy"][-1]]), bodies["t"][-1]


@pytest.mark.parametrize("gap", [1.0, 0.1, 0.02])
def test_along_the_wall(gap):
    force, torque = drag(1.0 + gap, (1.0, 0.0))
    expected = 4 * np.pi * VISCOSITY * SPEED / np.arccosh(1.0 + gap)
    assert force[0] == pytest.approx(-expected, rel=0.01)
    assert abs(torque) < 0.01 * expected


@pytest.mark.parametrize("gap", [1.0, 0.1, 0.02])
def test_towards_the_wall(gap):
    force, _ = drag(1.0 + gap, (0.0, -1.0))
    alpha = np.arccosh(1.0 + gap)
    assert force[1] == pytest.approx(4 * np.pi * VISCOSITY * SPEED / (alpha - np.tanh(alpha)), rel=0.01)


@pytest.mark.parametrize("gap", [1.0, 0.1])
def test_turning_on_the_spot(gap):
    """4πμω coth α, and no force (Jeffery, Proc. R. Soc. Lond. A 101 (1922) 169, doi:10.1098/rspa.1922.0035)."""
    force, torque = drag(1.0 + gap, spin=SPEED)
    expected = 4 * np.pi * VISCOSITY * SPEED / np.tanh(np.arccosh(1.0 + gap))
    assert torque == pytest.approx(-expected, rel=0.01)
    assert np.abs(force).max() < 0.02 * expected
