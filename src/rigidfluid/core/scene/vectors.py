"""Vectors in tables, with as many components as the scene's dimension asks for.

The dimension comes in the context of the validation, where the table that has it puts it, before tables with vectors
are read; without it any length will do.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo
from pydantic_core import PydanticCustomError

DIMENSION = "dimension"
"""Key of the context."""

WRONG_LENGTH = "vector_length"
"""Type of pydantic's complaint, whose context has what was found, what is allowed and the remedy."""


def _components(count: Callable[[int], int]) -> AfterValidator:
    """Refuse vectors without as many components as ``count`` says for a dimension."""

    def check(vector: tuple[Any, ...], info: ValidationInfo) -> tuple[Any, ...]:
        dimension = (info.context or {}).get(DIMENSION)
        if dimension is None or len(vector) == (needed := count(dimension)):
            return vector
        found = f"{list(vector)}, {len(vector)} of them"
        allowed = "1 number" if needed == 1 else f"{needed} numbers"
        remedy = f"The scene has {dimension} dimensions."
        raise PydanticCustomError(WRONG_LENGTH, "{found}", {"found": found, "allowed": allowed, "remedy": remedy})

    return AfterValidator(check)


_BY_AXIS = _components(lambda dimension: dimension)
_BY_ROTATION = _components(lambda dimension: 1 if dimension == 2 else 3)
# In 2D an angular velocity is one number, which stands for a vector of one component.
_LISTED = BeforeValidator(
    lambda value: tuple(value) if isinstance(value, list | tuple) else (value,),
    json_schema_input_type=float | tuple[float, ...],
)

Vector = Annotated[tuple[float, ...], _BY_AXIS]
Angular = Annotated[tuple[float, ...], _LISTED, _BY_ROTATION]
_NotNegative = tuple[Annotated[float, Field(ge=0)], ...]
NotNegative = Annotated[_NotNegative, _BY_AXIS]
NotNegativeAngular = Annotated[_NotNegative, _LISTED, _BY_ROTATION]
Formula = float | str
"""A number, or an expression of place and time."""
Formulas = Annotated[tuple[Formula, ...], _BY_AXIS]
