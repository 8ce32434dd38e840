"""Conditions on the domain's boundary: one class each, which says what it holds and by which values.

A class of another kind is one more subclass; no backend asks which class it has.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from typing import ClassVar, Self

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.given_function import guarded_function

Value = Callable[[float, FloatArray], FloatArray]
"""Velocities (N, d) or pressures (N,) at a time and points (N, d)."""

TimeValue = Callable[[float], float]
"""A number at a time."""

WallValue = Callable[[FloatArray], FloatArray]
"""Velocities (N, d) of a wall at its points (N, d), the same at any time."""


Place = Callable[[FloatArray], FloatArray]
"""The points (N, d) in a periodic domain whose images are at some points (N, d) [length]."""


def no_pressure(time: float, points: FloatArray) -> FloatArray:
    """Zero (N,) at ``points`` (N, d)."""
    return np.zeros(len(points))


@dataclass(frozen=True)
class BoundaryCondition(ABC):
    """Condition on one piece of the domain's boundary.

    Either the velocity or the traction is given across the piece, and either of both along it. A velocity that is held
    as a whole is `velocity`; a part that is held alone is zero. A traction along the piece is zero; across it, it is -p
    of `pressure`.

    Parameters
    ----------
    surface : int
        Number of the piece among all surfaces: bodies first, then the pieces of the boundary.
    name : str
        Name of the piece.
    normal : (d,) array or None
        Unit normal into the fluid; None where the piece is not flat.
    field : str
        Key of the scene's table that asks for it, for messages.
    """

    type: ClassVar[str] = "custom"
    """Name of the condition in scenes and messages."""

    surface: int
    name: str
    normal: FloatArray | None
    field: str = field(default="boundary", kw_only=True)

    def __post_init__(self) -> None:
        for one in fields(self):
            if callable(value := getattr(self, one.name)):
                guarded = guarded_function(value, f"{self.field}.{one.name} on {self.name!r}")
                object.__setattr__(self, one.name, guarded)

    @property
    @abstractmethod
    def prescribes_normal(self) -> bool:
        """Tell whether the velocity across the piece is given, else the traction."""

    @property
    @abstractmethod
    def prescribes_tangential(self) -> bool:
        """Tell whether the velocity along the piece is given, else the traction."""

    @property
    @abstractmethod
    def passes(self) -> bool:
        """Tell whether fluid goes in or out here, and its kinetic energy with it."""

    def velocity(self, time: float, points: FloatArray) -> FloatArray:
        """Velocity (N, d) at ``points`` (N, d) of the piece, where all of it is held [length/time]."""
        return np.zeros_like(points)

    def pressure(self, time: float, points: FloatArray) -> FloatArray:
        """Pressure (N,) at ``points`` (N, d) of the piece; of a periodic one its excess [force/length^(d-1)]."""
        return no_pressure(time, points)

    @property
    def data(self) -> Value:
        """Function of time and place that is prescribed: the velocity, unless said otherwise."""
        return self.velocity

    @property
    def held_flux(self) -> TimeValue | None:
        """Flux into the domain that is prescribed as a whole, for which the drop of pressure is found
        [length^d/time]; None if there is none."""
        return None

    @property
    def sliding(self) -> WallValue | None:
        """Velocity (N, d) at which a wall slides in itself, at points (N, d); None at rest [length/time]."""
        return None

    @property
    def image(self) -> int | None:
        """Number of the surface that is the same as this one; None, unless it is the first of a periodic pair."""
        return None

    def with_image(self, surface: int) -> Self:
        """The condition on the first piece of a periodic pair, whose other one has this number."""
        return self

    def in_each_image(self, original: Place) -> Self:
        """The condition with the values of its ``original`` place at all images of a periodic domain."""
        return self

    @property
    def is_seam(self) -> bool:
        """Tell whether it is only where a periodic domain is cut open, and its facets may be off the flat piece."""
        return False

    @property
    def holds_all(self) -> bool:
        """Tell whether the whole velocity is given."""
        return self.prescribes_normal and self.prescribes_tangential

    @property
    def holds_part(self) -> bool:
        """Tell whether the velocity is given either across or along the piece, and not both."""
        return self.prescribes_normal != self.prescribes_tangential

    @property
    def slips(self) -> bool:
        """Tell whether fluid goes along it without traction, and not across."""
        return self.prescribes_normal and not self.prescribes_tangential

    @property
    def is_open(self) -> bool:
        """Tell whether fluid goes in or out by itself; else nothing fixes the constant in the pressure."""
        return self.passes and not self.prescribes_normal

    @property
    def is_wall(self) -> bool:
        """Tell whether it is part of the container, which holds the fluid and lets none pass."""
        return self.holds_all and not self.passes

    @property
    def rests(self) -> bool:
        """Tell whether it is a wall that never moves: where two walls meet, that one holds the fluid."""
        return False


@dataclass(frozen=True)
class NoSlip(BoundaryCondition):
    """A wall: it repels bodies, and the fluid there has the wall's velocity, ``sliding(points)`` (N, d) along itself
    [length/time]; it rests if None is given."""

    type: ClassVar[str] = "wall"
    sliding: WallValue | None = None

    prescribes_normal = True
    prescribes_tangential = True
    passes = False

    def velocity(self, time: float, points: FloatArray) -> FloatArray:
        """Velocity (N, d) of the wall at ``points`` (N, d) [length/time]."""
        return np.zeros_like(points) if self.sliding is None else self.sliding(points)

    def in_each_image(self, original: Place) -> Self:
        """The same wall with the same velocity in each image."""
        sliding = self.sliding
        return self if sliding is None else replace(self, sliding=lambda points: sliding(original(points)))

    @property
    def rests(self) -> bool:
        """Tell whether no velocity is given."""
        return self.sliding is None


@dataclass(frozen=True)
class PrescribedVelocity(BoundaryCondition):
    """A velocity that is given, ``value(time, points)`` (N, d) [length/time]; fluid may pass with it."""

    type: ClassVar[str] = "velocity"
    value: Value

    prescribes_normal = True
    prescribes_tangential = True
    passes = True

    def in_each_image(self, original: Place) -> Self:
        """The same velocity in each image."""
        return replace(self, value=lambda time, points: self.value(time, original(points)))

    @property
    def data(self) -> Value:
        """The velocity (N, d) by time and points (N, d) [length/time]."""
        return self.value

    def velocity(self, time: float, points: FloatArray) -> FloatArray:
        """Velocity (N, d) at ``points`` (N, d) [length/time]."""
        return self.value(time, points)


@dataclass(frozen=True)
class PrescribedPressure(BoundaryCondition):
    """An end that fluid passes straight, under a pressure ``value(time, points)`` (N,) [force/length^(d-1)]."""

    type: ClassVar[str] = "pressure"
    value: Value = no_pressure

    prescribes_normal = False
    prescribes_tangential = True
    passes = True

    def in_each_image(self, original: Place) -> Self:
        """The same pressure in each image."""
        return replace(self, value=lambda time, points: self.value(time, original(points)))

    @property
    def data(self) -> Value:
        """The pressure (N,) by time and points (N, d) [force/length^(d-1)]."""
        return self.value

    def pressure(self, time: float, points: FloatArray) -> FloatArray:
        """Pressure (N,) at ``points`` (N, d) [force/length^(d-1)]."""
        return self.value(time, points)


@dataclass(frozen=True)
class Slip(BoundaryCondition):
    """A surface that fluid goes along without traction and does not pass, as a plane of symmetry."""

    type: ClassVar[str] = "slip"

    prescribes_normal = True
    prescribes_tangential = False
    passes = False


@dataclass(frozen=True)
class Periodic(BoundaryCondition):
    """One of two opposite surfaces with the same velocity and traction.

    The first of them names the other, by its number ``image``; the pressure may be higher on it, by ``drop(time,
    points)`` (N,) [force/length^(d-1)], or by as much as drives the flux ``held_flux(time)`` of fluid into the domain
    through it [length^d/time]. The other has none of these.
    """

    type: ClassVar[str] = "periodic"
    image: int | None = None
    drop: Value = no_pressure
    held_flux: TimeValue | None = None

    prescribes_normal = False
    prescribes_tangential = False
    passes = False
    is_seam = True

    @property
    def data(self) -> Value:
        """The excess of the pressure (N,) by time and points (N, d) [force/length^(d-1)]."""
        return self.drop

    def pressure(self, time: float, points: FloatArray) -> FloatArray:
        """Excess of the pressure (N,) at ``points`` (N, d) [force/length^(d-1)]."""
        return self.drop(time, points)

    def with_image(self, surface: int) -> Self:
        """The first of the pair, whose image is the other."""
        return replace(self, image=surface)
