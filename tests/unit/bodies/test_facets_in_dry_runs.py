"""Polygons and polyhedra that fall, lie, tip over and pile up without a fluid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from facet_shapes import CUBE, L_SHAPE, SQUARE, TRIANGLES, binary_stl
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene

ELASTIC = {"law": "contact", "epsilon": "auto", "range": 0.02}
BOX = (0.2 * np.array(SQUARE)).tolist()
TOOTH = ((0.0, 0.12), (0.25, 0.12), (0.35, 0.17), (0.65, 0.17), (0.75, 0.12))
"""Corners of a tooth: part of the turn to the next, and radius."""


def block(corners: Any, position: list[float], angle: float = 0.0) -> dict[str, Any]:
    return {"type": "polygon", "points": corners, "position": position, "angle": angle, "density": 1.0}


def energies(scene: Scene) -> tuple[Simulation, np.ndarray, float]:
    """The run at its end, its energy after each step, and the most kinetic energy of all."""
    simulation, total, fastest = Simulation(scene, None, False), [], 0.0
    while not simulation.ended:
        state, system = simulation.step(), simulation.system
        kinetic = 0.5 * system.mass @ np.sum(state.twist.velocity**2, axis=1)
        spin = state.twist.angular_velocity
        turning = 0.5 * np.einsum("nk,nkl,nl->", spin, system.inertia, spin)  # of squares and cubes in any frame
        assert system.law is not None
        total.append(kinetic + turning - np.sum(system.weight * state.pose.position))
        total[-1] += system.law.energy(state.contacts).sum()
        fastest = max(fastest, kinetic + turning)
    return simulation, np.array(total), fastest


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_a_square_dropped_flat_never_turns_and_keeps_its_energy(stepping: str) -> None:
    scene = dry_scene({**ELASTIC, "stepping": stepping}, block(BOX, [0.5, 0.3]), end=1.0, step=0.01, gravity=[0, -1.0])
    simulation, energy, most = energies(scene)
    assert abs(simulation.state.pose.orientation[0, 0]) < 1e-12
    assert simulation.state.pose.position[0, 0] == pytest.approx(0.5, abs=1e-12)
    assert np.ptp(energy) < 1e-3 * most


@pytest.mark.parametrize(("stepping", "share"), [("substeps", 1e-3), ("implicit", 1e-9)])
def test_a_square_dropped_on_a_corner_tips_over_and_keeps_its_energy(stepping: str, share: float) -> None:
    scene = dry_scene(
        {**ELASTIC, "stepping": stepping}, block(BOX, [0.5, 0.3], 0.6), end=1.0, step=0.01, gravity=[0, -1.0]
    )
    simulation, energy, most = energies(scene)
    assert abs(simulation.state.twist.angular_velocity[0, 0]) > 1.0
    assert np.ptp(energy) < share * most


@pytest.mark.long
def test_a_square_in_a_damped_contact_comes_to_lie_flat() -> None:
    law = {"law": "spring-dashpot", "range": 0.02, "stiffness": 40.0, "restitution": 0.2}
    scene = dry_scene(law, block(BOX, [0.5, 0.16], 0.2), end=3.0, step=0.01, gravity=[0, -1.0])
    simulation, energy, _ = energies(scene)
    assert np.all(np.diff(energy) < 1e-9)
    assert abs(simulation.state.pose.orientation[0, 0]) < 1e-3
    assert abs(simulation.state.twist.angular_velocity[0, 0]) < 1e-3
    lying = simulation.state.contacts.gap[:2]
    assert np.ptp(lying) < 1e-3 * lying.mean()


@pytest.mark.long
def test_a_pile_of_several_shapes_keeps_its_energy() -> None:
    bodies = [
        block((0.15 * np.array(L_SHAPE)).tolist(), [0.3, 0.3], 0.3),
        block((0.15 * np.array(SQUARE)).tolist(), [0.35, 0.65], 0.2),
        ball([0.7, 0.25], [0.1, 0.0]),
        ball([0.55, 0.85], [-0.3, 0.0]),
    ]
    simulation, energy, most = energies(dry_scene(ELASTIC, *bodies, end=0.8, step=0.01, gravity=[0, -1.0]))
    assert np.ptp(energy) < 1e-3 * most
    assert simulation.state.contacts.gap.min() > 0


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_squares_that_lie_on_each_other_create_no_energy(stepping: str) -> None:
    law = {"law": "barrier", "range": 0.02, "epsilon": 1e-3, "stepping": stepping}
    squares = block(BOX, [0.5, 0.11]), block(BOX, [0.5, 0.32])
    _, energy, most = energies(dry_scene(law, *squares, end=0.05, step=0.004, gravity=[0.0, -9.81]))
    assert np.ptp(energy) < 1e-3 * most


def gear(teeth: int) -> list[list[float]]:
    """Corners of a wheel with teeth that narrow outwards."""
    corners = [(tooth + turn, radius) for tooth in range(teeth) for turn, radius in TOOTH]
    turned = [(2.0 * np.pi * turn / teeth, radius) for turn, radius in corners]
    return [[radius * float(np.cos(angle)), radius * float(np.sin(angle))] for angle, radius in turned]


@pytest.mark.long
def test_gears_keep_their_energy_in_implicit_steps_of_any_length() -> None:
    """A tooth meets several sides, and a step that loses sight of one, or turns too far for one force, is shortened."""
    law = {"law": "normal", "range": 0.02, "epsilon": 1e-7, "stepping": "implicit"}
    turning = {"free": ["rotation"], "density": 1.0}
    first = block(gear(6), [0.35, 0.5]) | turning | {"angular_velocity": [20.0]}
    second = block(gear(6), [0.66, 0.5], 0.5) | turning
    simulation, energy, most = energies(dry_scene(law, first, second, end=0.06, step=0.004))
    assert abs(simulation.state.twist.angular_velocity[1, 0]) > 1.0
    assert np.ptp(energy) < 1e-4 * most


def test_a_cube_dropped_flat_lies_on_four_corners(tmp_path: Path) -> None:
    file = binary_stl(tmp_path / "cube.stl", CUBE, TRIANGLES)
    cube = {"type": "stl", "file": str(file), "scale": 0.2, "density": 1.0, "position": [0.5, 0.5, 0.15]}
    scene = dry_scene({**ELASTIC, "stepping": "implicit"}, cube, end=0.5, step=0.01, gravity=[0, 0, -1.0])
    simulation, energy, most = energies(scene)
    assert np.linalg.norm(simulation.state.twist.angular_velocity) < 1e-9
    assert np.ptp(energy) < 1e-9 * most


def test_a_square_dropped_flat_onto_an_obstacle_of_facets_does_not_turn() -> None:
    """The ledge is the arm of an L, which belongs to the domain."""
    table = {"type": "polygon", "points": (0.25 * np.array(L_SHAPE)).tolist(), "position": [0.5, 0.3]}
    domain = {"type": "channel", "lower": [0.0, 0.0], "upper": [1.0, 1.0], "obstacle": [table]}
    scene = scene_from_dict(
        dry_tables(block(BOX, [0.65, 0.55]), end=0.8, fluid={"gravity": [0.0, -1.0]}, domain=domain, contact=ELASTIC)
    )
    simulation, energy, most = energies(scene)
    assert simulation.system.detector.name == "facets"
    assert abs(simulation.state.pose.orientation[0, 0]) < 1e-12
    assert np.ptp(energy) < 1e-3 * most
    assert most > 1e-3


def test_a_scene_with_overlapping_polygons_is_refused() -> None:
    from rigidfluid.core.case.system import build_system
    from rigidfluid.errors import SceneError

    bar = (np.array([[-1.0, -0.1], [1.0, -0.1], [1.0, 0.1], [-1.0, 0.1]]) * 0.2).tolist()
    crossed = dry_scene(ELASTIC, block(bar, [0.5, 0.5]), block(bar, [0.5, 0.5], 1.5), end=1.0, step=0.1)
    with pytest.raises(SceneError, match=r"body\.0\.position: .* overlaps body 'body1'"):
        build_system(crossed)
    sunk = dry_scene(ELASTIC, ball([0.5, 0.8], [0, 0]), block(BOX, [0.5, 0.12], 0.6), end=1.0, step=0.1)
    with pytest.raises(SceneError, match=r"body\.1\.position: .* overlaps surface 'bottom'"):
        build_system(sunk)
