"""Checks of shapes that are not ours."""

from __future__ import annotations

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.core.setup.shape_checks import check_shapes


class Comparable(Ellipsoid):
    """A shape that is equal to others, and so has no hash."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Comparable)

    __hash__ = None  # type: ignore[assignment]


def test_a_shape_needs_no_hash() -> None:
    check_shapes([Comparable(EllipsoidOptions(semi_axes=(0.1, 0.05)), 2)])
