"""Gases of balls, followed in compiled substeps and one by one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.path import substep_path
from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.model.state import State
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene


def gas(
    law: dict[str, Any], dimension: int, side: int, substeps: int | None, step: float = 0.05, **contact: Any
) -> Scene:
    """Balls of different sizes on a lattice, which fly and spin at random."""
    random = np.random.default_rng(7)
    places = np.stack(np.meshgrid(*[np.arange(side)] * dimension), axis=-1).reshape(-1, dimension) + 0.5
    bodies = [
        {
            "type": "sphere",
            "radius": random.uniform(0.35, 0.46),
            "density": random.uniform(1.0, 3.0),
            "position": place,
            "velocity": (0.5 * random.normal(size=dimension)).tolist(),
            "angular_velocity": random.normal(size=dimension).tolist() if dimension == 3 else float(random.normal()),
        }
        for place in places.tolist()
    ]
    fluid = {"backend": "dry", "gravity": [0.0] * (dimension - 1) + [-3.0]}
    domain = {"lower": [0.0] * dimension, "upper": [float(side)] * dimension}
    tables = dry_tables(*bodies, fluid=fluid, domain=domain, end=10.0, step=step)
    tables["contact"] = law | {"range": 0.05} | contact | ({"substeps": substeps} if substeps else {})
    return scene_from_dict(tables)


Run = tuple[State, BodyStep]
"""State after some steps, and the path of the last one."""


def both_ways(scene: Scene, monkeypatch: pytest.MonkeyPatch, steps: int, maker: str = "ball_substeps") -> list[Run]:
    """The run after some steps in compiled substeps by this ``maker``, and one by one."""
    runs, compiled = [], getattr(substep_path, maker)
    makers: list[Callable[..., Any]] = [compiled, lambda *_: None]
    for each in makers:
        monkeypatch.setattr(substep_path, maker, each)
        run = Simulation(scene, None, False)
        for _ in range(steps):
            path = scheme_of(run.system).follow(run.state, run.time, run.clock.size(0), None)
            run.step()
        runs.append((run.state, path))
    return runs


FIELDS = [
    *(("pose", field) for field in ("position", "orientation")),
    *(("twist", field) for field in ("velocity", "angular_velocity")),
    *(("impulse", field) for field in ("force", "torque")),
]


def assert_same(runs: list[Run]) -> None:
    """Poses, twists, impulses and energies are the same but for rounding."""
    (state, path), (expected, slow) = runs
    assert path.substeps == slow.substeps > 1
    assert np.any(slow.impulse.force)
    pairs = [(getattr(getattr(path, one), two), getattr(getattr(slow, one), two)) for one, two in FIELDS]
    for found, other in [*pairs, (path.dissipated, slow.dissipated), (path.actuator_work, slow.actuator_work)]:
        np.testing.assert_allclose(found, other, rtol=0, atol=1e-11 * np.abs(other).max() + 1e-12)
    np.testing.assert_allclose(state.pose.position, expected.pose.position, rtol=0, atol=1e-11)
