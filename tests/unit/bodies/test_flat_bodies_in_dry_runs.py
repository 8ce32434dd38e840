"""Flat sides on flat sides: blocks slide by Coulomb's law, walls of bricks stand, dominoes fall, gears turn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from domino_waves import TIPPED, front_speeds, lean_of, measured_speeds
from dry_scenes import dry_scene
from facet_shapes import CUBE, TRIANGLES, binary_stl
from flat_bodies import DOMINO_STEP, GAP, GRAVITY, HEIGHT, THICKNESS, brick_wall, domino_row, gear_pair
from slopes import FRICTION, block_on_slope

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene


def stepped(simulation: Simulation, time: float) -> None:
    while time_of(simulation) < time * (1.0 - 1e-9):
        simulation.step()


def time_of(simulation: Simulation) -> float:
    return simulation.clock.time(simulation.state.tick)


def test_a_block_slides_down_a_slope_as_coulomb_says() -> None:
    """g (sin α - μ cos α), once the springs along the surfaces slip."""
    simulation = Simulation(block_on_slope(1.5, end=0.5), None, False)
    stepped(simulation, 0.2)
    before = simulation.state.twist.velocity[0, 0]
    stepped(simulation, 0.4)
    angle = np.arctan(1.5 * FRICTION)
    expected = GRAVITY * (np.sin(angle) - FRICTION * np.cos(angle))
    assert (simulation.state.twist.velocity[0, 0] - before) / 0.2 == pytest.approx(expected, rel=1e-3)
    assert abs(simulation.state.pose.orientation[0, 0]) < 0.03


def moved_after(scene: Scene, settled: float, time: float) -> tuple[float, float]:
    """Farthest way of a body's centre over the brick's height, and greatest speed, in a ``time`` after it has
    settled."""
    simulation = Simulation(scene, None, False)
    stepped(simulation, settled)
    place = simulation.state.pose.position
    stepped(simulation, settled + time)
    state = simulation.state
    return float(np.abs(state.pose.position - place).max()) / HEIGHT, float(np.abs(state.twist.velocity).max())


@pytest.mark.long
def test_three_bricks_stay_on_each_other() -> None:
    moved, speed = moved_after(brick_wall(0.3, (2, 1)), 0.2, 0.1)
    assert moved < 1e-3
    assert speed < 1e-3


@pytest.mark.long
@pytest.mark.nightly
def test_a_wall_of_ten_bricks_stands() -> None:
    moved, speed = moved_after(brick_wall(1.7), 0.7, 1.0)
    assert moved < 1e-3
    assert speed < 1e-4


def fallen(scene: Scene) -> tuple[FloatArray, FloatArray, Simulation]:
    """Times of the steps, and angles by which the dominoes lean, until the last one falls."""
    simulation = Simulation(scene, None, False)
    times, lean = [0.0], [-simulation.state.pose.orientation[:, 0]]
    while not simulation.ended and lean[-1][-1] < 2.0 * TIPPED:
        state = simulation.step()
        times.append(time_of(simulation))
        lean.append(-state.pose.orientation[:, 0])
    return np.array(times), np.array(lean), simulation


@pytest.mark.long
def test_dominoes_fall_as_fast_as_the_root_of_gravity() -> None:
    """v = √(g h) f(distance/h) by their similarity (McLachlan et al., SIAM Rev. 25 (1983) 403)."""
    slow, fast = (fallen(domino_row(2, 0.6, gravity))[0][-1] for gravity in (GRAVITY, 4.0 * GRAVITY))
    assert slow > 0.3
    assert fast == pytest.approx(0.5 * slow, rel=0.0, abs=1.01 * DOMINO_STEP)


def test_without_friction_forces_between_dominoes_do_no_work() -> None:
    lean = lean_of(0.2, 6, THICKNESS, GAP, friction=0.0)
    np.testing.assert_allclose(lean.lever, lean.rate, rtol=1e-12)
    turned = [lean_of(angle, 6, THICKNESS, GAP, friction=0.0) for angle in (0.2 - 1e-5, 0.2 + 1e-5)]
    np.testing.assert_allclose((turned[1].angle - turned[0].angle) / 2e-5, lean.rate, rtol=1e-8)
    np.testing.assert_allclose((turned[1].rate - turned[0].rate) / 2e-5, lean.bend, atol=1e-7)


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, pytest.param(0.3, marks=pytest.mark.nightly)])
def test_a_row_of_dominoes_falls_at_the_published_speed(friction: float) -> None:
    """Van Leeuwen's theory; after a dozen dominoes the start is forgotten."""
    times, lean, simulation = fallen(domino_row(16, 4.0, friction=friction))
    speed = measured_speeds(times, lean, GAP + THICKNESS, GRAVITY)
    np.testing.assert_allclose(speed[-2:], front_speeds(THICKNESS, GAP, friction, 15)[-2:], rtol=0.01)
    assert abs(simulation.state.ledger.residual) < 5e-3 * 16 * 0.12 * GRAVITY


