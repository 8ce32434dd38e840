"""When a moved mesh has become too coarse, and when somebody looks."""

from dataclasses import replace

import numpy as np
import pytest
from mesh_tools import ball, box, box_walls, upright
from threaded_ranks import on_ranks

from rigidfluid.core.mesh.adaptation import remesh as module
from rigidfluid.core.mesh.adaptation.coarsening import MOST_COARSENED, has_coarsened, is_due, relative_sizes
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.mesh_adaptation import reference_of
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.distribution import distributed
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_sizes
from rigidfluid.core.mesh.size.regions import RefinedBox
from rigidfluid.core.mesh.size.size_field import Sizes

RADIUS, DISK = 0.125, [ball(0.125)]
LOWER, UPPER = np.zeros(2), np.array([2.0, 8.0])
BOX, WALLS = box(LOWER, UPPER), box_walls(LOWER, UPPER, 1)
SIZES, START = Sizes(size=0.2, size_body=0.025), upright([1.0, 6.0])
MESH = initial_mesh(FluidDomain(DISK, START, BOX, WALLS), SIZES)
REFERENCE = reference_of(MESH, START, np.array([1.0]), 0)


def fallen(height):
    """The mesh's vertices when the disk has fallen so far, and its pose there."""
    pose = upright([1.0, 6.0 - height])
    return MeshMotion(MESH, FluidDomain(DISK, START, BOX, ())).move(pose), pose


def asks(points, pose, reference=REFERENCE, sizes=SIZES):
    cells = reference.mesh.cells
    made = relative_sizes(reference.mesh.points, cells, FluidDomain(DISK, reference.pose, BOX, WALLS), sizes)
    return has_coarsened(
        made, relative_sizes(points, cells, FluidDomain(DISK, pose, BOX, WALLS), sizes), reference.mesh.ranks
    )


def test_the_size_of_regular_simplices_is_their_edge():
    triangle = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, np.sqrt(3.0)]])
    tetrahedron = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    assert cell_sizes(triangle, np.array([[0, 1, 2]])) == pytest.approx([2.0])
    assert cell_sizes(tetrahedron, np.array([[1, 0, 2, 3]])) == pytest.approx([np.sqrt(8.0)])
    assert cell_sizes(triangle, np.array([[1, 0, 2]])) == [0.0]


def test_a_body_far_from_where_the_mesh_was_made_asks_long_before_a_cell_is_bad():
    found = [height for height in np.arange(0.0, 4.0, 0.05) if asks(*fallen(height))]
    assert 2.0 * RADIUS < found[0] < 12.0 * RADIUS
    assert cell_quality(fallen(found[0])[0], MESH.cells).min() > 0.5


def test_cells_are_never_much_coarser_than_wanted_if_it_is_heeded():
    mesh, start, worst, made = MESH, START, 0.0, 0
    for height in np.arange(0.05, 4.0, 0.05):
        pose = upright([1.0, 6.0 - height])
        points = MeshMotion(mesh, FluidDomain(DISK, start, BOX, ())).move(pose)
        if asks(points, pose, reference_of(mesh, start, np.array([1.0]), 0)):
            mesh, start = remesh(replace(mesh, points=points), FluidDomain(DISK, pose, BOX, WALLS), SIZES), pose
            points, made = mesh.points, made + 1
        worst = max(worst, relative_sizes(points, mesh.cells, FluidDomain(DISK, pose, BOX, WALLS), SIZES).max())
    assert worst < 1.25 * MOST_COARSENED
    assert 1 <= made < 6


def test_a_mesh_just_made_does_not_ask_however_coarse_it_is():
    far_too_fine = replace(SIZES, size=0.02, size_body=0.0025)
    assert (
        relative_sizes(MESH.points, MESH.cells, FluidDomain(DISK, START, BOX, WALLS), far_too_fine).min()
        > 1.1 * MOST_COARSENED
    )
    assert not asks(MESH.points, START, sizes=far_too_fine)


def test_cells_finer_than_wanted_may_grow_up_to_that():
    points, pose = fallen(1.5)
    assert asks(points, pose)
    assert not asks(points, pose, sizes=replace(SIZES, size=0.6, size_body=0.075))


def test_a_cell_counts_by_its_growth_over_what_it_was_or_over_what_is_wanted():
    """Whichever of both is longer; one cell alone in each mesh."""
    for made, now, asked in ((0.5, 1.3, False), (0.5, 1.5, True), (2.0, 2.7, False), (2.0, 2.9, True)):
        assert has_coarsened(np.array([made]), np.array([now]), MESH.ranks) is asked


def test_a_gap_asks_by_its_own_rule_alone():
    near = upright([1.0, RADIUS + 0.02])
    mesh = initial_mesh(FluidDomain(DISK, near, BOX, WALLS), SIZES)
    nearer = upright([1.0, RADIUS + 0.002])
    points = MeshMotion(mesh, FluidDomain(DISK, near, BOX, ())).move(nearer)
    assert not asks(points, nearer, reference_of(mesh, near, np.array([0.02]), 0))


def test_cells_that_are_carried_into_a_box_ask():
    below = RefinedBox(np.array([0.8, 5.0]), np.array([1.2, 5.5]), 0.05)
    sizes = replace(SIZES, regions=(below,))
    mesh = initial_mesh(FluidDomain(DISK, START, BOX, WALLS), sizes)
    carried = mesh.points + np.array([0.0, 0.3]) * (np.abs(mesh.points[:, 1:] - 5.0) < 1.2)
    reference = reference_of(mesh, START, np.array([1.0]), 0)
    assert not asks(mesh.points, START, reference, sizes)
    assert asks(carried, START, reference, sizes)


def test_a_look_is_due_each_time_that_a_body_has_gone_another_growth_length():
    length, before = SIZES.size_body / SIZES.growth, START
    due = 0
    for gone in np.arange(0.0, 10.0, 0.13)[1:] * length:
        after = upright([1.0 - 0.6 * gone, 6.0 - 0.8 * gone])
        due += is_due(START, before, after, SIZES)
        before = after
    assert due == 9
    assert not is_due(START, START, START, SIZES)


def test_all_ranks_are_told_the_same():
    for height in (0.5, 1.5):
        points, pose = fallen(height)

        def told(ranks, points=points, pose=pose):
            part = distributed(MESH if ranks.is_root else None, ranks)
            reference = reference_of(part, START, np.array([1.0]), 0)
            return asks(points[part.part.vertices], pose, reference)

        assert set(on_ranks(3, told)) == {asks(points, pose)}


def test_a_mesh_that_one_pass_of_mmg_leaves_too_coarse_gets_another(monkeypatch):
    """MMG knows the wanted size at the vertices alone, and behind the disk there are few."""
    points, pose = fallen(4.8)
    passes, improve = [], module.best_remeshed

    def lazy(mesh, *given):
        passes.append(mesh)
        return mesh if len(passes) == 1 else improve(mesh, *given)

    monkeypatch.setattr(module, "best_remeshed", lazy)
    made = remesh(replace(MESH, points=points), FluidDomain(DISK, pose, BOX, WALLS), SIZES)
    assert relative_sizes(points, MESH.cells, FluidDomain(DISK, pose, BOX, WALLS), SIZES).max() > 2.0
    assert relative_sizes(made.points, made.cells, FluidDomain(DISK, pose, BOX, WALLS), SIZES).max() < 1.4
    assert len(passes) == 2
