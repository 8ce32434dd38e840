"""Contacts of any shapes from distance fields in a narrow band around the bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from pydantic import Field

from rigidfluid.core.interfaces import Body, Detector, PartOptions
from rigidfluid.core.types import Contacts, Mesh, Pose, Wall
from rigidfluid.errors import SceneError
from rigidfluid.marching.options import MarchingOptions

BANDS_PER_RANGE = 1.5
"""Width of the band over the range of the law, the paper's."""


class NarrowBandOptions(MarchingOptions):
    """Keys of the ``[contact]`` table with detector ``narrow_band``."""

    band_width: float | None = Field(
        default=None, gt=0, description="Gap up to which contacts are looked for; 1.5 range if not given [length]"
    )


class NarrowBandDetector(Detector):
    """gap = min |x - y| over the facets x and y of two surfaces of the mesh, from a band around each body.

    The gap is exact to the facets, whose distance to a smooth surface of curvature radius R is at most h²/(8R). The
    work follows the number of cells in the bands of those bodies that have something near.

    Parameters
    ----------
    options : NarrowBandOptions
        ``band_width`` [length], ``accuracy``, ``multiple``, ``threads``.
    bodies : sequence of Body
        Shapes of any kind.
    walls : sequence of Wall
        The walls that repel.

    Notes
    -----
    Van Landeghem et al., arXiv:2402.19093, whose contact points are vertices of the mesh.
    """

    name: ClassVar[str] = "narrow_band"
    needs_mesh: ClassVar[bool] = True
    Options: ClassVar[type[PartOptions]] = NarrowBandOptions
    options: NarrowBandOptions

    def __init__(self, options: NarrowBandOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        from rigidfluid.marching.contacts import ContactFinder

        super().__init__(options, bodies, walls)
        self._finder = ContactFinder(bodies, walls, options.accuracy, options.multiple, False, options.threads)

    def sight(self, law_range: float) -> float:
        """``band_width``, or 1.5 ``law_range`` [length]; raises SceneError if the band is narrower than the range."""
        width = self.options.band_width
        if width is None:
            return BANDS_PER_RANGE * law_range
        if width < law_range:
            raise SceneError(
                "contact.band_width", width, f"at least the range, {law_range}", "Widen it, or leave it out."
            )
        return width

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the mesh around the bodies."""
        assert mesh is not None
        return self._finder.find(pose, mesh, reach)
