"""Forces and torques in narrow gaps in 3D Stokes flow, against exact series."""

import numpy as np
import pytest
from falling import SCENES
from near_spheres import MOTIONS, NearSpheres
from published import brenner, drag_of_approach
from two_spheres import drag_across

import rigidfluid

pytestmark = pytest.mark.long

SPEED, GAP = 1e-4, 0.1
WIDE = ["mesh.size_body=0.4"]
PAIR = [f"body.{number}.position=[0.0, 0.0, {sign * (1.0 + 0.5 * GAP)}]" for number, sign in enumerate((-1, 1))]
ACROSS = [f"body.{number}.prescribed.velocity=[{sign * SPEED}, 0.0, 0.0]" for number, sign in enumerate((1, -1))]


def force(scene, overrides, axis):
    """Over 6πμrV, of each body."""
    bodies = rigidfluid.run(rigidfluid.load_scene(SCENES / scene, [*WIDE, *overrides])).bodies
    return np.abs(bodies[axis][bodies["time"] > 0.0]) / (6.0 * np.pi * SPEED)


@pytest.mark.validation
def test_a_sphere_is_held_back_by_its_film_at_a_wall():
    assert force("squeezed_film.toml", [], "fz") == pytest.approx(brenner(GAP), rel=0.02)


@pytest.mark.validation
def test_two_spheres_are_held_back_by_the_film_between_them():
    assert force("two_spheres.toml", PAIR, "fz") == pytest.approx(drag_of_approach(GAP), rel=0.02)


@pytest.mark.validation
def test_two_spheres_drag_each_other_as_they_pass():
    assert force("two_spheres.toml", [*PAIR, *ACROSS], "fx") == pytest.approx(drag_across(GAP), rel=0.02)


def test_unequal_spheres_resist_squeezing_sliding_rolling_and_twisting():
    """Of radii 1 and 4, forces and torques on both."""
    spheres = NearSpheres(4.0, size_body=1.0)
    simulation, loads = spheres.simulation(GAP, 30.0), {}
    for motion in MOTIONS:
        loads |= {f"{motion}: {load}": pair for load, pair in spheres.loads(simulation, motion, GAP).items()}
    exact, found = ({name: pair[which] for name, pair in loads.items()} for which in (0, 1))
    assert len(loads) == 8
    assert found == pytest.approx(exact, rel=0.01)


def test_the_exact_forces_have_their_limits():
    """Far apart Stokes' law; in narrow gaps the leading term of the film's."""
    assert [brenner(1e3), drag_of_approach(1e3), drag_across(1e3, 4)] == pytest.approx([1.0] * 3, rel=2e-3)
    assert brenner(0.01) * 0.01 == pytest.approx(1.0, rel=0.03)
    assert drag_of_approach(0.01) * 0.04 == pytest.approx(2.0, rel=0.2)
