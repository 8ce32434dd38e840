"""Contacts of any shapes from distance fields over the whole mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from rigidfluid.core.interfaces import Body, Detector, PartOptions
from rigidfluid.core.types import Contacts, Mesh, Pose, Wall
from rigidfluid.marching.options import MarchingOptions


class FastMarchingDetector(Detector):
    """gap = min |x - y| over the facets x and y of two surfaces of the mesh, from one field per body over all of it.

    The gap is exact to the facets, whose distance to a smooth surface of curvature radius R is at most h²/(8R).

    Parameters
    ----------
    options : MarchingOptions
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
    Options: ClassVar[type[PartOptions]] = MarchingOptions
    options: MarchingOptions

    def __init__(self, options: MarchingOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        from rigidfluid.marching.contacts import ContactFinder

        super().__init__(options, bodies, walls)
        self._finder = ContactFinder(bodies, walls, options.accuracy, options.multiple, True, options.threads)

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the mesh around the bodies."""
        assert mesh is not None
        return self._finder.find(pose, mesh, reach)
