"""Parts that lie: whether an error names them wherever what they give enters."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import Any

from attacks.contained import REFUSED, Limits, contained
from attacks.trials import Trial

sys.path.append(str(Path(__file__).resolve().parents[2] / "tests" / "support"))

from lying_scenes import DRY, WET, ways, with_liars

from rigidfluid.registry import Registry

LIMITS = Limits(seconds=60.0, memory=8 << 30)


def attack_by_parts(count: int, start: int) -> Iterator[Trial]:
    """So many of all ways to meet a lie, drawn by the number ``start``, in the order of the kinds of parts."""
    all_ways = [(lie, way, meet) for lie in (*DRY, *WET) for way, meet in ways(lie).items()]
    chosen = sorted(Random(start).sample(range(len(all_ways)), min(count, len(all_ways))))
    for number in chosen:
        lie, way, meet = all_ways[number]
        ending = contained(lambda meet=meet: _met(meet), LIMITS)
        held = ending.how == REFUSED and lie.told in ending.said
        yield Trial(f"{lie.kind.title}, {way}", lie.part.name, ending.how, ending.said, held)


def _met(meet: Callable[[], Any]) -> str:
    """Meet a lie among the parts that are installed, in a process that has no other use for them."""
    registry = with_liars()
    Registry.load = lambda: registry  # type: ignore[method-assign]
    meet()
    return "nobody noticed"
