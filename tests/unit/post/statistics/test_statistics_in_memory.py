"""Statistics of runs in memory: those of their folders, also for an observer and of bodies that enter and leave."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from dry_scenes import ball, dry_scene
from page_code import page_blocks
from paths import ROOT
from scenes import wet_tables

import rigidfluid
from rigidfluid import api
from rigidfluid.api import Model, Simulation, load_results, measure_statistics, model_of, scene_from_dict
from rigidfluid.errors import OutputError
from rigidfluid.post.statistics import statistics

SPRING = {"law": "spring-dashpot", "range": 0.02, "stiffness": 200.0}
BALLS = [ball([0.2 + 0.25 * (n % 3), 0.3 + 0.3 * (n // 3)], [1.0 - 0.3 * n, 0.4 * n - 1.0]) for n in range(6)]


def scene(end: float = 0.3) -> rigidfluid.Scene:
    return dry_scene(SPRING, *BALLS, end=end, step=5e-3)


def test_they_are_those_of_the_folder(tmp_path: Path) -> None:
    histories = [rigidfluid.run(scene()), rigidfluid.run(scene(), tmp_path)]
    told, _ = statistics(tmp_path, since=0.1, across="x")
    for run in (*histories, load_results(tmp_path)):
        assert measure_statistics(run, since=0.1, across="x").to_dict() == told.to_dict()
    assert told.to_dict()["contacts"]["touching"][0] > 0.0


@pytest.mark.parametrize("in_folder", [False, True])
def test_an_observer_has_them_at_its_times(tmp_path: Path, in_folder: bool) -> None:
    run, seen = Simulation(scene(), tmp_path if in_folder else None), []
    run.observe(lambda now: seen.append(measure_statistics(now, since=now.time - 0.1).to_dict()), every=0.1)
    run.go()
    run.close()
    assert [(one["from"], one["to"]) for one in seen] == [
        (pytest.approx(to - 0.1), pytest.approx(to)) for to in (0.1, 0.2, 0.3)
    ]
    assert seen[1] == measure_statistics(run, seen[1]["from"], seen[1]["to"]).to_dict()
    assert seen[0]["velocity"] != seen[1]["velocity"]


def test_bodies_that_entered_and_left_are_known() -> None:
    run = Simulation(scene())
    run.go(0.05)
    run.remove("body3")
    run.go(0.1)
    run.add(ball([0.5, 0.85], [0.0, 0.0], name="guest"))
    run.go(0.13)
    run.finish("complete")
    for one in (run, run.history):
        names = [measure_statistics(one, *times).samples.name for times in ((0.0, 0.05), (0.06, 0.1), (0.11, 0.13))]
        assert ["body3" in each for each in names] == [True, False, False]
        assert ["guest" in each for each in names] == [False, False, True]
        told = measure_statistics(one, since=0.0).to_dict()
        assert (told["bodies"], told["present"]["least"], told["present"]["most"]) == (7, 5, 6)


def test_a_run_that_writes_fields_has_the_fluid_in_its_profile(tmp_path: Path) -> None:
    disk = {"type": "sphere", "radius": 0.1, "density": 2.0}
    disks = [disk | {"position": [x, 0.5], "velocity": [0.1, 0.0]} for x in (0.3, 0.7)]
    keys: dict[str, Any] = {"mesh": {"size": 0.3, "size_body": 0.15}, "output": {"every": 0.01, "stresslets": True}}
    found = []
    for out in (None, tmp_path):
        run = Simulation(rigidfluid.scene_from_dict(wet_tables(*disks, end=0.02, step=0.01, **keys)), out)
        run.go()
        found.append(measure_statistics(run, since=0.01).to_dict())
        run.close()
    assert [one["profile"]["fluid_velocity"] is None for one in found] == [True, False]
    assert found[0]["suspension_stress"] == found[1]["suspension_stress"]
    assert found[0]["suspension_stress"]["total"]["pressure"][0] is not None


def test_a_run_without_bodies_has_none() -> None:
    tables = wet_tables({"position": [1.0, 1.0]}, mesh={"size": 0.5, "size_body": 0.5})
    simulation = Simulation(scene_from_dict(tables | {"body": []}))
    simulation.step()
    with pytest.raises(OutputError, match="no bodies"):
        measure_statistics(simulation)


def test_a_history_that_does_not_know_its_bodies_asks_for_the_simulation() -> None:
    run = Simulation(scene(end=0.05))
    run.go()
    with pytest.raises(OutputError, match=r"history: found that of a run which goes on.*Give the Simulation"):
        measure_statistics(run.history)
    of_scene = model_of(scene(end=0.05))
    made = Model(
        **{name: getattr(of_scene, name) for name in ("name", "dimension", "domain", "bodies", "time", "output")}
    )
    history = rigidfluid.run(made)
    with pytest.raises(OutputError, match=r"made in Python.*Give the Simulation"):
        measure_statistics(history)


def test_the_programs_of_the_page_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With a quicker scene of the name that they load, and folders of the names that they read."""
    monkeypatch.chdir(tmp_path)
    slow = [one | {"velocity": [0.2 * speed for speed in one["velocity"]]} for one in BALLS]
    quick = dry_scene(SPRING, *slow, end=3.0, step=1e-2)
    rigidfluid.run(quick, Path("out/hundred_disks"))
    sheared = tomllib.loads((ROOT / "scenes" / "sheared_cell.toml").read_text("utf-8"))
    sheared["output"]["walls"] = True
    rigidfluid.run(scene_from_dict(sheared), Path("out/sheared_cell"))
    monkeypatch.setattr(api, "load_scene", lambda _: quick)
    programs = [block.text for block in page_blocks(ROOT / "docs" / "statistics.md") if block.language == "python"]
    for program in programs:
        exec(compile(program, "statistics.md", "exec"), {})
    assert len(programs) == 3
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == ["1.0", "2.0", "3.0"]
