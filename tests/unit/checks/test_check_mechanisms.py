"""What `check` says of strokes."""

import pytest
from articulated_scenes import OUT, WAG, scene

from rigidfluid.checks.report import check

FLUID = {"backend": "scikit-fem", "density": 1.0, "viscosity": 1.0}


def found(*strokes, **keys):
    return [one for one in check(scene(*strokes, **keys)).findings if one.question == "stroke"]


def grades(findings):
    return [one.grade for one in findings]


def test_cycles_and_the_nearest_approach_are_told():
    components, cycles = sorted(found(OUT, end=0.25), key=lambda one: "period" in one.found)
    assert cycles.found == {"period": pytest.approx(0.1), "cycles": pytest.approx(2.5)}
    assert "no linear momentum" in cycles.text
    assert components.found["gap"] == pytest.approx(0.15)
    assert components.subject in (("it.head", "it.trunk"), ("it.trunk", "it.tail"))  # both are as near


def test_a_rigid_one_is_not_asked():
    assert found() == []


def test_a_stroke_that_does_not_repeat_holds_its_last_value():
    (note, *_) = (one for one in found(OUT | {"repeat": False}) if "repeat" in one.text)
    assert "held" in note.text


def test_components_nearer_than_the_mesh_resolves_are_a_warning():
    near = OUT | {"piecewise": [[0.0, 0.0], [0.05, -0.148], [0.1, 0.0]]}
    assert "warning" not in grades(found(near))
    (warning,) = (one for one in found(near, fluid=FLUID) if one.grade == "warning")
    assert warning.found["gap"] == pytest.approx(0.002, rel=1e-6)
    assert warning.found["time"] == pytest.approx(0.05)
    assert warning.enough["size_body"] == pytest.approx(0.002 * 32 / 2)


def test_a_wall_within_the_stroke_is_a_warning_and_one_beyond_it_is_not():
    """The head's centre goes from x to x - 0.06, less what the whole is moved by that."""
    assert "warning" not in grades(found(OUT, position=(0.70, 2.0)))
    (warning,) = (one for one in found(OUT, position=(0.55, 2.0)) if one.grade == "warning")
    assert warning.subject == ("it.head", "left")
    assert 0.03 <= warning.found["time"] <= 0.05


def test_corners_within_steps_are_a_warning():
    (warning,) = (one for one in found(OUT, WAG, step=0.004) if one.grade == "warning")
    assert warning.found == {"corners": 4}
    assert "0.03, 0.05" in warning.text
    assert "warning" not in grades(found(OUT, WAG, step=0.01))
