"""What is wrong with a swarm is told by its field, with what is allowed and the remedy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from swarms import BALL, DISK, seeded, swarm_tables

from rigidfluid import load_scene, scene_from_dict
from rigidfluid.bodies.ellipsoid import Ellipsoid
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.seeding.scaled_options import scaled_options
from rigidfluid.errors import RigidfluidError, SceneError

SLAB = {"type": "box", "lower": [0.0, 0.0], "upper": [1.0, 0.1]}


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({}, "swarm.0.number: found none of number, fraction and file"),
        ({"number": 3, "fraction": 0.1}, "swarm.0.fraction: found number and fraction; allowed is one of number"),
        (
            {"number": 3, "name": "g*"},
            "swarm.0.name: found 'g*'; allowed is a text with no control",
        ),
        ({"number": 0}, "swarm.0.number: found 0; allowed is a value greater than or equal to 1"),
        ({"number": 10**6}, "swarm.0.number: found 1000000"),
        ({"fraction": 1.2}, "swarm.0.fraction: found 1.2"),
        ({"number": 3, "size": {"distribution": "lognormal"}}, "swarm.0.size.distribution: found 'lognormal'"),
        ({"number": 3, "size": {"distribution": "uniform", "least": 1.0}}, "swarm.0.size.greatest"),
        (
            {"number": 3, "size": {"distribution": "uniform", "least": 2.0, "greatest": 1.0}},
            "swarm.0.size.greatest: found 1.0; allowed is at least size.least = 2",
        ),
        (
            {"number": 3, "size": {"distribution": "table", "rows": [[1.0, 0.0]]}},
            "swarm.0.size.rows: found shares",
        ),
        (
            {"number": 3, "size": {"distribution": "normal", "deviation": 0.01, "least": 1.2, "greatest": 1.3}},
            "swarm.0.size.least: found 1.2, up to size.greatest = 1.3, with less than 1e-06 of all sizes",
        ),
        (
            {"number": 3, "size": {"distribution": "log-normal", "deviation": 0.01, "least": 0.1, "greatest": 0.8}},
            "swarm.0.size.least: found 0.1",
        ),
        ({"number": 3, "tilt": 0.1}, "swarm.0.tilt: found 0.1 from no angle"),
        ({"number": 3, "orientation": [1.0, 0.0, 0.0, 0.0]}, "swarm.0.orientation: found [1.0, 0.0, 0.0, 0.0]"),
        ({"number": 3, "gap": 0.5}, "swarm.0.gap: found 0.5 on both sides of a body 0.1 thick; allowed is together at"),
        ({"number": 150}, "swarm.0.number: found 150 bodies, 1.18 of the region's volume"),
        (
            {"fraction": 0.95},
            "swarm.0.fraction: found 121 bodies, 0.95 of the region's volume; allowed is up to",
        ),
        ({"fraction": 0.001}, "swarm.0.fraction: found 0.001, less than half of the 0.00785 of one body"),
        ({"fraction": 0.1, "region": {"type": "ball"}}, "swarm.0.region.type: found 'ball'; allowed is 'box', 'cyl"),
        (
            {"fraction": 0.1, "region": SLAB | {"lower": [0.0, 2.0], "upper": [1.0, 3.0]}},
            "swarm.0.region: found a region from [0.0, 2.0] to [1.0, 3.0] outside the domain",
        ),
        (
            {"fraction": 0.1, "region": SLAB | {"upper": [1.0, -0.1]}},
            "swarm.0.region.upper: found [1.0, -0.1]; allowed is a corner above",
        ),
        ({"number": 1, "region": SLAB}, "swarm.0.gap: found 0.0005 on both sides of a body 0.1 thick"),
        (
            {"number": 1, "region": {"type": "cylinder", "start": [0.5, 0.5], "end": [1.0, 1.0], "radius": 0.3}},
            "swarm.0.region.end: found [1.0, 1.0]; allowed is no end in 2D",
        ),
        ({"number": 1, "region": {"type": "file", "file": "a.stl"}}, 'swarm.0.region.type: found "stl" in 2D'),
        ({"number": 3, "nmber": 3}, "swarm.0.nmber: found a key that nothing reads"),
        ({"file": "a.csv", "gap": 0.1}, "swarm.0.gap: found gap together with file"),
        ({"number": 3, "velocity": [1.0]}, "swarm.0.velocity: found [1.0]"),
    ],
)
def test_wrong_keys_are_told_with_their_field(keys: dict[str, Any], told: str) -> None:
    with pytest.raises(SceneError) as error:
        seeded(2, DISK, **keys)
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("shape", "told"),
    [
        ({"type": "sphere"}, "swarm.0.shape.0.radius: this key is missing"),
        ({"type": "sphere", "raduis": 0.1}, "swarm.0.shape.0.raduis: found a key that nothing reads"),
        ({"type": "disk", "radius": 0.1}, "swarm.0.shape.0.type: found 'disk'"),
        ({"type": "ellipsoid", "semi_axes": [0.1]}, "swarm.0.shape.0.semi_axes"),
        (DISK | {"weight": 0.0}, "swarm.0.shape.0.weight: found 0.0"),
    ],
)
def test_wrong_shapes_are_told_with_their_field(shape: dict[str, Any], told: str) -> None:
    with pytest.raises(RigidfluidError) as error:
        seeded(2, shape, number=3)
    assert told in str(error.value)


def test_a_cylinder_in_space_needs_its_other_end() -> None:
    with pytest.raises(SceneError, match=r"swarm\.0\.region\.end: found nothing"):
        seeded(3, BALL, number=1, region={"type": "cylinder", "start": [0.5, 0.5, 0.5], "radius": 0.3})


def test_a_name_that_a_listed_body_has_is_told_with_the_swarm() -> None:
    listed = DISK | {"name": "grain0", "density": 1.0, "position": [0.1, 0.1]}
    with pytest.raises(SceneError, match=r"swarm\.0\.body 'grain0'\.name: found 'grain0'; allowed is a name that no"):
        scene_from_dict(swarm_tables(2, DISK, number=2, tables={"body": [listed]}))


def test_errors_stand_in_the_line_of_their_table(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(
        """[scene]
