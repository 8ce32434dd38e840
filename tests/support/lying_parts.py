"""Parts that lie: built-in ones, of each kind, of which one answer is not what it should be."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from rigidfluid.backends.dry import Dry
from rigidfluid.backends.scikit_fem.backend import ScikitFem
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.joints.constraints import Constraint, SamePoint
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.mechanism import Component, Mechanism
from rigidfluid.core.model.part import Part
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.domains.box import Box
from rigidfluid.errors import SceneError, StepRejected
from rigidfluid.joints.hinge import Hinge
from rigidfluid.registry import (
    BODY,
    DETECTOR,
    DOMAIN,
    FLUID_BACKEND,
    FORCE_LAW,
    JOINT,
    MECHANISM,
    SIZE_FIELD,
    Entry,
    Kind,
)

Change = Callable[[Any], Any]


class Springy(ForceLaw):
    """A spring and a dashpot, honest."""

    name = "springy"
    dissipative = True

    def force(self, contacts: Any) -> Any:
        return 1e3 * np.maximum(self.range - contacts.gap, 0.0)[:, None] * contacts.normal

    def energy(self, contacts: Any) -> Any:
        return 0.5e3 * np.maximum(self.range - contacts.gap, 0.0) ** 2

    def stiffness(self, contacts: Any) -> Any:
        return np.where(contacts.gap < self.range, 1e3, 0.0)

    def damping(self, contacts: Any, motion: Any) -> Any:
        return -np.where(contacts.gap < self.range, 1e-3, 0.0)[:, None] * motion.velocity


class Dumbbell(Mechanism):
    """Two balls whose distance grows, honest."""

    name = "dumbbell"
    driven = True

    @cached_property
    def components(self) -> Any:
        ball = Sphere(Sphere.Options(radius=0.1), self.dimension)
        return [Component(name, ball, 1.0) for name in ("left", "right")]

    def placement(self, time: float) -> Any:
        return Pose(np.array([[-0.2 - 0.1 * time, 0.0], [0.2 + 0.1 * time, 0.0]]), np.zeros((2, 1)))

    def rate(self, time: float) -> Any:
        return Twist(np.array([[-0.1, 0.0], [0.1, 0.0]]), np.zeros((2, 1)))

    def next_corner(self, time: float) -> Any:
        return super().next_corner(time)

    @property
    def period(self) -> Any:
        return None


def raising(error: BaseException) -> Change:
    def lie(_: Any) -> Any:
        raise copy(error)

    return lie


class Wordless(Exception):
    """An error that has no words."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


def everywhere(value: float) -> Change:
    return lambda answer: np.full_like(answer, value) if isinstance(answer, np.ndarray) else value


