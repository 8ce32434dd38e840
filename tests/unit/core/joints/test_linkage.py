"""Joints as rows on twists: what they hold, that they fit, and what springs store."""

import mechanism_parts
import numpy as np
import pytest
from linked_bodies import AXIS, ground_link, joint, linkage, moved, placed, split
from mechanism_parts import PairOptions

from rigidfluid.core.joints.joint_forces import joint_forces
from rigidfluid.core.joints.joint_parts import joint_markers
from rigidfluid.core.joints.linkage import JointLinkage
from rigidfluid.core.joints.markers import Markers, add_relative_rows
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.rigid import moment, rotate
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.errors import PluginError, SceneError, StepRejected

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])


def swing(time):
    return 0.7 * np.sin(3.0 * time), 2.1 * np.cos(3.0 * time)


def chain(dimension, **keys):
    """A hinge, a rod and a driven hinge, between four bodies."""
    pose = placed(4, dimension)
    points = 0.5 * (pose.position[:-1] + pose.position[1:])
    joints = [
        joint("hinge", 0, 1, points[0]),
        joint("rod", 2, 1, points[1]),
        joint("hinge", 2, 3, points[2], drive=swing),
    ]
    return pose, linkage(pose, joints, **keys)


def fits_and_moves(links, pose, time, seed=1):
    """Somewhere else where the joints fit, and twists there that they allow."""
    count, dimension = pose.position.shape
    width = 3 if dimension == 2 else 6
    random = np.random.default_rng(seed)
    there = links.closed(moved(pose, random.normal(size=(count, width)), 0.3), time)
    return there, links.fitting(there, split(random.normal(size=(count, width)), dimension), time)


def assert_rates(links, pose, twist, time):
    """Misfits change by C u - rate, whatever the twists."""
    here, small = links.links(pose, time), 1e-5
    later, earlier = (links.misfit(moved(pose, flat(twist), way), time + way) for way in (small, -small))
    expected = (np.einsum("cni,ni->c", here.rows, flat(twist)) - here.rate)[here.compliance == 0.0]
    np.testing.assert_allclose((later - earlier) / (2.0 * small), expected, atol=1e-8)


def angle_of(links):
    """Of the last joint's markers."""
    return lambda pose: links._markers.placed(pose)[-1].angle


@DIMENSIONS
def test_rows_are_the_rates_of_misfits(dimension):
    pose, links = chain(dimension)
    there, _ = fits_and_moves(links, pose, 0.4)
    twist = split(np.random.default_rng(2).normal(size=flat(links.spring_wrench(pose, 0.0)).shape), dimension)
    assert np.abs(there.position - pose.position).max() > 0.1
    assert_rates(links, there, twist, 0.4)


@DIMENSIONS
def test_a_sliders_axis_turns_with_the_second_body(dimension):
    """Separation across and displacement along it change by their rows for bodies anywhere, whatever the twist; without
    the term of the turning axis they do not."""
    pose, small = placed(2, dimension), 1e-5
    slider = joint("slider", 0, 1, pose.position.mean(axis=0))
    twist = np.random.default_rng(6).normal(size=(2, 3 if dimension == 2 else 6))
    there, markers = moved(pose, twist[::-1], 0.7), joint_markers(slider, pose)
    off, along = slider.kind.constraints("it", markers)[0], slider.kind.coordinate
    place = Markers([markers], dimension)

    def separation(way):
        at = place.placed(moved(there, twist, way))[0]
        return np.array([*off.misfit(at, 0.0), along.value(at)])

    slope, at = (separation(small) - separation(-small)) / (2.0 * small), place.placed(there)[0]
    rows, wrong = np.zeros((2, dimension, *twist.shape))
    for part, first in ((off, 0), (along, dimension - 1)):
        directions = part.directions(at)
        here = slice(first, first + len(directions[0]))
        add_relative_rows(markers.bodies, part.levers(at), directions, rows[here])
        add_relative_rows(markers.bodies, at.levers, directions, wrong[here])
    assert np.linalg.norm(off.misfit(at, 0.0)) > 0.3
    np.testing.assert_allclose(np.einsum("cni,ni->c", rows, twist), slope, atol=1e-8)
    assert np.abs(np.einsum("cni,ni->c", wrong, twist) - slope).min() > 0.1


