"""Description of a model that was made in Python, for its results: it tells models apart, and cannot make one again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model
    from rigidfluid.core.setup.rigid_body import RigidBody

IN_PYTHON = "model"
"""Key that a description has and no scene."""


def describe(model: Model) -> dict[str, Any]:
    """Names, classes and numbers of a model's objects, in values that JSON can hold."""
    return {
        "scene": {"name": model.name, "dimension": model.dimension, "seed": model.seed},
        IN_PYTHON: {"made_in": "Python"},
        "domain": {"type": _class_name(model.domain), "surfaces": list(model.domain.names)},
        "fluid": {
            "backend": model.fluid.backend.part.name,
            **model.fluid.description(),
        },
        "boundary": {condition.name: _class_name(condition) for condition in model.conditions},
        "body": [_body(body) for body in model.all_bodies],
        "joint": [{"name": joint.name, "type": joint.kind.name} for joint in model.joints],
        "contact": [{"law": law.law.part.name, "range": law.range} for law in model.laws],
        "time": model.time.model_dump(mode="json", exclude_none=True),
        "output": model.output.model_dump(mode="json", exclude_none=True),
    }


def _body(body: RigidBody) -> dict[str, Any]:
    position = [float(component) for component in body.position]
    return {"name": body.name, "type": _class_name(body.shape), "density": body.density, "position": position}


def _class_name(part: object) -> str:
    return type(part).__name__
