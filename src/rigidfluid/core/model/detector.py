"""Abstract class of a detector."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from rigidfluid.core.geometry.answers import instance, optional
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model import part_answers as parts
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import Part, PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose


class Detector(Part):
    """Finds which surfaces are near each other.

    Parameters
    ----------
    options : PartOptions
        The detector's own keys of the ``[contact]`` table.
    bodies : sequence of Body
        The shapes, in the scene's order.
    walls : sequence of Wall
        The walls that repel; a detector that cannot take a wall of their shape raises SceneError.
    """

    kind: ClassVar[str] = "detector"
    bodies: tuple[Body, ...]
    walls: tuple[Wall, ...]
    needs_mesh: ClassVar[bool] = False
    """Tell whether it looks at the fluid's mesh; then it is never asked without one."""
    cost: ClassVar[float] = math.inf
    """Time for a near pair over that of `sphere` for two balls [1]; ``auto`` takes the cheapest that is exact."""

    closed_form: ClassVar[bool] = False
    """Tell whether it finds balls and flat walls by their closed forms, so that compiled substeps may find them without
    asking; only the class that says so itself."""

    signed: bool = False
    """Tell whether contacts may have the sign -1."""

    def __init__(self, options: PartOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        self.options = options
        self.bodies = tuple(bodies)
        self.walls = tuple(walls)

    @classmethod
    @gives(optional(instance(lambda: str)))
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why gaps between these shapes are exact, with a mesh exact to its facets; None if they may not be.

        ``auto`` asks this of every installed detector, and `rigidfluid check` prints "chosen as" and the reason.

        Parameters
        ----------
        bodies : sequence of Body
            The shapes of the scene.
        pieces : sequence of Piece
            The pieces of the domain's boundary.

        Returns
        -------
        str or None
            A clause such as "all bodies are balls"; None, as here, keeps a detector from being chosen.
        """
        return None

    @gives(parts.reach)
    def preferred_reach(self, law_range: float) -> float:
        """The reach that the loop should ask for with a law of this range [length]; infinite if it costs little."""
        return math.inf

    @abstractmethod
    @gives(parts.contacts)
    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b); reach may be infinite."""
