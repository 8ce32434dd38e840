"""Several processes with DOLFINx' backend take the steps, and give the responses, that one does with scikit-fem's."""

import json
import shutil
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

pytestmark = [
    pytest.mark.skipif(find_spec("dolfinx") is None, reason="DOLFINx is not installed"),
    pytest.mark.skipif(shutil.which("mpirun") is None, reason="there is no mpirun"),
]

STEPS = Path(__file__).parents[1] / "support" / "shared_steps.py"
RESPONSES = Path(__file__).parent / "shared_responses.py"
CHANNEL = {
    "scene": {"name": "channel", "dimension": 2},
    "fluid": {"density": 1.0, "viscosity": 0.1, "gravity": [0.0, -10.0], "tolerance": 1e-13},
    "domain": {"lower": [0.0, 0.0], "upper": [3.0, 1.0]},
    "boundary": [{"on": "left", "type": "velocity", "velocity": [1.0, 0.0], "profile": "parabolic"}]
    + [{"on": "right", "type": "pressure", "pressure": 0.3}, {"on": "top", "type": "slip"}],
    "body": [
        {"type": "sphere", "radius": 0.15, "density": 2.0, "position": [1.1, 0.5]},
        {"type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.4, 0.7]},
        {"type": "sphere", "radius": 0.15, "position": [2.0, 0.5], "density": 1.0}
        | {"prescribed": {"velocity": [0.0, -0.2], "angular_velocity": 1.0}},
    ],
    "mesh": {"size": 0.2, "size_body": 0.04},
    "time": {"step": 0.002, "end": 1.0},
    "output": {"every": 1.0, "probes": [[0.1, 0.1], [1.5, 0.5], [2.9, 0.9], [1.1, 0.5]]},
}
ENCLOSED = CHANNEL | {
    "scene": {"name": "enclosed", "dimension": 2},
    "boundary": [
        {"on": "left", "type": "velocity", "velocity": [1.0, 0.0], "profile": "parabolic"},
        {"on": "right", "type": "velocity", "velocity": [0.6666666666666666, 0.0]},
    ],
    "body": CHANNEL["body"][:2],
}
ROOM = CHANNEL | {
    "scene": {"name": "room", "dimension": 3},
    "fluid": CHANNEL["fluid"] | {"gravity": [0.0, -10.0, 0.0]},
    "domain": {"lower": [0.0, 0.0, 0.0], "upper": [2.0, 1.0, 1.0]},
    "boundary": [{"on": "left", "type": "velocity", "velocity": [0.5, 0.0, 0.0]}]
    + [{"on": "right", "type": "pressure", "pressure": 0.3}, {"on": "front", "type": "slip"}],
    "body": [{"type": "sphere", "radius": 0.25, "density": 2.0, "position": [1.1, 0.5, 0.5]}],
    "mesh": {"size": 0.5, "size_body": 0.2},
    "output": {"every": 1.0, "probes": [[0.1, 0.1, 0.1], [1.9, 0.9, 0.9]]},
}


THINNING = CHANNEL | {
    "fluid": {"density": 1.0, "gravity": [0.0, -10.0], "tolerance": 1e-13}
    | {"material": {"type": "carreau", "viscosity": 0.2, "relaxation_time": 1.0, "exponent": 0.5}},
    "mesh": CHANNEL["mesh"] | {"order": 1},
}
"""Straight cells alone: in curved ones a viscosity that varies is integrated by each backend's own rule."""


@pytest.fixture
def printed(mpirun, tmp_path):
    """What a script prints of a scene."""

    def run(count, script, scene, more):
        (tmp_path / "scene.json").write_text(json.dumps(scene))
        result = mpirun(count, script, tmp_path / "scene.json", json.dumps(more))
        assert result.returncode == 0, result.stderr
        return json.loads(result.stdout)

    return run


def assert_all_as_alone(found, tolerance, **tolerances):
    for shared, _ in found["shared"]:
        assert shared == found["shared"][0][0]
        for name, expected in found["alone"].items():
            allowed = tolerances.get(name, tolerance) * np.nanmax(np.abs(expected))  # probes without a scalar have NaN
            np.testing.assert_allclose(shared[name], expected, rtol=0, atol=allowed, err_msg=name)


def assert_keeps_no_memory(found, times):
    """Far less each time than the matrices of a step, or a mesh of every second; a leak shows always, the heap grows
    in leaps."""
    for _, held in found["shared"]:
        assert np.diff(held).min() < times * 30_000


@pytest.mark.parametrize("scene", [CHANNEL, ENCLOSED, ROOM, THINNING], ids=["channel", "enclosed", "room", "thinning"])
def test_three_processes_step_as_one_does(printed, scene):
    found = printed(3, STEPS, scene, [])
    assert found["alone"]["remeshes"] == 1
    assert_all_as_alone(found, 1e-8)


@pytest.mark.parametrize("scene", [CHANNEL, ROOM], ids=["channel", "room"])
@pytest.mark.parametrize("count", [1, 2])
def test_processes_respond_to_impulses_as_one_does(printed, count, scene):
    """Each to the accuracy that is asked of it."""
    found = printed(count, RESPONSES, scene, [])
    assert_all_as_alone(found, 1e-8, inviscid=1e-4, viscous=1e-4, turned=1e-3)


def test_a_step_keeps_no_memory(printed):
    assert_keeps_no_memory(printed(3, STEPS, CHANNEL, [10, 10, 10, 10]), 10)


def test_a_response_keeps_no_memory(printed):
    assert_keeps_no_memory(printed(2, RESPONSES, CHANNEL, [10, 10, 10, 10]), 10)
