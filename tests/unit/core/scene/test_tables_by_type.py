"""Lists of tables whose keys depend on their type, and scenes that were stored before there were such."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import jsonschema
import pytest
from pydantic import BaseModel, ConfigDict, Field

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.output.checkpoint import adopt_checkpoint, read_checkpoint, stage_checkpoint
from rigidfluid.core.output.writer import CHECKPOINT
from rigidfluid.core.scene.earlier import tables_now
from rigidfluid.core.scene.validation import read_table
from rigidfluid.errors import SceneError

INLET = {"on": "left", "type": "velocity", "velocity": [1.0, 0.0]}
OUTLET = {"on": "right", "type": "pressure", "pressure": 0.0}
LEFT = {"on": "left"}


def tables(*boundary: Any, **changes: Any) -> dict[str, Any]:
    """A fixed disk in a channel."""
    disk = {"type": "sphere", "radius": 0.2, "density": 1.0, "position": [1.0, 0.5], "fixed": True}
    return {
        "scene": {"name": "by_type", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 1.0},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
        "boundary": copy.deepcopy(list(boundary)),
        "body": [disk],
        "mesh": {"size": 0.4, "size_body": 0.2},
        "time": {"end": 0.2, "step": 0.1},
        "output": {"every": 0.1},
    } | changes


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (
            LEFT | {"type": "slip", "pressure_drop": 1.0},
            "boundary.1.pressure_drop: pressure_drop is valid only with type = 'periodic', not 'slip'. "
            "Leave it out, or set type = 'periodic'.",
        ),
        (
            LEFT | {"type": "symmetry", "velocity": [1.0, 0.0]},
            "boundary.1.velocity: velocity is valid only with type = 'wall' or 'velocity', not 'symmetry'. "
            "Leave it out, or change the type.",
        ),
        (
            INLET | {"velocty": [1.0, 0.0]},
            "boundary.1.velocty: found a key that nothing reads; allowed is flux, on, over_time, profile, ramp, type, "
            "velocity. Did you mean 'velocity'?",
        ),
        (INLET | {"over_time": {"flie": "a"}}, "boundary.1.over_time.flie: found a key that nothing reads"),
        (
            LEFT | {"type": "pressure"},
            "boundary.1.pressure: this key is missing. Add 'pressure': Pressure on the surface",
        ),
        (LEFT | {"type": "periodic", "pressure_drop": [1]}, "boundary.1.pressure_drop: found [1]; allowed is a valid"),
        (LEFT | {"type": "symetry"}, "boundary.1.type: found 'symetry'; allowed is 'wall', 'velocity', "),
        (LEFT | {"type": True}, "boundary.1.type: found True; allowed is 'wall', "),
        (LEFT, "boundary.1.type: found nothing; allowed is 'wall', "),
        (LEFT | {"tpye": "wall"}, "boundary.1.tpye: found a key that nothing reads"),
        (3, "boundary.1: found 3; allowed is an object"),
        (INLET | {"velocity": [1.0]}, "boundary.1.velocity: found [1.0], 1 of them; allowed is 2 numbers"),
    ],
)
def test_a_table_is_told_what_its_type_does_not_have(table: Any, message: str) -> None:
    with pytest.raises(SceneError) as raised:
        scene_from_dict(tables(OUTLET, table))
    assert any(line.startswith(message) for line in str(raised.value).splitlines())
    assert raised.value.remedy


@pytest.mark.parametrize(
    ("word", "remedy"), [("symetry", "Did you mean 'symmetry'?"), ("tpye", "Did you mean 'type'?")]
)
def test_a_type_that_is_misspelt_is_recognised(word: str, remedy: str) -> None:
    table = {"type": word} if word == "symetry" else {word: "wall"}
    with pytest.raises(SceneError) as raised:
        scene_from_dict(tables(LEFT | table))
    assert raised.value.remedy == remedy


def test_the_schema_has_the_keys_of_each_type() -> None:
    valid = jsonschema.Draft7Validator(json_schema()).is_valid
    assert valid(tables(INLET, OUTLET, {"on": "top", "type": "symmetry"}))
    assert not valid(tables(INLET | {"pressure": 0.0}))
    assert not valid(tables(LEFT | {"type": "walls"}))


def stored(scene: rigidfluid.Scene) -> dict[str, Any]:
    """Tables of a scene as they once were, with a profile of all conditions."""
    old = scene.to_dict()
    for table in old["boundary"]:
        table.setdefault("profile", "uniform")
    return old


def test_scenes_of_earlier_runs_are_the_same_scenes() -> None:
    scene = scene_from_dict(tables({"on": "all", "type": "slip"}, INLET, OUTLET))
    old = stored(scene)
    assert old != scene.to_dict()
    assert tables_now(old) == scene.to_dict()
    assert scene_from_dict(old) == scene
    assert old == stored(scene)
    assert tables_now(scene.to_dict()) == scene.to_dict()


def test_runs_from_before_go_on(tmp_path: Path) -> None:
    scene = scene_from_dict(tables(INLET, OUTLET))
    rigidfluid.run(scene_from_dict(tables(INLET, OUTLET, time={"end": 0.1, "step": 0.1})), tmp_path)
    checkpoint = read_checkpoint(tmp_path / CHECKPOINT)
    written = stored(scene_from_dict(json.loads(checkpoint.scene)))
    stage_checkpoint(tmp_path / CHECKPOINT, replace(checkpoint, scene=json.dumps(written)))
    adopt_checkpoint(tmp_path / CHECKPOINT)
    assert rigidfluid.run(scene, tmp_path, resume=True).bodies["time"][-1] == pytest.approx(0.2)


class Disc(BaseModel):
    model_config = ConfigDict(extra="forbid")

    form: Literal["disc"]
    radius: float


class Slab(BaseModel):
    model_config = ConfigDict(extra="forbid")

    form: Literal["slab"]
    size: tuple[float, ...]


class Holder(BaseModel):
    one: Disc | Slab | None = Field(discriminator="form")
    many: tuple[Annotated[Disc | Slab, Field(discriminator="form")], ...] = ()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"one": {"form": "disc", "size": 1.0}}, "it.one.size: size is valid only with form = 'slab', not 'disc'"),
        ({"one": {"form": "disc"}}, "it.one.radius: this key is missing. Add 'radius'"),
        ({"one": {"form": "slab", "size": [1.0, "a"]}}, "it.one.size.1: found 'a'"),
        ({"one": {"form": "dics", "size": 1.0}}, "it.one.form: found 'dics'; allowed is 'disc', 'slab'. Did you mean"),
        ({"one": {"size": 1.0}}, "it.one.form: found nothing; allowed is 'disc', 'slab'. Add the key 'form'"),
        ({"one": {"form": "disc", "radius": 1.0}, "many": [{"form": "disc"}]}, "it.many.0.radius: this key is missing"),
    ],
)
def test_a_part_may_tell_its_tables_apart_by_a_key(data: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError) as raised:
        read_table(Holder, data, "it")
    assert any(line.startswith(message) for line in str(raised.value).splitlines())
