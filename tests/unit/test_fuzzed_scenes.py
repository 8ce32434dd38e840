"""Scenes and settings that nobody means end in a result, or in an error that names where: never in a bare exception.

`python tools/attack.py scenes` and `overrides` try many more, each in a process of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from attacks.contained import Ending, ending_of
from attacks.hostile_scenes import changed_scenes, changed_texts, generated_scenes, settings
from attacks.scenes import held, try_settings, try_tables, try_text
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings


def bounded(examples: int) -> hypothesis_settings:
    """The same examples in each run, and none kept on the disk."""
    return hypothesis_settings(
        max_examples=examples,
        derandomize=True,
        database=None,
        deadline=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.large_base_example],
    )


def require_held(attempt: Callable[[Any], str], hostile: Any) -> None:
    ending = ending_of(lambda: attempt(hostile))
    assert held(ending, repr(hostile)), ending


@pytest.mark.long
@bounded(80)
@given(changed_scenes())
def test_a_shipped_scene_with_changes(hostile: tuple[str, dict[str, Any]]) -> None:
    require_held(try_tables, hostile[1])


@bounded(40)
@given(generated_scenes())
def test_a_scene_of_tables_that_the_schema_allows(hostile: tuple[str, dict[str, Any]]) -> None:
    require_held(try_tables, hostile[1])


@bounded(30)
@given(changed_texts())
def test_a_scene_file_with_damage(hostile: tuple[str, bytes]) -> None:
    require_held(try_text, hostile[1])


@bounded(80)
@given(settings())
def test_settings_of_a_shipped_scene(hostile: tuple[str, list[str]]) -> None:
    require_held(try_settings, hostile)


@pytest.mark.parametrize("subject", ["", "gap", "2.5"])
def test_a_refusal_that_names_no_place_does_not_hold(subject: str) -> None:
    assert not held(Ending("refused", "found something wrong", subject), "{'time': 1}")
