"""Contacts of any shapes from distance fields in a narrow band around the bodies."""

from __future__ import annotations

from typing import ClassVar, final

from pydantic import Field

from rigidfluid.core.model.part import PartOptions
from rigidfluid.errors import SceneError
from rigidfluid.marching.detector import MarchingDetector
from rigidfluid.marching.options import MarchingOptions

BANDS_PER_RANGE = 1.5
"""Width of the band over the range of the law, the paper's."""


class NarrowBandOptions(MarchingOptions):
    """Keys of the ``[contact]`` table with detector ``narrow_band``."""

    band_width: float | None = Field(
        default=None, gt=0, description="Gap up to which contacts are looked for; 1.5 range if not given [length]"
    )


@final
class NarrowBandDetector(MarchingDetector):
    """Marches a field from each body that has something near, in a band around it.

    The work follows the number of cells in the bands. ``band_width`` [length] is one more option.
    """

    name: ClassVar[str] = "narrow_band"
    cost: ClassVar[float] = 1e5
    whole_domain: ClassVar[bool] = False
    Options: ClassVar[type[PartOptions]] = NarrowBandOptions
    options: NarrowBandOptions

    def preferred_reach(self, law_range: float) -> float:
        """``band_width``, or 1.5 ``law_range`` [length]; raises SceneError if the band is narrower than the range."""
        width = self.options.band_width
        if width is None:
            return BANDS_PER_RANGE * law_range
        if width < law_range:
            raise SceneError(
                "contact.band_width", width, f"at least the range, {law_range}", "Widen it, or leave it out."
            )
        return width
