"""Files of others: only regular ones of bounded size are read, since pipes and devices may be read for ever."""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from pathlib import Path

from rigidfluid.errors import ArgumentError, SceneError

MOST_TEXT, MOST_GEOMETRY = 1 << 26, 1 << 28
"""Largest size of a scene or a table, and of a file of geometry [byte]."""


def path_of(key: str, value: object, allowed: str, remedy: str) -> Path:
    """The path that a value names; raises ArgumentError, which names the ``key``, where no file can be called so."""
    if isinstance(value, str | os.PathLike):
        with suppress(UnicodeEncodeError):
            if (name := os.fsencode(value)) and b"\0" not in name:
                return Path(os.fsdecode(name))
    raise ArgumentError(key, repr(value), allowed, remedy)


def require_regular(path: Path, key: str, most: float, allowed: str = "a file that is there") -> None:
    """Raise SceneError, which names the ``key``, where a path is not one that is ``allowed``, no regular file, or has
    more than ``most`` bytes."""
    try:
        present = path.stat()
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the path
        reason = getattr(error, "strerror", None) or str(error)
        found = reason if key == str(path) else f"{path}: {reason}"
        raise SceneError(key, found, allowed, "Check path and permissions.") from None
    if not stat.S_ISREG(present.st_mode):
        if path.is_dir():
            raise SceneError(key, f"{path}, which is a folder", "a regular file", "Name a file in it.")
        found, remedy = f"{path}, which is a pipe or a device", "Write its content to a file first."
        raise SceneError(key, found, "a regular file", remedy)
    if present.st_size > most:
        found, limit = f"{path} of {present.st_size / 2**20:.0f} MiB", f"at most {most / 2**20:.0f} MiB"
        raise SceneError(key, found, limit, "Check that it is the right file, or make it smaller.")