ANY: dict[str, Change] = {
    "text": lambda _: "a lie",
    "number": lambda _: 1j,
    "class": type,
    "ValueError": raising(ValueError("a lie")),
    "KeyError": raising(KeyError("a lie")),
    "SystemExit": raising(SystemExit(0)),
}
NONE: dict[str, Change] = {"None": lambda _: None}
RAISED: dict[str, Change] = {
    "Wordless": raising(Wordless()),
    "GeneratorExit": raising(GeneratorExit()),
    "MemoryError": raising(MemoryError()),
    "SceneError": raising(SceneError("body", 1, "another", "Lie on.")),
    "StepRejected": raising(StepRejected("a step", 1, "another", "Lie on.")),
}
ROWS: dict[str, Change] = (
    ANY
    | NONE
    | {
        "list": lambda answer: answer.tolist(),
        "complex": lambda answer: answer.astype(complex),
        "object": lambda answer: answer.astype(object),
        "matrix": lambda answer: answer.view(np.matrix),
        "masked": lambda answer: np.ma.array(answer, mask=True),
        "shape": lambda answer: np.concatenate([answer, answer])[..., None],
        "NaN": everywhere(np.nan),
        "infinite": everywhere(np.inf),
    }
)
NUMBER: dict[str, Change] = (
    ANY
    | NONE
    | {
        "list": lambda answer: [answer],
        "NaN": everywhere(np.nan),
        "infinite": everywhere(np.inf),
        "negative": lambda answer: -answer,
    }
)
DETECTED: dict[str, Change] = (
    ANY
    | NONE
    | {
        "list": lambda answer: [answer],
        "blind": lambda answer: select(answer, np.zeros(len(answer), dtype=bool)),
        "doubled": lambda answer: select(answer, np.repeat(np.arange(len(answer)), 2)),
        "half blind": lambda answer: select(answer, np.arange(1, len(answer))),
        "flipped": lambda answer: replace(answer, normal=-answer.normal),
        "exchanged": lambda answer: replace(answer, point_a=answer.point_b, point_b=answer.point_a),
        "long normals": lambda answer: replace(answer, normal=2.0 * answer.normal),
        "backwards": lambda answer: select(answer, np.arange(len(answer))[::-1]),
        "farther": lambda answer: replace(
            answer, gap=1.5 * answer.gap, point_a=answer.point_a + 0.5 * answer.gap[:, None] * answer.normal
        ),
        "body of no number": lambda answer: replace(answer, body_a=answer.body_a - 100),
        "surface of no number": lambda answer: replace(answer, body_b=answer.body_b + 100),
        "walls as bodies": lambda answer: replace(answer, at_wall=~answer.at_wall),
        "gaps beyond": lambda answer: replace(answer, gap=answer.gap[:1]),
        "points lost": lambda answer: replace(answer, point_a=answer.point_a * np.nan),
        "gaps lost": lambda answer: replace(answer, gap=answer.gap * np.nan),
        "normals endless": lambda answer: replace(answer, normal=answer.normal * np.inf),
        "text gaps": lambda answer: replace(answer, gap="a lie"),
        "complex gaps": lambda answer: replace(answer, gap=answer.gap * 1j),
        "objects": lambda answer: replace(answer, body_b=answer.body_b.astype(object)),
        "flat": lambda answer: replace(answer, normal=answer.normal.ravel()),
    }
)
STATE: dict[str, Change] = (
    ANY
    | NONE
    | {
        "list": list,
        "NaN energy": lambda answer: (answer[0], np.nan),
        "text energy": lambda answer: (answer[0], "a lie"),
        "state": lambda answer: (None, answer[1]),
        "objects": lambda answer: ({"u": np.array([None])}, answer[1]),
    }
)
STEP: dict[str, Change] = (
    ANY
    | NONE
    | {
        "lost": lambda answer: replace(
            answer, twist=Twist(answer.twist.velocity * np.nan, answer.twist.angular_velocity)
        ),
        "one body": lambda answer: replace(
            answer, twist=Twist(answer.twist.velocity[:1], answer.twist.angular_velocity)
        ),
        "no twist": lambda answer: replace(answer, twist=None),
        "complex": lambda answer: replace(
            answer, twist=Twist(answer.twist.velocity * 1j, answer.twist.angular_velocity)
        ),
        "NaN energy": lambda answer: replace(answer, kinetic_energy=np.nan),
        "no energy": lambda answer: replace(answer, kinetic_energy=None),
        "rows of power": lambda answer: replace(answer, boundary_power=np.zeros(2)),
        "no wrench": lambda answer: replace(answer, hydrodynamic_wrench=None),
        "link forces": lambda answer: replace(answer, link_force=np.zeros(7)),
        "state": lambda answer: replace(answer, fluid=[1.0]),
    }
)
LIST: dict[str, Change] = (
    ANY | NONE | {"empty": lambda _: [], "texts": lambda _: ["a lie"], "classes": lambda a: [type(a[0])]}
)
POSE: dict[str, Change] = (
    ANY
    | NONE
    | {
        "list": lambda answer: [answer],
        "one body": lambda answer: type(answer)(*(getattr(answer, name)[:1] for name in answer.__slots__)),
        "NaN": lambda answer: type(answer)(*(getattr(answer, name) * np.nan for name in answer.__slots__)),
        "texts": lambda answer: type(answer)("a", "lie"),
    }
)
CHANGES: dict[tuple[Kind[Any], type[Part], str], dict[str, Change]] = {
    (FORCE_LAW, Springy, "force"): ROWS
    | RAISED
    | {
        "half": lambda answer: 0.5 * answer,
        "askew": lambda answer: answer[:, ::-1] + 1.0,
        "across": lambda answer: answer + 0.1 * answer[:, ::-1] * [-1.0, 1.0],
    },
    (FORCE_LAW, Springy, "energy"): ROWS
    | {"negative": lambda answer: -answer, "constant": lambda answer: 0.0 * answer},
    (FORCE_LAW, Springy, "stiffness"): ROWS
    | {"negative": lambda answer: -answer, "double": lambda answer: 2.0 * answer},
    (FORCE_LAW, Springy, "damping"): ROWS | {"driving": lambda answer: -answer},
    (FORCE_LAW, Springy, "ranges"): {
        "None": lambda _: None,
        "negative": lambda _: (-1.0,),
        "texts": lambda _: ("a lie",),
    },
    (DETECTOR, SphereDetector, "detect"): DETECTED | RAISED,
    (DETECTOR, SphereDetector, "exact_for"): {"number": lambda _: 3, "ValueError": ANY["ValueError"]},
    (DETECTOR, SphereDetector, "preferred_reach"): NUMBER | {"infinite": lambda _: "inf"},
    (BODY, Sphere, "volume"): NUMBER | {"double": lambda answer: 2.0 * answer, "half": lambda answer: 0.5 * answer},
    (BODY, Sphere, "bounding_radius"): NUMBER | {"half": lambda answer: 0.5 * answer},
    (BODY, Sphere, "radius"): {key: lie for key, lie in NUMBER.items() if key != "None"},
    (BODY, Sphere, "unit_inertia"): ROWS | {"negative": lambda answer: -answer, "large": lambda answer: 9.0 * answer},
    (BODY, Sphere, "signed_distance"): ROWS
    | {"inside": lambda answer: answer - 10.0, "flipped": lambda answer: -answer, "short": lambda answer: 0.9 * answer},
    (BODY, Sphere, "closest_point"): ROWS | RAISED | {"centre": lambda answer: 0.0 * answer},
    (BODY, Sphere, "sample_surface"): ROWS | {"none": lambda answer: answer[:0]},
    (DOMAIN, Box, "pieces"): LIST,
    (DOMAIN, Box, "extent"): ANY
    | NONE
    | {"swapped": lambda answer: answer[::-1], "lists": lambda answer: tuple(map(list, answer))},
    (DOMAIN, Box, "volume"): NUMBER,
    (MECHANISM, Dumbbell, "components"): LIST,
    (MECHANISM, Dumbbell, "placement"): POSE,
    (MECHANISM, Dumbbell, "rate"): POSE,
    (MECHANISM, Dumbbell, "next_corner"): NUMBER | {"infinite": lambda _: "inf", "negative": lambda _: -1.0},
    (MECHANISM, Dumbbell, "period"): {key: lie for key, lie in NUMBER.items() if key not in ("None", "negative")},
    (JOINT, Hinge, "constraints"): LIST,
    (JOINT, Hinge, "springs"): {key: lie for key, lie in LIST.items() if key not in ("empty", "classes")},
    (JOINT, Hinge, "axes"): ROWS,
    (FLUID_BACKEND, Dry, "initial"): STATE | {"negative energy": lambda answer: (answer[0], -1.0)},
    (FLUID_BACKEND, Dry, "advance"): STEP
    | RAISED
    | {"negative energy": lambda answer: replace(answer, kinetic_energy=-1.0)},
    (FLUID_BACKEND, Dry, "unknowns"): NUMBER | {"negative": lambda _: -7},
    (FLUID_BACKEND, Dry, "memory"): {
        key: lie for key, lie in STATE.items() if "energy" not in key and key not in ("state", "objects")
    },
}
"""Lies by kind, honest part and method."""
PAIR: dict[str, Change] = (
    ANY
    | NONE
    | {
        "one": lambda answer: answer[:1],
        "lists": lambda answer: tuple(each.tolist() for each in answer),
        "NaN": lambda answer: (answer[0] * np.nan, answer[1]),
        "shapes": lambda answer: (answer[0][:1], answer[1]),
        "flat": lambda answer: (answer[0].ravel(), answer[1]),
    }
)
CONSTRAINED: dict[str, dict[str, Change]] = {
    "directions": PAIR,
    "misfit": ROWS,
    "compliance": ROWS | {"negative": lambda answer: answer - 1.0},
    "rate": ROWS,
    "levers": ROWS,
}
"""Lies of a constraint, by method."""
WET: dict[str, dict[str, Change]] = {
    "initial": {key: STATE[key] for key in ("None", "text", "NaN energy", "state", "KeyError")},
    "advance": {key: STEP[key] for key in ("None", "lost", "no twist", "no energy", "ValueError")},
    "fields": ANY | NONE,
    "probe": {key: PAIR[key] for key in ("None", "one", "lists", "NaN")},
}
"""Lies of a backend with a fluid, by method."""
SIZED: dict[str, Change] = ROWS | {"negative": lambda answer: -answer}
"""Lies of a size field."""
MADE: dict[tuple[Kind[Any], type[Part]], dict[str, Any]] = {
    (FORCE_LAW, Springy): {"range": np.nan, "range twice": "a lie", "overlap": "a lie", "conservative": None},
    (DETECTOR, SphereDetector): {"bodies": None},
    (BODY, Sphere): {"dimension": "a lie"},
    (DOMAIN, Box): {"periodic": "a lie"},
    (MECHANISM, Dumbbell): {"driven": "a lie"},
    (JOINT, Hinge): {"coordinate": "a lie", "drive": "a lie"},
}
"""Attributes of another type, once a part is made."""


