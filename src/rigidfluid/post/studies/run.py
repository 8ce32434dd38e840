"""Runs the missing runs of a study, and reports on all of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rigidfluid.core.output.results_folder import Product, take_folder
from rigidfluid.errors import RigidfluidError
from rigidfluid.post.progress import Observer, begin_run
from rigidfluid.post.studies.kernel_subject import KernelSubject
from rigidfluid.post.studies.model import Settings, Study
from rigidfluid.post.studies.report import write_report
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import Row, fingerprint, text_of
from rigidfluid.post.studies.scene_subject import SceneSubject
from rigidfluid.post.studies.subject import Subject
from rigidfluid.post.studies.table import read_rows, write_rows

TABLE = "study.csv"

STUDY = Product("study", r"study\.(csv(\.part)?|html|png|svg)")


def run_study(
    study: Study, out: Path, *, fresh: bool = False, progress: Observer | None = None
) -> tuple[Results, list[Path]]:
    """Run a study to its end, resuming one in ``out`` unless ``fresh``; return the results and the files written.

    Raises SceneError or PluginError if the study cannot be run at all (one run's failure goes into the table),
    OutputError if the disk refuses or the table cannot be read.
    """
    subject: Subject = SceneSubject(study) if study.scene is not None else KernelSubject(study)
    with take_folder(out, STUDY, new=True):
        results = _results(study, subject, out, fresh, progress)
        return results, [out / TABLE, *write_report(results, out)]


def _results(study: Study, subject: Subject, out: Path, fresh: bool, progress: Observer | None) -> Results:
    distinct = {fingerprint(subject.identity(settings)): subject.read(settings) for settings in study.settings()}
    prints, plan = list(distinct), list(distinct.values())
    rows = {} if fresh else read_rows(out / TABLE)
    results = Results(study, subject.target, plan, prints, rows)
    for number, (settings, key) in enumerate(zip(plan, prints, strict=True)):
        if key not in rows:
            about = ", ".join(f"{name} {text_of(value)}" for name, value in settings.items())
            rows[key] = _tried(subject, settings, begin_run(progress, number, len(plan), about))
            results = Results(study, subject.target, plan, prints, rows)
        write_rows(out / TABLE, results)
    return results


def _tried(subject: Subject, settings: Settings, show: Callable[[float], None]) -> Row:
    try:
        return Row(subject.run(settings, show))
    except RigidfluidError as error:
        return Row(None, str(error))
