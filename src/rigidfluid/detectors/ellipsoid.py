"""Contacts of the true shapes of balls, ellipses and ellipsoids with each other and with flat and round walls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.wall import Wall, is_round
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import in_order, select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.round_pieces import is_whole
from rigidfluid.detectors.smooth_contacts import SmoothContacts
from rigidfluid.errors import SceneError


class EllipsoidDetector(Detector):
    """gap = max over unit n of n·(x_a - x_b) - h_a(n) - h_b(n), with h(n) = |diag(a) Rᵀn| the reach of an ellipsoid.

    The gap is the distance of the surfaces, and where they overlap, minus the shortest way apart; n is the normal. A
    flat wall has a known n, and so a gap in closed form. A round wall that bulges into the fluid is a ball. In a
    hollow of radius R the gap is R less the largest distance of the surface from the centre; a body has a contact with
    it at each local maximum of that distance, two at most, if the wall is there. Bodies without semi-axes, and
    walls neither flat nor round, raise SceneError.
    """

    name: ClassVar[str] = "ellipsoid"
    cost: ClassVar[float] = 50.0

    def __init__(self, options: PartOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        super().__init__(options, bodies, walls)
        for index, body in enumerate(bodies):
            if body.semi_axes is None:
                allowed = "balls, ellipses and ellipsoids only"
                _refuse(f'body.{index} of type "{body.name}"', allowed)
        for wall in walls:
            if wall.shape.plane is None and not is_round(wall.shape):
                _refuse(f"the wall {wall.name!r}", "walls that are flat or round")
        self._contacts = SmoothContacts(bodies, walls)

    @classmethod
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why detection is exact for ellipsoids between flat walls, round bumps and round hollows, or None."""
        if any(body.semi_axes is None for body in bodies):
            return None
        walls_taken = all(piece.shape.plane or is_whole(piece) for piece in pieces)
        return "all bodies are balls or ellipsoids" if walls_taken else None

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the shapes alone.

        Pairs whose normal is not found raise StepError.
        """
        contacts = in_order([self._contacts.pair_contacts(pose, reach), *self._contacts.wall_contacts(pose, reach)])
        return select(contacts, contacts.gap <= reach)


def _refuse(found: str, allowed: str) -> None:
    remedy = 'Use detector = "auto", which takes one for these shapes.'
    raise SceneError("contact.detector", f'"ellipsoid" with {found}', allowed, remedy)
