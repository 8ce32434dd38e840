"""Contacts in a fluid without inertia, at steps far longer than bodies of next to no mass take to stop."""

import numpy as np
import pytest
import stokes_contacts as scenes
from fluid_contact_table import track
from fluid_contacts import created_and_lost, resting_gap, stokes_pressed
from stokes_contacts import disk_weight, last_fifth, mean_over_time

import rigidfluid
from rigidfluid.core.output.history import History

pytestmark = pytest.mark.long


def refuse_unrest(history: History, density: float, epsilon: float) -> None:
    """The contact bears the weight at the gap where it does so exactly, and the disk lies still."""
    late = last_fifth(history)
    np.testing.assert_allclose(np.abs(track(history, "cfy")[late, 0]) / disk_weight(density), 1.0, atol=1e-5)
    assert np.abs(track(history, "vy")[late, 0]).max() <= 1e-5
    assert track(history, "gap")[-1, 0] == pytest.approx(resting_gap(epsilon, density), abs=2e-7)


@pytest.mark.parametrize("density", [2.0, 0.1, 1e-3])
def test_a_disk_comes_to_rest_on_a_wall_and_makes_no_energy(density):
    """The body's mass alone would say that a light one at rest may move by a thousandth of ten metres a second."""
    history = rigidfluid.run(stokes_pressed(0.1, density, 1e-8, "implicit"))
    refuse_unrest(history, density, 1e-8)
    assert np.abs(track(history, "vy")).max() <= 1.31
    assert created_and_lost(history)[0] <= 1e-3


def test_substeps_follow_a_light_disk_onto_a_wall():
    history = rigidfluid.run(stokes_pressed(0.1, 1e-3))
    refuse_unrest(history, 1e-3, 1e-8)
    assert created_and_lost(history)[0] <= 1e-3


def test_an_impact_shortens_no_step_and_loses_little():
    """The fluid has no layer that a shorter step would make thinner, and the path's friction is all accounted for."""
    history = rigidfluid.run(stokes_pressed(0.01, 1e-3, 1e-8, "implicit"))
    assert len(history.energy["time"]) <= 40
    assert history.energy["path_friction"][-1] == 0.0
    created, lost, _ = created_and_lost(history)
    assert created <= 1e-3
    assert lost <= 0.04


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
@pytest.mark.parametrize("scene", [scenes.released, scenes.hinged])
def test_bodies_that_contacts_throw_off_the_floor_make_no_energy(scene, stepping):
    """They opened gaps to many times what they were, and 5 to 8 % of the energy seemed created at any step."""
    for step in (4e-3, 1e-3):
        created, lost, first = created_and_lost(rigidfluid.run(scene(step, stepping)))
        assert created <= 2e-3
        assert lost <= 0.01
        assert abs(first) <= 2e-3


@pytest.mark.parametrize("step", [0.01, 0.004])
def test_the_first_step_that_sees_a_wall_knows_how_fast_the_disk_is(step):
    """The fluid's force at its start is that of the disk's speed then, and not that of half a step before."""
    assert created_and_lost(rigidfluid.run(stokes_pressed(step, 2.0)))[0] <= 1e-3


@pytest.mark.parametrize(("step", "most"), [(0.004, 1e-4), (0.002, 2e-3), (0.001, 5e-3)])
def test_a_light_disk_is_followed_onto_a_wall_at_short_steps_too(step, most):
    """Friction grows within a step, and velocities at its end are those of the force there: with that of the latest
    substep's middle 1.7, .55 and .5 % seemed created."""
    assert created_and_lost(rigidfluid.run(stokes_pressed(step, 1e-3)))[0] <= most


@pytest.mark.validation
def test_disks_in_a_chimney_come_to_rest_on_each_other():
    history = rigidfluid.run(scenes.column(0.1, "implicit"))
    late = last_fifth(history)
    np.testing.assert_allclose(track(history, "cfy")[late].sum(axis=1), 4.0 * disk_weight(2.0), rtol=1e-4)
    assert np.abs(track(history, "vy")[late]).max() <= 1e-4
    assert created_and_lost(history)[0] <= 1e-3


@pytest.mark.validation
def test_a_swimmer_crawls_on_the_floor_and_weighs_what_it_weighs():
    """Its balls are driven up and down on the contacts; the mean is over half a cycle and more."""
    history = rigidfluid.run(scenes.swimmer(0.05, "implicit"))
    floor = track(history, "cfy")[:, :3].sum(axis=1)
    assert mean_over_time(history, floor) == pytest.approx(3.0 * disk_weight(2.0), rel=0.02)
    assert history.bodies["gap"].min() > 0.02
    assert created_and_lost(history)[0] <= 0.01
