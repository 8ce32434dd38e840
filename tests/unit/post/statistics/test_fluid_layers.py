"""Profiles of the fluid: cells cut by layers, against integrals that are known, and flows against their flux."""

from __future__ import annotations

from itertools import product
from math import factorial, prod
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import Simulation
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.vtu import read_vtu
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.statistics.cell_pieces import cut_by_layers, simplex_rule
from rigidfluid.post.statistics.fluid_layers import fluid_layers, layer_integrals
from rigidfluid.post.statistics.profiles import LAYERS, Profile, profile
from rigidfluid.post.statistics.samples import Samples, samples_at

FLUX, LAYER = 4e-4, 1.5e-3
"""Relative errors of the flux that the weak divergence leaves on these meshes, in all and in a layer [1]."""

DISK = {"type": "sphere", "radius": 0.15, "density": 1.0}


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_rule_is_exact_to_degree_five(dimension: int) -> None:
    points, weights = simplex_rule(dimension + 1)
    for powers in product(range(6), repeat=dimension + 1):
        if sum(powers) <= 5:
            exact = factorial(dimension) * prod(map(factorial, powers)) / factorial(dimension + sum(powers))
            assert weights @ np.prod(points**powers, axis=1) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_cells_are_cut_into_pieces_each_within_a_layer(dimension: int) -> None:
    """Of random cells that are lower and higher than layers, some with corners on their edges; the whole stays."""
    random = np.random.default_rng(2)
    height = random.uniform(-1.0, 1.0, (300, dimension + 1)) * random.choice([0.2, 1.0, 6.0], (300, 1))
    height[::3] = np.rint(height[::3])
    pieces = cut_by_layers(height)
    lowest, highest = pieces.height.min(axis=1), pieces.height.max(axis=1)
    np.testing.assert_array_less(highest, np.floor(lowest + 1e-8) + 1.0 + 1e-8)
    np.testing.assert_allclose(np.bincount(pieces.cell, pieces.share), 1.0, rtol=1e-12)
    at = np.einsum("pck,pk->pc", pieces.corners, height[pieces.cell])
    np.testing.assert_allclose(at, pieces.height, atol=1e-12)
    assert (pieces.corners >= 0.0).all()


def test_a_layer_of_one_cell_has_its_exact_share() -> None:
    """Of the triangle y ≤ 1 - x with the flow (y², 1): ∫ y² (1 - y) dy from .25 to .5, and 1 - y for the volume."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    points = np.vstack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])
    velocity = np.stack([points[:, 1] ** 2, np.ones(6)], axis=1)
    fields = Fields(points, np.arange(6)[None], velocity, np.zeros(6))
    volume, moved = layer_integrals(fields, 1, 0.0, 0.25, 4)
    y = np.linspace(0.0, 1.0, 5)
    np.testing.assert_allclose(volume, np.diff(y - y**2 / 2.0), rtol=1e-12)
    np.testing.assert_allclose(moved[:, 0], np.diff(y**3 / 3.0 - y**4 / 4.0), rtol=1e-12)
    np.testing.assert_allclose(moved[:, 1], volume, rtol=1e-12)
    for away, lower in ((3.0, 0.0), (0.1, 0.1)):
        other = Fields(points + [0.0, away], fields.cells, velocity, np.zeros(6))
        np.testing.assert_allclose(layer_integrals(other, 1, lower, 0.25, 4)[0], volume, rtol=1e-9)


def test_curved_cells_have_the_volume_of_their_curved_shape() -> None:
    """A triangle whose long edge is bent by .1 in its middle has 2/3 of .1 times its length more."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    points = np.vstack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])
    points[4] += 0.1 / np.sqrt(2.0)
    fields = Fields(points, np.arange(6)[None], np.ones((6, 2)), np.zeros(6))
    volume, moved = layer_integrals(fields, 0, 0.0, 0.3, 4)
    assert volume.sum() == pytest.approx(0.5 + 2.0 / 3.0 * 0.1 * np.sqrt(2.0), rel=1e-12)
    np.testing.assert_allclose(moved[:, 0], volume, rtol=1e-12)


def channel(dimension: int, *bodies: dict[str, Any], **tables: Any) -> dict[str, Any]:
    """A channel 2 long with walls across y at 0 and 1, in 3D with periods across z, from the parabola 4 y (1 - y)."""
    drop = {"on": "left", "type": "periodic", "pressure_drop": 0.16}
    pairs = [drop, *({"on": face, "type": "periodic"} for face in ("right", "back", "front")[: 2 * dimension - 3])]
    common: dict[str, Any] = {
        "scene": {"name": "channel", "dimension": dimension},
        "fluid": {"density": 1.0, "viscosity": 0.01, "initial": ["4*y*(1 - y)", *["0"] * (dimension - 1)]},
        "domain": {"lower": [0.0] * dimension, "upper": [2.0, 1.0, 0.6][:dimension]},
        "boundary": pairs,
        "body": list(bodies),
        "mesh": {"size": 0.31, "size_body": 0.06},
        "contact": {"law": "normal", "range": 0.05, "epsilon": 1e-3},
        "time": {"end": 0.04, "step": 0.01},
        "output": {"every": 0.02},
    }
    return common | tables


