"""Table of a scalar that a scene's fluid carries along."""

from __future__ import annotations

from pydantic import Field

from rigidfluid.core.scene.table import Positive, Table
from rigidfluid.core.scene.vectors import Formula


class ScalarBoundaryTable(Table):
    """The scalar on a surface of the domain; nothing goes through those without a table, but with the fluid."""

    on: str = Field(description="Name of a surface of the domain, or `all` that are not periodic")
    value: Formula | None = Field(
        default=None,
        description="Value that is held there, a number or an expression; with a condition of type `pressure` that of "
        "the fluid that comes in [scalar]",
    )
    flux: Formula | None = Field(
        default=None, description="Instead of `value`, the flux into the fluid [scalar·length/time]"
    )


class ScalarBodyTable(Table):
    """The scalar on a body; nothing goes through bodies without a table."""

    on: str = Field(description="Name of a body, or `all`")
    value: Formula | None = Field(
        default=None,
        description="Value that is held on its surface, a number or an expression; with `capacity` the one at the "
        "start, `scalar.initial` if not given [scalar]",
    )
    flux: Formula | None = Field(
        default=None, description="Instead of `value`, the flux into the fluid [scalar·length/time]"
    )
    capacity: Positive | None = Field(
        default=None,
        description="The body has one value, which changes by the flux: its heat capacity over that of as much fluid, "
        "for bodies that conduct far better than the fluid; with `conductivity` it has many [1]",
    )
    conductivity: Positive | None = Field(
        default=None,
        description="Beside `capacity`: the scalar is solved for inside the body too, from `value` at the start on, "
        "with the body's conductivity over the fluid's [1]",
    )


class ScalarTable(Table):
    """A scalar that the fluid carries along, as temperature or concentration; results call it `scalar`.

    Expressions are those of `[[boundary]]` with type = 'velocity'.
    """

    diffusivity: Positive = Field(description="Diffusivity of the scalar in the fluid [length²/time]")
    initial: Formula = Field(default=0.0, description="Value at the start, a number or an expression [scalar]")
    source: Formula | None = Field(
        default=None, description="Source in the fluid, a number or an expression; none if not given [scalar/time]"
    )
    expansion: float | None = Field(
        default=None,
        description="Expansion β of the fluid: its weight changes by -ρβ(T - `reference`) times `fluid.gravity` "
        "(Boussinesq); the flow does not feel the scalar if not given [1/scalar]",
    )
    reference: float | None = Field(default=None, description="Value at which there is no buoyancy; 0 if not given")
    boundary: tuple[ScalarBoundaryTable, ...] = Field(
        default=(), description="Conditions on surfaces of the domain; a later entry overrides an earlier one"
    )
    body: tuple[ScalarBodyTable, ...] = Field(
        default=(), description="Conditions on bodies; a later entry overrides an earlier one"
    )
