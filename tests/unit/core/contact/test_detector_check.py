"""Detectors that miss some pairs only are named, wherever these are among all pairs and whatever the bodies' shapes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from falling import SCENES

import rigidfluid
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.contact.pairs.detector_check import MOST_PAIRS, check_detector
from rigidfluid.core.geometry.arrays import BoolArray
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import PluginError

CONTACT = {"law": "centre", "range": 0.02, "epsilon": 1e-4, "epsilon_wall": 1e-4, "detector": "sphere"}
PAIRS = 6
"""Number of pairs, each nearer than the one before: the first are never among the nearest."""


Change = Callable[[Contacts], Contacts]


@contextmanager
def lying(detector: type[Detector], change: Change, after: int = 0) -> Iterator[None]:
    """A detector whose answers change, once it has been asked so often."""
    honest, asked = detector.detect, [0]

    def detect(self: Any, *given: Any) -> Any:
        found = honest(self, *given)
        asked[0] += 1
        return change(found) if asked[0] > after else found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(detector, "detect", detect)
        yield


def blind(detector: type[Detector], *pair: int, after: int = 0) -> AbstractContextManager[None]:
    """A detector that does not find the contacts of two surfaces, once it has been asked so often."""
    return lying(detector, lambda found: select(found, ~between(found, *pair)), after)


def between(found: Contacts, a: int, b: int) -> BoolArray:
    return (found.body_a == a) & (found.body_b == b)


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
    system = replace(assembled(scene), reach=0.05)
    wall = system.surfaces.index("left")
    told = f"no contact of body{PAIRS - 1} and left"
    with blind(SphereDetector, PAIRS - 1, wall), pytest.raises(PluginError, match=told):
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


def slender(position: list[float]) -> dict[str, Any]:
    return ellipse(position, [0.0, 0.0]) | {"semi_axes": [0.1, 0.02]}


def hedge(*others: dict[str, Any]) -> Scene:
    """Slender ellipses beside each other, in reach by their bounding balls and not by their gaps; and others."""
    upright = [slender([0.3 + 0.45 * row, 0.2 + 0.15 * place]) for row in range(2) for place in range(12)]
    contact = CONTACT | {"law": "contact", "detector": "ellipsoid"}
    return dry_scene(contact, *upright, *others, end=0.0128, step=1e-4, upper=[1.4, 2.5])


def is_caught(system: System, count: int) -> bool:
    try:
        check_detector(system, system.pose, None, count)
    except PluginError:
        return True
    return False


def caught(scene: Scene, *pair: int) -> list[bool]:
    """Whether a detector that is blind for a pair is caught, in each of many checks."""
    system = replace(assembled(scene), reach=0.05)
    with blind(EllipsoidDetector, *pair):
        return [is_caught(system, count) for count in range(40)]


def test_among_many_pairs_that_are_out_of_reach_one_is_drawn_at_times() -> None:
    near = [slender([0.3 + 0.22 * place, 2.2]) for place in range(5)]
    told = caught(hedge(*near), 24, 25)
    assert 0.03 < np.mean(told) < 0.5


def test_checks_of_a_run_draw_different_pairs() -> None:
    near = [slender([0.3 + 0.22 * place, 2.2]) for place in range(5)]
    scene = hedge(*near, *(slender([0.15 + 0.3 * place, 2.35]) for place in range(4)))
    assert len(model_of(scene).bodies) > 30, "fewer are all in reach"
    with blind(EllipsoidDetector, 26, 27), pytest.raises(PluginError, match="no contact of body26 and body27"):
        rigidfluid.run(scene)


def test_balls_among_other_shapes_come_first() -> None:
    others = [slender([0.3 + 0.205 * place, 2.2]) for place in range(4)]
    balls = [ball([1.25, 0.5], [0.0, 0.0], radius=0.05), ball([1.25, 0.62], [0.0, 0.0], radius=0.05)]
    assert all(caught(hedge(*others, *balls), 28, 29))


def turned_away(found: Contacts, angle: float) -> Contacts:
    """Contacts of the first two balls, one above the other, at other points of both, which are farther apart."""
    rows = between(found, 0, 1)
    away = found.radius_a[rows, None] * np.array([np.sin(angle), 1.0 - np.cos(angle)])
    point_a, point_b = found.point_a.copy(), found.point_b.copy()
    point_a[rows] += away * [1.0, -1.0]
    point_b[rows] += away
    apart = point_a - point_b
    gap = np.where(rows, np.linalg.norm(apart, axis=1), found.gap)
    normal = np.where(rows[:, None], apart / gap[:, None], found.normal)
    return replace(found, point_a=point_a, point_b=point_b, gap=gap, normal=normal)


@pytest.mark.parametrize("angle", [0.05, 0.1])
def test_points_that_are_not_the_nearest(angle: float) -> None:
    """Those of the nearest two balls, which are larger than others, are on both surfaces and farther apart."""
    large = [ball([0.3, y], [0.0, 0.0], radius=0.2) for y in (0.25, 0.655)]
    small = [ball([x, 0.2 + 0.2 * pair], [0.0, 0.0], radius=0.05) for pair in range(4) for x in (0.6, 0.71)]
    system = assembled(dry_scene(CONTACT, *large, *small, end=0.03, step=1e-4))
    check_detector(system, system.pose, None, 0)
    told = "no contact of body0 and body1; allowed is one with a gap of 0.005"
    with lying(SphereDetector, lambda found: turned_away(found, angle)), pytest.raises(PluginError, match=told):
        check_detector(system, system.pose, None, 0)


def test_points_that_are_not_on_the_surfaces() -> None:
    """Both moved along the normal, so that they are as far apart as before."""

    def moved(found: Contacts) -> Contacts:
        by = 1e-3 * found.normal
        return replace(found, point_a=found.point_a + by, point_b=found.point_b + by)

    system = assembled(BALLS)
    with lying(SphereDetector, moved), pytest.raises(PluginError, match=r"0\.001 off body"):
        check_detector(system, system.pose, None, 0)


def test_honest_detectors_pass() -> None:
    for scene in (BALLS, ELLIPSES):
        system = assembled(scene)
        for count in range(20):
            check_detector(system, system.pose, None, count)


def test_a_place_at_which_two_pieces_meet_may_be_a_contact_of_one_of_them() -> None:
    system = assembled(rigidfluid.load_scene(SCENES / "insertion_2d.toml"))
    for count in range(20):
        check_detector(system, system.pose, None, count)
