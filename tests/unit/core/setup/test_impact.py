"""How fast bodies are expected to hit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rigidfluid import Scene
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.system import build_system
from rigidfluid.core.setup.impact import terminal_speeds
from rigidfluid.errors import SceneError

RADIUS, RANGE, GRAVITY = 0.1, 0.02, 10.0
BALL = {"type": "sphere", "radius": RADIUS, "density": 3.0}
FLUID = {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.01}
MESH = {"size": 0.2, "size_body": 0.02}


def scene(
    *bodies: dict[str, Any], dimension: int = 2, gravity: tuple[float, ...] = (0.0, -GRAVITY), **tables: Any
) -> Scene:
    fluid = {"backend": "dry"} | tables.pop("fluid", {}) | {"gravity": [*gravity, 0.0][:dimension]}
    placed = [{"position": [1.0, 1.5, 1.0][:dimension]} | body for body in bodies]
    return scene_from_dict(
        {
            "scene": {"name": "fall", "dimension": dimension},
            "fluid": fluid,
            "domain": {"lower": [0.0] * dimension, "upper": [2.0] * dimension},
            "body": placed,
            "contact": {"law": "normal", "range": RANGE, "epsilon": 1.0} | tables.pop("contact", {}),
            "time": {"end": 1.0, "step": 0.01},
            "output": {"every": 0.1},
        }
        | tables
    )


def speed(*bodies: dict[str, Any], **tables: Any) -> float:
    return float(build_system(scene(*bodies, **tables)).loads.speed[0])


def test_dry_fall_ends_where_the_law_begins() -> None:
    height = 1.5 - RADIUS - RANGE
    assert speed(BALL) == pytest.approx(np.sqrt(2 * GRAVITY * height))
    assert speed(BALL | {"velocity": [3.0, 4.0]}) == pytest.approx(np.sqrt(25.0 + 2 * GRAVITY * height))


def test_upward_and_aslant() -> None:
    assert speed(BALL, gravity=(0.0, GRAVITY)) == pytest.approx(np.sqrt(2 * GRAVITY * (0.5 - RADIUS - RANGE)))
    aslant = (0.6 * GRAVITY, -0.8 * GRAVITY)
    assert speed(BALL, gravity=aslant) == pytest.approx(np.sqrt(2 * GRAVITY * (0.9 / 0.6 - RANGE)))
    assert speed(BALL, gravity=(0.0, 0.0)) == 0.0


def test_buoyancy_slows_a_dry_fall() -> None:
    height = 1.5 - RADIUS - RANGE
    assert speed(BALL, fluid={"density": 1.0}) == pytest.approx(np.sqrt(2 * GRAVITY * 2 / 3 * height))


def test_an_ellipse_falls_as_far_as_it_can_and_turns() -> None:
    ellipse = {"type": "ellipsoid", "semi_axes": [0.2, 0.05], "density": 3.0}
    assert speed(ellipse) == pytest.approx(np.sqrt(2 * GRAVITY * (1.5 - 0.05 - RANGE)))
    assert speed(ellipse | {"angular_velocity": 2.0}, gravity=(0.0, 0.0)) == pytest.approx(
        2 * np.sqrt(0.2**2 - 0.05**2)
    )


def test_driven_bodies_have_the_speed_of_their_prescription() -> None:
    moved = {"velocity": [3.0, 0.0], "amplitude": [0.0, 0.5], "frequency": 2.0}
    assert speed(BALL | {"prescribed": moved}) == pytest.approx(3.0 + 2 * np.pi * 2.0 * 0.5)
    assert speed(BALL | {"fixed": True}) == 0.0


def test_the_scene_may_say_it_for_free_bodies() -> None:
    assert speed(BALL, contact={"impact_speed": 7.0}) == 7.0
    assert speed(BALL | {"prescribed": {"velocity": [3.0, 0.0]}}, contact={"impact_speed": 7.0}) == 3.0


def drag_3d(v: float) -> float:
    re = 2 * RADIUS * v / 0.01
    return float(24 / re * (1 + 0.15 * re**0.687) * 0.5 * v**2 * np.pi * RADIUS**2)


def drag_2d(v: float) -> float:
    re = 2 * RADIUS * v / 0.01
    return float((1 + 10 * re ** (-2 / 3)) * 0.5 * v**2 * 2 * RADIUS)


@pytest.mark.parametrize(("dimension", "drag"), [(2, drag_2d), (3, drag_3d)])
@pytest.mark.parametrize("v", [0.01, 1.0, 20.0])
def test_drag_holds_the_weight_at_the_terminal_speed(dimension: int, drag: Any, v: float) -> None:
    wet = scene(BALL, dimension=dimension, fluid=FLUID, mesh=MESH)
    found = terminal_speeds(model_of(wet), np.array([drag(v), 0.0][:1]))
    assert found[0] == pytest.approx(v, rel=1e-6)


def test_newton_drag_beyond_the_correlation() -> None:
    wet = scene(BALL, dimension=3, fluid=FLUID, mesh=MESH)
    weight = 0.44 * 0.5 * 100.0**2 * np.pi * RADIUS**2
    assert terminal_speeds(model_of(wet), np.array([weight]))[0] == pytest.approx(100.0)


def test_stokes_without_inertia() -> None:
    for dimension, resistance in ((3, 6 * np.pi * RADIUS), (2, 4 * np.pi / np.log(2.0 / RADIUS))):
        slow = scene(BALL, dimension=dimension, fluid=FLUID | {"model": "stokes"}, mesh=MESH)
        found = terminal_speeds(model_of(slow), np.array([5.0]))
        assert found[0] == pytest.approx(5.0 / (0.01 * resistance))


@pytest.mark.parametrize("model", ["stokes", "navier-stokes"])
@pytest.mark.parametrize("exponent", [0.2, 0.6, 1.5])
def test_a_viscosity_that_varies_is_that_of_the_fall(model: str, exponent: float) -> None:
    """As in a Newtonian fluid whose viscosity is the material's at the shear rate that it gives; 0 without weight."""
    law = {"type": "power_law", "viscosity": 0.3, "shear_rate": 2.0, "exponent": exponent, "least_shear_rate": 1e-6}
    pull, given = np.array([5.0, 0.0]), {key: value for key, value in FLUID.items() if key != "viscosity"}
    bodies = BALL, BALL | {"position": [1.0, 0.5]}
    thin = model_of(scene(*bodies, fluid=given | {"model": model, "material": law}, mesh=MESH))
    found = terminal_speeds(thin, pull)
    viscosity = 0.3 * (found[0] / (2 * RADIUS) / 2.0) ** (exponent - 1.0)
    newtonian = model_of(scene(*bodies, fluid=FLUID | {"model": model, "viscosity": viscosity}, mesh=MESH))
    assert viscosity < 0.2 if exponent < 1.0 else viscosity > 0.4
    assert found == pytest.approx(terminal_speeds(newtonian, pull), rel=1e-9)


