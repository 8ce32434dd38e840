"""Plate and flapping plates against their contracts, and in a fluid."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rigidfluid.api import Body, FloatArray, Scene, SceneError, Simulation, scene_from_dict
from rigidfluid.testing import BodyContract, MechanismContract
from rigidfluid_flapping import FlappingPlate, Plate
from rigidfluid_flapping.mechanism import FlappingPlateOptions
from rigidfluid_flapping.plate import PlateOptions

FISH = {"length": 0.3, "thickness": 0.04, "hub_radius": 0.1, "gap": 0.04, "density": 1.0}
FISH |= {"amplitude": 0.5, "frequency": 1.0}
WINGS = FISH | {"plates": 2, "rest_angle": 0.9}


class TestPlate(BodyContract):
    @pytest.fixture(params=[None, 0.5])
    def body(self, request: pytest.FixtureRequest) -> Plate:
        return Plate(PlateOptions(length=1.2, thickness=0.3, width=request.param), 2 if request.param is None else 3)


class TestFlappingPlate(MechanismContract):
    @pytest.fixture(params=[(table, d) for table in (FISH, WINGS) for d in (2, 3)], ids=str)
    def mechanism(self, request: pytest.FixtureRequest) -> FlappingPlate:
        table, dimension = request.param
        width = 0.2 if dimension == 3 else None
        return FlappingPlate(FlappingPlateOptions(**table, width=width), dimension)


def scene(table: dict[str, Any], dimension: int = 2, model: str = "navier-stokes", **time: float) -> Scene:
    place = {"name": "it", "type": "flapping_plate", "position": [1.0, 1.0, 0.6][:dimension]}
    return scene_from_dict(
        {
            "scene": {"name": "flapping", "dimension": dimension},
            "fluid": {"model": model, "density": 1.0, "viscosity": 0.01},
            "domain": {"lower": [0.0] * dimension, "upper": [2.0, 2.0, 1.2][:dimension]},
            "mechanism": [place | table],
            "mesh": {"size": 0.3, "size_body": 0.04 if dimension == 2 else 0.12},
            "time": {"end": 0.5, "step": 0.025} | time,
            "output": {"every": time.get("end", 0.5)},
        }
    )


def ran(given: Scene) -> Simulation:
    simulation = Simulation(given)
    simulation.go()
    return simulation


def test_plates_that_close_behind_the_hub_drive_it_forwards() -> None:
    """What they push out pushes the common centre of mass, which no inner force could; the drive's work goes into it.
    A period as a whole leads forwards as well, as plates that open take in fluid from all sides."""
    shown = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8").split("```toml\n")[1]
    it = Simulation(scene_from_dict(tomllib.loads(shown.split("```")[0])))
    it.go(0.3)
    whole, ledger = it.bodies["swimmer"], it.state.ledger
    assert whole.velocity[0] > 0.3
    assert whole.force[0] > 0.0
    assert abs(whole.velocity[1]) < 1e-3
    assert abs(whole.angular_velocity[0]) < 1e-3
    assert ledger.control > ledger.dissipation > 0.0
    assert abs(ledger.relative_residual) < 0.02
    it.go()
    assert it.bodies["swimmer"].position[0] > 1.05
    assert it.bodies["swimmer.hub"].position[1] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_one_plate_turns_the_hub_against_itself(dimension: int) -> None:
    """Without a fluid momentum and angular momentum stay zero while the plate goes from one side to the other."""
    width = {} if dimension == 2 else {"width": 0.2}
    given = scene(FISH | width | {"amplitude": 1.5}, dimension, step=0.1).to_dict()
    it = ran(scene_from_dict(given | {"fluid": {"backend": "dry"}}))
    shapes = [part.shape for part in FlappingPlate(FlappingPlateOptions(**FISH | width), dimension).components]
    bodies = [it.bodies["it.hub"], it.bodies["it.plate"]]
    spins = [body.angular_velocity[-1] for body in bodies]
    parts = [
        shape.volume * np.append(body.velocity, _moment(body.position - 1.0, body.velocity, shape, spin))
        for shape, body, spin in zip(shapes, bodies, spins, strict=True)
    ]
    assert abs(it.bodies["it"].orientation[-1]) > 0.4
    np.testing.assert_allclose(sum(parts), 0.0, atol=1e-14)


def _moment(arm: FloatArray, velocity: FloatArray, shape: Body, spin: float) -> float:
    """Of what moves in the first two axes, over its mass."""
    return float(arm[0] * velocity[1] - arm[1] * velocity[0] + shape.unit_inertia[-1, -1] * spin)


def test_a_plate_sinks_straight_in_three_dimensions() -> None:
    """What a mesh around it must give: in Stokes flow, upright in the middle of a box."""
    plate = {"type": "plate", "length": 1.0, "width": 1.0, "thickness": 0.4, "density": 2.0, "name": "it"}
    tables = scene(WINGS).to_dict() | {
        "scene": {"name": "sinking_plate", "dimension": 3},
        "fluid": {"model": "stokes", "density": 1.0, "viscosity": 10.0, "gravity": [0.0, -1.0, 0.0]},
        "domain": {"lower": [-1.5] * 3, "upper": [1.5] * 3},
        "body": [plate | {"position": [0.0] * 3, "orientation": [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]}],
        "mesh": {"size": 1.0, "size_body": 0.4},
        "time": {"end": 1.0, "step": 1.0},
        "output": {"every": 1.0},
    }
    del tables["mechanism"]
    body = ran(scene_from_dict(tables)).bodies["it"]
    assert body.velocity[1] < -1e-3
    np.testing.assert_allclose(body.velocity[[0, 2]], 0.0, atol=0.02 * abs(body.velocity[1]))
    np.testing.assert_allclose(body.angular_velocity, 0.0, atol=0.02 * abs(body.velocity[1]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rest_angle": 0.55}, r"mechanism\.0.*rest_angle ± amplitude goes from 0\.05 to 1\.05.*touch"),
        ({"rest_angle": 2.7}, r"mechanism\.0.*rest_angle ± amplitude.*touch"),
        ({"plates": 1}, r"mechanism\.0.*must be 0 with one plate"),
        ({"thickness": 0.3}, r"mechanism\.0.*length = 0\.3 must be above the thickness"),
        ({"width": 0.2}, r"mechanism\.0\.width: found 0\.2; allowed is none in 2D"),
        ({"frequency": 0.0}, r"mechanism\.0\.frequency"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused_by_name(change: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        scene(WINGS | change)


def test_a_plate_in_space_needs_a_width() -> None:
    with pytest.raises(SceneError, match=r"mechanism\.0\.width: found None; allowed is a length"):
        scene(WINGS, 3)