@DIMENSIONS
def test_rows_of_held_directions_are_the_rates_of_misfits(dimension):
    pose = placed(2, dimension)
    held = {2: ([0, 2], [1]), 3: ([1, 3, 5], [0, 2, 3, 4, 5])}[dimension]
    links = linkage(pose, ground=[ground_link(body, dimension, which) for body, which in enumerate(held)])
    there, _ = fits_and_moves(links, pose, 0.0)
    twist = split(np.random.default_rng(2).normal(size=flat(links.spring_wrench(pose, 0.0)).shape), dimension)
    assert_rates(links, there, twist, 0.0)


@DIMENSIONS
def test_a_motion_that_fits_leaves_what_the_joint_is_for(dimension):
    """Of four bodies: all together, one angle, and one that is driven."""
    pose, links = chain(dimension)
    rows = links.links(pose, 0.0).rows.reshape(-1, pose.position.shape[0] * (3 if dimension == 2 else 6))
    assert rows.shape[1] - np.linalg.matrix_rank(rows) == (3 if dimension == 2 else 6) + 1


@DIMENSIONS
def test_joints_give_neither_momentum_nor_angular_momentum(dimension):
    pose, links = chain(dimension)
    there, _ = fits_and_moves(links, pose, 0.4)
    force = np.random.default_rng(3).normal(size=len(links.links(there, 0.4).rate))
    wrench = np.einsum("c,cni->ni", force, links.links(there, 0.4).rows)
    np.testing.assert_allclose(wrench[:, :dimension].sum(axis=0), 0.0, atol=1e-12)
    torque = wrench[:, dimension:] + moment(there.position, wrench[:, :dimension])
    np.testing.assert_allclose(torque.sum(axis=0), 0.0, atol=1e-11)


@DIMENSIONS
def test_closed_poses_fit_to_rounding_and_the_centre_of_mass_stays(dimension):
    pose, links = chain(dimension)
    apart = moved(pose, np.random.default_rng(4).normal(size=(4, 3 if dimension == 2 else 6)), 0.2)
    closed = links.closed(apart, 0.3)
    assert np.abs(links.misfit(apart, 0.3)).max() > 0.05
    assert np.abs(links.misfit(closed, 0.3)).max() < 1e-12
    mass = 1.0 + 0.5 * np.arange(4)
    np.testing.assert_allclose(mass @ closed.position, mass @ apart.position, atol=1e-12)
    assert links.closed(closed, 0.3) is closed


def test_bodies_of_given_motion_stay_where_they_are():
    pose, links = chain(2, prescribed=[1])
    apart = moved(pose, np.ones((4, 3)), 0.1)
    closed = links.closed(apart, 0.0)
    np.testing.assert_array_equal(closed.position[1], apart.position[1])
    assert not np.array_equal(closed.position[0], apart.position[0])


def test_what_cannot_be_closed_is_rejected():
    pose = Pose(np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros((2, 1)))
    links = linkage(pose, [joint("hinge", 0, 1, [0.5, 0.0])], prescribed=[1])
    held = linkage(pose, [joint("hinge", 0, 1, [0.5, 0.2])], [ground_link(0, 2, [0])], prescribed=[1])
    far = Pose(pose.position + [[0.0, 0.0], [3.0, 0.0]], pose.orientation)
    assert np.abs(links.misfit(links.closed(far, 0.0), 0.0)).max() < 1e-12
    with pytest.raises(StepRejected, match=r"joints.*cannot be closed"):
        held.closed(far, 0.0)


def test_a_pose_in_which_two_joints_hold_the_same_is_rejected():
    with pytest.raises(StepRejected, match=r"joints.*two of them hold the same"):
        joint_forces(np.ones((2, 2)), np.array([1.0, 0.0]))


@DIMENSIONS
def test_given_motion_is_in_the_rates(dimension):
    given = np.random.default_rng(5).normal(size=(4, 3 if dimension == 2 else 6))
    pose, links = chain(dimension, prescribed=[1], given=lambda _: given)
    plain = chain(dimension)[1].links(pose, 0.2)
    here = links.links(pose, 0.2)
    assert not here.rows[:, 1].any()
    np.testing.assert_allclose(here.rate, plain.rate - plain.rows[:, 1] @ given[1], atol=1e-14)


@DIMENSIONS
def test_an_angle_is_that_of_the_first_body_seen_from_the_second(dimension):
    pose = placed(2, dimension)
    links = linkage(pose, [joint("hinge", 0, 1, pose.position[0])])
    together = np.array([[0.3]]) if dimension == 2 else np.array([[0.5, -0.2, 0.4]])
    alone = np.array([[0.6]]) if dimension == 2 else 0.6 * AXIS[None]
    turned = np.concatenate([rotate(pose.orientation[:1], alone), pose.orientation[1:]])
    there = Pose(pose.position, rotate(turned, np.repeat(together, 2, axis=0)))
    assert angle_of(links)(pose) == pytest.approx(0.0, abs=1e-15)
    assert angle_of(links)(there) == pytest.approx(0.6, rel=1e-12)


