"""The benchmarks after the paper's tables, on meshes small enough for a test."""

import json
import sys

import numpy as np
import pytest
from benchmark_scripts import benchmark

from rigidfluid.core.model.part import PartOptions
from rigidfluid.detectors.sphere import SphereDetector


@pytest.fixture(scope="module")
def narrow_band():
    with benchmark("narrow_band") as module:
        yield module


@pytest.fixture(scope="module")
def collisions():
    with benchmark("collisions") as module:
        yield module


def rows_of(script, tmp_path, monkeypatch, *arguments):
    """What a benchmark writes, called with arguments."""
    file = tmp_path / "rows.json"
    monkeypatch.setattr(sys, "argv", [script.__file__, *arguments, "--json", str(file)])
    script.main()
    return json.loads(file.read_text())


@pytest.mark.long
def test_narrow_band_writes_a_row_for_each_band(narrow_band, tmp_path, monkeypatch, capsys):
    rows = rows_of(narrow_band, tmp_path, monkeypatch, "--refinement", "0.4")
    assert [row["dimension"] for row in rows] == [2] * 6 + [3] * 5
    assert len(capsys.readouterr().out.splitlines()) == len(rows) + 1
    assert all(row["max_error"] <= 1e-12 for row in rows)
    assert all(row["seconds"] > 0 and row["seconds_two_threads"] > 0 for row in rows)
    full = [row for row in rows if row["threshold"] == 1.9]
    assert all(row["band_elements"] == row["elements"] for row in full)


@pytest.mark.parametrize("refinement", ["0.2", "fine"])
def test_a_refinement_that_makes_no_mesh_is_refused(narrow_band, tmp_path, monkeypatch, capsys, refinement):
    with pytest.raises(SystemExit, match="2"):
        rows_of(narrow_band, tmp_path, monkeypatch, "--refinement", refinement)
    assert "--refinement" in capsys.readouterr().err


def test_rows_that_cannot_be_written_end_in_one_line(tmp_path, capsys):
    with benchmark("row_command") as row_command, pytest.raises(SystemExit, match="2"):
        row_command.show_rows([], tmp_path / "missing" / "rows.json")
    assert capsys.readouterr().err.startswith(f"Error: {tmp_path / 'missing'}")


@pytest.mark.validation
def test_collisions_counts_the_contacts_of_the_paper(collisions, tmp_path, monkeypatch):
    rows = rows_of(collisions, tmp_path, monkeypatch, "--most-bodies", "25")
    assert [(row["dimension"], row["bodies"]) for row in rows] == [(2, 1), (2, 25), (3, 1)]
    for row in rows:
        assert row["body_body"] == row["paper_body_body"]
        assert row["body_wall"] == row["paper_body_wall"]


@pytest.mark.parametrize("dimension", [2, 3])
def test_grids_have_the_contacts_of_the_paper(collisions, dimension):
    for count, (pairs, at_walls) in collisions.PAPER[dimension].items():
        balls, pose, _, walls = collisions.balls_in_a_box(dimension, count)
        contacts = SphereDetector(PartOptions(), balls, walls).detect(pose, None, collisions.RANGE)
        at_wall = contacts.body_b >= count
        assert (np.count_nonzero(~at_wall), len(set(contacts.body_a[at_wall]))) == (pairs, at_walls)