name = "swarm"
dimension = 2
[fluid]
backend = "dry"
[domain]
lower = [0, 0]
upper = [1, 1]
[time]
end = 1.0
step = 0.1
[output]
every = 1.0
[[swarm]]
name = "grain"
density = 2.0
shape = [{type = "sphere", radius = 0.1}]
number = 3
gap = 0.6
"""
    )
    with pytest.raises(SceneError) as error:
        load_scene(scene)
    assert str(error.value).startswith(f"{scene}:19: swarm.0.gap")
    assert len(load_scene(scene, ["swarm.0.gap=0.01", "swarm.0.number=4"]).body) == 4


def test_other_errors_of_a_scene_are_told_before_it_is_seeded() -> None:
    tables = swarm_tables(2, DISK, number=2, tables={"time": {"end": 1.0}})
    with pytest.raises(SceneError, match=r"time\.step"):
        scene_from_dict(tables)
    with pytest.raises(SceneError, match=r"domain\.upper"):
        scene_from_dict(swarm_tables(2, DISK, number=2, tables={"domain": {"lower": [0.0, 0.0], "upper": [-1.0, 1.0]}}))


def test_sizes_of_shapes_without_lengths_are_refused() -> None:
    class Fixed(Ellipsoid):
        Options = PartOptions

    with pytest.raises(SceneError, match=r"swarm\.0\.size: found sizes of shapes of type 'ellipsoid'"):
        scaled_options(Fixed, {}, 2.0, "swarm.0")
    assert scaled_options(Fixed, {}, 1.0, "swarm.0") == {}
    assert scaled_options(Ellipsoid, {"semi_axes": [1.0, 2.0]}, 2.0, "swarm.0") == {"semi_axes": [2.0, 4.0]}
