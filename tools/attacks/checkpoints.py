"""Damaged folders of runs, taken up again: each is refused by the name of its file, or comes to the tables of the
unbroken run to the last bit."""

from __future__ import annotations

import functools
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import rigidfluid
from attacks.checkpoint_damages import HARMS, Folders
from attacks.contained import FINISHED, REFUSED, Ending, Limits, contained
from attacks.small_runs import DRY, WET, SmallRun, differences
from attacks.trials import Trial

LIMITS = Limits(seconds=180.0, memory=8 << 30)
EQUAL = "the results of the unbroken run"


def attack_checkpoints(count: int, start: int) -> Iterator[Trial]:
    """Damage of all kinds in turn, to a dry run and to one in a fluid."""
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        for small in (DRY, WET):
            for part, share in (("earlier", 0.25), ("broken", 0.5), ("later", 0.75), ("unbroken", 1.0)):
                _require_run(small, share, place / small.name / part)
            _warm_up(small, place)
        for number in range(start, start + count):
            small, other = (DRY, WET) if number % 2 == 0 else (WET, DRY)
            yield _tried(small, other, place, number, list(HARMS)[number // 2 % len(HARMS)])


def _require_run(small: SmallRun, share: float, folder: Path) -> None:
    ending = contained(functools.partial(_run, small, share, folder), LIMITS)
    if ending.how != FINISHED:
        raise SystemExit(f"a run {small.name} was to be whole: {ending}")


def _warm_up(small: SmallRun, place: Path) -> None:
    """Load and compile here what each process would load again; a resumed run meshes nothing, so this one may fork."""
    shutil.copytree(place / small.name / "broken", place / "whole")
    if (said := _taken_up(small, place / "whole", place / small.name / "unbroken")) != EQUAL:
        raise SystemExit(f"a run {small.name} that nothing has damaged: {said}")
    shutil.rmtree(place / "whole")


def _run(small: SmallRun, share: float, folder: Path) -> str:
    rigidfluid.run(small.scene(share), folder)
    return ""


def _tried(small: SmallRun, other: SmallRun, place: Path, number: int, group: str) -> Trial:
    mine, broken = place / small.name, place / "to break"
    shutil.copytree(mine / "broken", broken)
    folders = Folders(broken, mine / "earlier", mine / "later", place / other.name / "broken")
    said = HARMS[group](folders, np.random.default_rng(number))
    ending = contained(functools.partial(_taken_up, small, broken, mine / "unbroken"), LIMITS)
    trial = Trial(f"{small.name}: {group}", f"seed {number}: {said}", ending.how, ending.said, held(ending, broken))
    shutil.rmtree(broken)
    return trial


def _taken_up(small: SmallRun, folder: Path, unbroken: Path) -> str:
    rigidfluid.run(small.scene(), folder, resume=True)
    other = differences(folder, unbroken)
    return f"other results in {', '.join(other)}" if other else EQUAL


def held(ending: Ending, folder: Path) -> bool:
    """Whether a run went on to the same results, or was refused by the name of a file in its folder."""
    return ending == Ending(FINISHED, EQUAL) or (ending.how == REFUSED and str(folder) in ending.subject)