@DIMENSIONS
@pytest.mark.parametrize("kind", ["hinge", "ground"])
def test_springs_pull_down_the_slope_of_their_energy(dimension, kind):
    pose, width = placed(2, dimension), 3 if dimension == 2 else 6
    hinge = [joint("hinge", 0, 1, pose.position[0], stiffness=2.0, rest_angle=0.3)]
    ground = [ground_link(1, dimension, stiffness=np.arange(1.0, width + 1.0))]
    links = linkage(pose, hinge) if kind == "hinge" else linkage(pose, ground=ground)
    there, _ = fits_and_moves(links, pose, 0.0)
    slope, small = np.zeros((2, width)), 1e-5
    for body in range(2):
        for direction in range(width):
            way = np.zeros((2, width))
            way[body, direction] = small
            ends = [links.spring_energy(moved(there, way, sign), 0.0) for sign in (1.0, -1.0)]
            slope[body, direction] = (ends[0] - ends[1]) / (2.0 * small)
    assert np.abs(slope).max() > 0.1
    np.testing.assert_allclose(flat(links.spring_wrench(there, 0.0)), -slope, atol=1e-8)


def test_the_frequency_is_that_of_the_stiffest_spring_on_its_masses():
    pose = placed(2, 3)
    hinge = linkage(pose, [joint("hinge", 0, 1, pose.position[0], stiffness=2.0)])
    rail = linkage(
        pose, ground=[ground_link(1, 3, [0, 2, 3, 4, 5], stiffness=[900.0, 6.0, 900.0, 900.0, 900.0, 900.0])]
    )
    least, greatest = (np.sqrt(2.0 * (1.0 / moment + 1.0 / (1.5 * moment))) for moment in (0.4, 0.2))
    assert least < hinge.frequency < greatest
    assert rail.frequency == pytest.approx(2.0)
    assert linkage(pose).frequency == 0.0


@pytest.fixture
def carried():
    """A pair that changes its length, wags its head and has one ball hinged to it, in 3D."""
    mechanism = mechanism_parts.Stroke(PairOptions(radius=0.1, length=0.6, density=2.0, ratio=1.5, stroke=0.2), 3)
    mass, inertia = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 3.0])[:, None, None] * np.diag([0.1, 0.2, 0.3])
    start = Pose(placed(2, 3).position, placed(2, 3).orientation)
    rest = Twist(np.zeros((2, 3)), np.zeros((2, 3)))
    bodies = CarriedBodies({"it": mechanism}, mass, inertia, np.zeros(3, dtype=bool), start, rest)
    pose = bodies.poses(start, 0.0)
    hinge = joint("hinge", 0, 2, pose.position[2] + [0.0, 0.3, 0.0], stiffness=1.0)
    links = JointLinkage(pose, [hinge], [], bodies, lambda _: np.zeros((2, 6)))
    return bodies, links, start


def test_joints_of_components_move_their_motions(carried):
    _, links, start = carried
    there, twist = fits_and_moves(links, start, 0.4)
    assert links.links(start, 0.4).rows.shape == (5, 2, 6)
    assert np.abs(links.links(there, 0.4).rate).max() > 0.1
    assert_rates(links, there, twist, 0.4)
    assert_rates(links, there, split(np.random.default_rng(7).normal(size=(2, 6)), 3), 0.4)
    assert list(links.clusters) == [0, 0]


def test_what_moves_components_works_against_springs(carried):
    _, links, start = carried
    there, twist = fits_and_moves(links, start, 0.4)
    small = 1e-5
    later, earlier = (links.spring_energy(moved(there, flat(twist), way), 0.4 + way) for way in (small, -small))
    pull = flat(links.spring_wrench(there, 0.4))
    expected = links.spring_power(there, 0.4) - np.sum(pull * flat(twist))
    assert abs(links.spring_power(there, 0.4)) > 1e-3
    assert (later - earlier) / (2.0 * small) == pytest.approx(expected, rel=1e-7)


