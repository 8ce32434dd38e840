"""Functions in Python that raise, when a model is made or in its run: errors name what they were given for."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from scenes import wet_tables

import rigidfluid
from rigidfluid.api import Model, NoSlip, PrescribedPressure, PrescribedVelocity, Scalar, model_of, scene_from_dict
from rigidfluid.core.geometry.given_function import GivenFunction
from rigidfluid.core.setup.fluid import Fluid
from rigidfluid.core.setup.scalar import ScalarOnSurface
from rigidfluid.errors import SceneError

BALL = {"type": "sphere", "radius": 0.15, "density": 2.0, "position": [0.5, 0.5]}


def failing(*given: Any, shape: tuple[int, ...], since: float) -> Any:
    """Zeros of the points' number and ``shape``, from a time on an error."""
    time = given[0] if len(given) > 1 else np.inf
    if time >= since:
        return {}["no such"]
    return np.zeros((len(given[-1]), *shape))


def model_with(given: str, since: float) -> Model:
    """A ball in a box, with one function that raises."""
    made = model_of(scene_from_dict(wet_tables(BALL, end=0.02, step=0.01, mesh={"size": 0.4, "size_body": 0.2})))
    vector, number = (partial(failing, shape=shape, since=since) for shape in ((2,), ()))
    fluid = made.fluid
    assert isinstance(fluid, Fluid)
    match given:
        case "force":
            return replace(made, fluid=replace(fluid, source=vector))
        case "initial":
            return replace(made, fluid=replace(fluid, initial=vector))
        case "velocity":
            return replace(made, boundary={"left": partial(PrescribedVelocity, value=vector)})
        case "pressure":
            return replace(made, boundary={"left": partial(PrescribedPressure, value=number)})
        case "sliding":
            return replace(made, boundary={"left": partial(NoSlip, sliding=vector)})
        case "scalar":
            return replace(made, fluid=replace(fluid, scalar=Scalar(0.1, number)))
        case _:
            on = {"left": ScalarOnSurface(value=number)}
            return replace(made, fluid=replace(fluid, scalar=Scalar(0.1, lambda _, at: np.zeros(len(at)), on_faces=on)))


KEYS = {
    "force": r"fluid\.force",
    "initial": r"fluid\.initial",
    "velocity": r"boundary\.value on 'left'",
    "pressure": r"boundary\.value on 'left'",
    "sliding": r"boundary\.sliding on 'left'",
    "scalar": r"scalar\.initial",
    "held": r"scalar\.value",
}


@pytest.mark.parametrize("given", KEYS)
def test_an_error_at_any_time_names_key_error_and_line(given: str) -> None:
    told = rf"{KEYS[given]}: found KeyError: 'no such', raised in module .*test_given_functions, line \d+; allowed is"
    with pytest.raises(SceneError, match=told):
        rigidfluid.run(model_with(given, since=0.0))


@pytest.mark.parametrize("given", ["force", "velocity", "pressure", "held"])
def test_an_error_within_a_run_is_told_alike(given: str) -> None:
    with pytest.raises(SceneError, match=rf"{KEYS[given]}: found KeyError: 'no such'"):
        rigidfluid.run(model_with(given, since=0.01))


def test_the_line_is_one_of_the_function_and_not_of_what_it_calls() -> None:
    with pytest.raises(SceneError, match=r"ValueError: .*, raised in module .*test_given_functions, line \d+;"):
        GivenFunction(lambda: np.concatenate([np.zeros((2, 2)), np.zeros((3, 3))]), "fluid.force")()
    with pytest.raises(SceneError, match=r"TypeError") as caught:
        GivenFunction(len, "fluid.force")()
    assert isinstance(caught.value.__cause__, TypeError)


def test_errors_of_rigidfluid_and_interrupts_stay() -> None:
    for error in (SceneError("key", "this", "that", "Mend it."), KeyboardInterrupt(), MemoryError()):

        def fail(error: BaseException = error) -> None:
            raise error

        with pytest.raises(type(error)) as caught:
            GivenFunction(fail, "fluid.force")()
        assert caught.value is error
