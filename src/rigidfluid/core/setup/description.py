"""Description of a model that was made in Python, for its results: it tells models apart, and cannot make one again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

from rigidfluid.errors import OutputError

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model

IN_PYTHON = "model"
"""Key that a description has and no scene."""

_TOLD_APART = ("registry", "name", "seed", "time", "output")
"""Fields of a model that are no table of objects."""


def describe(model: Model) -> dict[str, Any]:
    """Names, classes and numbers of a model's objects, in values that JSON can hold; functions by their names."""
    names = [field.name for field in fields(model) if field.name not in _TOLD_APART]
    return {
        "scene": {"name": model.name, "dimension": model.dimension, "seed": model.seed},
        "fluid": {"backend": model.fluid.backend.part.name},
        "time": _told(model.time),
        "output": _told(model.output),
        IN_PYTHON: {name: _told(getattr(model, name)) for name in names},
    }


def refuse_description(tables: Mapping[str, Any], folder: Path, remedy: str) -> None:
    """Raise OutputError where the ``tables`` of results in a ``folder`` describe a model made in Python."""
    if IN_PYTHON in tables:
        found = f"results of the model {tables['scene']['name']!r}, made in Python"
        raise OutputError(str(folder), found, "results of a scene", remedy)


def _told(value: Any) -> Any:
    """A value, or what makes an object, its class and its options or fields."""
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json", exclude_none=True)
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Mapping):
        return {str(key): _told(inner) for key, inner in value.items()}
    if isinstance(value, tuple | list):
        return [_told(inner) for inner in value]
    if isinstance(value, partial):
        return {"function": _told(value.func), "arguments": _told(value.args), "named": _told(value.keywords)}
    if is_dataclass(value) and not isinstance(value, type):
        return {"type": type(value).__name__} | {
            field.name: _told(getattr(value, field.name)) for field in fields(value)
        }
    if hasattr(value, "options"):
        return {"type": type(value).__name__, "options": _told(value.options)}
    return getattr(value, "__qualname__", type(value).__name__)
