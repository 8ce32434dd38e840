"""Regions that hold a swarm: the domain, a box, a cylinder, or the inside of a surface from a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.nested.part_options import own_options, told_at
from rigidfluid.core.scene.swarm_tables import BoxRegion, CylinderRegion, FileRegion, RegionTable
from rigidfluid.core.seeding.cylinder import Cylinder
from rigidfluid.core.seeding.inside import Inside
from rigidfluid.errors import SceneError
from rigidfluid.registry import BODY, DOMAIN, Registry


class Region(Protocol):
    """A bounded region between surfaces."""

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around it, (d,) each [length]."""

    @property
    def volume(self) -> float:
        """[length^d]."""

    @property
    def surfaces(self) -> Sequence[Surface]:
        """Surfaces around it, seen from inside."""

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside, (N,)."""


@dataclass(frozen=True)
class DomainRegion:
    """The inside of a ``domain``."""

    domain: Domain

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """(d,) each [length]."""
        return self.domain.extent

    @property
    def volume(self) -> float:
        """[length^d]."""
        return self.domain.volume

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """Surfaces of its pieces."""
        return tuple(piece.shape for piece in self.domain.pieces)

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside, (N,)."""
        return self.domain.contains(points)


def region_of(table: RegionTable | None, domain: Domain, at: str, registry: Registry) -> Region:
    """The region of a table at the place ``at``, the domain without one; raises SceneError where it is wrong."""
    if table is None:
        return DomainRegion(domain)
    dimension = domain.dimension
    if isinstance(table, BoxRegion):
        box, corners = registry.get(DOMAIN, "box", at), {"lower": table.lower, "upper": table.upper}
        with told_at(at):
            return DomainRegion(box(own_options(box, corners, "domain"), dimension))
    if isinstance(table, CylinderRegion):
        return _cylinder(table, dimension, at)
    assert isinstance(table, FileRegion)
    surface, keys = registry.get(BODY, "stl", at), {"file": table.file, "scale": table.scale}
    with told_at(at):
        return Inside(surface(own_options(surface, keys, "body"), dimension))


def _cylinder(table: CylinderRegion, dimension: int, at: str) -> Cylinder:
    if dimension == 2 and table.end is not None:
        raise SceneError(f"{at}.end", list(table.end), "no end in 2D", "In 2D it is a disk around `start`.")
    if dimension == 3 and (table.end is None or table.end == table.start):
        found = "nothing" if table.end is None else f"{list(table.end)}, which is `start` too"
        raise SceneError(f"{at}.end", found, "the centre of the other end", "Add it, or correct it.")
    return Cylinder(np.array(table.start), None if table.end is None else np.array(table.end), table.radius)
