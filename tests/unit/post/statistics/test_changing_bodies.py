"""Statistics of runs whose bodies enter and leave: each mean against the tables, state by state."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from scenes import wet_tables

import rigidfluid
from rigidfluid.api import Simulation, load_results
from rigidfluid.post.reports import report
from rigidfluid.post.statistics import section, statistics
from rigidfluid.post.statistics.blocks import mean
from rigidfluid.post.statistics.contact_network import contact_network
from rigidfluid.post.statistics.contact_rows import contact_rows
from rigidfluid.post.statistics.diffusion import diffusion
from rigidfluid.post.statistics.figures import Statistics
from rigidfluid.post.statistics.gap_distribution import gap_distribution
from rigidfluid.post.statistics.pair_distribution import pair_distribution, shell_shares
from rigidfluid.post.statistics.presence import presence
from rigidfluid.post.statistics.profiles import profile
from rigidfluid.post.statistics.samples import Samples
from rigidfluid.post.statistics.structure_factor import structure_factor

State = dict[str, np.ndarray]
LAW = {"law": "spring-dashpot", "range": 0.02, "stiffness": 200.0}
BALLS = [
    ball([0.2 + 0.25 * (n % 3), 0.3 + 0.3 * (n // 3)], [1.0 - 0.3 * n, 0.4 * n - 1.0], radius=0.07 + 0.005 * n)
    for n in range(6)
]
SINCE = 0.05


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six balls in a box, of which two leave at different times; two more enter, one of which leaves again."""
    path = tmp_path_factory.mktemp("run")
    run = Simulation(dry_scene(LAW, *BALLS, end=0.6, step=5e-3), path)
    for time, enters, leaves in (
        (0.15, None, "body3"),
        (0.25, ball([0.08, 0.4], [0.3, -0.8], radius=0.05, name="guest"), "body0"),
        (0.4, None, "guest"),
        (0.45, ball([0.92, 0.62], [0.0, 0.0], radius=0.05, name="late"), None),
    ):
        run.go(time)
        if leaves:
            run.remove(leaves)
        if enters:
            run.add(enters)
    run.go()
    run.finish("complete")
    run.close()
    return path


@pytest.fixture(scope="module")
def measured(folder: Path) -> Statistics:
    return statistics(folder, since=SINCE)[0]


@pytest.fixture(scope="module")
def states(folder: Path, measured: Statistics) -> list[State]:
    """Rows of the table of bodies by state."""
    table = load_results(folder).bodies
    rows = [table["step"] == step for step in measured.samples.step]
    return [{name: column[here] for name, column in table.items()} for here in rows]


def place(state: State) -> np.ndarray:
    return np.stack([state["x"], state["y"]], axis=1)


def volumes(measured: Statistics, state: State) -> np.ndarray:
    radius = dict(zip(measured.samples.name, measured.samples.radius, strict=True))
    return np.array([np.pi * radius[name] ** 2 for name in state["body"]])


def test_bodies_are_counted_state_by_state(measured: Statistics, states: list[State]) -> None:
    count = np.array([len(state["body"]) for state in states])
    assert set(measured.samples.name) == {*(f"body{n}" for n in range(6)), "guest", "late"}
    assert set(count.tolist()) == {4, 5, 6}
    told = measured.to_dict()
    assert told["bodies"] == 8
    assert told["present"]["mean"] == pytest.approx([count.mean(), mean(count).error])
    assert (told["present"]["least"], told["present"]["most"]) == (4, 6)
    volume = np.array([volumes(measured, state).sum() for state in states])
    assert told["volume_fraction"] == pytest.approx([volume.mean(), mean(volume).error])
    assert measured.lines[0] == f"4 to 6 of 8 bodies, {volume.mean():.3g} of the volume"


