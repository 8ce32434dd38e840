"""The files that a scene or a model takes geometry or tables from, and their digests."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


def file_digests(document: Mapping[str, Any]) -> dict[str, str]:
    """SHA-256 of each regular file that a key ``file`` of a model's document names, by its name."""
    names = sorted({name for name in named_files(document) if Path(name).is_file()})
    return {name: hashlib.sha256(Path(name).read_bytes()).hexdigest() for name in names}


def named_files(value: Any) -> Iterator[str]:
    """Values of all keys ``file`` in nested tables."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key == "file" and isinstance(inner, str):
                yield inner
            yield from named_files(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from named_files(inner)
