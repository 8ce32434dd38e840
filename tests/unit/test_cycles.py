"""What the summary and the report say of the cycles of mechanisms."""

import json

import numpy as np
import pytest
from articulated_scenes import OUT, WAG, scene

import rigidfluid
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns
from rigidfluid.core.run.cycles import cycles
from rigidfluid.reports.report import report


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


def test_what_is_rigid_has_no_cycles():
    assert "cycles" not in rigidfluid.run(scene()).summary
