"""Cases 2 and 4 of arXiv:2402.19093, coarse: a sphere comes to rest; an ellipsoid turns, and comes to a wall."""

import functools

import numpy as np
import pytest
from falling import SCENES

import rigidfluid
from rigidfluid.core.mechanics.rigid import rotation_matrices

pytestmark = pytest.mark.validation

SPHERE = ["mesh.size_body=0.3", "time.step=0.02"]
ELLIPSOID = ["mesh.size_body=0.05", "time.step=0.005", "time.end=0.36"]
REST_GAP = 0.2344  # cm, where (2r + gap)(range - gap)²/ε is the submerged weight


@functools.cache
def sphere():
    return rigidfluid.run(rigidfluid.load_scene(SCENES / "falling_sphere.toml", SPHERE))


@functools.cache
def ellipsoid():
    return rigidfluid.run(rigidfluid.load_scene(SCENES / "falling_ellipsoid.toml", ELLIPSOID))


def long_axis():
    """Of the ellipsoid, over time (s, 3)."""
    bodies = ellipsoid().bodies
    return rotation_matrices(np.stack([bodies[name] for name in ("qw", "qx", "qy", "qz")], axis=1))[:, :, 1]


def test_sphere_falls_straight_and_rests_where_the_law_bears_its_weight():
    bodies = sphere().bodies
    assert np.hypot(bodies["x"], bodies["z"]).max() < 5e-3
    assert bodies["gap"].min() > 0.1
    assert bodies["gap"][-1] == pytest.approx(REST_GAP, abs=5e-4)
    assert abs(bodies["vy"][-1]) < 1e-3


def test_highest_speed_of_the_sphere_is_below_that_in_a_wider_box():
    """8.727 cm/s is measured in a box of 10 × 10 × 16 cm; walls that are 1/5 nearer take some per cent."""
    assert 0.95 * 8.727 < -sphere().bodies["vy"].min() < 0.99 * 8.727


def test_ellipsoid_turns_broadside_and_swings_past():
    tilt = np.unwrap(np.arctan2(-long_axis()[:, 0], long_axis()[:, 1]), period=np.pi)
    time = ellipsoid().bodies["time"]
    assert time[np.argmax(tilt > np.pi / 2)] == pytest.approx(0.17, abs=0.01)
    assert np.radians(120) < tilt.max() < np.radians(170)


def test_ellipsoid_stays_in_the_plane_in_which_it_is_tilted():
    assert np.abs(np.arcsin(long_axis()[:, 2])).max() < 0.1
    assert np.abs(ellipsoid().bodies["z"] - 0.2).max() < 0.02


def test_ellipsoid_comes_to_the_wall_and_off_again():
    history = ellipsoid()
    near = np.argmin(history.bodies["gap"])
    assert set(history.contacts["b"]) == {"right"}
    assert 0.02 < history.bodies["gap"][near] < 0.04
    assert history.bodies["gap"][-1] > history.bodies["gap"][near] + 0.01
    assert history.summary["failed_remeshes"] == 0


@pytest.mark.parametrize("history", [sphere, ellipsoid])
def test_next_to_no_energy_is_created(history):
    assert history().summary["energy"]["created"] < 0.01
