"""Swarms keep their gaps, reach their fraction, and are the same by their seed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from facet_shapes import CUBE, TRIANGLES, text_stl
from jsonschema import Draft7Validator
from swarms import (
    BALL,
    DISK,
    ELLIPSE,
    ELLIPSOID,
    SQUARE,
    least_gap,
    least_gap_of_balls,
    radii,
    seeded,
    start,
    swarm_tables,
)

from rigidfluid import Scene, load_results, scene_from_dict
from rigidfluid.checks import check
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.run.run import simulate
from rigidfluid.post.insertion import insert


def record(scene: Scene) -> Any:
    found = scene.swarm[0].seeded
    assert found is not None
    return found


def test_the_same_seed_gives_the_same_bodies_and_another_one_others() -> None:
    first, same, other = (seeded(2, DISK, fraction=0.6, seed=seed) for seed in (3, 3, 4))
    assert first == same
    assert not np.allclose(start(first).position, start(other).position[: len(first.body)], atol=0.01)


@pytest.mark.parametrize(("dimension", "shape"), [(2, DISK), (3, BALL)])
def test_thin_swarms_are_inserted_with_their_gap(dimension: int, shape: dict[str, Any]) -> None:
    scene = seeded(dimension, shape, fraction=0.2, gap=0.01)
    assert record(scene).way == "insertion"
    assert 0.01 <= least_gap_of_balls(scene) == pytest.approx(record(scene).gap)


@pytest.mark.parametrize(
    ("dimension", "shape", "fraction"), [(2, DISK, 0.75), (3, BALL | {"radius": 0.1}, 0.5)], ids=["disks", "balls"]
)
def test_dense_swarms_of_balls_reach_their_fraction(dimension: int, shape: dict[str, Any], fraction: float) -> None:
    scene = seeded(dimension, shape, fraction=fraction)
    ball = np.pi * shape["radius"] ** 2 if dimension == 2 else 4.0 / 3.0 * np.pi * shape["radius"] ** 3
    assert abs(len(scene.body) * ball - fraction) <= 0.5 * ball
    assert record(scene).way == "growth"
    assert least_gap_of_balls(scene) >= 0.01 * shape["radius"]


def test_few_balls_in_a_box_are_shaken_until_they_fit() -> None:
    """These are stuck below a fraction of .5 if they only grow."""
    radius = float(np.cbrt(0.5 / 50 * 0.75 / np.pi))
    scene = seeded(3, BALL | {"radius": radius}, number=50, seed=5)
    assert least_gap_of_balls(scene) >= 0.01 * radius


@pytest.mark.parametrize(
    ("dimension", "shape", "fraction"),
    [
        pytest.param(2, ELLIPSE, 0.65, marks=pytest.mark.long),
        (2, SQUARE, 0.4),
        (3, ELLIPSOID | {"semi_axes": [0.3, 0.2, 0.15]}, 0.3),
    ],
    ids=["ellipses", "squares", "ellipsoids"],
)
def test_the_naive_detector_finds_no_smaller_gap(dimension: int, shape: dict[str, Any], fraction: float) -> None:
    scene = seeded(dimension, shape, fraction=fraction, gap=0.002)
    assert record(scene).fraction == pytest.approx(fraction, abs=0.02)
    assert least_gap(scene, 0.002) >= 0.002 * (1.0 - 1e-6)
    assert record(scene).gap >= 0.002


def test_sizes_scale_all_lengths_of_shapes() -> None:
    size = {"distribution": "table", "rows": [[0.5, 1.0]]}
    scene = seeded(2, DISK, ELLIPSE, SQUARE, number=12, size=size)
    smaller = {
        "radius": 0.025,
        "semi_axes": (0.04, 0.02),
        "points": [[0.0, 0.0], [0.05, 0.0], [0.05, 0.05], [0.0, 0.05]],
    }
    for body in scene.body:
        for key, value in body.options.items():
            np.testing.assert_allclose(value, smaller[key])


def test_bodies_from_files_are_scaled_too(tmp_path: Path) -> None:
    text_stl(tmp_path / "cube.stl", CUBE, TRIANGLES)
    shape = {"type": "stl", "file": str(tmp_path / "cube.stl"), "scale": 0.2}
    scene = seeded(3, shape, number=4, size={"distribution": "table", "rows": [[0.5, 1.0]]})
    assert [body.options["scale"] for body in scene.body] == [0.1] * 4
    assert record(scene).fraction == pytest.approx(4 * 0.1**3)


def test_a_swarm_avoids_listed_bodies_and_the_swarm_before_it() -> None:
    listed = {"type": "sphere", "radius": 0.2, "density": 1.0, "position": [0.5, 0.5]}
    tables = swarm_tables(2, DISK, fraction=0.4, tables={"body": [listed]})
    tables["swarm"].append(tables["swarm"][0] | {"name": "dust", "shape": [DISK | {"radius": 0.02}], "fraction": 0.1})
    scene = scene_from_dict(tables)
    assert [body.name for body in scene.body[:2]] == ["body0", "grain0"]
    assert scene.body[-1].name.startswith("dust")
    assert least_gap_of_balls(scene) >= 0.01 * 0.02
    np.testing.assert_array_equal(start(scene).position[0], [0.5, 0.5])


@pytest.mark.parametrize("shape", [DISK, pytest.param(ELLIPSE, marks=pytest.mark.long)], ids=["disks", "ellipses"])
def test_swarms_keep_clear_of_round_obstacles(shape: dict[str, Any]) -> None:
    pin = {"type": "sphere", "radius": 0.2, "position": [0.5, 0.5]}
    channel = {"type": "channel", "lower": [0.0, 0.0], "upper": [1.0, 1.0], "obstacle": [pin]}
    scene = seeded(2, shape, fraction=0.45, gap=0.003, tables={"domain": channel})
    assert record(scene).fraction == pytest.approx(0.45, abs=0.01)
    assert least_gap(scene, 0.003) >= 0.003 * (1.0 - 1e-6)


def test_a_box_holds_all_of_each_body() -> None:
    region = {"type": "box", "lower": [0.2, 0.1], "upper": [0.8, 0.5]}
    scene = seeded(2, DISK | {"radius": 0.03}, fraction=0.6, region=region)
    position = start(scene).position
    assert np.all((position >= [0.23, 0.13]) & (position <= [0.77, 0.47]))
    assert abs(len(scene.body) * np.pi * 0.03**2 / 0.24 - 0.6) <= 0.5 * np.pi * 0.03**2 / 0.24


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_cylinder_holds_all_of_each_ball(dimension: int) -> None:
    region: dict[str, Any] = {"type": "cylinder", "start": [0.5] * dimension, "radius": 0.4}
    if dimension == 3:
        region |= {"start": [0.5, 0.5, 0.2], "end": [0.5, 0.5, 0.9]}
    scene = seeded(dimension, BALL | {"radius": 0.06}, fraction=0.45, region=region)
    position = start(scene).position
    assert np.linalg.norm(position[:, :2] - 0.5, axis=1).max() <= 0.4 - 0.06
    assert record(scene).way == "growth"
    if dimension == 3:
        assert position[:, 2].min() >= 0.26
        assert position[:, 2].max() <= 0.84


def test_a_region_is_the_inside_of_a_surface_from_a_file(tmp_path: Path) -> None:
    text_stl(tmp_path / "cube.stl", CUBE, TRIANGLES)
    region = {"type": "file", "file": str(tmp_path / "cube.stl"), "scale": 0.5}
    scene = seeded(3, BALL, fraction=0.3, region=region)
    assert start(scene).position.max() <= 0.42
    assert record(scene).fraction == pytest.approx(0.3, abs=0.5 * 4.0 / 3.0 * np.pi * 0.08**3 / 0.125)


def test_the_scene_of_results_has_the_bodies_and_is_not_seeded_again() -> None:
    scene = seeded(2, DISK, number=5)
    again = scene_from_dict(scene.to_dict())
    assert again == scene
    assert len(again.body) == 5


def test_a_check_tells_number_fraction_and_gap() -> None:
    scene = seeded(2, DISK, number=5)
    note = next(finding for finding in check(scene).findings if finding.question == "swarm")
    assert note.subject == ("grain",)
    assert note.found["number"] == 5
    assert note.text.startswith("5 bodies fill 3.93 % of their region, with gaps of at least 0.0")


def test_a_dense_swarm_starts_and_keeps_its_energy() -> None:
    tables = swarm_tables(2, DISK, fraction=0.7, gap=0.004, velocity_deviation=0.1)
    tables |= {"contact": {"law": "normal", "range": 0.004, "epsilon": 1e-6}}
    tables |= {"time": {"end": 0.2, "step": 0.002}, "output": {"every": 0.2}}
    energy = simulate(scene_from_dict(tables)).energy
    total = energy["kinetic"] + energy["contact"]
    np.testing.assert_allclose(total, total[0], rtol=1e-3)
    assert energy["contact"].max() > 0.1 * total[0]


def test_radii_of_a_swarm_follow_its_sizes() -> None:
    size = {"distribution": "uniform", "least": 0.5, "greatest": 1.0}
    found = radii(seeded(2, DISK, number=40, size=size))
    assert (found.min() >= 0.025) & (found.max() <= 0.05)
    assert np.ptp(found) > 0.02


def test_a_run_is_resumed_from_a_scene_that_is_seeded_again(tmp_path: Path) -> None:
    tables = swarm_tables(2, DISK, fraction=0.3, velocity_deviation=0.1)
    tables |= {"contact": {"law": "barrier", "range": 0.01, "epsilon": 1e-4}, "output": {"every": 0.05}}
    whole = simulate(scene_from_dict(tables | {"time": {"end": 0.1, "step": 0.01}}), tmp_path / "whole")
    again = simulate(scene_from_dict(tables | {"time": {"end": 0.1, "step": 0.01}}), tmp_path / "whole", resume=True)
    np.testing.assert_array_equal(whole.bodies["x"], again.bodies["x"])
    found = load_results(tmp_path / "whole").scene
    assert found is not None
    assert found.swarm[0].seeded == record(scene_from_dict(tables))


def test_a_swarm_is_inserted_into_a_mesh_with_its_picture(tmp_path: Path) -> None:
    wet = {"fluid": {"density": 1.0, "viscosity": 0.1}, "mesh": {"size": 0.3, "size_body": 0.1}}
    _, files = insert(seeded(2, DISK | {"radius": 0.1}, number=4, gap=0.05, tables=wet), tmp_path / "mesh")
    assert (tmp_path / "mesh" / "mesh.png") in files


def test_swarms_fit_the_schema() -> None:
    region = {"type": "box", "lower": [0.0, 0.0], "upper": [1.0, 1.0]}
    size = {"distribution": "uniform", "least": 0.5, "greatest": 1.0}
    tables = swarm_tables(2, DISK, ELLIPSE | {"weight": 2.0}, number=3, region=region, size=size)
    schema = Draft7Validator(json_schema())
    assert list(schema.iter_errors(tables)) == []
    assert list(schema.iter_errors(scene_from_dict(tables).to_dict())) == []
    tables["swarm"][0]["shape"] = [DISK | {"raduis": 0.1}]
    assert len(list(schema.iter_errors(tables))) > 0
