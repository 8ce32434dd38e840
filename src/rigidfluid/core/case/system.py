"""The system of a scene or a model."""

from __future__ import annotations

from rigidfluid.core.case.scene_model import Case, model_of
from rigidfluid.core.model.system import System
from rigidfluid.core.setup.assemble import assemble


def build_system(case: Case) -> System:
    """Build the bodies, laws, detector and backend of a scene or a model, and check that they fit together.

    Raises SceneError if a body overlaps another or a surface of the domain, or the mesh is too coarse for a gap.
    """
    return assemble(model_of(case))