@pytest.mark.long
def test_a_gear_pair_turns_with_the_ratio_of_its_teeth() -> None:
    """The second wheel has no load and flies on from tooth to tooth; it never leaves the play of the teeth."""
    simulation = Simulation(gear_pair((12, 18), 4.0, 0.8), None, False)
    start, apart = simulation.state.pose.orientation[:, 0], []
    while not simulation.ended:
        turned = simulation.step().pose.orientation[:, 0] - start
        apart.append(turned[1] + turned[0] * 12 / 18)
    assert turned[0] == pytest.approx(3.2)
    assert np.abs(apart).max() < 0.15 * 2.0 * np.pi / 18


STICKING = {
    "law": "spring-dashpot",
    "stiffness": 10.0,
    "restitution": 0.3,
    "friction": 0.5,
    "tangential_stiffness": 8.0,
}
HIGH = 0.35 + 0.02 - 3e-4
"""Height of the centre of a cube of side .2 that lies on another one, whose centre is at .15 [length]."""


def cube_on_cube(
    folder: Path, law: dict[str, Any], place: list[float], turn: list[float], end: float, pull: float = 0.0
) -> Simulation:
    """A fixed cube, and one above it at a ``place``, turned by a rotation vector; gravity is (pull, 0, -1)."""
    file = str(binary_stl(folder / "cube.stl", CUBE, TRIANGLES))
    cube = {"type": "stl", "file": file, "scale": 0.2, "density": 1.0}
    fixed = cube | {"position": [0.5, 0.5, 0.15], "prescribed": {"velocity": [0.0, 0.0, 0.0]}}
    orientation = rotate(np.eye(1, 4), np.array([turn]))[0].tolist()
    free = cube | {"position": place, "orientation": orientation}
    scene = dry_scene(law | {"range": 0.02}, fixed, free, end=end, step=4e-3, gravity=[pull, 0.0, -1.0])
    return Simulation(scene, None, False)


@pytest.mark.parametrize("stepping", [pytest.param("substeps", marks=pytest.mark.long), "implicit"])
def test_a_cube_that_tumbles_on_a_cube_keeps_its_energy(stepping: str, tmp_path: Path) -> None:
    """Edges of both pass each other, and cease to."""
    law = {"law": "normal", "epsilon": "auto", "stepping": stepping}
    simulation = cube_on_cube(tmp_path, law, [0.53, 0.52, 0.45], [0.24, 0.256, 0.192], end=0.6)
    stepped(simulation, 0.6)
    state = simulation.state
    assert np.linalg.norm(state.twist.angular_velocity[1]) > 0.2
    assert abs(state.ledger.residual) < 1e-3 * abs(state.ledger.gravity)


@pytest.mark.long
@pytest.mark.nightly
def test_a_turned_cube_rests_on_a_cube(tmp_path: Path) -> None:
    simulation = cube_on_cube(tmp_path, STICKING, [0.53, 0.52, HIGH], [0.0, 0.0, 0.3], end=0.8)
    stepped(simulation, 0.8)
    assert np.linalg.norm(simulation.state.twist.velocity[1]) < 1e-6
    assert np.linalg.norm(simulation.state.twist.angular_velocity[1]) < 1e-6


@pytest.mark.long
def test_a_cube_slides_off_a_cube_as_coulomb_says(tmp_path: Path) -> None:
    """Friction tilts it a little on its soft contacts, and with it their normals."""
    simulation = cube_on_cube(tmp_path, STICKING, [0.5, 0.5, HIGH], [0.0, 0.0, 0.0], end=0.4, pull=0.8)
    stepped(simulation, 0.2)
    before = simulation.state.twist.velocity[1, 0]
    stepped(simulation, 0.4)
    assert (simulation.state.twist.velocity[1, 0] - before) / 0.2 == pytest.approx(0.8 - 0.5, rel=0.01)
