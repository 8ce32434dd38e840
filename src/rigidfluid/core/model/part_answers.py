"""Checks of what bodies, domains, mechanisms, detectors and force laws give."""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from rigidfluid.core.geometry.answers import (
    corners,
    refuse_no_number,
    refuse_other_rows,
    refuse_other_shape,
    refuse_others,
    several,
)
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.model.contact_results import refuse_odd
from rigidfluid.core.model.types import Contacts, Pose, Twist

_ROUNDING = 1e-9


def inertia(answer: Any, part: Any) -> None:
    """Refuse what is no symmetric matrix (k, k) of positive moments."""
    turns = 1 if part.dimension == 2 else 3
    refuse_other_rows(answer, (turns, turns))
    least = float(np.linalg.eigvalsh(answer)[0])
    if least <= 0.0 or np.abs(answer - answer.T).max() > _ROUNDING * np.abs(answer).max():
        raise Wrong(f"{answer.tolist()}", "a symmetric matrix of positive moments")


def points(answer: Any, part: Any, count: int) -> None:
    """Refuse what are no points, one at least."""
    refuse_other_rows(answer, (max(len(answer), 1) if isinstance(answer, np.ndarray) else count, part.dimension))


def facets(answer: Any, part: Any) -> None:
    """Refuse what are no facets between points that are there."""
    refuse_others(answer, Facets)
    d = part.dimension
    refuse_other_rows(answer.points, (np.shape(answer.points)[:1] or (0,)) + (d,), "points")
    count = (np.shape(answer.vertices)[:1] or (0,))[0]
    refuse_other_shape(answer.vertices, (count, d), "vertices", "iu")
    refuse_other_shape(answer.markers, (count,), "markers", "iu")
    if count == 0 or answer.vertices.min() < 0 or answer.vertices.max() >= len(answer.points):
        raise Wrong(f"{count} facets between {len(answer.points)} points", "facets between points that there are")


def extent(answer: Any, part: Any) -> None:
    """Refuse what is no pair of finite corners with room between them."""
    corners(answer, part)
    for corner in answer:
        refuse_other_rows(corner, (part.dimension,))
    if not np.all(answer[0] < answer[1]):
        raise Wrong(f"corners {answer[0].tolist()} and {answer[1].tolist()}", "a lower and an upper one")


def pieces(answer: Any, part: Any) -> None:
    """Refuse what are no named pieces of surface."""
    several(lambda: Piece, least=1)(answer)
    for piece in answer:
        refuse_others(piece.name, str, "name")
        refuse_others(piece.shape, Surface, f"shape of {piece.name!r}")
        if piece.area != inf:
            refuse_no_number(piece.area, f"area of {piece.name!r}")


def truths(answer: Any, part: Any, points: Any) -> None:
    """Refuse what does not say of each point whether it is inside."""
    refuse_other_shape(answer, points.shape[:1], kinds="b")


def components(answer: Any, part: Any) -> None:
    """Refuse what are no components of a mechanism."""
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.model.mechanism import Component

    several(lambda: Component, least=1)(answer)
    for one in answer:
        refuse_others(one.name, str, "name")
        refuse_others(one.shape, Body, f"shape of {one.name!r}")
        refuse_no_number(one.density, f"density of {one.name!r}", least=0.0)


def placement(answer: Any, part: Any, time: float) -> None:
    """Refuse what is no pose of all components."""
    refuse_others(answer, Pose)
    count, d = len(part.components), part.dimension
    refuse_other_rows(answer.position, (count, d), "position")
    refuse_other_rows(answer.orientation, (count, 1 if d == 2 else 4), "orientation")
    if d == 3 and np.abs(np.sum(answer.orientation**2, axis=1) - 1.0).max() > _ROUNDING:
        raise Wrong(f"quaternions {answer.orientation.tolist()}", "quaternions of length 1")


def rate(answer: Any, part: Any, time: float) -> None:
    """Refuse what is no twist of all components, or moves what is not driven."""
    refuse_others(answer, Twist)
    count, d = len(part.components), part.dimension
    refuse_other_rows(answer.velocity, (count, d), "velocity")
    refuse_other_rows(answer.angular_velocity, (count, 1 if d == 2 else 3), "angular velocity")
    if not part.driven and (answer.velocity.any() or answer.angular_velocity.any()):
        raise Wrong("a rate of what is not driven", "`driven = True` with `rate`")


def later(answer: Any, part: Any, time: float) -> None:
    """Refuse what is no later time; there may be none."""
    if answer != inf:
        refuse_no_number(answer)
        if answer <= time:
            raise Wrong(f"{answer}", f"a time after {time:g}")


def reach(answer: Any, part: Any, law_range: float) -> None:
    """Refuse what is no reach; it is 0 where nothing is to be measured, and may be infinite."""
    if not (isinstance(answer, float) and answer == inf):
        refuse_no_number(answer)
    if answer < 0.0:
        raise Wrong(f"{answer}", "a reach of 0 or more")


def ranges(answer: Any, part: Any) -> None:
    """Refuse what are no gaps at which a law begins."""
    several(lambda: object, least=1)(answer)
    for one in answer:
        refuse_no_number(one, "range", least=0.0)


def energies(answer: Any, part: Any, contacts: Contacts) -> None:
    """Refuse what are no energies; they are infinite in overlap where the law says so."""
    if type(answer) is np.ndarray and part.overlap == "unbounded":
        answer = np.where(answer == inf, 0.0, answer)
    refuse_other_rows(answer, contacts.gap.shape, shorter=True)


def contacts(answer: Any, part: Any, pose: Pose, mesh: Any, reach: float) -> None:
    """Refuse contacts of surfaces that there are not, or twice the same ones, points that are not a gap apart, and
    signs that the detector does not declare."""
    refuse_others(answer, Contacts)
    refuse_odd(answer, pose, part.bodies, part.walls)
    odd = (np.abs(answer.sign) if part.signed else answer.sign) != 1.0
    if odd.any():
        first, allowed = int(np.argmax(odd)), "1 or -1" if part.signed else "1, as `signed` is not set"
        raise Wrong(f"a sign of {answer.sign[first]:g}, contact {first}", allowed)
