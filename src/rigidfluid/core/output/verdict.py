"""Warnings and remarks of a run's summary, in the words of the command line, the report and Python's warnings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any


def verdict(summary: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Grade of each warning and remark, "serious warning", "warning" or a remark's, and its text with the remedy."""
    for warning in summary["energy"]["warnings"]:
        yield "serious warning" if warning["serious"] else "warning", f"{warning['text']}. {warning['remedy']}"
    for remark in summary.get("remarks", ()):
        yield remark["grade"], f"{remark['text']}. {remark['remedy']}"
