"""Errors of forces by dual flows: beside what halved edges change, and none in a flow that the elements hold."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from facet_shapes import CUBE, TRIANGLES, binary_stl

from rigidfluid.api import FloatArray, Simulation, scene_from_dict
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.generation.refined_mesh import refined_mesh
from rigidfluid.core.model.flow_error import RefinedFlow
from rigidfluid.core.run.refinement_error import step_in_place
from rigidfluid.taylor_hood.stepping.force_errors import weighted_residuals


class Found(NamedTuple):
    """Weighted ``residuals`` (d+k, vertices), ``parts`` of cells, and the ``change`` (d+k,) of the wrench by halved
    edges."""

    residuals: FloatArray
    parts: FloatArray
    change: FloatArray


def found(dimension: int, **tables: Any) -> Found:
    """Errors after a step of a steady flow past a ball that is held."""
    inflow = [1.0] + [0.0] * (dimension - 1)
    scene = scene_from_dict({
        "scene": {"name": "held", "dimension": dimension},
        "fluid": {"density": 1.0, "viscosity": 0.05, "initial": "steady"},
        "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
        "boundary": [
            *({"on": side, "type": "velocity", "velocity": inflow} for side in ("left", "bottom", "top")),
            {"on": "right", "type": "pressure", "pressure": 0.0},
            *({"on": side, "type": "velocity", "velocity": inflow} for side in ("front", "back")),
        ][: 2 * dimension],
        "body": [{
            "name": "ball", "type": "sphere", "radius": 0.2, "density": 1.0, "position": [0.45, 0.55, 0.5][:dimension],
            "fixed": True,
        }],
        "mesh": {"size": 0.25, "size_body": 0.1, "order": 1},
        "time": {"end": 0.1, "step": 0.1},
        "output": {"every": 0.1},
    } | tables)  # fmt: skip
    simulation = Simulation(scene)
    state, system = simulation.step(), simulation.system
    finer = refined_mesh(state.mesh, fluid_domain_at(system, state.pose).placed_on(state.mesh))
    step, flow = step_in_place(system, state, simulation.time, 0.0), RefinedFlow(state.fluid, state.mesh, finer)
    assert isinstance(system.backend, ScikitFem)
    coarse = system.backend.numbering_of(state.mesh)
    residuals = weighted_residuals(system.backend.held_in_place(flow, step), state.fluid, coarse, state.mesh)
    still = np.zeros_like(state.mesh.geometry)
    wrench = system.backend.refinement(flow, step, None, lambda twist: still).wrench
    change = np.concatenate([wrench.force[0], wrench.torque[0] / 0.2])
    return Found(residuals, system.backend.force_errors(flow, step), change)


CREEPING = {"fluid": {"density": 1.0, "viscosity": 0.05, "model": "stokes", "initial": "steady"}}
BLUNT = [[-0.15, -0.1], [0.15, -0.1], [0.1, 0.15], [-0.1, 0.15]]
POLYGON = {"name": "blunt", "type": "polygon", "points": BLUNT, "density": 1.0, "position": [0.45, 0.5], "fixed": True}


def test_residuals_add_up_to_what_halved_edges_change_of_forces_and_torques_in_creeping_flow() -> None:
    """Leave edges straight, so that the tolerance of dual flows alone is left; arms are from the centre of mass."""
    seen = found(2, body=[POLYGON], **CREEPING)
    assert seen.residuals.sum(axis=1)[:2] == pytest.approx(-seen.change[:2], rel=1e-3)
    torque, turned = seen.change[2] * 0.2, -seen.residuals[2].sum()
    assert torque / turned == pytest.approx(0.19, abs=0.01)  # the bounding radius


@pytest.mark.parametrize("side", ["slip", "wall"])
def test_residuals_add_up_to_the_change_where_a_flux_is_held(side: str) -> None:
    """Take a disk on curved cells: between slip walls a given drop of pressure gives the force without any error."""
    seams: list[dict[str, Any]] = [{"on": "left", "type": "periodic", "flux": 1.0}, {"on": "right", "type": "periodic"}]
    walls = [{"on": name, "type": side} for name in ("bottom", "top")]
    seen = found(2, boundary=[*seams, *walls], mesh={"size": 0.25, "size_body": 0.1}, **CREEPING)
    assert abs(seen.change[0]) > 1e-4
    assert seen.residuals.sum(axis=1)[0] == pytest.approx(-seen.change[0], rel=0.1)
    assert np.linalg.norm(seen.change[:2]) < seen.parts.sum()


def test_parts_are_the_residuals_of_vertices_whose_sum_bounds_the_change() -> None:
    seen = found(2, body=[POLYGON], **CREEPING)
    assert (seen.parts > 0.0).all()
    assert seen.parts.sum() == pytest.approx(np.linalg.norm(seen.residuals, axis=0).sum(), rel=1e-12)
    assert np.linalg.norm(seen.change[:2]) < seen.parts.sum()


def test_residuals_add_up_to_the_change_in_three_dimensions(tmp_path: Path) -> None:
    """Test the force on a cube, whose edges stay straight."""
    cube = {"name": "cube", "type": "stl", "file": str(binary_stl(tmp_path / "cube.stl", 0.4 * CUBE, TRIANGLES))}
    held = {"density": 1.0, "position": [0.45, 0.55, 0.5], "fixed": True}
    seen = found(3, body=[cube | held], mesh={"size": 0.5, "size_body": 0.4, "order": 1}, **CREEPING)
    assert seen.residuals.sum(axis=1)[:3] == pytest.approx(-seen.change[:3], rel=1e-3)
    assert np.linalg.norm(seen.change[:3]) < seen.parts.sum()


def test_residuals_follow_the_change_with_convection() -> None:
    """Take a Reynolds number of 40, and cells that are fine enough for it."""
    seen = found(2, body=[POLYGON], mesh={"size": 0.1, "size_body": 0.03, "order": 1})
    assert seen.residuals.sum(axis=1)[0] == pytest.approx(-seen.change[0], rel=0.3)


def test_a_flow_that_the_elements_hold_has_no_part() -> None:
    """Fluid and walls move past the body as it does, so that nothing is sheared."""
    moving = {key: each for key, each in POLYGON.items() if key != "fixed"}
    seen = found(2, body=[moving | {"prescribed": {"velocity": [1.0, 0.0]}}], **CREEPING)
    assert seen.parts.sum() < 1e-7
