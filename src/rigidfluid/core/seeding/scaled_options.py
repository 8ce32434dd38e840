"""Keys of a shape with all its lengths multiplied by a factor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rigidfluid.core.model.body import Body
from rigidfluid.core.scene.quantity import described_quantity
from rigidfluid.core.scene.validation import fields_by_key
from rigidfluid.errors import SceneError

_SCALE = "scale"
"""Key of shapes from files, by which their lengths are multiplied."""


def scaled_options(part: type[Body], options: Mapping[str, Any], factor: float, at: str) -> dict[str, Any]:
    """Keys of a body type for a shape ``factor`` times as large as that of ``options``: its `scale`, or else all keys
    that are lengths by their descriptions. Raises SceneError of a type that has neither."""
    if factor == 1.0:
        return dict(options)
    fields = fields_by_key(part.Options)
    if _SCALE in fields:
        return {**options, _SCALE: factor * options.get(_SCALE, fields[_SCALE].default)}
    lengths = [key for key in options if described_quantity(fields[key].description or "") == "length"]
    if not lengths:
        found = f"sizes of shapes of type {part.name!r}, which has no length among its keys"
        raise SceneError(f"{at}.size", found, "shapes whose keys are lengths", "Leave `size` out for this shape.")
    return {**options, **{key: _times(options[key], factor) for key in lengths}}


def _times(value: Any, factor: float) -> Any:
    return [_times(one, factor) for one in value] if isinstance(value, list | tuple) else factor * value
