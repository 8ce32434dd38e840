"""Where bodies are put for the narrowest gaps of a run."""

from __future__ import annotations

import numpy as np
import pytest
from falling import SCENES, falling_disk

from rigidfluid.checks.settled_pose import settled_pose
from rigidfluid.core.case.load import load_scene, scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.system import build_system
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.scene.scene import Scene

GAP = 0.01
START = "body.0.position=[0.2, 6.0, 0.2]"


def positions(scene: Scene) -> FloatArray:
    return settled_pose(build_system(scene), model_of(scene).exact_detector, GAP).position


def test_a_disk_falls_to_the_floor() -> None:
    np.testing.assert_allclose(positions(falling_disk()), [[1.0, 0.125 + GAP]], atol=0.06 * GAP)


def test_a_light_disk_rises_to_the_top() -> None:
    found = positions(falling_disk(body={"density": 0.5}))
    np.testing.assert_allclose(found, [[1.0, 6.0 - 0.125 - GAP]], atol=0.06 * GAP)


def test_a_disk_comes_to_lie_on_the_one_below() -> None:
    scene = load_scene(SCENES / "two_disks.toml")
    found, radius = positions(scene), 0.1
    lower, upper = found[np.argsort(found[:, 1])]
    assert lower[1] == pytest.approx(radius + GAP, abs=0.06 * GAP)
    assert np.linalg.norm(upper - lower) - 2.0 * radius == pytest.approx(GAP, abs=0.06 * GAP)


def test_an_ellipsoid_comes_to_lie_on_its_side() -> None:
    scene = load_scene(SCENES / "falling_ellipsoid.toml")
    found = settled_pose(build_system(scene), model_of(scene).exact_detector, GAP)
    np.testing.assert_allclose(found.position, [[0.5, 0.1 + GAP, 0.2]], atol=0.06 * GAP)
    long_axis = rotation_matrices(found.orientation)[0, :, 1]
    np.testing.assert_allclose(np.abs(long_axis), [1.0, 0.0, 0.0], atol=1e-9)


def test_without_room_it_falls_as_it_is_turned() -> None:
    scene = load_scene(SCENES / "falling_ellipsoid.toml", ["domain.upper=[0.4, 8.0, 0.4]", START])
    system = build_system(scene)
    found = settled_pose(system, model_of(scene).exact_detector, GAP)
    assert 0.2 < found.position[0, 1] < 0.2 + 2.0 * GAP
    np.testing.assert_array_equal(found.orientation, system.pose.orientation)


@pytest.mark.parametrize("angle", [0.3, 1.0, np.pi / 2, np.pi])
def test_a_rectangle_lies_on_its_long_side(angle: float) -> None:
    corners = [[-0.3, -0.1], [0.3, -0.1], [0.3, 0.1], [-0.3, 0.1]]
    data = falling_disk(contact={"law": "normal", "detector": "auto"}).to_dict()
    data["body"] = [{"type": "polygon", "points": corners, "angle": angle, "density": 1.25, "position": [1.0, 4.0]}]
    assert positions(scene_from_dict(data))[0, 1] == pytest.approx(0.1 + GAP, abs=0.06 * GAP)


@pytest.mark.parametrize(
    "scene",
    [
        falling_disk(body={"fixed": True}),
        load_scene(SCENES / "swimmer.toml"),
        load_scene(SCENES / "dfg_cylinder.toml"),
        load_scene(SCENES / "hinged_pair.toml"),
    ],
    ids=["fixed", "mechanism", "weightless", "joint"],
)
def test_what_is_held_or_weightless_stays(scene: Scene) -> None:
    np.testing.assert_array_equal(positions(scene), build_system(scene).pose.position)
