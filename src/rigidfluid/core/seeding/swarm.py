"""Bodies of a swarm before they have places: their shapes and sizes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.body import Body
from rigidfluid.core.nested.part_options import build_part
from rigidfluid.core.scene.swarm_tables import MOST_BODIES, SwarmTable
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.listed_bodies import Row
from rigidfluid.core.seeding.scaled_body import ScaledBody
from rigidfluid.core.seeding.scaled_options import scaled_options
from rigidfluid.errors import SceneError
from rigidfluid.registry import BODY, Registry


@dataclass(frozen=True)
class Swarm:
    """Bodies of a ``table`` at the place ``at`` of a scene: ``shapes`` of its list, and for each body ``shape`` (n,),
    its number there, and ``factor`` (n,), by which its lengths are multiplied [1]."""

    table: SwarmTable
    at: str
    shapes: tuple[Body, ...]
    shape: IntArray
    factor: FloatArray

    def __len__(self) -> int:
        return len(self.shape)

    @property
    def dimension(self) -> int:
        """Number of space dimensions."""
        return self.shapes[0].dimension

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The shape of each body in its size."""
        of_list = [self.shapes[number] for number in self.shape]
        return tuple(
            shape if factor == 1.0 else ScaledBody(shape, factor)
            for shape, factor in zip(of_list, self.factor.tolist(), strict=True)
        )

    @property
    def volume(self) -> float:
        """Volume of all bodies [length^d]."""
        return float(self.volumes.sum())

    @property
    def volumes(self) -> FloatArray:
        """Volume of each body, (n,) [length^d]."""
        return np.asarray(self.factor**self.dimension * np.array([shape.volume for shape in self.shapes])[self.shape])

    @property
    def bounding_radii(self) -> FloatArray:
        """Bounding radius of each body, (n,) [length]."""
        return np.asarray(self.factor * np.array([shape.bounding_radius for shape in self.shapes])[self.shape])

    @property
    def gap(self) -> float:
        """The least gap that is wanted [length]."""
        return 0.01 * float(self.bounding_radii.min()) if self.table.gap is None else self.table.gap

    def first(self, count: int) -> Swarm:
        """The first bodies."""
        return replace(self, shape=self.shape[:count], factor=self.factor[:count])

    def options(self, body: int) -> dict[str, Any]:
        """Type and keys of the shape of a body in its size."""
        table, shape = self.table.shape[self.shape[body]], self.shapes[self.shape[body]]
        return {"type": table.type, **scaled_options(type(shape), table.options, float(self.factor[body]), self.at)}


def swarm_of(table: SwarmTable, at: str, dimension: int, draws: Draws, registry: Registry) -> Swarm:
    """Bodies of a table, `MOST_BODIES` of them, with shapes and sizes at random; raises SceneError or PluginError
    for shapes that cannot be made."""
    shapes = tuple(
        build_part(BODY, shape, f"{at}.shape.{n}", registry, dimension) for n, shape in enumerate(table.shape)
    )
    weights = [shape.weight for shape in table.shape]
    return Swarm(table, at, shapes, draws.choices(MOST_BODIES, weights), draws.factors(MOST_BODIES, table.size))


def with_fraction(swarm: Swarm, fraction: float, region_volume: float) -> Swarm:
    """The first bodies, up to the number that comes nearest to this ``fraction`` of the region's volume; raises
    SceneError if there are too few, or if one body is more."""
    reached = np.concatenate([[0.0], np.cumsum(swarm.volumes)]) / region_volume
    if reached[-1] < fraction:
        found = f"{fraction:g}, of which {MOST_BODIES} bodies fill {reached[-1]:.3g}"
        remedy = "Make the bodies larger or the region smaller, or use several swarms."
        raise SceneError(f"{swarm.at}.fraction", found, f"at most {MOST_BODIES} bodies", remedy)
    count = int(np.argmin(np.abs(reached - fraction)))
    if count == 0:
        found = f"{fraction:g}, less than half of the {reached[1]:.3g} of one body"
        raise SceneError(f"{swarm.at}.fraction", found, "one body at least", "Make the bodies smaller.")
    return swarm.first(count)


def with_rows(swarm: Swarm, rows: Sequence[Row]) -> Swarm:
    """The first bodies, one for each of the ``rows`` of a file, with the shapes and sizes that these give."""
    shape, factor = swarm.shape[: len(rows)].copy(), swarm.factor[: len(rows)].copy()
    for body, row in enumerate(rows):
        at = f"{swarm.at}.file, line {row['line']}"
        if "shape" in row:
            shape[body] = _shape_number(row["shape"], len(swarm.shapes), at)
        factor[body] = row.get("size", factor[body])
        if "radius" in row:
            radius = swarm.shapes[shape[body]].radius
            if radius is None:
                allowed, remedy = "a radius of balls", "Give the column `size`, a factor of the shape's lengths."
                raise SceneError(at, f"a radius of a {swarm.shapes[shape[body]].name!r}", allowed, remedy)
            factor[body] = float(row["radius"]) / radius
    return replace(swarm, shape=shape, factor=factor)


def _shape_number(found: float | str, count: int, at: str) -> int:
    if found not in range(count):
        allowed = f"a whole number from 0 to {count - 1}"
        raise SceneError(f"{at}, column 'shape'", found, allowed, "Count the swarm's shapes from 0.")
    return int(found)
