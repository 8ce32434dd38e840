"""Contacts of any shapes from distance fields over the whole mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from rigidfluid.core.interfaces import Body, Detector, PartOptions
from rigidfluid.core.types import Contacts, Mesh, Pose, Wall


class FastMarchingOptions(PartOptions):
    """Keys of the ``[contact]`` table with detector ``fast_marching``."""

    accuracy: Literal["exact", "first-order"] = Field(
        default="exact", description="How the distance is marched: `exact` to the facets, or by plane waves"
    )
    multiple: bool = Field(
        default=False, description="Whether a pair that is near at separate places has a contact at each of them"
    )
    threads: int = Field(default=0, ge=0, description="Threads that march side by side; 0 for one per core [1]")


class FastMarchingDetector(Detector):
    """gap = min |x - y| over the facets x and y of two surfaces of the mesh, from one field per body over all of it.

    The gap is exact to the facets, whose distance to a smooth surface of curvature radius R is at most h²/(8R).

    Parameters
    ----------
    options : FastMarchingOptions
        ``accuracy``, ``multiple``, ``threads``.
    bodies : sequence of Body
        Shapes of any kind.
    walls : sequence of Wall
        The walls that repel.

    Notes
    -----
    Van Landeghem et al., arXiv:2402.19093, whose contact points are vertices of the mesh.
    """

    name: ClassVar[str] = "fast_marching"
    needs_mesh: ClassVar[bool] = True
    Options: ClassVar[type[PartOptions]] = FastMarchingOptions
    options: FastMarchingOptions

    def __init__(self, options: FastMarchingOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        from rigidfluid.marching.contacts import ContactFinder

        super().__init__(options, bodies, walls)
        self._finder = ContactFinder(bodies, walls, options.accuracy, options.multiple, True, options.threads)

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the mesh around the bodies."""
        assert mesh is not None
        return self._finder.find(pose, mesh, reach)
