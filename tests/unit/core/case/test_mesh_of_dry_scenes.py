"""A table of a mesh in a scene without a fluid: a run makes none, and it may contradict itself no more than in one."""

from __future__ import annotations

from typing import Any

import pytest
from scenes import dry_tables, wet_tables

from rigidfluid.api import NoFluid, SceneError, model_of, scene_from_dict

BALL = {"name": "ball", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.5, 0.5]}
SIZES = {"size": 0.2, "size_body": 0.1}
CONTRADICTIONS: dict[str, dict[str, Any]] = {
    "coarser on the body": {"size_body": 0.3},
    "regenerated within a step": {"remesh_every": 1e-3},
    "a coarser wall": {"size_wall": 0.3},
    "a coarser box": {"refine": [{"lower": [0.1, 0.1], "upper": [0.2, 0.2], "size": 0.3}]},
    "a box beyond the domain": {"refine": [{"lower": [1.1, 0.1], "upper": [1.2, 0.2], "size": 0.1}]},
    "cells without end": {"size": 1e-6, "size_body": 1e-6},
    "a field that is not installed": {"field": [{"type": "vorticty"}]},
    "an option that a field has not": {"field": [{"type": "vorticity", "sise": 1.0}]},
}


def refusal(tables: dict[str, Any]) -> str:
    with pytest.raises(Exception, match=r"^mesh\.") as caught:
        scene_from_dict(tables)
    return str(caught.value)


@pytest.mark.parametrize("mesh", CONTRADICTIONS.values(), ids=CONTRADICTIONS)
def test_a_contradiction_is_refused_as_in_a_scene_with_a_fluid(mesh: dict[str, Any]) -> None:
    assert refusal(dry_tables(BALL, mesh=SIZES | mesh)) == refusal(wet_tables(BALL, mesh=SIZES | mesh))


def test_its_run_has_no_mesh() -> None:
    model = model_of(scene_from_dict(dry_tables(BALL, mesh=SIZES)))
    assert isinstance(model.fluid, NoFluid)
    assert model.fluid.mesh is None
    assert model.fluid.insertion is not None


def test_without_the_table_there_is_nothing_to_refuse() -> None:
    assert model_of(scene_from_dict(dry_tables(BALL))).fluid.insertion is None


def test_a_table_without_its_keys_is_refused() -> None:
    with pytest.raises(SceneError, match=r"^mesh\.size: this key is missing"):
        scene_from_dict(dry_tables(BALL, mesh={"size_body": 0.1}))
