"""Checks of two bodies that a long-range force pulls together, each confirmed by its run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.checks.finding import Finding
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.errors import StepError

STRENGTH, RADIUS = 1e-5, 0.1
PULL, WORK = 6.0 * STRENGTH / (2.0 * RADIUS) ** 4, 2.0 * STRENGTH / (2.0 * RADIUS) ** 3
"""Of two unit dipoles in line, with the balls in contact."""


def scene(dimension: int, *laws: dict[str, Any], **tables: Any) -> rigidfluid.Scene:
    """Two balls at rest whose dipoles are in line, but for those that start otherwise."""
    middle = [0.5] * (dimension - 1)
    bodies = [ball([x, *middle], [0.0] * dimension, name=name) for x, name in ((0.65, "a"), (0.35, "b"))]
    along = [1.0, *[0.0] * (dimension - 1)]
    dipole = {"law": "dipole", "range": 2.0, "names": ["a", "b"], "strength": STRENGTH, "moments": [along, along]}
    data = dry_scene({}, *bodies, end=0.9, step=5e-3).to_dict()
    return scene_from_dict(data | {"contact": {}, "interaction": [dipole, *laws]} | tables)


def normal(epsilon: float | str) -> dict[str, Any]:
    return {"law": "normal", "range": 0.03, "epsilon": epsilon}


def judged(case: rigidfluid.Scene) -> list[Finding]:
    return [finding for finding in check(case).findings if finding.question == "attraction"]


def least_gap(case: rigidfluid.Scene) -> float:
    """Least gap of a run, which ends where bodies overlap."""
    return float(rigidfluid.run(case).bodies["gap"].min())


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.long)])
@pytest.mark.parametrize("epsilon", [1e-3, 3e-3])
def test_a_law_that_is_strong_enough_is_a_note_and_keeps_them_apart(dimension: int, epsilon: float) -> None:
    case = scene(dimension, normal(epsilon))
    (finding,) = judged(case)
    assert finding.grade == "note"
    assert finding.subject == ("a", "b")
    assert finding.found["pull"] == pytest.approx(PULL, rel=1e-6)
    assert finding.found["work"] == pytest.approx(WORK, rel=1e-6)
    gap = float(finding.found["rest_gap"] or 0.0)
    push = (0.03 - gap) ** 2 / epsilon
    assert push == pytest.approx(6.0 * STRENGTH / (2.0 * RADIUS + gap) ** 4, rel=0.15)
    assert 0.0 < least_gap(case) < gap


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.long)])
@pytest.mark.parametrize(("epsilon", "of"), [(1e-2, "work"), (1e-1, "pull")])
def test_a_law_that_is_too_weak_is_a_warning_and_lets_them_overlap(dimension: int, epsilon: float, of: str) -> None:
    case = scene(dimension, normal(epsilon))
    (finding,) = judged(case)
    assert finding.grade == "warning"
    assert f"{PULL:.3g} at contact" in finding.text
    assert {"work": "its work is 0.0025, of which", "pull": "of which the law gives at most 0.24"}[of] in finding.text
    with pytest.raises(StepError, match="gap of -"):
        rigidfluid.run(case)
    enough = finding.enough["epsilon"]
    assert isinstance(enough, float)
    assert enough == pytest.approx(0.03**3 / 3.0 / WORK, rel=1e-3)
    assert f"interaction.1.epsilon to {enough:.3g}"[:30] in finding.remedy
    assert judged(scene(dimension, normal(enough)))[0].grade == "note"
    assert least_gap(scene(dimension, normal(enough))) > 0.0


def test_the_rotations_that_attract_most_count_not_those_at_the_start() -> None:
    """Side by side they repel, and turn."""
    across = {"angle": np.pi / 2.0}
    data = scene(2, normal(1e-2)).to_dict()
    turned = scene_from_dict(data | {"body": [{**one, **across} for one in data["body"]]})
    assert judged(turned) == judged(scene(2, normal(1e-2)))


def test_auto_does_with_the_impact_speed_that_the_remedy_names() -> None:
    slow = scene(2, normal("auto"), contact={"impact_speed": 0.01})
    (finding,) = judged(slow)
    assert finding.grade == "warning"
    with pytest.raises(StepError, match="gap of -"):
        rigidfluid.run(slow)
    speed = finding.enough["impact_speed"]
    fast = scene(2, normal("auto"), contact={"impact_speed": speed})
    assert "contact.impact_speed" in finding.remedy
    assert judged(fast)[0].grade == "note"
    assert least_gap(fast) > 0.0


def test_a_pair_that_no_law_keeps_apart_is_a_warning() -> None:
    (finding,) = judged(scene(2))
    assert finding.grade == "warning"
    assert "no law keeps them apart" in finding.text
    assert judged(scene(2, normal(1e-3), joint=[{"type": "rod", "between": ["a", "b"]}])) == []


def test_dampers_may_take_what_a_law_does_not_store() -> None:
    """The law holds the pull at rest, but not its work."""
    damped = {**normal(1e-2), "restitution": 0.3}
    (finding,) = judged(scene(2, damped))
    assert finding.grade == "note"
    assert "dampers must take the rest" in finding.text
