"""The body types that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.bodies.ellipsoid import Ellipsoid
from rigidfluid.bodies.polygon import Polygon
from rigidfluid.bodies.polyhedron import Polyhedron
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.model.body import Body
from rigidfluid.hookspecs import hookimpl


@hookimpl
def rigidfluid_bodies() -> list[type[Body]]:
    """The built-in body types."""
    return [Sphere, Ellipsoid, Polygon, Polyhedron]