@dataclass(frozen=True)
class Lie:
    """A class of a kind that lies by a method or attribute ``key``, and who is ``told``: another, of which it is made,
    if so."""

    kind: Kind[Any]
    part: type[Part]
    key: str
    liar: str = ""

    @property
    def told(self) -> str:
        return self.liar or f"{self.kind.title} {self.part.name!r}"

    @property
    def entry(self) -> Entry:
        return Entry(self.kind, self.part.name, self.part, "liars 1", True, "")


def lies() -> Iterator[Lie]:
    """Lies of parts that are asked where there is no fluid as well."""
    for (kind, base, key), changes in CHANGES.items():
        for name, change in changes.items():
            yield Lie(kind, _derived(base, f"{key}: {name}", {key: _changed(_member(base, key), change)}), key)
    for (kind, base), values in MADE.items():
        for name, value in values.items():
            key = name.split()[0]
            yield Lie(kind, _derived(base, f"attribute {name}", {"__init__": _setting(base, key, value)}), key)
        made = {
            "ValueError": _failing(ValueError("a lie")),
            "SystemExit": _failing(SystemExit(0)),
            "Nothing": lambda *_: None,
        }
        for name, init in made.items():
            yield Lie(kind, _derived(base, f"{name} when made", {"__init__": init}), "__init__")


