"""The first mesh, filled between the facets of domain and bodies."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from dish import dish, rim
from mesh_tools import ball, box, ellipsoid, nobody, upright
from wedge import wedge

from rigidfluid.core.geometry.facets import Facets, enclosed_volume
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation import fill
from rigidfluid.core.mesh.generation.fill import fill_mesh
from rigidfluid.core.mesh.generation.inserter import Inserter
from rigidfluid.core.mesh.generation.surface_checks import refuse_unfillable
from rigidfluid.core.mesh.generation.surface_mesh import surface_mesh
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.errors import MeshError

FILL = Inserter("fill")
COARSE = {2: Sizes(0.25, 0.05), 3: Sizes(0.4, 0.12, 0.4)}


def in_a_dish(dimension):
    """Two bodies in a round container, one of them near its rim, and all that a mesh asks for."""
    tilted = ellipsoid(0.25, 0.1) if dimension == 2 else ellipsoid(0.25, 0.15, 0.15)
    pose = upright(*np.array([[0.5, 0.4, 0.1], [-0.4, -0.2, 0.0]])[:, :dimension])
    bodies, walls = [ball(0.2, dimension), tilted], [rim(2, dimension=dimension)]
    return FluidDomain(bodies, pose, dish(1.0, dimension), walls), COARSE[dimension]


def square(half=0.2):
    """A body whose facets are the sides of a square, the last point on a side."""
    body = ball(half)
    corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    sides = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    body.__class__ = type("Square", (type(body),), {"facets": Facets(corners, sides, np.zeros(4, dtype=np.int64))})
    return body


def facet_set(mesh, markers):
    """The facets of some surfaces by their corners' coordinates, whatever their numbers."""
    chosen = mesh.points[mesh.facets[np.isin(mesh.markers, markers)]]
    return {tuple(sorted(map(tuple, corners.tolist()))) for corners in chosen}


@pytest.mark.parametrize("dimension", [2, 3])
def test_all_facets_stay_and_lie_on_the_shapes(dimension):
    around, sizes = in_a_dish(dimension)
    bodies, pose, domain = around.bodies, around.pose, around.domain
    surface, mesh = surface_mesh(around, sizes), fill_mesh(around, sizes)
    assert facet_set(mesh, [0, 1, 2]) == facet_set(surface, [0, 1, 2])
    check_mesh(mesh, quality=0.1)
    for i, body in enumerate(bodies):
        on_body = mesh.points[np.unique(mesh.facets[mesh.markers == i])]
        assert np.abs(distance_to_body(pose, i, body, on_body)).max() < 1e-14
    on_rim = mesh.points[np.unique(mesh.facets[mesh.markers == 2])]
    assert np.abs(np.linalg.norm(on_rim, axis=1) - 1.0).max() < 1e-14
    expected = domain.volume - sum(body.volume for body in bodies)
    assert np.sum(cell_volumes(mesh.points, mesh.cells)) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("dimension", [2, 3])
def test_grading_keeps_the_facets(dimension):
    around, sizes = in_a_dish(dimension)
    mesh = initial_mesh(around, sizes, FILL)
    assert facet_set(mesh, [0, 1, 2]) >= facet_set(surface_mesh(around, sizes), [0, 1, 2])
    assert cell_quality(mesh.points, mesh.cells).min() > 0.3


def test_walls_are_halved_near_bodies_and_nowhere_else():
    surface = surface_mesh(FluidDomain([ball(0.2)], upright([0.72, 0.0]), dish(), [rim(1)]), COARSE[2])
    corners = surface.points[surface.facets[surface.markers == 1]]
    length = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    assert length[corners.mean(axis=1)[:, 0] > 0.97].max() < 0.1
    assert length[corners.mean(axis=1)[:, 0] < 0.0].min() > 0.15


def test_corners_of_a_body_of_facets_stay_and_long_sides_are_halved():
    pose = replace(upright([0.3, 0.1]), orientation=np.array([[0.4]]))
    mesh = initial_mesh(FluidDomain([square()], pose, dish(), [rim(1)]), COARSE[2])
    on_body = np.unique(mesh.facets[mesh.markers == 0])
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    corners = square().facets.points @ turn.T + [0.3, 0.1]
    nearest = np.linalg.norm(mesh.points[on_body][:, None] - corners, axis=2).min(axis=0)
    assert nearest.max() < 1e-15
    assert len(on_body) > 20


def test_a_flat_wall_is_filled_too():
    mesh = initial_mesh(FluidDomain([ball(0.1)], upright([0.6, 0.3]), wedge(), []), Sizes(0.3, 0.04), FILL)
    assert np.unique(mesh.markers).tolist() == [0, 1, 2, 3]
    assert cell_quality(mesh.points, mesh.cells).min() > 0.3


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_lengths_may_be_in_any_unit(scale):
    sizes = Sizes(0.3 * scale, 0.06 * scale)
    around = FluidDomain([ball(0.2 * scale)], upright([0.5 * scale, 0.4 * scale]), dish(scale), [rim(1, scale)])
    cells = len(fill_mesh(around, sizes).cells)
    assert cells == pytest.approx(
        len(fill_mesh(FluidDomain([ball(0.2)], upright([0.5, 0.4]), dish(), [rim(1)]), Sizes(0.3, 0.06)).cells), rel=0.1
    )


