"""Statistics of many bodies as columns of a run: against figures that are known, and against those of a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from falling import SCENES

import rigidfluid
from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.post.statistics import statistics

FIXED = {"name": "fixed", "type": "sphere", "radius": 0.1, "density": 1.0, "fixed": True}
SPRING = {"law": "spring-dashpot", "range": 0.02, "stiffness": 200.0}


def scene(*bodies: dict[str, Any], contact: dict[str, Any] = SPRING, end: float = 0.3, **more: Any) -> rigidfluid.Scene:
    tables = dry_scene(contact, *bodies, end=end, step=5e-3).model_dump(mode="json", exclude_none=True) | more
    return scene_from_dict(tables | {"output": {"every": 0.1, "statistics": True}})


def test_two_balls_that_touch_press_by_their_force_times_their_distance() -> None:
    """Of a spring's force of 2 at half its range along (.6, .8), in a unit box; a third ball is at a wall."""
    apart = 0.21 * np.array([0.6, 0.8])
    balls = [ball([0.4, 0.4], [1.0, 0.0]), ball((np.array([0.4, 0.4]) + apart).tolist(), [1.0, 0.0])]
    fixed = FIXED | {"position": [0.85, 0.5]}
    run = Simulation(scene(*balls, ball([0.885, 0.84], [-2.0, 0.0]), fixed))
    first = run.history.statistics
    assert first["bodies"][0] == 3
    assert first["volume_fraction"][0] == pytest.approx(3.0 * np.pi * 0.01)
    assert first["vx"][0] == pytest.approx(0.0)
    assert first["vx_fluctuation"][0] == pytest.approx(np.sqrt((1.0 + 1.0 + 4.0) / 3.0))
    assert first["vy_fluctuation"][0] == pytest.approx(0.0)
    assert first["least_gap"][0] == pytest.approx(0.01)
    assert first["least_wall_gap"][0] == pytest.approx(0.015)
    assert first["gap"][0] == pytest.approx((0.01 + 0.01 + 0.015) / 3.0)
    assert first["coordination"][0] == pytest.approx(2.0 / 3.0)
    assert first["contacts"][0] == 2
    assert first["contact_xy"][0] == 0.0
    run.step()
    now, place = run.history.statistics, run.state.pose.position
    force = 200.0 * (0.02 - now["least_gap"][1])
    way = place[1] - place[0]
    wanted = -force * np.outer(way, way) / np.linalg.norm(way)
    found = [[now[f"contact_{row}{column}"][1] for column in "xy"] for row in "xy"]
    np.testing.assert_allclose(found, wanted, rtol=1e-9)
    assert np.isnan([now["stress_xx"][1], now["relative_viscosity"][1]]).all()


def test_an_observer_reads_them_during_the_run() -> None:
    run, seen = Simulation(scene(ball([0.3, 0.3], [0.5, 0.0]), ball([0.7, 0.7], [0.0, 0.0]))), []
    run.observe(lambda now: seen.append(now.history.statistics["vx"][-1]))
    run.go(0.02)
    np.testing.assert_allclose(seen, 0.25)
    assert len(seen) == 4


def test_their_means_are_the_statistics_of_the_folder(tmp_path: Path) -> None:
    """With a pair that meets across periodic surfaces, and a body that is fixed."""
    places = [0.06, 0.3], [0.84, 0.33], [0.4, 0.3], [0.6, 0.55], [0.2, 0.7]
    balls = [ball(place, [0.6 - 1.2 * (n % 2 == 0), 0.2 * n - 0.4]) for n, place in enumerate(places)]
    sides = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]
    fixed = FIXED | {"position": [0.5, 0.88]}
    run = rigidfluid.run(scene(*balls, fixed, boundary=sides), tmp_path)
    found, _ = statistics(tmp_path, since=0.0)
    told, column = found.to_dict(), run.statistics
    assert len(column["step"]) == len(np.unique(run.bodies["step"])) == told["states"]
    assert np.abs(column["contact_xx"]).max() > 0.3
    assert set(column["contacts"].tolist()) == {1, 2}
    for key, names in {
        "velocity": ["vx", "vy"],
        "velocity_fluctuations": ["vx_fluctuation", "vy_fluctuation"],
        "gap": ["gap"],
    }.items():
        np.testing.assert_allclose([column[name].mean() for name in names], np.atleast_1d(told[key][0]), atol=1e-12)
    assert column["coordination"].mean() == pytest.approx(told["contacts"]["coordination"][0])
    assert column["volume_fraction"][0] == pytest.approx(told["volume_fraction"][0])
    for row in range(2):
        for other in range(2):
            wanted = told["contacts"]["stress"][0][row][other]
            assert column[f"contact_{'xy'[row]}{'xy'[other]}"].mean() == pytest.approx(wanted, abs=1e-12)


