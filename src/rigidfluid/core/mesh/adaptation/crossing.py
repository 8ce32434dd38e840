"""Refuses bodies in places where contacts across periodic surfaces are not known.

Beside obstacles, curved or oblique walls, long-range forces and longer bodies no detector sees images.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose
from rigidfluid.errors import StepRejected

_POINTS = 400
"""Points of a body's surface by which gaps to images are measured."""

_REMEDY = "Lengthen the domain, end the run before, or hold the body."


def refuse_to_cross(system: System, pose: Pose) -> None:
    """Reject a step in which a body leaves a domain with periodic surfaces beyond which its contacts are not known, or
    comes within the range of the laws to what is there."""
    if bodies_cross(system):
        return
    outside = np.flatnonzero(~system.domain.contains(pose.position))
    if len(outside):
        raise StepRejected(
            f"body {system.surfaces[outside[0]]!r}",
            f"its centre at {pose.position[outside[0]].tolist()}, beyond a periodic surface",
            "bodies that stay in a domain with obstacles, curved or oblique walls, long-range forces or longer bodies",
            _REMEDY,
        )
    for body, other, gap in unseen_contacts(system, pose):
        raise StepRejected(
            f"body {system.surfaces[body]!r}",
            f"a gap of {gap:.3g} to {other!r} across a periodic surface, where contacts are not seen",
            f"at least the range of the laws, {system.law_range:.6g}, beside obstacles, curved or oblique walls, "
            "long-range forces or longer bodies",
            _REMEDY,
        )


def bodies_cross(system: System) -> bool:
    """Tell whether bodies may cross all periodic surfaces of the domain, as they may where it has none."""
    return not system.domain.periodic or len(system.lattice.vectors) > 0


def unseen_contacts(system: System, pose: Pose) -> Iterator[tuple[int, str, float]]:
    """Bodies that move, each with the name of a body or curved wall of which it meets an image within the range of the
    laws, and the gap [length]; none where no law acts, or detectors see images."""
    if system.law is None or bodies_cross(system):
        return
    signs = np.array([sign for sign in product((-1, 0, 1), repeat=len(system.domain.lattice)) if any(sign)])
    lower, upper = system.domain.extent
    for body in np.flatnonzero(~system.prescribed).tolist():
        far = system.bounding_radii[body] + system.law.range
        for centre in pose.position[body] + signs @ system.domain.lattice:
            if np.all((centre + far > lower) & (centre - far < upper)):
                yield from _met(system, pose, body, centre)


def _met(system: System, pose: Pose, body: int, centre: FloatArray) -> Iterator[tuple[int, str, float]]:
    """Contacts of the image of a body with this ``centre`` (d,), as `unseen_contacts` gives them."""
    reach = system.law_range
    own = system.bodies[body].sample_surface(_POINTS) @ rotation_matrices(pose.orientation[body : body + 1])[0].T
    away = np.linalg.norm(pose.position - centre, axis=1) - system.bounding_radii - system.bounding_radii[body]
    for other in np.flatnonzero((away < reach) & (np.arange(len(away)) != body)).tolist():
        gap = float(distance_to_body(pose, other, system.bodies[other], centre + own).min())
        if gap < reach:
            yield body, system.surfaces[other], gap
    for wall in system.walls:
        if wall.shape.plane is None:
            gap = _gap(wall.shape, centre + own)
            if gap < min(reach, _gap(wall.shape, pose.position[body] + own)):
                yield body, wall.name, gap


def _gap(surface: Surface, points: FloatArray) -> float:
    """Least distance of points (N, d) to a surface [length]."""
    return float(np.linalg.norm(points - surface.closest_point(points), axis=1).min())
