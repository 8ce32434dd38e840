"""Runs the missing runs of a study, and reports on all of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rigidfluid.core.output.writer import writing
from rigidfluid.errors import RigidfluidError
from rigidfluid.post.studies.kernel_subject import KernelSubject
from rigidfluid.post.studies.model import Settings, Study
from rigidfluid.post.studies.report import write_report
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import Row, fingerprint, text_of
from rigidfluid.post.studies.scene_subject import SceneSubject
from rigidfluid.post.studies.subject import Subject
from rigidfluid.post.studies.table import read_rows, write_rows

TABLE = "study.csv"


@dataclass(frozen=True, slots=True)
class StudyProgress:
    """Progress of a study: runs ``done``, a fraction of the present one included, of ``total``; the ``settings``."""

    done: float
    total: int
    settings: str


def run_study(
    study: Study, out: Path, *, fresh: bool = False, progress: Callable[[StudyProgress], None] | None = None
) -> tuple[Results, list[Path]]:
    """Run a study to its end, resuming one in ``out`` unless ``fresh``; return the results and the files written.

    Raises SceneError or PluginError if the study cannot be run at all (one run's failure goes into the table),
    OutputError if the disk refuses or the table cannot be read.
    """
    subject: Subject = SceneSubject(study) if study.scene is not None else KernelSubject(study)
    results = _results(study, subject, out, fresh, progress or (lambda _: None))
    return results, [out / TABLE, *write_report(results, out)]


def _results(
    study: Study, subject: Subject, out: Path, fresh: bool, progress: Callable[[StudyProgress], None]
) -> Results:
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
    distinct = {fingerprint(subject.identity(settings)): subject.read(settings) for settings in study.settings()}
    prints, plan = list(distinct), list(distinct.values())
    rows = {} if fresh else read_rows(out / TABLE)
    results = Results(study, subject.target, plan, prints, rows)
    for number, (settings, key) in enumerate(zip(plan, prints, strict=True)):
        if key not in rows:
            show = _shower(progress, number, len(plan), settings)
            show(0.0)
            rows[key] = _tried(subject, settings, show)
            results = Results(study, subject.target, plan, prints, rows)
        write_rows(out / TABLE, results)
    return results


def _tried(subject: Subject, settings: Settings, show: Callable[[float], None]) -> Row:
    try:
        return Row(subject.run(settings, show))
    except RigidfluidError as error:
        return Row(None, str(error))


def _shower(
    progress: Callable[[StudyProgress], None], number: int, total: int, settings: Settings
) -> Callable[[float], None]:
    words = ", ".join(f"{key} {text_of(value)}" for key, value in settings.items())
    return lambda part: progress(StudyProgress(number + part, total, words))
