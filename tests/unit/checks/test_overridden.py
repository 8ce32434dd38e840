"""Conditions without effect are noted."""

from __future__ import annotations

from typing import Any

from paths import SCENES

from rigidfluid import load_scene
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict


def overridden(*tables: dict[str, Any]) -> list[str]:
    scene = load_scene(SCENES / "dry_bounce.toml").to_dict()
    found = check(scene_from_dict({**scene, "boundary": list(tables)})).findings
    return [one.text for one in found if one.question == "boundary"]


def test_an_earlier_condition_of_the_same_face_is_noted_under_either_name() -> None:
    (text,) = overridden({"on": "top", "type": "wall"}, {"on": "ymax", "type": "slip"})
    assert text == "boundary.0, 'wall' on 'top', has no effect, as boundary.1 overrides it"


def test_a_later_condition_on_all_is_noted() -> None:
    (text,) = overridden({"on": "top", "type": "slip"}, {"on": "all", "type": "wall"})
    assert text.startswith("boundary.0,")


def test_exceptions_from_all_are_not_noted() -> None:
    assert overridden({"on": "all", "type": "wall"}, {"on": "top", "type": "slip"}) == []
