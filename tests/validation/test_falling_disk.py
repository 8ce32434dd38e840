"""A disk falls through a channel onto its floor, against published figures (case 1 of arXiv:2402.19093)."""

import functools

import numpy as np
import pytest
from falling import falling_disk

import rigidfluid

# Digitised from the figures, (time [s], velocity [cm/s]); reading error 1-2 % of the axis.
KOBLITZ_2017 = np.array(  # Koblitz, Lovett, Nikiforakis, Henshaw, J. Comput. Phys. 343 (2017) 414, figure 6b
    [(0.0306, -1.892), (0.0518, -2.727), (0.0800, -3.590), (0.1152, -4.338), (0.1775, -5.040)]
    + [(0.2798, -5.430), (0.3832, -5.540), (0.4866, -5.579), (0.5900, -5.591), (0.6934, -5.515)]
)
GLOWINSKI_2001 = np.array(  # Glowinski, Pan, Hesla, Joseph, Périaux, J. Comput. Phys. 169 (2001) 363
    [(0.0115, -1.017), (0.0220, -1.675), (0.0429, -2.591), (0.0639, -3.393), (0.0767, -3.736), (0.0977, -4.237)]
    + [(0.1223, -4.652), (0.1574, -4.995), (0.1761, -5.138), (0.2347, -5.351), (0.2570, -5.408), (0.3109, -5.493)]
    + [(0.3555, -5.535), (0.4212, -5.520), (0.5233, -5.575), (0.5901, -5.574), (0.6230, -5.559), (0.6546, -5.544)]
    + [(0.6664, -5.501), (0.6863, -5.458)]
)
TERMINAL_SPEED = 5.59
HIGHEST_REYNOLDS = 17.46  # P2-P1 body-fitted, with the solid's density; Wan & Turek 2006: 17.42
WEIGHT = (1.25 - 1.0) * np.pi * 0.125**2 * 981.0

MESHES = [
    pytest.param((0.025, 0.004, 0.02), id="coarse"),
    pytest.param((0.01, 0.001, 0.01), id="fine", marks=pytest.mark.validation),
]


@functools.cache
def fall(size_body, step):
    return rigidfluid.run(falling_disk(mesh={"size_body": size_body}, time={"step": step, "end": 1.0}))


@pytest.fixture(params=MESHES)
def resolution(request):
    return request.param


@pytest.fixture
def history(resolution):
    return fall(*resolution[:2])


@pytest.fixture
def off(history):
    """Velocity minus a published curve, over the terminal speed."""
    bodies = history.bodies
    return lambda curve: (np.interp(curve[:, 0], bodies["time"], bodies["vy"]) - curve[:, 1]) / TERMINAL_SPEED


def test_highest_reynolds_number(history, resolution):
    assert history.summary["reynolds_solid_density"] == pytest.approx(HIGHEST_REYNOLDS, rel=resolution[2])


def test_velocity_follows_koblitz(off):
    assert np.abs(off(KOBLITZ_2017)).max() < 0.03


def test_velocity_follows_glowinski(off):
    """In the mean over the fall; before .15 s the two published curves are up to 4.5 % from each other."""
    assert np.sqrt(np.mean(off(GLOWINSKI_2001) ** 2)) < 0.03
    assert np.abs(off(GLOWINSKI_2001[GLOWINSKI_2001[:, 0] > 0.15])).max() < 0.03


@pytest.mark.parametrize(("height", "time"), [(2.0, 0.434), (1.0, 0.613), (0.5, 0.703)])
def test_heights_are_passed_on_time(history, height, time):
    bodies = history.bodies
    assert np.interp(-height, -bodies["y"], bodies["time"]) == pytest.approx(time, abs=0.01)


def test_falls_straight_and_never_overlaps(history):
    bodies = history.bodies
    before_contact = bodies["gap"] > 0.015
    assert np.abs(bodies["x"] - 1.0)[before_contact].max() < 1e-3
    assert bodies["gap"].min() > 0


def test_energy_balance_closes(history):
    assert abs(history.summary["energy"]["relative_residual"]) < 0.02


def test_comes_to_rest_on_a_stiffer_floor():
    """At rest the centre law carries the weight: (2r + gap)(range - gap)²/ε = W gives the gap."""
    history = rigidfluid.run(
        falling_disk(
            body={"position": [1.0, 0.5]},
            contact={"epsilon_wall": 2.5e-6},
            mesh={"size_body": 0.025},
            time={"step": 0.004, "end": 1.2},
        )
    )
    bodies = history.bodies
    assert np.abs(bodies["vy"][-1]) < 1e-3
    assert bodies["cfy"][-1] == pytest.approx(WEIGHT, rel=0.01)
    assert (0.25 + bodies["gap"][-1]) * (0.015 - bodies["gap"][-1]) ** 2 / 2.5e-6 == pytest.approx(WEIGHT, rel=0.01)