def test_pairs_across_periodic_surfaces_are_as_far_apart_as_their_images() -> None:
    sides = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]
    for places in (([0.08, 0.5], [0.87, 0.5]), ([0.61, 0.5], [0.4, 0.5])):
        run = Simulation(scene(*(ball(place, [0.0, 0.0]) for place in places), boundary=sides))
        run.step()
        now = run.history.statistics
        gap = now["least_gap"][-1]
        assert now["contact_xx"][-1] == pytest.approx(-200.0 * (0.02 - gap) * (0.2 + gap), rel=1e-9)
        assert 0.01 < gap < 0.02


def test_the_viscosity_of_a_sheared_cell_is_what_its_walls_feel() -> None:
    wanted = ["output.statistics=true", "fluid.viscosity=2"]
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "sheared_cell.toml", wanted))
    found, energy, volume = history.statistics, history.energy, 17.7245**2
    power = (energy["boundary"][-1] - energy["boundary"][0]) / (energy["time"][-1] - energy["time"][0])
    assert found["relative_viscosity"][-1] == pytest.approx(power / (2.0 * volume), rel=1e-8)
    assert found["stress_xy"][-1] == pytest.approx(history.stresslets["sxy"][-1] / volume, rel=1e-12)
    assert found["first_normal_difference"][-1] == pytest.approx(found["stress_xx"][-1] - found["stress_yy"][-1])
    assert np.isnan([found["relative_viscosity"][0], found["first_normal_difference"][0]]).all()


def test_bodies_that_go_with_a_shear_do_not_fluctuate() -> None:
    """Two disks at different heights, far from each other and from the walls, fall apart as the shear between them."""
    wanted = ["output.statistics=true", "body.0.position=[3, 5]"]
    scene = rigidfluid.load_scene(SCENES / "sheared_cell.toml", wanted).model_dump(mode="json", exclude_none=True)
    scene["body"].append(scene["body"][0] | {"name": "other", "position": [12.0, 13.0]})
    found = rigidfluid.run(scene_from_dict(scene))
    speeds = found.bodies["vx"][-2:]
    assert np.ptp(speeds) == pytest.approx(8.0, rel=0.05)
    assert found.statistics["vx_fluctuation"][-1] < 0.2


def test_rows_are_resumed_to_the_last_bit(tmp_path: Path) -> None:
    balls = ball([0.3, 0.3], [0.9, 0.5]), ball([0.7, 0.7], [0.0, 0.0])
    rigidfluid.run(scene(*balls), tmp_path / "whole")
    rigidfluid.run(scene(*balls, end=0.1), tmp_path / "parts")
    rigidfluid.run(scene(*balls), tmp_path / "parts", resume=True)
    whole, parts = ((tmp_path / name / "statistics.csv").read_bytes() for name in ("whole", "parts"))
    assert whole == parts
    assert whole.count(b"\n") == 62


def test_there_are_none_unless_they_are_wanted_and_while_no_body_moves() -> None:
    unwanted = dry_scene(SPRING, ball([0.3, 0.3], [0.5, 0.0]), end=0.02, step=5e-3)
    still = scene(FIXED | {"position": [0.3, 0.3]}, end=0.02)
    for one in (unwanted, still):
        assert len(rigidfluid.run(one).statistics["step"]) == 0
