"""Drag in periodic arrays by the shipped scene, against published tables."""

import numpy as np
import pytest
from falling import SCENES
from published import CYLINDER_ARRAY, SPHERE_ARRAY

import rigidfluid

CELL = ["scene.dimension=3", "domain.lower=[0, 0, 0]", "domain.upper=[1, 1, 1]", "body.0.position=[0.5, 0.5, 0.5]"]


def force(*overrides):
    return rigidfluid.run(rigidfluid.load_scene(SCENES / "periodic_array.toml", overrides)).bodies["fx"][-1]


@pytest.mark.validation
def test_cylinders_in_a_square_array_take_the_published_force():
    assert force() == pytest.approx(CYLINDER_ARRAY[0.2], rel=1e-3)


@pytest.mark.validation
def test_spheres_in_a_cubic_array_take_the_published_force():
    radius = np.cbrt(0.75 * 0.125 / np.pi)
    found = force(*CELL, f"body.0.radius={radius}", "mesh.size=0.12", "mesh.size_body=0.06")
    assert found / (6.0 * np.pi * radius) == pytest.approx(SPHERE_ARRAY[0.125], rel=2e-3)
