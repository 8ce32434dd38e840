"""Options of parts whose keys are aliases of their fields."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from scenes import dry_tables

import rigidfluid
from rigidfluid.api import SceneError, scene_from_dict

Install = Callable[..., Path]

CODE = """
from pydantic import AliasChoices, Field

from rigidfluid.api import PartOptions
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.hookspecs import hookimpl


class RoundOptions(PartOptions):
    radius: float = Field(alias="half-width", gt=0, description="Half of its width [length]")
    colour: str = Field(default="red", validation_alias=AliasChoices("colour", "color"), description="Of its paint")


class Round(Sphere):
    name = "round"
    Options = RoundOptions


@hookimpl
def rigidfluid_bodies():
    return [Round]
"""


def tables(**body: Any) -> dict[str, Any]:
    own = {"name": "it", "type": "round", "density": 1.0, "position": [0.5, 0.5]} | body
    return dry_tables(own, end=0.02)


@pytest.fixture(autouse=True)
def part(install: Install) -> None:
    install(CODE, name="round", module="round_body")


def test_a_scene_gives_an_option_by_its_alias() -> None:
    scene = scene_from_dict(tables(**{"half-width": 0.1, "color": "blue"}))
    assert scene.to_dict()["body"][0]["half-width"] == 0.1
    assert rigidfluid.run(scene).bodies["gap"][-1] == pytest.approx(0.4)


def test_a_component_gives_it_too() -> None:
    component = tables(**{"half-width": 0.1})["body"][0]
    whole = {"name": "whole", "type": "articulated", "position": [0.5, 0.5]}
    both = [component | {"name": name, "position": [x, 0.0]} for name, x in (("a", -0.2), ("b", 0.2))]
    scene_from_dict(tables() | {"body": [], "mechanism": [whole | {"component": both}]})


REFUSED = {
    "the field's own name": ({"radius": 0.1}, r"body\.0\.radius: found a key that nothing reads.*half-width"),
    "nothing": ({}, r"body\.0\.half-width: this key is missing\. Add 'half-width': Half of its width"),
    "no number": ({"half-width": "wide"}, r"body\.0\.half-width: found 'wide'.*Half of its width"),
}


@pytest.mark.parametrize(("given", "said"), REFUSED.values(), ids=REFUSED)
def test_messages_name_the_alias(given: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        scene_from_dict(tables(**given))
