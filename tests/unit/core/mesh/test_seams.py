"""Periodic meshes cut open anywhere: where the seam runs, how it moves, and flows that are carried over."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from mesh_tools import ball
from scenes import wet_tables
from scipy.sparse import csc_array

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.backends.scikit_fem.backend import ScikitFem
from rigidfluid.core.fluid.conditions import Periodic, Value
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mesh.adaptation.chosen_cut import cut_around, is_badly_cut
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh, is_same_when_slid
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion, factorised
from rigidfluid.core.mesh.adaptation.recut import neighbours, recut
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.adaptation.smooth_cut import smooth_cut
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.curved_edges import with_curved_edges
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.generation.periodic import Seams, on_periodic_surfaces
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.core.model.extension import Extension
from rigidfluid.core.model.types import Mesh, Periods, Pose, Twist
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.testing.fluid.boxes import box
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Flow

RADIUS, SIZES = 0.15, Sizes(0.3, 0.06)


def around(*centres: Sequence[float], pairs: tuple[tuple[int, int], ...] = ((0, 1),)) -> FluidDomain:
    """Balls in a box of 2 by 1 by 1, periodic between some sides."""
    d = len(centres[0])
    domain = Box(BoxOptions(lower=(0.0,) * d, upper=(2.0, 1.0, 1.0)[:d]), d).with_periodic(pairs)
    pose = Pose(np.array(centres), np.tile(np.eye(1, 4) if d == 3 else np.zeros((1, 1)), (len(centres), 1)))
    return FluidDomain([ball(RADIUS, d)] * len(centres), pose, domain, ())


def seams_of(box_axes: Sequence[int], dimension: int) -> Seams:
    axes = np.array(box_axes)
    return Seams(2 * axes, 2 * axes + 1, np.eye(dimension)[axes])


def wavy(mesh: Mesh, seams: Seams) -> IntArray:
    """Shifts along two directions with a seam off the faces of the unit box."""
    centres = mesh.points[mesh.cells].mean(axis=1)
    border = 0.3 + 0.2 * np.sin(2.0 * np.pi * centres[:, [1, 0]])
    shift = (centres[:, :2] < border).astype(np.int64)
    none = np.zeros(len(mesh.cells), dtype=bool)
    return smooth_cut(shift, neighbours(mesh, seams), none, none)


def periodic(posed: FluidProblem, drops: Mapping[int, float]) -> FluidProblem:
    """The problem in a box, periodic along some axes with a drop of pressure."""
    conditions = list(posed.conditions)
    for axis, drop in drops.items():
        first, second = conditions[2 * axis : 2 * axis + 2]
        jump: Value = lambda _, at, drop=drop: np.full(len(at), drop)  # noqa: E731
        conditions[2 * axis] = Periodic(first.surface, first.name, first.normal, second.surface, jump)
        conditions[2 * axis + 1] = Periodic(second.surface, second.name, second.normal)
    return replace(posed, conditions=tuple(conditions))


def assert_whole(mesh: Mesh, fluid_domain: FluidDomain) -> None:
    """Each body's surface is on the mesh in one piece, and no vertex of it is on the seam."""
    placed = fluid_domain.placed_on(mesh)
    seam = mesh.facets[np.isin(mesh.markers, Seams.from_domain(len(placed.bodies), placed.domain).surfaces)]
    for i, centre in enumerate(placed.pose.position):
        vertices = np.unique(mesh.facets[mesh.markers == i])
        np.testing.assert_allclose(np.linalg.norm(mesh.points[vertices] - centre, axis=1), RADIUS, rtol=1e-9)
        assert not np.isin(vertices, seam).any()


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_mesh_cut_open_elsewhere_is_the_same_mesh_of_the_torus(dimension: int) -> None:
    mesh, seams = box(dimension, 6 if dimension == 2 else 4), seams_of((0, 1), dimension)
    shift = wavy(mesh, seams)
    other = recut(mesh, seams, shift)
    check_mesh(other, 0.0)
    displaced = mesh.points[mesh.cells] + (shift @ seams.ways)[:, None]
    np.testing.assert_allclose(other.points[other.cells], displaced, atol=1e-12)
    for first, second, way in zip(seams.first, seams.second, seams.ways, strict=True):
        one, two = (np.unique(other.facets[other.markers == surface]) for surface in (first, second))
        assert np.ptp(other.points[one] @ way) > 0.1
        images, found = (
            np.array(sorted(np.round(at, 9).tolist())) for at in (other.points[one] + way, other.points[two])
        )
        np.testing.assert_allclose(images, found)
    back = recut(other, seams, -shift)
    check_mesh(back, 0.0)
    np.testing.assert_allclose(back.points[back.cells], mesh.points[mesh.cells], atol=1e-12)
    assert len(back.points) == len(mesh.points)
    np.testing.assert_array_equal(np.bincount(back.markers), np.bincount(mesh.markers))


