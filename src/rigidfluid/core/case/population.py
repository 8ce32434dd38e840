"""Bodies of a run that enter and leave it: which there are, and the model that has those."""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from rigidfluid.core.case.scene_model import scene_body
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.scene.body_tables import BodyTable
from rigidfluid.core.scene.validation import read_table
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.core.setup.geometry_checks import check_places
from rigidfluid.core.setup.model import Model
from rigidfluid.core.setup.rigid_body import RigidBody
from rigidfluid.core.setup.shape_checks import check_shapes
from rigidfluid.errors import MeshError, SceneError


@dataclass(frozen=True)
class Present:
    """Pose and twist of bodies by ``names``, now."""

    names: tuple[str, ...]
    pose: Pose
    twist: Twist


@dataclass(frozen=True)
class Population:
    """Changes of the bodies of a run: tables of those that ``entered``, and names of those that ``left``; ``places``:
    keys of place and velocity of those that were there at the latest change, by name; ``since``: when each one of those
    that entered did [time]."""

    entered: tuple[Mapping[str, Any], ...] = ()
    left: tuple[str, ...] = ()
    places: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    since: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def from_dict(cls, stored: Mapping[str, Any]) -> Population:
        """Population as `to_dict` gave it, or its `changes` alone."""
        return cls(tuple(stored["entered"]), tuple(stored["gone"]), stored.get("places", {}), stored.get("since", {}))

    def __bool__(self) -> bool:
        return bool(self.entered or self.left)

    def to_dict(self) -> dict[str, Any]:
        """Values that JSON can hold, for checkpoints."""
        return self.changes | {"places": dict(self.places), "since": dict(self.since)}

    @property
    def changes(self) -> dict[str, Any]:
        """Which have entered, and which are gone, as values that JSON can hold."""
        return {"entered": list(self.entered), "gone": list(self.left)}

    def with_body(self, table: Mapping[str, Any], time: float) -> Population:
        """One with a body more, last of all, which entered at a ``time``."""
        return replace(self, entered=(*self.entered, table), since={**self.since, str(table["name"]): time})

    def without(self, name: str) -> Population:
        """One in which the body of this name has left."""
        return replace(self, left=(*self.left, name))

    def known(self, origin: Model) -> tuple[str, ...]:
        """Names of all bodies that are or were there, in their order."""
        return (*(body.name for body in origin.bodies), *(str(table["name"]) for table in self.entered))

    def names(self, origin: Model) -> tuple[str, ...]:
        """Names of the bodies at present, in their order."""
        return tuple(name for name in self.known(origin) if name not in self.left)

    def ever(self, origin: Model, names: Container[str]) -> Model:
        """The model of all bodies of these ``names`` that are or were there, as they started; raises as `model`."""
        bodies = (*origin.bodies, *self._entered(origin))
        return origin.with_bodies(tuple(body for body in bodies if body.name in names))

    def placed(self, now: Present) -> Population:
        """One whose latest change is ``now``."""
        return replace(self, places={name: _place(now, row) for row, name in enumerate(now.names)})

    def model(self, origin: Model) -> Model:
        """The model at the latest change: bodies of ``origin`` and those that entered, without those that left, in
        their places then; raises SceneError or PluginError for a table that is wrong."""
        bodies = [body for body in (*origin.bodies, *self._entered(origin)) if body.name not in self.left]
        return origin.with_bodies(tuple(_moved(body, self.places.get(body.name, {})) for body in bodies))

    def _entered(self, origin: Model) -> Iterator[RigidBody]:
        return (_body(table, f"body {table.get('name')!r}", origin) for table in self.entered)


def assemble_present(model: Model) -> System:
    """System of a model whose bodies are on their way, and may be nearer to each other than at a start; raises
    SceneError where two overlap."""
    return assemble(model, _check_places)


def assemble_ever(model: Model) -> System:
    """System of a model whose bodies need not have been there together."""
    return assemble(model, lambda _model, _pose: None)


def _check_places(model: Model, pose: Pose) -> None:
    check_shapes(model.shapes)
    check_places(model, pose)


def require_one_process(backend: FluidBackend) -> None:
    """Raise SceneError where several processes share the run."""
    if backend.ranks.size > 1:
        found = f"{backend.ranks.size} together with bodies that enter or leave"
        raise SceneError("processes", found, "one process", "Run it on one.")


def named_table(body: object) -> Mapping[str, Any]:
    """A body's table as plain values, for a checkpoint; raises SceneError for what is no table with a name."""
    if not isinstance(body, Mapping):
        raise SceneError("body", describe(body), "a mapping of the keys of a [[body]] table", "Give a dict.")
    table = read_table(BodyTable, body, "body")
    if not table.name:
        raise SceneError("body.name", "no name", "a name that no other body of the run has had", "Give one.")
    return table.model_dump(mode="json", exclude_none=True)


def refuse_unknown_name(model: Model, name: str) -> None:
    """Raise SceneError where no body has this name, or no other one would be left."""
    names = [body.name for body in model.bodies]
    if name not in names:
        raise SceneError("body", repr(name), f"a body: {', '.join(names)}", "Name another.")
    if len(names) == 1:
        raise SceneError("body", f"{name!r}, the last one", "another body besides", "Keep it, or end the run.")


def refuse_known_name(population: Population, model: Model, name: str) -> None:
    """Raise SceneError for the name of a body that enters if another one has or had it, or a source will give it:
    results go by names."""
    known = {*model.surfaces, *population.left}
    if name in known or any(source.gives(name) for source in model.source_tables):
        raise SceneError(
            "body.name", repr(name), "a name that no other body or surface of the run has had, or gets", "Change it."
        )


@contextmanager
def subjects_by_name(names: Sequence[str]) -> Iterator[None]:
    """Raise errors about bodies by their ``names``: numbers change as bodies enter and leave."""
    try:
        yield
    except (SceneError, MeshError) as error:
        raise error.renamed(
            lambda subject: re.sub(r"^body\.(\d+)", lambda found: f"body {names[int(found[1])]!r}", subject)
        ) from error


def _body(table: Mapping[str, Any], at: str, model: Model) -> RigidBody:
    return scene_body(read_table(BodyTable, table, at), at, model.registry, model.dimension)


def _place(now: Present, row: int) -> dict[str, Any]:
    """Keys of a body's place and velocity."""
    pose, twist = now.pose, now.twist
    turned = _numbers(pose.orientation[row])
    return {
        "position": _numbers(pose.position[row]),
        **({"angle": turned[0]} if len(turned) == 1 else {"orientation": turned}),
        "velocity": _numbers(twist.velocity[row]),
        "angular_velocity": _numbers(twist.angular_velocity[row]),
    }


def _moved(body: RigidBody, place: Mapping[str, Any]) -> RigidBody:
    """The body at its ``place``, if it is free with its velocities."""
    unread = ("velocity", "angular_velocity") if body.is_prescribed else ()
    keys: dict[str, Any] = {key: _unchanging(value) for key, value in place.items() if key not in unread}
    return replace(body, **keys)


def _unchanging(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _numbers(row: FloatArray) -> tuple[float, ...]:
    return tuple(row.tolist())
