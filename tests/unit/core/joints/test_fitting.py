"""Twists that joints allow, and kicks of any length against rigid joints and dampers together."""

from __future__ import annotations

import numpy as np
import pytest
from linked_bodies import joint, linkage, masses, placed, split

from rigidfluid.core.joints.jointed_dynamics import JointedDynamics
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.types import Wrench

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])


@DIMENSIONS
def test_a_twist_that_fits_has_the_rate_of_the_drive(dimension: int) -> None:
    pose = placed(2, dimension)
    links = linkage(pose, [joint("hinge", 0, 1, pose.position.mean(axis=0), drive=lambda time: (2.0 * time, 2.0))])
    random = np.random.default_rng(1).normal(size=(2, 3 if dimension == 2 else 6))
    twist = flat(links.fitting(pose, split(random, dimension), 0.0))
    here = links.links(pose, 0.0)
    assert np.abs(here.rate).max() == 2.0
    np.testing.assert_allclose(np.einsum("cni,ni->c", here.rows, twist), here.rate, atol=1e-12)


@DIMENSIONS
def test_one_long_kick_against_a_damper_is_many_short_ones(dimension: int) -> None:
    """In one place dampers are followed exactly, with all that the rigid part of the joint does meanwhile."""
    pose = placed(2, dimension)
    links = linkage(pose, [joint("hinge", 0, 1, pose.position.mean(axis=0), damping=1.5)])
    random = np.random.default_rng(2).normal(size=(2, 2, 3 if dimension == 2 else 6))
    start, wrench = links.fitting(pose, split(random[0], dimension), 0.0), split(random[1], dimension)
    ends = []
    for count in (1, 20):
        own = *masses(2, dimension), np.zeros((2, dimension)), np.zeros(2, dtype=bool)
        motion = JointedDynamics(DryDynamics(pose, start, *own, lambda _: np.zeros(0)), links, 0.0)
        for _ in range(count):
            motion.kick(Wrench(wrench.velocity, wrench.angular_velocity), 0.5 / count)
        ends.append(flat(motion.twist))
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-10)
    assert np.abs(ends[0] - flat(start)).max() > 0.1
