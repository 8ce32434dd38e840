"""Parts of tables are built in one way: bodies of a scene, obstacles of its domain, components of its mechanisms."""

from __future__ import annotations

from typing import Any

import pytest
from scenes import dry_tables

from rigidfluid.api import (
    BODY,
    Body,
    NestedBodyTable,
    PluginError,
    Registry,
    SceneError,
    Sphere,
    build_shape,
    scene_from_dict,
)
from rigidfluid.core.nested.part_options import build_part, told_at
from rigidfluid.core.scene.body_tables import BodyTable
from rigidfluid.registry import KINDS

BALL = {"type": "sphere", "radius": 0.1, "position": [0.5, 0.5]}
POINTS = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1], [0.0, 0.0]]


def scenes(shape: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Scenes with a shape in each of the places that it may have, by that place."""
    ball = BALL | {"name": "ball", "density": 2.0, "position": [0.2, 0.2]}
    whole = {"name": "whole", "type": "articulated", "position": [0.5, 0.5]}
    return {
        "body.1": dry_tables(ball, shape | {"name": "it", "density": 2.0}),
        "domain.obstacle.0": dry_tables(
            ball, domain={"type": "channel", "lower": [0.0, 0.0], "upper": [1.0, 1.0], "obstacle": [shape]}
        ),
        "mechanism.0.component.0": dry_tables(ball, mechanism=[whole | {"component": [shape | {"density": 2.0}]}]),
    }


REFUSED = {
    "an unknown key": (BALL | {"raduis": 0.1}, "raduis"),
    "a value": (BALL | {"radius": -0.1}, "radius"),
    "a type that is not there": (BALL | {"type": "spere"}, "type"),
    "what the shape itself refuses": ({"type": "polygon", "points": POINTS, "position": [0.5, 0.5]}, "points"),
}


@pytest.mark.parametrize(("shape", "key"), REFUSED.values(), ids=REFUSED)
def test_a_shape_is_refused_alike_wherever_its_table_is(shape: dict[str, Any], key: str) -> None:
    told = set()
    for place, tables in scenes(shape).items():
        with pytest.raises((SceneError, PluginError)) as caught:
            scene_from_dict(tables)
        assert caught.value.subject == f"{place}.{key}"
        told.add(str(caught.value.found))
    assert len(told) == 1


def test_tables_of_a_scene_and_within_those_of_parts_give_the_same_shape() -> None:
    given: dict[str, Any] = BALL | {"position": (0.5, 0.5)}
    inner = NestedBodyTable(**given)
    outer = BodyTable(**given, name="ball", density=2.0)
    registry = Registry.load()
    built: list[Body] = [build_part(BODY, table, "body.0", registry, 2) for table in (inner, outer)]
    built.append(build_shape(inner, "domain.obstacle.0", 2))
    assert [(type(shape), shape.options) for shape in built] == [(Sphere, built[0].options)] * 3


def test_an_error_of_a_plug_in_keeps_its_subject_and_one_of_a_table_within_gets_its_place() -> None:
    with pytest.raises(PluginError, match=r"^plug-in x: "), told_at("mechanism.0"):
        raise PluginError("plug-in x", "none", "one", "Mend it.")
    with pytest.raises(PluginError, match=r"^mechanism\.0\.component\.1\.type: "), told_at("mechanism.0"):
        raise PluginError("mechanism.component.1.type", "none", "one", "Mend it.")
    with pytest.raises(SceneError, match=r"^joint\.3\.axis: "), told_at("joint.3"):
        raise SceneError("joint.axis", "none", "one", "Mend it.")


@pytest.mark.parametrize("within", [kind.field.rpartition(".")[0] for kind in KINDS])
def test_a_part_within_another_is_told_at_the_place_of_the_whole(within: str) -> None:
    with pytest.raises(SceneError, match=r"^mechanism\.2\.axis: "), told_at("mechanism.2"):
        raise SceneError(f"{within}.axis", "none", "one", "Mend it.")


def test_a_key_with_the_name_of_a_part_is_kept() -> None:
    with pytest.raises(SceneError, match=r"^joint\.3\.body\.1: "), told_at("joint.3"):
        raise SceneError("joint.body.1", "none", "one", "Mend it.")
