"""Parts of their tables: their options among the keys, and how they are built."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, Protocol, TypeVar

from pydantic import BaseModel

from rigidfluid.core.model.part import Part, PartOptions, SpatialPart
from rigidfluid.core.scene.all_errors import all_told, raise_all
from rigidfluid.core.scene.spelling import nearest
from rigidfluid.core.scene.validation import fields_by_key, read_table, unknown_key
from rigidfluid.errors import PluginError, SceneError
from rigidfluid.registry import KINDS, Kind, Registry

P = TypeVar("P", bound=Part)
S = TypeVar("S", bound=SpatialPart)

_PLACELESS = sorted((f"{kind.table}." for kind in KINDS), key=len, reverse=True)
"""First words of a key in errors of parts, which do not know the place of their table; longer ones first."""


class NamesPart(Protocol):
    """A table that names a part, and has its keys besides its own."""

    @property
    def type(self) -> str:
        """Name of the part."""

    @property
    def model_extra(self) -> dict[str, Any] | None:
        """Keys of the part."""


def own_options(part: type[Part], given: Mapping[Any, Any], at: str) -> PartOptions:
    """The part's own of the keys given; ``at`` is the place of their table in the scene."""
    own = fields_by_key(part.Options)
    return read_table(part.Options, {key: given[key] for key in given if key in own}, at)


def refuse_unread(
    options: Mapping[str, Any], readers: Sequence[type[Part]], common: Mapping[str, Any], at: str, hint: str = ""
) -> None:
    """Raise SceneError for keys that none of the ``readers`` has, and that is not ``common`` to all such tables."""
    known = set().union(*(fields_by_key(reader.Options) for reader in readers))
    raise_all([unknown_key(f"{at}.{key}", known | set(common), hint) for key in options if key not in known])


def read_options(part: type[Part], options: Mapping[str, Any], common: Mapping[str, Any], at: str) -> PartOptions:
    """Options of a part whose table has keys that are ``common`` to all such tables; raises SceneError for all that are
    unknown or refused. A misspelt key is told once, and not missed too."""
    meant = {nearest(key, fields_by_key(part.Options)): value for key, value in options.items()}
    with all_told() as ask:
        ask(refuse_unread, options, [part], common, at)
        return ask(own_options, part, {**meant, **options}, at)


def read_part(
    look_up: Callable[[], type[P]],
    kind: Kind[P],
    options: Mapping[str, Any],
    table: type[BaseModel],
    at: str,
    registry: Registry,
) -> tuple[type[P], PartOptions]:
    """The part that ``look_up`` gives, and its options, among the keys of a ``table`` that are not its own; where the
    part is missing, its error is raised together with those of keys that no part of the kind has."""
    with all_told() as ask:
        part = ask(look_up)
        if part is None:
            every = registry.installed(kind)
            ask(refuse_unread, options, every, table.model_fields, at)
    return part, read_options(part, options, table.model_fields, at)


def build_part(kind: Kind[S], table: NamesPart, at: str, registry: Registry, dimension: int) -> S:
    """Part of a kind that a table names, at the place ``at`` of the scene (``body.0``, ``domain.obstacle.0``).

    Raises PluginError if it is missing, SceneError for an option that is unknown or refused.
    """
    assert isinstance(table, BaseModel)
    look_up = partial(registry.get, kind, table.type, f"{at}.type")
    part, read = read_part(look_up, kind, table.model_extra or {}, type(table), at, registry)
    with told_at(at):
        return part(read, dimension)


@contextmanager
def told_at(at: str) -> Iterator[None]:
    """Name the place ``at`` of a part in its errors and in those of parts within it, which do not know their place."""
    try:
        yield
    except (SceneError, PluginError) as error:
        if isinstance(error, PluginError) and _without_kind(error.subject) == error.subject:
            raise  # about a plug-in, and not a place in the scene
        raise error.renamed(lambda subject: f"{at}.{_without_kind(subject)}") from None


def _without_kind(subject: str) -> str:
    """Key of a part's table without the name of the table's kind."""
    return subject.removeprefix(next(filter(subject.startswith, _PLACELESS), ""))
