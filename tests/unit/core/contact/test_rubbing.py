"""Friction in one implicit step: its limits, its loss, and its elimination."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from rigidfluid.core.contact.path.implicit_friction import Rubbing, Slip, condensed, contacts_of_mean_force, rubbing
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw, SpringDashpotOptions

RANGE, STIFFNESS, FRICTION, TANGENTIAL, SIZE = 0.02, 400.0, 0.4, 900.0, 3e-3
LAW = SpringDashpotLaw(
    SpringDashpotOptions(stiffness=STIFFNESS, damping=2.0, friction=FRICTION, tangential_stiffness=TANGENTIAL), RANGE
)
ROLLING = SpringDashpotLaw(LAW.options.model_copy(update={"rolling_friction": 0.3, "twisting_friction": 0.2}), RANGE)
COUNT = 300


def contacts_of(dimension, random, least=0.1, most=0.9):
    normal = random.normal(size=(COUNT, dimension))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    point, radius, body = random.normal(size=(COUNT, dimension)), np.ones(COUNT), np.zeros(COUNT, dtype=np.int64)
    gap = RANGE * random.uniform(least, most, COUNT)
    return Contacts(body, body + 1, point, point, normal, gap, radius, radius, body.astype(bool))


def along(contacts, vectors):
    return vectors - np.sum(vectors * contacts.normal, axis=1)[:, None] * contacts.normal


def length(vectors):
    return np.linalg.norm(vectors, axis=1)


@pytest.mark.parametrize("secant", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_it_only_loses_energy_and_holds_no_more_than_friction_can(dimension, secant):
    random = np.random.default_rng(3)
    middle = contacts_of(dimension, random)
    end = replace(middle, gap=RANGE * random.uniform(0.1, 1.5, COUNT))
    held = along(middle, random.normal(scale=5e-3, size=middle.normal.shape))
    motion = Motion(random.normal(size=middle.normal.shape), np.ones(COUNT))
    rub = rubbing(LAW, middle, end, held, Slip(motion, SIZE, random.normal(size=held.shape), secant))
    way = SIZE * along(middle, motion.velocity)
    stored = 0.5 * TANGENTIAL * (length(rub.displacement) ** 2 - length(held) ** 2)
    assert np.all(-np.sum(rub.force * way, axis=1) - stored >= -1e-12)
    pressed = np.abs(STIFFNESS * (RANGE - middle.gap) - 2.0 * np.sum(motion.velocity * middle.normal, axis=1))
    assert np.all(length(rub.force) <= FRICTION * pressed * (1.0 + 1e-9))
    most = FRICTION * STIFFNESS * np.maximum(RANGE - end.gap, 0.0) / TANGENTIAL
    assert np.all(length(rub.displacement) <= most * (1.0 + 1e-9))
    assert 0.1 < np.mean(length(rub.force) < 0.999 * FRICTION * pressed) < 0.9


def test_what_sticks_without_a_dashpot_keeps_its_energy():
    law = SpringDashpotLaw(
        SpringDashpotOptions(stiffness=STIFFNESS, friction=100.0, tangential_stiffness=TANGENTIAL), RANGE
    )
    random = np.random.default_rng(3)
    middle = contacts_of(3, random)
    held = along(middle, random.normal(scale=5e-3, size=middle.normal.shape))
    motion = Motion(random.normal(size=middle.normal.shape), np.ones(COUNT))
    rub = rubbing(law, middle, middle, held, Slip(motion, SIZE, np.zeros_like(held), False))
    stored = 0.5 * TANGENTIAL * (length(rub.displacement) ** 2 - length(held) ** 2)
    np.testing.assert_allclose(-SIZE * np.sum(rub.force * motion.velocity, axis=1), stored, atol=1e-14)


def test_a_spring_too_long_for_its_contact_is_shortened_and_not_turned_round():
    random = np.random.default_rng(4)
    middle = contacts_of(3, random, 0.97, 0.99)
    held = along(middle, random.normal(scale=5e-3, size=middle.normal.shape))
    still = Slip(Motion(np.zeros_like(held), np.ones(COUNT)), SIZE, np.zeros_like(held), False)
    rub = rubbing(LAW, middle, replace(middle, gap=0.5 * middle.gap), held, still)
    assert np.all(np.sum(rub.displacement * held, axis=1) > 0.0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_slopes_are_those_of_the_force(dimension):
    """Of dashpots without a bound of their own; those at their bound have the slopes of secants."""
    law = SpringDashpotLaw(LAW.options.model_copy(update={"bounded_dashpot": False}), RANGE)
    random, step = np.random.default_rng(6), 1e-7
    middle = contacts_of(dimension, random)
    held = along(middle, random.normal(scale=5e-3, size=middle.normal.shape))
    velocity, change = random.normal(size=(2, *held.shape))
    change = along(middle, change)

    def rub_at(velocity):
        return rubbing(law, middle, middle, held, Slip(Motion(velocity, np.ones(COUNT)), SIZE, 0.0 * held, False))

    slope = (rub_at(velocity + step * change).force - rub_at(velocity - step * change).force) / (2.0 * step * SIZE)
    expected = -np.einsum("mij,mj->mi", rub_at(velocity).stiffness, change)
    np.testing.assert_allclose(slope, expected, rtol=1e-4, atol=1e-4 * np.abs(expected).max())


def turning_parts(contacts, vectors):
    """Rolling and twisting parts of ``vectors`` (m, k)."""
    twisting = vectors - along(contacts, vectors) if vectors.shape[1] == 3 else 0.0 * vectors
    return vectors - twisting, twisting


@pytest.mark.parametrize("secant", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_springs_that_resist_turning_lose_energy_each_within_its_bound(dimension, secant):
    random, radius = np.random.default_rng(3), 0.5
    middle = contacts_of(dimension, random)
    spins = random.normal(size=(3, COUNT, 1 if dimension == 2 else 3))
    held = np.hstack([along(middle, random.normal(scale=5e-3, size=middle.normal.shape)), 5e-3 * spins[0]])
    motion = Motion(random.normal(size=middle.normal.shape), np.ones(COUNT), spins[1])
    used = np.hstack([0.0 * middle.normal, spins[2]])
    rub = rubbing(ROLLING, middle, middle, held, Slip(motion, SIZE, used, secant))
    pressed = np.abs(STIFFNESS * (RANGE - middle.gap) - 2.0 * np.sum(motion.velocity * middle.normal, axis=1))
    force, before, after = (each[:, dimension:] for each in (rub.force, held, rub.displacement))
    columns = (turning_parts(middle, each) for each in (force, SIZE * radius * spins[1], before, after))
    for force, way, before, after, coefficient in zip(*columns, (0.3, 0.2), strict=True):
        stored = 0.5 * TANGENTIAL * (length(after) ** 2 - length(before) ** 2)
        assert np.all(-np.sum(force * way, axis=1) - stored >= -1e-12)
        assert np.all(length(force) <= coefficient * pressed * (1.0 + 1e-9))
    sliding = rubbing(LAW, middle, middle, held[:, :dimension], Slip(motion, SIZE, used[:, :dimension], secant))
    np.testing.assert_array_equal(rub.force[:, :dimension], sliding.force)


@pytest.mark.parametrize("dimension", [2, 3])
def test_slopes_of_turning_are_those_of_its_couples(dimension):
    """Without dashpots, as these are held at their bound."""
    law = SpringDashpotLaw(ROLLING.options.model_copy(update={"tangential_damping": 0.0}), RANGE)
    random, step, radius = np.random.default_rng(6), 1e-7, 0.5
    middle = contacts_of(dimension, random)
    spin, change, turned = random.normal(size=(3, COUNT, 1 if dimension == 2 else 3))
    held = np.hstack([0.0 * middle.normal, 5e-3 * turned])

    def rub_at(spin):
        motion = Motion(0.1 * middle.normal, np.ones(COUNT), spin)
        return rubbing(law, middle, middle, held, Slip(motion, SIZE, 0.0 * held, False))

    slope = (rub_at(spin + step * change).force - rub_at(spin - step * change).force) / (2.0 * step * SIZE * radius)
    way = np.hstack([0.0 * middle.normal, change])
    expected = -np.einsum("mij,mj->mi", rub_at(spin).stiffness, way)
    np.testing.assert_allclose(slope, expected, rtol=1e-4, atol=1e-4 * np.abs(expected).max())


def test_mean_gaps_give_the_mean_force():
    """Into the range from outside of it, and from one gap to another."""
    start = contacts_of(2, np.random.default_rng(7), 0.1, 1.5)
    gap = RANGE * np.random.default_rng(8).uniform(0.1, 1.5, COUNT)
    mean = -(LAW.energy(replace(start, gap=gap)) - LAW.energy(start)) / (gap - start.gap)
    there = contacts_of_mean_force(LAW, start, start, gap, mean)
    assert np.all((there.gap >= np.minimum(gap, start.gap)) & (there.gap <= np.maximum(gap, start.gap)))
    np.testing.assert_allclose(np.sum(LAW.force(there) * there.normal, axis=1), mean, atol=1e-10)


@pytest.mark.parametrize(("dimension", "width"), [(2, 2), (3, 3), (2, 3), (3, 6)])
def test_eliminated_forces_solve_the_whole_problem(dimension, width):
    """q = q₀ + b (f - f₀) - S (w - w₀), w - w₀ = C (N (f - f₀) + q - q₁); for a full response C and a sparse one, of
    forces alone and with couples beside them."""
    random, count = np.random.default_rng(5), 4
    contacts = contacts_of(dimension, random)
    contacts = select(contacts, np.arange(count))
    force, expected, rise, used = random.normal(size=(4, count, width))
    stiffness = random.uniform(size=(count, width, width))
    rub = Rubbing(force, expected, stiffness, rise, np.zeros_like(force))
    normal = np.hstack([contacts.normal, np.zeros((count, width - dimension))])
    root = random.normal(size=(width * count, width * count))
    response, gap, (before, after) = root @ root.T, random.uniform(size=count), random.normal(size=(2, count))
    for given in (response, sparse.csr_matrix(response)):
        found = condensed(given, contacts, rub, gap, before, used)
        q = found.along(after)
        changed = ((after - before)[:, None] * normal + q - used).T.ravel()
        way = (response @ changed).reshape(width, count).T
        np.testing.assert_allclose(
            q, expected + rise * (after - before)[:, None] - np.einsum("mij,mj->mi", stiffness, way), rtol=1e-9
        )
        opened = gap + np.sum(way * normal, axis=1)
        np.testing.assert_allclose(found.free + found.compliance @ after, opened, rtol=1e-9)
