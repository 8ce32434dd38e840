"""Parts that lie are named where what they give enters, in a run and in a check, whatever the stepping.

`python tools/attack.py parts` does the same, each in a process of its own, for docs/attack.md.
"""

from __future__ import annotations

import pytest
from lying_parts import Lie
from lying_scenes import DRY, IN_STEPS, WET, checked, ways, with_liars

from rigidfluid.errors import RigidfluidError
from rigidfluid.registry import Registry


@pytest.fixture(autouse=True)
def installed(monkeypatch: pytest.MonkeyPatch) -> None:
    registry = with_liars()
    monkeypatch.setattr(Registry, "load", lambda: registry)


def title(lie: Lie) -> str:
    return f"{lie.kind.title}: {lie.part.name}"


def test_there_are_many() -> None:
    assert len(DRY) >= 350
    assert len({title(lie) for lie in (*DRY, *WET)}) == len(DRY) + len(WET)


@pytest.mark.parametrize("lie", [*DRY, *WET], ids=title)
def test_a_lie_is_named(lie: Lie) -> None:
    for meet in ways(lie).values():
        with pytest.raises(RigidfluidError) as told:
            meet()
        assert lie.told in str(told.value)


@pytest.mark.parametrize("lie", [lie for lie in DRY if lie.key in IN_STEPS], ids=title)
def test_a_lie_that_no_check_asks_for_is_none_there(lie: Lie) -> None:
    checked(lie)
