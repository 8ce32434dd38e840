"""What the summary and the report say of the cycles of mechanisms."""

import json

import numpy as np
import pytest
from articulated_scenes import OUT, WAG, scene
from falling import SCENES

import rigidfluid
from rigidfluid.core.output.energy_account import per_cent
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns
from rigidfluid.core.run.cycles import cycles, start_remarks
from rigidfluid.post.reports.report import report


def history(dimension, places, turns, times):
    """Rows of one whole at these times."""
    width = len(columns(dimension)["bodies"])
    rows = [(time, 0, "it", *place, *turn) for time, place, turn in zip(times, places, turns, strict=True)]
    return History(dimension, {"bodies": [row + (0.0,) * (width - len(row)) for row in rows]})


def test_each_whole_cycle_is_counted_and_an_unfinished_one_is_not():
    found = cycles(history(2, [[0, 0], [1, 0], [3, 1], [9, 9]], [[0], [0.1], [0.4], [2]], [0, 2, 4, 5]), {"it": 2.0})
    assert found["it"]["period"] == 2.0
    np.testing.assert_allclose(found["it"]["displacement"], [[1.0, 0.0], [2.0, 1.0]])
    np.testing.assert_allclose(found["it"]["rotation"], [0.1, 0.3])


def test_a_rotation_in_3d_is_a_vector():
    half = np.sqrt(0.5)
    table = history(3, np.zeros((2, 3)), [[1, 0, 0, 0], [half, 0, 0, half]], [0, 1])
    np.testing.assert_allclose(cycles(table, {"it": 1.0})["it"]["rotation"], [[0.0, 0.0, 0.5 * np.pi]])


def test_cycles_that_end_between_two_steps_or_by_rounding_are_counted_and_others_rows_are_not():
    """By a third of .3 each, about an axis at an even rate; a half of the way between two turns is their mean."""
    half = np.array([0.0, 0.1, 0.2, 0.3])
    turns = [[np.cos(angle), 0.0, 0.0, np.sin(angle)] for angle in 5.0 * half]
    table = history(3, [[x, 0.0, 0.0] for x in half], turns, half)
    (found,) = cycles(table, {"it": 0.1}).values()
    np.testing.assert_allclose(found["rotation"], [[0.0, 0.0, 1.0]] * 3)
    rows = [list(row) for row in zip(*table.table("bodies", columns(3)["bodies"]).values(), strict=True)]
    away = [[*row[:2], "other", *[9.0] * 3, 1.0, *[0.0] * (len(row) - 7)] for row in rows]
    both = History(3, {"bodies": [tuple(row) for pair in zip(rows, away, strict=True) for row in pair]})
    assert cycles(both, {"it": 0.1})["it"] == found
    coarse = history(3, [[0.0] * 3] * 2, [turns[0], turns[2]], [0.0, 0.2])
    np.testing.assert_allclose(cycles(coarse, {"it": 0.1})["it"]["rotation"], [[0.0, 0.0, 1.0]] * 2)


@pytest.mark.long
def test_summary_and_report_have_the_cycles_of_a_run(tmp_path):
    head = OUT | {"period": 0.1}
    run = rigidfluid.run(scene(WAG | {"period": 0.4}, head, end=0.5, velocity=[0.5, 0.0]), tmp_path)
    (only,) = json.loads((tmp_path / "summary.json").read_text())["cycles"]["it"]["displacement"]
    assert only == pytest.approx([0.2, 0.0], abs=1e-12)
    assert run.summary["cycles"]["it"]["period"] == 0.4
    report(tmp_path)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Cycles of it" in page
    assert (tmp_path / "report" / "mechanisms.png").exists()


@pytest.mark.long
def test_what_is_rigid_has_no_cycles():
    assert "cycles" not in rigidfluid.run(scene()).summary


def told(moved, turned, inertia=True):
    return start_remarks({"it": {"period": 1.0, "displacement": moved, "rotation": turned}}, inertia, 0.1)


def test_a_first_cycle_that_differs_from_the_second_is_remarked():
    (remark,) = told([[0.8, 0.0], [1.0, 0.0], [1.0, 0.0]], [0.0, 0.0, 0.0])
    assert remark.grade == "note"
    assert "first cycle of 'it'" in remark.text
    assert "20 % off" in remark.text
    (turn,) = told([[1.0, 0.0], [1.0, 0.0]], [0.3, 0.4], inertia=False)
    assert "rotation" in turn.text
    (three,) = told([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.0, 0.0, 0.0]] * 2)
    assert "141 % off" in three.text


def test_cycles_alike_or_too_small_to_compare_are_not():
    assert told([[0.99, 0.0], [1.0, 0.0]], [0.0, 0.0]) == []
    assert told([[1e-9, 0.0], [-3e-9, 0.0]], [1e-9, 2e-9]) == []
    assert told([], []) == []


def test_a_lone_cycle_is_remarked_where_the_fluid_has_inertia():
    (remark,) = told([[1.0, 0.0]], [0.0])
    assert "no second one" in remark.text
    assert told([[1.0, 0.0]], [0.0], inertia=False) == []


@pytest.mark.long
def test_a_swimmer_from_rest_says_so_in_its_summary():
    """In a fluid with inertia its first cycle is not its second."""
    settings = ["fluid.model=navier-stokes", "fluid.density=3.0", "mesh.size=12", "mesh.size_body=1.0", "time.end=8.0"]
    run = rigidfluid.run(rigidfluid.load_scene(SCENES / "swimmer.toml", [*settings, "time.step=0.25"]))
    first, second = np.array(run.summary["cycles"]["swimmer"]["displacement"])
    off = np.linalg.norm(first - second) / np.linalg.norm(second)
    assert off > 0.02
    texts = [remark["text"] for remark in run.summary["remarks"]]
    assert any("first cycle of 'swimmer'" in text and f"{per_cent(off)} off" in text for text in texts)
