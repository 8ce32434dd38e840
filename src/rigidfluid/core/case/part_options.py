"""Options of a part among the keys of its table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rigidfluid.core.model.interfaces import Part, PartOptions
from rigidfluid.core.scene.validation import fields_by_key, read_table, unknown_key


def own_options(part: type[Part], given: Mapping[str, Any], at: str) -> PartOptions:
    """The part's own of the keys given; ``at`` is the place of their table in the scene."""
    own = fields_by_key(part.Options)
    return read_table(part.Options, {key: given[key] for key in given if key in own}, at)


def refuse_unread(
    options: Mapping[str, Any], readers: Sequence[type[Part]], common: Mapping[str, Any], at: str, hint: str = ""
) -> None:
    """Raise SceneError for a key that none of the ``readers`` has, and that is not ``common`` to all such tables."""
    known = set().union(*(fields_by_key(reader.Options) for reader in readers))
    for key in options:
        if key not in known:
            raise unknown_key(f"{at}.{key}", known | set(common), hint)
