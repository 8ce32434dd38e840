"""Normals and fluxes of boundary facets, flat and curved, and the axes of nodes where faces meet."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import BoundaryCondition, NoSlip, PrescribedPressure, Slip
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.facet_integrals import area_vectors, into_fluid, normals_at_nodes
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.testing.fluid.boxes import box
from rigidfluid.testing.fluid.curved import CENTRE, RADIUS, ball_in_a_box


def on_the_ball(mesh: Mesh) -> FloatArray:
    """Nodes of the facets on the ball, (F, 3 | 6, d)."""
    numbering = Numbering.from_mesh(mesh)
    facets = into_fluid(mesh.facets[mesh.markers == 0], mesh.cells, mesh.points)
    return numbering.node_points(mesh.geometry)[numbering.facet_nodes(facets)]


@pytest.mark.parametrize("dimension", [2, 3])
def test_facets_of_a_ball_close_and_enclose_its_volume(dimension: int) -> None:
    """∮ n = 0 exactly, and ∮ (x - c)·n = d V with the error h⁴ of curved facets; n leads out of the ball."""
    volume = {2: np.pi, 3: 4.0 * np.pi / 3.0}[dimension] * RADIUS**dimension
    errors = []
    for layers in (2, 4):
        points = on_the_ball(ball_in_a_box(dimension, layers))
        vectors = area_vectors(points)
        np.testing.assert_allclose(vectors.sum(axis=(0, 1)), 0.0, atol=1e-14)
        errors.append(np.sum((points - CENTRE) * vectors) / (dimension * volume) - 1.0)
    assert abs(errors[1]) < 0.01
    assert np.log2(errors[0] / errors[1]) > 3.5


@pytest.mark.parametrize("dimension", [2, 3])
def test_normals_at_nodes_of_a_ball_lead_out_of_it(dimension: int) -> None:
    points = on_the_ball(ball_in_a_box(dimension, 4))
    out = (points - CENTRE) / np.linalg.norm(points - CENTRE, axis=2, keepdims=True)
    assert np.sum(out * normals_at_nodes(points), axis=2).min() > 0.98


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_flat_facet_has_the_weights_of_simpson_or_of_midpoints(dimension: int) -> None:
    corners = np.random.default_rng(0).normal(size=(1, dimension, dimension))
    pairs = [(0, 1)] if dimension == 2 else [(0, 1), (1, 2), (0, 2)]
    middles = np.stack([corners[:, [a, b]].mean(axis=1) for a, b in pairs], axis=1)
    vectors = area_vectors(np.concatenate([corners, middles], axis=1))[0]
    whole = vectors.sum(axis=0)
    shares = [1 / 6, 1 / 6, 2 / 3] if dimension == 2 else [0, 0, 0, 1 / 3, 1 / 3, 1 / 3]
    np.testing.assert_allclose(vectors, np.outer(shares, whole), atol=1e-14)
    edges = corners[0, 1:] - corners[0, :1]
    np.testing.assert_allclose(edges @ whole, 0.0, atol=1e-14)


def test_a_corner_of_slip_faces_holds_both_normals_and_an_open_corner_lets_fluid_through() -> None:
    """A square turned by 30°: slip below and at the right, pressure at the left, a wall above."""
    turn = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    mesh = box(2, 2)
    kinds = {"left": PrescribedPressure, "right": Slip, "bottom": Slip, "top": NoSlip}
    normals = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]) @ turn.T
    faces = [kind(i, name, normals[i]) for i, (name, kind) in enumerate(kinds.items())]
    turned = Mesh(mesh.points @ turn.T, mesh.cells, mesh.facets, mesh.markers)
    surfaces = Surfaces(Numbering.from_mesh(mesh), turned, faces, ())
    frames, at = surfaces.frames, {tuple(point): number for number, point in enumerate(mesh.points)}
    free = {place: int(surfaces.velocity_free[number].sum()) for place, number in at.items()}
    assert [free[place] for place in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 1.0))] == [0] * 4
    assert [free[place] for place in ((0.0, 0.0), (0.5, 0.0), (1.0, 0.5), (0.0, 0.5))] == [1] * 4
    assert free[0.5, 0.5] == 2
    for place, way in (((0.0, 0.0), turn[:, 0]), ((0.5, 0.0), turn[:, 0]), ((1.0, 0.5), turn[:, 1])):
        own = np.searchsorted(frames.nodes, at[place])
        axis = frames.axes[own][:, frames.free[own]][:, 0]
        assert abs(axis @ way) == pytest.approx(1.0, abs=1e-14)


def test_faces_across_axes_need_no_axes_of_their_own() -> None:
    mesh = box(2, 2)
    faces = [Slip(i, str(i), n) for i, n in enumerate(np.array([[1, 0], [-1, 0], [0, 1], [0, -1.0]]))]
    assert not len(Surfaces(Numbering.from_mesh(mesh), mesh, faces, ()).frames.nodes)


@pytest.mark.parametrize("dimension", [2, 3])
def test_no_free_velocity_takes_fluid_through_a_curved_slip_face(dimension: int) -> None:
    """Σ û ∫ φ n · (column of P) = 0 for each free unknown, also at vertices of curved triangles."""
    mesh = ball_in_a_box(dimension, 2)
    numbering, d = Numbering.from_mesh(mesh), dimension
    faces: list[BoundaryCondition] = [Slip(0, "ball", None)]
    faces += [PrescribedPressure(1 + i, str(i), np.eye(d)[i // 2] * (1 - 2 * (i % 2))) for i in range(2 * d)]
    surfaces = Surfaces(numbering, mesh, faces, ())
    free = np.flatnonzero(surfaces.velocity_free)
    rows, which, values = surfaces.frames.spread(free)
    flux = np.zeros((numbering.nodes, d))
    ball = surfaces.faces[0]
    np.add.at(flux, ball.facet_nodes, ball.area_vectors(numbering.node_points(mesh.geometry)))
    through = np.bincount(which, flux.ravel()[rows] * values, len(free))
    assert np.abs(through).max() < 1e-12 * np.linalg.norm(flux, axis=1).max()


@pytest.mark.parametrize("dimension", [2, 3])
def test_energy_that_a_quadratic_flow_carries_through_a_face_is_exact(dimension: int) -> None:
    """u = (1 + y², x, 0) through the faces x = 0 and x = 1 of the unit box."""
    mesh, d = box(dimension, 2), dimension
    faces = [PrescribedPressure(i, str(i), np.eye(d)[i // 2] * (1 - 2 * (i % 2))) for i in range(2 * d)]
    numbering = Numbering.from_mesh(mesh)
    surfaces = Surfaces(numbering, mesh, faces, ())
    points = numbering.node_points(mesh.geometry)
    velocity = np.zeros_like(points)
    velocity[:, 0], velocity[:, 1] = 1.0 + points[:, 1] ** 2, points[:, 0]
    passed = [face.energy_inflow(points, velocity, velocity) for face in surfaces.faces[:2]]
    cubic, plain = 1.0 + 3.0 / 3.0 + 3.0 / 5.0 + 1.0 / 7.0, 1.0 + 1.0 / 3.0
    np.testing.assert_allclose(passed, [0.5 * cubic, -0.5 * (cubic + plain)], rtol=1e-13)
