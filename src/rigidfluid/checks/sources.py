"""Which bodies enter while the scene runs, and are they fit for it?"""

from __future__ import annotations

from collections.abc import Iterator

from rigidfluid.checks.finding import Finding
from rigidfluid.core.case.population import Population
from rigidfluid.core.case.population_due import body_alone
from rigidfluid.core.setup.model import Model

QUESTION = "source"

FIRST = 8
"""Bodies of a source that are judged."""


def with_first_bodies(model: Model) -> Model:
    """The model with the first bodies of each source too, in places where nobody else is; raises SceneError for one
    that has no room."""
    population = Population()
    for number, source in enumerate(model.source_tables):
        for count in range(min(FIRST, source.due(model.time.end))):
            population = population.with_body(body_alone(model, number, count), 0.0)
    return population.ever(model, population.known(model)) if population else model


def source_findings(model: Model) -> Iterator[Finding]:
    """Report how many bodies of each source are due until the end; a warning where there are none."""
    for source in model.source_tables:
        due = source.due(model.time.end)
        found = {"due": due}
        if due == 0:
            text = f"no body of {source.name} enters until the end, at {model.time.end:g}"
            remedy = "Let the first one enter earlier, or move time.end."
            yield Finding("warning", QUESTION, (source.name,), text, remedy, found)
            continue
        judged = "it is" if due == 1 else "they are" if due <= FIRST else f"the first {FIRST} are"
        text = (
            f"{due} {'body' if due == 1 else 'bodies'} of {source.name} {'is' if due == 1 else 'are'} due until the end"
        )
        text += f"; {judged} judged as those of the start"
        yield Finding("note", QUESTION, (source.name,), text, found=found)
