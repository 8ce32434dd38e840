"""The benchmark of steps on several processes: its rows, how it starts processes, and one run where DOLFINx is."""

import json
import shutil
import sys
from pathlib import Path

import pytest
from benchmark_scripts import benchmark
from page_tools.places import PAGES

from rigidfluid.errors import PluginError
from rigidfluid.registry import FLUID_BACKEND, Registry

MEASURED = {"mesh_nodes": 17000, "unknowns": 150000, "body_body": 28, "body_wall": 24}


@pytest.fixture(scope="module")
def parallel():
    with benchmark("parallel") as module:
        yield module


@pytest.fixture(scope="module")
def child():
    with benchmark("parallel_child") as module:
        yield module


@pytest.fixture(scope="module")
def processes():
    with benchmark("processes") as module:
        yield module


def test_the_page_follows_from_what_is_kept():
    with benchmark("parallel_page") as script:
        kept = json.loads(script.STORE.read_text(encoding="utf-8"))
        page = script.page(kept)
        assert (PAGES / "parallel.md").read_text(encoding="utf-8").startswith(page.rstrip())
        slow = [row | {"seconds_step": 2.5, "speedup_step": 1.9} for row in kept["steps"]["rows"]]
        assert "1.36 to 1.51 times as fast on two processes in 2D and 1.56 to 1.65 times in 3D." in page
        changed = script.page(kept | {"steps": kept["steps"] | {"rows": slow}})
        assert "1.90 to 1.90 times as fast on two processes in 2D and 1.90 to 1.90 times in 3D." in changed


def test_the_model_of_a_step_has_its_terms():
    with benchmark("step_model") as script:
        found = script.Constants(2e-5, 700, 300, 1e4)
        assert found.step(1000, 1, 1.0, 1.0) == pytest.approx(2e-2)
        assert found.step(8000, 8, 1e-3, 1e6) == pytest.approx(2e-2 + 1e-3 * (700 * 3 + 300) + 1e4 * 100 / 1e6)


def test_the_memory_of_a_process_is_that_of_its_share_and_the_root_has_the_whole_mesh():
    with benchmark("step_model") as script:
        rows = [{"unknowns": 1000, "bytes": 3e8}, {"unknowns": 3000, "bytes": 5e8}]
        share = script.Line.through(rows, "bytes")
        assert (share.start, share.slope) == pytest.approx((2e8, 1e5))
        assert share.at(2000) == pytest.approx(4e8)
        _, _, line, *_ = script.memory_lines(share, script.Line(1e9, 500.0))
        assert line.startswith("| 1,000,000 | 50, 1.5 | 6.5, 1.5 |")


def has_dolfinx() -> bool:
    try:
        Registry.load().get(FLUID_BACKEND, "dolfinx")
    except PluginError:
        return False
    return True


def test_speedups_are_against_one_rank(parallel):
    alone = MEASURED | {"seconds_collision": 0.3, "seconds_step": 2.0}
    made = parallel.row(2, 49, 2, MEASURED | {"seconds_collision": 0.2, "seconds_step": 1.25}, alone)
    assert (made.speedup_collision, made.speedup_step, made.share) == pytest.approx((1.5, 1.6, 0.16))
    assert (made.paper_body_body, made.paper_body_wall, made.paper_mesh_nodes) == (28, 24, 18284)
    assert (made.paper_speedup_4, made.paper_speedup_24, made.paper_largest_share) == (1.90, 2.15, 0.20)


def test_without_one_rank_there_is_no_speedup(parallel):
    made = parallel.row(3, 64, 2, MEASURED | {"seconds_collision": 0.2, "seconds_step": 1.0}, None)
    assert (made.speedup_collision, made.speedup_step) == (None, None)
    assert made.share == pytest.approx(0.2)


def test_the_papers_tables_have_the_same_arrangements(parallel):
    arrangements = {dimension: list(table) for dimension, table in parallel.PAPER.items()}
    with benchmark("mesh_sizes") as mesh_sizes:
        tables = mesh_sizes.PAPER_NODES, mesh_sizes.EDGES, parallel.PAPER_SPEEDUP
    for table in tables:
        assert {dimension: list(rows) for dimension, rows in table.items()} == arrangements


