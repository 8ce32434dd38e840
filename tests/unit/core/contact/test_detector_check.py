"""Detectors that miss some pairs only are named, wherever these are among all pairs and whatever the bodies' shapes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.contact.detector_check import MOST_PAIRS, check_detector
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.interfaces import Detector
from rigidfluid.core.model.system import System
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import PluginError

CONTACT = {"law": "centre", "range": 0.02, "epsilon": 1e-4, "epsilon_wall": 1e-4, "detector": "sphere"}
PAIRS = 6
"""Number of pairs, each nearer than the one before: the first are never among the nearest."""


@contextmanager
def blind(detector: type[Detector], *pair: int, after: int = 0) -> Iterator[None]:
    """A detector that does not find the contacts of two surfaces, once it has been asked so often."""
    honest, asked = detector.detect, [0]

    def detect(self: Any, *given: Any) -> Any:
        found = honest(self, *given)
        asked[0] += 1
        missed = (found.body_a == min(pair)) & (found.body_b == max(pair)) & (asked[0] > after)
        return select(found, ~missed)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(detector, "detect", detect)
        yield


def pairs_of(table: Callable[[list[float], list[float]], dict[str, Any]], contact: dict[str, Any]) -> Scene:
    """Pairs of bodies that approach each other slowly, the first farthest apart."""
    bodies = []
    for pair in range(PAIRS):
        height, half = 0.25 + 0.35 * pair, 0.105 - 0.0005 * pair
        bodies += [table([0.5 - half, height], [0.01, 0.0]), table([0.5 + half, height], [-0.01, 0.0])]
    return dry_scene(contact, *bodies, end=0.03, step=1e-4, upper=[1.0, 0.35 * PAIRS + 0.15])


def ellipse(position: list[float], velocity: list[float]) -> dict[str, Any]:
    return {
        "type": "ellipsoid",
        "semi_axes": [0.1, 0.08],
        "density": 1.0,
        "position": position,
        "velocity": velocity,
    }


def assembled(scene: Scene) -> System:
    return assemble(model_of(scene))


BALLS = pairs_of(ball, CONTACT)
ELLIPSES = pairs_of(ellipse, CONTACT | {"law": "contact", "detector": "ellipsoid"})


def test_a_pair_of_balls_that_is_not_among_the_nearest() -> None:
    assert PAIRS > MOST_PAIRS
    with blind(SphereDetector, 0, 1), pytest.raises(PluginError, match="no contact of body0 and body1"):
        rigidfluid.run(BALLS)


def test_a_ball_at_a_wall_that_is_not_among_the_nearest() -> None:
    near = [ball([0.105 + 0.001 * place, 0.25 + 0.3 * place], [0.0, 0.0]) for place in range(PAIRS)]
    scene = dry_scene(CONTACT, *near, end=0.03, step=1e-4, upper=[1.0, 0.3 * PAIRS + 0.2])
    system = assembled(scene)
    wall = system.surfaces.index("left")
    told = f"no contact of body{PAIRS - 1} and left"
    with (
        blind(SphereDetector, PAIRS - 1, wall),
        pytest.raises(PluginError, match=told),
    ):
        check_detector(system, system.pose, None, 0)


def test_blindness_that_comes_while_a_run_goes_on() -> None:
    with blind(SphereDetector, 0, 1, after=20), pytest.raises(PluginError, match="no contact of body0 and body1"):
        rigidfluid.run(BALLS)


def test_balls_that_overlap_have_a_contact() -> None:
    system = assembled(BALLS)
    position = system.pose.position.copy()
    position[1] = position[0] + [0.15, 0.0]
    pose = replace(system.pose, position=position)
    check_detector(system, pose, None, 0)
    with blind(SphereDetector, 0, 1), pytest.raises(PluginError, match="no contact of body0 and body1"):
        check_detector(system, pose, None, 0)


def test_pairs_of_other_shapes_are_drawn_until_the_one_is_found() -> None:
    with blind(EllipsoidDetector, 0, 1), pytest.raises(PluginError, match="no contact of body0 and body1"):
        rigidfluid.run(ELLIPSES)


def test_honest_detectors_pass() -> None:
    for scene in (BALLS, ELLIPSES):
        system = assembled(scene)
        for count in range(20):
            check_detector(system, system.pose, None, count)
