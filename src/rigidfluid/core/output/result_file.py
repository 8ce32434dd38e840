"""Files in folders of results before they are read: somebody else may have put pipes, devices or anything there."""

from __future__ import annotations

from pathlib import Path

from rigidfluid.core.model.memory import available_memory
from rigidfluid.errors import OutputError, SceneError
from rigidfluid.regular_file import require_regular


def require_result(path: Path) -> None:
    """Raise OutputError where a path is no regular file, or has more bytes than there is memory, since results are held
    whole; one that leads nowhere is left to the reader."""
    try:
        if path.exists():
            require_regular(path, str(path), available_memory())
    except SceneError as error:
        raise OutputError(error.subject, error.found, error.allowed, error.remedy) from None
