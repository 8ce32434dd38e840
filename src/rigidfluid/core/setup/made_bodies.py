"""Checks of the bodies that could be made where other parts of a scene are refused."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.nested.placing import initial_pose
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.setup.geometry_checks import check_places
from rigidfluid.core.setup.model_checks import check_vectors
from rigidfluid.core.setup.placed_bodies import PlacedBodies, check_names
from rigidfluid.core.setup.rigid_body import PlacedMechanism, RigidBody
from rigidfluid.errors import PluginError, SceneError
from rigidfluid.registry import Registry


def check_made_bodies(
    domain: Domain,
    bodies: Sequence[RigidBody | None],
    mechanisms: Sequence[PlacedMechanism],
    registry: Registry,
) -> None:
    """Refuse, with SceneError, names that bodies and surfaces share and bodies that overlap or are outside the domain;
    None stands for bodies that could not be made."""
    with all_told() as ask:
        valid = [
            None if body is None else ask(_valid, body, domain.dimension, f"body.{n}") for n, body in enumerate(bodies)
        ]
        numbers = [n for n, body in enumerate(valid) if body is not None]
        made = PlacedBodies(domain, tuple(filter(None, valid)), tuple(_distinct(mechanisms)), registry)
        if made.all_bodies:
            ask(_check_made, made, numbers)


def _distinct(mechanisms: Sequence[PlacedMechanism]) -> Iterator[PlacedMechanism]:
    """Mechanisms with a name that none before has, and components with names of their own: bodies are found by them."""
    names: set[str] = set()
    for one in mechanisms:
        components = [each.name for each in one.mechanism.components]
        if one.name not in names and len(set(components)) == len(components):
            yield one
        names.add(one.name)


def _check_made(made: PlacedBodies, numbers: Sequence[int]) -> None:
    with told_by_numbers({"body": numbers}), all_told() as ask:
        ask(check_names, made)
        ask(check_places, made, initial_pose(made.all_bodies, made.dimension))


@contextmanager
def told_by_numbers(numbers: Mapping[str, Sequence[int]]) -> Iterator[None]:
    """Name, in errors of lists from which entries are left out, the entries by their ``numbers`` in the whole lists."""
    try:
        yield
    except (SceneError, PluginError) as error:
        raise error.renamed(lambda subject: _renumbered(subject, numbers)) from None


def _renumbered(subject: str, numbers: Mapping[str, Sequence[int]]) -> str:
    entry = re.match(r"(\w+)\.(\d+)\b", subject)
    if entry is None or int(entry[2]) >= len(numbers.get(entry[1], ())):
        return subject
    return f"{entry[1]}.{numbers[entry[1]][int(entry[2])]}{subject[entry.end() :]}"


def _valid(body: RigidBody, dimension: int, at: str) -> RigidBody:
    check_vectors(body, dimension, at)
    return body
