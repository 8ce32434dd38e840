"""A check judges bodies that enter while the scene runs as it does those of the start."""

from __future__ import annotations

import tomllib
from typing import Any

import pytest
from page_code import page_blocks
from paths import ROOT
from scenes import dry_tables, wet_tables

from rigidfluid.api import scene_from_dict
from rigidfluid.checks import check
from rigidfluid.checks.finding import Finding
from rigidfluid.core.case.population_due import body_alone
from rigidfluid.core.case.scene_model import model_of

POST = {"name": "post", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.8, 0.8], "fixed": True}
SHAPES = [{"type": "sphere", "radius": 0.05}, {"type": "ellipsoid", "semi_axes": [0.06, 0.04]}]
REGION = {"type": "box", "lower": [0.1, 0.5], "upper": [0.5, 0.9]}
SOURCE = {"name": "grain", "shape": SHAPES, "density": 1.05, "region": REGION, "velocity": [0.0, -1.0]}
LAW = {"law": "normal", "range": 0.02, "epsilon": "auto"}
AT_START = {"memory", "time", "start", "source"}


def findings(make: Any, *bodies: dict[str, Any], **changes: Any) -> list[Finding]:
    given = {"contact": LAW, "fluid": {"gravity": [0.0, -1.0]}, "end": 1.0} | changes
    return list(check(scene_from_dict(make(*bodies, **given))).findings)


@pytest.mark.parametrize("make", [dry_tables, wet_tables])
def test_bodies_of_a_source_are_judged_as_listed_ones(make: Any) -> None:
    beside = {"type": "box", "lower": [0.52, 0.5], "upper": [0.68, 0.9]}
    source = [SOURCE | {"times": [0.1]}, SOURCE | {"name": "pebble", "times": [0.5], "region": beside}]
    scene = scene_from_dict(make(POST, source=source, contact=LAW, fluid={"gravity": [0.0, -1.0]}, end=1.0))
    grains = [dict(body_alone(model_of(scene), number, 0)) for number in range(2)]
    entering = [one for one in findings(make, POST, source=source) if one.question not in AT_START]
    listed = [one for one in findings(make, POST, *grains) if one.question not in AT_START]
    assert entering == listed
    assert {name for one in entering for name in one.subject} >= {"grain0", "pebble0"}


@pytest.mark.parametrize("page", ["seed-bodies", "enter-and-leave"])
def test_scenes_of_the_how_to_have_no_warnings(page: str) -> None:
    blocks = page_blocks(ROOT / "docs" / "howto" / f"{page}.md")
    (text,) = (
        block.text for block in blocks if block.file and block.file.endswith(".toml") and "[scene]" in block.text
    )
    assert [one.text for one in check(scene_from_dict(tomllib.loads(text))).findings if one.grade == "warning"] == []


def test_who_enters_is_told() -> None:
    (many,) = [one for one in findings(dry_tables, POST, source=[SOURCE | {"every": 0.05}]) if one.question == "source"]
    assert (many.grade, many.found) == ("note", {"due": 21})
    assert "21 bodies of grain are due until the end; the first 8 are judged" in many.text
    late = findings(dry_tables, POST, source=[SOURCE | {"times": [3.0]}])
    (none,) = [one for one in late if one.question == "source"]
    assert (none.grade, none.subject) == ("warning", ("grain",))
    assert "no body of grain enters" in none.text


def test_bodies_may_be_driven_to_where_they_leave() -> None:
    outlet = [{"on": "bottom", "type": "pressure", "pressure": 0.0}]
    free = POST | {"fixed": False}
    questions = [
        {
            one.question
            for one in findings(wet_tables, POST, free | {"name": "b", "position": [0.3, 0.5]}, boundary=outlet, **more)
        }
        for more in ({}, {"sink": [{"on": "bottom"}]}, {"sink": [{"on": "bottom", "when": "age > 5"}]})
    ]
    assert ["open-face" in found for found in questions] == [True, False, True]
