"""How contacts respond to each other's forces, against dense matrices."""

import numpy as np
import pytest
from mesh_tools import ball, box_walls, ellipsoid, upright

from rigidfluid.core.contact.path.delassus import delassus
from rigidfluid.core.coupling.coupled_dynamics import CoupledDynamics
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics import matrices
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.matrices import full
from rigidfluid.core.mechanics.wrenches import contact_wrench, flat
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.reduced_model import Coupling, Evaluation, reduced_model
from rigidfluid.core.model.types import Contacts, Pose, Twist, Wrench
from rigidfluid.detectors.ellipsoid import EllipsoidDetector


def scene(dimension: int) -> tuple[Contacts, Pose]:
    """Two ellipsoids and a ball, and the contacts of all of them with each other and with the walls."""
    bodies = [ellipsoid(0.15, *[0.08] * (dimension - 1)), ellipsoid(0.1, *[0.13] * (dimension - 1))]
    bodies.append(ball(0.1, dimension))
    rest = [0.4] * (dimension - 2)
    pose = upright([0.2, 0.3, *rest], [0.5, 0.35, *rest], [0.8, 0.45, *rest])
    walls = box_walls([0.0] * dimension, [1.0] * dimension, len(bodies))
    return EllipsoidDetector(PartOptions(), bodies, walls).detect(pose, None, np.inf), pose


def turning(dimension: int) -> int:
    return 1 if dimension == 2 else 3


def gap_rates(contacts: Contacts, pose: Pose) -> FloatArray:
    """G, of which each row is the wrench of a unit force in one contact."""
    rows = []
    for number in range(len(contacts)):
        force = np.zeros_like(contacts.normal)
        force[number] = contacts.normal[number]
        rows.append(flat(contact_wrench(contacts, force, pose)).ravel())
    return np.array(rows)


@pytest.mark.parametrize("most_full", [0, 64])
@pytest.mark.parametrize("dimension", [2, 3])
def test_free_bodies(monkeypatch, dimension, most_full):
    """With sparse matrices and with full ones."""
    monkeypatch.setattr(matrices, "MOST_FULL", most_full)
    contacts, pose = scene(dimension)
    count, k = len(pose.position), turning(dimension)
    twist = Twist(np.zeros((count, dimension)), np.zeros((count, k)))
    mass, inertia = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3])[:, None, None] * np.eye(k)
    driven = np.array([False, True, False])
    dynamics = DryDynamics(pose, twist, mass, inertia, np.zeros_like(pose.position), driven, lambda _: np.zeros(0))
    inverse = np.concatenate([1.0 / mass[:, None] * np.ones(dimension), [[10.0] * k, [5.0] * k, [10 / 3] * k]], axis=1)
    inverse[driven] = 0.0
    rates = gap_rates(contacts, pose)
    found = full(delassus(contacts, dynamics, 0.01))
    np.testing.assert_allclose(found, rates @ np.diag(inverse.ravel()) @ rates.T, atol=1e-12)
    assert len(contacts) > count


@pytest.mark.parametrize("dimension", [2, 3])
def test_bodies_in_a_fluid_respond_to_each_other(dimension):
    contacts, pose = scene(dimension)
    count, k = len(pose.position), turning(dimension)
    size = count * (dimension + k)
    root = np.random.default_rng(8).normal(size=(2, size, size))
    inviscid, friction = (r @ r.T + np.eye(size) for r in root)
    model = reduced_model(
        np.arange(size),
        inviscid,
        np.linalg.inv(np.linalg.inv(inviscid) + friction),
        1.0,
        Evaluation(*np.ones((2, size))),
        False,
    )
    twist = Twist(np.zeros((count, dimension)), np.zeros((count, k)))
    blocks = np.zeros((count, dimension, dimension)), np.zeros((count, k, k))
    dynamics = CoupledDynamics(
        pose, twist, np.zeros((count, dimension + k)), *blocks, Coupling(model, *np.zeros((3, size)))
    )
    rates, time = gap_rates(contacts, pose), 0.02
    found = full(delassus(contacts, dynamics, time))
    np.testing.assert_allclose(found, found.T, atol=1e-10)
    force = np.arange(1.0, len(contacts) + 1.0)
    dynamics.kick(contacts_push(contacts, force, pose), time)
    opened = rates @ np.concatenate([dynamics.twist.velocity, dynamics.twist.angular_velocity], axis=1).ravel()
    np.testing.assert_allclose(found @ force * time, opened, rtol=1e-9, atol=1e-10)


def contacts_push(contacts: Contacts, force: FloatArray, pose: Pose) -> Wrench:
    return contact_wrench(contacts, force[:, None] * contacts.normal, pose)
