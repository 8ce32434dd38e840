"""Refuses bodies of sizes that no run may start with."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.interfaces import Body
from rigidfluid.errors import PluginError


def refuse_lost_body(body: Body, at: str) -> None:
    """Raise PluginError unless all sizes of a body are finite and positive; ``at`` is its place in the scene."""
    turns = 1 if body.dimension == 2 else 3
    for name, shape in (("volume", ()), ("bounding_radius", ()), ("radius", ()), ("semi_axes", (body.dimension,))):
        size = getattr(body, name)
        if size is not None or name in ("volume", "bounding_radius"):
            _refuse_lost_size(body, at, name, np.shape(size) == shape and np.min(size) > 0.0)
    inertia = np.asarray(body.unit_inertia)
    sound = inertia.shape == (turns, turns) and np.isfinite(inertia).all()
    _refuse_lost_size(body, at, "unit_inertia", sound and np.linalg.eigvalsh(inertia)[0] > 0.0)


def _refuse_lost_size(body: Body, at: str, name: str, positive: bool | np.bool_) -> None:
    size = np.asarray(getattr(body, name)).tolist()
    if not (positive and np.all(np.isfinite(size))):
        remedy = "Mend the body type; its contract test in rigidfluid.testing shows more."
        raise PluginError(at, f"a {name} of {size}, by the type {body.name!r}", "a positive one of its shape", remedy)
