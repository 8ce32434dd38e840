"""Class of tables and of parts' options, which are made by a call in Python alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ValidationError

from rigidfluid.core.scene.validation import scene_errors
from rigidfluid.errors import ArgumentError

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass as _ModelType
else:
    _ModelType = type(BaseModel)


class TableType(_ModelType):
    """Class of tables: who makes one in Python gets our errors; tables that are read are not made by a call."""

    if not TYPE_CHECKING:  # each table has the signature that pydantic gives it

        def __call__(cls, *values: Any, **keys: Any) -> Any:
            try:
                return super().__call__(*values, **keys)
            except ValidationError as error:
                told = scene_errors(cls, error, cls.__name__)[0]
                raise ArgumentError(told.subject, told.found, told.allowed, told.remedy) from None
