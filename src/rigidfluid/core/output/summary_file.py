"""The summary of a run on disk, checked as it is read."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rigidfluid.core.output.result_file import require_result
from rigidfluid.errors import OutputError


def read_summary(path: Path, needed: Iterable[str] = ("scene", "status")) -> dict[str, Any]:
    """Read a summary that has the ``needed`` keys; raises OutputError where there is none or it cannot be read."""
    require_result(path)
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise unreadable(path, "no file") from None
    except OSError as error:
        raise unreadable(path, error.strerror) from error
    except (ValueError, RecursionError) as error:
        raise unreadable(path, f"no JSON ({error})") from error
    missing = [key for key in needed if key not in summary] if isinstance(summary, dict) else ["table"]
    if missing:
        raise unreadable(path, f"no {missing[0]} in it")
    match summary:
        case {"scene": {"scene": {"name": str(), "dimension": int(2 | 3)}}, "energy": dict()}:
            return dict(summary)
    raise unreadable(path, "no tables `scene` and `energy` of a run in it")


def unreadable(path: Path, found: object) -> OutputError:
    """The error for a file that is not as a run writes it."""
    remedy = "Run the scene again, or go on with --resume; then read its results."
    return OutputError(str(path), found, "a file that a run of rigidfluid has written", remedy)
