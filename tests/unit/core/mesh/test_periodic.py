"""Scenes with periodic surfaces: meshes that match, bodies that go along, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from facet_shapes import CUBE, TRIANGLES, binary_stl
from mesh_tools import ball, upright
from models import with_backend

from rigidfluid.backends.dolfinx.backend import Dolfinx
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.system import build_system
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.inserter import Inserter
from rigidfluid.core.mesh.generation.periodic import with_exact_images
from rigidfluid.core.mesh.generation.refine_surface import long_edges
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run.run import run
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.errors import MeshError, SceneError

ENDS = [{"on": "left", "type": "periodic", "pressure_drop": 6.0}, {"on": "right", "type": "periodic"}]


def channel(boundary: list[dict[str, Any]] = ENDS, dimension: int = 2, **tables: Any) -> Scene:
    """A ball of the fluid's density in a channel of length 2."""
    d = dimension
    body = {"type": "sphere", "radius": 0.15, "density": 1.0, "position": [0.6, 0.6, 0.5][:d]}
    scene = {
        "scene": {"name": "periodic", "dimension": d},
        "domain": {"lower": [0.0] * d, "upper": [2.0, 1.0, 1.0][:d]},
        "fluid": {"density": 1.0, "viscosity": 0.5},
        "body": [body],
        "contact": {},
        "boundary": boundary,
        "mesh": {"size": 0.2, "size_body": 0.06} if d == 2 else {"size": 0.35, "size_body": 0.15},
        "time": {"end": 0.8, "step": 0.04},
        "output": {"every": 0.4},
    }
    return scene_from_dict(scene | tables)


