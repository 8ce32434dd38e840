"""Contract tests of a law that knows poses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.mechanics.wrenches import add_pair_wrench, nothing
from rigidfluid.core.model.pose_law import PairPoses, PoseLaw
from rigidfluid.core.model.types import Pose

Column = Callable[[PairPoses], FloatArray]

_COUNT = 40


class PoseLawContract:
    """A long-range force between two bodies, which an energy of their poses gives.

    Override the fixture ``law``, which is asked in as many dimensions as the fixture ``dimension`` says.
    """

    least_fraction: ClassVar[float] = 0.2
    """The shortest distance at which the law is evaluated, as a part of the range."""

    @pytest.fixture(params=[2, 3])
    def dimension(self, request: pytest.FixtureRequest) -> int:
        """Both numbers of space dimensions."""
        return int(request.param)

    @pytest.fixture
    def law(self, dimension: int) -> PoseLaw:
        """The law under test, made for this ``dimension``."""
        raise NotImplementedError("override the fixture `law`")

    def test_zero_beyond_range(self, law: PoseLaw, dimension: int) -> None:
        """No energy, force and couple from the range on."""
        pairs = _pairs(law.range * np.array([1.0 + 1e-9, 1.001, 2.0, 1e6]), dimension)
        for column in (law.pair_energy, law.pair_force, law.pair_couple):
            assert not column(pairs).any()

    def test_fades_out_at_range(self, law: PoseLaw, dimension: int) -> None:
        """Energy, force and couple have no jump at range."""
        near, last = (_pairs(law.range * np.full(_COUNT, part), dimension) for part in (0.5, 1.0 - 1e-6))
        for column in (law.pair_energy, law.pair_force, law.pair_couple):
            assert column(near).any()
            assert np.abs(column(last)).max() < 1e-6 * np.abs(column(near)).max()

    def test_force_is_minus_the_slope_of_the_energy(self, law: PoseLaw, dimension: int) -> None:
        """F = -∂U/∂s, by a central difference of fourth order."""
        pairs, found = self._pairs_of(law, dimension), law.pair_force(self._pairs_of(law, dimension))
        for axis, direction in enumerate(np.eye(dimension)):
            slope = _slope(law.pair_energy, partial(_shifted, pairs, law.range * direction))
            np.testing.assert_allclose(found[:, axis], -slope / law.range, rtol=1e-6, atol=1e-7 * np.abs(found).max())

    def test_torques_are_minus_the_slopes_of_the_energy(self, law: PoseLaw, dimension: int) -> None:
        """T_a = C - ½ s × F = -∂U/∂(rotation of a) and T_b = -C - ½ s × F = -∂U/∂(rotation of b)."""
        pairs = self._pairs_of(law, dimension)
        force, couple = law.pair_force(pairs), law.pair_couple(pairs)
        for sign, name in ((1.0, "rotation_a"), (-1.0, "rotation_b")):
            torque = sign * couple - 0.5 * moment(pairs.separation, force)
            for axis in range(couple.shape[1]):
                slope = _slope(law.pair_energy, partial(_turned, pairs, name, np.eye(couple.shape[1])[axis]))
                np.testing.assert_allclose(torque[:, axis], -slope, rtol=1e-6, atol=1e-7 * np.abs(torque).max())

    def test_a_pair_gains_no_momentum(self, law: PoseLaw, dimension: int) -> None:
        """With ``core/mechanics/wrenches``, both wrenches have no resultant and no moment about any point."""
        pairs, random = self._pairs_of(law, dimension), np.random.default_rng(3)
        for separation, force, couple in zip(
            pairs.separation, law.pair_force(pairs), law.pair_couple(pairs), strict=True
        ):
            second, about = random.normal(size=(2, dimension))
            position = np.array([second + separation, second])
            pose = Pose(position, np.tile(np.eye(1, 1 if dimension == 2 else 4), (2, 1)))
            wrench = nothing(pose)
            add_pair_wrench(wrench, pose, (0, 1), force, couple)
            turning = wrench.torque + moment(position - about, wrench.force)
            scale = np.abs(wrench.force).max() + np.abs(turning).max()
            np.testing.assert_allclose(wrench.force.sum(axis=0), 0.0, rtol=0, atol=1e-13 * scale)
            np.testing.assert_allclose(turning.sum(axis=0), 0.0, rtol=0, atol=1e-12 * scale)

    def test_turns_with_the_frame(self, law: PoseLaw, dimension: int) -> None:
        """Rotating both bodies and their separation rotates force and couple, and leaves the energy."""
        pairs, rotation = self._pairs_of(law, dimension), _rotations(1, dimension, 5)[0]
        turned = PairPoses(pairs.separation @ rotation.T, rotation @ pairs.rotation_a, rotation @ pairs.rotation_b)
        couple = law.pair_couple(pairs)
        _assert_close(law.pair_energy(turned), law.pair_energy(pairs))
        _assert_close(law.pair_force(turned), law.pair_force(pairs) @ rotation.T)
        _assert_close(law.pair_couple(turned), couple if dimension == 2 else couple @ rotation.T)

    def test_stiffness_is_a_bound(self, law: PoseLaw, dimension: int) -> None:
        """|δᵀ U'' δ| ≤ κ_s |δs|² + κ_r (|δa|² + |δb|²), also with κ at any shorter distance."""
        pairs, random = self._pairs_of(law, dimension), np.random.default_rng(7)
        distance = np.linalg.norm(pairs.separation, axis=1)
        bounds = law.pair_stiffness(distance)
        shorter = law.pair_stiffness(0.5 * distance)
        assert np.all(shorter >= bounds)
        k = 1 if dimension == 2 else 3
        for _ in range(20):
            way, *turns = (random.normal(size=size) for size in (dimension, k, k))
            way *= law.range * random.choice([0.1, 1.0])

            def moved(step: float, way: FloatArray = way, turns: list[FloatArray] = turns) -> PairPoses:
                there = _shifted(pairs, way, step)
                for name, turn in zip(("rotation_a", "rotation_b"), turns, strict=True):
                    there = _turned(there, name, turn, step)
                return there

            step = 1e-4
            bent = law.pair_energy(moved(step)) - 2.0 * law.pair_energy(pairs) + law.pair_energy(moved(-step))
            most = bounds @ [way @ way, sum(turn @ turn for turn in turns)]
            assert np.all(np.abs(bent) / step**2 <= most * (1.0 + 1e-3))

    def test_pairs_do_not_influence_each_other(self, law: PoseLaw, dimension: int) -> None:
        """The order and the number of pairs change nothing, and none at all is allowed."""
        pairs = self._pairs_of(law, dimension)
        order = np.random.default_rng(7).permutation(len(pairs))[: len(pairs) // 2]
        for chosen in (order, order[:0]):
            some = PairPoses(pairs.separation[chosen], pairs.rotation_a[chosen], pairs.rotation_b[chosen])
            for column in (law.pair_energy, law.pair_force, law.pair_couple):
                np.testing.assert_allclose(column(some), column(pairs)[chosen], rtol=1e-13)

    def _pairs_of(self, law: PoseLaw, dimension: int) -> PairPoses:
        return _pairs(law.range * np.linspace(self.least_fraction, 0.99, _COUNT), dimension)


def _pairs(distance: FloatArray, dimension: int) -> PairPoses:
    count = len(distance)
    along = np.random.default_rng(2).normal(size=(count, dimension))
    along *= (distance / np.linalg.norm(along, axis=1))[:, None]
    return PairPoses(along, _rotations(count, dimension, 3), _rotations(count, dimension, 4))


def _rotations(count: int, dimension: int, seed: int) -> FloatArray:
    turns = np.random.default_rng(seed).normal(size=(count, 1 if dimension == 2 else 3))
    return np.array([_rotation_by(2.0 * turn) for turn in turns])


def _rotation_by(turn: FloatArray) -> FloatArray:
    """Rotation matrix (d, d) of a rotation vector (k,), by Rodrigues' formula."""
    angle = float(np.linalg.norm(turn))
    if len(turn) == 1:
        cosine, sine = np.cos(turn[0]), np.sin(turn[0])
        return np.array([[cosine, -sine], [sine, cosine]])
    x, y, z = turn / angle if angle > 0.0 else turn
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew)


def _shifted(pairs: PairPoses, way: FloatArray, step: float) -> PairPoses:
    return replace(pairs, separation=pairs.separation + step * way)


def _turned(pairs: PairPoses, name: str, turn: FloatArray, step: float) -> PairPoses:
    return replace(pairs, **{name: _rotation_by(step * turn) @ getattr(pairs, name)})


def _slope(energy: Column, moved: Callable[[float], PairPoses], step: float = 1e-4) -> FloatArray:
    """Derivative (m,) by a central difference of fourth order."""
    near = energy(moved(step)) - energy(moved(-step))
    wide = energy(moved(2.0 * step)) - energy(moved(-2.0 * step))
    return np.asarray((8.0 * near - wide) / (12.0 * step))


def _assert_close(found: FloatArray, expected: FloatArray) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
