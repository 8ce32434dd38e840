"""Polygons that fall onto the floor of a box of fluid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from facet_shapes import CUBE, L_SHAPE, SQUARE, TRIANGLES, binary_stl
from scenes import wet_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

FALLING = {
    "square": (0.3 * np.array(SQUARE), 0.2, [0.5, 0.3]),
    "L": (0.25 * np.array(L_SHAPE), 0.3, [0.5, 0.27]),
}


@pytest.mark.parametrize("shape", FALLING)
def test_a_polygon_falls_onto_the_floor(shape: str) -> None:
    """It touches the floor, no corner of it is lost in new meshes, and the energies add up."""
    points, angle, position = FALLING[shape]
    body = {"type": "polygon", "points": points.tolist(), "angle": angle, "position": position, "density": 2.0}
    tables: dict[str, Any] = wet_tables(
        body,
        scene={"name": shape},
        fluid={"viscosity": 0.005, "gravity": [0.0, -4.0]},
        mesh={"size": 0.15, "size_body": 0.06},
        contact={"law": "contact", "range": 0.03, "epsilon": "auto"},
    )
    simulation = Simulation(scene_from_dict(tables), None, False)
    assert simulation.system.detector.name == "facets"
    smallest = np.inf
    while not simulation.ended:
        smallest = min(smallest, float(simulation.step().gaps[0]))
    state, volume = simulation.state, simulation.system.bodies[0].volume
    assert 0.0 < smallest < 0.03
    assert simulation.counts.remeshes > 0
    assert simulation.counts.failed_remeshes == 0
    assert state.mesh is not None
    assert state.mesh.curved is None
    assert cell_volumes(state.mesh.points, state.mesh.cells).sum() == pytest.approx(1.0 - volume, rel=1e-10)
    assert abs(state.ledger.residual) < 0.01 * state.ledger.gravity


def test_a_cube_from_a_file_sinks(tmp_path: Path) -> None:
    """Its facets stay as they are, so that the mesh has the exact volume."""
    file = binary_stl(tmp_path / "cube.stl", CUBE, TRIANGLES)
    body = {"type": "stl", "file": str(file), "scale": 0.3, "density": 2.0, "orientation": [0.97, 0.1, 0.2, 0.05]}
    tables: dict[str, Any] = wet_tables(
        body | {"position": [0.5, 0.5, 0.4]},
        end=0.1,
        step=0.02,
        fluid={"viscosity": 0.02, "gravity": [0.0, 0.0, -4.0]},
        mesh={"size": 0.4, "size_body": 0.3},
        contact={"law": "contact", "range": 0.05, "epsilon": "auto"},
    )
    simulation = Simulation(scene_from_dict(tables), None, False)
    simulation.go()
    state = simulation.state
    assert state.pose.position[0, 2] < 0.4
    assert state.mesh is not None
    volume = simulation.system.bodies[0].volume
    assert cell_volumes(state.mesh.points, state.mesh.cells).sum() == pytest.approx(1.0 - volume, rel=1e-10)
    assert abs(state.ledger.residual) < 0.02 * state.ledger.gravity
