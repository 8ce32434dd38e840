"""Mechanisms that no run could trust, and what the contract says of them."""

import numpy as np
import pytest
from mechanism_parts import PairOptions, Stroke

from rigidfluid.api import Pose
from rigidfluid.testing import MechanismContract


class FalseRate(Stroke):
    """It says that it turns as fast the other way."""

    def rate(self, time):
        rate = super().rate(time)
        rate.angular_velocity[1] *= -1.0
        return rate


class Jump(Stroke):
    """One ball is elsewhere from one moment on."""

    def placement(self, time):
        pose = super().placement(time)
        pose.position[1] += 0.01 * (time > 0.777)
        return pose


class Flip(Stroke):
    """One body turns in no time, between the moments at which it is asked for derivatives."""

    def placement(self, time):
        pose = super().placement(time)
        return Pose(pose.position, self.turned(0.5 * np.sin(2.0 * np.pi * time) + 0.1 * (time > 0.777)))


class Clash(Stroke):
    """Its balls are in each other for a short time, when the rod is shortest."""

    def length(self, time):
        return 0.5 * super().length(time)

    def rate(self, time):
        rate = super().rate(time)
        rate.velocity[1] *= 0.5
        return rate


def contract_of(kind, dimension):
    """The contract, and the mechanism that it is to judge."""
    return MechanismContract(), kind(PairOptions(radius=0.1, length=0.6, density=2.0, stroke=0.25), dimension)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(
    ("kind", "found", "passed"),
    [
        (FalseRate, "test_the_rate_is_the_derivative_of_the_placement", "test_components_do_not_overlap"),
        (FalseRate, "test_its_kinematics_are_derivatives_of_the_poses", "test_components_do_not_overlap"),
        (Jump, "test_placements_do_not_jump", "test_the_rate_is_the_derivative_of_the_placement"),
        (Flip, "test_placements_do_not_jump", "test_the_rate_is_the_derivative_of_the_placement"),
        (Clash, "test_components_do_not_overlap", "test_placements_do_not_jump"),
    ],
)
def test_each_flaw_is_found(kind, found, passed, dimension):
    contract, mechanism = contract_of(kind, dimension)
    with pytest.raises(AssertionError):
        getattr(contract, found)(mechanism)
    getattr(contract, passed)(mechanism)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_right_one_passes_them_all(dimension):
    contract, mechanism = contract_of(Stroke, dimension)
    for name in dir(contract):
        if name.startswith("test_") and name != "test_shapes_are_of_types_that_a_scene_can_name":
            getattr(contract, name)(mechanism)
