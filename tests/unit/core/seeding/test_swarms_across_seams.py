"""Swarms lie across periodic surfaces, and keep their gaps to images of each other."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swarms import BALL, DISK, radii, seeded, start

from rigidfluid import Scene
from rigidfluid.api import Simulation
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.mesh.generation.meshing import longest_edges
from rigidfluid.core.model.types import Pose
from rigidfluid.core.seeding.clearance import Clearance, Surroundings
from rigidfluid.detectors.brute_force import BruteForceDetector
from rigidfluid.registry import Registry

SIDES = (("left", "right"), ("bottom", "top"), ("back", "front"))
MESH = {"size": 0.2, "size_body": 0.08}
WET = {"density": 1.0, "viscosity": 0.1}


def periodic(*axes: int) -> dict[str, Any]:
    return {"boundary": [{"on": side, "type": "periodic"} for axis in axes for side in SIDES[axis]]}


def gaps_to_images(scene: Scene, *axes: int) -> FloatArray:
    """Gaps of balls to all others or the nearest images of them, by the formula (n, n) [length]."""
    position, size = start(scene).position, radii(scene)
    apart = position[:, None] - position
    apart[..., axes] -= np.rint(apart[..., axes])
    gaps = np.linalg.norm(apart, axis=2) - size - size[:, None]
    np.fill_diagonal(gaps, np.inf)
    return gaps


def across(scene: Scene, axis: int) -> int:
    """Number of balls that lie across the surfaces of an axis."""
    place = start(scene).position[:, axis]
    return int(np.sum(np.minimum(place, 1.0 - place) < radii(scene)))


@pytest.mark.parametrize(
    ("dimension", "shape", "fraction", "axes"),
    [(2, DISK, 0.2, (0,)), (2, DISK, 0.75, (0, 1)), (3, BALL, 0.1, (0, 1, 2)), (3, BALL, 0.5, (0, 2))],
)
def test_gaps_are_kept_to_images_and_to_walls_alone(
    dimension: int, shape: dict[str, Any], fraction: float, axes: tuple[int, ...]
) -> None:
    scene = seeded(dimension, shape, fraction=fraction, gap=0.002, tables=periodic(*axes))
    place = start(scene).position
    assert np.all((place >= 0.0) & (place < 1.0))
    assert gaps_to_images(scene, *axes).min() >= 0.002
    assert [across(scene, axis) > 0 for axis in range(dimension)] == [axis in axes for axis in range(dimension)]


def test_nearest_points_of_images_are_told_on_the_bodies_themselves() -> None:
    disks = [Sphere(Sphere.Options(radius=0.03), 2)] * 2
    around = Surroundings((), (), Lattice(np.array([[1.0, 0.0]]), np.zeros(2)), Registry.load())
    pose = Pose(np.array([[0.05, 0.5], [0.97, 0.5]]), np.zeros((2, 1)))
    found = Clearance(disks, 2, around).within(pose, 0.1)
    assert found.gap == pytest.approx([0.02])
    ends = {int(found.a[0]): found.point_a[0], int(found.b[0]): found.point_b[0]}
    np.testing.assert_allclose(ends[0], [0.02, 0.5], atol=1e-12)
    np.testing.assert_allclose(ends[1], [1.0, 0.5], atol=1e-12)


def test_a_short_arc_beside_a_periodic_surface_is_divided() -> None:
    """Netgen leaves two arcs of .0303 whole, of a disk that lies across by .006, even where .019 is asked for."""
    contact = {"law": "normal", "range": 0.015, "epsilon": 1e-5}
    tables = periodic(0, 1) | {"fluid": WET, "mesh": {"size": 0.1, "size_body": 0.03}, "contact": contact}
    scene = seeded(2, {**DISK, "radius": 0.08}, fraction=0.25, gap=0.02, tables=tables, seed=4)
    mesh = Simulation(model_of(scene)).state.mesh
    assert longest_edges(mesh, len(scene.body)).max() <= 0.03 * (1.0 + 1e-9)


def test_a_region_that_overhangs_a_periodic_surface_keeps_bodies_off_it() -> None:
    region = {"type": "box", "lower": [-0.5, 0.0], "upper": [0.5, 1.0]}
    scene = seeded(2, DISK, number=8, gap=0.01, region=region, tables=periodic(0))
    place, size = start(scene).position, radii(scene)
    assert np.all((place[:, 0] > size) & (place[:, 0] < 0.5 - size))
    assert scene.swarm[0].seeded is not None
    assert scene.swarm[0].seeded.gap >= 0.01


def test_a_later_swarm_that_is_too_long_to_cross_keeps_all_off_periodic_surfaces() -> None:
    """A run has one lattice of images for all bodies."""
    grains = {"name": "grain", "number": 15, "density": 1.0, "gap": 0.01, "shape": [{"type": "sphere", "radius": 0.04}]}
    log = {"type": "ellipsoid", "semi_axes": [0.55, 0.05]}
    logs = {"name": "log", "number": 1, "density": 1.0, "gap": 0.01, "angle": np.pi / 2, "shape": [log]}
    scene = scene_from_dict(
        {
            "scene": {"name": "grains", "dimension": 2, "seed": 3},
            "fluid": WET,
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 2.0]},
            "mesh": MESH,
            "time": {"step": 0.01, "end": 0.01},
            "output": {"every": 0.01},
            "swarm": [grains, logs],
            **periodic(0),
        }
    )
    place = start(scene).position[:15, 0]
    assert np.all((place > 0.04) & (place < 0.96))
    Simulation(model_of(scene))


@pytest.mark.long
def test_the_naive_detector_finds_no_smaller_gap_among_all_images() -> None:
    ellipse = {"type": "ellipsoid", "semi_axes": [0.16, 0.08]}
    scene = seeded(2, ellipse, fraction=0.6, gap=0.002, tables=periodic(0, 1))
    pose, offsets = start(scene), np.array(list(product((0, 1, -1), repeat=2)))
    shapes = [body.shape for body in model_of(scene).all_bodies] * len(offsets)
    position = (offsets[:, None] + pose.position).reshape(-1, 2)
    naive = BruteForceDetector(BruteForceDetector.Options(), shapes, [])
    found = naive.detect(Pose(position, np.tile(pose.orientation, (len(offsets), 1))), None, 0.01)
    least = found.gap[found.body_a < len(pose.position)].min()
    assert least == pytest.approx(scene.swarm[0].seeded.gap, abs=1e-9)
    assert least >= 0.002


def test_a_region_holds_its_bodies_beside_periodic_surfaces_too() -> None:
    """They keep clear of a listed body that lies across, also where its image is."""
    post = {"name": "post", "type": "sphere", "radius": 0.2, "density": 1.0, "position": [1.0, 0.5]}
    region = {"type": "box", "lower": [0.0, 0.0], "upper": [0.5, 1.0]}
    tables = {"body": [post], **periodic(0)}
    scene = seeded(2, DISK, number=20, gap=0.01, region=region, tables=tables)
    place = start(scene).position[1:]
    assert np.all((place[:, 0] > 0.06) & (place[:, 0] < 0.44))
    assert gaps_to_images(scene, 0).min() >= 0.01


def test_a_body_of_a_file_may_lie_across(tmp_path: Path) -> None:
    file = tmp_path / "stones.csv"
    file.write_text("x,y,radius\n0.98,0.5,0.1\n0.2,0.5,0.1\n")
    shape = {"type": "sphere", "radius": 1.0}
    scene = seeded(2, shape, file=str(file), tables=periodic(0))
    assert scene.swarm[0].seeded.gap == pytest.approx(0.02)
    assert start(scene).position[0].tolist() == [0.98, 0.5]


def test_a_single_body_has_the_gap_to_its_own_image() -> None:
    scene = seeded(2, {"type": "sphere", "radius": 0.3}, number=1, tables=periodic(0, 1))
    assert scene.swarm[0].seeded.gap == pytest.approx(0.4)


def test_they_keep_clear_of_periodic_surfaces_that_bodies_do_not_cross() -> None:
    """An obstacle is not there again in the images of the domain."""
    obstacle = {"name": "post", "type": "sphere", "radius": 0.1, "position": [0.5, 0.5]}
    domain = {"type": "channel", "lower": [0.0, 0.0], "upper": [1.0, 1.0], "obstacle": [obstacle]}
    scene = seeded(2, DISK, number=40, tables={"domain": domain, "fluid": WET, "mesh": MESH, **periodic(0)})
    assert across(scene, 0) == 0


def test_a_run_in_a_fluid_starts_so() -> None:
    law = {"law": "normal", "range": 0.01, "epsilon": "auto", "impact_speed": 1.0}
    mesh = {"mesh": MESH, "contact": law, "fluid": WET}
    scene = seeded(2, {"type": "sphere", "radius": 0.12}, fraction=0.3, gap=0.03, tables=mesh | periodic(0, 1))
    assert across(scene, 0) + across(scene, 1) > 0
    run = Simulation(scene_from_dict(scene.to_dict()))
    assert run.step().ledger.residual == pytest.approx(0.0, abs=1e-6)
