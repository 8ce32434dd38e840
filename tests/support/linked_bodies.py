"""Bodies with joints, without a scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.joint import Joint, PlacedJoint
from rigidfluid.core.joints.linkage import JointLinkage
from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.model.joints import GroundLink
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.scene.validation import read_table
from rigidfluid.registry import JOINT, Registry

AXIS = np.array([0.48, 0.6, 0.64])
"""Of hinges in 3D and of sliders."""


def placed(count: int, dimension: int, seed: int = 0) -> Pose:
    """Bodies somewhere, turned somehow."""
    random, k = np.random.default_rng(seed), 1 if dimension == 2 else 3
    position = random.uniform(-1.0, 1.0, (count, dimension)) + 2.0 * np.arange(count)[:, None]
    orientation = np.zeros((count, 1)) if dimension == 2 else np.tile(np.eye(1, 4), (count, 1))
    return Pose(position, rotate(orientation, random.normal(size=(count, k))))


def masses(count: int, dimension: int) -> tuple[FloatArray, FloatArray]:
    """Each body heavier than the one before, with three unequal principal moments in 3D."""
    mass = 1.0 + 0.5 * np.arange(count)
    moments = np.array([[0.3]]) if dimension == 2 else np.diag([0.2, 0.3, 0.4])
    return mass, mass[:, None, None] * moments


class GivenDrive:
    """A function that gives value and rate."""

    period = None

    def __init__(self, value_and_rate: Callable[[float], tuple[float, float]]) -> None:
        self._value_and_rate = value_and_rate

    def value(self, time: float) -> float:
        return self._value_and_rate(time)[0]

    def rate(self, time: float) -> float:
        return self._value_and_rate(time)[1]

    def next_corner(self, time: float) -> float:
        return inf


def build_joint(kind: str, dimension: int, drive: Any = None, **keys: Any) -> Joint:
    """In 3D about or along `AXIS`, in 2D along the same in the plane, unless ``keys`` say otherwise."""
    part = Registry.load().get(JOINT, kind)
    if kind == "slider" or (kind == "hinge" and dimension == 3):
        keys = {"axis": AXIS[:dimension].tolist()} | keys
    built = part(read_table(part.Options, keys), dimension)
    built.drive = None if drive is None else GivenDrive(drive)
    return built


def joint(kind: str, first: int, second: int | None, at: Sequence[float], name: str = "", **keys: Any) -> PlacedJoint:
    """Of a kind by `build_joint`."""
    point = np.array(at, dtype=float)
    return PlacedJoint(name or f"joint{first}", build_joint(kind, len(point), **keys), first, second, point)


def ground_link(body: int, dimension: int, held: Sequence[int] = (), **keys: Any) -> GroundLink:
    """Holds some directions, by number; without spring and damper unless ``keys`` say otherwise."""
    width = 3 if dimension == 2 else 6
    held_directions, zero = np.zeros(width, dtype=bool), np.zeros(width)
    held_directions[list(held)] = True
    given = {"stiffness": zero, "damping": zero} | {key: np.array(value, dtype=float) for key, value in keys.items()}
    return GroundLink(f"body{body}", body, held_directions, **given)


def linkage(
    pose: Pose,
    joints: Sequence[PlacedJoint] = (),
    ground: Sequence[GroundLink] = (),
    prescribed: Sequence[int] = (),
    given: Any = None,
) -> JointLinkage:
    """Of bodies with `masses`; ``given``: the twists of those that are prescribed, zero if not said."""
    count, dimension = pose.position.shape
    held = np.zeros(count, dtype=bool)
    held[list(prescribed)] = True
    rest = np.zeros((count, 3 if dimension == 2 else 6))
    bodies = SingleBodies(*masses(count, dimension), held, pose, split(rest, dimension))
    return JointLinkage(pose, joints, ground, bodies, given or (lambda _: rest))


def moved(pose: Pose, twist: FloatArray, time: float) -> Pose:
    """Where twists (n, d+k) lead to that stay as they are."""
    d = pose.position.shape[1]
    return Pose(pose.position + time * twist[:, :d], rotate(pose.orientation, time * twist[:, d:]))


def split(twist: FloatArray, dimension: int) -> Twist:
    """A record of (n, d+k)."""
    return Twist(twist[:, :dimension], twist[:, dimension:])
