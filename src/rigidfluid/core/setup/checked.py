"""Dataclasses that check the types and ranges of their values when they are made, and refuse them with our errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import wraps
from typing import Annotated, Any, TypeVar, cast, dataclass_transform

import numpy as np
from pydantic import BeforeValidator, ConfigDict, Field, PlainValidator, ValidationError
from pydantic.dataclasses import dataclass

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.scene.patterns import BODY_NAME
from rigidfluid.core.scene.validation import LARGEST, allowed_by, value_text
from rigidfluid.errors import ArgumentError

T = TypeVar("T")

_CONFIG = ConfigDict(strict=True, arbitrary_types_allowed=True, allow_inf_nan=False)


def _plain(value: Any) -> Any:
    """A number of NumPy as one of Python."""
    return value.item() if isinstance(value, np.generic) else value


def _components(value: Any) -> tuple[float, ...]:
    if isinstance(value, str):
        raise ValueError("finite numbers in a row")
    try:
        row = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError("finite numbers in a row") from None
    if row.ndim != 1 or not np.all(np.abs(row) <= LARGEST):
        raise ValueError("finite numbers in a row")
    return tuple(row.tolist())


def _rotation(value: Any) -> tuple[float, ...]:
    return _components([value] if isinstance(value, int | float | np.generic) else value)


def _row(value: Any) -> Any:
    """A list as a tuple; other values as they are, for whoever refuses them."""
    return tuple(value) if isinstance(value, list) else value


Number = Annotated[float, BeforeValidator(_plain), Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, BeforeValidator(_plain), Field(gt=0, le=LARGEST)]
NotNegative = Annotated[float, BeforeValidator(_plain), Field(ge=0, le=LARGEST)]
Name = Annotated[str, Field(min_length=1, pattern=BODY_NAME)]
Vector = Annotated[Sequence[float] | FloatArray, PlainValidator(_components)]
AngularVector = Annotated[float | Sequence[float] | FloatArray, PlainValidator(_rotation)]
"""A row of numbers, or a number in 2D."""
AnyRow = BeforeValidator(_row)
"""Lets a list stand for a tuple."""


@dataclass_transform(frozen_default=True)
def checked(cls: type[T]) -> type[T]:
    """Make a frozen dataclass whose values are of their types; raises ArgumentError for others when one is made."""
    made = dataclass(frozen=True, config=_CONFIG)(cls)
    init: Callable[..., None] = made.__init__

    @wraps(init)
    def checking(self: object, *values: object, **named: object) -> None:
        try:
            init(self, *values, **named)
        except ValidationError as error:
            raise _refusal(made, error) from None

    setattr(made, "__init__", checking)  # noqa: B010  of a type, which has no such attribute for mypy
    return cast(type[T], made)


def _refusal(made: type[Any], error: ValidationError) -> ArgumentError:
    """Our error for the first complaint about the values of a class."""
    complaint, name, names = error.errors()[0], made.__name__, [field.name for field in fields(made)]
    first, *inner = complaint["loc"]
    if isinstance(first, int) and first < len(names):  # a value that was given without its name
        first = names[first]
    field = ".".join(map(str, (name, first, *inner)))
    if complaint["type"] == "missing":
        return ArgumentError(field, "nothing", "a value", "Add it.")
    if complaint["type"] in ("unexpected_keyword_argument", "unexpected_positional_argument"):
        return ArgumentError(field, "an argument that is not there", f"arguments of {name}", "Correct or remove it.")
    return ArgumentError(field, value_text(complaint["input"]), allowed_by(complaint), "Correct the value.")
