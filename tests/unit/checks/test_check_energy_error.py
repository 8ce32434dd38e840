"""What `check` expects a step to get wrong of the energy of an impact that it does not resolve."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rigidfluid import scene_from_dict
from rigidfluid.checks import Finding, check
from rigidfluid.core.run.impacts import MOST_HALVINGS

RADIUS, RANGE, DENSITY, VISCOSITY, GRAVITY = 0.1, 0.03, 1.0, 0.01, 981.0
BALL = {"type": "sphere", "radius": RADIUS, "density": 3.0, "position": [0.4, 0.2]}
STIFF = 1e-12
"""So stiff that no step of these tests resolves a contact."""
CUT = 2.0**MOST_HALVINGS
"""A nominal step over the shortest that an impact makes of it."""


def findings(*bodies: dict[str, Any], step: float = 0.002, epsilon: float = STIFF, **fluid: Any) -> list[Finding]:
    data = {
        "scene": {"name": "drop", "dimension": 2},
        "fluid": {"backend": "scikit-fem", "density": DENSITY, "viscosity": VISCOSITY, "gravity": [0.0, -GRAVITY]}
        | fluid,
        "mesh": {"size": 0.08, "size_body": 0.03},
        "domain": {"lower": [0.0, 0.0], "upper": [0.8, 0.8]},
        "body": list(bodies or (BALL,)),
        "contact": {"law": "normal", "range": RANGE, "epsilon": epsilon},
        "time": {"end": 1.0, "step": step, "shortest": 1e-7},
        "output": {"every": 0.5},
    }
    return [one for one in check(scene_from_dict(data)).findings if one.question == "energy-error"]


def only(*bodies: dict[str, Any], **keys: Any) -> dict[str, float]:
    (finding,) = findings(*bodies, **keys)
    return {key: float(value) for key, value in finding.found.items()}  # type: ignore[arg-type]


@pytest.mark.parametrize(("step", "lost"), [(0.004, 0.0158), (0.002, 0.0112), (0.001, 0.0044), (0.0005, 0.0022)])
def test_losses_that_a_falling_disk_was_seen_to_have(step: float, lost: float) -> None:
    found = only(step=step)
    assert found["step_at_impact"] == step / CUT
    assert found["energy_error"] == pytest.approx(lost, rel=0.35)


def test_among_many_bodies_the_impact_of_one_shortens_no_step() -> None:
    crowd = [BALL | {"position": [0.4, 0.2 + 0.3 * number]} for number in range(2)]
    many = [BALL | {"radius": 0.001, "position": [0.1, 0.1 + 0.005 * number]} for number in range(100)]
    assert {one.found["step_at_impact"] for one in findings(*crowd, step=0.0002)} == {0.0002 / CUT}
    assert 0.0002 in {one.found["step_at_impact"] for one in findings(*crowd[:1], *many, step=0.0002)}


def test_the_two_parts_of_the_error() -> None:
    step, mass = 0.002, 4.0 * np.pi * RADIUS**2
    pull = 2.0 * np.pi * RADIUS**2 * GRAVITY / mass
    speed = np.sqrt(2.0 * pull * (0.1 - RANGE))
    found = only(step=CUT * step)
    assert found["impact_speed"] == pytest.approx(speed)
    assert found["fall_error"] == pytest.approx(pull * step / speed)
    layer = DENSITY * np.sqrt(VISCOSITY / DENSITY * step) * 2.0 * np.pi * RADIUS / mass
    assert found["layer_error"] == pytest.approx(layer)
    assert found["energy_error"] == pytest.approx(found["layer_error"] + found["fall_error"])


def test_a_pair_drags_the_layers_of_both() -> None:
    """Seen from their common centre of mass each has its share of the energy, and loses of it as at a wall."""
    other = BALL | {"density": 1.0, "position": [0.4, 0.6], "velocity": [0.0, -1.0]}
    found = findings(BALL, other, step=CUT * 0.002, gravity=[0.0, 0.0])
    pair = next(one for one in found if one.subject[1] == "body1").found
    heavy, light = 4.0 * np.pi * RADIUS**2, 2.0 * np.pi * RADIUS**2
    resistance = np.sqrt(VISCOSITY * DENSITY * 0.002) * 2.0 * np.pi * RADIUS
    shares = np.array([light, heavy]) / (light + heavy)
    assert pair["layer_error"] == pytest.approx(shares @ (resistance / np.array([heavy, light])))
    assert pair["fall_error"] == 0.0


def test_the_step_that_is_named_is_enough() -> None:
    (finding,) = findings(step=CUT * 0.002)
    assert finding.grade == "warning"
    enough = float(finding.enough["time_step"])  # type: ignore[arg-type]
    assert only(step=enough)["energy_error"] == pytest.approx(0.05)
    assert [one.grade for one in findings(step=1.01 * enough)] == ["warning"]
    assert [one.grade for one in findings(step=0.99 * enough)] == ["note"]


def test_a_step_that_resolves_the_contact_is_enough_too() -> None:
    (finding,) = findings(step=CUT * 0.002, epsilon=1e-3)
    enough = float(finding.enough["time_step"])  # type: ignore[arg-type]
    assert enough > 0.02
    assert finding.found["turn_per_step"] == pytest.approx(0.5 * CUT * 0.002 / enough)
    assert findings(step=0.99 * enough, epsilon=1e-3) == []


def test_more_than_all_cannot_be_lost() -> None:
    assert only(BALL | {"position": [0.4, 0.1301]}, step=0.05)["energy_error"] == 1.0


def test_nothing_rebounds_without_inertia_and_nothing_is_lost_without_a_fluid() -> None:
    assert findings(model="stokes") == []
    assert findings(backend="dry") == []


def test_a_body_that_cannot_hit_loses_nothing() -> None:
    assert findings(gravity=[0.0, 0.0]) == []
    assert findings(BALL | {"position": [0.4, 0.12]}) == []  # within range, at rest
