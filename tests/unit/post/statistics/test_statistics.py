"""Statistics against places and motions for which they are known."""

from __future__ import annotations

import json
import tracemalloc
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from scenes import wet_tables

import rigidfluid
from rigidfluid.api import Simulation
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.mechanics.shear import Shear, shear_of_walls
from rigidfluid.core.mechanics.suspension import mean_gap, velocity_fluctuations
from rigidfluid.core.model.system import System
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.errors import OutputError
from rigidfluid.post.reports import report
from rigidfluid.post.reports.report import Section
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.statistics import statistics
from rigidfluid.post.statistics.blocks import mean
from rigidfluid.post.statistics.contact_network import contact_network
from rigidfluid.post.statistics.contact_rows import contact_rows
from rigidfluid.post.statistics.contact_stresses import contact_stresses
from rigidfluid.post.statistics.diffusion import diffusion
from rigidfluid.post.statistics.gap_distribution import gap_distribution
from rigidfluid.post.statistics.pair_distribution import pair_distribution, shell_shares
from rigidfluid.post.statistics.profiles import profile
from rigidfluid.post.statistics.report_section import _stresses, section
from rigidfluid.post.statistics.samples import Samples, samples_of
from rigidfluid.post.statistics.structure_factor import structure_factor
from rigidfluid.post.statistics.suspension_stress import StressFigures, SuspensionStress, suspension_stress
from rigidfluid.post.statistics.wall_stresses import wall_stresses


