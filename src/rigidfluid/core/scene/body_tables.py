"""Tables of a scene's bodies and mechanisms: what they are, how they start and how they may move."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rigidfluid.core.scene.joint_tables import SpringTable
from rigidfluid.core.scene.patterns import BODY_NAME
from rigidfluid.core.scene.table import OpenTable, Positive, Table
from rigidfluid.core.scene.vectors import Angular, Vector

Freedom = Literal["x", "y", "z", "rotation", "rx", "ry", "rz"]
# How bodies and mechanisms start, in their keys alike.
InitialPosition = Annotated[Vector, Field(description="Initial position of the centre of mass [length]")]
InitialAngle = Annotated[float | None, Field(description="Initial angle, counter-clockwise; only in 2D [rad]")]
InitialOrientation = Annotated[
    tuple[float, float, float, float] | None,
    Field(description="Initial orientation, a quaternion, scalar first; 3D only; normalised when read [1]"),
]
InitialVelocity = Annotated[Vector | None, Field(description="Initial velocity; zero if not given [length/time]")]
InitialAngularVelocity = Annotated[
    Angular | None,
    Field(description="Initial angular velocity; a number in 2D; zero if not given [rad/time]"),
]


class PrescribedTable(Table):
    """A motion that the fluid cannot change: velocity(t) = velocity + 2π·frequency·amplitude·cos(2π·frequency·t)."""

    velocity: Vector | None = Field(default=None, description="Constant velocity; zero if not given [length/time]")
    angular_velocity: Angular | None = Field(
        default=None, description="Constant angular velocity; a number in 2D; zero if not given [rad/time]"
    )
    amplitude: Vector | None = Field(default=None, description="Amplitude of a sinusoidal displacement [length]")
    frequency: Positive | None = Field(default=None, description="Frequency of the sinusoidal displacement [1/time]")


class BodyTable(OpenTable):
    """One rigid body."""

    name: str = Field(
        default="",
        pattern=BODY_NAME,
        description="Name in the results, without control characters and `*`; `body0`, `body1`, … if not given",
    )
    type: str = Field(description="Name of a body type")
    density: Positive = Field(description="Density of the body [mass/length^d]")
    position: InitialPosition
    angle: InitialAngle = None
    orientation: InitialOrientation = None
    velocity: InitialVelocity = None
    angular_velocity: InitialAngularVelocity = None
    part_of: str | None = Field(
        default=None, description="Name of the articulated body it is a part of; parts of one body do not repel"
    )
    fixed: bool = Field(default=False, description="Whether the body is held in place")
    prescribed: PrescribedTable | None = Field(default=None, description="A motion that the fluid cannot change")
    free: tuple[Freedom, ...] | None = Field(
        default=None,
        description="Directions in which it may move; the others are held. Of `x`, `y`, `z`, in 2D `rotation`, in 3D "
        "rotations `rx`, `ry`, `rz` about the axes; all if not given",
    )
    spring: SpringTable | None = Field(default=None, description="Springs and dampers between it and the ground")


class MechanismTable(OpenTable):
    """Several bodies that move as one; the keys of its type define them."""

    name: str = Field(
        default="",
        pattern=BODY_NAME,
        description="Name in the results, before those of its components; `mechanism0`, … if not given",
    )
    type: str = Field(description="Name of a mechanism")
    position: InitialPosition
    angle: InitialAngle = None
    orientation: InitialOrientation = None
    velocity: InitialVelocity = None
    angular_velocity: InitialAngularVelocity = None
