"""Does the run fit into memory, and how long do factors take?"""

from __future__ import annotations

from collections.abc import Iterator

from rigidfluid.checks.finding import Figures, Finding, figure
from rigidfluid.checks.run_size import RunSize
from rigidfluid.core.model.memory import REMEDY, available_memory, gigabytes

QUESTION = "memory"


def memory_findings(size: RunSize) -> Iterator[Finding]:
    """Compare the most memory that the backend expects to take, at the start or later, with what is available now; a
    warning where it is more."""
    start, most = size.start_cost, size.most_cost
    available = available_memory()
    found: Figures = {
        "cells": size.start.cells,
        "unknowns": start.unknowns,
        "most_cells": size.most.cells,
        "most_unknowns": most.unknowns,
        "gap": size.gap,
        "method": most.method,
        "memory": size.memory,
        "available": available,
        "seconds": most.seconds,
    }
    text = f"about {figure(size.start.cells)} cells with {figure(start.unknowns)} unknowns at the start"
    if size.meshes > 1:
        text += f", at most {figure(size.most.cells)} with {figure(most.unknowns)}"
        text += "" if size.gap is None else f", where gaps are {figure(size.gap)}"
    text += f"; by {most.method!r} the run takes {gigabytes(size.memory)} of memory, and {figure(most.seconds)} s of"
    text += " one core each time that factors are made"
    if size.memory <= available:
        yield Finding("note", QUESTION, (), text, found=found)
        return
    text += f"; {gigabytes(available)} are available"
    yield Finding("warning", QUESTION, (), text, REMEDY, found, {"memory": available})
