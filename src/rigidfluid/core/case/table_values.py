"""Values that a scene's table and an object of a model share by their names."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from pydantic import BaseModel


def values_of(table: BaseModel, kind: type[Any], part: str) -> dict[str, Any]:
    """Values of the fields of a ``kind`` of the model's dataclasses, from a table with keys of the same names; all but
    its ``part``."""
    return {field.name: getattr(table, field.name) for field in fields(kind) if field.name != part}
