"""Fields of the fluid as grids of PyVista are what ParaView reads from the disk."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes import wet_tables

from rigidfluid.api import Simulation, scene_from_dict

BALL = {"name": "ball", "type": "sphere", "radius": 0.2, "density": 2.0}


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_grid_is_the_one_on_disk(dimension: int, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    body = BALL | {"position": [0.5] * dimension, "velocity": [0.3, -0.5, 0.2][:dimension]}
    tables = wet_tables(body, end=0.01, mesh={"size": 0.4, "size_body": 0.2})
    simulation = Simulation(scene_from_dict(tables), tmp_path)
    simulation.go()
    simulation.close()
    grid, read = simulation.fields().grid(), pyvista.read(tmp_path / "fields" / "000001.vtu")
    np.testing.assert_array_equal(grid.points, read.points)
    np.testing.assert_array_equal(grid.celltypes, read.celltypes)
    np.testing.assert_array_equal(grid.cell_connectivity, read.cell_connectivity)
    assert set(grid.point_data) == set(read.point_data) == {"velocity", "pressure", "vorticity"}
    for name in read.point_data:
        assert grid.point_data[name].shape == read.point_data[name].shape
        np.testing.assert_allclose(grid.point_data[name], read.point_data[name], rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_vorticity_of_a_rotation_is_twice_its_rate(dimension: int) -> None:
    tables = wet_tables(BALL | {"position": [0.5] * dimension}, end=0.01, mesh={"size": 0.4, "size_body": 0.2})
    simulation = Simulation(scene_from_dict(tables))
    fields = simulation.fields()
    x, y = fields.points[:, 0], fields.points[:, 1]
    turning = np.stack([-1.5 * y, 1.5 * x, *([0.0 * x] * (dimension - 2))], axis=1)
    vorticity = replace(fields, velocity=turning).vorticity
    assert vorticity.shape == (len(x), 3)[: dimension - 1]
    np.testing.assert_allclose(vorticity if dimension == 2 else vorticity[:, 2], 3.0, atol=1e-9)