def test_dampers_have_rows_of_their_own():
    pose = placed(2, 2)
    hinge = joint("hinge", 0, 1, pose.position[0], damping=4.0)
    links = linkage(pose, [hinge], [ground_link(1, 2, [0], damping=[9.0, 2.0, 0.0])])
    here = links.links(pose, 0.0)
    np.testing.assert_allclose(here.compliance, [0.0, 0.0, 0.25, 0.0, 0.5])
    np.testing.assert_allclose(here.rows[2], [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    np.testing.assert_allclose(here.rows[4], [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    assert len(links.misfit(pose, 0.0)) == 3


def test_clusters_end_at_the_ground_and_at_what_is_given():
    pose = placed(6, 2)
    points = pose.position
    joints = [joint("hinge", 3, 1, points[1]), joint("rod", 3, 4, points[3]), joint("hinge", 0, 5, points[5])]
    links = linkage(pose, [*joints, joint("hinge", 5, 4, points[4])], prescribed=[5])
    np.testing.assert_array_equal(links.clusters, [0, 1, 2, 1, 1, 5])
    np.testing.assert_array_equal(links.linked, [True, True, False, True, True, True])
    grounded = linkage(pose, [joint("hinge", 0, None, points[0])], [ground_link(1, 2, stiffness=[1.0, 1.0, 0.0])])
    np.testing.assert_array_equal(grounded.clusters, np.arange(6))
    np.testing.assert_array_equal(grounded.linked, [True, True, False, False, False, False])


@DIMENSIONS
@pytest.mark.parametrize(
    ("joints", "name"),
    [
        (lambda at: [joint("hinge", 0, 1, at[0]), joint("hinge", 1, 0, at[1], name="two")], "joint 'two'"),
        (lambda at: [joint("rod", one, (one + 1) % 3, at[one], name=f"rod{one}") for one in range(3)], "joint 'rod2'"),
        (lambda at: [joint("hinge", 0, 1, at[0], drive=swing), joint("hinge", 0, 1, at[0], name="b")], "joint 'b'"),
        (lambda at: [joint("rod", 0, None, at[0]), joint("hinge", 0, None, at[1], name="b")], "joint 'b'"),
    ],
)
def test_joints_that_hold_what_is_held_are_refused(dimension, joints, name):
    pose = placed(3, dimension)
    with pytest.raises(SceneError, match=rf"{name}: found an over-determined joint"):
        linkage(pose, joints(pose.position))


def test_a_held_direction_that_a_joint_holds_already_is_refused():
    pose = placed(2, 2)
    with pytest.raises(SceneError, match=r"body 'body0': found an over-determined joint"):
        linkage(pose, [joint("rod", 0, None, pose.position[0])], [ground_link(0, 2, [1])])


def test_joints_without_a_body_that_moves_freely_are_refused():
    pose = placed(2, 2)
    with pytest.raises(SceneError, match=r"joint 'joint0': found nothing that moves freely"):
        linkage(pose, [joint("hinge", 0, 1, pose.position[0])], prescribed=[0, 1])
    with pytest.raises(SceneError, match=r"joint 'joint0': found nothing that moves freely"):
        linkage(pose, [joint("hinge", 0, None, pose.position[0])], prescribed=[0])


def test_parts_of_one_mechanism_are_not_joined(carried):
    bodies, _, start = carried
    pose = bodies.poses(start, 0.0)
    with pytest.raises(SceneError, match=r"found parts of one mechanism"):
        JointLinkage(pose, [joint("rod", 1, 2, pose.position[1])], [], bodies, lambda _: None)


def test_a_joint_that_holds_nothing_is_an_error_of_its_author():
    pose = placed(2, 2)
    given = joint("hinge", 0, 1, pose.position[0])
    given.kind.constraints = lambda name, markers: []
    with pytest.raises(PluginError, match=r"joint 'joint0'.*no constraints by type 'hinge'.*JointContract"):
        linkage(pose, [given])


def test_one_held_rotation_of_three_is_refused():
    with pytest.raises(SceneError, match=r"body 'body0'.*one rotation of three"):
        linkage(placed(1, 3), ground=[ground_link(0, 3, [0, 3])])


def test_a_drive_starts_where_the_bodies_are():
    pose = placed(2, 2)
    with pytest.raises(SceneError, match=r"joint 'joint0'.*angle 0.5.*start at 0"):
        linkage(pose, [joint("hinge", 0, 1, pose.position[0], drive=lambda time: (0.5 + time, 1.0))])


def test_a_drive_goes_round_and_round():
    pose = placed(2, 3)
    links = linkage(pose, [joint("hinge", 0, 1, pose.position[0], drive=lambda time: (9.0 * time, 9.0))])
    axes = np.array([9.0 * AXIS, np.zeros(3)])
    there = Pose(pose.position, rotate(pose.orientation, axes))
    assert np.abs(links.misfit(there, 1.0)).max() < 1e-14
    assert np.abs(links.misfit(there, 1.1)).max() == pytest.approx(0.9)
