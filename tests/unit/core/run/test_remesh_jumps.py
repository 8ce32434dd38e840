"""Jumps of forces at new meshes, of made-up tables."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns
from rigidfluid.core.run.remesh_jumps import jump_remarks, remesh_jumps

RADII = {"disk": 0.1}


def history(force, torque, remeshes):
    """Of one disk, a row a step."""
    names = columns(2)
    made = History(2)
    for number, (f, t, mesh) in enumerate(zip(force, torque, remeshes, strict=True)):
        body = {"time": 0.1 * number, "step": number, "body": "disk", "fx": f, "t": t}
        step = {"time": 0.1 * number, "step": number, "remeshes": mesh}
        rows = {"bodies": [tuple(body.get(name, 0.0) for name in names["bodies"])]}
        made.extend(rows | {"steps": [tuple(step.get(name, 0.0) for name in names["steps"])]})
    return made


def test_a_load_that_goes_on_straight_does_not_jump():
    line = np.linspace(0.0, 1.0, 20)
    found = remesh_jumps(history(line, -line, [0] * 10 + [1] * 10), RADII)
    assert found["disk"] == {"force": pytest.approx(0.0, abs=1e-12), "torque": pytest.approx(0.0, abs=1e-12)}


def test_a_spike_is_told_over_the_range():
    """Torque of 0 to 2, and a spike by .5 in the second step on the new mesh; the force has none."""
    torque = np.linspace(0.0, 2.0, 20)
    spiked = torque.copy()
    spiked[11] += 0.5
    found = remesh_jumps(history(torque, spiked, [0] * 10 + [1] * 10), RADII)
    assert found["disk"]["torque"] == pytest.approx(0.5 / np.ptp(spiked[5:]))
    assert found["disk"]["force"] == pytest.approx(0.0, abs=1e-12)


def test_a_large_jump_is_noted():
    found = jump_remarks({"a": {"force": 0.05, "torque": 0.2}, "b": {"force": 0.02, "torque": 0.3}})
    assert [remark.text for remark in found] == [
        "the torque on 'b' jumped by up to 30% of its range in the first steps on a new mesh"
    ]
    assert jump_remarks({}) == []


def test_a_spike_elsewhere_is_none_of_a_mesh():
    torque = np.linspace(0.0, 2.0, 20)
    torque[15] += 0.5
    assert remesh_jumps(history(torque, torque, [0] * 10 + [1] * 10), RADII)["disk"]["torque"] < 1e-12


def test_without_new_meshes_there_is_nothing_to_tell():
    line = np.linspace(0.0, 1.0, 20)
    assert remesh_jumps(history(line, line, [0] * 20), RADII) == {}


def test_a_torque_of_nothing_does_not_jump():
    """A thousandth of the force times the radius counts, however small the torque is."""
    force, noise = np.linspace(0.0, 2.0, 20), np.zeros(20)
    noise[10] = 1e-6
    found = remesh_jumps(history(force, noise, [0] * 10 + [1] * 10), RADII)
    assert found["disk"]["torque"] == pytest.approx(1e-6 / (1e-4 * np.ptp(force[5:])))