def test_means_are_over_the_bodies_that_are_there(measured: Statistics, states: list[State]) -> None:
    velocity = [np.stack([state["vx"], state["vy"]], axis=1) for state in states]
    for found, values in (
        (measured.gap, [state["gap"].mean() for state in states]),
        (measured.velocity, [one.mean(axis=0) for one in velocity]),
        (measured.fluctuations, [one.std(axis=0) for one in velocity]),
        (
            measured.gaps.gap,
            [
                np.sort(state["gap"])[np.ceil(measured.gaps.share * len(state["gap"])).astype(int) - 1]
                for state in states
            ],
        ),
    ):
        np.testing.assert_allclose(found.value, np.mean(values, axis=0), rtol=1e-9)
        np.testing.assert_allclose(found.error, mean(np.array(values)).error, rtol=1e-9)


def test_pairs_are_those_of_each_state_over_those_of_as_many_independent_places(
    measured: Statistics, states: list[State]
) -> None:
    width = measured.pairs.distance[1] - measured.pairs.distance[0]
    edges = np.append(measured.pairs.distance - 0.5 * width, measured.pairs.distance[-1] + 0.5 * width)
    sides = np.full(2, 1.0 - 2.0 * measured.samples.radius.mean())
    shares = shell_shares(edges, sides, np.zeros(2, dtype=bool))
    ratios = []
    for state in states:
        upper = np.triu_indices(len(state["body"]), 1)
        apart = np.linalg.norm(place(state)[:, None] - place(state), axis=2)[upper]
        ratios.append(np.histogram(apart, edges)[0] / (len(apart) * shares))
    np.testing.assert_allclose(measured.pairs.value.value, np.mean(ratios, axis=0), atol=1e-9)
    assert measured.pairs.value.value.max() > 1.0


def test_waves_are_over_the_number_of_bodies_in_each_state(measured: Statistics, states: list[State]) -> None:
    """The longest ones, along both axes and both diagonals."""
    waves = 2.0 * np.pi * np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]])
    longest = [
        np.mean(np.abs(np.exp(1j * waves @ place(state).T).sum(axis=1)) ** 2) / len(state["body"]) for state in states
    ]
    assert measured.structure.value.value[0] == pytest.approx(np.mean(longest))


def test_contacts_are_shared_among_the_bodies_that_are_there(
    folder: Path, measured: Statistics, states: list[State]
) -> None:
    table, walls = load_results(folder).contacts, ("left", "right", "bottom", "top")
    figures: dict[str, list[Any]] = {name: [] for name in ("coordination", "touching", "largest", "stress", "left")}
    for state in states:
        here, count = table["step"] == state["step"][0], len(state["body"])
        rows = [{name: column[here][row] for name, column in table.items()} for row in range(here.sum())]
        pairs = [(row["a"], row["b"]) for row in rows if row["a"] not in walls and row["b"] not in walls]
        groups = [{name} for name in state["body"]]
        for pair in pairs:
            joined = set().union(*(group for group in groups if group & set(pair)))
            groups = [group for group in groups if not group & joined] + [joined]
        centre = dict(zip(state["body"], place(state), strict=True))
        forces = [
            -np.outer([row["fx"], row["fy"]], centre[row["a"]] - centre[row["b"]])
            for row in rows
            if (row["a"], row["b"]) in pairs
        ]
        figures["coordination"].append(2.0 * len(pairs) / count)
        figures["touching"].append(len({row[side] for row in rows for side in "ab"} - set(walls)) / count)
        figures["largest"].append(max(map(len, groups)) / count)
        figures["stress"].append(np.sum(forces, axis=0) if forces else np.zeros((2, 2)))
        figures["left"].append(sum((-row["fx"] for row in rows if row["b"] == "left"), 0.0))
    found = measured.contacts
    assert found.coordination.value > 0.0
    for value, name in (
        (found.coordination.value, "coordination"),
        (found.touching.value, "touching"),
        (found.largest.value, "largest"),
        (found.stress.value, "stress"),
        (found.on_walls["left"].value[0], "left"),
    ):
        np.testing.assert_allclose(value, np.mean(figures[name], axis=0), atol=1e-9, err_msg=name)


