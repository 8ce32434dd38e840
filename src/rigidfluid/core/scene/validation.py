"""Reads a table of a scene into its model, and turns pydantic's complaints into ours."""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, NamedTuple, TypeVar, get_args, get_origin

from pydantic import AliasChoices, AliasPath, BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from rigidfluid.core.scene.all_errors import all_told, raise_all
from rigidfluid.core.scene.patterns import IN_WORDS
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.scene.vectors import WRONG_LENGTH
from rigidfluid.errors import SceneError

LARGEST, SMALLEST = 1e30, 1e-30
"""Numbers of a scene lie between these, or are zero: powers and products of them then stay finite."""

_LONG = 200

M = TypeVar("M", bound=BaseModel)
Location = tuple[int | str, ...]


def read_table(model: type[M], data: Mapping[str, Any], at: str = "") -> M:
    """Validate a table, as TOML gives it, into an instance of ``model``; ``at`` is its place in the scene (``body.0``).

    Raises SceneError for all refused values.
    """
    text = _json(data, at)
    try:
        table = model.model_validate_json(text, context={})
    except ValidationError as error:
        raise_all(scene_errors(model, error, at))
    with all_told() as ask:
        for field, number in _numbers(json.loads(text), at):
            ask(refuse_out_of_proportion, field, number)
    return table


def scene_errors(model: type[BaseModel], error: ValidationError, at: str) -> list[SceneError]:
    """Our errors for pydantic's complaints about a table at a place, in their order; of several about one value, or
    about the values in it, the most urgent one."""
    complaints = [one for one in error.errors() if one["type"] != "default_factory_not_called"]  # follows from others
    told: dict[int, SceneError] = {}
    for number in sorted(range(len(complaints)), key=lambda number: _urgency(complaints[number])):
        one = _told(model, complaints[number], complaints, at)
        if not any(_is_within(one.subject, other.subject) for other in told.values()):
            told[number] = one
    return [told[number] for number in sorted(told)]


def _is_within(field: str, other: str) -> bool:
    """Tell whether one of two fields is that of a value in the other, or both are the same."""
    return f"{field}.".startswith(f"{other}.") or f"{other}.".startswith(f"{field}.")


def _urgency(complaint: ErrorDetails) -> int:
    """Unknown keys often explain what is missing, and lengths of vectors why no other type of value fits."""
    first = ("extra_forbidden", WRONG_LENGTH)
    return first.index(complaint["type"]) if complaint["type"] in first else len(first)


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
    return SceneError(field if key else f"{field}''", "a key that nothing reads", ", ".join(keys), remedy)


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
        found = f"a number of {len(str(number))} digits" if isinstance(number, int) else f"{number:g}"
        raise SceneError(field, found, allowed, "Choose units in which it is nearer to 1.")


def _told(model: type[BaseModel], complaint: ErrorDetails, complaints: Sequence[ErrorDetails], at: str) -> SceneError:
    """The error of one of several complaints."""
    if complaint["type"] == "extra_forbidden":
        return _needless_key(_place(model, complaint["loc"][:-1], at), str(complaint["loc"][-1]))
    place = _place(model, complaint["loc"], at)
    if complaint["type"] == WRONG_LENGTH:
        return SceneError(place.field, *(complaint["ctx"][part] for part in ("found", "allowed", "remedy")))
    if complaint["type"] in ("union_tag_invalid", "union_tag_not_found"):
        return _unknown_type(place, complaint["input"])
    if complaint["type"] == "missing" and isinstance(complaint["input"], Mapping):
        return _missing_key(place, complaint["input"], str(complaint["loc"][-1]))
    if complaint["type"] == "missing":
        return _short_list(_place(model, complaint["loc"][:-1], at), complaint, complaints)
    if complaint["type"] in ("tuple_type", "list_type") and not _may_be_table(place, complaint["loc"]):
        return _single_value(place, complaint["input"])
    return SceneError(place.field or "scene", value_text(complaint["input"]), allowed_by(complaint), _remedy(place))


class _Types(NamedTuple):
    """The ``tables`` of a union, by what their ``key`` says; none of a value that is no such union."""

    key: str
    tables: Mapping[str, type[BaseModel]]


_UNTYPED = _Types("", {})


@dataclass(frozen=True)
class _Place:
    """A place in a scene.

    ``field``: its dotted key; ``key``: the last one in it; ``table``: that which has this key. ``within``: the table
    that stands there, if it is one; of several ``types`` it is that of this ``type``.
    """

    field: str
    key: str
    table: type[BaseModel]
    within: type[BaseModel] | None
    types: _Types = _UNTYPED
    type: str = ""


def _place(model: type[BaseModel], location: Location, at: str) -> _Place:
    """The place that pydantic gives by keys and numbers, and in between the types of a value that it has tried."""
    place, any_key = _Place(at, "", model, model), False
    for part in location:
        inside = f"{place.field}.{part}" if place.field else str(part)
        if isinstance(part, int) or any_key:
            place, any_key = replace(place, field=inside, key=place.key if isinstance(part, int) else part), False
        elif place.within is None and part in place.types.tables:
            place = replace(place, within=place.types.tables[part], type=part)
        elif place.within is not None and part in (fields := fields_by_key(place.within)):
            annotation, types = fields[part].annotation, _types(fields[part].annotation, fields[part].discriminator)
            place = _Place(inside, part, place.within, None if types.tables else _table_in(annotation), types)
            any_key = _has_any_key(annotation)
    return place