@pytest.mark.parametrize(
    ("centres", "pairs"),
    [
        ([[0.05, 0.6]], ((0, 1),)),
        ([[4.05, 0.95], [1.0, 0.05], [1.2, 0.5]], ((0, 1), (2, 3))),
        ([[0.05, 0.95], [1.75, 0.05], [0.3, 0.2]], ((1, 0), (2, 3))),
    ],
)
def test_bodies_that_lie_across_seams_are_whole_in_the_first_mesh(
    centres: list[list[float]], pairs: tuple[tuple[int, int], ...]
) -> None:
    fluid_domain = around(*centres, pairs=pairs)
    mesh = initial_mesh(fluid_domain, SIZES)
    assert_whole(mesh, fluid_domain)
    volume = cell_volumes(mesh.points, mesh.cells).sum()
    assert volume == pytest.approx(2.0 - len(centres) * np.pi * RADIUS**2, rel=3e-3)
    assert cell_quality(mesh.points, mesh.cells).min() > 0.3
    curved = with_curved_edges(mesh, fluid_domain.placed_on(mesh)).curved
    assert curved is not None
    assert set(curved.surface) <= set(range(len(centres)))


@pytest.mark.parametrize("beyond", [1e-6, 1e-5, 1e-4, 3e-4])
@pytest.mark.parametrize(("pairs", "ahead"), [(((0, 1), (2, 3)), (0.0, 1.0)), (((0, 1),), (1.0, 0.0))])
def test_a_body_whose_tip_is_close_to_a_seam_has_a_mesh(
    pairs: tuple[tuple[int, int], ...], ahead: tuple[float, float], beyond: float
) -> None:
    """The mesher fails, since its seam cuts off tiny arcs there; slid along the periods it does not."""
    centre = np.array([1.97, 0.5]) * (1.0 - np.array(ahead)) + beyond * np.array(ahead)
    fluid_domain = around(centre.tolist(), pairs=pairs)
    assert_whole(initial_mesh(fluid_domain, SIZES), fluid_domain)


def test_a_ball_across_seams_in_3d_is_whole() -> None:
    fluid_domain = around([0.05, 0.6, 0.95], pairs=((0, 1), (4, 5)))
    assert_whole(initial_mesh(fluid_domain, Sizes(0.4, 0.12)), fluid_domain)


def test_bodies_near_each_other_have_no_seam_between_them() -> None:
    """The second one is displaced by a period; where they are all along a period, a seam is made by finer cells."""
    mesh = initial_mesh(around([1.95, 0.5], [0.3, 0.5]), SIZES)
    assert mesh.periods is not None
    assert np.ptp(mesh.periods.winding) == 1
    row = around(*([x, 0.5] for x in np.arange(0.0, 2.0, 1.0 / 3.0)))
    for sizes in (SIZES, Sizes(0.3, 0.15)):
        assert_whole(initial_mesh(row, sizes), row)


def test_seams_in_two_directions_find_room_between_many_bodies() -> None:
    """Cells at two bodies are neighbours there and want to be apart in both directions: finer ones come between."""
    places = [[0.65, 0.99], [1.74, 0.39], [0.88, 0.37], [0.21, 0.48], [1.21, 0.65], [0.03, 0.18], [1.21, 0.22]]
    bodies = around(*places, [1.91, 0.72], [0.37, 0.82], [1.52, 0.07], pairs=((0, 1), (2, 3)))
    mesh = initial_mesh(bodies, Sizes(0.3, 0.12))
    assert_whole(mesh, bodies)
    assert cell_quality(mesh.points, mesh.cells).min() > 0.3


