"""Fields of the fluid as grids of PyVista are what ParaView reads from the disk."""

from __future__ import annotations

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
