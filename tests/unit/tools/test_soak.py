"""A long run that grows is told from one that does not."""

from __future__ import annotations

import pytest
from attacks.soak import GROWTH, Sample, growth


def samples(memory: float = 0.0, files: float = 0.0, cost: float = 0.0) -> list[Sample]:
    """Of a run whose figures grow by so much over 40 samples, relative to their start."""
    return [
        Sample(n, 100.0 * (1.0 + memory * n / 40), round(10 * (1.0 + files * n / 40)), 2.0 * (1.0 + cost * n / 40))
        for n in range(40)
    ]


def test_a_run_that_stays_as_it_is() -> None:
    assert growth(samples()) == {"memory": 1.0, "files": 1.0, "cost": 1.0}


@pytest.mark.parametrize("grown", [{"memory": 0.2}, {"files": 0.5}, {"cost": 1.0}])
def test_what_grows_is_beyond_its_bound(grown: dict[str, float]) -> None:
    beyond = {key for key, factor in growth(samples(**grown)).items() if factor > GROWTH[key]}
    assert beyond == set(grown)
