"""A new scene: bodies in a box, with numbers chosen so that its check has nothing to warn of."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import replace
from math import ceil

from rigidfluid.checks import Finding, Report, check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.validation import LARGEST, SMALLEST
from rigidfluid.errors import SceneError
from rigidfluid.start.scene_text import EARTH, UNITS, Numbers, scene_text
from rigidfluid.start.wishes import Wishes

_TRIALS = 8
_MARGIN = 0.9
"""Share that is taken of what a check says would be enough at most."""


def new_scene(wishes: Wishes, name: str) -> tuple[str, Report]:
    """Text of a scene, and its check, which warns of nothing.

    Raises SceneError where no numbers are found with which that is so.
    """
    if wishes.shape == "polygon" and wishes.dimension == 3:
        raise SceneError("--shape", "'polygon' in 3D", "sphere, ellipsoid", "Choose one, or --dimension 2.")
    _check_numbers(wishes)
    numbers = _paced(wishes, name)
    for _ in range(_TRIALS):
        text, report = _checked(wishes, name, numbers)
        doubts = [finding for finding in report.findings if finding.grade != "note"]
        if not doubts:
            return text, report
        numbers = _adopted(numbers, doubts)
    remedy = "Choose another --size or --fluid; slow and small bodies in viscous fluids cost least."
    if any(finding.question == "units" for finding in doubts):
        earth = EARTH / UNITS[wishes.units][2]
        remedy = f"Set --gravity {earth:g}, or leave it out for the Earth's, or choose other --units."
    raise SceneError("new", f"with these numbers a check still warns: {doubts[0].text}", None, remedy)


def _check_numbers(wishes: Wishes) -> None:
    """Refuse, with SceneError, a width and a gravity with which there is no scene."""
    if not SMALLEST <= wishes.width <= LARGEST:
        found, allowed = f"{wishes.width:g}", f"a width from {SMALLEST:g} to {LARGEST:g}"
        raise SceneError("--size", found, allowed, "Give the width of the box in the units, or leave it out.")
    gravity = wishes.gravity
    if gravity is not None and not (gravity == 0.0 or SMALLEST <= gravity <= LARGEST):
        remedy = f"It acts downwards: leave the sign out, --gravity {-gravity:g}." if -LARGEST <= gravity < 0 else ""
        allowed = f"0, or a number from {SMALLEST:g} to {LARGEST:g}"
        remedy = remedy or "Leave it out for the Earth's; another direction is set in the file, as a vector."
        raise SceneError("--gravity", f"{gravity:g}", allowed, remedy)


def _paced(wishes: Wishes, name: str) -> Numbers:
    """Numbers with an end and a step that suit the speeds that a check expects."""
    first = Numbers.in_box(wishes.width, wishes.bodies, wishes.dimension)
    _, report = _checked(wishes, name, first)
    speed = max(row.impact_speed for row in report.bodies)
    return replace(first, end=1.5 * first.height / speed, step=0.1 * first.radius / speed)


def _checked(wishes: Wishes, name: str, numbers: Numbers) -> tuple[str, Report]:
    text = scene_text(wishes, name, numbers)
    try:
        return text, check(scene_from_dict(tomllib.loads(text)))
    except SceneError as error:
        found = f"numbers of which no scene can be made ({error})"
        raise SceneError("--size or --gravity", found, None, "Choose others, or leave them out.") from None


def _adopted(numbers: Numbers, doubts: Sequence[Finding]) -> Numbers:
    """Numbers that are enough for what a check doubts, where it says so."""
    for doubt in doubts:
        enough = {key: float(value) for key, value in doubt.enough.items() if isinstance(value, int | float)}
        if "time_step" in enough:
            numbers = replace(numbers, step=min(numbers.step, _MARGIN * enough["time_step"]))
        elif "refinements" in enough:
            numbers = replace(numbers, refinements=ceil(enough["refinements"]))
        elif "size_body" in enough:
            size = min(numbers.size_body or enough["size_body"], enough["size_body"])
            numbers = replace(numbers, size_body=_MARGIN * size)
        elif "restitution_stokes" in enough:
            numbers = replace(numbers, restitution_stokes=enough["restitution_stokes"])
        elif "range" in enough:
            numbers = replace(numbers, range=min(numbers.range, _MARGIN * enough["range"]))
    return numbers
