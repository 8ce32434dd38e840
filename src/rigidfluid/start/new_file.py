"""Files that a user gets to work on: never in the place of one that is there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rigidfluid.errors import OutputError


def require_new(path: Path) -> None:
    """Raise OutputError where there is a file already, or none can have that name."""
    with _writing(path):
        if path.exists():
            raise OutputError(str(path), "a file that is there", "a new one", "Move it away, or choose another place.")


def write_new(files: dict[Path, bytes]) -> None:
    """Write files, all or none; raises OutputError where one is there already, or cannot be written."""
    for path in files:
        require_new(path)
    for path, content in files.items():
        with _writing(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("xb") as file:
                file.write(content)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        allowed = "a folder that can be written to, on a disk with room"
        raise OutputError(str(path), error.strerror, allowed, "Work in another folder.") from None
