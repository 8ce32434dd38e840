"""Threads of the linear algebra while a simulation steps."""

from __future__ import annotations

import os
import subprocess
import sys

from falling import SCENES

THREADS_OF_A_RUN = """
from rigidfluid.api import Simulation, load_scene
from threadpoolctl import threadpool_info

def told(when):
    print(when, *(pool["num_threads"] for pool in threadpool_info() if pool["internal_api"] == "openblas"))

def seen(*given, **named):
    told("solving")
    return solve(*given, **named)

scene = load_scene({scene!r}, ["mesh.size=0.5", "mesh.size_body=0.1", "time.end=0.005"])
simulation = Simulation(scene)  # loads the libraries
import rigidfluid.taylor_hood.linear_solver.flexible_gmres as solver
solve, solver.gcrotmk = solver.gcrotmk, seen
simulation.go()
told("after")
"""


LOADED_LATER = """
from rigidfluid.core.run.process import one_openblas_thread
from threadpoolctl import threadpool_info

with one_openblas_thread():
    import scipy.sparse.linalg
    print(*(pool["num_threads"] for pool in threadpool_info() if pool["internal_api"] == "openblas"))
"""


def test_openblas_has_one_thread_while_a_simulation_steps_and_those_that_it_had_after() -> None:
    """NumPy's, and SciPy's own, which is loaded on the way."""
    told = printed(THREADS_OF_A_RUN.format(scene=str(SCENES / "falling_disk.toml")))
    assert set(told[:-1]) == {"solving 1 1"}
    assert told[-1] == "after 2 2"


def test_a_library_that_is_loaded_later_has_one_thread_too() -> None:
    assert printed(LOADED_LATER) == ["1 1"]


def printed(code: str) -> list[str]:
    """Lines of a process of its own: in this one all libraries are loaded."""
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    environment["OPENBLAS_NUM_THREADS"] = "2"
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.splitlines()


RUNS_AT_ONCE = """
from rigidfluid.core.run.process import one_openblas_thread
from threadpoolctl import threadpool_info

def told():
    print(*(pool["num_threads"] for pool in threadpool_info() if pool["internal_api"] == "openblas"))

first, second = one_openblas_thread(), one_openblas_thread()
first.__enter__()
second.__enter__()
first.__exit__(None, None, None)
told()
second.__exit__(None, None, None)
told()
"""


def test_of_two_runs_at_once_the_last_gives_threads_back() -> None:
    assert printed(RUNS_AT_ONCE) == ["1 1", "2 2"]
