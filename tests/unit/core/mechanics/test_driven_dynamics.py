"""Motions that change their shape, between contacts, and in the time scheme: angular momentum is kept."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from carried_bodies import carried
from linked_bodies import split

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.driven_dynamics import DrivenDynamics
from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.rigid import inverse_lab_inertia, lab_inertia, rotate, turned
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.types import Pose, Twist, Wrench

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])


def angular_momentum(motions: CarriedBodies, orientation: FloatArray, spin: FloatArray, time: float) -> FloatArray:
    own = np.einsum("nij,nj->ni", lab_inertia(motions.inertia(time), orientation), spin)
    return own + turned(orientation, motions.spin(time))


def free(motions: CarriedBodies, dimension: int, start: float) -> DrivenDynamics:
    return DrivenDynamics(motions.pose, motions.twist, motions, np.zeros((3, dimension)), start, lambda _: None)  # type: ignore[arg-type, return-value]


@DIMENSIONS
def test_a_stroke_turns_the_whole_back_and_changes_how_it_answers(dimension: int) -> None:
    """By the inertia of the present shape."""
    motions, _ = carried(dimension)
    body = free(motions, dimension, 0.1)
    before = angular_momentum(motions, motions.pose.orientation, motions.twist.angular_velocity, 0.1)
    for _ in range(3):
        body.drift(0.05)
    now = angular_momentum(motions, body.pose.orientation, body.twist.angular_velocity, 0.25)
    np.testing.assert_allclose(now, before, atol=1e-12)
    inverse = inverse_lab_inertia(motions.inertia(0.25), body.pose.orientation)
    np.testing.assert_allclose(body.inverse_inertia, inverse, atol=1e-9 * np.abs(inverse).max())


def test_what_is_as_a_ball_at_the_start_alone_answers_as_it_is_later() -> None:
    """The inverse inertia turns with it as soon as a stroke makes its moments differ."""

    class Stretching:
        mass, prescribed, driven_motions = np.ones(1), np.zeros(1, dtype=bool), np.ones(1, dtype=bool)

        def inertia(self, time: float) -> FloatArray:
            return np.diag([1.0, 1.0 + time, 1.0 + 2.0 * time])[None]

        def spin(self, time: float) -> FloatArray:
            return np.zeros((1, 3))

    twist = Twist(np.zeros((1, 3)), np.array([[0.3, -0.5, 0.7]]))
    motions: Any = Stretching()
    still = Pose(np.zeros((1, 3)), np.array([[0.5, 0.5, 0.5, 0.5]]))
    body = DrivenDynamics(still, twist, motions, np.zeros((1, 3)), 0.0, lambda _: np.zeros((1, 6)))
    body.drift(0.5)
    inverse = inverse_lab_inertia(motions.inertia(0.5), body.pose.orientation)
    np.testing.assert_allclose(body.inverse_inertia, inverse, atol=1e-12)


@DIMENSIONS
def test_a_stroke_is_followed_to_second_order(dimension: int) -> None:
    motions, _ = carried(dimension)
    ends = []
    for steps in (20, 40, 80):
        body = free(motions, dimension, 0.0)
        for _ in range(steps):
            body.drift(0.6 / steps)
        ends.append(body.pose.orientation)
    assert np.abs(ends[2] - ends[1]).max() < 0.3 * np.abs(ends[1] - ends[0]).max()


def test_a_stroke_that_begins_at_once_turns_the_whole_at_once() -> None:
    """From a moment ahead on, at which the drive is read."""
    motions, _ = carried(2)
    body = free(motions, 2, 0.0)
    before = angular_momentum(motions, motions.pose.orientation, motions.twist.angular_velocity, 0.0)
    body.begin(0.2)
    now = angular_momentum(motions, body.pose.orientation, body.twist.angular_velocity, 0.2)
    np.testing.assert_allclose(now, before)


def state_of(motions: CarriedBodies, moments: list[tuple[float, Pose, Twist]], **keys: Any) -> Any:
    """At the second of two moments, after a first step between them."""
    (first, pose, twist), (second, now, now_twist) = moments
    none = Wrench(np.zeros_like(now_twist.velocity), np.zeros_like(now_twist.angular_velocity))
    past = SimpleNamespace(pose=pose, twist=twist, step=second - first, applied=keys.pop("before", None))
    given = {"contact": none} | keys
    return SimpleNamespace(
        motions=SimpleNamespace(pose=now, twist=now_twist, contact=given["contact"]),
        pose=motions.poses(now, second),
        twist=motions.kinematics(now, second).component_twist(now_twist),
        past=past,
        past_step=past.step,
        applied=given.get("applied"),
    )


def system_of(motions: CarriedBodies, dimension: int) -> Any:
    joints = SimpleNamespace(with_springs=lambda wrench, *_: wrench, links=lambda *_: None)
    count = len(motions.carrier)
    return SimpleNamespace(
        motions=motions, dimension=dimension, solved_joints=joints, has_fluid=True, stresslets=False,
        boundary_forces=False, cell_errors=False,
        weight=np.zeros((count, dimension)),
        inertia=motions._own_inertia, prescribed=np.zeros(count, dtype=bool), prescribed_twist=lambda _: None,
    )  # fmt: skip


@DIMENSIONS
def test_the_time_scheme_keeps_the_angular_momentum_of_a_stroke(dimension: int) -> None:
    """If it was the same at three times, nothing is left for the fluid to do."""
    motions, _ = carried(dimension)
    moments = []
    kept = angular_momentum(motions, motions.pose.orientation, motions.twist.angular_velocity, 0.0)
    for time in (0.1, 0.15, 0.25):
        orientation = rotate(motions.pose.orientation, time * motions.twist.angular_velocity)
        left = kept - turned(orientation, motions.spin(time))
        spin = np.einsum("nij,nj->ni", inverse_lab_inertia(motions.inertia(time), orientation), left)
        moments.append((time, Pose(motions.pose.position, orientation), Twist(motions.twist.velocity, spin)))
    time, pose, twist = moments[2]
    none = Wrench(np.zeros((3, dimension)), np.zeros_like(kept))
    step = step_to(system_of(motions, dimension), state_of(motions, moments[:2]), StepEnd(time, 0.1, pose, none))
    lacking = np.einsum("nij,nj->ni", step.mass_matrix, flat(twist)) - step.load
    np.testing.assert_allclose(lacking, 0.0, atol=1e-11 * np.abs(step.load).max())


@DIMENSIONS
def test_impulses_of_contacts_change_momenta_at_once_and_applied_wrenches_steadily(dimension: int) -> None:
    """In steps of .05 and .1, without relative motion."""
    motions, _ = carried(dimension, stroke=0.0)
    motions.driven = False
    rows = split(np.random.default_rng(8).normal(size=flat(motions.twist).shape), dimension)
    impulse, still = Wrench(rows.velocity, rows.angular_velocity), motions.pose
    mass = (
        np.linalg.inv(motions.inertia(0.0))
        if dimension == 2
        else inverse_lab_inertia(motions.inertia(0.0), still.orientation)
    )

    def pushed(twist: Twist, wrench: Wrench, time: float) -> Twist:
        by_torque = np.einsum("nij,nj->ni", mass, wrench.torque)
        velocity = twist.velocity + time * wrench.force / motions.mass[:, None]
        return Twist(velocity, twist.angular_velocity + time * by_torque)

    def lacking(twists: list[Twist], end: StepEnd, **keys: Any) -> FloatArray:
        state = state_of(motions, [(0.1, still, twists[0]), (0.15, still, twists[1])], **keys)
        step = step_to(system_of(motions, dimension), state, end)
        found = np.einsum("nij,nj->ni", step.mass_matrix, flat(twists[2])) - step.load
        return np.asarray(np.abs(found).max() / np.abs(step.load).max())

    none = Wrench(np.zeros_like(impulse.force), np.zeros_like(impulse.torque))
    start = motions.twist
    hit = pushed(start, impulse, 1.0)
    assert lacking([start, start, hit], StepEnd(0.25, 0.1, still, impulse)) < 1e-12
    latest = Wrench(impulse.force / 0.05, impulse.torque / 0.05)
    assert lacking([start, hit, hit], StepEnd(0.25, 0.1, still, none), contact=latest) < 1e-12
    outside = Wrench(np.zeros((5, dimension)), np.zeros((5, impulse.torque.shape[1])))
    outside.force[0], outside.torque[:] = impulse.force[0], np.arange(5)[:, None]
    on_motions = motions.kinematics(still, 0.15).motion_wrench(outside)
    once = pushed(start, on_motions, 0.05)
    keys = {"applied": outside, "before": on_motions}
    assert lacking([start, once, pushed(once, on_motions, 0.1)], StepEnd(0.25, 0.1, still, none), **keys) < 1e-12
