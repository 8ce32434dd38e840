"""A study's plots and its page, which needs no other file."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

import matplotlib

from rigidfluid.core.output.disk import writing
from rigidfluid.core.run.summary import versions
from rigidfluid.post.reports.html import document, grid, picture, table
from rigidfluid.post.reports.style import STYLE, save
from rigidfluid.post.studies.model import Study
from rigidfluid.post.studies.plot import error_label, error_plot
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import cells

PLOT, PAGE = "study", "study.html"


def write_report(results: Results, out: Path) -> list[Path]:
    """Write the plot, if a run has an error to draw, as PNG and SVG, and the page, into the existing folder ``out``.

    Returns the files written; raises OutputError if the disk refuses.
    """
    with matplotlib.rc_context(STYLE), writing(out / PAGE):
        plots = save(error_plot(results), out, PLOT, ("png", "svg")) if results.points else []
        (out / PAGE).write_text(_page(results, plots[:1]), encoding="utf-8")
    return [*plots, out / PAGE]


def _page(results: Results, plots: list[Path]) -> str:
    study = results.study
    caption = f"Error against {study.tables.study.clock}. Rings: runs that no other run beats in both."
    parts = [
        *(f'<p class="note">{escape(note)}</p>' for note in _notes(results)),
        *(picture(path, caption) for path in plots),
        "<h2>Runs</h2>",
        f"<p>{escape(_meaning(results))}</p>",
        grid((*study.knobs, "figure", "error", "seconds", "unknowns", "steps", ""), _lines(results)),
        "<h2>Study file</h2>",
        f"<pre>{escape(study.text)}</pre>",
        *_scene(study),
        "<h2>Versions</h2>",
        table(versions().items()),
    ]
    return document(study.name, parts)


def _scene(study: Study) -> Iterator[str]:
    if study.scene is not None:
        yield "<h2>Scene file</h2>"
        yield f"<pre>{escape(study.scene.read_text(encoding='utf-8'))}</pre>"


def _notes(results: Results) -> Iterator[str]:
    failures = [row.message for row in results.rows.values() if row.outcome is None]
    if failures:
        yield f"{len(failures)} of {len(results.plan)} runs failed; the table says why."
    if not results.points:
        yield "No run has an error to draw."
    if results.target.relative and not results.is_relative:
        yield "The reference is 0, so errors are not relative."


def _meaning(results: Results) -> str:
    clock = results.study.tables.study.clock
    reference = "not known" if results.reference is None else f"{results.reference:.8g}"
    return (
        f"Figure: {results.target.figure}. Reference: {reference}. "
        f"Error: {error_label(results).replace(chr(10), ' ')}. Seconds are {clock} of one run on this machine."
    )


def _lines(results: Results) -> Iterator[list[object]]:
    for settings, key in zip(results.plan, results.prints, strict=True):
        row, knobs = results.rows[key], cells(results.study.knobs, settings)
        if row.outcome is None:
            yield [*knobs, "", "", "", "", "", f"failed: {row.message}"]
            continue
        outcome = row.outcome
        figures = (f"{outcome.figure:.8g}", results.errors[key], outcome.seconds, outcome.unknowns, outcome.steps)
        yield [*knobs, *figures, _remark(results, key)]


def _remark(results: Results, key: str) -> str:
    if key == results.finest:
        return "reference"
    return "Pareto front" if key in results.front else ""
