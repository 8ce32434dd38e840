"""The benchmark of backends: its fit, its tables, and one run of each backend that is here, on a tiny mesh."""

import pytest
from benchmark_scripts import benchmark


@pytest.fixture(scope="module")
def backends():
    with benchmark("backends") as module:
        yield module


def test_the_exponent_is_that_of_a_power_law(backends):
    sizes = [15_000, 45_000, 150_000]
    assert backends.exponent(sizes, [3e-6 * n**1.37 for n in sizes]) == pytest.approx(1.37)


def test_the_exponent_is_fitted_by_least_squares(backends):
    """log₁₀ of the values 0, 1, 1 at 0, 1, 2: slope 1/2."""
    assert backends.exponent([1, 10, 100], [1.0, 10.0, 10.0]) == pytest.approx(0.5)


def test_there_is_no_exponent_of_one_size_or_of_nothing(backends):
    assert backends.exponent([100], [1.0]) is None
    assert backends.exponent([100, 200], [0.0, 0.0]) is None


def test_the_command_is_told_as_one_types_it_in_the_repository(backends):
    page = str(backends.ROOT / "docs/validation/backends.md")
    told = backends.told_command(["--steps", "5", "--page", page])
    assert told == "python benchmarks/backends.py --steps 5 --page docs/validation/backends.md"


def row(backends, unknowns, seconds):
    stages = dict.fromkeys(backends.STAGES, 0.0) | {"iterate": seconds / 2, "the rest": seconds / 2}
    counts = {"iterations": 1.75, "factorisations": 1, "memory": 3 * 2**20}
    return {"unknowns": unknowns, "seconds": seconds, "stages": stages} | counts


def test_a_page_has_a_table_for_each_case_and_the_reason_of_what_is_missing(backends):
    found = {
        "date": "2026-01-01",
        "machine": "2 cores",
        "command": "python here",
        "steps": 20,
        "rows": {"one, 2 threads": [row(backends, 100, 0.01), row(backends, 10_000, 1.0)]},
        "skipped": {"other, 1 thread": "not here"},
    }
    page = backends.page({"rows": found})
    assert "| [ms a step] | 100 | 10000 | exponent |" in page
    assert "| **whole step** | 10.0 | 1000.0 | 1.00 |" in page
    assert "| iterate | 5.0 | 500.0 | 1.00 |" in page
    assert "| Krylov iterations a step | 1.75 | 1.75 |  |" in page
    assert "| peak memory [MiB] | 3 | 3 |  |" in page
    assert "* other, 1 thread: not here" in page


def test_a_case_is_named_by_what_its_cores_are(backends):
    assert backends.Case("dolfinx", 2).name == "dolfinx, 2 ranks"
    assert backends.Case("scikit-fem", 1).name == "scikit-fem, 1 thread"


def test_a_backend_that_is_not_there_is_left_out_with_the_reason(backends):
    found = backends.collect([backends.Case("stones", 1)], [3], 1)
    assert found["rows"] == {}
    assert "'stones'" in found["skipped"]["stones, 1 thread"]


@pytest.mark.parametrize("name", ["scikit-fem", "ngsolve", "dolfinx"])
def test_the_stages_of_each_backend_are_found(backends, name):
    if reason := backends.missing(name):
        pytest.skip(reason)
    found = backends.Case(name, 1).measure(3, 2)
    assert found["unknowns"] == 3620
    assert found["factorisations"] == 1
    assert found["iterations"] > 0
    assert found["memory"] > 2**20
    assert sum(found["stages"].values()) == pytest.approx(found["seconds"])
    assert all(found["stages"][stage] > 0 for stage in ("assemble matrix", "factorise", "iterate", "energies"))
