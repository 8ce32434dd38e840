"""Steps that both programs take, and times at which they are compared."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from rigidfluid.api import FloatArray, Scene


@dataclass(frozen=True)
class Timing:
    """``blocks`` of equal length, each of ``steps`` steps of size ``step`` [time]; samples lie between blocks."""

    blocks: int
    steps: int
    step: float

    @classmethod
    def choose(cls, scene: Scene, samples: int) -> Timing:
        """Choose a scene's substep as the step, and at most ``samples`` blocks up to its end."""
        step = scene.time.step / (scene.contact.substeps or 1)
        count = ceil(scene.time.end / step - 1e-6)
        blocks = min(samples, count)
        return cls(blocks, ceil(count / blocks), step)

    def divided(self, by: int) -> Timing:
        """The same blocks in steps that are shorter by a whole factor."""
        return Timing(self.blocks, self.steps * by, self.step / by)

    @property
    def times(self) -> FloatArray:
        """When samples are taken, the start included (blocks + 1,) [time]."""
        return np.asarray(np.arange(self.blocks + 1) * (self.steps * self.step))