def made(
    position: np.ndarray,
    velocity: np.ndarray | None = None,
    radius: float = 0.01,
    period: float = np.inf,
    shear: Shear | None = None,
) -> Samples:
    """Balls in a unit box at places (s, n, d), a time of .1 from state to state."""
    states, count, dimension = position.shape
    return Samples(
        step=np.arange(states, dtype=float),
        time=0.1 * np.arange(states),
        position=position,
        velocity=np.zeros_like(position) if velocity is None else velocity,
        angular_velocity=np.zeros((states, count, 2 * dimension - 3)),
        gap=np.full((states, count), 0.1),
        radius=np.full(count, radius),
        name=tuple(f"ball{number}" for number in range(count)),
        lower=np.zeros(dimension),
        upper=np.ones(dimension),
        volume=1.0,
        period=np.array([period, *[np.inf] * (dimension - 1)]),
        shear=shear,
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_independent_places_have_no_structure(dimension: int) -> None:
    random = np.random.default_rng(7)
    samples = made(0.01 + 0.98 * random.random((200, 60, dimension)))
    pairs, waves = pair_distribution(samples), structure_factor(samples)
    many = pairs.distance > 0.2
    np.testing.assert_allclose(pairs.value.value[many], 1.0, atol=0.1)
    assert np.mean(np.abs(pairs.value.value[many] - 1.0) < 2.0 * pairs.value.error[many]) > 0.85
    short = waves.wavenumber > 30.0
    np.testing.assert_allclose(waves.value.value[short], 1.0, atol=0.1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_shells_of_the_box_are_those_of_random_places(dimension: int) -> None:
    random = np.random.default_rng(7)
    sides = np.array([1.0, 0.7, 1.3])[:dimension]
    edges = np.linspace(0.0, 0.35, 8)
    apart = np.linalg.norm(np.diff(random.random((400_000, 2, dimension)) * sides, axis=1)[:, 0], axis=1)
    counted = np.histogram(apart, edges)[0] / len(apart)
    np.testing.assert_allclose(
        shell_shares(edges, sides, np.zeros(dimension, dtype=bool)), counted, rtol=0.1, atol=3e-4
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_independent_places_have_no_structure_along_a_period_either(dimension: int) -> None:
    random = np.random.default_rng(7)
    place = 0.01 + 0.98 * random.random((200, 60, dimension))
    place[..., 0] = random.random((200, 60)) + random.integers(-3, 4, (200, 60))
    pairs = pair_distribution(made(place, period=1.0))
    many = pairs.distance > 0.2
    np.testing.assert_allclose(pairs.value.value[many], 1.0, atol=0.1)
    assert np.mean(np.abs(pairs.value.value[many] - 1.0) < 2.0 * pairs.value.error[many]) > 0.85


def test_statistics_do_not_depend_on_the_period_in_which_a_body_is() -> None:
    random = np.random.default_rng(3)
    place = np.array([[[0.02, 0.5], [0.97, 0.5], [0.5, 0.2]]]) + 1e-3 * random.random((16, 1, 2))
    there = place + np.array([[1.0, 0.0], [-2.0, 0.0], [3.0, 0.0]])
    middle = place + np.array([0.4, 0.0])
    middle[..., 0] = np.mod(middle[..., 0], 1.0)
    table = {
        "step": np.arange(16.0),
        "a": np.array(["ball0"] * 16),
        "b": np.array(["ball1"] * 16),
        "fx": np.full(16, 3.0),
        "fy": np.zeros(16),
    }
    found = []
    for position, shift in ((place, -1.0), (there, 2.0), (middle, 0.0)):
        samples = made(position, velocity=np.ones_like(position), radius=0.03, period=1.0)
        on_b = position[:, 1] + [shift + 0.03, 0.0]
        network = contact_network(contact_rows(samples, table | {"bx": on_b[:, 0], "by": on_b[:, 1]}))
        found.append(
            (pair_distribution(samples).value.value, network.stress.value, profile(samples, 1, None).fraction.value)
        )
        assert profile(samples, 0, None).fraction.value.sum() / 20.0 == pytest.approx(3.0 * np.pi * 0.03**2)
    np.testing.assert_allclose(found[0][1], [[-3.0 * 0.05, 0.0], [0.0, 0.0]], atol=1e-12)
    for other in found[1:]:
        for one, same in zip(found[0], other, strict=True):
            np.testing.assert_allclose(one, same, rtol=0, atol=1e-9)


@pytest.mark.parametrize("period", [np.inf, 1.0])
@pytest.mark.parametrize("dimension", [2, 3])
def test_pairs_are_counted_as_one_by_one(dimension: int, period: float) -> None:
    place = 5.0 * np.random.default_rng(11).random((3, 40, dimension)) - 2.0
    if np.isinf(period):
        place = np.mod(place, 1.0)
    samples = made(place, period=period)
    found = pair_distribution(samples)
    edges = np.linspace(0.0, 0.49, 61)
    apart = place[:, :, None] - place[:, None]
    apart = np.linalg.norm(apart - samples.periods(apart), axis=-1)[:, *np.triu_indices(40, 1)]
    counted = np.array([np.histogram(one, edges)[0] for one in apart]).mean(axis=0)
    sides = np.where(samples.periodic, 1.0, 0.98)
    np.testing.assert_allclose(found.value.value * 780.0 * shell_shares(edges, sides, samples.periodic), counted)


def test_pairs_of_thousands_of_bodies_take_little_memory() -> None:
    position = np.random.default_rng(1).random((1, 6000, 3))
    tracemalloc.start()
    pair_distribution(made(position))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5e7


def test_a_lattice_scatters_waves_of_its_spacing_alone() -> None:
    grid = (np.stack(np.meshgrid(np.arange(5), np.arange(5)), axis=-1).reshape(1, -1, 2) + 0.5) / 5.0
    waves = structure_factor(made(np.repeat(grid, 2, axis=0)))
    strong = waves.wavenumber[waves.value.value > 1.0]
    np.testing.assert_allclose(strong / (2.0 * np.pi), [5.0, 7.0, 10.0, 11.0], atol=0.1)


def test_waves_of_thousands_of_bodies_take_little_memory() -> None:
    position = np.random.default_rng(1).random((2, 3000, 3))
    tracemalloc.start()
    structure_factor(made(position))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e8


def test_errors_of_correlated_values_are_those_of_what_is_independent() -> None:
    random = np.random.default_rng(7)
    values = np.repeat(random.normal(size=1024), 8)
    found = mean(values)
    assert found.error == pytest.approx(1.0 / np.sqrt(1024.0), rel=0.35)
    assert np.isnan(mean(values[:4]).error)


def test_a_random_walk_diffuses_and_common_motion_does_not() -> None:
    random = np.random.default_rng(7)
    steps = random.normal(scale=[0.02, 0.01], size=(400, 300, 2))
    drift = np.linspace(0.0, 5.0, 400)[:, None, None]
    found = diffusion(made(np.cumsum(steps, axis=0) + drift))
    np.testing.assert_allclose(found.coefficient, [0.02**2 / 0.2, 0.01**2 / 0.2], rtol=0.2)
    spread = velocity_fluctuations(steps + 3.0, steps, None).mean(axis=0)
    np.testing.assert_allclose(spread, [0.02, 0.01], rtol=0.02)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_shear_neither_diffuses_nor_fluctuates(dimension: int) -> None:
    """Walkers that a shear moves along x by their place across, the last axis: what is left is their own walk."""
    random, last = np.random.default_rng(7), dimension - 1
    shear, own = shear_of_walls(sheared(dimension)), np.full(dimension, 0.02)
    assert shear is not None
    steps = random.normal(scale=own, size=(400, 300, dimension))
    walk = random.random((300, dimension)) + np.cumsum(steps, axis=0)
    place, velocity = walk.copy(), np.zeros_like(walk)
    velocity[..., 0] = 1.5 + 2.0 * walk[..., last]
    place[1:, :, 0] += np.cumsum(0.05 * (velocity[1:, :, 0] + velocity[:-1, :, 0]), axis=0)
    found, flow = made(place, velocity + steps, shear=shear), made(place, velocity + steps)
    np.testing.assert_allclose(diffusion(found).coefficient, own**2 / 0.2, rtol=0.2)
    assert diffusion(flow).coefficient[0] > 1.0
    spread = velocity_fluctuations(found.velocity, found.position, shear).mean(axis=0)
    np.testing.assert_allclose(spread, own, rtol=0.02)
    layered = profile(found, last, None).fluctuations
    middle = slice(5, 15)
    within = 2.0 / 20.0 / np.sqrt(12.0)
    np.testing.assert_allclose(layered.value[middle, 0], np.hypot(own[0], within), rtol=0.1)
    np.testing.assert_allclose(layered.value[middle, last], own[last], rtol=0.05)


def test_gaps_are_told_by_the_share_of_bodies_below() -> None:
    """Of twenty bodies with the gaps 1 to 20 in any order, the last of which has nothing near in one of the states."""
    random = np.random.default_rng(7)
    samples = made(np.full((16, 20, 2), 0.5))
    gaps = np.stack([random.permutation(np.arange(1.0, 21.0)) for _ in range(16)])
    found = gap_distribution(replace(samples, gap=gaps))
    np.testing.assert_allclose(found.gap.value, 20.0 * found.share)
    gaps[1][gaps[1] >= 19.0] = np.inf
    found = gap_distribution(replace(samples, gap=gaps))
    np.testing.assert_allclose(found.gap.value[:-1], 20.0 * found.share[:-1])
    assert found.gap.to_list()[0][-1] is None


def test_velocities_in_a_layer_spread_by_the_parts_of_bodies_in_it() -> None:
    """Of two disks in the middle of layers and one that lies in both, three to one."""
    place = np.array([[0.2, 0.225], [0.5, 0.275], [0.8, 0.25 + 0.02]])
    velocity = np.array([[1.0, 0.0], [2.0, 0.0], [5.0, 4.0]])
    states = [np.repeat(values[None], 16, axis=0) for values in (place, velocity)]
    found = profile(made(*states, radius=0.025), 1, None).fluctuations
    height = -0.02 / 0.025
    below = (0.5 * np.pi + np.arcsin(height) + height * np.sqrt(1.0 - height**2)) / np.pi
    for layer, share, speed in ((4, below, 1.0), (5, 1.0 - below, 2.0)):
        spread = np.sqrt(share) / (1.0 + share)
        np.testing.assert_allclose(found.value[layer], [spread * (5.0 - speed), spread * 4.0], rtol=1e-9)
    assert np.isnan(found.value[0]).all()


@pytest.mark.parametrize("dimension", [2, 3])
def test_layers_share_a_body_by_its_volume(dimension: int) -> None:
    place = np.full((16, 2, dimension), 0.5)
    place[:, 1, 1] = 0.21
    velocity = np.zeros_like(place)
    velocity[:, 0, 0], velocity[:, 1, 0] = 2.0, -1.0
    found = profile(made(place, velocity, radius=0.03), 1, None)
    volume = np.pi * 0.03**2 if dimension == 2 else 4.0 / 3.0 * np.pi * 0.03**3
    assert found.fraction.value.sum() / 20.0 == pytest.approx(2.0 * volume)
    half = found.fraction.value[[9, 10]] / 20.0
    np.testing.assert_allclose(half, 0.5 * volume)
    np.testing.assert_allclose(found.velocity.value[[3, 4, 9, 10], 0], [-1.0, -1.0, 2.0, 2.0])
    assert np.isnan(found.velocity.value[0, 0])


def test_contacts_make_groups_and_press() -> None:
    place = np.array([[0.1, 0.5], [0.2, 0.5], [0.3, 0.5], [0.8, 0.8]])
    samples = made(np.repeat(place[None], 8, axis=0), radius=0.05)
    rows = [("ball0", "ball1", -4.0, 0.0), ("ball1", "ball2", -4.0, 0.0), ("ball0", "left", 4.0, 0.0)]
    a, b, fx, fy = (np.array([row[column] for row in rows] * 8) for column in range(4))
    step = np.repeat(np.arange(8), 3)
    table = {"step": step, "a": a, "b": b, "fx": fx, "fy": fy, "bx": 0.0 * fx, "by": 0.0 * fy}
    found = contact_network(contact_rows(samples, table))
    assert found.coordination.value == pytest.approx(4 / 4)
    assert found.touching.value == pytest.approx(3 / 4)
    assert found.largest.value == pytest.approx(3 / 4)
    np.testing.assert_allclose(found.stress.value, [[-0.8, 0.0], [0.0, 0.0]])
    np.testing.assert_allclose(found.on_walls["left"].value, [-4.0, 0.0])


def test_of_a_run_they_are_written_beside_its_results(tmp_path: Path) -> None:
    law = {"law": "spring-dashpot", "range": 0.02, "stiffness": 200.0}
    balls = [ball([0.2 + 0.25 * (n % 3), 0.3 + 0.3 * (n // 3)], [1.0 - 0.3 * n, 0.4 * n - 1.0]) for n in range(6)]
    scene = dry_scene(law, *balls, end=0.6, step=5e-3)
    rigidfluid.run(scene, tmp_path)
    found, files = statistics(tmp_path, since=0.1)
    curves = ["pair_distribution", "structure_factor", "gap_distribution", "diffusion", "profile"]
    tables = [f"statistics_{name}.csv" for name in curves]
    assert [file.name for file in files] == ["statistics.json", *tables, "statistics.png"]
    data = json.loads(files[0].read_text())
    written = {file.name: np.genfromtxt(file, delimiter=",", names=True) for file in files[1:-1]}
    for table, column, wanted in (
        (tables[0], "g", data["pair_distribution"]["g"][0]),
        (tables[1], "s_error", data["structure_factor"]["s"][1]),
        (tables[2], "gap", data["gap_distribution"]["gap"][0]),
        (tables[3], "square_displacement_y", np.array(data["diffusion"]["mean_square_displacement"])[:, 1]),
        (tables[4], "fluctuation_vx", np.array(data["profile"]["velocity_fluctuations"][0])[:, 0]),
        (tables[4], "place", data["profile"]["place"]),
    ):
        np.testing.assert_array_equal(written[table][column], np.array(wanted, dtype=float))
    assert data["bodies"] == 6
    assert data["volume_fraction"] == pytest.approx([6 * np.pi * 0.01, 0.0])
    assert data["from"] == pytest.approx(0.1)
    assert data["contacts"]["touching"][0] > 0.0
    assert set(data["contacts"]["force_on"]) <= {"left", "right", "bottom", "top"}
    assert found.to_dict() == data
    for keys, told in (
        ({"across": "z"}, "--across"),
        ({"since": 0.5, "until": 0.2}, "times"),
        ({"since": 9.0}, "times"),
    ):
        with pytest.raises(OutputError, match=told):
            statistics(tmp_path, **keys)  # type: ignore[arg-type]


def test_the_report_of_many_bodies_has_statistics_and_that_of_few_has_none(tmp_path: Path) -> None:
    law = {"law": "spring-dashpot", "range": 0.02, "stiffness": 2000.0}
    balls = [ball([0.17 + 0.3 * (n % 3), 0.2 + 0.3 * (n // 3)], [1.0 - 0.3 * n, 0.4 * n - 1.0]) for n in range(8)]
    pages = []
    for count in (7, 8):
        folder = tmp_path / str(count)
        rigidfluid.run(dry_scene(law, *balls[:count], end=0.1, step=5e-3), folder)
        written = report(folder, sections=(section,))
        pages.append((folder / "report.html").read_text())
        assert ("statistics.png" in {path.name for path in written}) == (count == 8)
    assert "Statistics" not in pages[0]
    assert ">Statistics</a>" in pages[1]
    assert "<li>share with a contact: " in pages[1]


def test_one_body_with_stresslets_has_no_statistics_in_its_report() -> None:
    system = SimpleNamespace(prescribed=np.array([True, False]))
    one = SimpleNamespace(folder=Path(), system=system, present=np.ones((3, 2), dtype=bool))
    tables = {"stresslets": {"step": np.arange(3)}}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rigidfluid.post.statistics.report_section.load_results", lambda folder: folder)
        patch.setattr("rigidfluid.post.statistics.report_section.tables_of", lambda _: tables)
        assert section(cast("Results", one)) == Section()


def test_the_report_says_why_a_run_has_no_statistics(tmp_path: Path) -> None:
    balls = [ball([0.17 + 0.3 * (n % 3), 0.2 + 0.3 * (n // 3)], [0.0, 0.0]) for n in range(8)]
    run = Simulation(dry_scene({}, *balls, end=0.06, step=1e-2), tmp_path)
    run.go(0.01)
    for number in range(7):
        run.remove(f"body{number}")
    run.go()
    run.finish("complete")
    run.close()
    report(tmp_path, sections=(section,))
    assert (
        "None: 5 states, with at most 1 bodies that move. rigidfluid statistics"
        in (tmp_path / "report.html").read_text()
    )


def test_the_stress_of_each_cause_is_in_a_table() -> None:
    figures = StressFigures(mean(np.eye(2)[None]), mean(np.array([3.0])), mean(np.array([[0.5]])), None)
    found = _stresses(SuspensionStress({"fluid": figures}, None, None), "force/length")
    assert '<td class="n">fluid</td><td class="n">3</td><td class="n"></td><td class="n">0.5</td>' in found


def test_gaps_are_those_of_bodies_with_something_near() -> None:
    samples = made(np.full((8, 3, 2), 0.5))
    samples.gap[:, 1] = np.inf
    samples.gap[3] = np.inf
    np.testing.assert_allclose(mean_gap(samples.gap)[[0, 3]], [0.1, np.nan])
    assert mean(mean_gap(samples.gap)).to_list() == [None, None]


def test_a_single_body_has_none(tmp_path: Path) -> None:
    rigidfluid.run(dry_scene({}, ball([0.5, 0.5], [0.1, 0.0]), end=0.02, step=1e-2), tmp_path)
    with pytest.raises(OutputError, match="1 bodies that move"):
        statistics(tmp_path)


def sheared(dimension: int, **more: Any) -> System:
    """Two balls between walls across z, or in 2D y, that slide past each other at a rate of 2, in a fluid of viscosity
    3."""
    across = dimension - 1
    faces = ("bottom", "top") if dimension == 2 else ("back", "front")
    tables = {
        "scene": {"name": "sheared", "dimension": dimension},
        "fluid": {"model": "stokes", "density": 1.0, "viscosity": 3.0},
        "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
        "boundary": [
            {"on": face, "type": "wall", "velocity": [speed, *[0.0] * across]}
            for face, speed in zip(faces, (-1.0, 1.0), strict=True)
        ],
        "body": [
            {
                "name": f"ball{n}",
                "type": "sphere",
                "radius": 0.1,
                "density": 1.0,
                "position": [0.3 + 0.3 * n] * dimension,
            }
            for n in range(2)
        ],
        "mesh": {"size": 0.2, "size_body": 0.05},
        "time": {"end": 1.0, "step": 0.1},
        "output": {"every": 1.0},
    }
    return assemble(model_of(rigidfluid.scene_from_dict(tables | more)))


@pytest.mark.parametrize("dimension", [2, 3])
def test_tractions_are_forces_over_areas_and_the_wall_that_slides_along_is_held_back(dimension: int) -> None:
    """At a rate of 2 in a fluid of viscosity 3: one wall goes along x, and the other one back."""
    random, shear = np.random.default_rng(5), shear_of_walls(sheared(dimension))
    assert shear is not None
    way = {"top": 1.0, "front": 1.0, "bottom": -1.0, "back": -1.0}[shear.wall]
    samples, forces = made(random.random((32, 2, dimension)), shear=shear), random.normal(size=(64, 2, dimension))
    walls = np.array([shear.wall, "other"] * 32)
    table = {"step": np.repeat(samples.step, 2), "wall": walls, "area": np.tile([4.0, 5.0], 32)} | {
        f"{kind}f{axis}": forces[:, column, n]
        for column, kind in enumerate(("", "contact_"))
        for n, axis in enumerate("xyz"[:dimension])
    }
    found, tractions = wall_stresses(samples, table), forces.sum(axis=1)
    assert found is not None
    np.testing.assert_allclose(found.by_surface[shear.wall].value, tractions[::2].mean(axis=0) / 4.0)
    np.testing.assert_allclose(found.by_surface["other"].value, tractions[1::2].mean(axis=0) / 5.0)
    assert found.relative_viscosity is not None
    assert found.relative_viscosity.value == pytest.approx(-way * tractions[::2, 0].mean() / 4.0 / 6.0)
    assert wall_stresses(replace(samples, step=samples.step + 100.0), table) is None


@pytest.mark.parametrize("dimension", [2, 3])
def test_stresses_differ_along_the_flow_across_it_and_along_the_vorticity(dimension: int) -> None:
    """With the walls across z the directions of flow, gradient and vorticity are x, z and y."""
    random = np.random.default_rng(5)
    samples = made(random.random((32, 2, dimension)), shear=shear_of_walls(sheared(dimension)))
    single = random.normal(size=(64, dimension, dimension))
    single = single + single.swapaxes(1, 2)
    rows, columns = np.triu_indices(dimension)
    table = {"step": np.repeat(samples.step, 2), "body": np.array(["ball0", "ball1"] * 32)} | {
        f"s{'xyz'[row]}{'xyz'[column]}": single[:, row, column] for row, column in zip(rows, columns, strict=True)
    }
    by_fluid = single.reshape(32, 2, dimension, dimension).sum(axis=1)
    by_contacts = random.normal(size=(32, dimension, dimension))
    found = suspension_stress(samples, table, {"contacts": by_contacts})
    assert found is not None
    assert found.relative_viscosity is not None
    assert found.shear_rate == pytest.approx(2.0)
    last = dimension - 1
    for cause, stress in {"fluid": by_fluid, "contacts": by_contacts, "total": by_fluid + by_contacts}.items():
        figures = found.by_cause[cause]
        assert figures.differences is not None
        differences = [stress[:, 0, 0] - stress[:, last, last], stress[:, last, last] - stress[:, 1, 1]]
        known = mean(np.stack(differences[:last], axis=1))
        np.testing.assert_allclose(figures.differences.value, known.value, atol=1e-12)
        np.testing.assert_allclose(figures.differences.error, known.error, rtol=1e-9)
        assert figures.pressure.value == pytest.approx(-np.trace(stress.mean(axis=0)) / dimension)
    shearing = 0.5 * (by_contacts[:, 0, last] + by_contacts[:, last, 0]) + by_fluid[:, 0, last]
    assert found.relative_viscosity.value == pytest.approx(1.0 + shearing.mean() / 6.0)
    assert found.relative_viscosity.error == pytest.approx(mean(shearing / 6.0).error)


def test_a_fluid_whose_viscosity_varies_has_no_relative_viscosity() -> None:
    """Its own stress changes with the bodies, so that theirs is not all that they add."""
    material = {"type": "power_law", "viscosity": 3.0, "shear_rate": 1.0, "exponent": 0.5, "least_shear_rate": 0.1}
    shear = shear_of_walls(sheared(2, fluid={"model": "stokes", "density": 1.0, "material": material}))
    samples = made(np.random.default_rng(5).random((4, 2, 2)), shear=shear)
    names = {"step": np.repeat(samples.step, 2), "body": np.array(["ball0", "ball1"] * 4)}
    found = suspension_stress(samples, names | {name: np.ones(8) for name in ("sxx", "sxy", "syy")}, {})
    assert found is not None
    assert found.shear_rate == pytest.approx(2.0)
    assert found.relative_viscosity is None
    assert found.by_cause["total"].viscosity is None
    assert found.by_cause["total"].differences is not None
    json.dumps(found.to_dict(), allow_nan=False)


@pytest.mark.parametrize("sliding", [False, True])
def test_what_a_film_resists_is_apart_from_what_its_contact_repels(tmp_path: Path, sliding: bool) -> None:
    """Of the stress of the law that repels and the film's, the first alone follows from the gaps."""
    repelling = {"law": "spring-dashpot", "range": 0.1, "stiffness": 50.0}
    film = {"law": "lubrication", "range": 0.1, "viscosity": 0.2, "cutoff": 0.01, "sliding": sliding}
    balls = [ball([0.35, 0.5], [0.5, 0.3]), ball([0.62, 0.55], [-0.5, 0.0]), ball([0.4, 0.8], [0.0, -0.4])]
    scene = dry_scene(repelling, *balls, end=0.3, step=5e-3)
    tables = scene.model_dump(mode="json", exclude_none=True)
    del tables["contact"]
    tables["interaction"] = [repelling, film]
    run = rigidfluid.run(rigidfluid.scene_from_dict(tables), tmp_path)
    results = read_results(tmp_path, motion_only=True)
    samples = samples_of(results, 0.005, None)
    rows = contact_rows(samples, run.table("contacts"))
    pairs = rows.selected(rows.paired)
    assert len(pairs.state) > 10
    found = contact_stresses(results, pairs)
    assert found.keys() == {"contacts", "lubrication"}
    repelled = 50.0 * (0.1 - pairs.columns["gap"])[:, None] * pairs.vectors("n")
    np.testing.assert_allclose(found["contacts"], pairs.stress(repelled), rtol=1e-6, atol=1e-6)
    assert np.abs(found["lubrication"]).max() > 0.01


def test_a_run_in_a_fluid_without_stresslets_tells_how_to_have_the_stress(tmp_path: Path) -> None:
    disk = {"type": "sphere", "radius": 0.1, "density": 2.0}
    disks = [disk | {"position": [x, 0.5], "velocity": [0.1, 0.0]} for x in (0.3, 0.7)]
    mesh = {"size": 0.3, "size_body": 0.15}
    hints = []
    for asked in (False, True):
        tables = wet_tables(*disks, mesh=mesh, end=0.02, step=0.01, output={"stresslets": asked})
        rigidfluid.run(rigidfluid.scene_from_dict(tables), tmp_path)
        found, _ = statistics(tmp_path, since=0.01)
        hints.append([line for line in found.lines if "output.stresslets = true" in line])
    assert [len(each) for each in hints] == [1, 0]


@pytest.mark.long
def test_the_viscosity_of_a_sheared_suspension_is_what_its_walls_feel(tmp_path: Path) -> None:
    """Two free disks between walls that slide, in Stokes flow: by stresslets, and by the walls' power."""
    disk = {"type": "sphere", "radius": 1.0, "density": 1e-9}
    disks = [disk | {"position": place} for place in ([3.0, 4.0], [9.0, 8.0])]
    walls = [
        {"on": "all", "type": "periodic"},
        {"on": "bottom", "type": "wall", "velocity": [-6.0, 0.0]},
        {"on": "top", "type": "wall", "velocity": [6.0, 0.0]},
    ]
    scene = rigidfluid.scene_from_dict(
        {
            "scene": {"name": "sheared", "dimension": 2},
            "fluid": {"model": "stokes", "density": 1.0, "viscosity": 2.0},
            "domain": {"lower": [0.0, 0.0], "upper": [12.0, 12.0]},
            "boundary": walls,
            "body": disks,
            "mesh": {"size": 1.5, "size_body": 0.3},
            "time": {"end": 0.02, "step": 0.005},
            "output": {"every": 0.02, "stresslets": True, "walls": True},
        }
    )
    history = rigidfluid.run(scene, tmp_path)
    found, _ = statistics(tmp_path, since=0.005)
    assert found.suspension is not None
    assert found.suspension.relative_viscosity is not None
    assert found.suspension.shear_rate == pytest.approx(1.0)
    energy = history.energy
    power = (energy["boundary"][-1] - energy["boundary"][1]) / (energy["time"][-1] - energy["time"][1])
    assert found.suspension.relative_viscosity.value == pytest.approx(power / (2.0 * 144.0), rel=1e-4)
    assert found.suspension.relative_viscosity.value > 1.04
    told = json.loads((tmp_path / "statistics.json").read_text())["suspension_stress"]
    assert told["fluid"]["stress"][0][0][1] == pytest.approx(2.0 * (told["relative_viscosity"][0] - 1.0), rel=1e-6)
    assert told["fluid"]["viscosity"][0] == pytest.approx(told["relative_viscosity"][0] - 1.0, rel=1e-12)
    assert any(line.startswith("viscosity over that of the fluid: 1.") for line in found.lines)
    assert found.walls is not None
    assert found.walls.relative_viscosity is not None
    assert found.walls.relative_viscosity.value == pytest.approx(found.suspension.relative_viscosity.value, rel=1e-6)
    assert any(line.startswith("viscosity at the walls over that of the fluid: 1.") for line in found.lines)
