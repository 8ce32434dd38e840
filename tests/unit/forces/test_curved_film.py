"""Films between surfaces of any curvatures, against Reynolds' equation by finite volumes and the terms of balls."""

from dataclasses import replace

import numpy as np
import pytest
from reynolds import Film, clustered
from touching import contact

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.contacts import joined
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.forces.lubrication import LubricationLaw, LubricationOptions

VISCOSITY = 0.7
SQUEEZING, TWISTING = 2, 5
"""Motions along and about the normal."""
PAIRS = {
    "two ellipsoids": (((0.7, 1.9), 0.0), ((0.4, 1.1), 0.6)),
    "one on a wall": (((0.7, 1.9), 0.3), ((0.0, 0.0), 0.0)),
    "one on a ball": (((0.7, 1.9), 0.0), ((1.2, 1.2), 0.0)),
    "one in a hollow": (((0.9, 1.9), 0.4), ((-0.3, -0.3), 0.0)),
}
"""Principal curvatures of a and of b, and how far they are turned about the normal."""


def law(range_: float) -> LubricationLaw:
    return LubricationLaw(LubricationOptions(viscosity=VISCOSITY, cutoff=1e-12, sliding=True), range_)


def tensor(curvatures: tuple[float, float], angle: float) -> FloatArray:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.asarray(turn @ np.diag(curvatures) @ turn.T)


def between(a: FloatArray, b: FloatArray, gap: float) -> Contacts:
    """A contact with the normal z of surfaces of these tensors (2, 2)."""
    normal, whole = np.eye(3)[2:], a + b
    radius = np.sqrt(2.0 / (np.trace(whole) * np.sqrt(np.linalg.det(whole))))
    tensors = np.zeros((1, 2, 3, 3))
    tensors[0, :, :2, :2] = a, b
    given = {"normal": normal, "point_a": gap * normal, "effective_radius": np.array([radius]), "curvatures": tensors}
    return replace(contact(gap, dimension=3), **given)


def resistance(film: LubricationLaw, touching: Contacts) -> FloatArray:
    """Forces and couples (6,) on a with the opposite sign, by each of its velocities and angular velocities (6,)."""
    columns = []
    for unit in np.eye(6):
        motion = Motion(unit[None, :3], np.ones(1), unit[None, 3:])
        columns.append(-np.hstack([film.damping(touching, motion), film.couple(touching, motion)])[0])
    return np.transpose(columns)


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_the_film_grows_as_reynolds_equation_says(pair: tuple) -> None:
    """Forces and couples by the surfaces' rigid motion, with nothing of the closed form, at two gaps."""
    a, b = (tensor(*each) for each in pair)
    gap, end = 1e-4, 1e-3
    nodes = clustered(0.8, 0.15 * np.sqrt(gap), 80)
    thin, thick = (Film(nodes, nodes, a, b, each).resistance() for each in (gap, end))
    expected, found = VISCOSITY * (thin - thick), resistance(law(end), between(a, b, gap))
    scale = np.sqrt(np.outer(expected.diagonal(), expected.diagonal()))
    left_out = np.zeros((6, 6), dtype=bool)
    left_out[SQUEEZING, TWISTING] = left_out[TWISTING, SQUEEZING] = left_out[TWISTING, TWISTING] = True
    np.testing.assert_allclose(expected, expected.T, rtol=0, atol=1e-12 * expected.max())
    away = np.where(left_out, 0.0, found / scale - expected / scale)
    np.testing.assert_allclose(away, 0.0, atol=0.015)
    twisting_alone = np.sqrt(VISCOSITY * thin[TWISTING, TWISTING] * expected[SQUEEZING, SQUEEZING])
    assert abs(expected[SQUEEZING, TWISTING]) < 0.01 * twisting_alone


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_twisting_grows_as_reynolds_equation_says(pair: tuple) -> None:
    """By the second difference over gaps of which each is twice the one before, which no linear parts are in."""
    a, b = (tensor(*each) for each in pair)
    gap = 1e-3
    nodes = clustered(0.8, 0.15 * np.sqrt(gap), 80)
    exact = [VISCOSITY * Film(nodes, nodes, a, b, part * gap).resistance()[TWISTING, TWISTING] for part in (1, 2, 4)]
    wide, narrow = (resistance(law(2.0 * each), between(a, b, each))[TWISTING, TWISTING] for each in (2.0 * gap, gap))
    assert wide - 2.0 * narrow == pytest.approx((exact[1] - exact[2]) - 2.0 * (exact[0] - exact[1]), rel=0.03)
    assert narrow > 0.0


