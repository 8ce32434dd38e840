"""Bodies that are there: how many, and how much of the domain they fill."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples


class Presence(NamedTuple):
    """Number of bodies that are there in a state, its ``mean`` and the ``least`` and the ``most``, and their volume
    over that of the domain, ``fraction`` [1]."""

    mean: Mean
    least: int
    most: int
    fraction: Mean

    def to_dict(self) -> dict[str, Any]:
        """Names and numbers of bodies."""
        return {"mean": self.mean.to_list(), "least": self.least, "most": self.most}

    def words(self, ever: int) -> str:
        """Number of bodies in words, ``ever`` those that were there in any state."""
        fewer = "" if self.least == self.most else f"{self.least} to "
        more = "" if self.most == ever else f" of {ever}"
        return f"{fewer}{self.most}{more} bodies"


def presence(samples: Samples) -> Presence:
    """Presence of the bodies, by the share of the states in which each is there."""
    present, count = samples.present, samples.count
    share = present.mean(axis=0)
    volume = (share * samples.body_volume).sum() / samples.volume
    off = (present - share) @ samples.body_volume / samples.volume
    return Presence(
        mean(count.astype(float)), int(count.min()), int(count.max()), Mean(np.asarray(volume), mean(off).error)
    )
