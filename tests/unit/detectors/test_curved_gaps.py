"""What detectors on the mesh make of gaps to curved walls."""

from __future__ import annotations

import pytest
from curved_gaps import curved_gaps


@pytest.mark.long
def test_facets_widen_a_gap_to_a_curved_wall_by_what_they_cut_off() -> None:
    found = list(curved_gaps(sizes=(0.1, 0.05)))
    assert len(found) == 12
    for gap in found:
        assert 0.0 < gap.error <= gap.bound, gap
