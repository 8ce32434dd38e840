"""Values for a place in a scene: those that the JSON Schema of scenes allows there, and those that nobody means."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hypothesis import strategies as st

from rigidfluid.core.case.schema import json_schema

Schema = Mapping[str, Any]

DIMENSION = 2
"""Space dimensions of generated scenes."""

_DEEP = 4
"""Tables within tables that are filled; below them only what is required."""

_NUMBERS = [
    0,
    -0.0,
    1,
    -1,
    2,
    3,
    7,
    1e-3,
    -1e-3,
    1e-9,
    1e-16,
    1e-29,
    1e3,
    1e9,
    1e16,
    1e29,
    -1e29,
    2**31,
    2**63,
    -(2**63),
]
_NO_NUMBERS = [1e31, 1e308, 5e-324, float("nan"), float("inf"), float("-inf"), 10**40, 10**400, -(10**4000)]
_TEXTS = [
    "",
    " ",
    "auto",
    "x" * 5000,
    "\0",
    "a.b",
    "0",
    "../..",
    "/dev/zero",
    "é\u202e",
    "[bold]",
    "$\\frac$",
    "\ud800",
]
_OTHERS: list[Any] = [
    None,
    True,
    False,
    [],
    {},
    [[]],
    [{}],
    {"": 1},
    {"type": "sphere"},
    [None, None],
    [float("nan")] * 2,
]
_DEEP_LIST: list[Any] = []
for _ in range(200):
    _DEEP_LIST = [_DEEP_LIST]

numbers = st.one_of(
    st.sampled_from(_NUMBERS), st.floats(-10.0, 10.0), st.floats(-1e30, 1e30), st.integers(-(2**70), 2**70)
)
"""Numbers of all sizes that a scene may have."""

vectors = st.lists(numbers, max_size=5)

hostile_values = st.one_of(
    numbers,
    st.sampled_from(_NO_NUMBERS),
    st.sampled_from(_TEXTS),
    st.text(max_size=20),
    st.sampled_from([*_OTHERS, _DEEP_LIST]),
    vectors,
    st.lists(vectors, max_size=4),
)
"""Values that no place in a scene asks for."""

formulas = st.builds(
    "{}{}{}".format,
    st.sampled_from(["t", "x", "y", "sin(t)", "1", "(", "exp(x*y)", "sqrt(-1)", "t**t", "__import__('os')", "9" * 400]),
    st.sampled_from(["+", "-", "*", "/", "**", "%", " ", ".", ";", ","]),
    st.sampled_from(["t", "x", "0", "1e300", ")", "open('f')", "lambda: 0", "t" * 3000, "y[0]", "abs(t)"]),
)


class SchemaValues:
    """Strategies for the tables and keys of the JSON Schema of scenes, with those of all parts that are installed."""

    def __init__(self) -> None:
        self.schema = json_schema()

    def scene(self) -> st.SearchStrategy[dict[str, Any]]:
        """Whole scenes, right table by table and seldom as wholes."""
        named = {"name": "generated", "dimension": DIMENSION}
        return self.values(self.schema).map(lambda tables: tables | {"scene": named})

    def values(self, schema: Schema, depth: int = 0) -> st.SearchStrategy[Any]:
        """Values that one schema, or nearly, allows."""
        schema = self._resolved(schema)
        options = schema.get("anyOf") or schema.get("oneOf")
        if options:
            return st.one_of([self.values(option, depth) for option in options])
        if "enum" in schema or "const" in schema:
            return st.sampled_from(schema.get("enum", [schema.get("const")]))
        kinds = {"object": self._tables, "array": self._lists, "number": _floats, "integer": _integers}
        if (kind := schema.get("type")) in kinds:
            return kinds[kind](schema, depth)
        return {"string": st.one_of(st.text(max_size=8), formulas), "boolean": st.booleans(), "null": st.none()}.get(
            str(kind), hostile_values
        )

    def keys_of(self, schema: Schema) -> dict[str, Schema]:
        """The keys of a table, with those of all parts that it may name."""
        found = dict(schema.get("properties", {}))
        for condition in schema.get("allOf", []):
            found.update(condition.get("then", {}).get("properties", {}))
        return found

    def at(self, path: tuple[str | int, ...]) -> Schema:
        """The schema of a place in a scene; empty where there is none."""
        schema: Schema = self.schema
        for key in path:
            schema = self._inner(self._resolved(schema), key)
        return self._resolved(schema)

    def _inner(self, schema: Schema, key: str | int) -> Schema:
        options = [self._resolved(option) for option in schema.get("anyOf") or schema.get("oneOf") or [schema]]
        for option in options:
            if isinstance(key, int) and "items" in option:
                items = option["items"]
                return dict(items[min(key, len(items) - 1)] if isinstance(items, list) else items)
            if key in self.keys_of(option):
                return self.keys_of(option)[str(key)]
        return {}

    def _resolved(self, schema: Schema) -> Schema:
        while "$ref" in schema:
            schema = self.schema["$defs"][schema["$ref"].rpartition("/")[2]]
        return schema

    def _tables(self, schema: Schema, depth: int) -> st.SearchStrategy[Any]:
        """One of the parts that a table may name, with the table's own keys and the part's."""
        parts = [one for one in schema.get("allOf", ()) if "then" in one] or [{}]
        return st.sampled_from(parts).flatmap(lambda part: self._table_with(schema, part, depth))

    def _table_with(self, schema: Schema, part: Schema, depth: int) -> st.SearchStrategy[Any]:
        then = self._resolved(part.get("then", {}))
        theirs = {key for one in schema.get("allOf", ()) for key in one.get("else", {}).get("properties", {})}
        own = {key: value for key, value in schema.get("properties", {}).items() if key not in theirs}
        if "additionalProperties" in then:  # it has all keys of its type
            own = {}
        named = {key: st.just(given["const"]) for key, given in part.get("if", {}).get("properties", {}).items()}
        known = {**own, **then.get("properties", {})}
        required = {*schema.get("required", []), *then.get("required", [])}
        strategies = {
            key: named[key] if key in named else self.values(inner, depth + 1) for key, inner in known.items()
        }
        needed = {key: strategies[key] for key in strategies if key in required or key in named}
        free = {key: strategies[key] for key in strategies if key not in needed} if depth < _DEEP else {}
        return st.fixed_dictionaries(needed, optional=free)

    def _lists(self, schema: Schema, depth: int) -> st.SearchStrategy[Any]:
        if isinstance(schema.get("items"), list):
            return st.tuples(*(self.values(item, depth) for item in schema["items"])).map(list)
        if self._resolved(schema.get("items", {})).get("type") == "number" and "minItems" not in schema:
            return st.lists(self.values(schema["items"], depth), min_size=DIMENSION, max_size=DIMENSION)
        least, most = schema.get("minItems", 0), min(schema.get("maxItems", 3), 3)
        return st.lists(self.values(schema.get("items", {}), depth + 1), min_size=least, max_size=max(least, most))


def _floats(schema: Schema, _: int) -> st.SearchStrategy[float]:
    least, most = _bounds(schema)
    return st.one_of(st.floats(max(least, -10.0), min(most, 10.0)), st.floats(max(least, -1e30), min(most, 1e30)))


def _integers(schema: Schema, _: int) -> st.SearchStrategy[int]:
    least, most = _bounds(schema)
    lowest = int(max(least, -5))
    return st.integers(lowest, int(min(most, max(lowest, 40))))


def _bounds(schema: Schema) -> tuple[float, float]:
    least = schema.get("minimum", schema.get("exclusiveMinimum", -1e30))
    most = schema.get("maximum", schema.get("exclusiveMaximum", 1e30))
    return float(least), float(most)
