"""Freedoms that joints leave, frequencies of their springs, and how far they can move."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.joints.joint import PlacedJoint
from rigidfluid.core.joints.joint_parts import joint_markers
from rigidfluid.core.joints.markers import Markers
from rigidfluid.core.mechanics.rigid import rotate, rotation_matrices
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose
from rigidfluid.core.setup.joints import placed_joints
from rigidfluid.core.setup.model import Model

QUESTION = "joints"

_WELL_RESOLVED = 0.2
"""Greatest frequency times step at which a spring's period errs by less than 0.2 % [1]."""

_SCAN = np.linspace(0.0, 1.0, 73)[1:]
"""Parts of the farthest value of a coordinate at which bodies are looked at until two touch."""

_BISECTIONS = 10
"""Bisections of the interval in which they first touch."""

_DRIVE_SAMPLES = 400
"""Times at which a drive is evaluated for its range."""


def joint_findings(model: Model, system: System) -> Iterator[Finding]:
    """Count freedoms, compare springs with the step, and move joints of one coordinate between two bodies until these
    touch.

    A warning where frequency times step is above 0.2, or bodies touch within half a turn or the domain; an error where
    a drive leads there.
    """
    if not system.joints.linked.any():
        return
    yield _freedom_finding(len(model.joints), system)
    if system.joints.frequency > 0.0:
        yield _spring_finding(model.time.step, system)
    for joint in placed_joints(model, system.pose):
        if joint.kind.coordinate is not None and joint.second is not None:
            yield _clearance_finding(model, system, joint, joint.second)


def _freedom_finding(joints: int, system: System) -> Finding:
    """Count the velocities of free motions, and those that rigid links leave."""
    links = system.joints.links(system.motions.pose, 0.0)
    width = links.rows.shape[2]
    free = width * int(np.count_nonzero(~system.motions.prescribed))
    held = int(np.count_nonzero(links.compliance == 0.0))
    found = {"joints": joints, "velocities": free, "held": held, "remaining": free - held}
    text = f"joints and held directions take {held} of the {free} velocities of free motions; {free - held} are left"
    return Finding("note", QUESTION, (), text, found=found)


def _spring_finding(step: float, system: System) -> Finding:
    """Compare the frequency of the stiffest spring with the step; the frequency with added mass is a guess by the sums
    of masses over all linked bodies."""
    frequency = system.joints.frequency
    linked = system.joints.linked[system.motions.carrier]
    added = np.trace(system.added_mass, axis1=1, axis2=2)[linked].sum() / system.dimension
    slowed = frequency / np.sqrt(1.0 + added / system.mass[linked].sum())
    found = {"frequency": frequency, "with_added_mass": slowed, "turn_per_step": frequency * step}
    text = f"the stiffest spring swings in {figure(2 * np.pi / frequency)}"
    if system.quasi_steady:
        text = f"the stiffest spring relaxes no faster than in {figure(1.0 / frequency)}"
    if added > 0.0:
        text += f", with added mass in about {figure(2 * np.pi / slowed)}"
    text += f"; frequency times step is {figure(frequency * step)}"
    if frequency * step <= _WELL_RESOLVED:
        return Finding("note", QUESTION, (), text, found=found)
    enough = {"time_step": _WELL_RESOLVED / frequency}
    remedy = f"Set time.step to {round_down(enough['time_step'])} or less."
    return Finding("warning", QUESTION, (), f"{text}: few steps for that", remedy, found, enough)


def _clearance_finding(model: Model, system: System, joint: PlacedJoint, second: int) -> Finding:
    """Report how far the coordinate can go either way before the first body touches the second."""
    names, coordinate = (system.surfaces[joint.first], system.surfaces[second]), joint.kind.coordinate
    assert coordinate is not None
    gap = partial(_gap, model.exact_detector, system, _path(system, joint), (joint.first, second))
    turning = np.isfinite(coordinate.period)
    farthest = 0.5 * coordinate.period if turning else float(np.linalg.norm(model.domain.size))
    up, down = _touching_value(gap, farthest), _touching_value(gap, -farthest)
    kind, moves = joint.kind.name, "turns" if turning else "moves"
    found = {"gap": gap(0.0), f"least_{coordinate.name}": -down, f"greatest_{coordinate.name}": up}
    text = f"{kind} {joint.name} of {names[0]} and {names[1]}, a gap of {figure(gap(0.0))} apart, {moves} "
    if np.isinf(up) and np.isinf(down):
        free = "all around" if turning else "either way without touching"
        return Finding("note", QUESTION, names, text + free, found=found)
    text += f"from {figure(-down)} to {figure(up)} until they touch"
    least, greatest = _drive_range(model.time.end, joint)
    if least <= -down or greatest >= up:
        text += f", and its drive from {figure(least)} to {figure(greatest)}"
        return Finding("error", QUESTION, names, text, "Move them apart, or drive it less far.", found)
    remedy = f"Move them apart, or hold them by a spring in the {kind}: joined bodies do not repel each other."
    if joint.kind.drive is not None:
        return Finding("note", QUESTION, names, text, found=found)
    return Finding("warning", QUESTION, names, text, remedy, found)


def _drive_range(end: float, joint: PlacedJoint) -> tuple[float, float]:
    """Least and greatest value of a joint's drive; 0 without one."""
    if joint.kind.drive is None:
        return 0.0, 0.0
    values = [joint.kind.drive.value(time) for time in np.linspace(0.0, end, _DRIVE_SAMPLES)]
    return min(values), max(values)


def _touching_value(gap: Callable[[float], float], farthest: float) -> float:
    """Distance that the coordinate goes towards the value ``farthest`` until the two bodies touch, infinite where they
    do not [length | rad]."""
    before = 0.0
    for value in _SCAN:
        if gap(value * farthest) <= 0.0:
            break
        before = float(value)
    else:
        return np.inf
    after = float(value)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (before + after)
        before, after = (middle, after) if gap(middle * farthest) > 0.0 else (before, middle)
    return before * abs(farthest)


def _path(system: System, joint: PlacedJoint) -> Callable[[float], Pose]:
    """Pose of the first body, one row, as a function of the joint's coordinate: it moves along the directions that the
    coordinate has at the start."""
    coordinate, first, pair = joint.kind.coordinate, joint.first, joint_markers(joint, system.pose)
    assert coordinate is not None
    placed = Markers([pair], system.dimension).placed(system.pose)[0]
    along, about = coordinate.directions(placed)
    position, orientation = system.pose.position[first], system.pose.orientation[first : first + 1]
    zero = np.zeros((1, 1)) if system.dimension == 2 else np.eye(1, 4)

    def pose_at(value: float) -> Pose:
        turn = value * about
        matrix = rotation_matrices(rotate(zero, turn))[0]
        centre = joint.at + matrix @ (position - joint.at) + value * along[0]
        return Pose(centre[None], rotate(orientation, turn))

    return pose_at


def _gap(
    detector: type[Detector], system: System, path: Callable[[float], Pose], pair: tuple[int, int], value: float
) -> float:
    """Gap between the two bodies of a pair where the first has gone along its path [length]."""
    moved, second = path(value), pair[1]
    pose = Pose(
        np.concatenate([moved.position, system.pose.position[second : second + 1]]),
        np.concatenate([moved.orientation, system.pose.orientation[second : second + 1]]),
    )
    bodies = tuple(system.bodies[body] for body in pair)
    return float(detector(detector.Options(), bodies, ()).detect(pose, None, np.inf).gap.min())
