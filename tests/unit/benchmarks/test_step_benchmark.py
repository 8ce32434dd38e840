"""The benchmark of a step compared with NGSolve's: its page, and that NGSolve's ways are ways to the same flow."""

import os
import shutil
import sysconfig

import numpy as np
import pytest
from benchmark_scripts import benchmark

pytest.importorskip("ngsolve")


@pytest.fixture(scope="module")
def step():
    with benchmark("step") as module:
        yield module


@pytest.fixture(scope="module")
def ngsolve_step():
    with benchmark("ngsolve_step") as module:
        yield module


def test_a_page_has_the_ratio_to_each_way_and_all_stages(step):
    theirs = {"umfpack": 0.4, "imex": 0.2, "reuse": 0.1}
    row = {
        "unknowns": 45_000,
        "seconds": 0.05,
        "stages": {"iterate": 0.05},
        "ngsolve_seconds": theirs,
        "ngsolve_stages": {way: {"solve": seconds} for way, seconds in theirs.items()},
        "ratio": {way: 0.05 / seconds for way, seconds in theirs.items()},
    }
    page = step.page({"date": "2026-01-01", "load": 1.0, "cores": 2, "rows": [row]})
    assert "| 45000 | 50 | 400 | 0.12 | 200 | 0.25 | 100 | 0.50 |" in page
    for line in ("| iterate | 50.0 |", "| NGSolve umfpack: solve | 400.0 |", "| NGSolve reuse: solve | 100.0 |"):
        assert line in page


@pytest.mark.skipif(shutil.which("c++") is None, reason="there is no C++ compiler")
def test_ways_lead_to_the_same_flow(ngsolve_step, monkeypatch):
    """To the tolerance where both are explicit in the convection, else to the error of the time step; also where the
    environment is not activated."""
    scripts = sysconfig.get_path("scripts")
    others = [folder for folder in os.environ["PATH"].split(os.pathsep) if folder != scripts]
    monkeypatch.setenv("PATH", os.pathsep.join(others))
    with benchmark("disk_under_way") as under_way:
        run = under_way.falling(3)
    mesh, problem, frames = run.state.mesh, run.system.fluid, []
    for _ in range(3):
        run.step()
        frames.append(ngsolve_step.Frame(run.state.mesh.points, run.state.twist.velocity[0]))
    found = {}
    for way in ngsolve_step.WAYS:
        flow = ngsolve_step.Flow(mesh, problem, run.clock.size(0), way)
        for number, frame in enumerate(frames):
            flow.advance(frame, number)
        found[way] = flow.state.components[0].vec.FV().NumPy().copy()
    size = np.linalg.norm(found["imex"])
    assert np.linalg.norm(found["reuse"] - found["imex"]) < 1e-6 * size
    assert 1e-3 * size < np.linalg.norm(found["umfpack"] - found["imex"]) < 5e-2 * size
