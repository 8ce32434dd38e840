"""Which pages are older than what they were made from."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from page_tools.inputs import Inputs, changed
from page_tools.places import INPUTS, PAGES

SHOWN = 4
"""Number of changed inputs that are named."""


def recorded(folder: Path = INPUTS) -> dict[str, Inputs]:
    """What each page was made from, by its name."""
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))}


def stale(pages: Path = PAGES, inputs: Path = INPUTS) -> Iterator[tuple[str, str]]:
    """Pages that may be out of date, and why."""
    known = recorded(inputs)
    for name in sorted(path.stem for path in pages.glob("*.md")):
        if name not in known:
            yield name, "made before its inputs were recorded"
        elif files := changed(known[name]):
            more = ", …" if len(files) > SHOWN else ""
            yield name, f"{len(files)} of {len(known[name])} inputs have changed: {', '.join(files[:SHOWN])}{more}"
