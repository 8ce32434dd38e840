"""Reads a table of a scene into its model, and turns pydantic's complaints into ours."""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar, get_args, get_origin

from pydantic import AliasChoices, AliasPath, BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from rigidfluid.errors import SceneError
from rigidfluid.registry import suggestion

LARGEST, SMALLEST = 1e30, 1e-30
"""Numbers of a scene lie between these, or are zero: powers and products of them then stay finite."""

_LONG = 200

M = TypeVar("M", bound=BaseModel)
Location = tuple[int | str, ...]


def read_table(model: type[M], data: Mapping[str, Any], at: str = "") -> M:
    """Validate a table, as TOML gives it, into an instance of ``model``; ``at`` is its place in the scene (``body.0``).

    Raises SceneError at the first refused value; unknown keys come first, as they often explain what is missing.
    """
    text = _json(data, at)
    try:
        table = model.model_validate_json(text)
    except ValidationError as error:
        complaints = sorted(error.errors(), key=lambda complaint: complaint["type"] != "extra_forbidden")
        raise _scene_error(model, complaints, at) from None
    for field, number in _numbers(json.loads(text), at):
        refuse_out_of_proportion(field, number)
    return table


def fields_by_key(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """The fields of a table by the keys that it may have."""
    fields = model.model_fields
    return {key: fields[name] for name, keys in _keys_by_name(model).items() for key in keys}


def table_of(options: BaseModel) -> dict[str, Any]:
    """The table that `read_table` makes such options of."""
    keys = _keys_by_name(type(options))
    return {keys[name][0]: value for name, value in options.model_dump().items()}


def _keys_by_name(model: type[BaseModel]) -> dict[str, list[str]]:
    """The keys that each field of a model is read from: its aliases where it has any, and also its name where the model
    takes both."""
    both = model.model_config.get("populate_by_name") or model.model_config.get("validate_by_name")
    found = {}
    for name, field in model.model_fields.items():
        aliases = list(_aliases(field.validation_alias))
        found[name] = [*aliases, name] if both or not aliases else aliases
    return found


def _aliases(alias: str | AliasPath | AliasChoices | None) -> Iterator[str]:
    """Keys of a table that an alias reads."""
    if isinstance(alias, AliasChoices):
        for choice in alias.choices:
            yield from _aliases(choice)
    elif isinstance(alias, AliasPath):
        yield str(alias.path[0])
    elif alias is not None:
        yield alias


def unknown_key(field: str, known: Iterable[str], hint: str = "") -> SceneError:
    """Error for a key that nobody reads at the place ``field`` (``body.0.raduis``), with the nearest of the ``known``
    keys as remedy, or the ``hint`` where none is near."""
    key = field.rpartition(".")[2]
    keys = sorted(known)
    remedy = suggestion(key, keys) or hint or "Remove it."
    return SceneError(field, "a key that nothing reads", ", ".join(keys), remedy)


def value_text(value: object) -> str:
    """A value for a message, cut short where it is long."""
    text = repr(value)
    return text if len(text) <= _LONG else f"{text[:_LONG]}… ({len(text)} characters)"


def _json(data: Mapping[str, Any], at: str) -> str:
    """JSON's arrays may become tuples in strict mode, while a string never becomes a number."""
    try:
        return json.dumps(data, default=_plain)
    except (ValueError, TypeError, RecursionError) as error:
        found = f"a value that is no JSON ({error})"
        raise SceneError(at or "scene", found, "tables, lists, numbers and texts", "Correct the values.") from None


def _plain(value: Any) -> Any:
    """NumPy values as lists and numbers; TOML's dates, which no key takes, as they are written."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


def _numbers(value: Any, at: str) -> Iterator[tuple[str, float]]:
    """Every number in tables and lists, with its field."""
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _numbers(inner, f"{at}.{key}" if at else str(key))
    elif isinstance(value, int | float):
        yield at, value


def refuse_out_of_proportion(field: str, number: float) -> None:
    """Raise SceneError for a number that is not zero and beyond `SMALLEST` or `LARGEST`."""
    if number != 0 and not SMALLEST <= abs(number) <= LARGEST:
        allowed = f"0, or a number from {SMALLEST:g} to {LARGEST:g} in size"
        raise SceneError(field, f"{number:g}", allowed, "Choose units in which it is nearer to 1.")


def _scene_error(model: type[BaseModel], complaints: Sequence[ErrorDetails], at: str) -> SceneError:
    """The error of the first complaint."""
    complaint, location = complaints[0], _keys(model, complaints[0])
    field = ".".join([*filter(None, [at]), *map(str, location)])
    if complaint["type"] == "extra_forbidden":
        return unknown_key(field, fields_by_key(_model_at(model, location[:-1])))
    if complaint["type"] == "missing" and isinstance(complaint["input"], Mapping):
        return _missing_key(model, complaint, field)
    if complaint["type"] == "missing":
        return _short_list(model, complaints, at)
    return SceneError(field or "scene", value_text(complaint["input"]), _allowed(complaint), _remedy(model, location))


def _keys(model: type[BaseModel], complaint: ErrorDetails) -> Location:
    """Location of a complaint in the scene, without the types of a key that pydantic has tried and names in between."""
    keys: list[int | str] = []
    table: type[BaseModel] | None = model
    any_key = False
    *inner, last = complaint["loc"] or ("",)
    for part in (*inner, *([] if complaint["type"] == "extra_forbidden" else [last])):
        if isinstance(part, int) or any_key:
            keys.append(part)
            any_key = False
        elif table is not None and part in (fields := fields_by_key(table)):
            keys.append(part)
            annotation = fields[part].annotation
            table, any_key = _table_in(annotation), _has_any_key(annotation)
    return (*keys, last) if complaint["type"] == "extra_forbidden" else tuple(keys)


def _has_any_key(annotation: Any) -> bool:
    """Whether a value may be a table whose keys are free."""
    kinds = map(get_origin, (annotation, *get_args(annotation)))
    return any(inspect.isclass(kind) and issubclass(kind, Mapping) for kind in kinds)


def _short_list(model: type[BaseModel], complaints: Sequence[ErrorDetails], at: str) -> SceneError:
    """Error for a list with too few entries: pydantic complains of each place that is empty."""
    place, keys = complaints[0]["loc"][:-1], _keys(model, complaints[0])[:-1]
    field = ".".join([*filter(None, [at]), *map(str, keys)])
    empty = sum(complaint["type"] == "missing" and complaint["loc"][:-1] == place for complaint in complaints)
    given = complaints[0]["input"]
    return SceneError(field, value_text(given), f"{len(given) + empty} entries", _remedy(model, keys))


def _missing_key(model: type[BaseModel], complaint: ErrorDetails, field: str) -> SceneError:
    table, key = complaint["input"], str(complaint["loc"][-1])
    fields = fields_by_key(_model_at(model, complaint["loc"][:-1]))
    misspelt = [other for other in table if other not in fields and suggestion(other, [key])]
    if misspelt:
        return unknown_key(field.removesuffix(key) + misspelt[0], fields)
    meaning = fields[key].description
    if meaning is None:
        return SceneError(field, "nothing", "a table", f"Add the table [{field}].")
    return SceneError(field, "nothing", meaning, f"Add the key {key!r}.")


def _allowed(complaint: ErrorDetails) -> str:
    text = complaint["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    return f"a value {text}" if text.startswith(("greater", "less")) else text


def _remedy(model: type[BaseModel], location: Location) -> str:
    names = [part for part in location if isinstance(part, str)]
    field = fields_by_key(_model_at(model, names[:-1])).get(names[-1]) if names else None
    meaning = None if field is None else field.description
    return f"Correct it; it means: {meaning}." if meaning else "Correct the value."


def _model_at(model: type[BaseModel], location: Iterable[int | str]) -> type[BaseModel]:
    """The model of the table at this place of the scene."""
    for part in location:
        if isinstance(part, str):
            model = _table_in(fields_by_key(model)[part].annotation) or model
    return model


def _table_in(annotation: Any) -> type[BaseModel] | None:
    """The model inside ``tuple[Model, ...]`` or ``Model | None``."""
    if inspect.isclass(annotation) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_table_in, get_args(annotation))), None)
