"""Files that are replaced as a whole, and the operating system's refusals as errors that name the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rigidfluid.errors import OutputError


def replace_text(path: Path, text: str) -> None:
    """Write a file as a whole: one that cannot be written leaves the one before, or none."""
    staged = path.with_name(path.name + ".part")
    try:
        staged.write_text(text, encoding="utf-8", newline="\n")
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
