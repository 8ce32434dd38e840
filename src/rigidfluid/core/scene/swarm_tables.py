"""Tables of swarms: bodies that are seeded at random, or listed in a file, when the scene is loaded."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rigidfluid.core.scene.body_tables import (
    InitialAngle,
    InitialAngularVelocity,
    InitialOrientation,
    InitialVelocity,
)
from rigidfluid.core.scene.patterns import BODY_NAME
from rigidfluid.core.scene.table import OpenTable, Positive, Table
from rigidfluid.core.scene.vectors import Vector

MOST_BODIES = 10_000
"""Greatest number of bodies of one swarm."""

NotNegative = Annotated[float, Field(ge=0)]


class SwarmShapeTable(OpenTable):
    """A shape of a swarm's bodies; it also has the keys of its type."""

    type: str = Field(description="Name of a body type")
    weight: Positive = Field(
        default=1.0, description="Share of the bodies that have this shape, relative to the other weights [1]"
    )


class UniformSizes(Table):
    """Sizes with equal chances for equal differences."""

    distribution: Literal["uniform"] = Field(description="Distribution of the factor")
    least: Positive = Field(description="Least factor [1]")
    greatest: Positive = Field(description="Greatest factor [1]")


class NormalSizes(Table):
    """Sizes of a normal distribution, cut off at both ends."""

    distribution: Literal["normal"] = Field(description="Distribution of the factor")
    mean: Positive = Field(default=1.0, description="Mean before the ends are cut off [1]")
    deviation: Positive = Field(description="Standard deviation before the ends are cut off [1]")
    least: Positive = Field(description="Least factor [1]")
    greatest: Positive = Field(description="Greatest factor [1]")


class LogNormalSizes(Table):
    """Sizes with normally distributed logarithms, cut off at both ends."""

    distribution: Literal["log-normal"] = Field(description="Distribution of the factor")
    median: Positive = Field(default=1.0, description="Median before the ends are cut off [1]")
    deviation: Positive = Field(
        description="Standard deviation of the natural logarithm before the ends are cut off [1]"
    )
    least: Positive = Field(description="Least factor [1]")
    greatest: Positive = Field(description="Greatest factor [1]")


class TableSizes(Table):
    """Sizes of a table, as of a sieve analysis."""

    distribution: Literal["table"] = Field(description="Distribution of the factor")
    rows: tuple[tuple[Positive, NotNegative], ...] = Field(
        min_length=1, description="Rows [factor, share of the bodies], the shares relative to their sum [1]"
    )


SizeTable = Annotated[UniformSizes | NormalSizes | LogNormalSizes | TableSizes, Field(discriminator="distribution")]


class BoxRegion(Table):
    """A box with its sides along the axes."""

    type: Literal["box"] = Field(description="Form of the region")
    lower: Vector = Field(description="Corner with the smallest coordinates [length]")
    upper: Vector = Field(description="Corner with the largest coordinates [length]")


class CylinderRegion(Table):
    """A circular cylinder between two points; in 2D a disk."""

    type: Literal["cylinder"] = Field(description="Form of the region")
    start: Vector = Field(description="Centre of one end; in 2D of the disk [length]")
    end: Vector | None = Field(default=None, description="Centre of the other end; only in 3D [length]")
    radius: Positive = Field(description="Radius [length]")


class FileRegion(Table):
    """The inside of a closed surface of triangles from an STL file; only in 3D."""

    type: Literal["file"] = Field(description="Form of the region")
    file: str = Field(description="STL file, text or binary, searched for in the scene's folder")
    scale: Positive = Field(default=1.0, description="Factor by which lengths in the file are multiplied [1]")


RegionTable = Annotated[BoxRegion | CylinderRegion | FileRegion, Field(discriminator="type")]


class SeededTable(Table):
    """Record of bodies that were seeded. Results and checkpoints have it; a swarm with it is not seeded again, since
    its bodies are among those of the scene."""

    number: int = Field(ge=0, description="Number of bodies")
    fraction: NotNegative = Field(description="Their volume over that of the region [1]")
    gap: float = Field(description="Smallest gap to each other, other bodies and walls [length]")
    way: Literal["insertion", "growth", "file"] = Field(
        description="insertion: at random, one by one; growth: small bodies have grown and pushed each other away; "
        "file: as they are listed"
    )


class RandomBodies(Table):
    """Bodies whose shapes, sizes, orientations and velocities are random, and the region that holds them."""

    name: str = Field(
        min_length=1, pattern=BODY_NAME, description="Beginning of the names of its bodies: `grain` gives `grain0`, …"
    )
    shape: tuple[SwarmShapeTable, ...] = Field(min_length=1, description="Shapes, each with its share of the bodies")
    density: Positive = Field(description="Density of the bodies [mass/length^d]")
    size: SizeTable | None = Field(
        default=None, description="Distribution of the factor by which lengths of the shapes are multiplied"
    )
    angle: InitialAngle = None
    orientation: InitialOrientation = None
    tilt: NotNegative = Field(
        default=0.0,
        description="Standard deviation of a random rotation from `angle` or `orientation`, in 3D about each axis; "
        "without these all orientations are equally likely [rad]",
    )
    gap: Positive | None = Field(
        default=None,
        description="Least gap to each other, to other bodies and to walls; 0.01 of the smallest body's bounding "
        "radius if not given [length]",
    )
    region: RegionTable | None = Field(
        default=None,
        description="Region that holds all of each body; the whole domain if not given, "
        "in a swarm across periodic surfaces too",
    )
    velocity: InitialVelocity = None
    velocity_deviation: NotNegative = Field(
        default=0.0,
        description="Standard deviation of a random, normally distributed part of each component of the velocity "
        "[length/time]",
    )
    angular_velocity: InitialAngularVelocity = None
    angular_velocity_deviation: NotNegative = Field(
        default=0.0,
        description="Standard deviation of a random, normally distributed part of each component of the angular "
        "velocity [rad/time]",
    )


class SwarmTable(RandomBodies):
    """Bodies that are seeded when the scene is loaded, in the same places for the same `scene.seed`.

    Exactly one of `number`, `fraction` and `file` is given. [How to seed bodies](howto/seed-bodies.md) has examples.
    """

    number: int | None = Field(default=None, ge=1, le=MOST_BODIES, description="Number of bodies")
    fraction: float | None = Field(
        default=None,
        gt=0,
        lt=1,
        description="Volume of the bodies over that of the region, which the nearest number of bodies gives [1]",
    )
    file: str | None = Field(
        default=None,
        description="CSV file with a body in each row, searched for in the scene's folder. Its first row names the "
        "columns: x, y, z, and if needed name, shape (number in the list), size or radius, density, angle or qw, qx, "
        "qy, qz, vx, vy, vz, and w or wx, wy, wz. What has no column follows from the other keys",
    )
    seeded: SeededTable | None = Field(
        default=None, description="Record of bodies that were seeded; written with results, and never by hand"
    )
