"""Options of a scene that all detectors which march over the mesh share."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigidfluid.core.model.part import PartOptions


class MarchingOptions(PartOptions):
    """Keys of the ``[contact]`` table with a marching detector."""

    accuracy: Literal["exact", "first-order"] = Field(
        default="exact", description="How the distance is marched: `exact` to the facets, or by plane waves"
    )
    multiple: bool = Field(
        default=False, description="Whether a pair that is near at separate places has a contact at each of them"
    )
    threads: int = Field(default=0, ge=0, description="Threads that march in parallel; 0 for one per core [1]")
