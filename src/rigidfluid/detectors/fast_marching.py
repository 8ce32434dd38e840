"""Contacts of any shapes from distance fields over the whole mesh."""

from __future__ import annotations

from typing import ClassVar, final

from rigidfluid.marching.detector import MarchingDetector


@final
class FastMarchingDetector(MarchingDetector):
    """Marches a field from each body that has something near, over all of the mesh."""

    name: ClassVar[str] = "fast_marching"
    cost: ClassVar[float] = 2e5
    whole_domain: ClassVar[bool] = True
