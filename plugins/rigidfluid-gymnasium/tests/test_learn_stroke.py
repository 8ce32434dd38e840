"""The example: a stroke that swims, the policies that contain it, and the method that finds them."""

from __future__ import annotations

import numpy as np
import pytest
from learn_stroke import ELITE, KNOWN, POPULATION, learn, returns, swim, swimming, targets

from rigidfluid_gymnasium import FluidEnv


def test_the_known_stroke_swims_forwards_and_backwards_it_swims_back() -> None:
    """In Stokes flow the way is the same, but for the walls that the swimmer is nearer to."""
    env = FluidEnv(swimming("time.end=4"))
    way, lengths = swim(env, None)
    assert lengths.round(6).tolist() == [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]
    assert 0.1 < way < 0.15
    env.reset(seed=0)
    back = sum(env.step(action)[1] for action in KNOWN[[2, 1, 0, 3]])
    assert back == pytest.approx(-way, rel=0.05)


def test_policies_contain_the_known_stroke() -> None:
    """Each arm goes where the other one is, or is not."""
    policy = np.array([0.0, -9.0, 9.0, 0.0, 0.0, 0.0])
    lengths = 0.5 + 0.5 * np.roll(KNOWN, 1, axis=0)
    np.testing.assert_allclose(targets(np.tile(policy, (4, 1)), lengths), KNOWN, atol=1e-6)


class Likes:
    """Environments that reward actions near a ``wanted`` one, in episodes of two actions."""

    def __init__(self, wanted: list[float]) -> None:
        self.num_envs, self._wanted, self._count = 4, np.array(wanted), 0

    def reset(self, seed: int) -> tuple[np.ndarray, dict[str, object]]:
        self._count = 0
        return np.full((4, 2), 0.5), {}

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, object]]:
        self._count += 1
        reward = -np.abs(actions - self._wanted).sum(axis=1)
        return np.full((4, 2), 0.5), reward, np.zeros(4, dtype=bool), np.full(4, self._count == 2), {}


def test_the_method_finds_what_is_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    envs = Likes([0.5, -0.7])
    policy, curve = learn(envs, generations=20)  # type: ignore[arg-type]
    assert curve.shape == (20, POPULATION)
    assert curve[0].mean() < -1.0
    assert np.sort(curve[-1])[-ELITE:].mean() > -0.1
    assert returns(envs, np.tile(policy, (4, 1))) == pytest.approx(-0.0, abs=0.1)  # type: ignore[arg-type]
    assert "generation 20" in capsys.readouterr().out
