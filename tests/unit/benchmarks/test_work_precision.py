"""The benchmark of error against run time: passing times, errors, and its page."""

from dataclasses import asdict

import numpy as np
import pytest
from benchmark_scripts import benchmark


@pytest.fixture(scope="module")
def work_precision():
    with benchmark("work_precision") as module:
        yield module


def test_passing_times_of_a_free_fall_are_exact_between_steps(work_precision):
    time = np.linspace(0.0, 1.0, 8)
    found = work_precision.passing_times(time, 4.0 - 4.0 * time**2, -8.0 * time)
    np.testing.assert_allclose(found, np.sqrt([0.5, 0.75, 0.875]), rtol=1e-12)


def test_the_error_is_the_largest_over_the_last_time(work_precision):
    reference = np.array(work_precision.STORED["reference"]["passing_times"])
    assert work_precision.error_of(reference) == 0.0
    assert work_precision.error_of(reference + [0.0, -3e-3, 1e-3]) == pytest.approx(3e-3 / reference[-1])


def test_a_page_says_what_is_measured_and_what_is_stored(work_precision, tmp_path):
    rows = [work_precision.Row("rigidfluid", "0.05, 0.008", 1e-3, 3.21), work_precision.Row("other", "", 2e-3, 1.0)]
    found = {"date": "2026-01-01", "load": 1.0, "cores": 2, "rows": [asdict(row) for row in rows]}
    rows += work_precision.stored()
    page = work_precision.page(found, "picture.png")
    assert "| rigidfluid | 0.05, 0.008 | 1.0e-03 | 3.2 |" in page
    assert page.count("| stored |") == len(work_precision.stored()) == 3
    assert "Stored, not measured with the others: OpenFOAM" in page
    assert "Reference: rigidfluid" in page
    work_precision.plot(rows, tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 1000


@pytest.mark.long
def test_the_script_beside_falls_as_the_reference_does(work_precision):
    pytest.importorskip("ngsolve")
    assert work_precision.ngsolve(0.4, 0.3, 0.1, 0.005).error < 1e-2
