"""Runs that start with a fluid in motion, and prescribed flows that change in time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scenes import wet_tables

import rigidfluid
from rigidfluid import scene_from_dict
from rigidfluid.core.output.history import History
from rigidfluid.errors import SceneError


def run(changes: dict[str, dict[str, Any]] | None = None, **tables: Any) -> History:
    """A disk of radius .2 in the unit square, with keys of its tables changed, and tables replaced."""
    scene: dict[str, Any] = (
        wet_tables(
            {"type": "sphere", "radius": 0.2, "density": 1.0, "position": [0.5, 0.5], "fixed": True}, end=0.5, step=0.05
        )
        | tables
    )
    for table, keys in (changes or {}).items():
        scene[table] = scene[table] | keys
    return rigidfluid.run(scene_from_dict(scene))


CHANNEL = [
    {"on": "left", "type": "velocity", "velocity": ["4*y*(1 - y)", 0.0]},
    {"on": "right", "type": "pressure", "pressure": 0.0},
]


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_a_steady_flow_stays_as_it_starts(model: str) -> None:
    history = run({"fluid": {"initial": "steady", "model": model}}, boundary=CHANNEL)
    drag = history.bodies["fx"][1:]
    np.testing.assert_allclose(drag, drag[-1], rtol=1e-6)
    kinetic = history.energy["kinetic"]
    assert (kinetic[0] > 0.0) == (model == "navier-stokes")
    np.testing.assert_allclose(kinetic, kinetic[0], rtol=1e-6)
    assert abs(history.energy["residual"][-1]) < 1e-5 * history.energy["boundary"][-1]


def test_it_is_the_flow_that_a_start_from_rest_ends_in() -> None:
    late = run({"time": {"end": 5.0, "step": 0.1}}, boundary=CHANNEL)
    steady = run({"fluid": {"initial": "steady"}}, boundary=CHANNEL)
    assert steady.bodies["fx"][-1] == pytest.approx(late.bodies["fx"][-1], rel=1e-4)


@pytest.mark.long
def test_a_flow_that_is_not_steady_is_refused_with_its_reynolds_number() -> None:
    with pytest.raises(SceneError, match=r"fluid\.initial: found 'steady' with .* Reynolds number of .*ramp"):
        run({"fluid": {"initial": "steady", "viscosity": 2e-4}}, boundary=CHANNEL)


def swaying(step: float) -> History:
    """A disk that sways with all of the fluid round it, u = (.3 cos 4t, 0), p = 1.2 sin(4t) (x - 1/2)."""
    velocity = ["0.3*cos(4*t)", 0.0]
    body = {"type": "sphere", "radius": 0.2, "density": 1.0, "position": [0.5, 0.5]}
    return run(
        {"fluid": {"initial": velocity}, "time": {"step": step}},
        boundary=[{"on": "all", "type": "velocity", "velocity": velocity}],
        body=[body | {"prescribed": {"amplitude": [0.075, 0.0], "frequency": 2.0 / np.pi}}],
    )


def test_velocities_that_change_in_time_have_second_order() -> None:
    """The fluid's force is that of its own inertia, ρ times the disk's volume times dU/dt."""
    errors = []
    for step in (0.05, 0.025, 0.0125):
        history = swaying(step)
        exact = np.pi * 0.2**2 * -1.2 * np.sin(4.0 * 0.5)
        errors.append(abs(history.bodies["fx"][-1] - exact) / abs(exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[-1] > 1.8, (orders, errors)
    assert errors[-1] < 0.01


VORTEX = ["sin(pi*x)**2*sin(2*pi*y)", "-sin(2*pi*x)*sin(pi*y)**2"]


def test_a_formula_starts_without_a_burst_of_pressure() -> None:
    """What divergence is left is balanced in the first step by a pressure in inverse proportion to that step."""
    pressures = []
    for step in (1e-2, 1e-4):
        tables = {"time": {"end": 2 * step, "step": step}, "output": {"every": step, "probes": [[0.1, 0.1]]}}
        pressures.append(abs(run({"fluid": {"initial": VORTEX}}, **tables).probes["pressure"][-1]))
    assert pressures[1] < 3.0 * pressures[0]


def test_the_energy_of_a_formula_is_that_at_the_start() -> None:
    far = [{"type": "sphere", "radius": 1e-2, "density": 1.0, "position": [0.5, 0.5], "fixed": True}]
    mesh = {"size": 0.1, "size_body": 5e-3}
    tables = {"time": {"end": 0.01, "step": 1e-3}, "output": {"every": 0.01}}
    history = run({"fluid": {"initial": VORTEX}}, body=far, mesh=mesh, **tables)
    # ½ ∫ sin⁴(πx) sin²(2πy) + the same with x and y exchanged
    assert history.energy["kinetic"][0] == pytest.approx(3.0 / 16.0, rel=5e-3)
    lost = history.energy["kinetic"][0] - history.energy["kinetic"][-1]
    assert history.energy["dissipation"][-1] == pytest.approx(lost, rel=0.02)


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"initial": ["x"]}, r"fluid\.initial: found \['x'\], 1 of them; .* 2 numbers"),
        ({"initial": ["x", "z"]}, r"fluid\.initial\.1: found an unknown name: 'z'"),
        ({"initial": ["1/x", 0.0]}, r"fluid\.initial\.0: found inf from '1/x' at time 0 and point \[0.0"),
        ({"initial": "moving"}, r"fluid\.initial: found 'moving'; .* 'rest' or 'steady'"),
        ({"initial": "steady", "backend": "dry"}, r"fluid\.initial: found steady; allowed is 'rest' with .* 'dry'"),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, Any], found: str) -> None:
    with pytest.raises(SceneError, match=found):
        run({"fluid": changes})


def test_a_formula_on_slip_faces_passes_none_of_them() -> None:
    history = run(
        {"fluid": {"initial": ["1", "y"]}, "output": {"every": 0.5, "probes": [[0.5, 1.0], [0.0, 0.5]]}},
        boundary=[{"on": "all", "type": "slip"}],
    )
    top, left = (history.probes[name][probe] for name, probe in (("vy", 0), ("vx", 1)))
    assert abs(top) < 1e-12
    assert abs(left) < 1e-12
