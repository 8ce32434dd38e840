"""Steps and runs of the backend "ngsolve" are those of scikit-fem; it is found by name."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import FLUID_BACKEND, FloatArray, Registry, Simulation
from rigidfluid_ngsolve import NGSolve

SCENES = Path(__file__).parents[3] / "scenes"
BACKENDS = ("ngsolve", "scikit-fem")


def two_balls(backend: str, dimension: int, model: str) -> rigidfluid.Scene:
    """A free ball sinks, turning, beside one whose motion is prescribed; the mesh moves with both."""
    spin = 2.0 if dimension == 2 else [0.5, -1.0, 2.0]
    ball = {"type": "sphere", "radius": 0.12}
    free = {"density": 3.0, "position": [0.7] * dimension, "angular_velocity": spin}
    driven = {
        "density": 1.0,
        "position": [0.3] * dimension,
        "prescribed": {"velocity": [0.5] * dimension, "angular_velocity": spin},
    }
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "two_balls", "dimension": dimension},
            "fluid": {
                "backend": backend,
                "model": model,
                "density": 1.0,
                "viscosity": 0.05,
                "gravity": [0.0] * (dimension - 1) + [-10.0],
                "tolerance": 1e-13,
            },
            "domain": {"type": "box", "lower": [0.0] * dimension, "upper": [1.0] * dimension},
            "body": [ball | free, ball | driven],
            "mesh": {"size": 0.5, "size_body": 0.12, "growth": 0.8, "order": 1},
            "time": {"step": 0.01, "end": 0.03},
            "output": {"every": 1.0},
        }
    )


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("model", ["stokes", "navier-stokes"])
def test_steps_are_those_of_scikit_fem(dimension: int, model: str) -> None:
    """On straight cells, where all integrals are exact."""
    ours, theirs = (Simulation(two_balls(backend, dimension, model), None, False) for backend in BACKENDS)
    for _ in range(3):
        for simulation in (ours, theirs):
            simulation.step()
        assert set(ours.state.fluid) == set(theirs.state.fluid)
        for name, expected in theirs.state.fluid.items():
            close(ours.state.fluid[name], expected)
        for part in ("force", "torque"):
            close(*(getattr(s.state.hydrodynamic_wrench, part) for s in (ours, theirs)))
        for entry in ("kinetic", "dissipation"):
            close(*(getattr(s.state.ledger, entry) for s in (ours, theirs)))


def close(found: FloatArray | float, expected: FloatArray | float, to: float = 1e-10) -> None:
    """Equal but for ``to`` times the largest entry."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=to * np.abs(expected).max())


def test_a_run_is_that_of_scikit_fem_and_near_it_after_re_meshing() -> None:
    coarse = ["mesh.size=0.4", "mesh.size_body=0.05", "mesh.growth=0.5", "time.step=0.016", "time.end=0.56"]
    ours, theirs = (
        rigidfluid.run(rigidfluid.load_scene(SCENES / "falling_disk.toml", [*coarse, f"fluid.backend={name!r}"]))
        for name in BACKENDS
    )
    assert ours.summary["remeshes"] == theirs.summary["remeshes"] == 1
    on_one_mesh = slice(0, 20)
    for column in ("y", "vy", "fy"):
        close(
            ours.bodies[column][on_one_mesh], theirs.bodies[column][on_one_mesh], to=1e-9
        )  # the stress in curved cells
        close(ours.bodies[column], theirs.bodies[column], to=1e-2)


def test_it_is_found_by_name() -> None:
    assert Registry.load().get(FLUID_BACKEND, "ngsolve") is NGSolve


def test_without_ngsolve_it_is_listed_with_what_to_install() -> None:
    code = (
        "import sys, importlib.util as util; find = util.find_spec\n"
        "util.find_spec = lambda name, *rest: None if name == 'ngsolve' else find(name, *rest)\n"
        "from rigidfluid.api import Registry\n"
        "print(*[entry.hint for entry in Registry.load().entries if entry.name == 'ngsolve'], 'ngsolve' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said == "Package ngsolve is missing: install ngsolve (`pip install ngsolve`). False\n"