def test_layers_hold_the_bodies_that_are_there(measured: Statistics, states: list[State]) -> None:
    """Over all layers the share is that of all, the momentum too; in each the share is that of points in the bodies."""
    whole = measured.profile.fraction.value
    moved = [volumes(measured, state) @ np.stack([state["vx"], state["vy"]], axis=1) for state in states]
    carried = np.nan_to_num(measured.profile.velocity.value) * whole[:, None] / 20.0
    np.testing.assert_allclose(carried.sum(axis=0), np.mean(moved, axis=0), atol=1e-9)
    points = (np.arange(200) + 0.5) / 200.0
    grid = np.stack(np.meshgrid(points, points, indexing="ij"), axis=-1)
    inside = np.zeros(20)
    for state in states:
        for centre, volume in zip(place(state), volumes(measured, state), strict=True):
            within = np.linalg.norm(grid - centre, axis=2) < np.sqrt(volume / np.pi)
            inside += within.mean(axis=0).reshape(20, 10).mean(axis=1) / len(states)
    np.testing.assert_allclose(whole, inside, atol=2e-3)


def test_velocities_in_layers_spread_about_those_of_the_bodies_there(measured: Statistics) -> None:
    """A body that has left leaves no velocity of zero behind: with one velocity for all there is no spread."""
    samples = measured.samples
    one = replace(samples, velocity=np.where(samples.present[..., None], [3.0, -1.0], np.nan))
    found = profile(one, 1, None)
    filled = np.isfinite(found.velocity.value[:, 0])
    assert filled.sum() > 15
    np.testing.assert_allclose(found.velocity.value[filled].mean(axis=0), [3.0, -1.0], atol=0.2)
    np.testing.assert_allclose(found.fluctuations.value[filled], 0.0, atol=1e-6)


def test_displacements_are_those_of_bodies_that_are_there_so_long(measured: Statistics, states: list[State]) -> None:
    for lag in (1, 20, len(measured.diffusion.lag)):
        square = []
        for first, last in zip(states[:-lag], states[lag:], strict=True):
            ends = [dict(zip(state["body"], place(state), strict=True)) for state in (first, last)]
            way = np.array([ends[1][name] - at for name, at in ends[0].items() if name in ends[1]])
            square.append((way - way.mean(axis=0)) ** 2)
        np.testing.assert_allclose(measured.diffusion.displacement[lag - 1], np.concatenate(square).mean(axis=0))


def made(position: np.ndarray, **more: Any) -> Samples:
    """Balls in a unit box at places (s, n, 2), not a number where they are not there."""
    there = np.isfinite(position[..., 0])
    values: dict[str, Any] = {
        "velocity": np.where(there[..., None], [1.0, 1.0], np.nan),
        "angular_velocity": np.where(there[..., None], 1.0, np.nan),
        "gap": np.where(there, 0.1, np.inf),
    }
    states, count = there.shape
    return Samples(
        step=np.arange(states, dtype=float),
        time=0.1 * np.arange(states),
        position=position,
        radius=np.full(count, 0.0625),
        name=tuple(f"ball{number}" for number in range(count)),
        lower=np.zeros(2),
        upper=np.ones(2),
        volume=1.0,
        period=np.full(2, np.inf),
        shear=None,
        **(values | more),
    )


def figures_of(samples: Samples) -> list[np.ndarray]:
    a, b = (np.array([name] * len(samples.step)) for name in ("ball0", "ball3"))
    ones = np.ones(len(samples.step))
    table = {"step": samples.step, "a": a, "b": b, "fx": ones, "fy": ones, "bx": ones, "by": ones}
    contacts, layers, told = contact_network(contact_rows(samples, table)), profile(samples, 1, None), presence(samples)
    means = [
        *(contacts.coordination, contacts.touching, contacts.largest, contacts.stress),
        *(layers.fraction, layers.velocity, layers.fluctuations),
        *(told.mean, told.fraction),
        *(pair_distribution(samples).value, structure_factor(samples).value, gap_distribution(samples).gap),
    ]
    spread = diffusion(samples)
    return [*(part for one in means for part in one), spread.displacement, spread.coefficient]


