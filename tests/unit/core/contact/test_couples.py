"""Couples of laws on the bodies' path: by films that resist sliding and rolling, in substeps and implicit steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.output.history import History
from rigidfluid.forces.film_resistance import film_resistance

RADIUS, GAP, RANGE, VISCOSITY = 0.1, 2e-3, 0.02, 0.01
FILM = {"law": "lubrication", "range": RANGE, "cutoff": 1.5e-3, "viscosity": VISCOSITY, "sliding": True}
STEPPINGS = pytest.mark.parametrize("stepping", ["substeps", "implicit"])


def spin(history: History, dimension: int) -> np.ndarray:
    """Angular velocities of all rows (rows, k)."""
    return np.column_stack([history.bodies[name] for name in (["w"] if dimension == 2 else ["wx", "wy", "wz"])])


@pytest.mark.parametrize(("stepping", "within"), [("substeps", 1e-3), ("implicit", 2e-4)])
@pytest.mark.parametrize("dimension", [pytest.param(2, marks=pytest.mark.long), 3])
def test_a_ball_that_turns_at_a_wall_is_braked_by_force_and_couple(
    dimension: int, stepping: str, within: float
) -> None:
    """It is held in its place: I dω/dt = -(S l² + 2 Q l + W) μ ω, l the arm of the force and v = -l n × ω."""
    place = [0.5] * (dimension - 1) + [RADIUS + GAP]
    turning: Any = 3.0 if dimension == 2 else [0.0, 3.0, 0.0]
    free = ["rotation"] if dimension == 2 else ["rx", "ry", "rz"]
    disk = ball(place, [0.0] * dimension, angular_velocity=turning, free=free)
    history = rigidfluid.run(dry_scene(FILM | {"stepping": stepping}, disk, end=0.05, step=5e-4))
    film, end = (
        film_resistance(np.array([gap]), np.array([RADIUS]), np.array([np.inf]), dimension) for gap in (GAP, RANGE)
    )
    beyond, arm = film.beyond(end), RADIUS + 0.5 * GAP
    resistance = beyond.sliding[0] * arm**2 + 2.0 * arm * beyond.coupling[0] + beyond.rolling[0]
    inertia = 0.5 * np.pi * RADIUS**4 if dimension == 2 else 8.0 / 15.0 * np.pi * RADIUS**5
    expected = 3.0 * np.exp(-VISCOSITY * resistance / inertia * history.bodies["time"])
    assert expected[-1] < 2.9
    about = 0 if dimension == 2 else 1
    np.testing.assert_allclose(spin(history, dimension)[:, about], expected, rtol=within)
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-5


@STEPPINGS
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_pair_that_passes_and_turns_keeps_its_angular_momentum_and_its_energy_account(
    dimension: int, stepping: str
) -> None:
    rest = [0.0] * (dimension - 1)
    apart = np.array([2.0 * RADIUS + GAP, *rest])
    turning: Any = (5.0, -2.0) if dimension == 2 else ([1.0, 5.0, 2.0], [0.5, 0.0, -3.0])
    first = ball([0.5, *([0.5] * (dimension - 1))], [0.0, 0.4, *rest[1:]], angular_velocity=turning[0], density=2.0)
    second = ball(np.array(first["position"]) - apart, [0.0, -0.3, *rest[1:]], angular_velocity=turning[1])
    history = rigidfluid.run(dry_scene(FILM | {"stepping": stepping}, first, second, end=0.1, step=1e-3))
    bodies, volume = history.bodies, np.pi * RADIUS**2 if dimension == 2 else 4.0 / 3.0 * np.pi * RADIUS**3
    mass, arm = volume * np.array([2.0, 1.0]), 0.5 if dimension == 2 else 0.4
    axes = "xyz"[:dimension]
    place, velocity = (np.stack([bodies[kind + axis] for axis in axes], axis=1) for kind in ("", "v"))
    about = moment(place, velocity)
    own = arm * RADIUS**2 * spin(history, dimension)
    total = np.einsum("b,tbk->tk", mass, (about + own).reshape(-1, 2, own.shape[1]))
    scale = np.abs(mass @ (about + own).reshape(-1, 2, own.shape[1])[0]).max()
    np.testing.assert_allclose(total, total[:1].repeat(len(total), axis=0), rtol=0, atol=1e-9 * scale)
    changed = np.abs(own.reshape(-1, 2, own.shape[1])[-1] - own.reshape(-1, 2, own.shape[1])[0]).max()
    assert changed > 0.05 * arm * RADIUS**2 * 5.0
    energy = history.energy
    assert energy["contact_loss"][-1] > 0.02 * energy["kinetic"][0]
    assert np.all(np.diff(energy["contact_loss"]) >= 0.0)
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-4


def test_the_path_converges_with_second_order() -> None:
    def turned(step: float) -> float:
        first = ball([0.5, 0.5], [0.0, 0.4], angular_velocity=5.0)
        second = ball([0.5 - 2.0 * RADIUS - GAP, 0.5], [0.0, 0.0])
        scene = dry_scene(FILM | {"stepping": "implicit"}, first, second, end=0.08, step=step)
        return float(rigidfluid.run(scene).bodies["w"][-1])

    found = [turned(0.008 / 2**k) for k in range(4)]
    ratios = np.diff(found)[:-1] / np.diff(found)[1:]
    assert np.all(ratios > 3.2)
