"""The benchmarks of the command line, on meshes small enough for a test."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from rigidfluid.cli import app
from rigidfluid.core.model.interfaces import PartOptions
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.evaluation.bench.collisions import PAPER
from rigidfluid.evaluation.bench.grids import RANGE, balls_in_a_box


def test_narrow_band_writes_a_row_for_each_band(tmp_path):
    file = tmp_path / "rows.json"
    result = CliRunner().invoke(app, ["bench", "narrow-band", "--refinement", "0.4", "--json", str(file)])
    assert result.exit_code == 0
    rows = json.loads(file.read_text())
    assert [row["dimension"] for row in rows] == [2] * 6 + [3] * 5
    assert len(result.stdout.splitlines()) == len(rows) + 1
    assert all(row["max_error"] <= 1e-12 for row in rows)
    assert all(row["seconds"] > 0 and row["seconds_two_threads"] > 0 for row in rows)
    full = [row for row in rows if row["threshold"] == 1.9]
    assert all(row["band_elements"] == row["elements"] for row in full)


@pytest.mark.validation
def test_collisions_counts_the_contacts_of_the_paper(tmp_path):
    file = tmp_path / "rows.json"
    result = CliRunner().invoke(app, ["bench", "collisions", "--most-bodies", "25", "--json", str(file)])
    assert result.exit_code == 0
    rows = json.loads(file.read_text())
    assert [(row["dimension"], row["bodies"]) for row in rows] == [(2, 1), (2, 25), (3, 1)]
    for row in rows:
        assert row["body_body"] == row["paper_body_body"]
        assert row["body_wall"] == row["paper_body_wall"]


@pytest.mark.parametrize(("dimension", "table"), PAPER.items())
def test_grids_have_the_contacts_of_the_paper(dimension, table):
    for count, (pairs, at_walls) in table.items():
        balls, pose, _, walls = balls_in_a_box(dimension, count)
        contacts = SphereDetector(PartOptions(), balls, walls).detect(pose, None, RANGE)
        at_wall = contacts.body_b >= count
        assert (np.count_nonzero(~at_wall), len(set(contacts.body_a[at_wall]))) == (pairs, at_walls)