def test_a_body_that_is_never_there_changes_nothing() -> None:
    random = np.random.default_rng(3)
    position, velocity = random.random((40, 6, 2)), random.normal(size=(40, 6, 2))
    turning, gap = random.normal(size=(40, 6, 1)), random.random((40, 6))
    with_one_more = [np.insert(values, 5, np.nan, axis=1) for values in (position, velocity, turning)]
    all_there = made(position, velocity=velocity, angular_velocity=turning, gap=gap)
    other = made(
        with_one_more[0],
        velocity=with_one_more[1],
        angular_velocity=with_one_more[2],
        gap=np.insert(gap, 5, np.inf, axis=1),
    )
    for one, same in zip(figures_of(all_there), figures_of(other), strict=True):
        np.testing.assert_allclose(one, same, rtol=1e-12, atol=1e-12)


def test_of_bodies_that_all_stay_they_are_the_means_of_whole_arrays() -> None:
    """To the last bit."""
    random = np.random.default_rng(5)
    samples = made(np.cumsum(0.01 * random.normal(size=(40, 11, 2)), axis=0), gap=random.random((40, 11)))
    own = samples.position - samples.position.mean(axis=1, keepdims=True)
    square = np.array([((own[lag:] - own[:-lag]) ** 2).mean(axis=(0, 1)) for lag in range(1, 21)])
    time = samples.interval * np.arange(11, 21)
    away = time - time.mean()
    velocity = random.normal(size=(40, 11, 2))
    gap = np.quantile(samples.gap, np.linspace(0.05, 0.95, 19), axis=1, method="inverted_cdf").T
    for found, wanted in (
        (diffusion(samples).displacement, square),
        (diffusion(samples).coefficient, 0.5 * (away @ square[10:] / (away @ away))),
        (gap_distribution(samples).gap.value, gap.mean(axis=0)),
        (samples.map_states(partial(np.mean, axis=0), velocity), velocity.mean(axis=1)),
        (samples.map_states(partial(np.std, axis=0), velocity), velocity.std(axis=1)),
        (presence(samples).mean.to_list(), [11.0, 0.0]),
        (presence(samples).fraction.to_list(), [samples.body_volume.sum(), 0.0]),
    ):
        np.testing.assert_array_equal(found, wanted)


def test_states_without_bodies_count_as_empty_and_have_no_figures_of_bodies() -> None:
    random = np.random.default_rng(3)
    position = random.random((40, 6, 2))
    some = position.copy()
    some[:20] = np.nan
    late, half = made(position[20:]), made(some)
    assert presence(half).mean.value == 3.0
    assert presence(half).fraction.value == pytest.approx(0.5 * presence(late).fraction.value)
    for figure in (pair_distribution, structure_factor):
        np.testing.assert_array_equal(figure(half).value.value, figure(late).value.value)
    np.testing.assert_array_equal(gap_distribution(half).gap.value, gap_distribution(late).gap.value)
    np.testing.assert_allclose(profile(half, 0, None).fraction.value, 0.5 * profile(late, 0, None).fraction.value)
    np.testing.assert_allclose(profile(half, 0, None).velocity.value, profile(late, 0, None).velocity.value)


def test_states_with_one_body_have_its_figures_and_no_pairs() -> None:
    """One body in half of the states, two near each other in the others."""
    position = np.tile([[0.5, 0.5], [0.5, 0.7]], (40, 1, 1))
    position[:20, 1] = np.nan
    gap = np.where(np.isfinite(position[..., 0]), np.arange(40.0)[:, None], np.inf)
    samples, two = made(position, gap=gap), made(position[20:])
    np.testing.assert_allclose(gap_distribution(samples).gap.value, 19.5)
    pairs = pair_distribution(two).value.value
    assert pairs.max() > 1.0
    np.testing.assert_array_equal(pair_distribution(samples).value.value, pairs)


