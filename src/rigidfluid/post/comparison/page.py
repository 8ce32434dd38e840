"""The plots of a comparison and its page, which needs no other file."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

import matplotlib

from rigidfluid.core.output.disk import replace_file, writing
from rigidfluid.core.scene.scene_text import scene_text
from rigidfluid.post.comparison.comparison import Comparison
from rigidfluid.post.comparison.figures import body_plot, difference_plot, most_different
from rigidfluid.post.comparison.tables import HEADER, cost_rows, difference_rows, meaning
from rigidfluid.post.reports.html import Picture, document, grid, save_pictures
from rigidfluid.post.reports.style import STYLE

PAGE = "comparison.html"
MOST_BODIES = 4
"""More bodies have no plot."""
_SECONDS = (
    "Backends run one after the other on this machine, each in a process of its own. Seconds are wall time; "
    "those of a backend's first run include what it compiles, and --fresh measures again."
)


def write_page(comparison: Comparison, name: str, out: Path) -> list[Path]:
    """Write the plots, if two runs are complete, as PNG and SVG, and the page, into the existing folder ``out``.

    Returns the files written; raises OutputError if the disk refuses.
    """
    with matplotlib.rc_context(STYLE), writing(out / PAGE):
        written, shown = save_pictures(_plots(comparison), out)
        replace_file(out / PAGE, _page(comparison, name, shown).encode())
    return [*written, out / PAGE]


def _plots(comparison: Comparison) -> Iterator[Picture]:
    if not comparison.pairs:
        return
    caption = f"Largest distance of any body from {comparison.pairs[0].reference} over time."
    yield "differences", caption, difference_plot(comparison.pairs), ("png", "svg")
    for number in most_different(comparison.pairs, MOST_BODIES):
        caption = f"{comparison.bodies[number]}: position, velocity and the fluid's force over time, by component."
        yield f"body_{number}", caption, body_plot(comparison.complete, number), ("png", "svg")


def _page(comparison: Comparison, name: str, plots: list[str]) -> str:
    parts = [
        f"<pre>{escape(comparison.command)}</pre>",
        *(f'<p class="note">{escape(note)}</p>' for note in _notes(comparison)),
        *_differences(comparison),
        *plots,
        "<h2>Cost</h2>",
        f"<p>{_SECONDS}</p>",
        grid(("", *(run.backend for run in comparison.runs)), cost_rows(comparison)),
        *_scenes(comparison),
        "<h2>Versions</h2>",
        grid(("", *(run.backend for run in comparison.complete)), _versions(comparison)),
    ]
    return document(f"{name}: {' and '.join(run.backend for run in comparison.runs)}", parts)


def _notes(comparison: Comparison) -> Iterator[str]:
    for run in comparison.failed:
        yield f"{run.backend} failed: {run.error}"
    if not comparison.pairs:
        yield "Fewer than two backends reached the end, so there is nothing to compare."
    hidden = len(comparison.bodies) - MOST_BODIES
    if comparison.pairs and hidden > 0:
        yield f"Of {len(comparison.bodies)} bodies only the {MOST_BODIES} that differ most have a plot."


def _differences(comparison: Comparison) -> Iterator[str]:
    for pair in comparison.pairs:
        yield f"<h2>{escape(pair.other)} compared with {escape(pair.reference)}</h2>"
        yield f"<p>{escape(meaning(pair))}</p>"
        yield grid(HEADER, difference_rows(comparison, pair))


def _scenes(comparison: Comparison) -> Iterator[str]:
    yield "<h2>Scene</h2>"
    for run in comparison.complete[:1]:
        assert run.results is not None
        text = escape(scene_text(run.results.summary["scene"]))
        yield f"<details open><summary>As {escape(run.backend)} ran it</summary><pre>{text}</pre></details>"


def _versions(comparison: Comparison) -> Iterator[tuple[str, ...]]:
    versions = [run.results.summary["versions"] for run in comparison.complete if run.results is not None]
    for package in dict.fromkeys(package for each in versions for package in each):
        yield package, *(each.get(package, "") for each in versions)