def constraint_lies() -> Iterator[Lie]:
    """Lies of constraints, each in a joint."""
    for key, changes in CONSTRAINED.items():
        for name, change in changes.items():
            point = _derived(SamePoint, f"{key}: {name}", {key: _changed(_member(SamePoint, key), change)})
            joint = _derived(Hinge, f"with {key}: {name}", {"held": _holding(point)})
            yield Lie(JOINT, joint, key, f"constraint {point.name!r}")


def wet_lies() -> Iterator[Lie]:
    """Lies of parts that are asked where there is a fluid alone."""
    for key, changes in WET.items():
        for name, change in changes.items():
            part = _derived(ScikitFem, f"{key}: {name}", {key: _changed(_member(ScikitFem, key), change)})
            yield Lie(FLUID_BACKEND, part, key)
    for name, change in SIZED.items():
        even = {"edge_length": _changed(lambda _, points, around, flow: np.ones(len(points)), change)}
        yield Lie(SIZE_FIELD, _derived(SizeField, f"edge_length: {name}", even), "edge_length")


def _holding(point: type[Constraint]) -> Any:
    return lambda joint, name, markers: [point(name, markers, np.eye(joint.dimension))]


def _member(cls: type, key: str) -> Any:
    return next(vars(base)[key] for base in cls.__mro__ if key in vars(base))


def _derived(base: type[Part], name: str, namespace: dict[str, Any]) -> Any:
    return type(base)("Liar", (base,), {"name": f"{getattr(base, 'name', base.__name__)} {name}", **namespace})


def _changed(honest: Any, change: Change) -> Any:
    if isinstance(honest, property):
        return property(lambda part: change(honest.fget(part)))
    if isinstance(honest, cached_property):
        return property(lambda part: change(honest.func(part)))
    if isinstance(honest, classmethod):
        return classmethod(lambda part, *given: change(honest.__func__(part, *given)))
    return lambda part, *given: change(honest(part, *given))


def _setting(base: type[Part], key: str, value: Any) -> Any:
    def init(part: Any, *given: Any) -> None:
        base.__init__(part, *given)
        setattr(part, key, value)

    return init


def _failing(error: BaseException) -> Any:
    def init(*_: Any) -> None:
        raise error

    return init
