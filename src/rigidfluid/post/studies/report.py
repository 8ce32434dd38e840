"""A study's plots and its page, which needs no other file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from rigidfluid.core.output.disk import replace_file, writing
from rigidfluid.core.run.summary import versions
from rigidfluid.post.reports.html import document, grid, picture, table
from rigidfluid.post.reports.style import STYLE, save
from rigidfluid.post.studies.model import FINEST, Study
from rigidfluid.post.studies.parameter_plot import parameter_plot
from rigidfluid.post.studies.plot import error_label, error_plot
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import cells
from rigidfluid.post.studies.sampled import Grid, Sampled, index_table, quantile_table
from rigidfluid.post.studies.samples_plot import samples_plot
from rigidfluid.post.studies.table import write_grid

PLOT, PAGE = "study", "study.html"

_HEADINGS = {"quantiles": "Quantiles", "indices": "Sobol indices, with the half-width of 95 % confidence"}


def write_report(results: Results, out: Path) -> list[Path]:
    """Write the plot, if a run has something to draw, as PNG and SVG, the page, and of random samples the tables of
    quantiles and indices, into the existing folder ``out``.

    Returns the files written; raises OutputError if the disk refuses.
    """
    samples = results.samples
    grids = _sample_grids(results, samples)
    tables = [write_grid(out / f"{name}.csv", grid) for name, grid in grids.items()]
    with matplotlib.rc_context(STYLE), writing(out / PAGE):
        figure, caption = _plot(results, samples)
        plots = [] if figure is None else save(figure, out, PLOT, ("png", "svg"))
        pictures = [picture(path, caption) for path in plots[:1]]
        replace_file(out / PAGE, _page(results, pictures, grids).encode())
    return [*tables, *plots, out / PAGE]


def _sample_grids(results: Results, samples: Sequence[Sampled]) -> dict[str, Grid]:
    """Tables of quantiles and indices that have rows."""
    knobs = list(results.study.tables.vary)
    grids = {"quantiles": quantile_table(knobs, samples), "indices": index_table(knobs, samples)}
    return {name: found for name, found in grids.items() if found[1]}


def _plot(results: Results, samples: Sequence[Sampled]) -> tuple[Figure | None, str]:
    """The plot of this kind of study and its caption; None where it has nothing to show."""
    if samples and results.outcomes:
        return samples_plot(results, samples), "Each sample, the median, and the band from 5 to 95 %."
    if results.study.parameters and results.outcomes:
        return parameter_plot(results), f"Over {results.study.parameters[0]}; errors against {results.target.against}."
    if results.points:
        clock = results.study.tables.study.clock
        return error_plot(results), f"Error against {clock}. Rings: runs that no other run beats in both."
    return None, ""


def _page(results: Results, pictures: Sequence[str], grids: Mapping[str, Grid]) -> str:
    study = results.study
    parts = [
        *(f'<p class="note">{escape(note)}</p>' for note in _notes(results)),
        *pictures,
        *(part for name, found in grids.items() for part in (f"<h2>{_HEADINGS[name]}</h2>", grid(*found))),
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
    if not results.outcomes or (not results.study.parameters and not results.points):
        yield "No run has an error to draw."
    if results.target.relative and not results.is_relative:
        yield "A reference is 0, so errors are not relative."


def _meaning(results: Results) -> str:
    clock = results.study.tables.study.clock
    error = f"Error: {error_label(results).replace(chr(10), ' ')}. " if results.target.reference is not None else ""
    return (
        f"Figure: {results.target.figure}. Reference: {_reference(results)}. {error}"
        f"Seconds are {clock} of one run on this machine."
    )


def _reference(results: Results) -> str:
    if results.target.reference is None:
        return "none"
    if results.study.parameters and results.target.reference == FINEST:
        return "the finest run with the same parameters"
    return "not known" if results.reference is None else f"{results.reference:.8g}"


def _lines(results: Results) -> Iterator[list[object]]:
    for settings, key in zip(results.plan, results.prints, strict=True):
        row, knobs = results.rows[key], cells(results.study.knobs, settings)
        if row.outcome is None:
            yield [*knobs, "", "", "", "", "", f"failed: {row.message}"]
            continue
        outcome = row.outcome
        error = results.errors.get(key, "")
        figures = (f"{outcome.figure:.8g}", error, outcome.seconds, outcome.unknowns, outcome.steps)
        yield [*knobs, *figures, _remark(results, key)]


def _remark(results: Results, key: str) -> str:
    if results.finest.get(key) == key:
        return "reference"
    return "Pareto front" if key in results.front else ""
