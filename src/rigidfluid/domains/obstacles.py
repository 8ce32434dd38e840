"""Obstacles of a scene: bodies of any type that stay where they are and belong to the domain's boundary."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from rigidfluid.core.contact.path.detector_choice import exact_detector
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Pose
from rigidfluid.core.nested.bodies import NestedBodyTable, build_shape, tables_by_name
from rigidfluid.core.nested.placing import initial_pose
from rigidfluid.domains.placed import PlacedBody
from rigidfluid.errors import SceneError
from rigidfluid.registry import Registry

ALL = "all"
"""Name that a boundary condition gives for all surfaces, and no surface has."""


class Obstacles:
    """Bodies K_i of any type that stay where they are in a domain ``around`` them, each a surface of the boundary.

    Parameters
    ----------
    tables : sequence of NestedBodyTable
        One for each, in the order of their surfaces.
    around : Domain
        The domain without them, which has a CAD shape.
    at : str
        Place of the tables in a scene, for messages and for names that are not given: ``domain.obstacle``.

    Raises
    ------
    SceneError
        If a name is taken, a key is unknown, a vector has a wrong length, a shape cannot be, or an obstacle overlaps
        another or a surface around them.
    PluginError
        If there is no such body type.
    """

    def __init__(self, tables: Sequence[NestedBodyTable], around: Domain, at: str) -> None:
        self._around, self._at, d = around, at, around.dimension
        self._placed = {
            name: PlacedBody(build_shape(table, f"{at}.{number}", d), initial_pose([table], d))
            for number, (name, table) in enumerate(tables_by_name(tables, at).items())
        }
        self._refuse_taken_names()
        self._refuse_outside()
        self._refuse_overlap()

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """One piece of the boundary for each, in the scene's order."""
        return tuple(Piece(name, placed.surface, placed.area) for name, placed in self._placed.items())

    @property
    def volume(self) -> float:
        """Σ |K_i| [length^d]."""
        return sum(placed.shape.volume for placed in self._placed.values())

    def hold(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside an obstacle or on one, (N,)."""
        inside = np.zeros(len(points), dtype=bool)
        for placed in self._placed.values():
            inside |= placed.signed_distance(points) <= 0.0
        return inside

    def cut_from(self, shape: Any, unit: float) -> Any:
        """A ``netgen.occ`` face or solid ``shape`` minus the obstacles, whose sides have their names; lengths are over
        ``unit``."""
        for name, placed in self._placed.items():
            shape = shape - placed.cad_shape(name, unit)
        return shape

    def _refuse_taken_names(self) -> None:
        others = [piece.other_name for piece in self._around.pieces if piece.other_name]
        for number, name in enumerate(self._placed):
            if name in (taken := (ALL, *self._around.names, *others)):
                allowed = f"a name other than {', '.join(taken)}"
                raise SceneError(f"{self._at}.{number}.name", repr(name), allowed, "Rename it.")

    def _refuse_outside(self) -> None:
        """A centre beyond a surface overlaps it by more than a detector need see."""
        for number, placed in enumerate(self._placed.values()):
            if not self._around.contains(placed.pose.position).all():
                lower, upper = (corner.tolist() for corner in self._around.extent)
                allowed = f"inside the {self._around.name} from {lower} to {upper}"
                found = placed.pose.position[0].tolist()
                raise SceneError(f"{self._at}.{number}.position", found, allowed, "Move it.")

    def _refuse_overlap(self) -> None:
        if not self._placed:
            return
        pieces, placed = self._around.pieces, list(self._placed.values())
        shapes, poses = [one.shape for one in placed], [one.pose for one in placed]
        pose = Pose(np.concatenate([one.position for one in poses]), np.concatenate([one.orientation for one in poses]))
        walls = [Wall(len(shapes) + i, piece.name, piece.shape) for i, piece in enumerate(pieces)]
        detector = exact_detector(shapes, pieces, Registry.load())
        contacts = detector(detector.Options(), shapes, walls).detect(pose, None, 0.0)
        if len(contacts):
            names = [*self._placed, *self._around.names]
            worst = int(np.argmin(contacts.gap))
            a, b = (int(numbers[worst]) for numbers in (contacts.body_a, contacts.body_b))
            place, depth = pose.position[a].tolist(), abs(contacts.gap[worst])
            raise SceneError(
                f"{self._at}.{a}.position",
                f"{place}, where {names[a]!r} overlaps {names[b]!r} by {depth:.6g}",
                "a place inside the domain and clear of all other surfaces",
                "Move it, or make it smaller.",
            )
