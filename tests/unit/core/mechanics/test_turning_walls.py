"""Walls that turn in themselves: what they do to the fluid, to bodies that rub on them, and to the energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from curved_channels import VISCOSITY, flow_between_cylinders, torque_between_cylinders
from dish import CODE, in_a_dish

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.history import History
from rigidfluid.core.run.run import run
from rigidfluid.errors import SceneError

RUBBING = {"law": "spring-dashpot", "range": 0.02, "stiffness": 400.0, "damping": 1.0, "friction": 0.4}


@pytest.fixture(autouse=True)
def _plug_in(install: Any) -> None:
    install(CODE, name="dish", module="rigidfluid_dish")


def turned(spin: Any, body: dict[str, Any], **tables: Any) -> History:
    """A run of a body in a dish whose rim turns."""
    rim = {"on": "rim", "type": "wall", "angular_velocity": spin}
    return run(scene_from_dict(in_a_dish(body, boundary=[rim], **tables)))


@pytest.mark.parametrize(("inner", "outer"), [(1.0, 0.0), (0.0, 1.0), (1.0, -0.5)])
def test_the_torque_between_cylinders_is_exact(inner: float, outer: float) -> None:
    """Taylor–Couette flow to 1e-4, and of order 3 at least."""
    exact = torque_between_cylinders(inner, outer)
    found = [flow_between_cylinders(layers, inner, outer).advance.hydrodynamic_wrench.torque[0, 0] for layers in (3, 6)]
    errors = np.abs(np.array(found) / exact - 1.0)
    assert errors[1] < 1e-4
    assert np.log2(errors[0] / errors[1]) > 3.0


@pytest.mark.parametrize(
    ("dimension", "sizes", "allowed"), [(2, (0.2, 0.1), 2e-4), (3, (0.5, 0.25), 0.03)], ids=["2D", "3D"]
)
def test_a_scene_with_a_rim_that_turns(dimension: int, sizes: tuple[float, float], allowed: float) -> None:
    """The torque on a ball held in the middle, and the balance of the energy: the rim's power is dissipated."""
    radius, spin = 0.5, 1.0 if dimension == 2 else [0.0, 0.0, 1.0]
    held = {"type": "sphere", "radius": radius, "density": 1.0, "position": [0.0] * dimension, "fixed": True}
    fluid = {"density": 1.0, "viscosity": VISCOSITY, "model": "stokes"}
    history = turned(
        spin,
        held,
        dimension=dimension,
        fluid=fluid,
        contact={},
        mesh={"size": sizes[0], "size_body": sizes[1]},
        time={"end": 0.2, "step": 0.1},
        output={"every": 0.1},
    )
    ratio = radius**dimension / (1.0 - radius**dimension)
    exact = (4.0 if dimension == 2 else 8.0) * np.pi * VISCOSITY * ratio
    torque = history.bodies["t" if dimension == 2 else "tz"][-1]
    assert torque == pytest.approx(exact, rel=allowed)
    # Stokes flow starts at once; the step after that is steady.
    power, left = (np.diff(history.energy[name])[-1] / 0.1 for name in ("boundary", "residual"))
    assert power == pytest.approx(exact, rel=allowed)
    assert abs(left) < 1e-6 * power


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_a_rim_that_turns_takes_a_ball_along_by_friction(stepping: str) -> None:
    """While it slips, friction μ m g accelerates it by μ g; what the rim gives, ball and friction take."""
    ball = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.0, -0.9 + 0.0192]}
    history = turned(
        1.0,
        ball,
        fluid={"backend": "dry", "gravity": [0.0, -10.0]},
        contact=RUBBING | {"stepping": stepping},
        time={"end": 0.03, "step": 0.001},
        output={"every": 0.03},
    )
    assert history.bodies["vx"][-1] == pytest.approx(0.4 * 10.0 * 0.03, rel=0.05)
    energy = history.energy
    assert energy["control"][-1] > 0.0
    assert abs(energy["residual"][-1]) < 0.01 * energy["control"][-1]


def test_a_ball_around_the_fluid_may_turn_about_any_axis_through_its_centre() -> None:
    """And about no other."""
    scene = in_a_dish(dimension=3, boundary=[{"on": "rim", "type": "wall", "angular_velocity": [0.3, -0.2, 0.5]}])
    scene["body"] = [{"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.0, 0.0, 0.0]}]
    scene_from_dict(scene)
    scene["boundary"][0]["centre"] = [0.0, 0.01, 0.0]
    with pytest.raises(SceneError, match=r"boundary.0.angular_velocity: found .* across the wall 'rim'"):
        scene_from_dict(scene)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("angular_velocity", [1.0, 2.0], r"boundary.0.angular_velocity: found .* allowed is 1 number"),
        ("centre", [1.0], r"boundary.0.centre: found .* allowed is 2 numbers"),
    ],
)
def test_vectors_of_another_dimension_are_refused(key: str, value: FloatArray, message: str) -> None:
    rim = {"on": "rim", "type": "wall", "angular_velocity": 1.0} | {key: value}
    body = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.0, 0.0]}
    with pytest.raises(SceneError, match=message):
        scene_from_dict(in_a_dish(body, boundary=[rim]))


def test_fluid_may_go_along_a_curved_surface_that_is_no_wall_and_has_no_outlet() -> None:
    """Its flow through the surface is rounding, whose sign says nothing."""
    wall, open_one = (
        flow_between_cylinders(3, 0.3, 1.0, wall=wall).advance.hydrodynamic_wrench for wall in (True, False)
    )
    np.testing.assert_allclose(open_one.torque, wall.torque, rtol=1e-9)