def test_a_fluid_limits_the_fall_but_not_the_start() -> None:
    thick = FLUID | {"viscosity": 10.0}
    slow = speed(BALL, fluid=thick, mesh=MESH)
    wet = scene(BALL, fluid=thick, mesh=MESH)
    pull = np.linalg.norm(build_system(wet).weight, axis=1)
    assert slow == terminal_speeds(model_of(wet), pull)[0] < 1.0
    assert speed(BALL | {"velocity": [0.0, -3.0]}, fluid=thick, mesh=MESH) == 3.0


def test_a_short_fall_counts_the_added_mass() -> None:
    low = BALL | {"position": [1.0, RADIUS + RANGE + 0.001]}
    expected = np.sqrt(2 * GRAVITY * (3.0 - 1.0) / (3.0 + 1.0) * 0.001)
    assert speed(low, fluid=FLUID, mesh=MESH) == pytest.approx(expected)


def test_the_inflow_carries_bodies() -> None:
    faces = [
        {"on": "left", "type": "velocity", "velocity": [4.0, 0.0]},
        {"on": "right", "type": "pressure", "pressure": 0.0},
    ]
    assert speed(BALL, gravity=(0.0, 0.0), fluid=FLUID, mesh=MESH, boundary=faces) == 4.0


@pytest.mark.parametrize(
    ("contact", "text"),
    [
        (
            {"smallest_gap": RANGE},
            "contact.smallest_gap: found 0.02; allowed is a length above 0 and below contact.range",
        ),
        ({"smallest_gap": 0.0}, "contact.smallest_gap: found 0"),
        ({"impact_speed": -1.0}, "contact.impact_speed: found -1"),
        ({"epsilon": "auto"}, "body 'body0' that has neither weight nor speed.*contact.impact_speed"),
    ],
)
def test_wrong_input(contact: dict[str, Any], text: str) -> None:
    with pytest.raises(SceneError, match=text):
        build_system(scene(BALL, gravity=(0.0, 0.0), contact=contact))


@pytest.mark.parametrize("key", ["smallest_gap", "impact_speed"])
def test_keys_that_no_law_reads(key: str) -> None:
    data = scene(BALL).to_dict()
    data["contact"] = {key: 0.01}
    with pytest.raises(SceneError, match=f"contact.{key}: found 0.01 without a law"):
        scene_from_dict(data)


def test_loads_hold_the_added_mass_and_nothing_for_driven_bodies() -> None:
    driven = BALL | {"fixed": True, "position": [1.0, 0.5]}
    loads = build_system(scene(BALL, driven, fluid=FLUID, mesh=MESH)).loads
    area = np.pi * RADIUS**2
    np.testing.assert_allclose(loads.mass, [4.0 * area, np.inf])
    np.testing.assert_allclose(loads.weight, [2.0 * area * GRAVITY, 0.0])
    assert loads.smallest_gap == 0.25 * RANGE


def test_components_have_the_greatest_speed_of_their_strokes() -> None:
    """A smooth stroke s = 3 a (t/T)² - 2 a (t/T)³ begins at rest; one of two equal balls has half of its rate."""
    parts = [BALL | {"name": name, "position": [x, 0.0]} for name, x in (("left", 0.0), ("right", 1.0))]
    stroke = {"moves": ["right"], "along": [1.0, 0.0], "smooth": [[0.0, 0.0], [0.5, 0.4], [1.0, 0.0]]}
    mechanism = {"type": "articulated", "component": parts, "stroke": [stroke], "position": [1.0, 1.0]}
    speeds = build_system(scene(gravity=(0.0, 0.0), mechanism=[mechanism])).loads.speed
    np.testing.assert_allclose(speeds, 0.5 * 1.5 * 0.4 / 0.5, rtol=1e-3)