def _has_any_key(annotation: Any) -> bool:
    """Tell whether a value may be a table whose keys are free."""
    kinds = map(get_origin, (annotation, *get_args(annotation)))
    return any(inspect.isclass(kind) and issubclass(kind, Mapping) for kind in kinds)


def _needless_key(place: _Place, key: str) -> SceneError:
    """Error for a key that the table at a place does not have; tables of other types may have it."""
    assert place.within is not None
    field = f"{place.field}.{key}" if place.field else key
    others = [name for name, table in place.types.tables.items() if key in fields_by_key(table)]
    if not others:
        return unknown_key(field, fields_by_key(place.within))
    named = place.types.key
    statement = f"{key} is valid only with {named} = {' or '.join(map(repr, others))}, not {place.type!r}"
    remedy = f"set {named} = {others[0]!r}" if len(others) == 1 else f"change the {named}"
    return SceneError(field, statement, None, f"Leave it out, or {remedy}.")


def _unknown_type(place: _Place, table: Mapping[str, Any]) -> SceneError:
    """Error for a table without a type, or of one that there is not."""
    key, tables = place.types
    field, allowed = f"{place.field}.{key}", ", ".join(map(repr, tables))
    if key in table:
        remedy = suggestion(str(table[key]), tables) or "Name one of them."
        return SceneError(field, value_text(table[key]), allowed, remedy)
    known = {other for each in tables.values() for other in fields_by_key(each)}
    misspelt = _misspelt_key(place.field, table, key, known)
    return misspelt or SceneError(field, "nothing", allowed, f"Add the key {key!r}.")


def _short_list(place: _Place, first: ErrorDetails, complaints: Sequence[ErrorDetails]) -> SceneError:
    """Error for a list with too few entries: pydantic complains of each place that is empty."""
    empty = sum(each["type"] == "missing" and each["loc"][:-1] == first["loc"][:-1] for each in complaints)
    allowed = f"{len(first['input']) + empty} entries"
    return SceneError(place.field, value_text(first["input"]), allowed, _remedy(place))


def _may_be_table(place: _Place, location: Location) -> bool:
    """Tell whether a single table might stand in the place of a list: pydantic then ends the ``location`` by the kind
    that it has tried."""
    return place.within is not None and location[-1] not in (place.key, place.type)


def _single_value(place: _Place, value: object) -> SceneError:
    """Error for a single ``value`` in the place of a list."""
    found = value_text(value)
    if place.within is None and not place.types.tables:
        return SceneError(place.field, found, "a list", f"Put it in brackets: [{found}].")
    name = ".".join(part for part in place.field.split(".") if not part.isdecimal())
    return SceneError(place.field, found, "a list of tables", f"Write [[{name}]] in front of each of its tables.")


def _missing_key(place: _Place, table: Mapping[str, Any], key: str) -> SceneError:
    fields = fields_by_key(place.table)
    misspelt = _misspelt_key(place.field.rpartition(".")[0], table, key, fields)
    if misspelt is not None:
        return misspelt
    meaning = fields[key].description
    if meaning is None and _table_in(fields[key].annotation) is not None:
        return SceneError(place.field, "this table is missing", None, f"Add the table [{place.field}].")
    return SceneError(place.field, "this key is missing", None, f"Add {key!r}{f': {meaning}' if meaning else ''}.")


def _misspelt_key(field: str, table: Mapping[str, Any], key: str, known: Iterable[str]) -> SceneError | None:
    """Error for a key of a ``table`` at ``field`` that is nearly the one that is missing, if there is such a key."""
    known = set(known)
    wrong = [other for other in table if other not in known and suggestion(other, [key])]
    return unknown_key(f"{field}.{wrong[0]}" if field else wrong[0], known) if wrong else None


_LENGTHS = {"too_short": ("at least", "min_length"), "too_long": ("at most", "max_length")}
"""Bounds of the number of entries of a list, as pydantic calls them."""


def allowed_by(complaint: ErrorDetails) -> str:
    """Values that would have been allowed in the place of one that pydantic complains about."""
    if complaint["type"] in _LENGTHS:
        bound, key = _LENGTHS[complaint["type"]]
        count = complaint["ctx"][key]
        return f"{bound} {count} {'entry' if count == 1 else 'entries'}"
    if complaint["type"] == "string_pattern_mismatch":
        pattern = complaint["ctx"]["pattern"]
        return IN_WORDS.get(pattern, f"a text that the regular expression {pattern} matches")
    text = complaint["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    return f"a value {text}" if text.startswith(("greater", "less")) else text


def _remedy(place: _Place) -> str:
    field = fields_by_key(place.table).get(place.key)
    meaning = None if field is None else field.description
    return f"Correct it; it means: {meaning}." if meaning else "Correct the value."


def _types(annotation: Any, key: object = None) -> _Types:
    """The tables of a union that a ``key`` of theirs tells apart, or of one within the annotation."""
    inner = get_args(annotation)
    if isinstance(key, str):
        tables = [table for table in map(_table_in, inner) if table is not None]
        return _Types(key, {said: table for table in tables for said in get_args(table.model_fields[key].annotation)})
    if get_origin(annotation) is Annotated:
        keys = [mark.discriminator for mark in inner[1:] if isinstance(mark, FieldInfo)]
        return _types(inner[0], next(filter(None, keys), None))
    return next((found for found in map(_types, inner) if found.tables), _UNTYPED)


def _table_in(annotation: Any) -> type[BaseModel] | None:
    """The model inside ``tuple[Model, ...]`` or ``Model | None``."""
    if inspect.isclass(annotation) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_table_in, get_args(annotation))), None)
