"""The force that a scene puts on each volume of its fluid."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigidfluid.core.setup.expressions import VectorExpression
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import Scene
    from rigidfluid.core.setup.parts import Parts

_KEY = "fluid.force"


def body_force(scene: Scene) -> VectorExpression | None:
    """Force (N, d) at a time and points (N, d) [force/volume], None without any; raises SceneError for no formula."""
    return None if scene.fluid.force is None else VectorExpression.parse(scene.fluid.force, _KEY)


def check_body_force(parts: Parts) -> None:
    """Refuse a force that is no formula, or that there is no fluid for."""
    if body_force(parts.scene) is not None and not parts.wet:
        found = f"{list(parts.scene.fluid.force or ())} with backend {parts.backend.part.name!r}"
        raise SceneError(_KEY, found, "a backend with a fluid", "Leave it out, or choose backend = 'scikit-fem'.")