def across(mesh: Mesh, surface: int, axis: int) -> FloatArray:
    """Vertices of a surface without their coordinate across it, in order."""
    vertices = np.delete(mesh.points[np.unique(mesh.facets[mesh.markers == surface])], axis, axis=1)
    return np.unique(vertices, axis=0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_facets_of_periodic_surfaces_match_in_all_meshes(dimension: int) -> None:
    d = dimension
    domain = Box(BoxOptions(lower=(0.0,) * d, upper=(2.0, 1.0, 1.0)[:d]), d)
    domain.periodic = ((0, 1),) if d == 2 else ((0, 1), (5, 4))
    body, sizes = ball(0.15, d), Sizes(0.3, 0.1) if d == 2 else Sizes(0.5, 0.25)
    poses = [upright([x, 0.6, 0.5][:d]) for x in (0.6, 0.8, 1.0)]
    mesh = initial_mesh(FluidDomain([body], poses[0], domain, []), sizes)
    for before, pose in pairwise(poses):
        mesh = replace(mesh, points=MeshMotion(mesh, FluidDomain([body], before, domain, ())).move(pose))
        mesh = remesh(mesh, FluidDomain([body], pose, domain, []), sizes)
        for pair in domain.periodic:
            one, two = (across(mesh, 1 + piece, pair[0] // 2) for piece in pair)
            assert len(one) > d
            np.testing.assert_array_equal(one, two)


def test_images_are_put_exactly_where_they_belong_and_lost_ones_are_told() -> None:
    domain = Box(BoxOptions(lower=(0.0, 0.0), upper=(2.0, 1.0)), 2)
    domain.periodic = ((0, 1),)
    mesh = initial_mesh(FluidDomain([ball(0.15)], upright([0.6, 0.6]), domain, []), Sizes(0.3, 0.1))
    right = np.unique(mesh.facets[mesh.markers == 2])
    points = mesh.points.copy()
    points[right, 1] += 1e-9 * np.sin(np.arange(len(right)))
    np.testing.assert_array_equal(with_exact_images(replace(mesh, points=points), 1, domain).points, mesh.points)
    points[right[0], 1] += 0.01
    with pytest.raises(MeshError, match=r"vertices on the periodic surfaces 'left' and 'right'"):
        with_exact_images(replace(mesh, points=points), 1, domain)


def test_facets_of_periodic_surfaces_are_not_halved() -> None:
    """Though they are longer than wanted by now, as those of the ball are."""
    domain = Box(BoxOptions(lower=(0.0, 0.0), upper=(2.0, 1.0)), 2)
    domain.periodic = ((0, 1),)
    around = FluidDomain([ball(0.15)], upright([0.3, 0.6]), domain, [])
    mesh = initial_mesh(around, Sizes(0.3, 0.1))
    edges, _, _ = long_edges(mesh, around, Sizes(0.02, 0.01), LONGEST)
    assert len(edges)
    assert set(edges.ravel()) <= set(mesh.facets[mesh.markers == 0].ravel())


@pytest.mark.long
def test_a_pressure_drop_takes_a_ball_along_and_the_energy_balance_closes() -> None:
    """Through several meshes; of the fluid's density it goes nearly with the flow."""
    mesh = {"size": 0.2, "size_body": 0.06, "remesh_every": 0.6}
    coarse, fine = (run(channel(mesh=mesh, time={"end": 1.8, "step": step})) for step in (0.04, 0.02))
    assert min(coarse.summary["remeshes"], fine.summary["remeshes"]) > 0
    left = [each.energy["residual"][-1] / each.energy["boundary"][-1] for each in (coarse, fine)]
    assert abs(left[1]) < 5e-4
    assert abs(left[1]) < 0.6 * abs(left[0])
    assert fine.bodies["x"][-1] == pytest.approx(coarse.bodies["x"][-1], abs=1e-3)


@pytest.mark.long
def test_in_a_box_that_is_periodic_all_around_a_drop_accelerates_all_alike() -> None:
    """dU/dt = G/ρ of fluid and ball, in 3D: nothing holds them. The mesh misses .1 % of the ball's volume."""
    around = [{"on": "all", "type": "periodic"}, {"on": "left", "type": "periodic", "pressure_drop": 2.0}]
    history = run(channel(around, 3, time={"end": 0.12, "step": 0.04}))
    np.testing.assert_allclose(history.bodies["vx"], history.bodies["time"], rtol=2e-3)
    assert abs(history.energy["residual"][-1]) < 1e-4 * history.energy["boundary"][-1]


def test_a_run_starts_with_the_steady_flow_that_the_drop_drives() -> None:
    """Poiseuille flow past a ball that is held: what the drop gives is dissipated from the start on."""
    held = {"type": "sphere", "radius": 0.15, "density": 1.0, "position": [0.6, 0.6], "fixed": True}
    fluid = {"density": 1.0, "viscosity": 0.5, "initial": "steady"}
    history = run(channel(body=[held], fluid=fluid, time={"end": 0.08, "step": 0.04}, output={"every": 0.08}))
    power, lost = (np.diff(history.energy[name]) for name in ("boundary", "dissipation"))
    np.testing.assert_allclose(power, lost, rtol=1e-6)
    assert power[-1] > 0.01


def test_a_run_across_a_periodic_surface_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    """The ball goes on to beyond the domain, and the mesh that is made then has its image."""
    body = {"type": "sphere", "radius": 0.15, "density": 1.0, "position": [1.82, 0.6]}
    tables = {"body": [body], "mesh": {"size": 0.2, "size_body": 0.06, "remesh_every": 0.2}, "output": {"every": 0.2}}
    history = run(channel(**tables), tmp_path / "whole")
    assert history.bodies["x"][-1] > 2.1
    state = read_checkpoint(tmp_path / "whole" / "state.h5").state
    assert state.mesh.periods is not None
    assert state.mesh.periods.winding.tolist() == [[1]]
    assert state.mesh.images_of(state.pose).position[0, 0] == pytest.approx(history.bodies["x"][-1] - 2.0, abs=1e-6)
    run(channel(**tables, time={"end": 0.6, "step": 0.04}), tmp_path / "parts")
    run(channel(**tables), tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


@pytest.mark.long
def test_two_balls_cross_periodic_surfaces_again_and_again() -> None:
    """The same path as from half a period further on, but for the error of other meshes; the energy balance closes."""
    mesh, time = {"size": 0.15, "size_body": 0.05}, {"end": 12.0, "step": 0.04}
    paths = []
    for start in ((0.3, 1.2), (1.3, 0.2)):
        places = [[start[0], 0.55], [start[1], 0.25]]
        balls = [{"type": "sphere", "radius": 0.12, "density": 1.0, "position": place} for place in places]
        history = run(channel(body=balls, mesh=mesh, time=time, output={"every": 12.0}))
        assert history.summary["remeshes"] > 5
        assert history.summary["failed_remeshes"] == 0
        assert abs(history.energy["residual"][-1]) < 1e-4 * history.energy["boundary"][-1]
        paths.append(np.reshape(history.bodies["x"], (-1, 2))[-1] - start)
    assert paths[0][0] > 8.0
    np.testing.assert_allclose(paths[0], paths[1], atol=0.01 * 2.0)


@pytest.mark.parametrize(
    ("boundary", "message"),
    [
        ([ENDS[0]], r"'left' is periodic and the surface opposite to it is not. Set type = 'periodic' on 'right' too"),
        ([ENDS[0], ENDS[1] | {"pressure_drop": 1.0}], r"boundary.0.pressure_drop: only one of 'left' and 'right'"),
        ([{"on": "top", "type": "slip", "pressure_drop": 1.0}], r"is valid only with type = 'periodic', not 'slip'"),
        (
            [ENDS[0] | {"velocity": [1.0, 0.0]}, ENDS[1]],
            r"0.velocity: velocity is valid only with type = 'wall' or 'velocity', not 'periodic'",
        ),
    ],
)
def test_what_periodic_surfaces_cannot_be_is_refused_by_name(boundary: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        channel(boundary)


def test_a_surface_without_an_opposite_one_is_refused() -> None:
    bumps = [{"on": "bottom_bump", "type": "periodic"}]
    with pytest.raises(SceneError, match=r"an equal one opposite can be periodic, and 'bottom_bump' has none"):
        channel(bumps, domain={"type": "stenosis", "length": 6.0, "width": 3.0, "radius": 0.8})


def test_a_backend_without_periodic_faces_refuses_them_by_name() -> None:
    scene = channel()
    with pytest.raises(SceneError, match=r"boundary.0.type: found 'periodic' with backend 'dolfinx'"):
        with_backend(model_of(scene), Dolfinx)


def test_a_mesh_that_is_filled_between_facets_has_no_periodic_surfaces() -> None:
    domain = Box(BoxOptions(lower=(0.0, 0.0), upper=(2.0, 1.0)), 2)
    domain.periodic = ((0, 1),)
    refused = r"mesh.inserter: found 'fill' with periodic surfaces; allowed is .cad.*Leave the key out"
    with pytest.raises(MeshError, match=refused):
        Inserter("fill").chosen([ball(0.15)], domain)
    assert Inserter().chosen([ball(0.15)], domain) == "cad"


@pytest.mark.parametrize("x", [0.1, 0.9])
def test_a_body_that_touches_a_periodic_surface_has_a_mesh(x: float) -> None:
    bodies = [
        {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [x, 0.5]},
        {"type": "ellipsoid", "semi_axes": [0.1, 0.05], "density": 1.0, "position": [0.6, 0.6], "angle": 0.3},
    ]
    cells = {"size": 0.15, "size_body": 0.05, "cells_per_gap": 1, "refinements": 1}
    domain = {"lower": [0.0, 0.0], "upper": [1.0, 1.0]}
    mesh = Simulation(channel(body=bodies, domain=domain, mesh=cells)).state.mesh
    assert cell_quality(mesh.points, mesh.cells).min() > 0.25
    assert np.ptp(mesh.points[:, 0]) > 1.0  # cut open elsewhere, not straight


@pytest.mark.parametrize("radius", [0.49, 0.498])
def test_a_body_near_its_own_images_has_a_mesh(radius: float) -> None:
    body = {"type": "sphere", "radius": radius, "density": 1.0, "position": [0.5, 0.5]}
    all_around, domain = [{"on": "all", "type": "periodic"}], {"lower": [0.0, 0.0], "upper": [1.0, 1.0]}
    mesh = {"size": 0.1, "size_body": 0.05}
    made = Simulation(channel(all_around, body=[body], domain=domain, mesh=mesh)).state.mesh
    assert cell_quality(made.points, made.cells).min() > 0.1


def test_a_body_of_facets_crosses_periodic_surfaces_as_from_half_a_period_further() -> None:
    corners = [[-0.15, -0.1], [0.15, -0.1], [0.15, 0.1], [-0.15, 0.1]]
    rest = {"type": "polygon", "points": corners, "density": 1.0, "angle": 0.3}
    finer, paths = {"size": 0.15, "size_body": 0.04}, []
    for x in (0.6, 1.6):
        placed = rest | {"position": [x, 0.55]}
        run = Simulation(channel(body=[placed], time={"end": 2.0, "step": 0.04}, mesh=finer))
        run.go()
        bodies = run.history.bodies
        paths.append(np.stack([bodies["x"] - x, bodies["y"], bodies["angle"]]))
    assert paths[0][0, -1] > 1.0
    np.testing.assert_allclose(paths[0], paths[1], atol=2e-3)


def test_a_cube_that_touches_a_periodic_surface_has_a_mesh(tmp_path: Path) -> None:
    file = binary_stl(tmp_path / "cube.stl", 0.3 * CUBE, TRIANGLES)
    cube = {"type": "stl", "file": str(file), "density": 1.0, "position": [0.15, 0.5, 0.5]}
    mesh = Simulation(channel(dimension=3, body=[cube])).state.mesh
    on_cube = mesh.points[np.unique(mesh.facets[mesh.markers == 0])]
    np.testing.assert_allclose(np.ptp(on_cube, axis=0), 0.3)
    assert cell_quality(mesh.points, mesh.cells).min() > 0.1


def test_no_periodic_surface_repels() -> None:
    assert [wall.name for wall in build_system(channel()).walls] == ["bottom", "top"]
