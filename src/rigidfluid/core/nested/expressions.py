"""Formulas of place and time in a scene: read by Python's parser, checked against a short list, evaluated by NumPy."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.scene.validation import LARGEST
from rigidfluid.errors import SceneError

LONGEST, DEEPEST = 1000, 200
"""Greatest number of characters of a formula, and of operations nested within one another."""

_OPERATORS: dict[type[ast.AST], Callable[..., FloatArray]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.USub: np.negative,
    ast.UAdd: np.positive,
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}


def _chosen(condition: FloatArray, then: FloatArray, otherwise: FloatArray) -> FloatArray:
    return np.where(condition != 0.0, then, otherwise)


_FUNCTIONS: dict[str, tuple[int, Callable[..., FloatArray]]] = {
    "sin": (1, np.sin),
    "cos": (1, np.cos),
    "tan": (1, np.tan),
    "tanh": (1, np.tanh),
    "exp": (1, np.exp),
    "log": (1, np.log),
    "sqrt": (1, np.sqrt),
    "abs": (1, np.abs),
    "min": (2, np.minimum),
    "max": (2, np.maximum),
    "where": (3, _chosen),
}
_COORDINATES = ("x", "y", "z")

Names = Mapping[str, FloatArray]
Operation = Callable[[Names], FloatArray]


class Expression:
    """Formula f(t, x) of a scene, or a number: a text such as ``"0.3*sin(pi*t/8)"`` in x, y (z in 3D) [length], t
    [time] and pi.

    ``at`` is its key and ``where`` its place (`` on 'left'``), for messages. Raises SceneError for an invalid formula
    and, when called, for a value that is not finite.
    """

    def __init__(self, source: float | str, at: str, dimension: int, where: str = "") -> None:
        self.source, self.at = source, f"{at}{where}"
        self._value, self.names = _compiled(source, at, (*_COORDINATES[:dimension], "t", "pi"))

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Values (N,) at ``points`` (N, d) [length]."""
        names = dict(zip(_COORDINATES, points.T, strict=False)) | {"t": np.float64(time), "pi": np.float64(np.pi)}
        with np.errstate(all="ignore"):
            found = np.broadcast_to(np.asarray(self._value(names), dtype=float), len(points))
        lost = np.flatnonzero(~(np.abs(found) <= LARGEST))
        if lost.size:
            where = f"at time {time:g}" + (f" and point {points[lost[0]].tolist()}" if points.shape[1] else "")
            remedy = "Write it so that it has a value there, as with max(…) or where(…)."
            allowed = f"finite values, up to {LARGEST:g}"
            raise SceneError(self.at, f"{found[lost[0]]} from {self.source!r} {where}", allowed, remedy)
        return found


