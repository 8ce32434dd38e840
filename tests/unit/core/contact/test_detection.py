"""Contacts found by the poses alone, and on the fluid's mesh."""

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.pairs.extrapolated_contacts import ExtrapolatedContacts
from rigidfluid.core.contact.pairs.gap_changes import change_too_fast
from rigidfluid.core.contact.path.detection import MeshDetection, PoseDetection, detection_by
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.detectors.brute_force import BruteForceDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector
from rigidfluid.errors import StepRejected

BALL = {"type": "sphere", "radius": 0.1, "density": 2.0}
PAIR = BALL | {"name": "a", "position": [0.3, 0.5]}, BALL | {"name": "b", "position": [0.55, 0.5]}
LAW = {"law": "centre", "range": 0.08, "epsilon": 1e-4}


@pytest.fixture(scope="module")
def system():
    return build_system(scene_from_dict(dry_tables(*PAIR, contact=LAW)))


@pytest.fixture(scope="module")
def contacts(system):
    return system.detector.detect(system.pose, None, 1.0)


def test_a_detector_that_declares_that_it_needs_the_mesh_is_asked_on_the_mesh():
    class Theirs(BruteForceDetector):
        needs_mesh: ClassVar[bool] = True

    found = [detection_by(detector) for detector in (BruteForceDetector, NarrowBandDetector, Theirs)]
    assert found == [PoseDetection, MeshDetection, MeshDetection]


def test_no_mesh_is_made_for_a_detector_that_looks_at_none(system):
    made = Mesh.empty(2)
    assert MeshDetection.mesh_at(system.pose, lambda pose: made) is made
    assert len(PoseDetection.mesh_at(system.pose, lambda pose: pytest.fail("made")).points) == 0


def test_contacts_found_by_poses_are_never_missed(system, contacts):
    assert not PoseDetection(system).has_missed(select(contacts, contacts.gap < 0.0), contacts)


def test_a_pair_in_range_that_was_not_seen_is_missed_on_the_mesh(system, contacts):
    touching = contacts.gap < system.law.range
    assert touching.sum() == 1
    assert MeshDetection(system).has_missed(select(contacts, ~touching), contacts)
    assert not MeshDetection(system).has_missed(contacts, contacts)
    assert not MeshDetection(system).has_missed(select(contacts, touching), contacts)


def test_more_contacts_of_a_pair_than_were_seen_are_missed_on_the_mesh(system, contacts):
    pair = np.flatnonzero(contacts.gap < system.law.range)
    assert MeshDetection(system).has_missed(contacts, select(contacts, np.repeat(pair, 2)))


def test_contacts_between_two_meshes_move_with_their_bodies_and_others_are_detected_anew(system, contacts):
    near = select(contacts, contacts.gap < system.law.range)
    moved = Pose(system.pose.position + [[0.0, 0.0], [0.0, 0.3]], system.pose.orientation)
    simulation = Simulation(scene_from_dict(dry_tables(*PAIR, contact=LAW)))
    bodies = simulation.stepper.scheme.bodies_now(simulation.state, 0.0)
    start = ExtrapolatedContacts(near, system.pose)
    carried, anew = (
        kind(system).look_ahead(start, bodies, 0.01).contacts_at(moved) for kind in (MeshDetection, PoseDetection)
    )
    assert len(carried) == 1
    assert len(anew) == 0


def test_what_comes_between_two_meshes_is_not_known(system, contacts):
    assert ExtrapolatedContacts(contacts, system.pose).missed(system.law, system.pose) == 0.0


def test_a_gap_may_close_to_seven_tenths_of_it_in_a_step(system):
    state = Simulation(scene_from_dict(dry_tables(*PAIR, contact=LAW))).state

    def is_too_fast(way):
        pose = Pose(system.pose.position + [[way, 0.0], [0.0, 0.0]], system.pose.orientation)
        return change_too_fast(system, state, pose, lambda pose: pytest.fail("no mesh is asked for"))

    assert [is_too_fast(way) for way in (0.0, 0.0148, 0.0152, -0.026)] == [False, False, True, True]


def test_a_gap_changes_too_fast_where_the_mesh_is_tangled():
    simulation = Simulation(scene_from_dict(dry_tables(*PAIR, contact=LAW)))
    pose = Pose(simulation.state.pose.position + [[0.02, 0.0], [0.0, 0.0]], simulation.state.pose.orientation)
    on_mesh = replace(simulation.system, detection_type=MeshDetection)

    def tangled(pose):
        raise StepRejected("mesh", "a tangled cell", "none", "Shorten the step.")

    assert change_too_fast(on_mesh, simulation.state, pose, tangled)
