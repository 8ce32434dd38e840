"""Description of a scene's domain: its size, its file, and the surfaces of its boundary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.checks.finding import figure
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.setup.model import Model


@dataclass(frozen=True)
class SurfaceRow:
    """A surface of the domain: its shape, area and boundary condition."""

    name: str
    shape: str
    area: float
    condition: str


@dataclass(frozen=True)
class DomainRow:
    """The domain: its type, the file that it is from (None without one), its volume without bodies, the corners of the
    box around it, its surfaces in the order of their numbers, and remarks."""

    type: str
    file: str | None
    volume: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    surfaces: tuple[SurfaceRow, ...]
    remarks: tuple[str, ...]


def domain_row(model: Model) -> DomainRow:
    """Description of a model's domain."""
    domain = model.domain
    lower, upper = (tuple(corner.tolist()) for corner in domain.extent)
    surfaces = tuple(
        SurfaceRow(piece.name, _shape(piece.shape, domain), piece.area, condition.type)
        for piece, condition in zip(domain.pieces, model.conditions, strict=True)
    )
    return DomainRow(
        domain.name, getattr(domain.options, "file", None), domain.volume, lower, upper, surfaces, domain.remarks
    )


def _shape(shape: Surface, domain: Domain) -> str:
    if shape.plane is not None:
        return "flat"
    if shape.radius is not None:
        return f"{'hollow' if shape.radius < 0.0 else 'round'}, of radius {figure(abs(shape.radius))}"
    if shape.least_radius is not None and np.isfinite(shape.least_radius):
        return f"curved, radii from {figure(shape.least_radius)}"
    return "facets" if domain.facets is not None else "not flat"
