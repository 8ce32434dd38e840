"""Table of a scene's fluid."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigidfluid.core.scene.table import OpenTable, Positive
from rigidfluid.core.scene.vectors import Formulas, Vector


class MaterialTable(OpenTable):
    """The material of the fluid, if its viscosity varies with the shear rate γ̇ = √(½|∇u + ∇uᵀ|²)."""

    type: str = Field(description="Name of a material")


class FluidTable(OpenTable):
    """The fluid, and the backend that computes it."""

    backend: str = Field(default="scikit-fem", description="Name of a fluid backend; `dry` leaves the fluid out")
    model: Literal["navier-stokes", "stokes"] = Field(
        default="navier-stokes", description="Equations of the fluid; `stokes` leaves out its inertia"
    )
    density: Positive | None = Field(
        default=None, description="Density of the fluid; needed by backends with a mesh, else 0 [mass/length^d]"
    )
    viscosity: Positive | None = Field(
        default=None,
        description="Dynamic viscosity; needed by backends with a mesh, unless there is a `material` "
        "[mass·length^(2-d)/time]",
    )
    material: MaterialTable | None = Field(
        default=None, description="Material whose viscosity varies; one with `viscosity` if not given"
    )
    gravity: Vector | None = Field(default=None, description="Gravity; zero if not given [length/time²]")
    force: Formulas | None = Field(
        default=None, description="Expressions of a force on the fluid alone; none if not given [force/volume]"
    )
    initial: Literal["rest", "steady"] | Formulas = Field(
        default="rest",
        description="Flow at the start: `rest`, except for what moving bodies set in motion, `steady`, settled around "
        "bodies that stay in their places, or expressions of its velocity; `steady` is no settled wake of a body that "
        "moves on, but is one of a body held in a stream [length/time]",
    )
