"""What bodies put on each other, against sums over all pairs and against stacks that are added up by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scenes import wet_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.setup.stacks import stack_loads

BOX = np.array([2.0, 3.0, 4.0])


def one_by_one(
    own: FloatArray, weight: FloatArray, position: FloatArray, radius: FloatArray, box: FloatArray
) -> FloatArray:
    """The definition, body by body; gravity is along an axis, the last."""
    count, total = len(own), own.copy()
    fit = max(np.floor(np.prod(box[:-1]) / (2.0 * radius.max()) ** (len(box) - 1)), 1.0)
    for i in range(count):
        sums = {+1.0: np.zeros(own.shape[1]), -1.0: np.zeros(own.shape[1])}
        for j in range(count):
            side = np.sign(weight[j, -1])
            if side == 0.0 or (position[i, -1] - position[j, -1]) * side <= 0.0:
                continue
            over = np.linalg.norm((position[i] - position[j])[:-1]) < radius[i] + radius[j]
            sums[side] += own[j] * (1.0 if over else 1.0 / fit)
        total[i] += np.maximum(*sums.values())
    return total


@pytest.mark.parametrize("dimension", [2, 3])
def test_sums_over_all_pairs(dimension: int) -> None:
    rng, count, box = np.random.default_rng(1), 60, BOX[:dimension]
    position, radius = rng.random((count, dimension)) * box, rng.uniform(0.02, 0.2, count)
    weight = np.zeros((count, dimension))
    weight[:, -1] = np.round(rng.normal(-1.0, 2.0, count))  # some rise, some have no weight
    own = np.column_stack([np.abs(weight[:, -1]), rng.random(count)])
    found = stack_loads(own, weight, position, radius, box)
    np.testing.assert_allclose(found, one_by_one(own, weight, position, radius, box))


def test_without_weight_each_bears_its_own() -> None:
    own = np.array([[1.0, 2.0], [3.0, 4.0]])
    assert stack_loads(own, np.zeros((2, 2)), np.eye(2), np.ones(2), BOX[:2]) is own


def test_gravity_aslant_is_gravity_along_an_axis_in_a_turned_box() -> None:
    """Along a diagonal bodies overlap that lie behind each other on it; the square is √2 as wide there."""
    diagonal, across = np.array([1.0, 1.0]) / np.sqrt(2.0), np.array([1.0, -1.0]) / np.sqrt(2.0)
    position = np.array([[1.0, 1.0], [1.0, 1.0] - 0.5 * diagonal, [1.0, 1.0] - 0.5 * diagonal + 0.5 * across])
    found = stack_loads(np.ones((3, 1)), np.tile(diagonal, (3, 1)), position, np.full(3, 0.1), np.array([2.0, 2.0]))
    fit = np.floor(2.0 * np.sqrt(2.0) / 0.2)
    np.testing.assert_allclose(found[0], 1.0 + 1.0 + 1.0 / fit)


# scenes

BALL: dict[str, Any] = {"type": "sphere", "radius": 0.1, "density": 3.0}
AREA = np.pi * 0.1**2


def loads(*bodies: dict[str, Any]) -> Any:
    data = wet_tables(
        *[BALL | body for body in bodies],
        fluid={"viscosity": 0.01, "gravity": [0.0, -10.0]},
        domain={"lower": [0.0, 0.0], "upper": [0.8, 0.8]},
        mesh={"size": 0.08, "size_body": 0.03},
        contact={"law": "normal", "range": 0.03, "epsilon": 1e-7},
        output={"every": 0.5},
    )
    return build_system(scene_from_dict(data)).loads


def test_the_lower_of_two_disks_bears_both() -> None:
    found = loads({"position": [0.4, 0.2]}, {"position": [0.4, 0.5]})
    weight, energy = 2.0 * AREA * 10.0, 0.5 * 4.0 * AREA * found.speed**2
    np.testing.assert_allclose(found.stacked_weight, [2.0 * weight, weight])
    np.testing.assert_allclose(found.stacked_energy, [energy.sum(), energy[1]])


def test_light_disks_press_upward() -> None:
    light = {"density": 0.5}
    found = loads(light | {"position": [0.4, 0.2]}, light | {"position": [0.4, 0.5]})
    np.testing.assert_allclose(found.stacked_weight, np.array([1.0, 2.0]) * 0.5 * AREA * 10.0)


def test_of_what_presses_from_above_and_below_the_larger_counts() -> None:
    below, above = {"density": 0.5, "position": [0.4, 0.15]}, {"position": [0.4, 0.65]}
    found = loads(below, {"density": 2.0, "position": [0.4, 0.4]}, above)
    np.testing.assert_allclose(found.stacked_weight[1], (1.0 + 2.0) * AREA * 10.0)


def test_what_falls_elsewhere_counts_by_a_share() -> None:
    found = loads({"position": [0.2, 0.2]}, {"position": [0.6, 0.5]})
    np.testing.assert_allclose(found.stacked_weight, np.array([1.25, 1.0]) * 2.0 * AREA * 10.0)  # four fit side by side


def test_a_driven_body_bears_without_bound_and_presses_on_nothing() -> None:
    found = loads({"position": [0.4, 0.2]}, {"position": [0.4, 0.5], "fixed": True})
    np.testing.assert_allclose(found.stacked_weight, [2.0 * AREA * 10.0, np.inf])
    assert found.stacked_energy[1] == np.inf
    moved = loads({"position": [0.4, 0.2]}, {"position": [0.4, 0.5], "prescribed": {"velocity": [0.0, -3.0]}})
    assert moved.speed[1] == 3.0
    np.testing.assert_allclose(moved.stacked_energy, [0.5 * 4.0 * AREA * moved.speed[0] ** 2, np.inf])
