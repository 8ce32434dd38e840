"""What is between two circles or balls about the origin: a hub and a rim, each of which may turn in itself."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from rigidfluid.api import BoolArray, Domain, FloatArray, PartOptions, Piece, Surface, hookimpl


class AnnulusOptions(PartOptions):
    inner: float = Field(gt=0, description="Radius of the hub [length]")
    outer: float = Field(gt=0, description="Radius of the rim [length]")


class Round(Surface):
    """|x| = |r|, with the fluid outside where r > 0, else inside."""

    def __init__(self, radius: float, dimension: int) -> None:
        self.r, self.dimension = radius, dimension

    @property
    def radius(self) -> float:
        return self.r

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        return np.full(self.dimension, -abs(self.r)), np.full(self.dimension, abs(self.r))

    def closest_point(self, points: FloatArray) -> FloatArray:
        return np.asarray(abs(self.r) * points / np.linalg.norm(points, axis=1, keepdims=True))

    def signed_distance(self, points: FloatArray) -> FloatArray:
        return np.asarray(np.sign(self.r) * (np.linalg.norm(points, axis=1) - abs(self.r)))


class Annulus(Domain):
    """{x : inner < |x| < outer}."""

    name = "annulus"
    Options = AnnulusOptions
    options: AnnulusOptions

    @property
    def pieces(self) -> tuple[Piece, ...]:
        radii = {"hub": self.options.inner, "rim": -self.options.outer}
        d, area = self.dimension, 2.0 * (self.dimension - 1.0) * np.pi
        return tuple(Piece(name, Round(r, d), area * abs(r) ** (d - 1)) for name, r in radii.items())

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        return self.pieces[1].shape.bounds

    @property
    def volume(self) -> float:
        hub, rim = self.pieces
        return (rim.area * self.options.outer - hub.area * self.options.inner) / self.dimension

    def contains(self, points: FloatArray) -> BoolArray:
        distance = np.linalg.norm(points, axis=1)
        return np.asarray((distance > self.options.inner) & (distance < self.options.outer))

    def cad_shape(self, unit: float) -> Any:
        return self._round(self.options.outer / unit, "rim") - self._round(self.options.inner / unit, "hub")

    def _round(self, radius: float, name: str) -> Any:
        from netgen import occ

        flat = self.dimension == 2
        shape = occ.WorkPlane().Circle(radius).Face() if flat else occ.Sphere(occ.Pnt(0, 0, 0), radius)
        for side in shape.edges if flat else shape.faces:
            side.name = name
        return shape


@hookimpl
def rigidfluid_domains() -> list[type[Domain]]:
    return [Annulus]


def annulus(dimension: int, inner: float) -> Annulus:
    return Annulus(AnnulusOptions(inner=inner, outer=1.0), dimension)