def test_seams_in_two_directions_find_room_off_narrow_gaps() -> None:
    """No body lies across a seam. Where finer cells are needed to keep the seams out of narrow gaps, they are made."""
    places = [[1.02, 0.81], [0.4, 0.81], [0.68, 0.45], [1.55, 0.44], [1.08, 0.17], [1.78, 0.66], [0.22, 0.52]]
    bodies, sizes = around(*places, [1.31, 0.7], pairs=((0, 1), (2, 3))), Sizes(0.3, 0.12)
    mesh = initial_mesh(bodies, sizes)
    seam = mesh.facets[on_periodic_surfaces(mesh, 8, bodies.domain)]
    assert bodies.placed_on(mesh).gap_widths(mesh.points[seam].mean(axis=1)).min() > RADIUS


def test_a_seam_that_is_bad_next_to_a_body_is_given_up() -> None:
    """Its edges are too long for what they face there; elsewhere they may have any length."""
    far, near = around([1.0, 0.5]), around([1.83, 0.5])
    assert not is_badly_cut(generate_mesh(far, SIZES), far, SIZES)
    mesh = generate_mesh(near, SIZES)
    assert is_badly_cut(mesh, near, SIZES)
    cut = cut_around(mesh, near, np.zeros((1, 1), dtype=np.int64), 0.0)
    assert_whole(cut, near)
    assert not is_badly_cut(remesh(cut, near, SIZES), near, SIZES)


@pytest.mark.parametrize("y", [0.2, 0.4, 0.6, 0.8])
def test_a_bad_cell_has_no_facet_on_the_seam(y: float) -> None:
    """Re-meshing could not change such a facet, and a flat cell between two of them would stay."""
    bodies = around([1.83, 0.5])
    mesh = generate_mesh(bodies, SIZES)
    flat = int(np.argmin(np.linalg.norm(mesh.points[mesh.cells].mean(axis=1) - (0.83, y), axis=1)))
    apex, *base = mesh.cells[flat]
    points = mesh.points.copy()
    points[apex] = 0.05 * points[apex] + 0.95 * points[base].mean(axis=0)
    cut = cut_around(replace(mesh, points=points), bodies, np.zeros((1, 1), dtype=np.int64), 0.0)
    seam = cut.facets[on_periodic_surfaces(cut, 1, bodies.domain)]
    assert abs(cut.points[seam] - (0.83, y)).sum(axis=2).min() < 0.5
    assert np.isin(seam, cut.cells[flat]).all(axis=1).sum() == 0


def test_obstacles_on_the_other_side_of_the_seam_have_their_shape_and_size_there() -> None:
    post = {"name": "post", "type": "sphere", "radius": 0.1, "position": [0.2, 0.25]}
    domain = {"type": "channel", "lower": [0.0, 0.0], "upper": [2.0, 1.0], "obstacle": [post]}
    sides = [{"on": side, "type": "periodic"} for side in ("left", "right")]
    body = {"type": "sphere", "radius": 0.1, "density": 20.0, "position": [1.88, 0.3]}
    sizes = {"size": 0.15, "size_body": 0.05, "order": 2}
    given = wet_tables(body, domain=domain, boundary=sides, mesh=sizes, fluid={"viscosity": 0.05}, end=0.1, step=0.01)
    simulation = Simulation(scene_from_dict(given))
    assert not is_same_when_slid(simulation.system.domain)
    mesh = simulation.state.mesh
    bent = mesh.curved.surface == mesh.markers.max()
    centre = np.array([2.2, 0.25])  # the mesh is cut open left of the body
    radii = np.linalg.norm(mesh.curved.middles[bent] - centre, axis=1)
    np.testing.assert_allclose(radii, 0.1, rtol=1e-12)
    assert bent.sum() == (mesh.markers == mesh.markers.max()).sum() > 20


