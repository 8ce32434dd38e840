"""Damaged files of geometry and of tables over time, read by scenes that are checked and begun: each ends in a result
or is refused by the name of its file."""

from __future__ import annotations

import functools
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from attacks.contained import FINISHED, FORK, REFUSED, Ending, Limits, contained
from attacks.damages import DAMAGES
from attacks.geometry_files import write_files
from attacks.scenes import try_tables
from attacks.trials import Trial
from rigidfluid.domains import trial
from rigidfluid.regular_file import MOST_GEOMETRY

LIMITS = Limits(seconds=120.0, memory=8 << 30)
SHORT = 15.0
"""Seconds after which a trial of a file gives up here; in runs `trial.SECONDS`."""


def _as_a_pipe(path: Path) -> None:
    os.mkfifo(path)


def _as_a_device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def _as_a_large_file(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(MOST_GEOMETRY + 1)  # holes take no room


def _as_a_hole(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(1 << 26)


NO_FILES: Mapping[str, Callable[[Path], object]] = {
    "a pipe": _as_a_pipe,
    "a device": _as_a_device,
    "a folder": Path.mkdir,
    "no file": lambda path: None,
    "a link to itself": lambda path: path.symlink_to(path),
    "more than is read": _as_a_large_file,
    "64 MiB of zeros": _as_a_hole,
}
"""What may lie in the place of a file."""


def attack_geometry(count: int, start: int) -> Iterator[Trial]:
    """Files of all kinds, with all kinds of damage, in turn."""
    trial.SECONDS = SHORT
    with tempfile.TemporaryDirectory() as folder:
        with FORK.Pool(1) as another:  # a process that Netgen has meshed in cannot be forked
            scenes = another.apply(write_files, (Path(folder) / "whole",))
        for path, tables in scenes.items():
            _require_whole(path, tables)
        work = Path(folder) / "damaged"
        work.mkdir()
        cases = _cases(scenes, start)
        for _ in range(count):
            yield _tried(*next(cases), work)


def _require_whole(path: Path, tables: dict[str, Any]) -> None:
    ending = contained(functools.partial(try_tables, tables), LIMITS)
    if ending.how != FINISHED:
        raise SystemExit(f"{path.name}: a whole file is refused: {ending}")


Case = tuple[Path, dict[str, Any], str, str, Callable[[Path], object]]
"""A whole file, its scene, the group, what is done, and what writes the damaged one."""


def _cases(scenes: Mapping[Path, dict[str, Any]], start: int) -> Iterator[Case]:
    """First what is no file in the place of each kind of file, then damage of all kinds without end."""
    for number, (path, tables) in enumerate(scenes.items()):
        name = list(NO_FILES)[number % len(NO_FILES)]
        yield path, tables, "pipes, devices, folders, sizes", name, NO_FILES[name]
    number = start
    while True:
        for path, tables in scenes.items():
            random = np.random.default_rng(number)
            group = list(DAMAGES)[int(random.integers(0, len(DAMAGES)))]
            kind = DAMAGES[group][int(random.integers(0, len(DAMAGES[group])))]
            data = kind(path.read_bytes(), random)
            yield path, tables, group, f"{kind.__name__}, seed {number}", functools.partial(Path.write_bytes, data=data)
            number += 1


def _tried(
    path: Path, tables: dict[str, Any], group: str, what: str, write: Callable[[Path], object], work: Path
) -> Trial:
    damaged = work / path.name
    write(damaged)
    try:
        ending = contained(functools.partial(try_tables, _with_file(tables, path, damaged)), LIMITS)
    finally:
        shutil.rmtree(damaged) if damaged.is_dir() else damaged.unlink(missing_ok=True)
    return Trial(f"{_kind(path)}: {group}", f"{path.name}, {what}", ending.how, ending.said, held(ending))


def held(ending: Ending) -> bool:
    """Whether a file was read, or refused in words that name the key, or what is made of it."""
    named = ending.subject.startswith(("domain", "body", "boundary", "scene"))
    return ending.how == FINISHED or (ending.how == REFUSED and named)


def _kind(path: Path) -> str:
    return "".join(path.suffixes[-2:] if path.suffix == ".gz" else path.suffixes[-1:])


def _with_file(value: Any, before: Path, after: Path) -> Any:
    """Tables in which one file has the place of another."""
    if isinstance(value, dict):
        return {key: _with_file(inner, before, after) for key, inner in value.items()}
    if isinstance(value, list):
        return [_with_file(inner, before, after) for inner in value]
    return str(after) if value == str(before) else value
