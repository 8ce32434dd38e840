"""A disk that hits the floor of a box of fluid: order in time with resolved contacts, and stiff ones that are not."""

import numpy as np
import pytest
from scenes import wet_tables

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict

pytestmark = pytest.mark.long

UNCHANGED = {"size": 0.1, "size_body": 0.03, "quality": 0.01, "refinements": 0, "cells_per_gap": 1}
"""A mesh that serves for the whole bounce."""


def bounce(step, end=0.032, epsilon=1e-7, contact=None, **changes):
    return scene_from_dict(
        wet_tables(
            {"type": "sphere", "radius": 0.125, "density": 3.0, "position": [0.5, 0.2], "velocity": [0.0, -5.0]}
            | changes,
            end=end,
            step=step,
            fluid={"gravity": [0.0, -981.0]},
            contact={"law": "centre", "range": 0.05, "epsilon": epsilon} | (contact or {}),
            mesh={"size": 0.1, "size_body": 0.05, "quality": 0.01, "refinements": 1, "cells_per_gap": 1},
        )
    )


@pytest.mark.parametrize(
    ("stepping", "speed", "end", "largest"),
    [
        pytest.param("substeps", 5.0, 0.032, 7e-4, marks=pytest.mark.nightly),
        ("substeps", 0.0, 0.036, 3e-4),
        pytest.param("implicit", 0.0, 0.036, 2.5e-4, marks=pytest.mark.validation),
    ],
)
def test_second_order_through_a_contact(stepping, speed, end, largest):
    """Positions after the bounce; the mesh is the same, so differences are those of the steps.

    The longest step does not resolve the contact quite; its error is bounded all the same. A start at speed is an
    impact of its own.
    """
    heights = []
    for step in 1e-3 / np.array([1.0, 2.0, 4.0, 8.0]):
        scene = bounce(step, end, contact={"stepping": stepping}, velocity=[0.0, -speed]).to_dict()
        history = rigidfluid.run(scene_from_dict(scene | {"mesh": UNCHANGED}))
        assert history.summary["remeshes"] == 0
        heights.append(history.bodies["y"][-1])
    _, second, third = np.abs(np.diff(heights))
    assert np.abs(heights[0] - heights[-1]) < largest
    assert np.log2(second / third) > 1.8


@pytest.mark.nightly
def test_implicit_contacts_followed_from_a_mesh_turn_the_disk_back():
    history = rigidfluid.run(bounce(5e-4, contact={"stepping": "implicit", "detector": "narrow_band"}))
    assert history.summary["rejected_steps"] == 0
    assert history.bodies["gap"].min() < 0.04
    assert history.bodies["y"][-1] > 0.16


@pytest.mark.parametrize("density", [0.01, 3.0])
@pytest.mark.parametrize(
    ("stepping", "epsilon"),
    [
        ("substeps", 1e-12),
        pytest.param("implicit", 1e-10, marks=pytest.mark.nightly),
        *(pytest.param("substeps", epsilon, marks=pytest.mark.validation) for epsilon in (1e-8, 1e-10)),
        pytest.param("implicit", 1e-8, marks=pytest.mark.validation),
    ],
)
def test_the_step_is_not_tied_to_the_stiffness(stepping, epsilon, density):
    """ωΔt is 10 to 1,000 and more: explicit steps are unstable above 2. What is left is a hop of a step or two."""
    step, volume = 0.004, np.pi * 0.125**2
    start = {"density": density, "position": [0.5, 0.75 if density < 1 else 0.25], "velocity": [0.0, 0.0]}
    data = bounce(step, end=0.25, epsilon=epsilon, contact={"stepping": stepping}, **start).to_dict()
    history = rigidfluid.run(scene_from_dict(data | {"mesh": {"size": 0.1, "size_body": 0.05}}))
    bodies, late = history.bodies, slice(-30, None)
    assert history.summary["rejected_steps"] == 0
    assert 0.0 < bodies["gap"].min() <= 0.05
    weight = volume * (density - 1.0) * 981.0
    fall = abs(weight) * step / (volume * (density + 1.0))
    assert np.abs(bodies["vy"][late]).max() < 2.0 * fall
    assert np.abs(bodies["gap"][late] - 0.05).max() < 3.0 * fall * step
    assert -bodies["cfy"][late].mean() == pytest.approx(-weight, rel=0.1)
