"""Refuses models whose bodies cannot enter and leave, and tells which of them stay in any case."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model


def require_changeable(model: Model) -> None:
    """Raise SceneError for a model whose bodies cannot change: windows and scalars go by them."""
    for key, value in {"domain.window": model.window, "scalar": model.fluid.scalar}.items():
        if value:
            remedy = f"Leave {key} out, or keep the bodies."
            raise SceneError(key, "together with bodies that enter or leave", "one of both", remedy)
    if not model.all_bodies:
        found_bodies = "none, where bodies enter or leave"
        raise SceneError("body", found_bodies, "one at the start", "Add a table [[body]].")
    backend = model.fluid.backend.part
    if not backend.exchanges_bodies:
        found_backend, allowed = f"{backend.name!r}", "a backend whose bodies may enter and leave"
        raise SceneError("fluid.backend", found_backend, allowed, "Use backend = 'scikit-fem' or 'dry'.")


def staying_bodies(model: Model) -> frozenset[str]:
    """Names of the bodies that cannot leave: those of joints, with springs to the ground or held directions, and the
    components of mechanisms."""
    joined = {name for joint in model.joints for name in joint.between}
    return frozenset(joined | {body.name for body in model.all_bodies if body.linked_to_ground or body.part_of})


def has_links(model: Model) -> bool:
    """Tell whether there are joints, springs to the ground or held directions."""
    return bool(model.joints) or any(body.linked_to_ground for body in model.bodies)
