"""The latest answer is kept for the same objects alone."""

from __future__ import annotations

from rigidfluid.core.model.latest import Latest


def test_it_is_asked_again_for_other_objects_alone() -> None:
    kept, one, equal = Latest[int](), [0], [0]
    answers = iter(range(9))

    def ask() -> int:
        return next(answers)

    assert [kept.answer((one, one), ask), kept.answer((one, one), ask)] == [0, 0]
    assert [kept.answer((one, equal), ask), kept.answer((one, one), ask)] == [1, 2]
