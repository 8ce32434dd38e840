"""Drag on a disk in a Bingham fluid, and on a sphere in a Carreau fluid, against published and independent drags."""

import numpy as np
import pytest
from pages.drag_in_materials import bingham, carreau, moved, plane_mesh, stokes
from published import cylinder_in_bingham_fluid
from sphere_in_material import drag_on_sphere


@pytest.mark.validation
def test_a_disk_in_a_bingham_fluid_has_the_published_drag():
    _, drag = moved(stokes(2, bingham(10.0, 100.0), plane_mesh(0.12), 10.0))
    assert drag == pytest.approx(cylinder_in_bingham_fluid(10.0), rel=0.012)


@pytest.mark.validation
def test_a_sphere_in_a_carreau_fluid_has_the_drag_of_least_work():
    run, drag = moved(stokes(3, carreau(0.5, 10.0), {"size": 60.0, "size_body": 0.25, "growth": 0.5}, 200.0))
    least = drag_on_sphere(run.system.fluid.material.viscosity)
    assert drag / (3.0 * np.pi) == pytest.approx(least, rel=0.03)
