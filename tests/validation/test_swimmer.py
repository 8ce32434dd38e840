"""The three-sphere swimmer in 2D against a quasi-static computation in the same channel."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from swimmer_2d import ADVANCE, SWIMS, scene

import rigidfluid

pytestmark = pytest.mark.validation


def second_cycle(label: str) -> tuple[np.ndarray, dict[str, Any]]:
    """Displacement, and the summary."""
    summary = rigidfluid.run(scene(SWIMS[label])).summary
    return np.array(summary["cycles"]["swimmer"]["displacement"][1]), summary


@pytest.mark.parametrize("label", ["as shipped", "step 0.05", "step 0.025", "facets 0.15, cells 2"])
def test_the_advance_is_that_of_the_reference_whatever_step_and_mesh(label: str) -> None:
    moved, summary = second_cycle(label)
    assert moved[0] == pytest.approx(ADVANCE, rel=0.002)
    assert abs(moved[1]) < 1e-3 * ADVANCE
    assert abs(summary["energy"]["relative_residual"]) < 2e-3


def test_reversed_strokes_swim_back() -> None:
    assert second_cycle("strokes in reversed order")[0][0] == pytest.approx(-ADVANCE, rel=0.002)


def test_a_quarter_turn_of_the_swimmer_in_a_square_box_changes_nothing() -> None:
    along, across = (second_cycle(f"box 100 x 100{turn}")[0] for turn in ("", ", turned by 90°"))
    assert across[1] == pytest.approx(along[0], rel=0.002)
    assert abs(across[0]) < 1e-3 * ADVANCE


def test_any_angle_in_a_large_box_gives_the_same_advance_along_the_axis() -> None:
    straight, turned = (second_cycle(f"box 200 x 200{turn}")[0] for turn in ("", ", turned by 30°"))
    axis = np.array([np.cos(np.pi / 6), 0.5])
    assert turned @ axis == pytest.approx(straight[0], rel=0.005)


def test_with_inertia_of_the_fluid_the_balance_of_energy_converges() -> None:
    errors = [
        abs(second_cycle(label)[1]["energy"]["relative_residual"])
        for label in ("Navier–Stokes, Re 8", "Navier–Stokes, step 0.05", "Navier–Stokes, step 0.025")
    ]
    assert errors[0] < 0.05
    assert errors[2] < 0.65 * errors[1] < 0.65 * 0.65 * errors[0]
