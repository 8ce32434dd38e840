"""Tables of conditions on the surfaces of a scene's domain, one class for each type."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from rigidfluid.core.scene.rows_over_time import TimeFileTable
from rigidfluid.core.scene.table import Positive, Table
from rigidfluid.core.scene.vectors import Angular, Formula, Formulas, Vector


class _BoundaryTable(Table):
    """A condition on a surface of the domain, or on all of them."""

    on: str = Field(description="Name of a surface of the domain, or `all`")
    type: str


class VaryingTable(_BoundaryTable):
    """A condition with values that may change in time."""

    over_time: tuple[tuple[float, float], ...] | TimeFileTable | None = Field(
        default=None,
        description="Factor of the velocity or pressure in rows [time, factor], linear between them, from 0 to "
        "`time.end`; or a table with a `file` of such rows",
    )
    ramp: Positive | None = Field(
        default=None, description="Time in which the velocity or pressure rises smoothly from zero [time]"
    )


class WallTable(_BoundaryTable):
    """No slip; the only type that repels bodies. A wall may move along itself."""

    type: Literal["wall"] = Field(description="The condition")
    velocity: Vector | None = Field(
        default=None,
        description="Velocity of a wall along itself, in numbers; expressions need type = 'velocity' [length/time]",
    )
    angular_velocity: Angular | None = Field(
        default=None, description="Angular velocity of a wall that rotates along itself; a number in 2D [rad/time]"
    )
    centre: Vector | None = Field(
        default=None, description="Point that such a wall rotates about; the origin if not given [length]"
    )


class VelocityTable(VaryingTable):
    """A prescribed velocity, given directly or by its `flux`.

    Values may be expressions of x, y, z and t in quotes, with `pi`, `+ - * / **`, comparisons, which `and`, `or` and
    `not` join, and the functions `sin`, `cos`, `tan`, `tanh`, `exp`, `log`, `sqrt`, `abs`, `min`, `max` and
    `where(condition, then, otherwise)`.
    """

    type: Literal["velocity"] = Field(description="The condition")
    velocity: Formulas | None = Field(default=None, description="Velocity, at the peak of the `profile` [length/time]")
    flux: Formula | None = Field(
        default=None,
        description="Instead of `velocity`, the inflow through the surface, negative for outflow: a number or an "
        "expression of t only [length^d/time]",
    )
    profile: Literal["uniform", "parabolic", "poiseuille", "couette"] = Field(
        default="uniform",
        description="Distribution of the velocity over the surface; `parabolic` is zero on its edges; `poiseuille` is "
        "the developed flow through a segment, rectangle or disk; `couette` rises from one end of a segment to the "
        "other",
    )


class PressureTable(VaryingTable):
    """An open end with a prescribed pressure, a number or an expression; fluid passes it at right angles."""

    type: Literal["pressure"] = Field(description="The condition")
    pressure: Formula = Field(description="Pressure on the surface [force/length^(d-1)]")


class SlipTable(_BoundaryTable):
    """No fluid passes; it flows along the surface without traction."""

    type: Annotated[Literal["slip", "symmetry"], AfterValidator(lambda value: "slip")] = Field(
        description="The condition; `symmetry` is another name of it"
    )


class PeriodicTable(_BoundaryTable):
    """On two opposite surfaces: what flows out through one comes in through the other.

    Bodies cross them, and meet images of each other. Pairs are then at right angles to each other, all other surfaces
    flat and along the way across, and a body's longest diameter and the range of the laws are together less than the
    distance of the surfaces. Positions in results go on beyond the domain. With a fluid there may be other surfaces,
    such as obstacles: a run then ends where the centre of a body leaves the domain, or a body comes within the range of
    the laws to an image of another body or of a curved wall.
    """

    type: Literal["periodic"] = Field(description="The condition")
    pressure_drop: Formula | None = Field(
        default=None,
        description="Excess of the pressure here over that on the opposite surface: a number or an expression of t "
        "only [force/length^(d-1)]",
    )
    flux: Formula | None = Field(
        default=None,
        description="Instead of `pressure_drop`, the flux of fluid and bodies together into the domain here, and out "
        "of it on the opposite surface: a number or an expression of t only; the drop of pressure is found in each "
        "step [length^d/time]",
    )

    @property
    def driving(self) -> Literal["pressure_drop", "flux"] | None:
        """The key that drives a flow, if one is given."""
        return "pressure_drop" if self.pressure_drop is not None else "flux" if self.flux is not None else None


BoundaryTable = WallTable | VelocityTable | PressureTable | SlipTable | PeriodicTable