def test_a_single_lag_has_no_slope() -> None:
    found = diffusion(made(np.random.default_rng(3).random((2, 5, 2))))
    assert np.isfinite(found.displacement).all()
    assert np.isnan(found.coefficient).all()


def test_nobody_diffuses_over_lags_longer_than_two_bodies_are_there() -> None:
    """Bodies that are there for four states each, one after the other, two at a time."""
    position = np.full((24, 12, 2), np.nan)
    random = np.random.default_rng(3)
    for body, state in product(range(12), range(24)):
        if 4 * (body // 2) <= state < 4 * (body // 2 + 1):
            position[state, body] = random.random(2)
    found = diffusion(made(position))
    np.testing.assert_array_equal(np.isfinite(found.displacement[:, 0]), np.arange(12) < 3)
    slope = (found.displacement[2] - found.displacement[1]) / (found.lag[2] - found.lag[1])
    np.testing.assert_allclose(found.coefficient, 0.5 * slope)
    position[:, 1::2] = np.nan
    alone = diffusion(made(position))
    assert np.isnan(alone.displacement).all()
    assert np.isnan(alone.coefficient).all()


def test_files_and_the_report_have_them(folder: Path, tmp_path: Path) -> None:
    """Also of lags over which nobody is there; a report of a run of eight bodies at a time has the section."""
    found, files = statistics(folder, since=0.4, until=0.6)
    assert json.loads(files[0].read_text(encoding="utf-8")) == found.to_dict()
    balls = [ball([0.17 + 0.3 * (n % 3), 0.2 + 0.3 * (n // 3)], [0.0, 0.1 * n]) for n in range(8)]
    for most in (7, 8):
        run = Simulation(dry_scene(LAW, *balls[:most], end=0.2, step=1e-2), tmp_path / str(most))
        run.go(0.1)
        run.remove("body3")
        run.add(balls[3] | {"name": "guest"})
        run.go()
        run.finish("complete")
        run.close()
        report(tmp_path / str(most), sections=(section,))
    pages = [(tmp_path / str(most) / "report.html").read_text(encoding="utf-8") for most in (7, 8)]
    assert ["<li>8 of 9 bodies, " in page for page in pages] == [False, True]
    assert "Statistics" not in pages[0]


def test_stresses_are_those_of_the_bodies_that_are_there(tmp_path: Path) -> None:
    """In a fluid: the fluid's part by the table of stresslets, and tractions by that of walls."""
    disk = {"type": "sphere", "radius": 0.1, "density": 2.0}
    disks = [disk | {"position": [x, 0.5], "velocity": [0.0, 0.3]} for x in (0.25, 0.75)]
    keys: dict[str, Any] = {"mesh": {"size": 0.3, "size_body": 0.15}, "output": {"stresslets": True, "walls": True}}
    run = Simulation(rigidfluid.scene_from_dict(wet_tables(*disks, end=0.06, step=0.01, **keys)), tmp_path)
    run.go(0.03)
    run.add(disk | {"name": "guest", "position": [0.5, 0.2]})
    run.go(0.05)
    run.remove("body0")
    run.go()
    run.finish("complete")
    run.close()
    found, results = statistics(tmp_path, since=0.01)[0], load_results(tmp_path)
    assert found.presence.to_dict() | {"mean": None} == {"mean": None, "least": 2, "most": 3}
    assert found.suspension is not None
    assert found.walls is not None
    table, stress = results.stresslets, found.suspension.by_cause["fluid"].stress.value
    known = np.isin(table["step"], found.samples.step)
    for row, column in ("xx", "xy", "yy"):
        wanted = table[f"s{row}{column}"][known].sum() / len(found.samples.step)
        assert stress["xy".index(row), "xy".index(column)] == pytest.approx(wanted)
    bottom = np.isin(results.walls["step"], found.samples.step) & (results.walls["wall"] == "bottom")
    wanted = (results.walls["fy"] / results.walls["area"])[bottom].mean()
    assert found.walls.by_surface["bottom"].value[1] == pytest.approx(wanted)
