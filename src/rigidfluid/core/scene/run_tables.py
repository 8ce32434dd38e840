"""Tables of a scene's run: its steps in time, and what it writes."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from rigidfluid.core.scene.table import Positive, Table
from rigidfluid.core.scene.vectors import Vector


class TimeTable(Table):
    """End, steps and tolerance of the simulation."""

    end: Positive = Field(description="Time at which the simulation ends [time]")
    step: Positive = Field(description="Size of a step [time]")
    tolerance: Annotated[float, Field(ge=1e-6, le=0.1)] | None = Field(
        default=None,
        description="Allowed local error of a step, relative and per unit time; `step` is then the longest step. If "
        "not given, only steps that cannot be taken whole are shorter than `step` [1]",
    )
    shortest: Positive = Field(
        default_factory=lambda table: table["step"] / 1024,
        description="Size below which a step is not shortened further; step/1024 if not given [time]",
    )


class OutputTable(Table):
    """Interval of fields and checkpoints, and points that record the flow."""

    every: Positive = Field(description="Time between two written fields and checkpoints [time]")
    probes: tuple[Vector, ...] = Field(
        default=(), description="Points that record velocity, pressure and scalar [length]"
    )
    stresslets: bool = Field(default=False, description="Record the stresslets of the bodies by the fluid")
    walls: bool = Field(
        default=False,
        description="Record the forces of the fluid, and of contacts, on the surfaces of the domain",
    )
    statistics: bool = Field(
        default=False, description="Record at each step velocities, gaps, contacts and stress of the bodies that move"
    )
    sensitivities: tuple[str, ...] = Field(
        default=(),
        description="Keys of the scene, as `fluid.viscosity` or `body.0.density`, by whose values poses, velocities "
        "and forces of the bodies are differentiated",
    )
    error_bars: bool = Field(
        default=False,
        description="Estimate how wrong the bodies' velocities, forces and torques are by mesh and by step, at each "
        "`every`; takes about half as long again as the run, and at each some ten steps on four (3D: eight) times the "
        "cells",
    )
