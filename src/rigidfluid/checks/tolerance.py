"""Can steps become as short as a tolerance of their error may ask for?"""

from __future__ import annotations

from collections.abc import Iterator

from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.initial_state import START_LEVEL
from rigidfluid.core.scene.run_tables import TimeTable

QUESTION = "tolerance"


def tolerance_findings(time: TimeTable) -> Iterator[Finding]:
    """Compare the shortest step with the longest, where the scene has a tolerance; a warning where there are fewer
    halvings between them than the first step takes."""
    if time.tolerance is None:
        return
    halvings = Clock.for_steps(time.step, time.shortest, time.end).levels
    found = {"tolerance": time.tolerance, "longest": time.step, "shortest": time.shortest, "halvings": halvings}
    text = f"steps are between {figure(time.shortest)} and {figure(time.step)}"
    text += f", by a local error of at most {figure(time.tolerance)}"
    if halvings >= START_LEVEL:
        yield Finding("note", QUESTION, (), text, found=found)
        return
    enough = {"shortest": time.step / 2**START_LEVEL}
    text += f"; {halvings} halvings are fewer than the {START_LEVEL} of the first step"
    remedy = f"Set time.shortest to {round_down(enough['shortest'])} or less, or leave it out."
    yield Finding("warning", QUESTION, (), text, remedy, found, enough)
