"""What a checkpoint may hold of a backend that is not ours."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.output.checkpoint import Checkpoint, read_checkpoint
from rigidfluid.core.output.checkpoint_checks import require_sound
from rigidfluid.core.output.stored_records import Misfit

NAMES = ("levels", "times", "seconds", "highest_speed", "cell_of")


@pytest.fixture
def written(tmp_path: Path) -> Checkpoint:
    rigidfluid.run(dry_scene({}, ball([0.5, 0.5], [0.1, 0.0]), end=0.02, step=0.01), tmp_path)
    return read_checkpoint(tmp_path / "state.h5")


def with_arrays(checkpoint: Checkpoint, values: FloatArray, where: str) -> Checkpoint:
    arrays = dict.fromkeys(NAMES, values)
    if where == "memory":
        return replace(checkpoint, memory=arrays)
    return replace(checkpoint, state=replace(checkpoint.state, fluid=arrays))


@pytest.mark.parametrize("where", ["memory", "fluid"])
@pytest.mark.parametrize("values", [np.array([-1, 2]), np.array([-0.5, 0.0]), np.zeros((0, 3)), np.array(-1.0)])
def test_arrays_of_a_backend_have_any_names_signs_and_shapes(
    written: Checkpoint, values: FloatArray, where: str
) -> None:
    require_sound(with_arrays(written, values, where))


@pytest.mark.parametrize("where", ["memory", "fluid"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_arrays_of_a_backend_are_finite(written: Checkpoint, value: float, where: str) -> None:
    with pytest.raises(Misfit) as error:
        require_sound(with_arrays(written, np.array([value]), where))
    assert error.value.allowed == "finite numbers"


@pytest.mark.parametrize("name", [field.name for field in fields(Contacts)])
def test_columns_of_contacts_are_of_one_length(written: Checkpoint, name: str) -> None:
    contacts = written.state.contacts
    count, d = contacts.normal.shape
    contacts = replace(contacts, shift=np.zeros_like(contacts.normal), curvatures=np.zeros((count, 2, d, d)))
    longer = np.zeros((len(contacts) + 1, *getattr(contacts, name).shape[1:]), dtype=getattr(contacts, name).dtype)
    state = replace(written.state, contacts=replace(contacts, **{name: longer}))
    with pytest.raises(Misfit, match="state/contacts"):
        require_sound(replace(written, state=state))
