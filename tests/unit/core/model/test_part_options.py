"""Options of parts that are made in Python."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from pydantic import AliasChoices, Field, ValidationError, field_validator

from rigidfluid.api import (
    ArgumentError,
    BoxOptions,
    EllipsoidOptions,
    NestedBodyTable,
    PartOptions,
    PolygonOptions,
    SceneError,
    SphereOptions,
)
from rigidfluid.core.scene.validation import read_table


class PaintOptions(PartOptions):
    """Of somebody else's part: an alias, and options of another part made within."""

    colour: str = Field(default="red", validation_alias=AliasChoices("colour", "color"), description="Of its paint")
    drop: float = Field(default=1.0, description="Size of a drop [length]")

    @field_validator("drop")
    @classmethod
    def of_a_ball(cls, drop: float) -> float:
        """A drop is a ball."""
        return SphereOptions(radius=drop).radius


REFUSED = {
    "a value out of range": (SphereOptions, {"radius": -1}, r"SphereOptions\.radius: found -1; .* greater than 0\."),
    "a wrong type": (SphereOptions, {"radius": "wide"}, r"SphereOptions\.radius: found 'wide'; allowed is a valid"),
    "an unknown key": (SphereOptions, {"raduis": 1.0}, r"SphereOptions\.raduis: found a key.* Did you mean 'radius'\?"),
    "nothing": (SphereOptions, {}, r"SphereOptions\.radius: this key is missing\. Add 'radius': Radius"),
    "no string by an alias": (PaintOptions, {"color": 1}, r"PaintOptions\.color.*: found 1; allowed is a valid string"),
    "a body without a type": (NestedBodyTable, {"position": (0.0,)}, r"NestedBodyTable\.type: this key is missing"),
}


@pytest.mark.parametrize(("options", "keys", "said"), REFUSED.values(), ids=REFUSED)
def test_the_error_names_class_and_field_the_value_and_what_is_allowed(
    options: type[PartOptions], keys: dict[str, Any], said: str
) -> None:
    with pytest.raises(ArgumentError, match=said) as caught:
        options(**keys)
    assert isinstance(caught.value, SceneError)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


ROWS = [(0.2, 0.1), [0.2, 0.1], np.array([0.2, 0.1])]


@pytest.mark.parametrize("row", ROWS, ids=["tuple", "list", "array"])
def test_any_row_of_numbers_is_taken(row: Any) -> None:
    assert EllipsoidOptions(semi_axes=row).semi_axes == (0.2, 0.1)
    assert BoxOptions(lower=row, upper=row).upper == (0.2, 0.1)
    assert PolygonOptions(points=[row, row, [1.0, 0.0]]).points[1] == (0.2, 0.1)


def test_a_row_of_words_is_refused_and_the_others_are_not_blamed() -> None:
    with pytest.raises(ArgumentError, match=r"BoxOptions\.upper\.1: found 'b'"):
        BoxOptions(lower=[0.0, 0.0], upper=(1.0, "b"))


def test_who_catches_what_pydantic_raises_catches_it_too() -> None:
    with pytest.raises(ValueError, match="radius"):
        SphereOptions(radius=-1)
    with pytest.raises(ArgumentError, match=r"PaintOptions\.drop: found -1\.0; .*SphereOptions\.radius: found -1\.0"):
        PaintOptions(drop=-1.0)


def test_what_reads_a_table_is_told_by_pydantic_and_names_its_place() -> None:
    with pytest.raises(ValidationError):
        SphereOptions.model_validate({"radius": -1.0})
    with pytest.raises(SceneError, match=r"^body\.0\.radius: found -1\.0"):
        read_table(SphereOptions, {"radius": -1.0}, "body.0")
