"""The benchmarks of the command line, on meshes small enough for a test."""

import json

from typer.testing import CliRunner

from rigidfluid.cli import app


def test_narrow_band_writes_a_row_for_each_band(tmp_path):
    file = tmp_path / "rows.json"
    result = CliRunner().invoke(app, ["bench", "narrow-band", "--refinement", "0.4", "--json", str(file)])
    assert result.exit_code == 0
    rows = json.loads(file.read_text())
    assert [row["dimension"] for row in rows] == [2] * 6 + [3] * 5
    assert len(result.stdout.splitlines()) == len(rows) + 1
    assert all(row["max_error"] <= 1e-12 for row in rows)
    assert all(0 < row["seconds"] <= row["seconds_one_thread"] for row in rows)
    full = [row for row in rows if row["threshold"] == 1.9]
    assert all(row["band_elements"] == row["elements"] for row in full)
