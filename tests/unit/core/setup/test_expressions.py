"""Formulas in scenes: what they compute, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest

from rigidfluid.core.nested.expressions import LONGEST, Expression, VectorExpression
from rigidfluid.errors import SceneError

POINTS = np.array([[0.0, 0.5], [1.0, -0.25], [2.0, 4.0]])
X, Y = POINTS.T


@pytest.mark.parametrize(
    ("text", "expected"),
    {
        "1 + 2*3 - 4/8": np.full(3, 6.5),
        "-x**2": -(X**2),
        "2**3**2 / 2**9": np.ones(3),
        "+y*t": 3.0 * Y,
        "6*y*(0.41 - y)/0.41**2 * sin(pi*t/8)": 6 * Y * (0.41 - Y) / 0.41**2 * np.sin(np.pi * 3 / 8),
        "exp(-x) + cos(y) + tan(y) + tanh(y) + abs(y)": np.exp(-X) + np.cos(Y) + np.tan(Y) + np.tanh(Y) + np.abs(Y),
        "sqrt(x) + log(x + 1)": np.sqrt(X) + np.log(X + 1),
        "min(x, 1) + max(0, y, t)": np.minimum(X, 1) + np.maximum(Y, 3),
        "where(0 < y <= 1, x, -x)": np.array([0.0, -1.0, -2.0]),
        "where(x > 0, 1/x, 0)": np.array([0.0, 1.0, 0.5]),
        "-(x >= 1) + (x < 1)": np.array([1.0, -1.0, -1.0]),
        "x\n  + y": X + Y,
        "(x > 0 and y > 0) + 2*(x > 0 or y > 0)": np.array([2.0, 2.0, 3.0]),
        "where(not x > 0 and not (y > 1 or y < 0), t, 2)": np.array([3.0, 2.0, 2.0]),
    }.items(),
)
def test_values(text: str, expected: np.ndarray) -> None:
    np.testing.assert_allclose(Expression(text, "a", 2)(3.0, POINTS), expected, rtol=1e-15)


def test_a_number_is_the_same_everywhere() -> None:
    np.testing.assert_array_equal(Expression(0.3, "a", 2)(1.0, POINTS), [0.3, 0.3, 0.3])


def test_a_vector_has_its_components() -> None:
    found = VectorExpression.parse(["z", 1.0, "t"], "a")(2.0, np.array([[0.0, 0.0, 5.0]]))
    np.testing.assert_array_equal(found, [[5.0, 1.0, 2.0]])


BAD = {
    "unknown name": ("sin(x) + yy", "an unknown name: 'yy' at character 10", "Did you mean 'y'"),
    "function alone": ("2*sin", "a function without arguments: 'sin' at character 3", r"Write sin\(…\)."),
    "no z in 2D": ("x + z", "an unknown name: 'z'", "x, y, t, pi"),
    "unknown function": ("sinh(x)", "not allowed: 'sinh(x)'", "Use what is allowed"),
    "caret": ("x^2", "not allowed: 'x^2'", r"\*\* for powers"),
    "no formula": ("2*(x", "no formula, at character 3", "Correct"),
    "empty": ("", "no formula", "Correct"),
    "two statements": ("x; y", "no formula, at character 2", "Correct"),
    "attribute": ("x.real", "not allowed: 'x.real'", "allowed"),
    "import": ("__import__('os')", "not allowed", "allowed"),
    "lambda": ("(lambda: 1)()", "not allowed", "allowed"),
    "comprehension": ("[x for x in y]", "not allowed", "allowed"),
    "text": ("'a'*9", "not allowed: \"'a'\"", "allowed"),
    "truth": ("True", "not allowed: 'True'", "allowed"),
    "imaginary": ("1j", "not allowed: '1j'", "allowed"),
    "number for a condition": ("x > 0 and y", "not a comparison: 'y' at character 11", "a > 0"),
    "negated number": ("not x", "not a comparison: 'x' at character 5", "a > 0"),
    "bits": ("1 << 9", "not allowed", "allowed"),
    "keyword": ("sin(x=1)", "not allowed", "allowed"),
    "too few arguments": ("where(x, 1)", "2 arguments", "Give where 3"),
    "one to choose from": ("min(x)", "1 arguments", "at least 2"),
    "a large number": ("1" + "0" * 400, "too large", "units"),
    "long": ("1+" * LONGEST + "1", f"{2 * LONGEST + 1} characters", "shorter"),
    "deep": ("-" * 500 + "1", "nested too deep", "fewer"),
    "brackets": ("(" * 400 + "1" + ")" * 400, "no formula", "Correct"),
}


@pytest.mark.parametrize(("text", "found", "remedy"), BAD.values(), ids=BAD.keys())
def test_refused_when_read(text: str, found: str, remedy: str) -> None:
    with pytest.raises(SceneError, match=r"boundary\.0\.velocity\.1: ") as raised:
        Expression(text, "boundary.0.velocity.1", 2)
    assert found in str(raised.value)
    assert re.search(remedy, raised.value.remedy)


@pytest.mark.parametrize("text", ["1/x", "log(x)", "(x - 1)**0.5", "9**9**9", "exp(1e3)", "0*(1/x)", "1e31"])
def test_a_value_that_is_not_finite_is_refused_with_its_place(text: str) -> None:
    expression = Expression(text, "boundary.0.pressure", 2, " on 'left'")
    with pytest.raises(SceneError, match=r"boundary\.0\.pressure on 'left': .* at time 7 and point \[0\.0, 0\.5\]"):
        expression(7.0, POINTS)
