"""Gravity and densities of different units are found; the fastest body's speed is told."""

from __future__ import annotations

import numpy as np
import pytest
from falling import falling_disk
from paths import SCENES

from rigidfluid import load_scene, scene_from_dict
from rigidfluid.checks import check
from rigidfluid.checks.finding import Finding


def told(density: float, gravity: float) -> Finding:
    fluid = {"density": density, "viscosity": 0.1 * density, "gravity": [0.0, -gravity]}
    findings = check(falling_disk(fluid=fluid, body={"density": 1.25 * density})).findings
    (finding,) = [one for one in findings if one.question == "units"]
    return finding


def test_metres_in_a_scene_of_centimetres_are_found_with_speed_and_reynolds_number() -> None:
    finding = told(1.0, 9.81)
    assert finding.grade == "warning"
    assert "gravity is the Earth's in m/s², and densities are as in g/cm³" in finding.text
    assert finding.remedy.startswith("Set gravity = [0, -981] in [fluid],")
    speed = finding.found["speed"]
    assert isinstance(speed, float)
    assert finding.found["reynolds"] == pytest.approx(0.25 * speed / 0.1)
    assert finding.found["diameters"] == pytest.approx(speed / 0.25)


@pytest.mark.parametrize(
    ("density", "gravity", "grade"),
    [
        (1.0, 981.0, "note"),
        (1.0, 9810.0, "warning"),
        (1000.0, 9.81, "note"),
        (1000.0, 981.0, "warning"),
        (1000.0, 9810.0, "warning"),
        (1.0, 10.0, "note"),
    ],
)
def test_mixed_systems_are_warned_of_and_one_is_not(density: float, gravity: float, grade: str) -> None:
    assert told(density, gravity).grade == grade


def test_a_scene_without_a_fluid_is_not_asked() -> None:
    assert [one for one in check(load_scene(SCENES / "dry_bounce.toml")).findings if one.question == "units"] == []


def test_gravity_in_space_keeps_its_direction() -> None:
    fluid = {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.1, "gravity": [0.0, 0.0, -9.81]}
    scene = load_scene(SCENES / "falling_sphere.toml", [f"fluid.gravity={fluid['gravity']}"])
    (finding,) = [one for one in check(scene).findings if one.question == "units"]
    assert finding.remedy.startswith("Set gravity = [0, 0, -981] in [fluid],")


def test_gravity_in_the_units_that_the_scene_names_is_not_doubted() -> None:
    units = ['scene.units={ length = "mm", time = "s", mass = "mg" }', "fluid.gravity=[0.0, -9810.0]"]
    (finding,) = [
        one for one in check(load_scene(SCENES / "falling_disk.toml", units)).findings if one.question == "units"
    ]
    assert finding.grade == "note"


def test_the_reynolds_number_is_that_of_the_viscosity_at_the_shear_rate_of_the_body() -> None:
    """And a fluid with a yield stress has a Bingham number, τ_y d/(μ v)."""
    material = {"type": "bingham", "viscosity": 0.1, "yield_stress": 4.0, "stress_growth": 0.01}
    given = falling_disk().to_dict()
    del given["fluid"]["viscosity"]
    scene = scene_from_dict(given | {"fluid": given["fluid"] | {"material": material}})
    (finding,) = [one for one in check(scene).findings if one.question == "units"]
    speed = finding.found["speed"]
    assert isinstance(speed, float)
    rate = speed / 0.25
    viscosity = 0.1 + 4.0 * (1.0 - np.exp(-0.01 * rate)) / rate
    assert finding.found["viscosity"] == pytest.approx(viscosity)
    assert finding.found["reynolds"] == pytest.approx(0.25 * speed / viscosity)
    assert finding.found["bingham"] == pytest.approx(4.0 * 0.25 / (0.1 * speed))
    assert "Bingham number" in finding.text
