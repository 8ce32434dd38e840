"""Files of others: only regular ones of bounded size are read, since pipes and devices may be read for ever."""

from __future__ import annotations

from pathlib import Path

from rigidfluid.errors import SceneError

MOST_TEXT, MOST_GEOMETRY = 1 << 26, 1 << 31
"""Largest size of a scene or a table, and of a file of geometry [byte]."""


def require_regular(path: Path, key: str, most: int) -> None:
    """Raise SceneError, which names the ``key``, where a path is no regular file or has more than ``most`` bytes."""
    try:
        is_there, is_regular = path.exists(), path.is_file()
        size = path.stat().st_size if is_regular else 0
    except OSError as error:
        raise SceneError(key, f"{path}: {error.strerror}", "a file that can be read", "Check the path.") from None
    if not is_there:
        raise SceneError(key, str(path), "a file that is there", "Check the path.")
    if not is_regular:
        found = f"{path}, which is {'a folder' if path.is_dir() else 'a pipe or a device'}"
        raise SceneError(key, found, "a regular file", "Write its content to a file first.")
    if size > most:
        found, allowed = f"{path} of {size / 2**20:.0f} MiB", f"at most {most / 2**20:.0f} MiB"
        raise SceneError(key, found, allowed, "Check that it is the right file, or make it smaller.")