def test_a_seam_moves_with_the_mesh_and_images_alike() -> None:
    here = around([0.05, 0.95], pairs=((0, 1), (2, 3)))
    mesh = initial_mesh(here, SIZES)
    there = replace(here.pose, position=here.pose.position + [[5.0, 3.0]])
    moved = MeshMotion(mesh, here).move(there)
    np.testing.assert_allclose(moved, mesh.points + [5.0, 3.0], rtol=1e-12)


def test_a_mesh_that_nothing_holds_is_held_at_one_vertex() -> None:
    """Else the map would be known but for a displacement."""
    free, held = box(2, 4), []
    domain = Box(BoxOptions(lower=(0.0, 0.0), upper=(1.0, 1.0)), 2).with_periodic(((0, 1), (2, 3)))
    nobody = FluidDomain([], Pose(np.zeros((0, 2)), np.zeros((0, 1))), domain, ())

    def extension(mesh: Mesh, matrix: csc_array, of_component: BoolArray) -> Extension:
        held.append(int(of_component.sum()))
        assert matrix.shape == (16, 16)
        return factorised(mesh, matrix, of_component)

    np.testing.assert_allclose(MeshMotion(free, nobody, extension).move(nobody.pose), free.points, atol=1e-15)
    assert held == [1, 1]


def test_a_flow_is_carried_over_to_a_mesh_cut_open_elsewhere() -> None:
    """Its cells are the same, and so is the flow but for periods; the pressure goes on with its drop."""

    def stirring(_time: float, at: FloatArray) -> FloatArray:
        return 8.0 * np.sin(2.0 * np.pi * at[:, ::-1])

    backend = ScikitFem(ScikitFem.Options(), periodic(problem(2, source=stirring), {0: 2.0, 1: 0.0}))
    mesh, seams = box(2, 6), seams_of((0, 1), 2)
    mesh = replace(mesh, periods=Periods(seams.ways, np.zeros((0, 2), dtype=np.int64)))
    flow = Flow.start(backend, mesh, Pose(np.zeros((0, 2)), np.zeros((0, 1)))).after(0.1).after(0.1)
    shift = wavy(mesh, seams)
    other = replace(recut(mesh, seams, shift), periods=mesh.periods)
    fluid, lost = backend.transfer(flow.fluid, mesh, other)
    assert abs(lost) < 1e-9
    before, after = backend.fields(flow.fluid, mesh), backend.fields(fluid, other)
    assert np.abs(before.velocity).max() > 0.1
    for cells in (slice(0, 1), slice(None)):
        np.testing.assert_allclose(after.velocity[after.cells[cells]], before.velocity[before.cells[cells]], atol=1e-8)
    fall = after.pressure[after.cells] - before.pressure[before.cells]
    np.testing.assert_allclose(fall, np.tile(-2.0 * shift[:, :1], (1, 6)), atol=1e-9)
    at = np.array([[0.1, 0.2], [0.15, 0.9], [0.7, 0.05]])
    for one, two in zip(backend.probe(flow.fluid, mesh, at), backend.probe(fluid, other, at), strict=True):
        np.testing.assert_allclose(two, one, atol=1e-8)


def test_the_image_of_a_body_on_a_new_mesh_turns_about_its_own_centre() -> None:
    """The same mesh a period further on: nodes on the ball have U + ω × r with r from its image there."""
    there = around([2.3, 0.5])
    backend = ScikitFem(ScikitFem.Options(), periodic(problem(2, bodies=1), {0: 0.0}))
    near = initial_mesh(there, SIZES)
    assert near.periods is not None
    assert near.periods.winding.tolist() == [[1]]
    far = replace(near, points=near.points + [2.0, 0.0], periods=replace(near.periods, winding=np.array([[0]])))
    fluid, _ = backend.initial(near, there.pose, Twist(np.array([[0.3, -0.2]]), np.array([[2.0]])))
    moved, _ = backend.transfer(fluid, near, far)
    for name in ("position", "position_previous"):
        np.testing.assert_allclose(moved[name], there.pose.position)
    vertices = np.unique(far.facets[far.markers == 0])
    arm = far.points[vertices] - there.pose.position[0]
    np.testing.assert_allclose(moved["velocity"][vertices], [0.3, -0.2] + 2.0 * arm[:, ::-1] * [-1.0, 1.0], atol=1e-12)
