"""Refuses models whose bodies cannot enter and leave."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model


def require_changeable(model: Model) -> None:
    """Raise SceneError for a model whose bodies cannot change: joints, mechanisms, springs, windows and
    scalars go by them."""
    found = {
        "mechanism": model.mechanisms,
        "joint": model.joints,
        "body.spring or body.free": [body for body in model.bodies if body.linked_to_ground],
        "domain.window": model.window,
        "scalar": model.fluid.scalar,
    }
    for key, value in found.items():
        if value:
            remedy = f"Leave {key} out, or keep the bodies."
            raise SceneError(key, "together with bodies that enter or leave", "one of both", remedy)
    if not model.bodies:
        found_bodies = "none, where bodies enter or leave"
        raise SceneError("body", found_bodies, "one at the start", "Add a table [[body]].")
    backend = model.fluid.backend.part
    if not backend.exchanges_bodies:
        found_backend, allowed = f"{backend.name!r}", "a backend whose bodies may enter and leave"
        raise SceneError("fluid.backend", found_backend, allowed, "Use backend = 'scikit-fem' or 'dry'.")
