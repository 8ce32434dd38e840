"""Class of tables and of parts' options, which are made by a call in Python alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel, ValidationError

from rigidfluid.core.scene.validation import scene_errors
from rigidfluid.errors import ArgumentError

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass as _ModelType
else:
    _ModelType = type(BaseModel)


class TableType(_ModelType):
    """Class of tables: who makes one in Python gets our errors, and may give lists or arrays for rows of numbers;
    tables that are read are not made by a call."""

    if not TYPE_CHECKING:  # each table has the signature that pydantic gives it

        def __call__(cls, *values: Any, **keys: Any) -> Any:
            try:
                return super().__call__(*values, **keys)
            except ValidationError as error:
                found = error
            try:
                return super().__call__(*values, **{key: _row(value) for key, value in keys.items()})
            except ValidationError as error:
                found = min((error, found), key=ValidationError.error_count)
            told = scene_errors(cls, found, cls.__name__)[0]
            raise ArgumentError(told.subject, told.found, told.allowed, told.remedy) from None


def _row(value: Any) -> Any:
    """A list or an array as a tuple, rows within it too, and a number of NumPy as one of Python; else the value."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    return tuple(map(_row, value)) if isinstance(value, list | tuple) else value
