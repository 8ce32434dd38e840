"""Freedoms that joints leave, frequencies of their springs, and angles to which hinges can turn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.mechanics.rigid import rotate, rotation_matrices
from rigidfluid.core.model.interfaces import Detector
from rigidfluid.core.model.linkage import Joint, Linkage
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FloatArray, Pose
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.joints import joints_of
from rigidfluid.core.setup.parts import Parts

QUESTION = "joints"

_WELL_RESOLVED = 0.2
"""Greatest frequency times step at which a spring's period errs by less than 0.2 % [1]."""

_SCAN = np.linspace(0.0, np.pi, 73)[1:]
_BISECTIONS = 10
_STROKE_SAMPLES = 400


def joint_findings(parts: Parts, system: System) -> Iterator[Finding]:
    """Count freedoms, compare springs with the step, and turn hinges between two bodies until these touch.

    A warning where frequency times step is above 0.2, or bodies touch within half a turn; an error where a drive leads
    there.
    """
    if system.linkage is None:
        return
    scene = parts.scene
    yield _freedom_finding(scene, system, system.linkage)
    if system.linkage.frequency > 0.0:
        yield _spring_finding(scene, system, system.linkage)
    for joint in joints_of(scene, system.pose):
        if joint.type == "hinge" and joint.second is not None:
            yield _clearance_finding(parts, system, joint, joint.second)


def _freedom_finding(scene: Scene, system: System, linkage: Linkage) -> Finding:
    motions = system.pose if system.mechanisms is None else system.mechanisms.pose
    links = linkage.links(motions, 0.0)
    width = links.rows.shape[2]
    free = width * int(np.count_nonzero(~system.controlled_motions))
    held = int(np.count_nonzero(links.compliance == 0.0))
    found = {"joints": len(scene.joint), "velocities": free, "held": held, "remaining": free - held}
    text = f"joints and held directions take {held} of the {free} velocities of free motions; {free - held} are left"
    return Finding("note", QUESTION, (), text, found=found)


def _spring_finding(scene: Scene, system: System, linkage: Linkage) -> Finding:
    """Compare the frequency of the stiffest spring with the step; added mass slows it, by the mean of all that is
    linked."""
    frequency, step = linkage.frequency, scene.time.step
    carrier = np.arange(len(system.mass)) if system.mechanisms is None else system.mechanisms.carrier
    linked = linkage.linked[carrier]
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


def _clearance_finding(parts: Parts, system: System, joint: Joint, second: int) -> Finding:
    """Report how far the first body can turn either way before it touches the second."""
    names = system.surfaces[joint.first], system.surfaces[second]
    gap = partial(_gap, parts.exact_detector, system, joint, second)
    up, down = _touching_angle(gap, 1.0), _touching_angle(gap, -1.0)
    found = {"gap": gap(0.0), "least_angle": -down, "greatest_angle": up}
    text = f"hinge {joint.name} of {names[0]} and {names[1]}, a gap of {figure(gap(0.0))} apart, "
    if np.isinf(up) and np.isinf(down):
        return Finding("note", QUESTION, names, text + "turns all around", found=found)
    text += f"turns from {figure(-down)} to {figure(up)} until they touch"
    least, greatest = _drive_angles(parts.scene, joint)
    if least <= -down or greatest >= up:
        text += f", and its drive from {figure(least)} to {figure(greatest)}"
        return Finding("error", QUESTION, names, text, "Move them apart, or drive it less far.", found)
    remedy = "Move them apart, or hold them by a spring in the hinge: joined bodies do not repel each other."
    if joint.drive is not None:
        return Finding("note", QUESTION, names, text, found=found)
    return Finding("warning", QUESTION, names, text, remedy, found)


def _drive_angles(scene: Scene, joint: Joint) -> tuple[float, float]:
    """Least and greatest angle of a joint's drive; 0 without one."""
    if joint.drive is None:
        return 0.0, 0.0
    angles = [joint.drive(time)[0] for time in np.linspace(0.0, scene.time.end, _STROKE_SAMPLES)]
    return min(angles), max(angles)


def _touching_angle(gap: Callable[[float], float], sign: float) -> float:
    """Angle at which the two bodies touch either way, infinite where they do not within half a turn [rad]."""
    before = 0.0
    for angle in _SCAN:
        if gap(sign * angle) <= 0.0:
            break
        before = float(angle)
    else:
        return np.inf
    after = float(angle)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (before + after)
        before, after = (middle, after) if gap(sign * middle) > 0.0 else (before, middle)
    return before


def _gap(detector: type[Detector], system: System, joint: Joint, second: int, angle: float) -> float:
    """Gap between the two bodies where the first has turned by an ``angle`` [length]."""
    pair = [joint.first, second]
    position, orientation = system.pose.position[pair], system.pose.orientation[pair]
    turn = _turn(joint, angle)
    zero = np.zeros((1, 1)) if len(joint.at) == 2 else np.eye(1, 4)
    matrix = rotation_matrices(rotate(zero, turn))[0]
    turned = Pose(
        np.stack([joint.at + matrix @ (position[0] - joint.at), position[1]]),
        np.concatenate([rotate(orientation[:1], turn), orientation[1:]]),
    )
    bodies = tuple(system.bodies[body] for body in pair)
    return float(detector(detector.Options(), bodies, ()).detect(turned, None, np.inf).gap.min())


def _turn(joint: Joint, angle: float) -> FloatArray:
    return np.array([[angle]]) if joint.axis is None else angle * joint.axis[None]
