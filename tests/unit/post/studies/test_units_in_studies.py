"""Axes of studies carry the units that the scene names."""

from __future__ import annotations

from pathlib import Path

import pytest
from falling import SCENES

from rigidfluid import load_scene
from rigidfluid.core.scene.scene import Scene
from rigidfluid.post.reports.units import Units
from rigidfluid.post.studies import load_study
from rigidfluid.post.studies.model import FigureTable
from rigidfluid.post.studies.quantities import figure_unit, key_unit
from rigidfluid.post.studies.scene_subject import SceneSubject

NAMES = {"length": "cm", "time": "s", "mass": "g"}


@pytest.fixture(scope="module", params=["falling_disk", "falling_sphere"])
def scene(request: pytest.FixtureRequest) -> Scene:
    return load_scene(SCENES / f"{request.param}.toml")


def test_keys_of_a_scene_have_the_units_of_their_quantities(scene: Scene) -> None:
    units = Units(NAMES, scene.dimension)
    found = {
        key: key_unit(scene, key, units)
        for key in ("body.0.density", "body.0.radius", "fluid.viscosity", "fluid.gravity.1", "time.step")
    }
    assert found == {
        "body.0.density": " [g/cm³]",
        "body.0.radius": " [cm]",
        "fluid.viscosity": " [g/(cm·s)]",
        "fluid.gravity.1": " [cm/s²]",
        "time.step": " [s]",
    }
    assert {key_unit(scene, key, Units(None, 2)) for key in found} == {""}
    assert [key_unit(scene, key, units) for key in ("contact.law", "mesh.growth", "nothing.there")] == ["", "", ""]


@pytest.mark.parametrize(
    ("figure", "unit"),
    [
        ({"table": "bodies", "column": "vy", "at": 0.1}, " [cm/s]"),
        ({"table": "bodies", "column": "y", "at": 0.1}, " [cm]"),
        ({"table": "probes", "column": "pressure", "at": 0.1}, " [g/(cm·s²)]"),
        ({"key": "smallest_gap"}, " [cm]"),
        ({"key": "energy.relative_residual"}, ""),
        ({"key": "cells"}, ""),
    ],
)
def test_figures_have_the_units_of_their_columns(figure: dict[str, object], unit: str) -> None:
    assert figure_unit(FigureTable.model_validate(figure), Units(NAMES, 2)) == unit
    assert figure_unit(FigureTable.model_validate(figure), Units(NAMES, 3)) == unit


def test_labels_of_a_study_have_them(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(f"""
[study]
name = "named"
scene = "{SCENES}/dry_bounce.toml"
[set]
scene.units = {{ length = "cm", time = "s", mass = "g" }}
[parameters]
body.0.density = [1.0, 2.0]
[error]
figure = {{ table = "bodies", column = "y", at = 0.004 }}
""")
    target = SceneSubject(load_study(path)).target
    assert target.axis_label("body.0.density") == "body.0.density [g/cm³]"
    assert target.figure_label == "y at 0.004 [cm]"
