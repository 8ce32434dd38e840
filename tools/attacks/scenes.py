"""Hostile scenes and settings, read, checked and, where there is no fluid, begun; each ends in a result or is refused
by name."""

from __future__ import annotations

import functools
import re
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

import rigidfluid
from attacks.contained import FINISHED, LONGEST, REFUSED, Ending, Limits, contained
from attacks.hostile_scenes import BASES, SCENES, Hostile, changed_scenes, changed_texts, generated_scenes, settings
from attacks.trials import Trial
from rigidfluid.api import Scene, Simulation
from rigidfluid.checks import check

LIMITS = Limits(seconds=60.0, memory=6 << 30)
STEPS = 3
"""Steps of a scene without a fluid that are taken."""

TABLES = {*Scene.model_fields, "--set"}


def read_check_and_step(scene: Scene) -> str:
    """Ask all questions of a scene, and take its first steps if it has no fluid; raises RigidfluidError."""
    errors = check(scene).count("error")
    if scene.fluid.backend != "dry":
        return f"checked, {errors} errors"
    simulation = Simulation(scene)
    for _ in range(STEPS):
        if not simulation.ended:
            simulation.step()
    return f"checked, {errors} errors; begun"


def try_tables(tables: dict[str, Any]) -> str:
    """A scene from its tables."""
    return read_check_and_step(rigidfluid.scene_from_dict(tables))


def try_text(text: bytes) -> str:
    """A scene from a file."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.toml"
        file.write_bytes(text)
        return read_check_and_step(rigidfluid.load_scene(file))


def try_settings(hostile: tuple[str, list[str]]) -> str:
    """A shipped scene with settings."""
    name, assignments = hostile
    return read_check_and_step(rigidfluid.load_scene(SCENES / f"{name}.toml", assignments))


def attack_scenes(count: int, start: int) -> list[Trial]:
    """Whole scenes from the schema, shipped ones with changes, and files with damage."""
    found = _tried("scenes by the schema", generated_scenes(), try_tables, count // 4, start)
    found += _tried("shipped scenes, changed", changed_scenes(), try_tables, count // 2, start)
    return found + _tried("scene files, damaged", changed_texts(), try_text, count - len(found), start)


def attack_settings(count: int, start: int) -> list[Trial]:
    """Settings of shipped scenes, as after ``--set``."""
    strategy = settings().map(lambda hostile: (f"{hostile[0]}: {hostile[1]}", hostile))
    return _tried("overrides", strategy, try_settings, count, start)


def _tried(
    group: str, strategy: st.SearchStrategy[Hostile], attempt: Callable[[Any], str], count: int, start: int
) -> list[Trial]:
    """As many different attempts of one group, each in a process of its own."""
    warm_up()
    trials: dict[str, Trial] = {}

    def one(hostile: Hostile) -> None:
        what, data = hostile
        key = f"{what} {data!r}"
        if len(trials) < count and key not in trials:
            ending = contained(functools.partial(attempt, data), LIMITS)
            trials[key] = Trial(group, key[:LONGEST], ending.how, ending.said, held(ending, repr(data)))

    drawn = 0
    while len(trials) < count:
        number = start + drawn
        seed(number)(_without_limits(count)(given(strategy)(one)))()
        drawn += 1
    return list(trials.values())


@functools.cache
def warm_up() -> None:
    """Load and compile here what each process would load and compile again."""
    for name in BASES:
        try_settings((name, []))


def held(ending: Ending, data: str) -> bool:
    """Whether an attempt came to a result, or to a refusal that names a field of the scene, something that its ``data``
    name, or a file."""
    place = re.split(r"[.\s]", ending.subject)[0]
    named = place and (place in TABLES or place in data or ending.subject.startswith("/"))
    return ending.how == FINISHED or (ending.how == REFUSED and bool(named))


def _without_limits(count: int) -> hypothesis_settings:
    checks = list(HealthCheck)
    return hypothesis_settings(
        max_examples=count, database=None, deadline=None, phases=[Phase.generate], suppress_health_check=checks
    )