@pytest.mark.parametrize(("dimension", "bodies"), [(2, 49), (3, 125)])
def test_a_scene_has_the_balls_of_its_arrangement(child, dimension, bodies):
    made = child.scene(dimension, bodies, 1.0, backend="scikit-fem")
    balls, pose, *_ = child.balls_in_a_box(dimension, bodies)
    assert [body.position for body in made.body] == [tuple(centre) for centre in pose.position]
    assert {body.options["radius"] for body in made.body} == {balls[0].radius}


def program(tmp_path: Path, text: str) -> list[str]:
    file = tmp_path / "program.py"
    file.write_text(text, encoding="utf-8")
    return [str(file)]


def test_what_a_process_writes_is_read(processes, tmp_path):
    text = "import json, os, sys; json.dump([os.environ['OMP_NUM_THREADS'], *sys.argv[1:-1]], open(sys.argv[-1], 'w'))"
    assert processes.measured_apart([*program(tmp_path, text), "a"], threads=3) == ["3", "a"]


@pytest.mark.parametrize("text", ["raise ValueError('no such thing')", "sys.exit('ValueError: no such thing\\n---')"])
def test_a_process_that_fails_is_an_error_with_its_reason(processes, tmp_path, text):
    """Also where a launcher has drawn a line below it."""
    with pytest.raises(processes.LaunchError, match=r"found ValueError: no such thing; allowed is a run to the end"):
        processes.measured_apart(program(tmp_path, f"import sys; {text}"))


def test_without_mpirun_several_ranks_are_refused(processes, monkeypatch):
    monkeypatch.setattr(processes.shutil, "which", lambda name: None)
    with pytest.raises(processes.LaunchError, match="no mpirun"):
        processes.measured_apart(["program.py"], ranks=2)


def test_an_mpirun_that_refuses_root_is_named(processes, monkeypatch, tmp_path):
    """Without a word to it by us: whoever is root decides."""
    refusing = tmp_path / "mpirun"
    refusing.write_text("#!/bin/sh\necho 'mpirun: you can override this by --allow-run-as-root' >&2\nexit 1\n")
    refusing.chmod(0o755)
    monkeypatch.setattr(processes.shutil, "which", lambda name: str(refusing))
    with pytest.raises(processes.LaunchError, match="OMPI_ALLOW_RUN_AS_ROOT=1"):
        processes.measured_apart(["program.py"], ranks=2)


def test_mpirun_starts_as_many_processes_as_asked(processes, monkeypatch, tmp_path):
    """A stand-in writes what it was called with."""
    starter = tmp_path / "mpirun"
    starter.write_text(f"#!{sys.executable}\nimport json, sys; json.dump(sys.argv[1:-1], open(sys.argv[-1], 'w'))\n")
    starter.chmod(0o755)
    monkeypatch.setattr(processes.shutil, "which", lambda name: str(starter))
    called = processes.measured_apart(["-m", "thing", "4"], ranks=2)
    assert called == ["-n", "2", sys.executable, "-P", "-m", "thing", "4"]


def call(parallel, monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", [parallel.__file__, *map(str, arguments)])
    parallel.main()


@pytest.mark.skipif(has_dolfinx(), reason="DOLFINx is installed")
def test_without_dolfinx_it_says_what_to_install(parallel, monkeypatch, capsys):
    with pytest.raises(SystemExit, match="2"):
        call(parallel, monkeypatch)
    told = capsys.readouterr().err
    assert told.startswith("Error: fluid.backend")
    assert "fenics-dolfinx" in told


@pytest.mark.skipif(not has_dolfinx(), reason="DOLFINx is not installed")
def test_rows_of_one_body(parallel, monkeypatch, tmp_path):
    ranks = [1, 2] if shutil.which("mpirun") else [1]
    file = tmp_path / "rows.json"
    call(parallel, monkeypatch, "--most-bodies", 1, "--coarseness", 4, "--ranks", *ranks, "--json", file)
    rows = json.loads(file.read_text())
    assert [(made["dimension"], made["ranks"]) for made in rows] == [(d, r) for d in (2, 3) for r in ranks]
    for made in rows:
        assert (made["body_body"], made["body_wall"]) == (made["paper_body_body"], made["paper_body_wall"])
        assert 0 < made["seconds_collision"] < made["seconds_step"]
