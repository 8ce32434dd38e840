"""Studies on pages: their plot, and their runs in tables."""

from __future__ import annotations

import matplotlib
from matplotlib.figure import Figure
from page_tools import Page, Work, table

from rigidfluid.post.reports.style import STYLE
from rigidfluid.post.studies.plot import error_plot
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import cells, short_text


def study_plot(results: Results) -> Figure:
    """Error against run time, as `rigidfluid study` draws it."""
    with matplotlib.rc_context(STYLE):
        figure = error_plot(results)
        figure.set_dpi(STYLE["savefig.dpi"])
        figure.draw_without_rendering()
    return figure


def kernel_study(work: Work, name: str, title: str) -> Page:
    """The page of a study of a kernel: its plot, and its runs in a table."""
    results, rows = work.study(name), []
    for key, settings in zip(results.prints, results.plan, strict=True):
        outcome, front = results.outcomes.get(key), "yes" if key in results.front else ""
        figures = ("failed",) * 3 if outcome is None else (
            f"{outcome.figure:.1e}", f"{outcome.seconds:.1e}", str(outcome.unknowns)
        )  # fmt: skip
        rows.append((*cells(results.study.knobs, settings), *figures, front))
    text = f"Error of the {results.target.of} against {results.target.against}.\n\n"
    text += table((*results.study.knobs, "error", "seconds", "vertices", "Pareto front"), rows)
    text += f"\n\nThe same with a page of its own: `rigidfluid study studies/{name}.toml`."
    return Page(title, text, {"": study_plot(results)})


def study_table(results: Results) -> str:
    """The runs of a study of a scene, a row each: all knobs, the figure, its error, and the cost."""
    rows = []
    for key, settings in zip(results.prints, results.plan, strict=True):
        outcome, error = results.outcomes.get(key), results.errors.get(key)
        found = ("failed", "", "", "", "") if outcome is None else (
            f"{outcome.figure:.6g}", "reference" if error is None else f"{error:.1e}",
            f"{outcome.seconds:.1f}", f"{outcome.unknowns:,}", f"{outcome.steps:,}",
        )  # fmt: skip
        rows.append((*cells(results.study.knobs, settings), *found))
    return table(
        (*results.study.knobs, "figure", "error", results.study.tables.study.clock + " [s]", "unknowns", "steps"), rows
    )


def scene_rows(results: Results) -> str:
    """The runs of a study of a scene in a table: error and seconds, or that they failed."""
    rows, (group, knob) = [], results.study.knobs
    for key, settings in zip(results.prints, results.plan, strict=True):
        outcome, front = results.outcomes.get(key), "yes" if key in results.front else ""
        names = short_text(settings[group], results.study.tables.vary[group]), f"{settings[knob]:g}"
        figures = ("failed", "", "") if outcome is None else (
            f"{results.errors[key]:.1e}", f"{outcome.seconds:.2f}", str(outcome.steps)
        )  # fmt: skip
        rows.append((*names, *figures, front))
    return table((group, knob, "error", "seconds", "steps", "Pareto front"), rows)


def errors_by(results: Results) -> dict[str, dict[float, float]]:
    """The errors of a study of a scene by its group, in few words, and by its other knob."""
    group, knob = results.study.knobs
    found: dict[str, dict[float, float]] = {}
    for key, settings in zip(results.prints, results.plan, strict=True):
        errors = found.setdefault(short_text(settings[group], results.study.tables.vary[group]), {})
        if key in results.errors:
            errors[settings[knob]] = results.errors[key]
    return found