@pytest.mark.parametrize("radius_b", [1.0, 0.3, 4.0, np.inf, -1.7])
def test_with_equal_curvatures_the_leading_terms_are_those_of_balls(radius_b: float) -> None:
    """Of twisting by the second difference, which no linear terms are in."""

    def alike(gap: float, end: float) -> tuple[FloatArray, FloatArray]:
        touching = between(np.eye(2), np.eye(2) / radius_b, gap)
        ball = replace(touching, radius_a=np.ones(1), radius_b=np.full(1, radius_b), curvatures=None)
        return resistance(law(end), touching), resistance(law(end), ball)

    found, expected = alike(1e-9, 1e-8)
    scale = np.sqrt(np.outer(expected.diagonal(), expected.diagonal()))
    np.testing.assert_allclose((found / scale)[:TWISTING], (expected / scale)[:TWISTING], rtol=0, atol=1e-6)
    (wide, wide_ball), (narrow, narrow_ball) = alike(2e-9, 4e-9), alike(1e-9, 2e-9)
    np.testing.assert_allclose((wide - 2.0 * narrow)[TWISTING], (wide_ball - 2.0 * narrow_ball)[TWISTING], rtol=1e-5)


def test_no_motion_gains_energy_and_forces_are_reciprocal() -> None:
    random = np.random.default_rng(3)
    for _ in range(50):
        own, turns = np.exp(random.normal(size=(2, 2))), random.uniform(0.0, np.pi, 2)
        a, b = (tensor(tuple(each), turn) for each, turn in zip(own, turns, strict=True))
        b = b if random.random() < 0.5 else -0.9 * b * np.linalg.eigvalsh(a)[0] / np.linalg.eigvalsh(b)[1]
        found = resistance(law(1e-2), between(a, b, float(10.0 ** random.uniform(-6.0, -2.1))))
        scale = np.sqrt(np.outer(found.diagonal(), found.diagonal()))
        np.testing.assert_allclose(found / scale, found.T / scale, rtol=0, atol=1e-12)
        assert np.linalg.eigvalsh(found / scale)[0] > 0.0


def test_ellipses_resist_as_circles_of_their_curvatures() -> None:
    """Of which 2D has the leading terms alone anyway."""
    curvature = np.array([0.7, 1.9])
    circles = contact(1e-3, *(1.0 / curvature))
    across = np.eye(2) - circles.normal[0][:, None] * circles.normal[0]
    tensors = (curvature[:, None, None] * across)[None]
    ellipses = replace(contact(1e-3), effective_radius=1.0 / curvature.sum(keepdims=True), curvatures=tensors)
    motion = Motion(np.array([[0.3, -1.1]]), np.ones(1), np.array([[0.6]]))
    for what in ("damping", "couple"):
        found, expected = (getattr(law(1e-2), what)(each, motion) for each in (ellipses, circles))
        np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_balls_beside_ellipsoids_resist_as_without_them() -> None:
    """To the last digit, also where all have tensors."""
    ball = contact(1e-3, 1.3, 0.6, dimension=3)
    known = np.eye(3) - ball.normal[0][:, None] * ball.normal[0]
    ball = replace(ball, curvatures=np.stack([known / 1.3, known / 0.6])[None])
    both = joined([ball, between(tensor((0.7, 1.9), 0.0), np.eye(2), 1e-3)])
    random = np.random.default_rng(4)
    motion = Motion(random.normal(size=(2, 3)), np.ones(2), random.normal(size=(2, 3)))
    for what in ("damping", "couple"):
        found = getattr(law(1e-2), what)(both, motion)
        np.testing.assert_array_equal(found[:1], getattr(law(1e-2), what)(ball, motion.select(np.array([0]))))
        assert found[1].any()
