"""Positions in the domain are beside those that go on beyond periodic surfaces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from dry_scenes import ball
from scenes import dry_tables

import rigidfluid
from rigidfluid.api import Simulation
from rigidfluid.core.output.records import columns
from rigidfluid.core.output.tables import read_header
from rigidfluid.core.output.vtu import read_pvd
from rigidfluid.post.reports.results import read_results

LOWER, SIDES = [-0.3, 0.1, 0.2], [1.0, 2.0, 0.7]
PERIODIC = {2: ("left", "right"), 3: ("left", "right", "back", "front")}


def crossing(dimension: int, end: float = 0.9, **keys: object) -> rigidfluid.Scene:
    """Two balls, one of which goes round forwards and the other backwards, also along z in 3D."""
    box = {"lower": LOWER[:dimension], "upper": [a + b for a, b in zip(LOWER, SIDES, strict=True)][:dimension]}
    thrown = [ball([0.4, 0.7, 0.6][:dimension], [2.0, 0.1, 1.5][:dimension])]
    thrown += [ball([0.1, 1.4, 0.4][:dimension], [-3.0, 0.0, -1.0][:dimension])]
    tables = {"boundary": [{"on": side, "type": "periodic"} for side in PERIODIC[dimension]]} | keys
    every = {"output": {"every": 0.3}}
    return rigidfluid.scene_from_dict(dry_tables(*thrown, domain=box, end=end, step=0.05, **every | tables))


def in_domain(positions: np.ndarray) -> np.ndarray:
    """Periodic coordinates by their remainders, the others as they are."""
    dimension = positions.shape[-1]
    wrapped = positions.copy()
    for axis in {2: (0,), 3: (0, 2)}[dimension]:
        wrapped[..., axis] = LOWER[axis] + (positions[..., axis] - LOWER[axis]) % SIDES[axis]
    return wrapped


def stacked(table: dict[str, np.ndarray], suffix: str, dimension: int) -> np.ndarray:
    return np.stack([table[axis + suffix] for axis in "xyz"[:dimension]], axis=-1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_table_of_bodies_has_both(tmp_path: Path, dimension: int) -> None:
    history = rigidfluid.run(crossing(dimension), tmp_path)
    for table in (history.bodies, rigidfluid.load_results(tmp_path).bodies, rigidfluid.run(crossing(dimension)).bodies):
        positions = stacked(table, "", dimension)
        assert np.ptp(positions[:, 0]) > 3.0
        np.testing.assert_allclose(stacked(table, "_wrapped", dimension), in_domain(positions), rtol=0, atol=1e-12)
    results = read_results(tmp_path)
    np.testing.assert_array_equal(results.path(1), stacked(results.bodies, "_wrapped", dimension)[:, 1])


@pytest.mark.parametrize("dimension", [2, 3])
def test_so_have_the_bodies_of_an_output_and_of_a_run(tmp_path: Path, dimension: int) -> None:
    meshio = pytest.importorskip("meshio")
    run = Simulation(crossing(dimension), out=tmp_path)
    run.go()
    run.close()
    for body in run.bodies.values():
        np.testing.assert_allclose(body.wrapped_position, in_domain(body.position), rtol=0, atol=1e-12)
    last = np.array([body.wrapped_position for body in run.bodies.values()])
    bodies = meshio.read(read_pvd(tmp_path / "fields.pvd", "bodies")[-1][1])
    np.testing.assert_array_equal(bodies.point_data["wrapped_position"][:, :dimension], last)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_resumed_run_keeps_the_columns(tmp_path: Path, dimension: int) -> None:
    whole, halves = tmp_path / "whole", tmp_path / "halves"
    rigidfluid.run(crossing(dimension), whole)
    rigidfluid.run(crossing(dimension, end=0.3), halves)
    rigidfluid.run(crossing(dimension), halves, resume=True)
    assert (halves / "bodies.csv").read_text() == (whole / "bodies.csv").read_text()
    assert read_header(whole / "bodies.csv")[-dimension:] == ["x_wrapped", "y_wrapped", "z_wrapped"][:dimension]


def test_a_run_with_bodies_that_enter_has_them(tmp_path: Path) -> None:
    source = {"name": "grain", "shape": [{"type": "sphere", "radius": 0.05}], "density": 1.0, "times": [0.2, 0.4]}
    region = {"type": "box", "lower": [-0.2, 0.2], "upper": [0.2, 0.45]}
    source |= {"region": region, "velocity": [4.0, 0.0]}
    rigidfluid.run(crossing(2, source=[source]), tmp_path)
    results = read_results(tmp_path)
    assert len(results.names) == 4
    there = results.present
    wrapped = np.stack([results.bodies["x_wrapped"], results.bodies["y_wrapped"]], axis=-1)
    np.testing.assert_allclose(wrapped[there], in_domain(results.quantity("position")[there]), rtol=0, atol=1e-12)


def test_a_domain_without_periodic_surfaces_has_no_such_columns(tmp_path: Path) -> None:
    history = rigidfluid.run(crossing(2, end=0.05, boundary=[]), tmp_path)
    assert tuple(read_header(tmp_path / "bodies.csv")) == columns(2)["bodies"] == tuple(history.bodies)
    assert tuple(rigidfluid.load_results(tmp_path).bodies) == columns(2)["bodies"]
    assert not [name for name in columns(2)["bodies"] if "wrapped" in name]
