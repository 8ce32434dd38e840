"""A scene's tables as the text of a scene file."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any


def scene_text(tables: Mapping[str, Any]) -> str:
    """TOML text, without a newline at its end, that reads back to the same tables, those of `Scene.to_dict`."""
    return "\n\n".join(text for name, table in tables.items() for text in _tables(name, table))


def _tables(name: str, table: Any) -> Iterator[str]:
    if isinstance(table, list):
        for entry in table:
            yield from _one_table(f"[[{name}]]", name, entry)
    else:
        yield from _one_table(f"[{name}]", name, table)


def _one_table(title: str, name: str, table: Mapping[str, Any]) -> Iterator[str]:
    plain = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    yield "\n".join([title, *(f"{key} = {_text(value)}" for key, value in plain.items())])
    for key in table.keys() - plain.keys():
        yield from _one_table(f"[{name}.{key}]", f"{name}.{key}", table[key])


def _text(value: Any) -> str:
    """JSON's numbers and strings are TOML's too."""
    if isinstance(value, list):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key} = {_text(part)}' for key, part in value.items())}}}"
    return json.dumps(value, ensure_ascii=False)
