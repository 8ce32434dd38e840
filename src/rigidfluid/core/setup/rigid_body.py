"""Objects of a model that move: bodies, mechanisms in their place, joined bodies."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import BoolArray
from rigidfluid.core.joints.joint import Joint
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.scene.body_tables import Freedom, PrescribedTable
from rigidfluid.core.scene.joint_tables import SpringTable
from rigidfluid.core.setup.checked import AngularVector, AnyRow, Name, Number, Positive, Vector, checked

DIRECTIONS = {2: ("x", "y", "rotation"), 3: ("x", "y", "z", "rx", "ry", "rz")}
"""Names of the d+k directions of motion."""


@checked
class Start:
    """Place and velocities at the start, of the centre of mass; other arguments of a class that has them come before,
    from the bases after this one."""

    position: Vector
    angle: Number | None = None
    orientation: Vector | None = None
    velocity: Vector | None = None
    angular_velocity: AngularVector | None = None


@checked
class _Shaped:
    """A shape with its name and density."""

    name: Name
    shape: Body
    density: Positive


@checked
class _NamedMechanism:
    """A mechanism with its name."""

    name: Name
    mechanism: Mechanism


@checked
class RigidBody(Start, _Shaped):
    """A rigid body with the velocities v and ω about its centre of mass: where it starts, and what moves it.

    Parameters
    ----------
    name : str
        Name in the results, which no other body has.
    shape : Body
        Its shape, of a registered type or any other.
    density : float
        Mass over volume [mass/length^d].
    position : sequence of float
        Position of the centre of mass at the start, (d,) [length].
    angle : float, optional
        Angle at the start, counter-clockwise; in 2D alone [rad].
    orientation : sequence of float, optional
        Orientation at the start, a quaternion (4,), scalar first; in 3D alone [1].
    velocity : sequence of float, optional
        Velocity at the start, (d,); zero if not given [length/time].
    angular_velocity : float or sequence of float, optional
        Angular velocity at the start, in 2D a number or (1,), in 3D (3,); zero if not given [rad/time].
    part_of : str, optional
        Name of the articulated body that it is a part of; parts of one do not repel each other.
    fixed : bool
        Whether it is held in place.
    prescribed : PrescribedTable, optional
        A motion that the fluid cannot change.
    free : sequence of str, optional
        Directions in which it may move, the others are held: `x`, `y`, `z`, in 2D `rotation`, in 3D `rx`, `ry`, `rz`.
    spring : SpringTable, optional
        Springs and dampers between it and the ground.
    """

    part_of: str | None = None
    fixed: bool = False
    prescribed: PrescribedTable | None = None
    free: Annotated[tuple[Freedom, ...] | None, AnyRow] = None
    spring: SpringTable | None = None

    @property
    def is_prescribed(self) -> bool:
        """Tell whether its motion is prescribed; it is zero if fixed."""
        return self.fixed or self.prescribed is not None

    @property
    def linked_to_ground(self) -> bool:
        """Tell whether directions of it are held, or springs pull it."""
        return self.free is not None or self.spring is not None

    @property
    def held_directions(self) -> BoolArray:
        """Directions (d+k,) in which it is held."""
        names = DIRECTIONS[self.shape.dimension]
        return np.array([self.free is not None and name not in self.free for name in names])


@checked
class PlacedMechanism(Start, _NamedMechanism):
    """A mechanism named ``name`` in its place at the start, that of its centre of mass; the other values are those of a
    `RigidBody`."""


@checked
class JoinedBodies:
    """A joint named ``name`` of a ``kind`` between two bodies by name, or of one with the ground; ``at`` (d,) is its
    point at the start, the first body's if None [length]."""

    name: Name
    kind: Joint
    between: Annotated[tuple[str, ...], AnyRow, Field(min_length=1, max_length=2)]
    at: Vector | None = None