def test_by_default_shapes_decide():
    smooth, edged = [ball(0.2)], [square()]
    assert Inserter().chosen(smooth, dish()) == "cad"
    assert Inserter().chosen(edged, dish()) == "fill"
    assert FILL.chosen(smooth, dish()) == "fill"


def test_a_shape_without_cad_is_refused_by_name_where_cad_is_asked_for():
    with pytest.raises(MeshError, match=r"mesh.inserter: found .cad. with body.0 made of facets; .* 'fill'"):
        initial_mesh(FluidDomain([square()], upright([0.0, 0.0]), dish(), [rim(1)]), COARSE[2], Inserter("cad"))


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        ([[0.0, 0.0], [0.3, 0.0]], r"body.0: found facets that cross body.1 near \(0.1"),
        ([[0.85, 0.0], [0.0, 0.0]], r"body.0: found facets that cross domain surface 'rim' near \(0.9"),
        ([[0.0, 0.0], [1.4, 0.0]], r"body.1.position: found a vertex outside, at \(1.[2-6]"),
        ([[0.0, 0.0], [0.0, 0.0]], r"body.[01].position: found a vertex inside body.[01]"),
    ],
    ids=["each other", "the wall", "outside", "one in the other"],
)
def test_what_cannot_be_filled_is_refused_with_its_place(monkeypatch, positions, message):
    monkeypatch.setattr(fill, "filled", None)  # the mesher is not called
    bodies = [ball(0.2), ball(0.1 if positions[0] == positions[1] else 0.2)]
    with pytest.raises(MeshError, match=message):
        fill_mesh(FluidDomain(bodies, upright(*positions), dish(), [rim(2)]), COARSE[2])


@pytest.mark.parametrize("dimension", [2, 3])
def test_an_open_surface_is_refused_with_its_place(dimension):
    around, sizes = in_a_dish(dimension)
    whole = surface_mesh(around, sizes)
    left = np.arange(len(whole.facets)) != np.flatnonzero(whole.markers == 1)[0]
    leaking = replace(whole, facets=whole.facets[left], markers=whole.markers[left])
    with pytest.raises(MeshError, match=r"body.1: found a surface that is open.* at \(-0"):
        refuse_unfillable(leaking, around)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_surface_turned_inside_out_is_refused(dimension):
    around, sizes = in_a_dish(dimension)
    whole = surface_mesh(around, sizes)
    for marker, message in ((0, "body.0: found facets that enclose"), (2, "domain: found facets around a fluid")):
        facets = whole.facets.copy()
        facets[whole.markers == marker] = facets[whole.markers == marker][:, ::-1]
        with pytest.raises(MeshError, match=message):
            refuse_unfillable(replace(whole, facets=facets), around)


def test_one_facet_turned_over_is_refused():
    around, sizes = in_a_dish(3)
    whole = surface_mesh(around, sizes)
    facets = whole.facets.copy()
    facets[0] = facets[0, ::-1]
    with pytest.raises(MeshError, match="open, folded or turned over"):
        refuse_unfillable(replace(whole, facets=facets), around)


def test_a_mesher_without_end_is_stopped(monkeypatch):
    monkeypatch.setattr(fill, "MESHER", [sys.executable, "-c", "while True: print('more elements')"])
    with pytest.raises(MeshError, match=r"found a mesher that had not ended; allowed is an end within 0.5 seconds"):
        fill_mesh(*in_a_dish(2), timeout=0.5)


def test_files_of_the_working_folder_are_no_modules_of_the_mesher(monkeypatch, tmp_path):
    (tmp_path / "numpy.py").write_text("raise SystemExit(9)", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert len(fill_mesh(*in_a_dish(2)).cells) > 0


def test_a_mesher_that_breaks_off_is_told(monkeypatch):
    monkeypatch.setattr(fill, "MESHER", [sys.executable, "-c", "import os; os.abort()"])
    with pytest.raises(MeshError, match=r"Netgen failed \(its process ended with code -6\)"):
        fill_mesh(*in_a_dish(2))


def test_cells_that_leave_a_body_out_are_refused(monkeypatch):
    """Netgen has returned such a mesh without a word."""
    around, sizes = in_a_dish(2)
    alone = fill_mesh(replace(around, bodies=[], pose=nobody(2)), sizes)
    monkeypatch.setattr(fill, "filled", lambda *_: (alone.points, alone.cells))
    with pytest.raises(MeshError, match="a vertex lost by Netgen"):
        fill_mesh(around, sizes)


def test_enclosed_is_the_volume():
    surface = surface_mesh(FluidDomain([], nobody(3), box([0, 0, 0], [1, 2, 3]), []), COARSE[3])
    assert enclosed_volume(surface.points, surface.facets) == pytest.approx(-6.0, rel=1e-13)
