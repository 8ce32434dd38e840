"""Bodies of a run that enter and leave it: which there are, and the model that has those."""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from rigidfluid.core.case.scene_model import scene_body
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.scene.body_tables import BodyTable
from rigidfluid.core.scene.validation import read_table
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.core.setup.changeable import has_links, staying_bodies
from rigidfluid.core.setup.geometry_checks import check_places, overlap
from rigidfluid.core.setup.model import Model
from rigidfluid.core.setup.rigid_body import RigidBody
from rigidfluid.core.setup.shape_checks import check_shapes
from rigidfluid.errors import MeshError, SceneError


@dataclass(frozen=True)
class Present:
    """Pose and twist of single bodies and of mechanisms by ``names``, at a ``time``."""

    time: float
    names: tuple[str, ...]
    pose: Pose
    twist: Twist


@dataclass(frozen=True)
class Population:
    """Changes of the bodies of a run: tables of those that ``entered``, and names of those that ``left``; ``places``:
    keys of place and velocity of bodies and mechanisms that were there at the ``latest`` change, by name; ``since``:
    when each one of those that entered did [time]."""

    entered: tuple[Mapping[str, Any], ...] = ()
    left: tuple[str, ...] = ()
    places: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    since: Mapping[str, float] = field(default_factory=dict)
    latest: float = 0.0

    @classmethod
    def from_dict(cls, stored: Mapping[str, Any]) -> Population:
        """Population as `to_dict` gave it, or its `changes` alone."""
        changes = tuple(stored["entered"]), tuple(stored["gone"])
        return cls(*changes, stored.get("places", {}), stored.get("since", {}), stored.get("latest", 0.0))

    def __bool__(self) -> bool:
        return bool(self.entered or self.left)

    def to_dict(self) -> dict[str, Any]:
        """Values that JSON can hold, for checkpoints."""
        return self.changes | {"places": dict(self.places), "since": dict(self.since), "latest": self.latest}

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
        """Names of all bodies that are or were there, in their order, and of the mechanisms after them."""
        components = (body.name for body in origin.all_bodies[len(origin.bodies) :])
        single = (*(body.name for body in origin.bodies), *(str(table["name"]) for table in self.entered))
        return (*single, *components, *origin.mechanisms_by_name)

    def names(self, origin: Model) -> tuple[str, ...]:
        """Names of the bodies at present, in their order, and of the mechanisms after them."""
        return tuple(name for name in self.known(origin) if name not in self.left)

    def ever(self, origin: Model, names: Container[str]) -> Model:
        """The model of all bodies of these ``names`` that are or were there, as they started; raises as `model`."""
        bodies = (*origin.bodies, *self._entered(origin))
        return origin.with_bodies(tuple(body for body in bodies if body.name in names), origin.mechanisms)

    def placed(self, now: Present) -> Population:
        """One whose latest change is ``now``."""
        places = {name: _place(now, row) for row, name in enumerate(now.names)}
        return replace(self, places=places, latest=now.time)

    def model(self, origin: Model) -> Model:
        """The model at the latest change: bodies of ``origin`` and those that entered, without those that left, in
        their places then; raises SceneError or PluginError for a table that is wrong."""
        bodies = [body for body in (*origin.bodies, *self._entered(origin)) if body.name not in self.left]
        placed = tuple(replace(one, **_keys(self.places.get(one.name, {}))) for one in origin.mechanisms)
        return origin.with_bodies(tuple(_moved(body, self.places.get(body.name, {})) for body in bodies), placed)

    def _entered(self, origin: Model) -> Iterator[RigidBody]:
        return (_body(table, f"body {table.get('name')!r}", origin) for table in self.entered)


def assemble_present(origin: Model, model: Model, population: Population) -> System:
    """System of the ``model`` of a ``population`` of the model ``origin``, whose bodies are on their way and may be
    nearer to each other than at a start; raises SceneError where two overlap. Joints and springs are those of the
    start."""
    started = population.ever(origin, population.names(origin)) if has_links(model) else None
    return assemble(model, _check_places, started, population.latest)


def assemble_ever(model: Model) -> System:
    """System of a model whose bodies need not have been there together."""
    return assemble(model, lambda _model, _pose: None)


def _check_places(model: Model, pose: Pose) -> None:
    check_shapes(model.shapes)
    check_places(model, pose, refusal=partial(_refusal, model))


def _refusal(model: Model, a: int, b: int, depth: float) -> SceneError:
    """Error of two surfaces that overlap so deep: of two single bodies that of the later one, which has entered, and of
    one at an open end how it may leave [length]."""
    if b < len(model.bodies):
        return overlap(model, b, a, depth)
    name, held = model.surfaces[b], b < len(model.all_bodies) or b in (wall.surface for wall in model.walls)
    remedy = "" if held else f"Nothing holds it there: let it leave before, by a [[sink]] with on = {name!r}."
    return overlap(model, a, b, depth, remedy)


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
    for key in ("spring", "free"):
        if getattr(table, key) is not None:
            found, allowed = "one of a body that enters", "none: only bodies of the start are held"
            raise SceneError(f"body.{key}", found, allowed, f"Leave {key!r} out.")
    return table.model_dump(mode="json", exclude_none=True)


def refuse_staying(model: Model, name: str) -> None:
    """Raise SceneError where no body has this name, it is held, or no other one would be left."""
    staying, known = staying_bodies(model), [body.name for body in model.all_bodies]
    if name not in known or name in staying:
        found = f"{name!r}, which a joint, a spring or a mechanism holds" if name in staying else repr(name)
        names = ", ".join(one for one in known if one not in staying)
        raise SceneError("body", found, f"a body that may leave: {names or 'there is none'}", "Name another.")
    if len(known) == 1:
        raise SceneError("body", f"{name!r}, the last one", "another body besides", "Keep it, or end the run.")


def refuse_known_name(population: Population, model: Model, name: str) -> None:
    """Raise SceneError for the name of a body that enters if another one has or had it, or a source will give it:
    results go by names."""
    if name in (joint.name for joint in model.joints):
        raise SceneError("body.name", f"{name!r}, the name of a joint", "a name that no joint has", "Change it.")
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
    """The body at its ``place``, if it is free with its velocities, which have no rounding in held directions."""
    keys = _keys(place)
    if body.is_prescribed:
        keys = {key: value for key, value in keys.items() if "velocity" not in key}
    elif keys and body.free is not None:
        d = body.shape.dimension
        twist = np.where(body.held_directions, 0.0, np.append(keys["velocity"], keys["angular_velocity"])).tolist()
        keys |= {"velocity": tuple(twist[:d]), "angular_velocity": tuple(twist[d:])}
    return replace(body, **keys)


def _keys(place: Mapping[str, Any]) -> dict[str, Any]:
    return {key: _unchanging(value) for key, value in place.items()}


def _unchanging(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _numbers(row: FloatArray) -> tuple[float, ...]:
    return tuple(row.tolist())
