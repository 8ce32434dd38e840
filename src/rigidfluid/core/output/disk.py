"""Files that are replaced as a whole, and the operating system's refusals as errors that name the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from rigidfluid.errors import OutputError


def open_new(path: Path) -> BinaryIO:
    """Open a file that nobody knows by another name: what was in its place is removed, and a link is not followed."""
    path.unlink(missing_ok=True)
    return path.open("xb")


def replace_file(path: Path, data: bytes | memoryview) -> None:
    """Write a file by `open_new`."""
    with open_new(path) as file:
        file.write(data)


def replace_text(path: Path, text: str) -> None:
    """Write a file as a whole: one that cannot be written leaves the one before, or none."""
    staged = path.with_name(path.name + ".part")
    try:
        replace_file(staged, text.encode())
        staged.replace(path)
    except OSError:
        staged.unlink(missing_ok=True)
        raise


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn the operating system's refusal into an OutputError that names the file."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            str(path),
            error.strerror or str(error),
            "a folder that can be written to, on a disk with room",
            "Choose another --out, or make room and go on with --resume.",
        ) from error
