"""Few balls, of which all pairs are looked at, and many, which a tree sorts, give the same."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.contact.pairs import broad_phase

RANDOM = np.random.default_rng(3)
POSITION, RADII = RANDOM.uniform(size=(40, 3)), RANDOM.uniform(0.02, 0.1, size=40)
WAYS = pytest.mark.parametrize("few", [0, 100])


@WAYS
def test_near_pairs_are_all_within_reach(few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(broad_phase, "_FEW", few)
    first, second = broad_phase.near_pairs(POSITION, RADII, 0.05)
    gap = np.linalg.norm(POSITION[:, None] - POSITION, axis=2) - RADII[:, None] - RADII
    expected = [(a, b) for a in range(40) for b in range(a + 1, 40) if gap[a, b] <= 0.05]
    assert sorted(zip(first.tolist(), second.tolist(), strict=True)) == expected
    assert len(expected) > 10


@WAYS
def test_nearest_other_is_the_nearest_but_the_point_itself(few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(broad_phase, "_FEW", few)
    distance, other = broad_phase.nearest_others(POSITION)
    for place in range(40):
        distances = {k: float(np.linalg.norm(POSITION[k] - POSITION[place])) for k in range(40) if k != place}
        nearest = min(distances, key=lambda k: distances[k])
        assert other[place] == nearest
        assert distance[place] == pytest.approx(distances[nearest])