def profiled(results: Results, axis: int) -> Profile:
    """Profile of all bodies in all states after the start."""
    samples = samples_at(results, np.arange(1, len(results.time)), np.arange(len(results.names)))
    return profile(samples, axis, fluid_layers(results, samples, axis, LAYERS, 3))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_flow_without_bodies_has_its_exact_means_in_layers_thinner_than_cells(tmp_path: Path, dimension: int) -> None:
    rigidfluid.run(rigidfluid.scene_from_dict(channel(dimension)), tmp_path)
    fields = read_vtu(read_results(tmp_path).series[-1][1])
    y = np.linspace(0.0, 1.0, LAYERS + 1)
    exact = np.diff(2.0 * y**2 - 4.0 / 3.0 * y**3) * LAYERS
    for axis, length, wanted in ((0, 2.0, 2.0 / 3.0), (1, 1.0, exact)):
        volume, moved = layer_integrals(fields, axis, 0.0, length / LAYERS, LAYERS)
        np.testing.assert_allclose(volume * LAYERS, 2.0 if dimension == 2 else 1.2, rtol=1e-9)
        np.testing.assert_allclose(moved[:, 0] / volume, wanted, atol=2e-6)
        np.testing.assert_allclose(moved[:, 1:] / volume[:, None], 0.0, atol=1e-6)


@pytest.mark.parametrize("axis", [0, 1])
def test_fluid_and_bodies_together_carry_the_flux(tmp_path: Path, axis: int) -> None:
    """In each layer along the flow too. One disk lies across the periodic surfaces, so that the mesh reaches out of the
    domain; one is fixed."""
    disks = DISK | {"position": [0.0, 0.42]}, DISK | {"position": [1.1, 0.7], "fixed": True}
    stokes = {"model": "stokes", "density": 1.0, "viscosity": 0.01}
    history = rigidfluid.run(rigidfluid.scene_from_dict(channel(2, *disks, fluid=stokes)), tmp_path)
    results = read_results(tmp_path)
    assert read_vtu(results.series[-1][1]).points[:, 0].min() < -0.1
    found = profiled(results, axis).mixture
    assert found is not None
    flux = history.driving["flux"][np.isin(history.driving["time"], [time for time, _ in results.series[1:]])].mean()
    np.testing.assert_allclose(found.value[:, 0].mean(), flux, rtol=FLUX)
    if axis == 0:
        np.testing.assert_allclose(found.value[:, 0], flux, rtol=LAYER)


def test_a_body_that_enters_carries_its_part_of_the_flux(tmp_path: Path) -> None:
    """It is there at the last of two output times alone."""
    stokes = {"model": "stokes", "density": 1.0, "viscosity": 0.01}
    tables = channel(2, DISK | {"position": [0.4, 0.42]}, fluid=stokes)
    run = Simulation(rigidfluid.scene_from_dict(tables), tmp_path)
    run.go(0.02)
    run.add(DISK | {"name": "guest", "position": [1.4, 0.6]})
    run.go()
    run.finish("complete")
    run.close()
    found, driving = profiled(read_results(tmp_path), 1).mixture, run.history.driving
    assert found is not None
    outputs = np.isclose(driving["time"][:, None], [0.02, 0.04]).any(axis=1)
    np.testing.assert_allclose(found.value[:, 0].mean(), driving["flux"][outputs].mean(), rtol=FLUX)


@pytest.mark.parametrize(
    ("dimension", "axis"),
    [(2, 0), (2, 1), (3, 1), *(pytest.param(3, axis, marks=pytest.mark.long) for axis in (0, 2))],
)
def test_layers_of_a_body_that_turns_move_as_its_points_there(dimension: int, axis: int) -> None:
    """A naive twin: points of a grid in a ball that is as thick as five layers."""
    random = np.random.default_rng(4)
    centre, radius = np.full(dimension, 0.43), 0.13
    velocity, turning = random.normal(size=dimension), random.normal(size=2 * dimension - 3)
    samples = samples_of_one(centre, velocity, turning, radius)
    found = profile(samples, axis, None)
    line = (np.arange(240) + 0.5) / 120.0 - 1.0
    arms = radius * np.stack(np.meshgrid(*[line] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    arms = arms[np.linalg.norm(arms, axis=1) < radius]
    spin = np.append([0.0, 0.0], turning) if dimension == 2 else turning
    moved = velocity + np.cross(spin, np.pad(arms, ((0, 0), (0, 3 - dimension))))[:, :dimension]
    layer = np.floor((centre + arms)[:, axis] * LAYERS).astype(int)
    for number in np.unique(layer):
        np.testing.assert_allclose(found.velocity.value[number], moved[layer == number].mean(axis=0), atol=3e-3)


def samples_of_one(centre: np.ndarray, velocity: np.ndarray, turning: np.ndarray, radius: float) -> Samples:
    """One ball in a unit box, at one time."""
    none, dimension = np.zeros(1), len(centre)
    return Samples(
        *(none, none, centre[None, None], velocity[None, None], turning[None, None]),
        *(np.zeros((1, 1)), np.array([radius]), ("ball",)),
        *(np.zeros(dimension), np.ones(dimension), 1.0, np.full(dimension, np.inf), None),
    )


def test_runs_without_fields_have_none(tmp_path: Path) -> None:
    dry = channel(2, DISK | {"position": [0.5, 0.5], "velocity": [1.0, 0.0]}, fluid={"backend": "dry"})
    dry["boundary"] = []
    rigidfluid.run(rigidfluid.scene_from_dict(dry), tmp_path)
    found = profiled(read_results(tmp_path), 1)
    assert found.fluid is None
    assert found.mixture is None
