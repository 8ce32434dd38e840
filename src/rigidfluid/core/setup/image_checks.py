"""Refuses what bodies that cross periodic surfaces cannot have around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.setup.boundary_samples import points_of
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rigidfluid.core.geometry.piece import Piece
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.setup.model import Model

_ALONG = 1e-12
"""Greatest cosine of an angle that counts as a right one."""


def crossed_lattice(model: Model) -> Lattice:
    """The lattice by which bodies of a model cross its periodic surfaces; without vectors in a fluid where something is
    not the same in each image, as obstacles, or a body is too long: there they may stay in the domain."""
    if model.wet and model.domain.periodic:
        try:
            check_crossed(model, "boundary")
            check_lengths(model.shapes, model.domain.cells, 0.0)
        except SceneError:
            return model.domain.alone
    return model.domain.cells


def crossable_lattice(domain: Domain) -> Lattice:
    """The lattice by which bodies may cross periodic surfaces of a domain, without vectors where other surfaces are not
    the same in each image, or periodic ones at other angles than right ones."""
    lattice = domain.cells
    along = all(_is_along(domain.pieces[number], lattice) for number in _others(domain))
    return lattice if along and _has_right_angles(lattice) else domain.alone


def check_crossed(model: Model, at: str) -> None:
    """Refuse, with SceneError at the field ``at``, periodic surfaces that bodies cross and that are not at right angles
    to each other, walls that are not the same in each image of the domain, and forces between two bodies at any
    distance."""
    lattice = model.domain.cells
    if not _has_right_angles(lattice):
        found = "bodies that cross periodic surfaces at other angles than right ones"
        raise SceneError(at, found, "pairs of surfaces at right angles to each other", "Make others walls.")
    for number in _others(model.domain):
        _check_piece(model, number, lattice)
    if model.pair_forces:
        found = "bodies that cross periodic surfaces, with a long-range force between two of them"
        raise SceneError(at, found, "one of both, as such a force knows no images", "Make the surfaces walls.")


def check_lengths(bodies: Sequence[Body], lattice: Lattice, law_range: float) -> None:
    """Refuse, with SceneError, bodies that may come within the range of the laws [length] of their own images."""
    for number, body in enumerate(bodies):
        if 2.0 * body.bounding_radius + law_range >= lattice.shortest:
            found = (
                f"a bounding diameter of {2.0 * body.bounding_radius:.6g}, and contacts in a range of {law_range:.6g}"
            )
            allowed = f"together less than {lattice.shortest:.6g}, the distance to its own image"
            raise SceneError(f"body.{number}", found, allowed, "Make the domain longer between periodic surfaces.")


def _others(domain: Domain) -> list[int]:
    """Numbers of the pieces that are not periodic."""
    return sorted(set(range(len(domain.pieces))) - domain.periodic_pieces)


def _has_right_angles(lattice: Lattice) -> bool:
    units = lattice.vectors / lattice.lengths[:, None]
    return bool(np.all(np.abs(units @ units.T - np.eye(len(units))) <= _ALONG))


def _check_piece(model: Model, number: int, lattice: Lattice) -> None:
    """Refuse a piece of the boundary that is not the same in each image."""
    piece, condition = model.domain.pieces[number], model.conditions[number]
    if not _is_along(piece, lattice):
        found = f"{piece.name!r} beside periodic surfaces that bodies cross, neither flat nor along the way across"
        remedy = "Choose a domain with flat walls, such as a box, or do without periodic surfaces."
        raise SceneError(condition.field, found, "flat surfaces that lead on in each image of the domain", remedy)
    if condition.is_wall and condition.sliding is not None:
        points = points_of(piece.shape, model.domain)
        speed = condition.sliding(points)
        for vector in lattice.vectors:
            if not np.allclose(condition.sliding(points + vector), speed, rtol=_ALONG, atol=0.0):
                found = f"a wall {piece.name!r} that slides otherwise in an image of the domain"
                raise SceneError(condition.field, found, "the same velocity in each image", "Let it slide straight on.")


def _is_along(piece: Piece, lattice: Lattice) -> bool:
    """Tell whether a piece is flat and goes on along all vectors of the lattice."""
    plane = piece.shape.plane
    return plane is not None and bool(np.all(np.abs(lattice.vectors @ plane.unit_normal) <= _ALONG * lattice.lengths))
