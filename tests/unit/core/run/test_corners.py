"""Steps in a fluid at the corners of strokes, where velocities that are given change at once."""

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation

ROWS = [[0.0, 0.0], [0.06, 0.12], [0.1, 0.12], [0.16, 0.0], [0.2, 0.0]]


def scene(model="navier-stokes", rows=ROWS, joined="piecewise", end=0.2, step=0.02, every=None):
    """Two balls, the right one going to and fro."""
    parts = [
        {"name": name, "type": "sphere", "radius": 0.1, "density": 1.5, "position": [x, 0.0]}
        for name, x in (("left", 0.0), ("right", 0.5))
    ]
    stroke = {"moves": ["right"], "along": [1.0, 0.0], joined: rows}
    return scene_from_dict(
        {
            "scene": {"name": "corners", "dimension": 2},
            "fluid": {"backend": "scikit-fem", "model": model, "density": 1.0, "viscosity": 1.0},
            "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
            "mechanism": [
                {"name": "it", "type": "articulated", "component": parts, "stroke": [stroke], "position": [0.9, 0.45]}
            ],
            "mesh": {"size": 0.3, "size_body": 0.06},
            "time": {"end": end, "step": step},
            "output": {"every": every or end},
        }
    )


def created_at_the_corner(step, rows=ROWS):
    """What the balance does not account for from before the corner at 0.06 to 0.04 after it, over what was put in."""
    it = Simulation(scene(step=step, rows=rows))
    it.go(0.06)
    before = it.state.ledger.residual
    it.go(0.1)
    return (it.state.ledger.residual - before) / it.state.ledger.put_in


def test_a_step_ends_at_a_corner_and_the_next_ones_are_short():
    it, times = Simulation(scene(end=0.1)), [0.0]
    it.observe(lambda now: times.append(now.time))
    it.go()
    corner = next(number for number, time in enumerate(times) if time == pytest.approx(0.06))
    steps = np.diff(times)
    assert steps[corner - 1] == pytest.approx(0.02)
    np.testing.assert_allclose(steps[corner : corner + 8], 0.02 / np.array([64, 64, 64, 64, 32, 32, 16, 16]))


def test_what_an_impulse_at_a_corner_gives_back_is_in_the_balance():
    """The moving ball stops at once: the fluid that it set in motion pushes it on, and the drive holds it back."""
    errors = [abs(created_at_the_corner(step)) for step in (0.02, 0.01)]
    assert errors[0] < 0.005
    assert errors[1] < 0.65 * errors[0]


def test_a_corner_between_two_ticks_is_as_good_as_one_at_a_tick():
    rows = [[0.0, 0.0], [0.06005, 0.12], *ROWS[2:]]
    it = Simulation(scene(end=0.1, rows=rows))
    it.go(0.06)
    it.step()
    assert 0.06005 - 0.02 / 1024 < it.time < 0.06005
    assert abs(created_at_the_corner(0.02, rows)) < 0.005


def test_without_inertia_of_the_fluid_a_corner_leaves_no_error_of_a_whole_step():
    it = Simulation(scene("stokes"))
    it.go()
    assert abs(it.state.ledger.relative_residual) < 0.01


def test_a_smooth_stroke_has_no_corners():
    it = Simulation(scene(joined="smooth"))
    it.go(0.1)
    assert it.state.count == 5
    assert it.system.motions.next_corner(0.0) == np.inf


@pytest.mark.parametrize("end", [0.06, 0.06 + 0.02 / 64])
def test_a_run_that_is_resumed_at_a_corner_goes_on_with_the_same_bits(tmp_path, end):
    whole = rigidfluid.run(scene(end=0.1, every=end), tmp_path / "whole")
    rigidfluid.run(scene(end=end, every=end), tmp_path / "resumed")
    rigidfluid.run(scene(end=0.1, every=end), tmp_path / "resumed", resume=True)
    assert whole.summary["steps"] > 8
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "resumed" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
