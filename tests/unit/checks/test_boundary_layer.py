"""Cells across boundary layers: what the check and a run's summary say, and what "auto" makes of them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from falling import SCENES, falling_disk

import rigidfluid
from rigidfluid.checks import Finding, check
from rigidfluid.core.case.load import load_scene
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mechanics.boundary_layer import CELLS_WANTED, boundary_layers
from rigidfluid.core.mesh.generation.layer_cells import FEWEST_CELLS
from rigidfluid.core.run.remarks import layer_remarks
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import SceneError
from rigidfluid.post.reports.report import report

COARSE = {"size": 0.4, "size_body": 0.06}


def layers(scene: Scene) -> list[Finding]:
    return [one for one in check(scene).findings if one.question == "layer"]


def test_a_layer_is_a_diameter_over_the_root_of_its_reynolds_number() -> None:
    system = build_system(falling_disk(fluid={"viscosity": 0.01}))
    assert system.fluid is not None
    thickness = boundary_layers(system.bodies, np.array([4.0]), system.fluid.kinematic_viscosity)
    np.testing.assert_allclose(thickness, [0.25 / np.sqrt(0.25 * 4.0 / 0.01)])
    assert boundary_layers(system.bodies, np.array([0.0]), system.fluid.kinematic_viscosity)[0] == np.inf


def test_a_layer_has_the_viscosity_of_its_shear_rate() -> None:
    """So the check tells one Reynolds number."""
    law = {"type": "power_law", "viscosity": 0.1, "shear_rate": 1.0, "exponent": 0.5, "least_shear_rate": 0.01}
    thinning = falling_disk(fluid={"viscosity": None, "material": law})
    (layer,), (units,) = layers(thinning), [one for one in check(thinning).findings if one.question == "units"]
    assert layer.found["reynolds"] == pytest.approx(units.found["reynolds"])
    assert float(units.found["viscosity"] or 0.0) < 0.05


@pytest.mark.parametrize(
    ("viscosity", "size_body", "grade", "told"),
    [(0.1, 0.01, "note", False), (0.1, 0.05, "note", True), (0.01, 0.05, "warning", True)],
)
def test_the_check_counts_cells_across_the_layer(viscosity: float, size_body: float, grade: str, told: bool) -> None:
    fluid = {"viscosity": viscosity}
    (finding,) = layers(falling_disk(fluid=fluid, mesh={"size": 0.4, "size_body": size_body}))
    assert finding.grade == grade
    thickness = float(finding.found["thickness"] or 0.0)
    assert thickness == pytest.approx(0.25 / np.sqrt(float(finding.found["reynolds"] or 0.0)))
    assert bool(finding.enough) == told
    if told:
        enough = float(finding.enough["size_body"] or 0.0)
        (finer,) = layers(falling_disk(fluid=fluid, mesh={"size": 0.4, "size_body": 0.99 * enough}))
        assert finer.grade == "note"
        assert not finer.enough


def test_a_flow_past_a_fixed_body_has_a_layer_too() -> None:
    (finding,) = layers(load_scene(SCENES / "dfg_cylinder.toml"))
    assert finding.found["reynolds"] == pytest.approx(30.0)  # by the peak of the inflow, 1.5 times the mean


def test_the_impact_speed_of_a_scene_is_not_that_of_its_fall() -> None:
    slow, fast = (layers(falling_disk(contact={"impact_speed": speed}))[0] for speed in (0.1, 100.0))
    assert slow.found == fast.found


@pytest.mark.parametrize("scene", ["swimmer", "dry_bounce", "periodic_channel"])
def test_stokes_flow_dry_scenes_and_rest_have_none(scene: str) -> None:
    assert layers(load_scene(SCENES / f"{scene}.toml")) == []


def speeds_for(scene: Scene, cells: float) -> np.ndarray:
    """The speed at which so many mean edges of .9 size_body lie across the disk's layer."""
    assert scene.mesh is not None
    assert scene.fluid.viscosity is not None
    assert scene.fluid.density is not None
    return np.array([0.25 * scene.fluid.viscosity / scene.fluid.density / (0.9 * cells * scene.mesh.size_body) ** 2])