@dataclass(frozen=True)
class VectorExpression:
    """A vector of formulas, one for each component."""

    components: tuple[Expression, ...]

    @property
    def names(self) -> frozenset[str]:
        """The names that they use."""
        return frozenset().union(*(component.names for component in self.components))

    @classmethod
    def parse(cls, sources: Sequence[float | str], at: str, where: str = "") -> VectorExpression:
        """Make a vector from d numbers or formulas under the key ``at``; see `Expression`."""
        return cls(tuple(Expression(source, f"{at}.{i}", len(sources), where) for i, source in enumerate(sources)))

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Vectors (N, d) at ``points`` (N, d) [length]."""
        return np.stack([component(time, points) for component in self.components], axis=1)


def formula(source: str, at: str, variable: str) -> Callable[[FloatArray], FloatArray]:
    """Function (N,) → (N,) of one ``variable`` and pi by a ``source`` under the key ``at``; values need not be finite.

    Raises SceneError for an invalid formula.
    """
    evaluate = formula_in(source, at, (variable,))
    return lambda values: evaluate({variable: values})


def formula_in(source: str, at: str, variables: tuple[str, ...]) -> Operation:
    """The same of several ``variables`` by their names, all (N,)."""
    value, _ = _compiled(source, at, (*variables, "pi"))

    def evaluate(values: Names) -> FloatArray:
        with np.errstate(all="ignore"):
            found = np.asarray(value({**values, "pi": np.asarray(np.pi)}), dtype=float)
        return np.broadcast_to(found, values[variables[0]].shape).copy()

    return evaluate


def _compiled(source: float | str, at: str, known: tuple[str, ...]) -> tuple[Operation, frozenset[str]]:
    """Compile a source to a function of the values of ``known`` names, and collect those that it has."""
    if not isinstance(source, str):
        return _constant(source), frozenset()
    text = " ".join(source.split())
    if len(text) > LONGEST:
        raise SceneError(at, f"{len(text)} characters", f"at most {LONGEST}", "Write it shorter, or as `over_time`.")
    try:
        tree = ast.parse(text, mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        place = f", at character {error.offset}" if isinstance(error, SyntaxError) and error.offset else ""
        found = f"{source!r}, which is no formula{place}"
        raise SceneError(at, found, _allowed(known), "Correct it there.") from None
    names = frozenset(node.id for node in ast.walk(tree) if isinstance(node, ast.Name))
    return _Reader(text, at, known).operation(tree.body), names


@dataclass(frozen=True)
class _Reader:
    """Makes operations of the nodes of Python's syntax tree, of those alone that are allowed."""

    text: str
    at: str
    known: tuple[str, ...]

    def operation(self, node: ast.expr, depth: int = 0) -> Operation:
        """Compile a node of the syntax tree to a function of the names' values."""
        if depth > DEEPEST:
            raise self._refusal(node, "nested too deep", "Write it as fewer operations.")
        match node:
            case ast.Constant(value=bool() | complex()):
                pass
            case ast.Constant(value=int() | float() as number):
                return self._number(node, number)
            case ast.Name(id=name):
                return self._name(node, name)
            case ast.UnaryOp(op=ast.Not(), operand=part):
                return _applied(_opposite, [self._condition(part, depth)])
            case ast.BoolOp(op=operator, values=parts):
                joined = _all if isinstance(operator, ast.And) else _any
                return _applied(joined, [self._condition(part, depth) for part in parts])
            case ast.UnaryOp(op=operator, operand=operand) if type(operator) in _OPERATORS:
                return _applied(_OPERATORS[type(operator)], [self.operation(operand, depth + 1)])
            case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
                sides = [self.operation(side, depth + 1) for side in (left, right)]
                return _applied(_OPERATORS[type(operator)], sides)
            case ast.Compare(left=left, ops=operators, comparators=others) if all(
                type(operator) in _OPERATORS for operator in operators
            ):
                sides = [self.operation(side, depth + 1) for side in (left, *others)]
                pairs = zip(operators, sides, sides[1:], strict=False)
                return _applied(_all, [_applied(_OPERATORS[type(op)], [a, b]) for op, a, b in pairs])
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in _FUNCTIONS:
                return self._call(node, name, [self.operation(argument, depth + 1) for argument in arguments])
        powers = isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitXor)
        remedy = "Write ** for powers." if powers else "Use what is allowed alone."
        raise self._refusal(node, "not allowed", remedy)

    def _condition(self, node: ast.expr, depth: int) -> Operation:
        """Compile a comparison, or several that are joined."""
        match node:
            case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
                return self.operation(node, depth + 1)
        raise self._refusal(node, "not a comparison", "Compare it, as in a > 0.")

    def _number(self, node: ast.expr, number: float) -> Operation:
        try:
            return _constant(float(number))
        except OverflowError:
            raise self._refusal(node, "too large", "Choose units in which it is nearer to 1.") from None

    def _name(self, node: ast.expr, name: str) -> Operation:
        if name in self.known:
            return lambda names: names[name]
        if name in _FUNCTIONS:
            raise self._refusal(node, "a function without arguments", f"Write {name}(…).")
        remedy = suggestion(name, [*self.known, *_FUNCTIONS]) or f"The names here are {', '.join(self.known)}."
        raise self._refusal(node, "an unknown name", remedy)

    def _call(self, node: ast.expr, name: str, arguments: list[Operation]) -> Operation:
        count, function = _FUNCTIONS[name]
        several = name in ("min", "max")
        if len(arguments) != count and not (several and len(arguments) > count):
            least = "at least " if several else ""
            raise self._refusal(node, f"{len(arguments)} arguments", f"Give {name} {least}{count}.")
        return _applied((lambda *values: reduce(function, values)) if several else function, arguments)

    def _refusal(self, node: ast.expr, found: str, remedy: str) -> SceneError:
        part = ast.get_source_segment(self.text, node) or self.text
        place = f"{part!r} at character {node.col_offset + 1} of {self.text!r}"
        return SceneError(self.at, f"{found}: {place}", _allowed(self.known), remedy)


def _allowed(known: Sequence[str]) -> str:
    return f"numbers, {', '.join(known)}, + - * / **, < <= > >=, and or not, and {', '.join(_FUNCTIONS)}"


def _constant(number: float) -> Operation:
    value = np.float64(number)
    return lambda names: np.asarray(value)


def _applied(function: Callable[..., FloatArray], arguments: Sequence[Operation]) -> Operation:
    return lambda names: function(*(argument(names) for argument in arguments))


def _all(*conditions: FloatArray) -> FloatArray:
    """1 where all hold, and else 0."""
    return np.asarray(reduce(np.logical_and, conditions), dtype=float)


def _any(*conditions: FloatArray) -> FloatArray:
    """1 where one holds, and else 0."""
    return np.asarray(reduce(np.logical_or, conditions), dtype=float)


def _opposite(condition: FloatArray) -> FloatArray:
    """1 where it does not hold, and else 0."""
    return np.asarray(np.logical_not(condition), dtype=float)
