"""Reads a study file, and refuses what cannot be run."""

from __future__ import annotations

from math import prod
from pathlib import Path

from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.places import told_in_file
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.scene.toml_file import read_toml
from rigidfluid.core.scene.validation import read_table
from rigidfluid.errors import SceneError
from rigidfluid.post.studies.model import MOST_RUNS, Study, StudyFile
from rigidfluid.post.studies.sobol import require_salib


def load_study(path: str | Path) -> Study:
    """Read a study file (TOML), validated but for its scene or kernel.

    Raises SceneError if it cannot be read, is no TOML, has a value that is not allowed, and in which line, or needs a
    package that is missing.
    """
    path = Path(path)
    data = read_toml(path, "study")
    with told_in_file(path):
        tables = read_table(StudyFile, data)
        with all_told() as ask:
            for check in (_check_subject, _check_knobs, _check_group, _check_lengths, _check_samples, _check_reference):
                ask(check, tables)
    return Study(tables, path, path.read_text(encoding="utf-8"))


def _check_subject(tables: StudyFile) -> None:
    scene, kernel = tables.study.scene, tables.study.kernel
    if (scene is None) == (kernel is None):
        found = "neither scene nor kernel" if scene is None else "scene and kernel"
        raise SceneError("study", found, "one of scene and kernel", "Say what is run by one of them.")
    if scene is not None and tables.error is None:
        raise SceneError("error", "nothing", "a table", "Add the table [error].")
    if kernel is not None and tables.error is not None:
        raise SceneError("error", "a table", "nothing with study.kernel", "Remove it: a kernel has its own reference.")
    if kernel is not None and tables.study.seconds == "cpu":
        raise SceneError(
            "study.seconds", "'cpu'", "'wall' with study.kernel", "Remove it: calls are timed by themselves."
        )


def _check_knobs(tables: StudyFile) -> None:
    """Physical parameters are those of a scene, listed or random, and no numerical settings."""
    random = {} if tables.random is None else tables.random.parameters
    if not (tables.vary or tables.parameters or random):
        raise SceneError("vary", "nothing", "a table", "Add the table [vary], [parameters] or [random].")
    if tables.parameters and random:
        raise SceneError("random", "a table", "nothing with [parameters]", "Keep one of them, or make two studies.")
    for table, keys in (("parameters", list(tables.parameters)), ("random.parameters", list(random))):
        if keys and tables.study.kernel is not None:
            raise SceneError(table, "a table", "nothing with study.kernel", "Call it [vary].")
        for key in keys:
            if key in tables.vary:
                raise SceneError(f"{table}.{key}", "a key of [vary] too", "a key of one of them", "Remove one.")


def _check_group(tables: StudyFile) -> None:
    knobs = list(tables.vary)
    if tables.study.group and (tables.parameters or tables.random):
        allowed, remedy = "nothing with parameters", "Remove it: the plot is over the first parameter."
        raise SceneError("study.group", repr(tables.study.group), allowed, remedy)
    for key in tables.study.group:
        if key not in knobs:
            remedy = suggestion(key, knobs) or "Name one of them, or leave it out."
            raise SceneError("study.group", repr(key), f"a key of [vary]: {', '.join(knobs)}", remedy)


def _check_lengths(tables: StudyFile) -> None:
    lengths = {key: len(values) for key, values in tables.vary.items()}
    if tables.study.zip and len(set(lengths.values())) > 1:
        found = ", ".join(f"{length} values of {key}" for key, length in lengths.items())
        raise SceneError("vary", found, "lists of one length with zip = true", "Complete the lists, or drop zip.")
    variants = max(lengths.values(), default=1) if tables.study.zip else prod(lengths.values())
    groups = prod(map(len, tables.parameters.values())) if tables.random is None else tables.random.runs
    if variants * groups > MOST_RUNS:
        table = next(name for name in ("random", "parameters", "vary") if getattr(tables, name))
        remedy = "Take fewer samples." if tables.random else "Shorten the lists, or take them side by side."
        raise SceneError(table, f"{variants * groups} runs", f"at most {MOST_RUNS}", remedy)


def _check_samples(tables: StudyFile) -> None:
    if tables.random is None or not tables.random.indices:
        return
    number = tables.random.number
    if number & (number - 1):
        larger = 1 << number.bit_length()
        remedy = f"Take {larger // 2} or {larger}."
        raise SceneError("random.number", number, "a power of 2 with indices = true", remedy)
    require_salib()


def _check_reference(tables: StudyFile) -> None:
    if tables.error is None:
        return
    if tables.error.reference is None and tables.vary and not (tables.parameters or tables.random):
        allowed, remedy = 'a number, or "finest"', "Add the key 'reference', or vary [parameters]."
        raise SceneError("error.reference", "nothing", allowed, remedy)
    if tables.error.relative and not tables.error.reference:
        found = "nothing" if tables.error.reference is None else 0
        raise SceneError("error.reference", found, "another number with relative = true", "Set relative = false.")