@pytest.mark.parametrize(
    ("cells", "grades"), [(1.01 * CELLS_WANTED, []), (1.2, ["note"]), (0.99 * FEWEST_CELLS, ["warning"])]
)
def test_a_run_is_judged_by_its_highest_speed(cells: float, grades: list[str]) -> None:
    scene = falling_disk()
    system = build_system(scene)
    assert scene.mesh is not None
    found = layer_remarks(system, speeds_for(scene, cells), scene.mesh.size_body)
    assert [remark.grade for remark in found] == grades
    assert all("mesh.size_body" in remark.remedy for remark in found)
    assert layer_remarks(system, speeds_for(scene, cells), None) == []


@pytest.mark.parametrize(("size_body", "grade"), [(0.015, "warning"), (0.0075, "note")])
def test_a_layer_beside_which_torques_jumped_is_a_warning(size_body: float, grade: str) -> None:
    """With a layer of .012 next to cells of .015 a light disk's torque jumped eightfold, with half the cell by 12 %."""
    scene = falling_disk()
    assert scene.fluid.viscosity is not None
    speed = np.array([0.25 * scene.fluid.viscosity / 0.012**2])  # the density is 1
    (remark,) = layer_remarks(build_system(scene), speed, size_body)
    assert remark.grade == grade
    assert "0.012" in remark.text


@pytest.mark.long
def test_a_run_tells_it_in_its_summary_and_report(tmp_path: Path) -> None:
    fluid = {"viscosity": 0.001}
    settings = {"time": {"end": 0.02, "step": 0.01}, "output": {"every": 0.02}}
    rigidfluid.run(falling_disk(body={"velocity": [0.0, -2.0]}, fluid=fluid, mesh=COARSE, **settings), tmp_path)
    (remark,) = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["remarks"]
    assert remark["grade"] == "warning"
    assert "boundary layer of 'disk'" in remark["text"]
    report(tmp_path)
    assert "Warning: the boundary layer" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["falling_disk", "drafting_kissing_tumbling", "falling_ellipsoid", "rebound"])
def test_auto_resolves_the_layer_and_the_body(name: str) -> None:
    scene = load_scene(SCENES / f"{name}.toml", ["mesh.size_body=auto"])
    assert scene.mesh is not None
    (finding,) = layers(scene)
    assert finding.grade == "note"
    assert not finding.enough
    system = build_system(scene)
    smallest = min(float(body.volume) for body in system.bodies)
    diameter = 2.0 * (smallest / np.pi) ** 0.5 if scene.dimension == 2 else 2.0 * (0.75 * smallest / np.pi) ** (1 / 3)
    limit = min(float(finding.found["thickness"] or 0.0) / 2.0, diameter / 10.0)
    assert scene.mesh.size_body == pytest.approx(limit, rel=0.01)
    assert scene.mesh.size_body <= limit * (1.0 + 1e-9)


def test_auto_is_finer_in_a_thinner_fluid_and_a_number_from_then_on() -> None:
    thick, thin = (falling_disk(fluid={"viscosity": mu}, mesh={"size_body": "auto"}) for mu in (0.1, 0.001))
    assert thick.mesh is not None
    assert thin.mesh is not None
    assert thin.mesh.size_body < 0.5 * thick.mesh.size_body
    assert rigidfluid.scene_from_dict(thin.to_dict()) == thin


def test_auto_is_no_coarser_than_the_mesh() -> None:
    scene = falling_disk(mesh={"size": 0.02, "size_body": "auto"})
    assert scene.mesh is not None
    assert scene.mesh.size_body == 0.02


def test_other_words_are_refused() -> None:
    with pytest.raises(SceneError, match=r"mesh\.size_body"):
        falling_disk(mesh={"size_body": "automatic"})
