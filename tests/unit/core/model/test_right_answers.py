"""Answers that only look wrong."""

from rigidfluid.forces.normal import NormalLaw


def test_whole_numbers_are_gaps_too():
    assert NormalLaw(NormalLaw.Options(epsilon=1e-3), 1).ranges == (1,)
