"""Runs the missing runs of a study, and reports on all of it."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from time import monotonic

from rigidfluid.core.output.disk import writing
from rigidfluid.core.output.results_folder import Product, take_folder
from rigidfluid.post.progress import Observer, begin_run
from rigidfluid.post.studies.kernel_subject import KernelSubject
from rigidfluid.post.studies.model import Study
from rigidfluid.post.studies.processes import require_jobs, run_apart
from rigidfluid.post.studies.report import write_report
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import Row, fingerprint, try_run, words
from rigidfluid.post.studies.scene_subject import SceneSubject
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Subject
from rigidfluid.post.studies.table import read_rows, write_rows

TABLE = "study.csv"

STUDY = Product("study", r"(study|quantiles|indices)\.csv(\.part)?|study\.(html|png|svg)")

PAUSE = 20.0
"""Time from one writing of the table to the next, over what one takes: it is long where there are thousands of rows."""

Begin = Callable[[str], Callable[[float], None]]
"""Tells that a run begins, by words about it; returns what tells how much of it is done."""


def run_study(
    study: Study, out: Path, *, fresh: bool = False, jobs: int = 1, progress: Observer | None = None
) -> tuple[Results, list[Path]]:
    """Run a study to its end, resuming one in ``out`` unless ``fresh``; return the results and the files written.

    With several ``jobs`` so many runs go on at a time, each in a process of its own with one thread.

    Raises SceneError or PluginError if the study cannot be run at all (one run's failure goes into the table),
    OutputError if the disk refuses or the table cannot be read.
    """
    require_jobs(jobs)
    subject: Subject = SceneSubject(study) if study.scene is not None else KernelSubject(study)
    distinct = {fingerprint(subject.identity(settings)): subject.read(settings) for settings in study.settings()}
    with take_folder(out, STUDY, new=True):
        rows = {} if fresh else read_rows(out / TABLE)
        results = Results(study, subject.target, list(distinct.values()), list(distinct), rows)
        _run_missing(results, subject, out / TABLE, jobs, progress)
        results = replace(results)
        written = [out / TABLE, *write_report(results, out)]
        with writing(out):
            for earlier in set(STUDY.present(out)) - set(written):
                earlier.unlink()
        return results, written


def _run_missing(results: Results, subject: Subject, path: Path, jobs: int, progress: Observer | None) -> None:
    """Add the rows that are missing, and write the table, also where the runs are interrupted."""
    plan = zip(results.prints, results.plan, strict=True)
    missing = {key: settings for key, settings in plan if key not in results.rows}

    def begin(about: str) -> Callable[[float], None]:
        return begin_run(progress, len(results.plan) - len(missing), len(results.plan), about)

    written, pause = monotonic(), 0.0
    try:
        with closing(_rows(subject, dict(missing), jobs, begin)) as rows:
            for key, row in rows:
                results.rows[key] = row
                del missing[key]
                if (start := monotonic()) - written > pause:
                    write_rows(path, replace(results))
                    written = monotonic()
                    pause = PAUSE * (written - start)
    finally:
        write_rows(path, replace(results))


def _rows(
    subject: Subject, runs: Mapping[str, Settings], jobs: int, begin: Begin
) -> Generator[tuple[str, Row], None, None]:
    """Rows of the runs, one after the other in this process, or as they come from several."""
    if jobs == 1:
        for key, settings in runs.items():
            yield key, try_run(subject, settings, begin(words(settings)))
        return
    begin(f"{jobs} at a time")
    with closing(run_apart(subject, runs, jobs)) as rows:
        for each in rows:
            yield each
            begin(f"{jobs} at a time")
