"""The falling disk by all fluid backends."""

from __future__ import annotations

import os

from page_tools import Page, Work, table

from pages._studies import study_plot
from rigidfluid.post.studies.results import Results


def page(work: Work) -> Page:
    """Seconds and errors of all backends; fails where one is not installed, as its rows would be lost."""
    results = work.study("backends")
    if missing := [key for key in results.prints if key not in results.outcomes]:
        raise SystemExit(
            f"{len(missing)} runs failed, as where a backend is not installed: see study_backends/study.csv"
        )
    text = ABOUT.format(cores=os.cpu_count(), figures=rows(results), **ratios(results))
    command = "tools/dolfinx run python3 docs/make_validation.py backends_study"
    return Page("Fluid backends: error against run time", text, {"": study_plot(results)}, command)


def ratios(results: Results) -> dict[str, str]:
    """Of each backend's seconds to those of scikit-fem with the same mesh and step: least to greatest."""
    seconds: dict[str, dict[tuple[float, float], float]] = {}
    for key, settings in zip(results.prints, results.plan, strict=True):
        place = settings["mesh.size_body"], settings["time.step"]
        seconds.setdefault(settings["fluid.backend"], {})[place] = results.outcomes[key].seconds
    least = seconds["scikit-fem"]
    over = {name: [found[place] / least[place] for place in least] for name, found in seconds.items()}
    return {name: f"{min(found):.2f} to {max(found):.2f}" for name, found in over.items()}


def rows(results: Results) -> str:
    """A row for each mesh and step: what is the same of all backends, and the seconds of each."""
    lines: dict[tuple[str, str], dict[str, str]] = {}
    figures: dict[tuple[str, str], list[float]] = {}
    for key, settings in zip(results.prints, results.plan, strict=True):
        place = f"{settings['mesh.size_body']:g}", f"{settings['time.step']:g}"
        outcome, backend = results.outcomes[key], settings["fluid.backend"]
        same = {"unknowns": f"{outcome.unknowns}", "error": f"{results.errors[key]:.1e}"}
        lines.setdefault(place, same)[f"{backend} [s]"] = f"{outcome.seconds:.2f}"
        figures.setdefault(place, []).append(outcome.figure)
    for place, values in figures.items():
        lines[place]["heights apart"] = f"{max(values) - min(values):.0e}"
    head = ("mesh.size_body", "time.step", *next(iter(lines.values())))
    return table(head, [(*place, *row.values()) for place, row in lines.items()])


ABOUT = """`studies/backends.toml`: the falling disk until .2 s; the error is that of its height. On {cores}
cores, of which `OMP_NUM_THREADS=1` leaves one to each run; all backends in one Python, DOLFINx and OpenBLAS from
Debian 13.

{figures}

The last column is the largest difference of the heights that the backends find. Where it is round-off, the error says
nothing about a backend, and the time alone can choose: the points of a mesh and a step lie side by side in the plot.

**What to choose when.** Seconds over those of `scikit-fem` with the same mesh and step:

* `scikit-fem` unless there is a reason: it comes with rigidfluid, and needs neither compiler nor MPI.
* `dolfinx`, {dolfinx}, where it is installed, with OpenBLAS. It alone shares a run among processes, and in 3D its
  `schur` solver needs far less memory.
* `ngsolve`, {ngsolve}, to check a result with another library's elements.
* Whichever it is, refine mesh and step together.

See [backends](../backends.md) for what each can do, and [the seconds of a step by stage](backends.md)."""
