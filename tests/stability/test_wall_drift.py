"""Curved walls stay where they are through many meshes."""

from __future__ import annotations

import numpy as np
import pytest
from wall_drift import wall_drift

pytestmark = pytest.mark.long


def test_walls_stay_through_fifty_meshes_of_a_throat() -> None:
    """Vertices on the circles to round-off; the polygon only comes nearer to them, as edges are halved in the gap."""
    seen = list(wall_drift(50))
    assert len(seen) == 51
    assert max(one.off_wall for one in seen) < 1e-14
    assert min(one.quality for one in seen) > 0.4
    errors = np.array([one.area_error for one in seen])
    assert np.all(np.diff(errors) < 1e-12)
    assert 0.0 < errors[-1] < 0.7 * errors[0] < 0.1
    assert seen[0].curved_facets == 40
    assert seen[-1].curved_facets > 60
