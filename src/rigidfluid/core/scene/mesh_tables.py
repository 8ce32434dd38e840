"""Table of a scene's mesh, and of the places where its cells are finer."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, WithJsonSchema

from rigidfluid.core.scene.table import OpenTable, Positive, Table
from rigidfluid.core.scene.vectors import Vector

AUTO = "auto"
"""Stands in a file for a number that is computed when the scene is loaded."""
EdgeLength = Annotated[
    float, Field(gt=0), WithJsonSchema({"anyOf": [{"exclusiveMinimum": 0, "type": "number"}, {"const": AUTO}]})
]


class WakeTable(Table):
    """Finer cells behind free and prescribed bodies, from x - time·velocity to x and as wide as the body.

    They exist from the second mesh on. A flow past a fixed body needs `[[mesh.refine]]`, or a `[[mesh.field]]` that
    follows the flow.
    """

    time: Positive = Field(
        description="Time for which the wake behind a body stays fine, at the body's present velocity [time]"
    )
    size: Positive = Field(description="Edge length in the wake [length]")


class RefineTable(Table):
    """A box with finer cells, which grow outside as they do away from a body."""

    lower: Vector = Field(description="Corner of the box with the smallest coordinates [length]")
    upper: Vector = Field(description="Corner of the box with the largest coordinates [length]")
    size: Positive = Field(description="Edge length in the box [length]")


class SizeFieldTable(OpenTable):
    """A size field, which sets the cell size by position and flow; of several the smallest size counts."""

    type: str = Field(description="Name of a size field")


class MeshTable(Table):
    """Resolution of the mesh, and when it is regenerated."""

    size: EdgeLength = Field(
        description="Edge length far from the bodies; `auto`, with `accuracy` alone: a quarter of the domain's least "
        "width [length]"
    )
    size_body: EdgeLength = Field(
        description="Edge length on the bodies; `auto`: half of the thinnest boundary layer d/√Re at the expected "
        "speeds, at most d/10, where d is the diameter of a ball of the body's volume; with `accuracy` just that, "
        "also if it is not given and `size` is `auto` [length]"
    )
    size_wall: Positive | None = Field(
        default=None,
        description="Edge length on walls that are not flat; if not given, a quarter of the smallest radius of "
        "curvature, where it is known [length]",
    )
    growth: float = Field(default=0.2, gt=0, le=10, description="Growth of the edge length per distance to a body [1]")
    cells_per_gap: int = Field(
        default=2, ge=1, le=100, description="Cells across the gap between surfaces near contact [1]"
    )
    quality: float = Field(default=0.25, gt=0, lt=1, description="Cell quality below which the mesh is regenerated [1]")
    refinements: int = Field(
        default=5,
        ge=0,
        le=20,
        description="Number of times that a facet may be halved in a gap; from five on, three more in films [1]",
    )
    order: Literal[1, 2] = Field(
        default=2, description="1: cells with straight edges; 2: curved along bodies and curved walls [1]"
    )
    inserter: Literal["cad", "fill", "level_set"] | None = Field(
        default=None,
        description="How the first mesh is made. cad: Netgen meshes the domain minus the bodies; fill: Netgen fills "
        "the space between the facets of both, which are kept; level_set: MMG cuts the bodies out of a mesh of the "
        "domain, for comparison. If not given, fill if a shape is made of facets and no surfaces are periodic, "
        "else cad",
    )
    mesher_timeout: Positive = Field(
        default=600.0, description="Time after which the mesher that fills between facets is stopped [s]"
    )
    remesh_every: Positive | None = Field(
        default=None, description="Age of a mesh at which it is always regenerated; never if not given [time]"
    )
    estimate: bool = Field(
        default=False, description="Record an estimate of the error that the mesh makes, of each step and in each cell"
    )
    accuracy: float | None = Field(
        default=None,
        gt=0,
        lt=1,
        description="Relative error of velocity gradients and pressure that the mesh may make, or of the bodies' "
        "forces; cells then follow its estimate, as far as those that `size` and `size_body` ask for are coarser [1]",
    )
    goal: Literal["flow", "forces"] = Field(
        default="flow",
        description="What `accuracy` is of. `flow`: velocity gradients and pressure; `forces`: forces and torques on "
        "the bodies, beside the root of the sum of the forces' squares",
    )
    most_cells: int = Field(
        default=50_000, ge=100, le=10**9, description="About how many cells `accuracy` asks for at most [1]"
    )
    wake: WakeTable | None = Field(default=None, description="Finer cells behind moving bodies")
    refine: tuple[RefineTable, ...] = Field(default=(), description="Boxes with finer cells")
    field: tuple[SizeFieldTable, ...] = Field(default=(), description="Size fields")
