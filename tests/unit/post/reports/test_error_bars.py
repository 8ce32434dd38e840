"""Error bars in a report: on the curves, and in a table of the last output."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from scenes import wet_tables

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.post.reports.error_bars import bars, draw_bars, error_table
from rigidfluid.post.reports.results import read_results


def fallen(folder, **output):
    disk = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 1.5, "position": [0.5, 0.5]}
    tables = wet_tables(disk, end=0.08, step=0.02, fluid={"gravity": [0.0, -1.0]}, output={"every": 0.04, **output})
    rigidfluid.run(scene_from_dict(tables), folder)
    return read_results(folder)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return fallen(tmp_path_factory.mktemp("fallen"), error_bars=True)


def test_bars_are_a_fourth_longer_than_the_corrections_at_the_outputs(results) -> None:
    table, found = (
        np.genfromtxt(results.folder / "error_estimates.csv", delimiter=",", names=True),
        bars(results, "force"),
    )
    assert [results.time[state] for state in found.states] == pytest.approx([0.04, 0.08])
    np.testing.assert_array_equal(found.by_mesh[:, 0, 1], np.abs(table["fy_mesh"]))
    np.testing.assert_array_equal(found.bar[:, 0, 1], 1.25 * (np.abs(table["fy_mesh"]) + np.abs(table["fy_steps"])))


def test_they_are_drawn_around_the_curves(results) -> None:
    axes = Figure().add_subplot()
    draw_bars(axes, results, "force", 1)
    (drawn,) = axes.collections
    ends, found = np.array(drawn.get_segments()), bars(results, "force")
    np.testing.assert_allclose(np.ptp(ends[:, :, 1], axis=1), 2.0 * found.bar[:, 0, 1])
    np.testing.assert_allclose(ends[:, :, 1].mean(axis=1), results.quantity("force")[list(found.states), 0, 1])


def test_the_table_has_values_with_bars_and_both_errors(results) -> None:
    text = "\n".join(error_table(results, 8))
    found = bars(results, "velocity")
    errors = [each[-1, 0, 1] for each in (found.bar, found.by_mesh, found.by_steps)]
    numbers = (results.quantity("velocity")[-1, 0, 1], *errors)
    cells = "".join(f'<td class="n">{number:.5g}</td>' for number in numbers)
    assert f'<td class="n">vy [length/time]</td>{cells}' in text


def test_a_run_without_them_has_none(tmp_path) -> None:
    results = fallen(tmp_path)
    axes = Figure().add_subplot()
    draw_bars(axes, results, "force", 1)
    assert not axes.collections
    assert not list(error_table(results, 8))
