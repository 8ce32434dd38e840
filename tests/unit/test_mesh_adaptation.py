"""When a moved mesh is made anew."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rigidfluid.core import mesh_adaptation
from rigidfluid.core.mesh_adaptation import TANGLED, Mover


@pytest.mark.parametrize(
    ("asked", "made", "worst", "anew"),
    [(0.01, 0.5, 1.5 * TANGLED, True), (0.01, 0.5, 0.1, False), (0.25, 0.5, 0.2, True), (0.25, 0.3, 0.2, False)],
)
def test_quality(monkeypatch, asked, made, worst, anew):
    """Below what is asked and half of what it was; a quality below that of tangled cells would ask too late."""
    still: Any = SimpleNamespace(move=lambda pose: None)
    monkeypatch.setattr(mesh_adaptation, "worst_quality", lambda mesh, points: worst)
    monkeypatch.setattr(mesh_adaptation, "_gap_changed", lambda *arguments: np.array([False]))
    system: Any = None
    mover = Mover(system, None, asked)
    monkeypatch.setattr(mover, "_map", lambda reference: still)
    state: Any = SimpleNamespace(reference=SimpleNamespace(gaps=None, mesh=None, quality=made), gaps=None)
    assert mover._asks(state, state) is anew
