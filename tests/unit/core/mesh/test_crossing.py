"""Beside obstacles contacts across periodic surfaces are not seen, and bodies are refused where they would have any."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from scenes import wet_tables

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.checks import check
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mesh.adaptation.crossing import refuse_to_cross, unseen_contacts
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.errors import StepError, StepRejected

POST = {"name": "post", "type": "sphere", "radius": 0.1, "position": [0.2, 0.25]}
SIDES = [{"on": side, "type": "periodic"} for side in ("left", "right")]
LAW = {"law": "normal", "range": 0.04, "epsilon": 1e-4}


def tables(*bodies: dict[str, Any], obstacle: dict[str, Any] = POST, **more: Any) -> dict[str, Any]:
    domain = {"type": "channel", "lower": [0.0, 0.0], "upper": [2.0, 1.0], "obstacle": [obstacle]}
    sizes = {"size": 0.15, "size_body": 0.05}
    given = {"domain": domain, "boundary": SIDES, "mesh": sizes, "contact": LAW, "end": 0.5, "step": 0.02} | more
    return wet_tables(*bodies, **given)


def disk(name: str, *place: float, **more: Any) -> dict[str, Any]:
    return {"name": name, "type": "sphere", "radius": 0.1, "density": 2.0, "position": list(place)} | more


def system(*bodies: dict[str, Any], **more: Any) -> System:
    return assemble(model_of(scene_from_dict(tables(*bodies, **more))))


def at(*places: tuple[float, float]) -> Pose:
    return Pose(np.array(places), np.zeros((len(places), 1)))


def test_an_image_of_a_body_or_of_an_obstacle_is_found_within_the_range_alone() -> None:
    two = system(disk("a", 1.5, 0.7), disk("b", 0.5, 0.7))
    assert list(unseen_contacts(two, at((1.5, 0.7), (0.5, 0.7)))) == []
    assert list(unseen_contacts(two, at((1.87, 0.7), (0.115, 0.7)))) == []
    met = list(unseen_contacts(two, at((1.88, 0.7), (0.115, 0.7))))
    assert [(body, other) for body, other, _ in met] == [(0, "b"), (1, "a")]
    assert [gap for *_, gap in met] == pytest.approx([0.035, 0.035], abs=1e-4)
    assert list(unseen_contacts(two, at((1.95, 0.25), (0.5, 0.7)))) == []
    ((body, other, gap),) = unseen_contacts(two, at((1.98, 0.25), (0.5, 0.7)))
    assert (body, other) == (0, "post")
    assert gap == pytest.approx(0.02, abs=1e-4)


def test_what_a_body_touches_where_it_is_is_no_image() -> None:
    one = system(disk("a", 1.5, 0.7))
    assert list(unseen_contacts(one, at((0.43, 0.25)))) == []
    refuse_to_cross(one, at((0.43, 0.25)))
    with pytest.raises(StepRejected, match=r"0\.02 to 'post' across a periodic surface"):
        refuse_to_cross(one, at((1.98, 0.25)))
    with pytest.raises(StepRejected, match="beyond a periodic surface"):
        refuse_to_cross(one, at((2.01, 0.7)))


class Floor:
    """A round floor with its top at x = .9."""

    plane = None

    def closest_point(self, points: np.ndarray) -> np.ndarray:
        away = points - [0.9, -10.0]
        return np.array([0.9, -10.0]) + 10.05 * away / np.linalg.norm(away, axis=1, keepdims=True)


def test_a_curved_wall_that_goes_on_is_met_where_the_image_is_nearer_to_it() -> None:
    one = system(disk("a", 1.5, 0.7))
    floored = replace(one, walls=(Wall(9, "floor", cast("Surface", Floor())),))
    assert list(unseen_contacts(floored, at((0.03, 0.125)))) == []
    ((_, other, gap),) = unseen_contacts(floored, at((1.97, 0.125)))
    assert other == "floor"
    assert gap < 0.04


def test_prescribed_bodies_and_those_without_a_law_have_no_contacts() -> None:
    near = at((1.98, 0.25))
    assert list(unseen_contacts(system(disk("a", 1.5, 0.7, fixed=True)), near)) == []
    assert list(unseen_contacts(system(disk("a", 1.5, 0.7), contact={}), near)) == []


def test_a_run_ends_before_such_a_contact() -> None:
    run = Simulation(scene_from_dict(tables(disk("a", 1.8, 0.25, velocity=[1.0, 0.0], density=50.0))))
    with pytest.raises(StepError, match=r"body 'a'.* to 'post' across a periodic surface"):
        run.go()
    assert run.state.pose.position[0, 0] < 1.961


def test_a_check_tells_where_bodies_do_not_cross_and_what_is_not_seen() -> None:
    post = POST | {"position": [0.11, 0.25]}
    found = [
        one for one in check(scene_from_dict(tables(disk("a", 1.89, 0.25)))).findings if one.question == "periodic"
    ]
    assert [one.grade for one in found] == ["note"]
    scene = scene_from_dict(tables(disk("a", 1.89, 0.25), obstacle=post))
    found = [one for one in check(scene).findings if one.question == "periodic"]
    assert [(one.grade, one.subject) for one in found] == [("error", ("a", "post")), ("note", ())]
