"""Tables of what holds a scene's bodies: joints, and springs between a body and the ground."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from rigidfluid.core.scene.patterns import PRINTABLE
from rigidfluid.core.scene.table import OpenTable, Table
from rigidfluid.core.scene.vectors import NotNegative, NotNegativeAngular, Vector


class JointTable(OpenTable):
    """A joint between two bodies, or of one with the ground."""

    name: str = Field(
        default="", pattern=PRINTABLE, description="Name in the results; `joint0`, `joint1`, … if not given"
    )
    type: str = Field(description="Name of a joint type; `rod` has no keys of its own: the bodies move as one")
    between: Annotated[tuple[str, ...], Field(min_length=1, max_length=2)] = Field(
        description="Names of two bodies or components, or of one that is joined to the ground"
    )
    at: Vector | None = Field(
        default=None,
        description="Point of the joint at the start; for a rod and a slider the first body's centre of mass if not "
        "given [length]",
    )


class SpringTable(Table):
    """Springs and dampers between a body and the ground, along the axes: force = -stiffness · displacement - damping
    · velocity, and likewise for rotations."""

    stiffness: NotNegative | None = Field(
        default=None, description="Along x, y (and z); zero if not given [force/length]"
    )
    damping: NotNegative | None = Field(
        default=None, description="Along x, y, z; zero if not given [force·time/length]"
    )
    angular_stiffness: NotNegativeAngular | None = Field(
        default=None, description="A number in 2D, about x, y and z in 3D; zero if not given [force·length/rad]"
    )
    angular_damping: NotNegativeAngular | None = Field(
        default=None, description="A number in 2D, about x, y and z in 3D; zero if not given [force·length·time/rad]"
    )
    rest: Vector | None = Field(
        default=None,
        description="Position of the centre of mass at which springs exert no force; that at the start if not given; "
        "rotational springs rest at the initial orientation [length]",
    )
