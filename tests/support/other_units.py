"""Scenes in other units: each key is converted by the unit that its description ends with."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from rigidfluid.core.scene.scene import Scene
from rigidfluid.registry import Registry

Table = dict[str, Any]

_ALSO = {"contact": ("interaction",), "body": ("domain.obstacle", "mechanism.component")}
"""Other tables that name the same parts."""

_POWERS = {"centre": 3, "contact": 3, "normal": 2, "barrier": 1}
"""p of a law's ε, in length^p/force."""


@dataclass(frozen=True)
class Units:
    """Numbers that the old units of ``length``, ``mass`` and ``time`` have in the new ones, in ``dimension`` d."""

    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0
    dimension: int = 2

    def factor(self, unit: str, power: int) -> float:
        """What a number with a ``unit``, as the reference of scenes writes it, is multiplied by."""
        force = self.mass * self.length / self.time**2
        known = {"length": self.length, "mass": self.mass, "time": self.time, "force": force, "rad": 1.0, "s": 1.0}
        product = unit.replace("·", "*").replace("²", "**2").replace("³", "**3").replace("^", "**")
        found = eval(product, known | {"d": self.dimension, "p": power})
        return float(found)


def in_units(scene: Table, units: Units) -> Table:
    """The same scene in other units; files of shapes get a ``scale``, tables over time in files stay as they are."""
    schema = Scene.model_json_schema()
    parts = {(entry.kind.field, entry.name): entry.part.Options for entry in Registry.load().entries}

    def table(given: Table, model: Table, definitions: Table, at: str) -> Table:
        keys = dict(model["properties"])
        law = given.get("law", "")
        for (field, name), options in parts.items():
            place, _, key = field.rpartition(".")
            if at in (place, *_ALSO.get(place, ())) and given.get(key, keys.get(key, {}).get("default")) == name:
                more = options.model_json_schema()
                definitions, keys = definitions | more.get("$defs", {}), keys | more["properties"]
        found = {key: value(key, one, keys[key], definitions, at, law) for key, one in given.items()}
        return found | {"scale": units.length * given.get("scale", 1.0)} if "scale" in keys else found

    def value(key: str, given: Any, field: Table, definitions: Table, at: str, law: str) -> Any:
        if "discriminator" in (each := field.get("items", {})):
            by_type = {kind: definitions[_name(target)] for kind, target in each["discriminator"]["mapping"].items()}
            return [table(one, by_type[one["type"]], definitions, key) for one in given]
        name = _target(field)
        if name and isinstance(given, dict):
            return table(given, definitions[name], definitions, f"{at}.{key}".strip("."))
        if name and key != "over_time":
            return [table(one, definitions[name], definitions, f"{at}.{key}".strip(".")) for one in given]
        if key == "over_time":
            return [[units.time * time, factor] for time, factor in given]
        unit = re.search(r" \[([^]]*)\]$", field.get("description", ""))
        return given if unit is None else _times(units.factor(unit[1], _POWERS.get(law, 0)), given)

    return {key: value(key, given, schema["properties"][key], schema["$defs"], "", "") for key, given in scene.items()}


def _times(factor: float, value: Any) -> Any:
    """Numbers, and lists of them, multiplied; words stay."""
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [_times(factor, one) for one in value]
    return value if isinstance(value, str) else value if factor == 1.0 else factor * value


def _target(field: Table) -> str:
    """Name of the model that a field, or an entry of its list, is a table of; empty for a plain value."""
    for one in (field, field.get("items", {}), *field.get("anyOf", ())):
        if "$ref" in one:
            return _name(one["$ref"])
    return ""


def _name(reference: str) -> str:
    """Name of the model that a schema refers to."""
    return reference.rpartition("/")[2]
