"""Common base of the detectors that march over the mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, final

from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.marching.options import MarchingOptions


class MarchingDetector(Detector):
    """gap = min |x - y| over the facets x and y of two surfaces of the mesh, from a distance field of each body.

    The gap is exact to the facets, whose distance to a smooth surface of curvature radius R is at most h²/(8R).

    Notes
    -----
    Van Landeghem et al., arXiv:2402.19093, whose contact points are vertices of the mesh.
    """

    needs_mesh: ClassVar[bool] = True
    whole_domain: ClassVar[bool]
    """Tell whether the fields go on to the end of the mesh."""
    Options: ClassVar[type[PartOptions]] = MarchingOptions
    options: MarchingOptions

    @final
    def __init__(self, options: MarchingOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        from rigidfluid.marching.contacts import ContactFinder

        super().__init__(options, bodies, walls)
        self._finder = ContactFinder(bodies, walls, options, self.whole_domain)

    @final
    @classmethod
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why any shapes are detected, exactly to the facets of their mesh."""
        return "the shapes are of any kind, and there is a mesh and a law"

    @final
    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the mesh around the bodies."""
        assert mesh is not None
        return self._finder.find(pose, mesh, reach)
