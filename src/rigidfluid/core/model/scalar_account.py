"""Account of a transported scalar over one step."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.geometry.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class ScalarAccount:
    """Balance of the scalar at the end of a step: rate = Σ flux + source + imbalance, all [scalar·length^d/time].

    ``content``: its integral over the fluid [scalar·length^d], and ``rate`` its derivative in time as the scheme takes
    it. ``flux`` (surfaces,): into the fluid through each surface, bodies first, with what the fluid carries.
    ``imbalance``: what the scheme made. ``least`` and ``greatest`` values at nodes, those in bodies too [scalar].
    ``value`` (surfaces,): mean on each surface [scalar]; ``inside`` (surfaces,): mean in each body that conducts,
    ``value`` of all else [scalar]. ``remeshing``: content that corrections at new meshes have restored so far, in
    absolute value [scalar·length^d].
    """

    content: float
    rate: float
    source: float
    imbalance: float
    least: float
    greatest: float
    remeshing: float
    flux: FloatArray
    value: FloatArray
    inside: FloatArray
